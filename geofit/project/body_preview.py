"""A body as it would be with other settings, in a second: fewer data, coarse triangles, no volumes, no verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.active import farthest_apart
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_field
from geofit.bodies.settings import BodySettings
from geofit.data.progress import Progress, tell
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_record import Intervals, Outlines, SurfacePicks
from geofit.project.body_sources import read_body_source

__all__ = ["BodyPreview", "preview_body", "thinned_data"]

#: Contacts and samples of each side that a preview is fitted to, and cells along its longest side.
CONTACTS = 300
SAMPLES = 1500
CELLS = 40


@dataclass(frozen=True, eq=False)
class BodyPreview:
    """Triangles in map coordinates, and how many of the contacts they were fitted to."""

    mesh: TriangleMesh
    contacts: int
    of: int


def preview_body(
    source: Intervals | Outlines | SurfacePicks,
    settings: BodySettings,
    campaigns: Sequence[Any],
    folder: Path,
    *,
    progress: Progress | None = None,
) -> BodyPreview:
    """Fit a body to some of its data; parameters and errors as :func:`geofit.project.body_building.make_body`.

    It stops between its stages: reading, fit, triangles.
    """
    tell(progress, "read", 0.0)
    data = read_body_source(source, settings, campaigns, folder, progress).data
    few = thinned_data(data)
    tell(progress, "fit", 0.3)
    fitted = fit_field(few, settings)
    tell(progress, "triangles", 0.7)
    body = BodyFit("", few, settings, fitted)
    lower, upper = body.extent
    mesh = body.local_mesh(float((upper - lower).max()) / CELLS)
    tell(progress, "triangles", 1.0)
    return BodyPreview(TriangleMesh(mesh.vertices + body.origin, mesh.triangles), len(few.contacts), len(data.contacts))


def thinned_data(data: BodyData, contacts: int = CONTACTS, samples: int = SAMPLES) -> BodyData:
    """Return at most so many contacts, spread over the body, and samples of each side at regular intervals."""
    if max(len(data.contacts) - contacts, len(data.inside) - samples, len(data.outside) - samples) <= 0:
        return data
    own: NDArray[np.int64] = np.arange(len(data.contacts))
    if len(own) > contacts:
        own = np.sort(farthest_apart(data.contacts - data.contacts[0], contacts))
    inside, outside = (np.arange(0, len(xyz), max(1, -(-len(xyz) // samples))) for xyz in (data.inside, data.outside))
    return BodyData(
        data.contacts[own],
        data.inside[inside],
        data.outside[outside],
        data.normals[own],
        data.hole[own],
        data.inside_hole[inside],
        data.outside_hole[outside],
        data.inside_length[inside],
        data.outside_length[outside],
        data.issues,
    )

"""The check of a surface that a file gives: triangles, and patches that end at loops, measured to what is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.checks.check import check
from geofit.checks.shape import RANGE_SHARE
from geofit.data.accuracy import Accuracy, Check
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.geometry.mesh import MeshSurface
from geofit.geometry.mesh_projection import Nearest
from geofit.geometry.mesh_projection import nearest as nearest_triangle
from geofit.geometry.projection import Projection
from geofit.geometry.trim_loops import loops_of
from geofit.geometry.trim_loops import nearest as nearest_place
from geofit.surfaces.surface import HorizonSurface

__all__ = ["check_given"]

#: So many points beside the surface are named.
NAMED = 20


def check_given(surface: HorizonSurface, points: PointSet, settings: FitSettings, name: str) -> HorizonSurface:
    """Return a surface of a file with its points, settings and check.

    A point beside the surface is measured to the surface's edge, counts in sigma with that distance, and is
    listed: the surface says nothing of it.
    """
    judged = surface.with_(points=points, settings=settings, name=name)
    xyz = points.xyz - surface.origin
    if isinstance(surface, MeshSurface):
        found = nearest_triangle(surface.mesh, xyz)
        accuracy = check(judged, projection=_projection(found, np.zeros(len(points), np.int64)))
        accuracy = replace(accuracy, checks=(*accuracy.checks, *_mesh_checks(surface, points)))
        text = message(
            "check.triangle-mesh-seams-control",
            "A triangle mesh: seams, control points and the tangent plane do not apply.",
        )
        return judged.with_(accuracy=_with_beyond(accuracy, points, found, (text,)))
    found = nearest_place(surface.patches, xyz, loops_of(surface))
    accuracy = check(judged, projection=_projection(found, found.part))
    return judged.with_(accuracy=_with_beyond(accuracy, points, found, accuracy.notes))


def _projection(found: Nearest, patch: NDArray[np.int64]) -> Projection:
    """Return nearest places as the check takes them; triangles have no parameters."""
    uv = np.full((len(patch), 2), np.nan) if found.uv is None else found.uv
    return Projection(found.distance, found.foot, patch, uv[:, 0], uv[:, 1], np.ones(len(patch), bool))


def _with_beyond(accuracy: Accuracy, points: PointSet, found: Nearest, notes: tuple[Message, ...]) -> Accuracy:
    """Add the points beside the surface, each with its place in a file."""
    beside = np.flatnonzero(found.beyond)
    text = message(
        "check.points-beyond-surface-edge",
        "points beyond the surface's edge, measured to the edge: {count} of {total}",
        count=beside.size,
        total=accuracy.n,
    )
    added = Check("beyond the surface", None, float(beside.size), 0.0, "points", text)
    named = [
        message("check.beyond-surface", "beyond the surface: {point}", point=points.describe(int(i)))
        for i in beside[:NAMED].tolist()
    ]
    if beside.size > NAMED:
        named.append(
            message(
                "check.beyond-surface-further-points",
                "beyond the surface: further points, {count}",
                count=beside.size - NAMED,
            )
        )
    told = (text, *named) if beside.size else ()
    return replace(accuracy, checks=(*accuracy.checks, added), notes=(*notes, *told))


def _mesh_checks(surface: MeshSurface, points: PointSet) -> tuple[Check, ...]:
    """Look for triangles that are turned over or have no area, and for elevations far outside the data's range."""
    corners = surface.mesh.points[surface.mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    turned = int(((normal @ normal.sum(axis=0) < 0) | (size <= 1e-12 * size.max())).sum())
    text = message(
        "check.triangles-turned-without-area",
        "{count} of {total} triangles turned over or without an area",
        count=turned,
        total=len(size),
    )
    checks = [Check("normals", turned == 0, turned, 0, "places", text)]
    z, heights = points.xyz[:, 2], surface.mesh.xyz[:, 2]
    if len(z) and np.ptp(z) > 0:
        beyond = max(float(z.min() - heights.min()), float(heights.max() - z.max()), 0.0)
        limit = RANGE_SHARE * float(np.ptp(z))
        text = message(
            "check.elevations-reach-beyond-data", "elevations reach {value:.1f} m beyond the data's range", value=beyond
        )
        checks.append(Check("elevation range", beyond <= limit, beyond, limit, "m", text))
    return tuple(checks)

"""The check of a surface that a file gives: triangles, and patches that end at loops, measured to what is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.checks.check import check
from geofit.checks.outside import BEYOND, continued
from geofit.checks.shape import RANGE_SHARE
from geofit.data.accuracy import Accuracy, Check
from geofit.data.given import SURFACES, arguments_checked, require_kind
from geofit.data.legible import legible
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.mesh import Mesh
from geofit.geometry.trim_loops import beyond_edge
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["judge"]

#: So many points beside the surface are named.
NAMED = 20


@arguments_checked
def judge(
    surface: PatchSurface | MeshSurface, points: PointSet, settings: FitSettings | None = None, name: str = ""
) -> HorizonFit:
    """Check a surface against points, by the rules of a fit.

    Parameters
    ----------
    surface : PatchSurface or MeshSurface
        For instance one that :func:`geofit.read_surface` read.
    points : PointSet
        The points to measure, map coordinates in metres.
    settings : FitSettings, optional
        Tolerances; above all ``epsilon``, the limit of sigma.
    name : str
        Name of the horizon; empty: that of the surface.

    Returns
    -------
    HorizonFit
        Surface, points and ``accuracy``. It can be reported and exported, but not edited: it has no control net.

    Notes
    -----
    sigma is that of Li, Miao, Liu and Wang (2011), eq. 3, over all points. A point outside the outline is measured as
    in a fit, to the surface as it continues beneath the trimming; one beyond the edge of the patches, or of a face that
    ends at trim loops, is measured to the edge. Both are listed in ``accuracy.notes``, and the check "beyond the
    surface" gives sigma of the other points, which is the same in a fit and in its files.
    """
    require_kind("surface", surface, (PatchSurface, MeshSurface, HorizonFit), SURFACES)
    judged = HorizonFit(surface, points, settings or FitSettings(), legible(name or surface.name))
    found = surface.project(points.xyz)
    if found.beyond is None:
        found = replace(found, beyond=beyond_edge(surface.patches, points.xyz - surface.origin, found))
    assert found.beyond is not None
    beyond = found.beyond | continued(judged)
    accuracy = check(judged, projection=found)
    if not surface.patches:
        accuracy = replace(
            accuracy,
            checks=(*accuracy.checks, *_mesh_checks(surface.triangulate(), points)),
            notes=(
                message(
                    "fitting.mesh-without-seams",
                    "A triangle mesh: seams, control points and the tangent plane do not apply.",
                ),
            ),
        )
    return judged.with_(accuracy=_with_names(accuracy, points, beyond))


def _with_names(accuracy: Accuracy, points: PointSet, beyond: NDArray[np.bool_]) -> Accuracy:
    """Name the points that the surface does not reach, each with its place in a file."""
    if not beyond.any():
        return accuracy
    rows = np.flatnonzero(beyond)
    (count,) = [one.text for one in accuracy.checks if one.name == BEYOND]
    named = [
        message("fitting.point-beyond-edge", "beyond the surface: {point}", point=points.describe(int(i)))
        for i in rows[:NAMED].tolist()
    ]
    if rows.size > NAMED:
        named.append(
            message(
                "fitting.further-points-beyond-edge",
                "beyond the surface: further points, {count}",
                count=rows.size - NAMED,
            )
        )
    return replace(accuracy, notes=(*accuracy.notes, *(note.with_severity("warning") for note in (count, *named))))


def _mesh_checks(mesh: Mesh, points: PointSet) -> tuple[Check, ...]:
    """Look for triangles that are turned over or have no area, and for elevations far outside the data's range."""
    corners = mesh.points[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    turned = int(((normal @ normal.sum(axis=0) < 0) | (size <= 1e-12 * size.max())).sum())
    text = message(
        "fitting.triangles-degenerate",
        "{count} of {total} triangles turned over or without an area",
        count=turned,
        total=len(size),
    )
    checks = [Check("normals", turned == 0, turned, 0, "places", text)]
    z, heights = points.xyz[:, 2], mesh.xyz[:, 2]
    if len(z) and np.ptp(z) > 0:
        beyond = max(float(z.min() - heights.min()), float(heights.max() - z.max()), 0.0)
        limit = RANGE_SHARE * float(np.ptp(z))
        text = message(
            "data.elevations-beyond-data", "elevations reach {value:.1f} m beyond the data's range", value=beyond
        )
        checks.append(Check("elevation range", beyond <= limit, beyond, limit, "m", text))
    return tuple(checks)

"""The check of a surface that a file gives: triangles, and patches that end at loops, measured to what is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.accuracy import Accuracy, Check, Group
from geofit.check import check, sigma
from geofit.facets import Nearest
from geofit.facets import nearest as nearest_triangle
from geofit.loops import TrimmedSurface
from geofit.loops import nearest as nearest_place
from geofit.mesh import MeshSurface
from geofit.points import PointSet
from geofit.residual_tests import residual_checks
from geofit.settings import FitSettings
from geofit.shape import RANGE_SHARE
from geofit.surface import HorizonSurface
from geofit.words import said

__all__ = ["check_given"]

Floats = NDArray[np.float64]

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
        accuracy = _accuracy(judged, found, np.full(len(points), name), _mesh_checks(surface, points))
        text = said("A triangle mesh: seams, control points and the tangent plane do not apply.")
        return judged.with_(accuracy=_with_beyond(accuracy, points, found, (text,)))
    found = nearest_place(surface.patches, xyz, surface.loops if isinstance(surface, TrimmedSurface) else ())
    of_patches = check(judged)
    names = np.array([patch.name for patch in surface.patches])[found.part]
    accuracy = replace(_accuracy(judged, found, names, of_patches.checks), seams=of_patches.seams)
    return judged.with_(accuracy=_with_beyond(accuracy, points, found, of_patches.notes))


def _accuracy(surface: HorizonSurface, found: Nearest, part: NDArray[np.str_], checks: tuple[Check, ...]) -> Accuracy:
    """Return the figures of eq. 3 for distances that are measured already."""
    d, points, settings = found.distance, surface.points, surface.settings
    magnitude, value = np.abs(d), sigma(d)
    # What was asked of distances to whole patches is asked again of those that hold.
    again = [
        _tolerance(d, settings),
        *residual_checks(points.xyz - surface.origin, d, part, settings.interior_tolerance),
    ]
    measured = {check.name: check for check in (again if len(d) else ())}
    limits = {"interior tolerance": settings.interior_tolerance, "epsilon": settings.epsilon}
    return Accuracy(
        n=len(d),
        sigma=value,
        epsilon=settings.epsilon,
        passed=value < settings.epsilon,
        max_abs=float(magnitude.max(initial=0.0)),
        mean=float(d.mean()) if len(d) else 0.0,
        residuals=d,
        patch=part,
        by_patch=_groups(d, part),
        by_kind=_groups(d, points.kind),
        by_hole=_groups(d, points.hole),
        by_section=_groups(d, points.section),
        over={f"{what} {limit:g} m": int((magnitude > limit).sum()) for what, limit in limits.items()},
        worst=tuple(int(i) for i in np.argsort(-magnitude, kind="stable")[:20]),
        checks=(*measured.values(), *(check for check in checks if check.name not in measured)),
    )


def _tolerance(d: Floats, settings: FitSettings) -> Check:
    count, worst = int((np.abs(d) > settings.interior_tolerance).sum()), float(np.abs(d).max(initial=0.0))
    text = said("{count} of {total} points beyond the interior tolerance", count=count, total=len(d))
    return Check("interior tolerance", count == 0, worst, settings.interior_tolerance, "m", text)


def _groups(d: Floats, labels: NDArray[np.str_]) -> dict[str, Group]:
    parts = {label: d[labels == label] for label in dict.fromkeys(labels.tolist()) if label}
    return {
        label: Group(len(part), sigma(part), float(np.abs(part).max()), float(part.mean()))
        for label, part in parts.items()
    }


def _with_beyond(accuracy: Accuracy, points: PointSet, found: Nearest, notes: tuple[str, ...]) -> Accuracy:
    """Add the points beside the surface, each with its place in a file."""
    beside = np.flatnonzero(found.beyond)
    text = said(
        "{count} of {total} points lie beyond the surface's edge and are measured to the edge",
        count=beside.size,
        total=accuracy.n,
    )
    added = Check("beyond the surface", None, float(beside.size), 0.0, "points", text)
    named = [said("beyond the surface: {point}", point=points.describe(int(i))) for i in beside[:NAMED].tolist()]
    if beside.size > NAMED:
        named.append(said("beyond the surface: {count} more points", count=beside.size - NAMED))
    told = (text, *named) if beside.size else ()
    return replace(accuracy, checks=(*accuracy.checks, added), notes=(*notes, *told))


def _mesh_checks(surface: MeshSurface, points: PointSet) -> tuple[Check, ...]:
    """Look for triangles that are turned over or have no area, and for elevations far outside the data's range."""
    corners = surface.mesh.points[surface.mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    turned = int(((normal @ normal.sum(axis=0) < 0) | (size <= 1e-12 * size.max())).sum())
    text = said("{count} of {total} triangles turned over or without an area", count=turned, total=len(size))
    checks = [Check("normals", turned == 0, turned, 0, "places", text)]
    z, heights = points.xyz[:, 2], surface.mesh.xyz[:, 2]
    if len(z) and np.ptp(z) > 0:
        beyond = max(float(z.min() - heights.min()), float(heights.max() - z.max()), 0.0)
        limit = RANGE_SHARE * float(np.ptp(z))
        text = said("elevations reach {value:.1f} m beyond the data's range", value=beyond)
        checks.append(Check("elevation range", beyond <= limit, beyond, limit, "m", text))
    return tuple(checks)

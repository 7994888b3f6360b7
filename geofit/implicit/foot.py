"""Foot points on the surface of a field: the nearest point of the surface, and the signed distance to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.given import arguments_checked
from geofit.implicit.field import Field, points_of
from geofit.implicit.mesh import TriangleMesh

__all__ = ["FootPoints", "foot_points", "project_along_gradient", "signed_distance"]

Floats = NDArray[np.float64]

STEPS = 60
#: A step no longer than this share of the points' extent is the last: the next one would be rounding.
STILL = 1e-8
#: The factor of a step across the surface is not divided by less: at a centre of curvature it would have no end.
LEAST = 0.2


@dataclass(frozen=True, eq=False)
class FootPoints:
    """Foot points of n points.

    Parameters
    ----------
    xyz : (n, 3) array
        Foot points, metres.
    distance : (n,) array
        Signed distance of the points from them: negative inside.
    converged : (n,) array of bool
        Whether the iteration ended within its tolerance.
    """

    xyz: Floats
    distance: Floats
    converged: NDArray[np.bool_]


@arguments_checked
def foot_points(
    field: Field,
    xyz: ArrayLike,
    *,
    start: ArrayLike | None = None,
    reach: float = np.inf,
    tolerance: float = 1e-11,
) -> FootPoints:
    """Return the orthogonal projections of points onto the surface phi = 0.

    Parameters
    ----------
    field : Field
        phi.
    xyz : (n, 3) array
        Points p, metres.
    start : (n, 3) array, optional
        Where to begin, on the right part of the surface; by default the points themselves, which is right for points
        near the surface.
    reach : float
        Longest step, metres.
    tolerance : float
        The iteration ends when a step is below this part of the distance plus the size of the step before, metres.

    Notes
    -----
    D. Chopp's step for distances (SIAM J. Sci. Comput. 23, 2001), x += -phi g/g^2 + D - (D.g) g/g^2 with D = p - x,
    overshoots outside a curved surface: its part across is divided by 1 + k d, k the curvature in its direction, d the
    distance.
    """
    points = points_of(xyz)
    x = points.copy() if start is None else points_of(start).copy()
    converged = np.zeros(len(points), bool)
    active = np.arange(len(points))
    for _ in range(STEPS):
        if not len(active):
            break
        at, p = x[active], points[active]
        g = field.gradient(at)
        length = np.linalg.norm(g, axis=1)
        length = np.where(length > 0, length, 1.0)
        n = g / length[:, None]
        offset = p - at
        height = (offset * n).sum(axis=1)
        across = offset - height[:, None] * n
        width = np.linalg.norm(across, axis=1)
        probe = 1e-3 * across
        bend = (across * (field.gradient(at + probe) - g)).sum(axis=1)
        bend = np.where(width > 0, bend / np.where(width > 0, 1e-3 * width**2 * length, 1.0), 0.0)
        factor = 1 / np.maximum(1 + bend * height, LEAST)
        step = factor[:, None] * across - (field.value(at) / length)[:, None] * n
        size = np.linalg.norm(step, axis=1)
        step *= np.minimum(1, reach / np.where(size > 0, size, 1.0))[:, None]
        x[active] = at + step
        scale = np.maximum(np.linalg.norm(offset, axis=1), np.abs(at).max(axis=1) * 1e-4)
        done = size <= tolerance * np.maximum(scale, 1e-3)
        converged[active[done]] = True
        active = active[~done]
    x = np.where(np.isfinite(x), x, points)
    sign = np.where(field.value(points) < 0, -1.0, 1.0)
    return FootPoints(x, sign * np.linalg.norm(points - x, axis=1), converged)


@arguments_checked
def signed_distance(field: Field, xyz: ArrayLike, mesh: TriangleMesh | None = None) -> Floats:
    """Return signed orthogonal distances of points from the surface of a field, metres, positive outside.

    Parameters
    ----------
    field : Field
        phi.
    xyz : (n, 3) array
        Points, metres.
    mesh : TriangleMesh, optional
        Its surface mesh: the iteration starts at the nearest vertex. Needed for points that are not near the surface.
    """
    points = points_of(xyz)
    start = None
    if mesh is not None and len(mesh.vertices):
        from scipy.spatial import KDTree

        start = mesh.vertices[KDTree(mesh.vertices).query(points)[1]]
    return foot_points(field, points, start=start).distance


@arguments_checked
def project_along_gradient(field: Field, xyz: ArrayLike, *, reach: float = np.inf, steps: int = 6) -> Floats:
    """Return points moved onto the surface by Newton steps along the gradient, none longer than ``reach`` metres.

    At most ``steps`` are made for a point, and none after one that hardly moves it: where the gradient does not vanish,
    the next would be about as long as its square.
    """
    x = points_of(xyz).copy()
    still = STILL * float(np.ptp(x, axis=0).max()) if len(x) else 0.0
    moving = np.arange(len(x))
    for _ in range(steps):
        g = field.gradient(x[moving])
        square = (g**2).sum(axis=1)
        step = -(field.value(x[moving]) / np.where(square > 0, square, 1.0))[:, None] * g
        size = np.linalg.norm(step, axis=1)
        x[moving] += step * np.minimum(1, reach / np.where(size > 0, size, 1.0))[:, None]
        moving = moving[size > still]
        if not len(moving):
            break
    return x

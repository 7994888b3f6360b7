"""Centres and radii of metaballs moved together until their surface is nearest to that of the voxels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.medial.kernel import kernel, kernel_slope, reach

__all__ = ["polish", "surface_points"]

Floats = NDArray[np.float64]

_ROUNDS = 8
#: Surface points farther from the surface than this do not pull harder, voxels.
_FARTHEST = 1.5
#: Radii do not fall below this, voxels.
_SMALLEST = 0.3


def surface_points(body: NDArray[np.bool_], edges: Floats) -> Floats:
    """Return the centres (m, 3) of the faces between a body's voxels and rock, from the corner of the volume.

    They lie up to half a voxel on either side of the surface that was sampled, and on it on average.
    """
    padded = np.pad(body, 1)
    found = []
    for axis in range(3):
        front, back = [slice(None)] * 3, [slice(None)] * 3
        front[axis], back[axis] = slice(1, None), slice(None, -1)
        index = np.argwhere(padded[tuple(front)] != padded[tuple(back)]) - 0.5
        index[:, axis] += 0.5
        found.append(index)
    return np.asarray(np.vstack(found) * edges)


def polish(centre: Floats, radius: Floats, stiffness: float, points: Floats) -> tuple[Floats, Floats]:
    """Return centres (n, 3) and radii (n,) after a few damped Gauss-Newton steps; lengths in voxels.

    The residual of a surface point is its first-order distance (1 - F) / |grad F| from the surface.
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    damping = 1e-2
    residual, slopes = _linearized(centre, radius, stiffness, points, tree)
    for _ in range(_ROUNDS):
        normal = slopes.T @ slopes
        scale = normal.diagonal() + 1e-3 * max(float(normal.diagonal().max()), 1e-12)
        step = splu((normal + diags_array(damping * scale)).tocsc()).solve(-(slopes.T @ residual)).reshape(-1, 4)
        # A step is worth what its linear model is worth: no further than a third of a radius.
        step *= np.minimum(1.0, radius / 3 / np.maximum(np.abs(step).max(axis=1), 1e-12))[:, None]
        moved, grown = centre + step[:, :3], np.maximum(radius + step[:, 3], _SMALLEST)
        new_residual, new_slopes = _linearized(moved, grown, stiffness, points, tree)
        if new_residual @ new_residual < residual @ residual:
            centre, radius, residual, slopes = moved, grown, new_residual, new_slopes
            damping = max(damping / 4, 1e-6)
        else:
            damping *= 8
    return centre, radius


def _linearized(centre: Floats, radius: Floats, stiffness: float, points: Floats, tree: Any) -> tuple[Floats, Any]:
    """Return the residuals (m,) and their derivatives (m, 4 n) by the centre and radius of each ball."""
    from scipy.sparse import csr_array

    near = tree.query_ball_point(centre, reach(radius, stiffness), return_sorted=True)
    ball = np.repeat(np.arange(len(centre)), [len(n) for n in near])
    point = np.concatenate([np.asarray(n, dtype=np.int64) for n in near])
    offset = points[point] - centre[ball]
    r = np.maximum(np.linalg.norm(offset, axis=1), 1e-9)
    slope = kernel_slope(r, radius[ball], stiffness)
    away = slope[:, None] * offset / r[:, None]
    total = np.bincount(point, kernel(r, radius[ball], stiffness), len(points))
    gradient = np.column_stack([np.bincount(point, away[:, a], len(points)) for a in range(3)])
    # Where balls cancel or end, the distance is not defined; the slope of an average ball replaces it.
    steepness = np.maximum(np.linalg.norm(gradient, axis=1), 0.3 * stiffness / float(radius.mean()))
    residual = (1.0 - total) / steepness
    weight = np.minimum(1.0, _FARTHEST / np.maximum(np.abs(residual), 1e-12))
    columns = np.column_stack([away, slope * r / radius[ball]]) * (weight / steepness)[point][:, None]
    entries = (columns.ravel(), (np.repeat(point, 4), (4 * ball[:, None] + np.arange(4)).ravel()))
    return residual * weight, csr_array(entries, shape=(len(points), 4 * len(centre)))

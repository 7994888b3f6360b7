"""A smooth field through contact points: each contact is a plane, and near planes are averaged by distance.

The field of a place is the weighted mean of its heights over the planes of the contacts round it (implicit moving least
squares, Kolluri 2005), in units of the shortest voxel edge. The weight vanishes with two derivatives at the support.
Away from all contacts the field is that of the voxels, -1 in pores and 1 in rock, and linear between their middles.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["contact_values", "sort_into_cells"]

#: Weight of the voxels' own field, against 50 of a contact at its own place.
_BACKGROUND = 1e-3
#: Weight of a voxel that is held, against a contact at the same distance.
_FORCE = 30.0


def sort_into_cells(
    points: NDArray[np.float64], lower: NDArray[np.float64], size: float, counts: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the order of points by cell, and the first position of each cell in that order."""
    cell = np.clip(((points - lower) / size).astype(np.int64), 0, counts - 1)
    flat = np.ravel_multi_index((cell[:, 0], cell[:, 1], cell[:, 2]), (counts[0], counts[1], counts[2]))
    order = np.argsort(flat, kind="stable")
    return order, np.searchsorted(flat[order], np.arange(int(counts.prod()) + 1))


@njit(cache=True)
def contact_values(
    xyz: NDArray[np.float64],
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    held: NDArray[np.float64],
    start: NDArray[np.int64],
    lower: NDArray[np.float64],
    counts: NDArray[np.int64],
    support: float,
    pore: NDArray[np.bool_],
    edges: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return values (n,) and gradients (n, 3) at places given in units of the shortest edge from the low corner.

    ``points`` and ``normals`` are sorted into cells of edge ``support``. A point with a value other than 0 in ``held``
    has no normal: it is the middle of a voxel where the field takes this value, and reaches as far as one voxel.
    """
    values = np.empty(len(xyz))
    gradients = np.empty((len(xyz), 3))
    square = support * support
    slope = np.empty(3)
    for row in range(len(xyz)):
        place = xyz[row]
        base = _voxel_field(place, pore, edges, slope)
        total, height = _BACKGROUND, _BACKGROUND * base
        d_total, d_height = np.zeros(3), _BACKGROUND * slope
        i, j, k = (
            int(np.floor((place[0] - lower[0]) / support)),
            int(np.floor((place[1] - lower[1]) / support)),
            int(np.floor((place[2] - lower[2]) / support)),
        )
        for a in range(max(i - 1, 0), min(i + 2, counts[0])):
            for b in range(max(j - 1, 0), min(j + 2, counts[1])):
                first = (a * counts[1] + b) * counts[2]
                low, high = max(k - 1, 0), min(k + 2, counts[2])
                if low >= high:
                    continue
                for p in range(start[first + low], start[first + high]):
                    x, y, z = place[0] - points[p, 0], place[1] - points[p, 1], place[2] - points[p, 2]
                    own, force = (square, 1.0) if held[p] == 0.0 else (1.0, _FORCE)
                    q = (x * x + y * y + z * z) / own
                    if q >= 1.0:
                        continue
                    near = q + 0.02
                    w = force * (1.0 - q) ** 3 / near
                    dw = force * (-3.0 * (1.0 - q) ** 2 / near - (1.0 - q) ** 3 / near**2) * 2.0 / own
                    h = x * normals[p, 0] + y * normals[p, 1] + z * normals[p, 2] + held[p]
                    total += w
                    height += w * h
                    d_total[0] += dw * x
                    d_total[1] += dw * y
                    d_total[2] += dw * z
                    d_height[0] += dw * x * h + w * normals[p, 0]
                    d_height[1] += dw * y * h + w * normals[p, 1]
                    d_height[2] += dw * z * h + w * normals[p, 2]
        values[row] = height / total
        for axis in range(3):
            gradients[row, axis] = (d_height[axis] - height / total * d_total[axis]) / total
    return values, gradients


@njit(cache=True)
def _voxel_field(
    place: NDArray[np.float64], pore: NDArray[np.bool_], edges: NDArray[np.float64], slope: NDArray[np.float64]
) -> float:
    """Return the trilinear field of the voxels, -1 in pores and 1 in rock, and write its gradient to ``slope``."""
    first, share = np.empty(3, np.int64), np.empty(3)
    for axis in range(3):
        t = min(max(place[axis] / edges[axis] - 0.5, 0.0), pore.shape[axis] - 1.0)
        first[axis] = min(int(t), max(pore.shape[axis] - 2, 0))
        share[axis] = t - first[axis]
    value = 0.0
    slope[:] = 0.0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                i, j, k = (
                    min(first[0] + a, pore.shape[0] - 1),
                    min(first[1] + b, pore.shape[1] - 1),
                    min(first[2] + c, pore.shape[2] - 1),
                )
                own = -1.0 if pore[i, j, k] else 1.0
                u = share[0] if a else 1.0 - share[0]
                v = share[1] if b else 1.0 - share[1]
                w = share[2] if c else 1.0 - share[2]
                value += own * u * v * w
                slope[0] += own * (1 if a else -1) * v * w / edges[0]
                slope[1] += own * u * (1 if b else -1) * w / edges[1]
                slope[2] += own * u * v * (1 if c else -1) / edges[2]
    return value

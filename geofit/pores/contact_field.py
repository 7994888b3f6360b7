"""A smooth field through contact points: each contact is a plane, and near planes are averaged by distance.

The field of a place is the weighted mean of its heights over the planes of the contacts round it (implicit moving least
squares, Kolluri 2005), in units of the shortest voxel edge. The weight vanishes with two derivatives at the support.
Away from all contacts the field is that of the voxels, -1 in pores and 1 in rock, and linear between their middles.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["contact_gradients", "contact_values", "sort_into_cells"]

#: Weight of the voxels' own field, against 50 of a contact at its own place.
_BACKGROUND = 1e-3
#: Weight of a voxel that is held, against a contact at the same distance.
_FORCE = 30.0
#: Added to squared distances, or the nearest contact would have infinite weight.
_NEAREST = 0.02


def sort_into_cells(
    points: NDArray[np.float64], lower: NDArray[np.float64], size: float, counts: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the order of points by cell, and the first position of each cell in that order."""
    cell = np.clip(((points - lower) / size).astype(np.int64), 0, counts - 1)
    flat = np.ravel_multi_index((cell[:, 0], cell[:, 1], cell[:, 2]), (counts[0], counts[1], counts[2]))
    order = np.argsort(flat, kind="stable")
    return order, np.searchsorted(flat[order], np.arange(int(counts.prod()) + 1))


@njit(cache=True, nogil=True)
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
    values: NDArray[np.float64],
) -> None:
    """Write the field at places (n, 3), in units of the shortest edge from the low corner, to ``values`` (n,).

    ``points`` and ``normals`` are sorted into cells of edge ``support``. A point with a value other than 0 in ``held``
    has no normal: it is the middle of a voxel where the field takes this value, and reaches as far as one voxel.
    """
    square = support * support
    for row in range(len(xyz)):
        x0, y0, z0 = xyz[row]
        total, height = _BACKGROUND, _BACKGROUND * _voxel_field(x0, y0, z0, pore, edges)[0]
        first_i, end_i = _around(x0, lower[0], support, counts[0])
        first_j, end_j = _around(y0, lower[1], support, counts[1])
        first_k, end_k = _around(z0, lower[2], support, counts[2])
        for i in range(first_i, end_i):
            for j in range(first_j, end_j):
                row_of_cells = (i * counts[1] + j) * counts[2]
                if first_k >= end_k:
                    continue
                for p in range(start[row_of_cells + first_k], start[row_of_cells + end_k]):
                    x, y, z = x0 - points[p, 0], y0 - points[p, 1], z0 - points[p, 2]
                    own, force = (square, 1.0) if held[p] == 0.0 else (1.0, _FORCE)
                    away = x * x + y * y + z * z
                    if away >= own:
                        continue
                    q = away / own
                    w = force * (1.0 - q) ** 3 / (q + _NEAREST)
                    total += w
                    height += w * (x * normals[p, 0] + y * normals[p, 1] + z * normals[p, 2] + held[p])
        values[row] = height / total


@njit(cache=True, nogil=True)
def contact_gradients(
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
    gradients: NDArray[np.float64],
) -> None:
    """Write the gradient of the field at places (n, 3) to ``gradients`` (n, 3); all else as in `contact_values`."""
    square = support * support
    for row in range(len(xyz)):
        x0, y0, z0 = xyz[row]
        base, gx, gy, gz = _voxel_field(x0, y0, z0, pore, edges)
        total, height = _BACKGROUND, _BACKGROUND * base
        tx = ty = tz = 0.0
        hx, hy, hz = _BACKGROUND * gx, _BACKGROUND * gy, _BACKGROUND * gz
        first_i, end_i = _around(x0, lower[0], support, counts[0])
        first_j, end_j = _around(y0, lower[1], support, counts[1])
        first_k, end_k = _around(z0, lower[2], support, counts[2])
        for i in range(first_i, end_i):
            for j in range(first_j, end_j):
                row_of_cells = (i * counts[1] + j) * counts[2]
                if first_k >= end_k:
                    continue
                for p in range(start[row_of_cells + first_k], start[row_of_cells + end_k]):
                    x, y, z = x0 - points[p, 0], y0 - points[p, 1], z0 - points[p, 2]
                    own, force = (square, 1.0) if held[p] == 0.0 else (1.0, _FORCE)
                    away = x * x + y * y + z * z
                    if away >= own:
                        continue
                    q = away / own
                    near = q + _NEAREST
                    w = force * (1.0 - q) ** 3 / near
                    dw = force * (-3.0 * (1.0 - q) ** 2 / near - (1.0 - q) ** 3 / near**2) * 2.0 / own
                    h = x * normals[p, 0] + y * normals[p, 1] + z * normals[p, 2] + held[p]
                    total += w
                    height += w * h
                    tx += dw * x
                    ty += dw * y
                    tz += dw * z
                    hx += dw * x * h + w * normals[p, 0]
                    hy += dw * y * h + w * normals[p, 1]
                    hz += dw * z * h + w * normals[p, 2]
        mean = height / total
        gradients[row, 0] = (hx - mean * tx) / total
        gradients[row, 1] = (hy - mean * ty) / total
        gradients[row, 2] = (hz - mean * tz) / total


@njit(cache=True, nogil=True)
def _around(place: float, lower: float, support: float, count: int) -> tuple[int, int]:
    """Return the first cell of the three round a place along an axis, and the end of them."""
    cell = int(np.floor((place - lower) / support))
    return max(cell - 1, 0), min(cell + 2, count)


@njit(cache=True, nogil=True)
def _voxel_field(
    x: float, y: float, z: float, pore: NDArray[np.bool_], edges: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Return the trilinear field of the voxels, -1 in pores and 1 in rock, and its gradient."""
    i, s = _cell(x / edges[0], pore.shape[0])
    j, t = _cell(y / edges[1], pore.shape[1])
    k, r = _cell(z / edges[2], pore.shape[2])
    value = gx = gy = gz = 0.0
    for a in range(2):
        u = s if a else 1.0 - s
        for b in range(2):
            v = t if b else 1.0 - t
            for c in range(2):
                w = r if c else 1.0 - r
                at = min(i + a, pore.shape[0] - 1), min(j + b, pore.shape[1] - 1), min(k + c, pore.shape[2] - 1)
                own = -1.0 if pore[at] else 1.0
                value += own * u * v * w
                gx += own * (1 if a else -1) * v * w / edges[0]
                gy += own * u * (1 if b else -1) * w / edges[1]
                gz += own * u * v * (1 if c else -1) / edges[2]
    return value, gx, gy, gz


@njit(cache=True, nogil=True)
def _cell(place: float, count: int) -> tuple[int, float]:
    """Return the voxel whose middle lies below a place given in voxels, and the share of the way to the next."""
    t = min(max(place - 0.5, 0.0), count - 1.0)
    # A coordinate that is not a number must not index beyond the array; its weights are nan.
    first = max(min(int(t), max(count - 2, 0)), 0)
    return first, t - first

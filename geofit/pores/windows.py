"""Windows: the surfaces where two pores meet, or where a pore meets a face of the sample.

A window is a connected set of voxel faces. Its area is the length of the sum of the face vectors: the projected area of
its border curve, which does not depend on the staircase the faces make.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Windows", "inner_windows", "outer_windows"]


class Windows(NamedTuple):
    """Windows and their voxel faces; faces are sorted by window.

    ``first`` and ``second`` are the pores of a window, counted from 0; for a window in a face of the sample, ``second``
    is the number of that face (0 and 1: low and high end of axis 0, and so on). ``start`` has one entry more than there
    are windows. ``voxel`` is the flat index of the voxel on the low side of a face, ``axis`` the face's normal,
    ``sign`` +1 where the normal points from the first pore to the second, ``level`` the level of the narrower of its
    two voxels.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    start: NDArray[np.int64]
    voxel: NDArray[np.int64]
    axis: NDArray[np.int8]
    sign: NDArray[np.int8]
    level: NDArray[np.int32]


def inner_windows(pore_of: NDArray[np.int32], levels: NDArray[np.int32], pores: int) -> Windows:
    """Return the windows between pores; ``pore_of`` counts from 1."""
    key, voxel, axis, sign, level = _inner_faces(pore_of, levels, _count_inner(pore_of), pores + 1)
    found = _grouped(pore_of.shape, key, voxel, axis, sign, level, pores + 1)
    return found._replace(second=found.second - 1)


def outer_windows(pore_of: NDArray[np.int32], levels: NDArray[np.int32]) -> Windows:
    """Return the windows of pores in the six faces of the sample."""
    keys, voxels, axes, signs, found = [], [], [], [], []
    edge = np.array([pore_of.shape[1] * pore_of.shape[2], pore_of.shape[2], 1])
    for face in range(6):
        axis, high = divmod(face, 2)
        end = pore_of.shape[axis] - 1 if high else 0
        pores = np.asarray(pore_of.take(end, axis=axis))
        mask = pores > 0
        keys.append(pores[mask].astype(np.int64) * 8 + face)
        p, q = np.nonzero(mask)
        voxels.append(end * edge[axis] + p * np.delete(edge, axis)[0] + q * np.delete(edge, axis)[1])
        axes.append(np.full(int(mask.sum()), axis, np.int8))
        signs.append(np.full(int(mask.sum()), 1 if high else -1, np.int8))
        found.append(np.asarray(levels.take(end, axis=axis))[mask])
    key, voxel, level = np.concatenate(keys), np.concatenate(voxels), np.concatenate(found)
    return _grouped(pore_of.shape, key, voxel, np.concatenate(axes), np.concatenate(signs), level, 8)


def _grouped(
    shape: tuple[int, ...],
    key: NDArray[np.int64],
    voxel: NDArray[np.int64],
    axis: NDArray[np.int8],
    sign: NDArray[np.int8],
    level: NDArray[np.int32],
    base: int,
) -> Windows:
    """Sort faces by window; a key is first * base + second, and only the first counts from 1."""
    order = np.argsort(key, kind="stable")
    key, voxel, axis, sign, level = key[order], voxel[order], axis[order], sign[order], level[order]
    bounds = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1], [True]])) if len(key) else np.zeros(1, int)
    part = _connected_parts(shape[1], shape[2], voxel, axis, bounds)
    order = np.argsort(part, kind="stable")
    part = part[order]
    start = np.flatnonzero(np.concatenate([[True], part[1:] != part[:-1], [True]])) if len(part) else np.zeros(1, int)
    key = key[order][start[:-1]]
    return Windows(
        key // base - 1,
        key % base,
        start,
        voxel[order],
        axis[order],
        sign[order],
        level[order],
    )


@njit(cache=True)
def _count_inner(pore_of: NDArray[np.int32]) -> int:
    n0, n1, n2 = pore_of.shape
    count = 0
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                own = pore_of[i, j, k]
                if own == 0:
                    continue
                if i + 1 < n0 and pore_of[i + 1, j, k] != own and pore_of[i + 1, j, k] > 0:
                    count += 1
                if j + 1 < n1 and pore_of[i, j + 1, k] != own and pore_of[i, j + 1, k] > 0:
                    count += 1
                if k + 1 < n2 and pore_of[i, j, k + 1] != own and pore_of[i, j, k + 1] > 0:
                    count += 1
    return count


@njit(cache=True)
def _inner_faces(
    pore_of: NDArray[np.int32], levels: NDArray[np.int32], count: int, base: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int8], NDArray[np.int8], NDArray[np.int32]]:
    n0, n1, n2 = pore_of.shape
    key, voxel = np.empty(count, np.int64), np.empty(count, np.int64)
    axis, sign = np.empty(count, np.int8), np.empty(count, np.int8)
    level = np.empty(count, np.int32)
    row = 0
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                own = pore_of[i, j, k]
                if own == 0:
                    continue
                for d in range(3):
                    a, b, c = i + (d == 0), j + (d == 1), k + (d == 2)
                    if a == n0 or b == n1 or c == n2:
                        continue
                    other = pore_of[a, b, c]
                    if other == 0 or other == own:
                        continue
                    key[row] = np.int64(min(own, other)) * base + max(own, other)
                    voxel[row] = (i * n1 + j) * n2 + k
                    axis[row] = d
                    sign[row] = 1 if own < other else -1
                    level[row] = min(levels[i, j, k], levels[a, b, c])
                    row += 1
    return key, voxel, axis, sign, level


@njit(cache=True)
def _connected_parts(
    n1: int, n2: int, voxel: NDArray[np.int64], axis: NDArray[np.int8], bounds: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the connected part of each face, group by group: connected faces are within a voxel."""
    parent = np.arange(len(voxel))
    for group in range(len(bounds) - 1):
        for x in range(bounds[group], bounds[group + 1]):
            i, j, k = voxel[x] // (n1 * n2), voxel[x] // n2 % n1, voxel[x] % n2
            # Middles in half voxels; faces are listed slice by slice, so the search back ends soon.
            p, q, r = 2 * i + (axis[x] == 0), 2 * j + (axis[x] == 1), 2 * k + (axis[x] == 2)
            for y in range(x - 1, bounds[group] - 1, -1):
                a = voxel[y] // (n1 * n2)
                if i - a > 1:
                    break
                b, c = voxel[y] // n2 % n1, voxel[y] % n2
                if (
                    abs(2 * a + (axis[y] == 0) - p) > 2
                    or abs(2 * b + (axis[y] == 1) - q) > 2
                    or abs(2 * c + (axis[y] == 2) - r) > 2
                ):
                    continue
                u, v = x, y
                while parent[u] != u:
                    parent[u] = parent[parent[u]]
                    u = parent[u]
                while parent[v] != v:
                    parent[v] = parent[parent[v]]
                    v = parent[v]
                parent[max(u, v)] = min(u, v)
    for x in range(len(parent)):
        parent[x] = parent[parent[x]]
    return parent

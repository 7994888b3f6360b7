"""Windows: the surfaces where two pores meet, or where a pore meets a face of the sample.

A window is a connected set of voxel faces. Its area is the length of the sum of the face vectors: the projected area of
its border curve, which does not depend on the staircase the faces make.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace, slot, slots

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


def inner_windows(space: PackedSpace, pore_of: NDArray[np.int32], levels: NDArray[np.int32], pores: int) -> Windows:
    """Return the windows between pores; ``pore_of`` counts from 1."""
    key, voxel, axis, sign, level = _inner_faces(space, pore_of, levels, pores + 1)
    found = _grouped(space.shape, key, voxel, axis, sign, level, pores + 1)
    return found._replace(second=found.second - 1)


def outer_windows(space: PackedSpace, pore_of: NDArray[np.int32], levels: NDArray[np.int32]) -> Windows:
    """Return the windows of pores in the six faces of the sample."""
    keys, voxels, axes, signs, found = [], [], [], [], []
    steps = np.array([space.shape[1] * space.shape[2], space.shape[2], 1])
    for face in range(6):
        axis, high = divmod(face, 2)
        across = [other for other in range(3) if other != axis]
        rows, columns = (np.arange(space.shape[other]) * steps[other] for other in across)
        voxel = ((space.shape[axis] - 1) * steps[axis] * high + rows[:, None] + columns).ravel()
        place = slots(space, voxel)
        voxel, place = voxel[place >= 0], place[place >= 0]
        keys.append(pore_of[place].astype(np.int64) * 8 + face)
        voxels.append(voxel)
        axes.append(np.full(len(voxel), axis, np.int8))
        signs.append(np.full(len(voxel), 1 if high else -1, np.int8))
        found.append(levels[place])
    key, voxel, level = np.concatenate(keys), np.concatenate(voxels), np.concatenate(found)
    return _grouped(space.shape, key, voxel, np.concatenate(axes), np.concatenate(signs), level, 8)


def _grouped(
    shape: NDArray[np.int64],
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
def _inner_faces(
    space: PackedSpace, pore_of: NDArray[np.int32], levels: NDArray[np.int32], base: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int8], NDArray[np.int8], NDArray[np.int32]]:
    """Return the voxel faces that part two pores: key, voxel, axis, sign, level."""
    n0, n1, n2 = space.shape
    steps = (n1 * n2, n2, 1)
    voxel, axis = np.empty(1024, np.int64), np.empty(1024, np.int8)
    count, place = 0, -1
    for here in range(n0 * n1 * n2):
        if space.bits[here >> 6] >> np.uint64(here & 63) & np.uint64(1) == 0:
            continue
        place += 1
        for d in range(3):
            if here // steps[d] % space.shape[d] == space.shape[d] - 1:
                continue
            there = slot(space, here + steps[d])
            if there < 0 or pore_of[there] == pore_of[place]:
                continue
            if count == len(voxel):
                more_voxels, more_axes = np.empty(2 * count, np.int64), np.empty(2 * count, np.int8)
                more_voxels[:count], more_axes[:count] = voxel, axis
                voxel, axis = more_voxels, more_axes
            voxel[count], axis[count] = here, d
            count += 1
    voxel, axis = voxel[:count].copy(), axis[:count].copy()
    key, sign, level = np.empty(count, np.int64), np.empty(count, np.int8), np.empty(count, np.int32)
    for row in range(count):
        first, second = slot(space, voxel[row]), slot(space, voxel[row] + steps[axis[row]])
        own, other = pore_of[first], pore_of[second]
        key[row] = np.int64(min(own, other)) * base + max(own, other)
        sign[row] = 1 if own < other else -1
        level[row] = min(levels[first], levels[second])
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

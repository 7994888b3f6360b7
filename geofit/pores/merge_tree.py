"""Basins merged to pores: two parameters with a meaning decide which narrow places are throats.

Two basins meet at their saddle, the widest place between them. Saddles are visited from wide to narrow. The narrower
basin is merged into the wider one if its ball is too small to be a pore (R < R_min), or if the saddle is nearly as wide
as its ball (r >= tau R). Basins that are left are pores.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace, slot

__all__ = ["merge", "saddles"]


@njit(cache=True)
def _place(keys: NDArray[np.int64], key: int) -> int:
    """Return the place of a key in an open-addressing table, or the free place where it belongs."""
    mask = len(keys) - 1
    place = ((key * 0x9E3779B1) >> 7) & mask
    while keys[place] != -1 and keys[place] != key:
        place = (place + 1) & mask
    return place


@njit(cache=True)
def saddles(
    space: PackedSpace,
    levels: NDArray[np.int32],
    label: NDArray[np.int32],
    basins: int,
    by_edges: int,
    by_corners: int,
    offsets: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return the pairs of basins that touch and the level of the widest place between each.

    Returns
    -------
    pairs : ndarray of int64, shape (m, 2)
        Numbers of two basins, the smaller one first.
    level : ndarray of int32, shape (m,)
    """
    n0, n1, n2 = space.shape
    steps = offsets[:, 0] * (n1 * n2) + offsets[:, 1] * n2 + offsets[:, 2]
    # Of two neighbours the earlier voxel finds the later one.
    later = np.flatnonzero(steps > 0)
    size = 1024
    keys = np.full(size, -1, np.int64)
    widest = np.zeros(size, np.int32)
    count = 0
    row = -1
    for here in range(n0 * n1 * n2):
        if space.bits[here >> 6] >> np.uint64(here & 63) & np.uint64(1) == 0:
            continue
        row += 1
        own, level = label[row], levels[row]
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        inside = 0 < i < n0 - 1 and 0 < j < n1 - 1 and 0 < k < n2 - 1
        for d in later:
            if not inside:
                a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
                if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                    continue
            there = slot(space, here + steps[d])
            if there < 0 or label[there] == own:
                continue
            if d >= 6 and max(level, levels[there]) < (by_edges if d < 18 else by_corners):
                continue
            saddle = min(level, levels[there])
            key = np.int64(min(own, label[there])) * (basins + 1) + max(own, label[there])
            place = _place(keys, key)
            if keys[place] == -1:
                keys[place] = key
                count += 1
                widest[place] = saddle
                if 2 * count > size:
                    size *= 2
                    new_keys = np.full(size, -1, np.int64)
                    new_widest = np.zeros(size, np.int32)
                    for old in range(len(keys)):
                        if keys[old] != -1:
                            new = _place(new_keys, keys[old])
                            new_keys[new], new_widest[new] = keys[old], widest[old]
                    keys, widest = new_keys, new_widest
            elif saddle > widest[place]:
                widest[place] = saddle
    pairs = np.empty((count, 2), np.int64)
    level_of = np.empty(count, np.int32)
    row = 0
    for place in range(size):
        if keys[place] != -1:
            pairs[row, 0], pairs[row, 1] = keys[place] // (basins + 1), keys[place] % (basins + 1)
            level_of[row] = widest[place]
            row += 1
    return pairs, level_of


def merge(
    pairs: NDArray[np.int64], saddle: NDArray[Any], radius: NDArray[np.float64], r_min: float, tau: float
) -> NDArray[np.int64]:
    """Return for each basin the number of the pore it belongs to.

    Parameters
    ----------
    pairs : ndarray of int, shape (m, 2)
        Basins that touch, counted from 0.
    saddle : ndarray of float, shape (m,)
        Radius of the widest place between each pair.
    radius : ndarray of float, shape (n,)
        Radius of the largest ball of each basin; must not rise.
    r_min, tau : float

    Returns
    -------
    ndarray of int64, shape (n,)
        Pores count from 0, the widest first.
    """
    order = np.lexsort((pairs[:, 1], pairs[:, 0], -saddle))
    root = _merge(pairs[order], saddle[order], radius, r_min, tau)
    _, pore = np.unique(root, return_inverse=True)
    return pore.astype(np.int64)


@njit(cache=True)
def _merge(
    pairs: NDArray[np.int64], saddle: NDArray[np.float64], radius: NDArray[np.float64], r_min: float, tau: float
) -> NDArray[np.int64]:
    parent = np.arange(len(radius))
    for row in range(len(pairs)):
        a, b = pairs[row, 0], pairs[row, 1]
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        if a == b:
            continue
        wide, narrow = min(a, b), max(a, b)
        if radius[narrow] < r_min or saddle[row] >= tau * radius[narrow]:
            parent[narrow] = wide
    for basin in range(len(parent)):
        # A basin's pore has a smaller number, which is resolved already.
        parent[basin] = parent[parent[basin]]
    return parent

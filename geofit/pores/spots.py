"""Places finer than the grid: the widest ball near a voxel, and windows that have no widest place of their own."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace, slot
from geofit.pores.threads import in_parts
from geofit.pores.windows import Windows

__all__ = ["own_saddle", "widest_balls"]

#: Balls that are worth a thread.
_LEAST = 500
#: A centre may move this far from its start, in voxels along each axis.
_MOVE = 1.25
#: Distances and places that differ by less are the same; so many equally good places are followed at once.
_SAME, _TIES = 1e-9, 16
#: Third pores that are looked for in the ball of a window; more than two or three are rare.
_THIRDS = 8
#: A window with less than this share of the area of its own ball's section is a strip between other windows.
_STRIP = 0.5


def widest_balls(
    start: NDArray[np.float64], normal: NDArray[np.float64], space: PackedSpace, edges: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance to the nearest rock voxel's centre from the best place near each start.

    It does not depend on how the volume is turned or mirrored: a step goes to the best of all places round the centre,
    and to each of them if several are equally good.

    Parameters
    ----------
    start : ndarray of float, shape (n, 3)
        Places in indices at which the distance to the rock is known to be large.
    normal : ndarray of float, shape (n, 3)
        The centre moves only across this direction; zero: it moves freely.
    space : PackedSpace
        The pore space.
    edges : ndarray of float, shape (3,)
    """
    found = in_parts(
        lambda first, end: _widest_balls(start[first:end], normal[first:end], space, edges), len(start), _LEAST
    )
    return np.concatenate(found)


@njit(cache=True, nogil=True)
def _widest_balls(
    start: NDArray[np.float64], normal: NDArray[np.float64], space: PackedSpace, edges: NDArray[np.float64]
) -> NDArray[np.float64]:
    out = np.zeros(len(start))
    places, better = np.zeros((_TIES, 3)), np.zeros((_TIES, 3))
    for row in range(len(start)):
        rocks, count = _rocks_near(start[row], space, edges)
        if count == 0:
            out[row] = np.inf
            continue
        places[0] = 0.0
        ties = 1
        best = _nearest(rocks, count, 0.0, 0.0, 0.0, 0.0)
        stride = 0.5
        while stride > 0.02:
            found = 0
            for tie in range(ties):
                for step in range(27):
                    sx, sy, sz = (
                        (step // 9 - 1) * stride * edges[0],
                        (step // 3 % 3 - 1) * stride * edges[1],
                        (step % 3 - 1) * stride * edges[2],
                    )
                    across = sx * normal[row, 0] + sy * normal[row, 1] + sz * normal[row, 2]
                    x = places[tie, 0] + sx - across * normal[row, 0]
                    y = places[tie, 1] + sy - across * normal[row, 1]
                    z = places[tie, 2] + sz - across * normal[row, 2]
                    if abs(x) > _MOVE * edges[0] or abs(y) > _MOVE * edges[1] or abs(z) > _MOVE * edges[2]:
                        continue
                    distance = _nearest(rocks, count, x, y, z, best - _SAME if found else best)
                    if distance > best + _SAME:
                        best, found = distance, 0
                    elif found == 0 or distance < best - _SAME or found == _TIES:
                        continue
                    if not _listed(better, found, x, y, z):
                        better[found, 0], better[found, 1], better[found, 2] = x, y, z
                        found += 1
            if found == 0:
                stride *= 0.5
            else:
                places, better, ties = better, places, found
        out[row] = best
    return out


@njit(cache=True, nogil=True)
def _rocks_near(
    start: NDArray[np.float64], space: PackedSpace, edges: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """Return the rock voxels, from a place in indices, that can be the nearest to any place to which it may move."""
    n0, n1, n2 = space.shape
    i, j, k = int(np.floor(start[0] + 0.5)), int(np.floor(start[1] + 0.5)), int(np.floor(start[2] + 0.5))
    more = 2.0 * _MOVE * np.sqrt((edges * edges).sum())
    rocks = np.empty((64, 3))
    count, reach, nearest = 0, 0, np.inf
    while reach <= n0 + n1 + n2 and (reach - 1.5) * edges.min() <= nearest + more:
        for a in range(max(i - reach, 0), min(i + reach + 1, n0)):
            for b in range(max(j - reach, 0), min(j + reach + 1, n1)):
                shell = abs(a - i) == reach or abs(b - j) == reach
                step = 1 if shell else max(2 * reach, 1)
                for c in range(k - reach, k + reach + 1, step):
                    x, y, z = (a - start[0]) * edges[0], (b - start[1]) * edges[1], (c - start[2]) * edges[2]
                    gap = np.sqrt(x * x + y * y + z * z)
                    if gap > nearest + more or c < 0 or c >= n2 or slot(space, (a * n1 + b) * n2 + c) >= 0:
                        continue
                    nearest = min(nearest, gap)
                    if count == len(rocks):
                        grown = np.empty((2 * count, 3))
                        grown[:count] = rocks
                        rocks = grown
                    rocks[count, 0], rocks[count, 1], rocks[count, 2] = x, y, z
                    count += 1
        reach += 1
    return rocks, count


@njit(cache=True, nogil=True)
def _listed(places: NDArray[np.float64], count: int, x: float, y: float, z: float) -> bool:
    for row in range(count):
        if abs(places[row, 0] - x) + abs(places[row, 1] - y) + abs(places[row, 2] - z) < _SAME:
            return True
    return False


@njit(cache=True, nogil=True)
def _nearest(rocks: NDArray[np.float64], count: int, px: float, py: float, pz: float, least: float) -> float:
    """Return the distance to the nearest rock, or any distance not above ``least`` if it is nearer than that.

    A rock that ended the search moves forward, so that it ends the next one sooner.
    """
    best, enough = np.inf, least * least
    for r in range(count):
        x, y, z = rocks[r, 0] - px, rocks[r, 1] - py, rocks[r, 2] - pz
        square = x * x + y * y + z * z
        if square < best:
            best = square
            if best <= enough:
                ahead = r // 2
                for axis in range(3):
                    rocks[r, axis], rocks[ahead, axis] = rocks[ahead, axis], rocks[r, axis]
                break
    return float(np.sqrt(best))


def own_saddle(
    windows: Windows,
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    levels: NDArray[np.int32],
    radius_at: NDArray[np.float64],
    edges: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Return which windows are throats of their own.

    Where three or more pores meet, two of them may touch in a strip that is widest at the edge of a third, or too thin
    for its own ball: the way through the third pore is wider, and the window is left out if that pore has windows to
    both. So it is where the window's own ball reaches into a third pore with wider windows to both, as at the middle
    of the faces of a body-centred pack, where four pores meet.
    """
    if not len(windows.first):
        return np.zeros(0, dtype=bool)
    begin = windows.start[:-1]
    area2 = sum(
        np.add.reduceat(np.where(windows.axis == a, windows.sign, 0).astype(float), begin) ** 2 for a in range(3)
    )
    strip = np.sqrt(area2) < _STRIP * np.pi * radius_at[np.maximum.reduceat(windows.level, begin)] ** 2
    third = _wider_third(windows, space, pore_of, levels, strip)
    widest = np.maximum.reduceat(windows.level, begin)
    kept = np.ones(len(third), dtype=bool)
    present: dict[tuple[int, int], int] = {}
    pairs = list(zip(windows.first.tolist(), windows.second.tolist(), strict=True))
    for pair in pairs:
        present[pair] = present.get(pair, 0) + 1
    order = np.lexsort((windows.second, windows.first, widest))
    for window in order:
        c = int(third[window])
        if c < 0:
            continue
        a, b = pairs[window]
        if present.get((min(a, c), max(a, c)), 0) and present.get((min(b, c), max(b, c)), 0):
            kept[window] = False
            present[a, b] -= 1
    level_of: dict[tuple[int, int], int] = {}
    for window in order[kept[order]]:  # the widest of a pair comes last
        level_of[pairs[window]] = int(widest[window])
    for window, others in enumerate(_in_own_balls(windows, space, pore_of, radius_at, edges, widest)):
        a, b = pairs[window]
        for c in others[others >= 0].tolist():
            ways = level_of.get((min(a, c), max(a, c)), -1), level_of.get((min(b, c), max(b, c)), -1)
            if min(ways) > widest[window]:
                kept[window] = False
    return kept


@njit(cache=True)
def _in_own_balls(
    windows: Windows,
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    radius_at: NDArray[np.float64],
    edges: NDArray[np.float64],
    widest: NDArray[np.int32],
) -> NDArray[np.int64]:
    """Return the third pores (n, _THIRDS) that the ball at the widest place of each window reaches into, then -1.

    The ball reaches to the centres of the nearest rock voxels.
    """
    n0, n1, n2 = space.shape
    start, voxel, axis, level = windows.start, windows.voxel, windows.axis, windows.level
    out = np.full((len(start) - 1, _THIRDS), -1, np.int64)
    for window in range(len(start) - 1):
        x, y, z, count = 0.0, 0.0, 0.0, 0
        for row in range(start[window], start[window + 1]):
            if level[row] == widest[window]:
                here, side = voxel[row], axis[row]
                x += here // (n1 * n2) + 0.5 * (side == 0)
                y += here // n2 % n1 + 0.5 * (side == 1)
                z += here % n2 + 0.5 * (side == 2)
                count += 1
        x, y, z = x / count, y / count, z / count
        # Places at its border belong to it, however sums are rounded.
        reach = radius_at[widest[window]] + 0.5 + 1e-6
        found = 0
        p, q, r = reach / edges[0], reach / edges[1], reach / edges[2]
        for i in range(max(int(np.ceil(x - p)), 0), min(int(x + p) + 1, n0)):
            for j in range(max(int(np.ceil(y - q)), 0), min(int(y + q) + 1, n1)):
                for k in range(max(int(np.ceil(z - r)), 0), min(int(z + r) + 1, n2)):
                    if ((i - x) / p) ** 2 + ((j - y) / q) ** 2 + ((k - z) / r) ** 2 > 1:
                        continue
                    place = slot(space, (i * n1 + j) * n2 + k)
                    if place < 0:
                        continue
                    other = pore_of[place] - 1
                    if other == windows.first[window] or other == windows.second[window] or found == _THIRDS:
                        continue
                    known = False
                    for m in range(found):
                        known = known or out[window, m] == other
                    if not known:
                        out[window, found] = other
                        found += 1
    return out


@njit(cache=True)
def _wider_third(
    windows: Windows,
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    levels: NDArray[np.int32],
    strip: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """Return the third pore that is wider at the widest place of each window, or -1."""
    n0, n1, n2 = space.shape
    start, voxel, axis, level = windows.start, windows.voxel, windows.axis, windows.level
    out = np.full(len(start) - 1, -1, np.int64)
    for window in range(len(start) - 1):
        top = level[start[window] : start[window + 1]].max()
        best = 0 if strip[window] else top
        for row in range(start[window], start[window + 1]):
            if level[row] < top:
                continue
            i, j, k = voxel[row] // (n1 * n2), voxel[row] // n2 % n1, voxel[row] % n2
            p, q, r = i + (axis[row] == 0), j + (axis[row] == 1), k + (axis[row] == 2)
            for a in range(max(i - 1, 0), min(p + 2, n0)):
                for b in range(max(j - 1, 0), min(q + 2, n1)):
                    for c in range(max(k - 1, 0), min(r + 2, n2)):
                        place = slot(space, (a * n1 + b) * n2 + c)
                        if place < 0:
                            continue
                        other = pore_of[place] - 1
                        if other == windows.first[window] or other == windows.second[window]:
                            continue
                        wider = levels[place]
                        if wider > best or (wider == best and 0 <= other < out[window]):
                            best, out[window] = wider, other
    return out

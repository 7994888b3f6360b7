"""Basins of the distance map: the pore space split at its narrowest places, before anything is merged.

Pore voxels are flooded from the widest places down, one distance at a time. A voxel that touches flooded ones joins the
basin of its widest flooded neighbour; what is left of a distance forms new basins round its connected parts. All voxels
of one round are decided before any is written, and equal peaks are ranked by their surroundings, so the result does not
depend on the orientation of the volume.

Neighbours are chosen so that basins connect exactly where pore voxels connect by faces: a voxel wider than one edge
has pore voxels at all faces, so a diagonal neighbour is reached through one of them.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace, pore_voxels, row_of_three, slot
from geofit.pores.threads import in_parts

__all__ = ["OFFSETS", "flood", "levels_of"]

#: The 26 neighbours: 6 by faces, 12 by edges, 8 by corners.
OFFSETS = np.array(
    sorted(
        ((a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1) if (a, b, c) != (0, 0, 0)),
        key=lambda offset: sum(map(abs, offset)),
    ),
    dtype=np.int64,
)
#: The lower half of a key holds this number less the basin, the upper half the level.
_BASIN = 0x7FFFFFFF
#: Voxels of a level that are worth a thread.
_LEAST = 20_000


def levels_of(
    reach2: NDArray[Any], edges: tuple[float, float, float]
) -> tuple[NDArray[np.int32], NDArray[Any], int, int]:
    """Return the distances of pore voxels as whole numbers above 0 that keep their order.

    Returns
    -------
    levels : ndarray of int32, shape of ``reach2``
    values : ndarray
        F² of each level.
    by_edges, by_corners : int
        From these levels on, a voxel is connected to its neighbours by edges, and by corners.
    """
    squares = sorted(edge * edge for edge in edges)
    if reach2.dtype.kind == "i":
        values: NDArray[Any] = np.arange(int(reach2.max(initial=0)) + 1, dtype=np.int64)
        return reach2, values, 2, 3
    values, inverse = np.unique(reach2, return_inverse=True)
    values = np.concatenate([[0.0], values])
    by_edges = int(np.searchsorted(values, squares[2], side="right"))
    by_corners = int(np.searchsorted(values, squares[2] + squares[1], side="right"))
    return (inverse + 1).astype(np.int32), values, by_edges, by_corners


def flood(
    space: PackedSpace, levels: NDArray[np.int32], by_edges: int, by_corners: int
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the basin of every pore voxel (1, 2, ...) and the flat index of each basin's peak.

    Basins are numbered from the widest peak to the narrowest.
    """
    voxels = np.empty(len(levels), space.address_type)
    pore_voxels(space, voxels)
    ranked, counts = _ranked(levels, voxels, int(levels.max(initial=0)))
    del voxels
    return _flood(space, levels, ranked, counts, by_edges, by_corners)


@njit(cache=True)
def _ranked(levels: NDArray[np.int32], voxels: NDArray[Any], highest: int) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the pore voxels from the widest level to the narrowest, and how many each level has."""
    counts = np.zeros(highest + 1, np.int64)
    for level in levels:
        counts[level] += 1
    position = np.zeros(highest + 1, np.int64)
    for level in range(highest - 1, 0, -1):
        position[level] = position[level + 1] + counts[level + 1]
    ranked = np.empty_like(voxels)
    for row in range(len(levels)):
        level = levels[row]
        ranked[position[level]] = voxels[row]
        position[level] += 1
    return ranked, counts


@njit(cache=True)
def _mixed(value: int) -> np.uint64:
    """Scatter the bits of a number (the finalizer of SplitMix64), so that sums of them hardly ever agree."""
    z = np.uint64(value) + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@njit(cache=True)
def _neighbourhood(space: PackedSpace, levels: NDArray[np.int32], here: Any, reach: int) -> np.uint64:
    """Return a number made from the levels round a voxel and its place, the same after a rotation of the volume."""
    n0, n1, n2 = space.shape
    i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
    a, b, c = abs(2 * i - n0 + 1), abs(2 * j - n1 + 1), abs(2 * k - n2 + 1)
    total = _mixed(a * a + b * b + c * c) + _mixed(-(a * b * c) - 1)
    for p in range(max(i - reach, 0), min(i + reach + 1, n0)):
        for q in range(max(j - reach, 0), min(j + reach + 1, n1)):
            for r in range(max(k - reach, 0), min(k + reach + 1, n2)):
                gap = (p - i) ** 2 + (q - j) ** 2 + (r - k) ** 2
                place = slot(space, (p * n1 + q) * n2 + r)
                total += _mixed((np.int64(levels[place]) if place >= 0 else 0) * 4096 + gap)
    return total


def _flood(
    space: PackedSpace,
    levels: NDArray[np.int32],
    ranked: NDArray[Any],
    counts: NDArray[np.int64],
    by_edges: int,
    by_corners: int,
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    # Level and basin of each flooded voxel in one number, the larger the wider: of equal levels the first basin wins.
    # Two more, so that rock at the end of the volume has a key to read.
    keys = np.zeros(len(levels) + 2, np.int64)
    found, stack = np.empty(int(counts.max()), np.int64), np.empty_like(ranked[: counts.max()])
    peaks: list[NDArray[np.int64]] = []
    basins = begin = 0
    for level in range(len(counts) - 1, 0, -1):
        if counts[level] == 0:
            continue
        end = begin + int(counts[level])
        near = OFFSETS[: 6 if level < by_edges else 18 if level < by_corners else 26]
        # First wave: all voxels of this level; later ones: what touches a voxel that the last wave gave a basin.
        wave = ranked[begin:end].copy()
        while len(wave):
            decide = partial(_decide, space, keys, wave, by_edges, by_corners, OFFSETS, found)
            in_parts(decide, len(wave), _LEAST)
            decided, left = _write(space, keys, wave, found, level, stack)
            # The next wave is looked for from the side that has fewer voxels.
            if left <= decided and len(wave) == end - begin:
                waiting = _touching(space, keys, stack, left, level, near, wave)
                wave = wave[:waiting]
            else:
                waiting = _touched(space, levels, keys, wave, decided, level, near, stack)
                wave = stack[:waiting].copy()
        # What no wider basin reaches: one basin for each connected part, ranked by its surroundings.
        new = _new_basins(space, levels, keys, ranked[begin:end], level, basins, near, stack)
        peaks.append(new)
        basins += len(new)
        begin = end
    del found, stack
    np.bitwise_and(keys, _BASIN, out=keys)
    np.subtract(_BASIN, keys, out=keys)
    return keys[: len(levels)].astype(np.int32), np.concatenate(peaks)


@njit(cache=True, nogil=True)
def _decide(
    space: PackedSpace,
    keys: NDArray[np.int64],
    wave: NDArray[Any],
    by_edges: int,
    by_corners: int,
    offsets: NDArray[np.int64],
    out: NDArray[np.int64],
    first: int,
    end: int,
) -> None:
    """Write the largest key round the voxels ``first`` ... ``end`` - 1 of a wave; no key is changed meanwhile."""
    for index in range(first, end):
        out[index] = _widest(space, keys, np.int64(wave[index]), by_edges, by_corners, offsets)


@njit(cache=True)
def _write(
    space: PackedSpace,
    keys: NDArray[np.int64],
    wave: NDArray[Any],
    found: NDArray[np.int64],
    level: int,
    open_: NDArray[Any],
) -> tuple[int, int]:
    """Flood the voxels of a wave for which a key was found, and list the others as open; return how many of each.

    The flooded ones come first in ``wave`` afterwards.
    """
    decided, left = 0, 0
    for index in range(len(wave)):
        here = wave[index]
        if found[index] > 0:
            keys[slot(space, np.int64(here))] = (level << 32) | (found[index] & _BASIN)
            wave[decided] = here
            decided += 1
        else:
            open_[left] = here
            left += 1
    return decided, left


@njit(cache=True)
def _new_basins(
    space: PackedSpace,
    levels: NDArray[np.int32],
    keys: NDArray[np.int64],
    members: NDArray[Any],
    level: int,
    first: int,
    near: NDArray[np.int64],
    stack: NDArray[Any],
) -> NDArray[np.int64]:
    """Make a basin of each connected part of a level that is not flooded yet; return the peaks in their order."""
    peaks = np.empty(64, np.int64)
    basins = 0
    for index in range(len(members)):
        seed = slot(space, np.int64(members[index]))
        if keys[seed] != 0:
            continue
        if basins == len(peaks):
            grown = np.empty(2 * basins, np.int64)
            grown[:basins] = peaks
            peaks = grown
        basins += 1
        stack[0], size, done = members[index], 1, 0
        keys[seed] = -1
        while done < size:
            size += _touched(space, levels, keys, stack[done : done + 1], 1, level, near, stack[size:])
            done += 1
        for member in range(size):
            keys[slot(space, np.int64(stack[member]))] = _key(level, first + basins)
        peaks[basins - 1] = _middle(space, levels, stack, size)
    if basins > 1:
        number = _rank_peaks(space, levels, peaks, basins)
        for index in range(len(members)):
            place = slot(space, np.int64(members[index]))
            basin = _BASIN - (keys[place] & _BASIN) - first
            if basin > 0:
                keys[place] = _key(level, first + number[basin - 1])
    return peaks[:basins].copy()


@njit(cache=True)
def _key(level: int, basin: int) -> int:
    return (level << 32) | (_BASIN - basin)


@njit(cache=True, nogil=True)
def _widest(
    space: PackedSpace,
    keys: NDArray[np.int64],
    here: Any,
    by_edges: int,
    by_corners: int,
    offsets: NDArray[np.int64],
) -> int:
    """Return the largest key of the flooded neighbours that a voxel is connected to, 0 if there is none."""
    n0, n1, n2 = space.shape
    i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
    inside = 0 < i < n0 - 1 and 0 < j < n1 - 1 and 0 < k < n2 - 1
    # A flooded voxel is at least as wide as this one: it decides what its edges and corners connect.
    by_edges, by_corners = by_edges << 32, by_corners << 32
    best = 0
    if inside:
        for a in range(-1, 2):
            for b in range(-1, 2):
                there, three = row_of_three(space, here + (a * n1 + b) * n2)
                far = abs(a) + abs(b)
                beside = by_edges if far == 1 else by_corners if far == 2 else 0
                middle = by_edges if far == 2 else 0
                # Without branches, which the processor could not foresee: rock counts as a key of 0.
                low, mid, high = three & 1, three >> 1 & 1, three >> 2
                key = keys[there] * low
                best = max(best, key if key >= beside else 0)
                key = keys[there + low] * mid
                best = max(best, key if key >= middle else 0)
                key = keys[there + low + mid] * high
                best = max(best, key if key >= beside else 0)
        return best
    for d in range(26):
        a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
        if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
            continue
        there = slot(space, (a * n1 + b) * n2 + c)
        if there >= 0 and keys[there] >= (0 if d < 6 else by_edges if d < 18 else by_corners):
            best = max(best, keys[there])
    return best


@njit(cache=True)
def _touching(
    space: PackedSpace,
    keys: NDArray[np.int64],
    open_: NDArray[Any],
    count: int,
    level: int,
    offsets: NDArray[np.int64],
    out: NDArray[Any],
) -> int:
    """Write those of the first ``count`` open voxels that touch a flooded voxel of their level; return how many."""
    n0, n1, n2 = space.shape
    found = 0
    for index in range(count):
        here = np.int64(open_[index])
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        for d in range(len(offsets)):
            a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
            if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                continue
            there = slot(space, (a * n1 + b) * n2 + c)
            if there >= 0 and keys[there] >> 32 == level:
                out[found] = here
                found += 1
                break
    return found


@njit(cache=True)
def _touched(
    space: PackedSpace,
    levels: NDArray[np.int32],
    keys: NDArray[np.int64],
    flooded: NDArray[Any],
    count: int,
    level: int,
    offsets: NDArray[np.int64],
    out: NDArray[Any],
) -> int:
    """Write the open voxels of a level that touch the first ``count`` flooded ones, each once, and mark them by -1."""
    n0, n1, n2 = space.shape
    found = 0
    for index in range(count):
        here = np.int64(flooded[index])
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        for d in range(len(offsets)):
            a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
            if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                continue
            there = slot(space, (a * n1 + b) * n2 + c)
            if there >= 0 and keys[there] == 0 and levels[there] == level:
                keys[there] = -1
                out[found] = (a * n1 + b) * n2 + c
                found += 1
    return found


@njit(cache=True)
def _middle(space: PackedSpace, levels: NDArray[np.int32], members: NDArray[Any], size: int) -> int:
    """Return the voxel of a plateau that is nearest to its centroid; of several, by their surroundings."""
    if size == 1:
        return int(members[0])
    _, n1, n2 = space.shape
    si, sj, sk = 0, 0, 0
    for index in range(size):
        here = np.int64(members[index])
        si, sj, sk = si + here // (n1 * n2), sj + here // n2 % n1, sk + here % n2
    best, nearest, key = np.int64(members[0]), np.int64(-1), np.uint64(0)
    for index in range(size):
        here = np.int64(members[index])
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        gap = (size * i - si) ** 2 + (size * j - sj) ** 2 + (size * k - sk) ** 2
        if nearest < 0 or gap < nearest:
            best, nearest, key = here, gap, _neighbourhood(space, levels, here, 2)
        elif gap == nearest:
            other = _neighbourhood(space, levels, here, 2)
            if other < key:
                best, key = here, other
    return int(best)


@njit(cache=True)
def _rank_peaks(
    space: PackedSpace, levels: NDArray[np.int32], peaks: NDArray[np.int64], count: int
) -> NDArray[np.int32]:
    """Sort the first peaks, all of one level, by their surroundings; return the new number of each, from 1."""
    keys = np.empty(count, np.uint64)
    for index in range(count):
        keys[index] = _neighbourhood(space, levels, peaks[index], 2)
    order = np.argsort(keys)
    peaks[:count] = peaks[:count][order].copy()
    number = np.empty(count, np.int32)
    for place in range(count):
        number[order[place]] = 1 + place
    return number

"""Basins of the distance map: the pore space split at its narrowest places, before anything is merged.

Pore voxels are flooded from the widest places down, one distance at a time. A voxel that touches flooded ones joins the
basin of its widest flooded neighbour; what is left of a distance forms new basins round its connected parts. All voxels
of one round are decided before any is written, and equal peaks are ranked by their surroundings, so the result does not
depend on the orientation of the volume.

Neighbours are chosen so that basins connect exactly where pore voxels connect by faces: a voxel wider than one edge
has pore voxels at all faces, so a diagonal neighbour is reached through one of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace, pore_voxels, slot

__all__ = ["OFFSETS", "flood", "levels_of"]

#: The 26 neighbours: 6 by faces, 12 by edges, 8 by corners.
OFFSETS = np.array(
    sorted(
        ((a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1) if (a, b, c) != (0, 0, 0)),
        key=lambda offset: sum(map(abs, offset)),
    ),
    dtype=np.int64,
)


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
    label = np.zeros(len(levels), np.int32)
    peaks = _flood(space, levels, ranked, counts, by_edges, by_corners, OFFSETS, label)
    return label, peaks


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


@njit(cache=True)
def _flood(
    space: PackedSpace,
    levels: NDArray[np.int32],
    ranked: NDArray[Any],
    counts: NDArray[np.int64],
    by_edges: int,
    by_corners: int,
    offsets: NDArray[np.int64],
    label: NDArray[np.int32],
) -> NDArray[np.int64]:
    n0, n1, n2 = space.shape
    steps = offsets[:, 0] * (n1 * n2) + offsets[:, 1] * n2 + offsets[:, 2]
    wave = np.empty_like(ranked[: counts.max()])
    found = np.empty(len(wave), np.int32)
    stack = np.empty_like(wave)
    peaks = np.empty(1024, np.int64)
    basins = 0
    begin = 0
    for level in range(len(counts) - 1, 0, -1):
        end = begin + counts[level]
        # First wave: all voxels of this level; later ones: what touches a voxel that the last wave gave a basin.
        waiting = counts[level]
        for index in range(waiting):
            wave[index] = ranked[begin + index]
        while waiting > 0:
            decided = 0
            for index in range(waiting):
                here = np.int64(wave[index])
                i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
                inside = 0 < i < n0 - 1 and 0 < j < n1 - 1 and 0 < k < n2 - 1
                best_level, best = 0, 0
                for d in range(26):
                    if not inside:
                        a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
                        if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                            continue
                    there = slot(space, here + steps[d])
                    if there < 0:
                        continue
                    basin = label[there]
                    if basin <= 0:
                        continue
                    other = levels[there]
                    if d >= 6 and max(other, level) < (by_edges if d < 18 else by_corners):
                        continue
                    if other > best_level or (other == best_level and basin < best):
                        best_level, best = other, basin
                if best > 0:
                    wave[decided], found[decided] = here, best
                    decided += 1
            for index in range(decided):
                label[slot(space, np.int64(wave[index]))] = found[index]
            # The next wave; a voxel waits once, marked by -1.
            waiting = 0
            for index in range(decided):
                here = np.int64(wave[index])
                i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
                for d in range(6 if level < by_edges else 18 if level < by_corners else 26):
                    a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
                    if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                        continue
                    there = slot(space, here + steps[d])
                    if there >= 0 and levels[there] == level and label[there] == 0:
                        label[there] = -1
                        stack[waiting] = here + steps[d]
                        waiting += 1
            for index in range(waiting):
                wave[index] = stack[index]
        # What no wider basin reaches: one basin for each connected part, ranked by its surroundings.
        first = basins
        for index in range(begin, end):
            seed = slot(space, np.int64(ranked[index]))
            if label[seed] != 0:
                continue
            if basins == len(peaks):
                grown = np.empty(2 * basins, np.int64)
                grown[:basins] = peaks
                peaks = grown
            basins += 1
            stack[0], size = ranked[index], 1
            label[seed] = basins
            done = 0
            while done < size:
                here = np.int64(stack[done])
                done += 1
                i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
                for d in range(6 if level < by_edges else 18 if level < by_corners else 26):
                    a, b, c = i + offsets[d, 0], j + offsets[d, 1], k + offsets[d, 2]
                    if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                        continue
                    there = slot(space, here + steps[d])
                    if there >= 0 and levels[there] == level and label[there] == 0:
                        label[there] = basins
                        stack[size] = here + steps[d]
                        size += 1
            peaks[basins - 1] = _middle(space, levels, stack, size)
        if basins > first + 1:
            _rank_peaks(space, levels, label, ranked, begin, end, peaks, first, basins)
        begin = end
    return peaks[:basins].copy()


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
    space: PackedSpace,
    levels: NDArray[np.int32],
    label: NDArray[np.int32],
    ranked: NDArray[Any],
    begin: int,
    end: int,
    peaks: NDArray[np.int64],
    first: int,
    last: int,
) -> None:
    """Give the basins ``first`` ... ``last`` of one level numbers by the surroundings of their peaks."""
    keys = np.empty(last - first, np.uint64)
    for index in range(first, last):
        keys[index - first] = _neighbourhood(space, levels, peaks[index], 2)
    order = np.argsort(keys)
    sorted_peaks = peaks[first:last][order].copy()
    peaks[first:last] = sorted_peaks
    number = np.empty(last - first, np.int32)
    for place in range(len(order)):
        number[order[place]] = first + 1 + place
    for index in range(begin, end):
        place = slot(space, np.int64(ranked[index]))
        if label[place] > first:
            label[place] = number[label[place] - first - 1]

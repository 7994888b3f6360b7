"""The compiled scans of the exact distance map."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["scan_envelopes", "scan_rows"]

#: Columns gathered at a time: one cache line of the volume serves several of them.
_TILE = 32


@njit(cache=True, nogil=True)
def scan_rows(pore: NDArray[np.bool_], square: Any, farthest: Any, wall: bool, out: NDArray[Any]) -> None:
    """Write the squared distance to the nearest rock of the same row (last axis)."""
    n0, n1, n2 = pore.shape
    far = n0 + n1 + n2
    reach = np.empty(n2, np.int64)
    for i in range(n0):
        for j in range(n1):
            last = -1 if wall else -far
            for k in range(n2):
                if not pore[i, j, k]:
                    last = k
                reach[k] = k - last
            last = n2 if wall else n2 + far
            for k in range(n2 - 1, -1, -1):
                if not pore[i, j, k]:
                    last = k
                step = min(reach[k], last - k)
                out[i, j, k] = min(square * step * step, farthest) if step < far else farthest


@njit(cache=True, nogil=True)
def scan_envelopes(field: NDArray[Any], square: Any, farthest: Any, wall: bool) -> None:
    """Replace ``field`` by its lower envelope of parabolas along the first axis, in place."""
    n, rows, columns = field.shape
    lines = np.empty((_TILE, n), field.dtype)
    site = np.empty(n + 2, np.int64)
    height = np.empty(n + 2, field.dtype)
    start = np.empty(n + 2, np.int64)
    for row in range(rows):
        for left in range(0, columns, _TILE):
            width = min(_TILE, columns - left)
            for i in range(n):
                for c in range(width):
                    lines[c, i] = field[i, row, left + c]
            for c in range(width):
                line = lines[c]
                i = 0
                while i < n:
                    if line[i] == 0:
                        i += 1
                        continue
                    first = i
                    while i < n and line[i] != 0:
                        i += 1
                    _envelope(line, first, i, n, square, farthest, wall, site, height, start)
            for i in range(n):
                for c in range(width):
                    field[i, row, left + c] = lines[c, i]


@njit(cache=True, nogil=True)
def _envelope(
    line: NDArray[Any],
    first: int,
    end: int,
    n: int,
    square: Any,
    farthest: Any,
    wall: bool,
    site: NDArray[np.int64],
    height: NDArray[Any],
    start: NDArray[np.int64],
) -> None:
    """Take the envelope over the run ``first <= i < end``, which rock (or the sample's face) ends on both sides."""
    count = 0
    for u in range(first - 1, end + 1):
        if first <= u < end:
            value = line[u]
            if value >= farthest:
                continue
        else:
            if (u < 0 or u >= n) and not wall:
                continue
            value = line[0] * 0
        begin = first
        while count > 0:
            v = site[count - 1]
            # The new parabola is the lower one right of this place.
            begin = int((value - height[count - 1] + square * (u * u - v * v)) // (2 * square * (u - v))) + 1
            if begin > start[count - 1]:
                break
            count -= 1
            begin = first
        if begin < end:
            site[count], height[count], start[count] = u, value, max(begin, first)
            count += 1
    if count == 0:
        return
    part = count - 1
    for i in range(end - 1, first - 1, -1):
        while part > 0 and start[part] > i:
            part -= 1
        line[i] = min(height[part] + square * (i - site[part]) * (i - site[part]), farthest)

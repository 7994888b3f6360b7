"""Compiled: the sums of very many points over the cells of a mesh.

The terms are those of :mod:`geofit.splines.sums`; the points of a cell are looked up and summed together, and none is
copied. Loading the compiled code takes longer than summing a few thousand points without it.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["add_points"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points of a cell whose polynomials are held together.
TOGETHER = 256


@njit(cache=True, nogil=True, error_model="numpy")
def _interval(lines: Floats, bins: Ints, x: float) -> int:
    """Return the interval of a place, from that at the start of its bin on; the outermost hold what lies beyond."""
    last = len(lines) - 2
    share = (x - lines[0]) / (lines[last + 1] - lines[0])
    k = bins[int(min(max(share, 0.0), 1.0) * (len(bins) - 1))]
    while k < last and x >= lines[k + 1]:
        k += 1
    return int(k)


@njit(cache=True, nogil=True, error_model="numpy")
def _grow(rows: Floats, t: Floats, n: int) -> None:
    """Fill rows, of which the first two are given, with the Legendre polynomials at n places: Bonnet's recurrence."""
    for k in range(1, len(rows) - 1):
        ahead, back = (2 * k + 1) / (k + 1), k / (k + 1)
        for i in range(n):
            rows[k + 1, i] = ahead * t[i] * rows[k, i] - back * rows[k - 1, i]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _product(a: Floats, b: Floats, n: int) -> float:
    total = 0.0
    for i in range(n):
        total += a[i] * b[i]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def _in_cells(cell: Ints, cells: int) -> tuple[Ints, Ints]:
    """Return the rows by their cells, each cell's in their order, and where those of each cell end."""
    ends = np.zeros(cells + 1, np.int64)
    for k in cell:
        ends[k + 1] += 1
    for k in range(cells):
        ends[k + 1] += ends[k]
    order = np.empty(len(cell), np.int64)
    for i, k in enumerate(cell):
        order[ends[k]] = i
        ends[k] += 1
    return order, ends[:-1]


@njit(cache=True, nogil=True, error_model="numpy")
def add_points(
    sums: Floats,
    lines_u: Floats,
    lines_v: Floats,
    bins_u: Ints,
    bins_v: Ints,
    plane: Floats,
    z: Floats,
    weight: Floats,
) -> None:
    """Add points to sums (k, m, 2p + 1, 3p + 2) of Legendre polynomials, those with the heights last.

    ``bins_u`` and ``bins_v`` lead to the cells (:func:`geofit.splines.bspline.bins`).
    """
    along, all_across, across = sums.shape[2], sums.shape[3], len(lines_v) - 1
    cell = np.empty(len(z), np.int64)
    for i in range(len(z)):
        cell[i] = _interval(lines_u, bins_u, plane[i, 0]) * across + _interval(lines_v, bins_v, plane[i, 1])
    order, ends = _in_cells(cell, (len(lines_u) - 1) * across)
    of_u, of_v = np.empty((along, TOGETHER)), np.empty((all_across, TOGETHER))
    at_u, at_v = np.empty(TOGETHER), np.empty(TOGETHER)
    low = 0
    for k in range(len(ends)):
        cu, cv = k // across, k % across
        middle_u, half_u = (lines_u[cu] + lines_u[cu + 1]) / 2, (lines_u[cu + 1] - lines_u[cu]) / 2
        middle_v, half_v = (lines_v[cv] + lines_v[cv + 1]) / 2, (lines_v[cv + 1] - lines_v[cv]) / 2
        for start in range(low, ends[k], TOGETHER):
            n = min(TOGETHER, ends[k] - start)
            for i in range(n):
                row = order[start + i]
                at_u[i], at_v[i] = (plane[row, 0] - middle_u) / half_u, (plane[row, 1] - middle_v) / half_v
                of_u[0, i], of_u[1, i] = weight[row], weight[row] * at_u[i]
                of_v[0, i], of_v[1, i] = 1.0, at_v[i]
            _grow(of_u, at_u, n)
            _grow(of_v[:along], at_v, n)
            for j in range(all_across - along):
                for i in range(n):
                    of_v[along + j, i] = of_v[j, i] * z[order[start + i]]
            for i in range(along):
                for j in range(all_across):
                    sums[cu, cv, i, j] += _product(of_u[i], of_v[j], n)
        low = ends[k]

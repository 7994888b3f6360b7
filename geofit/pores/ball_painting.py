"""Balls painted into a grid: their union and the balls that suffice for it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["covering", "farthest_squares", "paint_union"]


@njit(cache=True)
def _half_width(rest: float, square: float) -> int:
    """Return the largest w with square * w² < rest, or -1."""
    # Rock at exactly F² is outside; rounding of edges that are not whole numbers must not let it in.
    rest -= 1e-9
    if rest <= 0.0:
        return -1
    w = int(np.sqrt(rest / square))
    while square * w * w >= rest:
        w -= 1
    while square * (w + 1) * (w + 1) < rest:
        w += 1
    return w


@njit(cache=True)
def paint_union(
    centre: NDArray[np.int32], reach2: NDArray[np.float64], squares: NDArray[np.float64], out: NDArray[np.bool_]
) -> None:
    """Set the voxels nearer than F to a centre."""
    n0, n1, n2 = out.shape
    for ball in range(len(centre)):
        i, j, k = centre[ball]
        h0 = _half_width(reach2[ball], squares[0])
        for a in range(max(i - h0, 0), min(i + h0 + 1, n0)):
            rest0 = reach2[ball] - squares[0] * (a - i) ** 2
            h1 = _half_width(rest0, squares[1])
            for b in range(max(j - h1, 0), min(j + h1 + 1, n1)):
                h2 = _half_width(rest0 - squares[1] * (b - j) ** 2, squares[2])
                for c in range(max(k - h2, 0), min(k + h2 + 1, n2)):
                    out[a, b, c] = True


def covering(reach2: NDArray[Any], squares: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the flat indices of the balls that cover, from large to small, a voxel no earlier ball covers.

    A ball inside another one is smaller, comes later, and covers nothing new: what is left is a subset of the maximal
    balls, whatever the voxel's edges.
    """
    flat = reach2.ravel()
    ranked = np.flatnonzero(flat)
    ranked = ranked[np.argsort(-flat[ranked], kind="stable")]
    covered = np.zeros(reach2.shape, dtype=bool)
    return ranked[_cover(reach2.astype(np.float64, copy=False), ranked, squares, covered)]


@njit(cache=True)
def _cover(
    reach2: NDArray[np.float64], ranked: NDArray[np.int64], squares: NDArray[np.float64], covered: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    n0, n1, n2 = reach2.shape
    kept = np.zeros(len(ranked), np.bool_)
    for rank in range(len(ranked)):
        here = ranked[rank]
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        own = reach2[i, j, k]
        h0 = _half_width(own, squares[0])
        for a in range(max(i - h0, 0), min(i + h0 + 1, n0)):
            rest0 = own - squares[0] * (a - i) ** 2
            h1 = _half_width(rest0, squares[1])
            for b in range(max(j - h1, 0), min(j + h1 + 1, n1)):
                h2 = _half_width(rest0 - squares[1] * (b - j) ** 2, squares[2])
                for c in range(max(k - h2, 0), min(k + h2 + 1, n2)):
                    if not covered[a, b, c]:
                        covered[a, b, c] = True
                        kept[rank] = True
    return kept


@njit(cache=True)
def farthest_squares(reach2: NDArray[np.float64], squares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return R² of each ball: the squared distance of its farthest voxel."""
    out = np.zeros(len(reach2), np.float64)
    for ball in range(len(reach2)):
        h0 = _half_width(reach2[ball], squares[0])
        for a in range(h0 + 1):
            rest0 = reach2[ball] - squares[0] * a * a
            h1 = _half_width(rest0, squares[1])
            for b in range(h1 + 1):
                c = _half_width(rest0 - squares[1] * b * b, squares[2])
                out[ball] = max(out[ball], squares[0] * a * a + squares[1] * b * b + squares[2] * c * c)
    return out

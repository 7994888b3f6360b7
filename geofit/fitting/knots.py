"""Where knots go: as fine as the data need, and no finer (METHOD, sec. 4: knots must follow the data)."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import Delaunay, QhullError

__all__ = ["graded_breaks", "neighbour_pairs", "pair_sizes", "some_breaks"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: How fast the spans may grow with the distance from a fine place.
GROWTH = 0.5
_SAMPLES = 4000


def neighbour_pairs(plane: Floats) -> Ints:
    """Return (m, 2) indices of points that are neighbours in the Delaunay triangulation.

    Collinear points are neighbours of the next along their line.
    """
    try:
        triangles = Delaunay(plane).simplices
    except (QhullError, ValueError):
        centred = plane - plane.mean(axis=0)
        along = centred @ np.linalg.svd(centred, full_matrices=False)[2][0]
        order = np.argsort(along, kind="stable")
        return np.column_stack([order[:-1], order[1:]])
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(edges, axis=1), axis=0)


def pair_sizes(plane: Floats, pairs: Ints, axis: int, factor: float) -> Floats:
    """Return (m, 3) rows (low, high, size): between two neighbours, spans no longer than ``factor`` x their gap.

    A pair asks this of the direction in which it is farther apart: two points of a section lie beside each
    other along it, two points of neighbouring sections across it.
    """
    first, second = plane[pairs[:, 0]], plane[pairs[:, 1]]
    gap = np.abs(second - first)
    mine = gap[:, axis] > gap[:, 1 - axis]
    low = np.minimum(first[mine, axis], second[mine, axis])
    return np.column_stack([low, low + gap[mine, axis], factor * gap[mine, axis]])


def graded_breaks(required: ArrayLike, largest: float, sizes: Floats) -> Floats:
    """Return ascending breaks through the ``required`` ones, their spans following a size function.

    Parameters
    ----------
    required : (k,) array_like
        Breaks that must stand: the ends, the seams, the section lines.
    largest : float
        Longest span.
    sizes : (m, 3) array
        Rows (low, high, size): the spans between low and high are at most ``size`` long.
    """
    required = np.unique(np.asarray(required, float))
    x = np.linspace(required[0], required[-1], _SAMPLES + 1)
    step = x[1] - x[0]
    size = np.full(_SAMPLES, largest)
    middle = (x[1:] + x[:-1]) / 2
    first = np.maximum(np.searchsorted(middle, sizes[:, 0]) - 1, 0).tolist()
    last = np.searchsorted(middle, sizes[:, 1]).tolist()
    for low, high, limit in zip(first, last, sizes[:, 2].tolist(), strict=True):
        part = size[low : high + 1]
        np.minimum(part, limit, out=part)
    grown = GROWTH * step * np.arange(_SAMPLES)
    size = np.minimum.accumulate(size - grown) + grown
    size = (np.minimum.accumulate((size - grown[::-1])[::-1]) + grown)[::-1]
    spent = np.concatenate([[0.0], np.cumsum(step / size)])
    breaks = [required[:1]]
    for low, high in itertools.pairwise(required):
        start, end = np.interp((low, high), x, spent)
        count = max(int(np.ceil(end - start - 1e-6)), 1)
        inner = np.interp(np.linspace(start, end, count + 1)[1:-1], spent, x)
        breaks += [inner, np.array([high])]
    return np.concatenate(breaks)


def some_breaks(breaks: Floats, least: float) -> Floats:
    """Return as few of ascending breaks as leave no span longer than ``least`` that is not one of theirs already."""
    chosen = [0]
    for k in range(1, len(breaks) - 1):
        if breaks[k + 1] - breaks[chosen[-1]] > least:
            chosen.append(k)
    return breaks[[*chosen, len(breaks) - 1]]

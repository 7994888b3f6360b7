"""The convex hull of places in a plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

__all__ = ["within_hull"]

Floats = NDArray[np.float64]


def within_hull(points: Floats, places: Floats) -> NDArray[np.bool_]:
    """Return which (k, 2) places lie within the hull of (n, 2) points; points without an area contain no place.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    >>> within_hull(corners, np.array([[1.0, 1.0], [3.0, 3.0]])).tolist()
    [True, False]
    >>> within_hull(corners[:2], np.array([[1.0, 0.0]])).tolist()
    [False]
    """
    try:
        return np.asarray(Delaunay(points).find_simplex(places) >= 0)
    except (QhullError, ValueError):
        return np.zeros(len(places), bool)

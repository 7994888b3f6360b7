"""The convex hull of places in a plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay, QhullError

__all__ = ["hull_corners", "within_hull"]

Floats = NDArray[np.float64]


def hull_corners(points: Floats) -> Floats:
    """Return the (k, 2) corners of the hull of (n, 2) points; those of points in a row are its ends.

    Examples
    --------
    >>> len(hull_corners(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0]])))
    4
    >>> hull_corners(np.array([[0.0, 0.0], [2.0, 1.0], [4.0, 2.0]])).tolist()
    [[0.0, 0.0], [4.0, 2.0]]
    """
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return points[np.lexsort(points.T)[[0, -1]]]


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

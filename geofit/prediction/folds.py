"""Which points are left out together: a hole, a section, or all of a square block."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay, QhullError

from geofit.data.points import PointSet

__all__ = ["beyond_hull", "block_labels", "groups_of", "hole_labels"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Strings = NDArray[np.str_]


def hole_labels(points: PointSet) -> Strings:
    """Return the (n,) hole of each point; a point of neither hole nor section is a hole of its own.

    Points of a section that no hole supports have none: they are left out with their section.
    """
    alone = np.array([f"#{k + 1}" for k in range(len(points))], dtype=np.str_)
    return np.where((points.hole == "") & (points.section == ""), alone, points.hole)


def block_labels(plane: Floats, size: float) -> Strings:
    """Return the (n,) names of square blocks, ``size`` wide, that the (n, 2) places lie in."""
    cell = np.floor((plane - plane.min(axis=0)) / size).astype(int)
    return np.array([f"{i}-{j}" for i, j in cell], dtype=np.str_)


def groups_of(labels: Strings) -> list[Ints]:
    """Return the numbers of the points of each label, labels in order; the empty label is not a group."""
    names, index = np.unique(labels, return_inverse=True)
    order = np.argsort(index, kind="stable")
    parts = np.split(order, np.cumsum(np.bincount(index, minlength=len(names)))[:-1])
    return [part.astype(np.int64) for name, part in zip(names, parts, strict=True) if name]


def beyond_hull(plane: Floats, groups: Sequence[Ints]) -> NDArray[np.bool_]:
    """Tell which (n,) points lie beyond the convex hull of all points that are not in their group."""
    outside = np.zeros(len(plane), bool)
    try:
        corner = np.zeros(len(plane), bool)
        corner[ConvexHull(plane).vertices] = True
    except (QhullError, ValueError):
        return outside
    for group in groups:
        if not corner[group].any():
            continue
        rest = np.delete(plane, group, axis=0)
        try:
            outside[group] = Delaunay(rest).find_simplex(plane[group]) < 0
        except (QhullError, ValueError):
            outside[group] = True
    return outside

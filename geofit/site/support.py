"""Where a surface is supported: below the ground, and within the hull of its points. Elsewhere it is drawn faded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from geofit.data.site import Ground

__all__ = ["Support", "support_of"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Points whose best plane is steeper than this are looked at across it, not in plan, degrees.
STEEP = 60.0
#: A surface this far above the ground is still on it: outcrops are mapped where the ground is, metres.
ROOM = 0.5


@dataclass(frozen=True, eq=False)
class Support:
    """The hull of a horizon's points in a plane, and the ground over it.

    Parameters
    ----------
    middle : (3,) array
        Where the plane passes, map coordinates.
    axes : (2, 3) array
        Unit vectors of the plane: east and north, or those of the best plane of steep points.
    sides : (k, 3) array
        Sides of the hull: outward unit normals in the plane and offsets, n . p + offset <= 0 inside; none where the
        points have no area.
    ground : Ground or None
        The topography; None: nothing is above it.
    """

    middle: Floats
    axes: Floats
    sides: Floats
    ground: Ground | None

    def depth(self, xyz: Floats) -> Floats:
        """Return how far (k, 3) places lie within the hull and below the ground, metres; negative where they do not."""
        depth = np.full(len(xyz), np.inf)
        if len(self.sides):
            plane = (xyz - self.middle) @ self.axes.T
            depth = -(plane @ self.sides[:, :2].T + self.sides[:, 2]).max(axis=1)
        if self.ground is not None:
            over = self.ground.elevation(xyz[:, 0], xyz[:, 1]) + ROOM - xyz[:, 2]
            depth = np.minimum(depth, np.where(np.isfinite(over), over, np.inf))
        return depth

    def within(self, xyz: Floats) -> Bools:
        """Return which (k, 3) places, map coordinates, lie within the hull and not above the ground."""
        return np.asarray(self.depth(xyz) >= 0)


def support_of(xyz: Floats, ground: Ground | None = None) -> Support:
    """Return where the surface through (n, 3) points is supported; points without an area support it everywhere.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0, 5.0], [9.0, 0.0, 5.0], [0.0, 9.0, 5.0]])
    >>> support_of(corners).within(np.array([[1.0, 1.0, 5.0], [8.0, 8.0, 5.0]])).tolist()
    [True, False]
    """
    middle = xyz.mean(axis=0) if len(xyz) else np.zeros(3)
    axes = np.eye(3)[:2]
    if len(xyz) >= 3:
        principal = np.linalg.svd((xyz - middle) if len(xyz) <= 5000 else (xyz - middle)[:: len(xyz) // 5000], False)[2]
        if abs(principal[2, 2]) < np.cos(np.radians(STEEP)):
            axes = principal[:2]
    plane = (xyz - middle) @ axes.T
    try:
        sides = np.unique(ConvexHull(plane).equations, axis=0)
    except (QhullError, ValueError):
        sides = np.empty((0, 3))
    return Support(middle, axes, sides, ground)

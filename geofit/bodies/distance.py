"""Signed orthogonal distance to the surface of a body."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field
from geofit.implicit.foot import foot_points
from geofit.implicit.mesh import TriangleMesh

__all__ = ["body_distance"]

Floats = NDArray[np.float64]
#: Of the last step, relative; blended fields are exact to some nanometres only.
TOLERANCE = 1e-8


def body_distance(field: Field, xyz: Floats, size: float, surface: Callable[[], TriangleMesh]) -> Floats:
    """Return the distances (n,) of (n, 3) places to the surface on which a field is zero, positive outside.

    The iteration for the foot point starts at the place itself where that is near the surface, else at the nearest
    vertex of a mesh of the surface.

    Parameters
    ----------
    field : Field
        The field.
    xyz : (n, 3) array
        Places in the field's coordinates.
    size : float
        Length in metres over which the surface is about flat; steps along it are not longer.
    surface : callable
        Returns a mesh of the surface; called only where places are far from it.
    """
    from scipy.spatial import cKDTree

    if not len(xyz):
        return np.zeros(0)
    value, gradient = field.value(xyz), field.gradient(xyz)
    sign = np.where(value < 0, -1.0, 1.0)
    foot = xyz.copy()
    far = np.flatnonzero(np.abs(value) > 0.1 * size * np.linalg.norm(gradient, axis=1))
    if len(far):
        vertices = surface().vertices
        if not len(vertices):
            return sign * np.inf
        foot[far] = vertices[cKDTree(vertices).query(xyz[far])[1]]
    found = foot_points(field, xyz, start=foot, reach=size, tolerance=TOLERANCE)
    return found.distance

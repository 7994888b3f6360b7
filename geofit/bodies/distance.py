"""Signed orthogonal distance to the surface of a body."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.mesh import Mesh
from geofit.geometry.mesh_projection import nearest_on_mesh
from geofit.implicit.field import Field
from geofit.implicit.foot import foot_points, project_along_gradient
from geofit.implicit.mesh import TriangleMesh

__all__ = ["body_distance", "wall_of"]

Floats = NDArray[np.float64]
#: Of the last step, relative; blended fields are exact to some nanometres only.
TOLERANCE = 1e-8
#: A place within this share of ``size`` of the surface is near it, by the first order of the field.
NEAR = 0.1
#: A place within this share of ``size`` of a foot point lies on the surface.
ON = 1e-7


def body_distance(field: Field, xyz: Floats, size: float, surface: Callable[[], TriangleMesh]) -> Floats:
    """Return the distances (n,) of (n, 3) places to the surface on which a field is zero, positive outside.

    The iteration for the foot point starts at the place itself where that is near the surface, else at the nearest
    vertex of a mesh of the surface. Where it does not converge, or ends farther away than it started, it starts again
    at the nearest place of the mesh's triangles, moved onto the surface; if that fails too, the distance is that of
    this place. The first end remains where it is nearer: a mesh lacks parts of the body that are smaller than its
    cells, and rounding of the field alone keeps an iteration from converging.

    Parameters
    ----------
    field : Field
        The field.
    xyz : (n, 3) array
        Places in the field's coordinates.
    size : float
        Length in metres over which the surface is about flat; steps along it are not longer.
    surface : callable
        Returns a mesh of the surface without caps (:func:`wall_of`); called only where places are far from it.
    """
    from scipy.spatial import cKDTree

    if not len(xyz):
        return np.zeros(0)
    sign = np.where(field.value(xyz) < 0, -1.0, 1.0)
    start = xyz.copy()
    far = np.flatnonzero(~_near(field, xyz, size))
    if len(far):
        wall = surface()
        if not len(wall.triangles):
            return sign * np.inf
        vertices = wall.vertices[np.unique(wall.triangles)]
        start[far] = vertices[cKDTree(vertices).query(xyz[far])[1]]
    distance, end = _walked(field, xyz, start, size)
    again = np.flatnonzero(np.isnan(distance))
    if len(again):
        places, first = xyz[again], end[again]
        found = np.linalg.norm(places - first, axis=1) + _offset(field, first)
        if len((wall := surface()).triangles):
            start = project_along_gradient(field, _nearest(wall, places, size), reach=NEAR * size)
            walked, _ = _walked(field, places, start, size)
            missed = np.isnan(walked)
            walked[missed] = np.linalg.norm(places - start, axis=1)[missed]
            found = np.fmin(found, walked)
        distance[again] = found
    return np.asarray(sign * distance)


def wall_of(field: Field, mesh: TriangleMesh, size: float) -> TriangleMesh:
    """Return the triangles whose corners are all near the surface: caps, as at the faces of a sample, are not."""
    return TriangleMesh(mesh.vertices, mesh.triangles[_near(field, mesh.vertices, size)[mesh.triangles].all(axis=1)])


def _near(field: Field, xyz: Floats, size: float) -> NDArray[np.bool_]:
    return np.asarray(_offset(field, xyz) <= NEAR * size)


def _offset(field: Field, xyz: Floats) -> Floats:
    """Return how far (n,) places are from the surface, by the first order of the field."""
    value, slope = np.abs(field.value(xyz)), np.linalg.norm(field.gradient(xyz), axis=1)
    return np.asarray(np.divide(value, slope, out=np.where(value > 0, np.inf, 0.0), where=slope > 0))


def _nearest(wall: TriangleMesh, xyz: Floats, size: float) -> Floats:
    """Return the nearest places (n, 3) of triangles."""
    # In units of the size: the projection takes places within 1e-9 m of each other for one.
    count = len(wall.triangles)
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    mesh = Mesh(wall.vertices / size, wall.triangles, patch, uv, np.zeros(3), ("",))
    return np.asarray(nearest_on_mesh(mesh, xyz / size).foot * size)


def _walked(field: Field, xyz: Floats, start: Floats, size: float) -> tuple[Floats, Floats]:
    """Return the distances (n,) of places from the foot points found from a start, NaN where none was, and its ends.

    The start is near the surface, so the nearest place of the surface is hardly farther away than the start.
    """
    found = foot_points(field, xyz, start=start, reach=size, tolerance=TOLERANCE)
    distance = np.abs(found.distance)
    most = np.linalg.norm(xyz - start, axis=1) + 2 * NEAR * size
    # Where a field is constant, the iteration converges off the surface.
    off = _offset(field, found.xyz)
    good = found.converged & (distance <= most) & (off <= NEAR * size)
    # On a contact, rounding of the field keeps the iteration from converging; no other start ends nearer.
    good |= distance + off <= ON * size
    return np.where(good, distance, np.nan), found.xyz

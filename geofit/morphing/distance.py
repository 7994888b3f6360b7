"""Signed distances of the nodes of a lattice from a body: a closed mesh, or a field."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field
from geofit.implicit.grid import SplineGrid, spline_grid
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice, sample
from geofit.implicit.mesh import TriangleMesh

__all__ = ["Samples", "both_distances", "distances", "front_distances", "redistanced", "samples_of"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Feet are found to this part of a spacing.
TOLERANCE = 1e-7
#: Feet that start on triangles are done at a step of this part: the next one would be about its square.
POLISHED = 1e-3
#: Beyond the bodies this many spacings get both distances: the front starts there.
RIM = 5.0
#: Layers of nodes around the way of a front that get both distances, too: their slopes are wanted at its ends.
BEYOND = 4
#: A polished distance must lie this near to that from the triangles, in spacings: triangles err by less.
TRUSTED = 0.25


class Samples:
    """A body on a lattice: its nodes inside, its triangles, and for fields the spline through its samples."""

    def __init__(self, lattice: Lattice, inside: Bools, mesh: TriangleMesh, spline: SplineGrid | None) -> None:
        self.lattice, self.inside, self.mesh, self.spline = lattice, inside, mesh, spline


def samples_of(body: Field | TriangleMesh, lattice: Lattice) -> Samples:
    """Return a body on a lattice; triangles are oriented so that their volume is positive."""
    if isinstance(body, TriangleMesh):
        from geofit.morphing.triangle_loops import winding_inside

        mesh = body if body.volume >= 0 else TriangleMesh(body.vertices, body.triangles[:, ::-1])
        inside = winding_inside(_places(mesh, lattice), mesh.triangles, lattice.shape).reshape(lattice.shape)
        return Samples(lattice, inside, mesh, None)
    values = sample(body, lattice)
    spline = spline_grid(values, lattice)
    return Samples(lattice, values < 0, isosurface(spline, lattice, capped=True), spline)


def distances(body: Samples, wanted: Bools, band: float = 8.0, tolerance: float = TOLERANCE) -> Floats:
    """Return the signed distances of the nodes from the surface of a body, metres, negative inside.

    Parameters
    ----------
    body : Samples
        The body.
    wanted : (nx, ny, nz) array of bool
        Nodes that need their distance although they are far from the surface.
    band : float
        Nodes nearer than this, in spacings, get theirs anyway; the others get ``band``, with their sign.
    tolerance : float
        Feet are found to this part of a spacing.
    """
    from geofit.morphing.triangle_loops import spread_triangles

    lattice = body.lattice
    places = _places(body.mesh, lattice)
    near, owner = spread_triangles(
        places, body.mesh.triangles, lattice.shape, np.ascontiguousarray(wanted.ravel()), band
    )
    known = owner >= 0
    distance = np.where(known, near.astype(np.float64), band)
    distance[~wanted.ravel()] = np.minimum(distance[~wanted.ravel()], band)
    if body.spline is not None:
        from geofit.morphing.foot_loops import polish_feet

        at = np.flatnonzero(known & (wanted.ravel() | (near < band)))
        points = np.stack(np.unravel_index(at, lattice.shape), axis=1).astype(np.float64)
        start = _feet(points, places[body.mesh.triangles[owner[at]]])
        polished, done = polish_feet(points, start, _padded(body.spline), tolerance)
        trusted = done & (np.abs(polished - distance[at]) < TRUSTED)
        distance[at] = np.where(trusted, polished, distance[at])
    sign = np.where(body.inside.ravel(), -1.0, 1.0)
    return np.asarray((lattice.spacing * sign * distance).reshape(lattice.shape))


def both_distances(a: Samples, b: Samples) -> tuple[Floats, Floats]:
    """Return the signed distances (nx, ny, nz) from two bodies, metres, exact in both of them and around them."""
    either = a.inside | b.inside
    d_a = distances(a, either)
    d_b = distances(b, either | (np.abs(d_a) < RIM * a.lattice.spacing))
    return d_a, d_b


def front_distances(a: Samples, b: Samples) -> tuple[Floats, Floats]:
    """Return the signed distances (nx, ny, nz) from two bodies, metres, exact on the way of a front and around it."""
    way = _widened(a.inside ^ b.inside, BEYOND)
    d_a = distances(a, way, tolerance=POLISHED)
    d_b = distances(b, way | (np.abs(d_a) < RIM * a.lattice.spacing), tolerance=POLISHED)
    return d_a, d_b


def _widened(nodes: Bools, layers: int) -> Bools:
    """Return the nodes within some layers of others along the axes and diagonals."""
    wide = nodes.copy()
    for axis in range(3):
        lines, before = np.moveaxis(wide, axis, 0), np.moveaxis(wide, axis, 0).copy()
        for k in range(1, layers + 1):
            lines[k:] |= before[:-k]
            lines[:-k] |= before[k:]
    return wide


def redistanced(values: Floats, lattice: Lattice, band: float) -> Floats:
    """Return the signed distances from where samples are zero, metres, within ``band`` spacings; beyond it a bound.

    Notes
    -----
    Foot points on the tricubic spline: order 4, so the surface stays where it is (M. Elsey & S. Esedoglu, 2012).
    """
    from geofit.morphing.foot_loops import ring_distances

    scaled = np.asarray(values / lattice.spacing)
    spline = spline_grid(scaled, lattice)
    distance, _ = ring_distances(scaled, _padded(spline), band, TOLERANCE)
    return np.asarray(distance * lattice.spacing)


def _padded(spline: SplineGrid) -> Floats:
    """Coefficients as the loops take them: node i is between coefficients i and i + 2."""
    return np.asarray(spline.coefficients)


def _places(mesh: TriangleMesh, lattice: Lattice) -> Floats:
    return np.asarray((mesh.vertices - lattice.origin) / lattice.spacing)


def _feet(points: Floats, corners: Floats) -> Floats:
    """Return the nearest places (n, 3) of triangles (n, 3, 3) to points."""
    from geofit.morphing.triangle_loops import nearest_places

    return np.asarray(nearest_places(points, np.ascontiguousarray(corners)))

"""Closed triangles of the part of a body in a box, from cells that fill the box exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Box, Field, range_in
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh

__all__ = ["mesh_in_box"]

Floats = NDArray[np.float64]


def mesh_in_box(field: Field, lower: Floats, upper: Floats, spacing: float, *, slivers: bool = False) -> TriangleMesh:
    """Return the surface of a body in a box, capped at the faces of the box.

    Parameters
    ----------
    field : Field
        Negative inside.
    lower, upper : (3,) array
        Corners of the box, metres.
    spacing : float
        Edge of the cells, metres. Along each axis it is changed so that a whole number of cells, the nearest one, fills
        the box: samples are rarely whole numbers of cubes in size, and their faces are part of the body.
    slivers : bool
        Leave triangles without area in the mesh.
    """
    counts = np.maximum(np.rint((upper - lower) / spacing).astype(int), 1)
    stretch = (upper - lower) / (counts * spacing)
    lattice = Lattice(lower / stretch, spacing, (int(counts[0]) + 1, int(counts[1]) + 1, int(counts[2]) + 1))
    mesh = isosurface(_Stretched(field, stretch), lattice, capped=True, slivers=slivers)
    return TriangleMesh(mesh.vertices * stretch, mesh.triangles)


@dataclass(frozen=True, eq=False)
class _Stretched:
    """A field of coordinates that are divided by a factor along each axis: cubes there are cells of any edges here."""

    field: Field
    stretch: Floats

    def value(self, xyz: Floats) -> Floats:
        return self.field.value(xyz * self.stretch)

    def gradient(self, xyz: Floats) -> Floats:
        return self.field.gradient(xyz * self.stretch) * self.stretch

    @property
    def bounds(self) -> Box:
        lower, upper = self.field.bounds
        return lower / self.stretch, upper / self.stretch

    @property
    def lipschitz(self) -> float:
        return self.field.lipschitz * float(self.stretch.max())

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        return range_in(self.field, lower * self.stretch, upper * self.stretch)

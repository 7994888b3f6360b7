"""Closed triangles as a body that a STEP file can be compared with: they are its surface, to the last bit.

A field on a lattice would not do: a layer between two horizons is thinner than its cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.mesh import Mesh
from geofit.geometry.mesh_projection import nearest_on_mesh
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.volume import Extent
from geofit.morphing.body import MorphBody

__all__ = ["TriangleBody", "plain_mesh", "triangle_body"]

Floats = NDArray[np.float64]

#: Cells along the longest side of the lattice that a body of a metamorphosis has to have; nothing is taken from it.
CELLS = 96


@dataclass(frozen=True, eq=False)
class TriangleBody(MorphBody):
    """A body whose surface is its triangles: nothing between them is curved."""

    @cached_property
    def size(self) -> Extent:
        """Volume and area of the triangles."""
        return Extent(self.overview.volume, self.overview.area)


@dataclass(frozen=True, eq=False)
class _Distance:
    """The distance from triangles about their origin: a field, as far as the read-back of a file needs one."""

    mesh: Mesh
    lipschitz: float = 1.0

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        return self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)

    def value(self, xyz: Floats) -> Floats:
        return np.asarray(nearest_on_mesh(self.mesh, xyz).distance)

    def gradient(self, xyz: Floats) -> Floats:
        return np.tile([0.0, 0.0, 1.0], (len(xyz), 1))


def triangle_body(mesh: TriangleMesh, origin: Floats, name: str) -> TriangleBody:
    """Return closed triangles about an origin as a body of a name."""
    lattice = Lattice.around(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0), cells=CELLS)
    return TriangleBody(name, 0.0, 0.0, None, _Distance(plain_mesh(mesh, origin, name)), origin, lattice, mesh, mesh)


def plain_mesh(mesh: TriangleMesh, origin: Floats, name: str) -> Mesh:
    """Return triangles as those of a surface of one patch, for the exporters."""
    count = len(mesh.triangles)
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    return Mesh(mesh.vertices, mesh.triangles, patch, uv, np.asarray(origin, float), (name,))

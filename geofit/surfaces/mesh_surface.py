"""A surface that is triangles itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import measurable_places
from geofit.data.given import arguments_checked
from geofit.geometry.mesh import Mesh, Tolerance
from geofit.geometry.mesh_projection import mesh_elevation, nearest_on_mesh
from geofit.geometry.projection import Projection
from geofit.geometry.trim_loops import Loops
from geofit.splines.patch import Patch

__all__ = ["MeshSurface"]

Floats = NDArray[np.float64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class MeshSurface:
    """A triangle mesh of a file as a surface; it has no patches."""

    mesh: Mesh
    name: str = "surface"

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {len(self.mesh.triangles)} triangles>"

    @property
    def patches(self) -> tuple[Patch, ...]:
        """No NURBS patches."""
        return ()

    @property
    def loops(self) -> Loops:
        """No trim loops."""
        return ()

    @property
    def origin(self) -> Floats:
        """Offset that turns the vertices into map coordinates, metres."""
        return self.mesh.origin

    @property
    def outline(self) -> Floats | None:
        """No outline: the triangles end where they end."""
        return None

    @property
    def frame(self) -> str:
        """Unknown: triangles may be a height field or not."""
        return ""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Box of the vertices, map coordinates."""
        return self.mesh.xyz.min(axis=0), self.mesh.xyz.max(axis=0)

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside, the highest of several; arrays broadcast."""
        return mesh_elevation(self.mesh, x, y)

    def project(self, xyz: ArrayLike) -> Projection:
        """Return the nearest triangles of (n, 3) map coordinates; they have no parameters."""
        return nearest_on_mesh(self.mesh, measurable_places(xyz) - self.origin)

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed distance of (n, 3) map coordinates to the nearest triangle, metres, positive above."""
        return self.project(xyz).distance

    def triangulate(self, tolerance: Tolerance = 0.05) -> Mesh:
        """Return the mesh itself, whatever the tolerance."""
        return self.mesh

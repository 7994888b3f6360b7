"""A surface of NURBS patches about a local origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import measurable_places
from geofit.data.given import arguments_checked
from geofit.data.threads import one_thread
from geofit.geometry.elevation import elevation
from geofit.geometry.mesh import Mesh, Tolerance, triangulate, trim_to_outline
from geofit.geometry.projection import Projection, project
from geofit.geometry.trim_loops import Loops
from geofit.splines.patch import Patch, Patches

__all__ = ["PatchSurface"]

Floats = NDArray[np.float64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class PatchSurface:
    """NURBS patches that share edges.

    Parameters
    ----------
    patches : tuple of Patch
        The core first, if there is one.
    origin : (3,) array
        Offset that turns the patches' coordinates into map coordinates, metres.
    name : str
        Name of the surface.
    outline : (k, 2) array or None
        Plan polygon (map coordinates, not closed) that trims the surface; None: not trimmed.
    frame : str
        In which frame it is a height field: "map", "best-plane", "sections" (in none) or "" (unknown).
    """

    patches: tuple[Patch, ...]
    origin: Floats
    name: str = "surface"
    outline: Floats | None = None
    frame: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "patches", Patches.of(self.patches))

    def __repr__(self) -> str:
        n = len(self.patches)
        return f"<{type(self).__name__} {self.name}: {n} patch{'' if n == 1 else 'es'}>"

    @property
    def loops(self) -> Loops:
        """Trim loops of each patch: none."""
        return ((),) * len(self.patches)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Box of the control points, which contains the patches, map coordinates."""
        poles = np.concatenate([patch.control.reshape(-1, 3) for patch in self.patches]) + self.origin
        return poles.min(axis=0), poles.max(axis=0)

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside; arrays broadcast.

        Where the surface lies over a place more than once (an overturned fold), the highest.
        """
        return elevation(self.patches, self.origin, self.outline, x, y)

    def project(self, xyz: ArrayLike) -> Projection:
        """Return the foot points of (n, 3) map coordinates; see :func:`geofit.geometry.projection.project`."""
        return project(self.patches, measurable_places(xyz) - self.origin)

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance of (n, 3) map coordinates, metres, positive above."""
        return self.project(xyz).distance

    def triangulate(self, tolerance: Tolerance = 0.05) -> Mesh:
        """Return triangles within a tolerance (m); see :func:`geofit.geometry.mesh.triangulate`."""
        # A second thread waits longer for the many small products than it works.
        with one_thread():
            mesh = triangulate(self.patches, self.origin, tolerance)
            return mesh if self.outline is None else trim_to_outline(mesh, self.patches, self.outline)

"""What every surface can do, whatever made it: a fit, a file, triangles, an implicit body."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from geofit.data.accuracy import Accuracy, Partition
    from geofit.data.points import PointSet
    from geofit.data.settings import FitSettings
    from geofit.geometry.foot_points import Projection
    from geofit.geometry.mesh import Mesh, Tolerance
    from geofit.geometry.trim_loops import Loops
    from geofit.splines.patch import Patch

__all__ = ["FittedSurface", "Frame", "HasElevation", "Surface"]

Floats = NDArray[np.float64]

#: In which frame a surface is a height field: over the map, over its best plane, or in none ("sections": a folded
#: surface through section curves; "": unknown, as for surfaces that were read from a file).
Frame = str


class HasElevation(Protocol):
    """A surface, a horizon or the ground as a height over the map."""

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Height at map coordinates, nan outside; arrays broadcast."""


class Surface(Protocol):
    """A surface in map coordinates, metres.

    Checks, reports, exporters and windows ask nothing else of a surface.
    """

    @property
    def name(self) -> str:
        """Name of the surface."""

    @property
    def patches(self) -> tuple[Patch, ...]:
        """NURBS patches about ``origin``; none for triangles."""

    @property
    def origin(self) -> Floats:
        """Offset (3,) of the patches' or triangles' coordinates, metres."""

    @property
    def outline(self) -> Floats | None:
        """Plan polygon (k, 2) in map coordinates that ends the surface."""

    @property
    def loops(self) -> Loops:
        """Trim loops of each patch in its parameters."""

    @property
    def frame(self) -> Frame:
        """Frame in which the surface is a height field."""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates, (3,) each, of a box that contains the surface."""

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Height at map coordinates, nan outside, the highest of several; arrays broadcast."""

    def project(self, xyz: ArrayLike) -> Projection:
        """Foot points of (n, 3) map coordinates, with signed orthogonal distances."""

    def distance(self, xyz: ArrayLike) -> Floats:
        """Signed orthogonal distance of (n, 3) map coordinates, positive above."""

    def triangulate(self, tolerance: Tolerance = 0.05) -> Mesh:
        """Triangles that leave the surface by at most about ``tolerance`` metres."""


class FittedSurface(Surface, Protocol):
    """A surface with the points and settings by which it is judged: what checks and exporters need of a fit."""

    @property
    def points(self) -> PointSet:
        """Points that the surface was fitted to, or is judged by."""

    @property
    def settings(self) -> FitSettings:
        """Settings that hold its tolerances."""

    @property
    def partition(self) -> Partition | None:
        """The split into core and periphery."""

    @property
    def core(self) -> NDArray[np.bool_]:
        """Which points it meets exactly, (n,)."""

    @property
    def diagnostics(self) -> Mapping[str, Any]:
        """Figures of the fit."""

    @property
    def accuracy(self) -> Accuracy | None:
        """Its check."""

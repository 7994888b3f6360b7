"""What writers ask of a body, whatever made it: a fit, a metamorphosis, the pore space of a rock, a cave, metaballs."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.volume import Extent

__all__ = ["ClosedBody"]

Floats = NDArray[np.float64]


class ClosedBody(Protocol):
    """A closed body: the places where its field is negative, in metres about ``origin``."""

    @property
    def name(self) -> str:
        """Name of the body."""

    @property
    def field(self) -> Field:
        """The field about ``origin``, negative inside."""

    @property
    def origin(self) -> Floats:
        """Map coordinates (3,) of the local origin, metres."""

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about ``origin``, metres."""

    @property
    def epsilon(self) -> float:
        """Distance in metres that a file may have from the body."""

    @property
    def contacts(self) -> Floats:
        """Measured places (n, 3) of the surface, map coordinates; may be none."""

    @property
    def overview(self) -> TriangleMesh:
        """Closed triangles of moderate size about ``origin``."""

    @property
    def size(self) -> Extent:
        """Volume and area with their numerical errors, m3 and m2."""

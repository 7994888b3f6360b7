"""What cuts, patches and STEP files need of a body, however it was made."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field
from geofit.implicit.mesh import TriangleMesh

__all__ = ["ClosedBody"]

Floats = NDArray[np.float64]


class ClosedBody(Protocol):
    """A closed body with a field and triangles about a local origin."""

    @property
    def name(self) -> str:
        """Name."""
        ...

    @property
    def origin(self) -> Floats:
        """Map coordinates (3,) of the local origin, metres."""
        ...

    @property
    def field(self) -> Field:
        """The field about the local origin, negative inside."""
        ...

    @property
    def overview(self) -> TriangleMesh:
        """Closed triangles about the local origin."""
        ...

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin."""
        ...

    @property
    def epsilon(self) -> float:
        """Distance that a file may have from the body, metres."""
        ...

    @property
    def contacts(self) -> Floats:
        """Measured places (n, 3) of its surface, map coordinates; may be none."""
        ...

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return closed triangles about the local origin at a spacing in metres."""
        ...

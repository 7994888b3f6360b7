"""Bodies of closed triangles: of a file, or closed between horizons."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.mesh import TriangleMesh

if TYPE_CHECKING:
    from geofit.data.messages import Message
    from geofit.morphing.between import BetweenSurfaces

__all__ = ["MeshBody", "read_mesh_body"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeshBody:
    """Closed triangles about a local origin: of a file, or between horizons. Nothing was fitted or is judged.

    ``notes`` are what a reader of the body must know.
    """

    name: str
    origin: Floats
    overview: TriangleMesh
    contacts: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    epsilon: float = 0.5
    #: The field of a body that was closed between horizons, and a hash of their elevations.
    closed: BetweenSurfaces | None = None
    digest: str = ""
    notes: tuple[Message, ...] = ()

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin."""
        return self.overview.vertices.min(axis=0), self.overview.vertices.max(axis=0)

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return the triangles as they are: a mesh of a file has no other spacing."""
        return self.overview


def read_mesh_body(file: Path, name: str) -> MeshBody:
    """Read a closed body from a file; triangles that are inside out are reversed, and a note reports it.

    Raises
    ------
    InputError
        If the file cannot be read.
    MorphError
        If the mesh is open or inconsistent; the error names edges.
    """
    from geofit.io.bodies import read_body
    from geofit.morphing.ends import require_closed
    from geofit.morphing.notes import turned_note

    mesh = read_body(file)
    require_closed(mesh, name)
    origin = np.round((mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2, -1)
    local = TriangleMesh(mesh.vertices - origin, mesh.triangles)
    if local.volume >= 0:
        return MeshBody(name, origin, local)
    return MeshBody(name, origin, TriangleMesh(local.vertices, local.triangles[:, ::-1]), notes=(turned_note(name),))

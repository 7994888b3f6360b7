"""A frame of a metamorphosis: a body like any other, with its share of the way and its date."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import FitError, SettingsError
from geofit.data.messages import Message, message
from geofit.implicit.field import Field
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh

if TYPE_CHECKING:
    from geofit.bodies.cut import BodyPiece
    from geofit.cad.solid import SolidReadBack

__all__ = ["GEOMETRY_ONLY", "MorphBody"]

Floats = NDArray[np.float64]

#: What every picture and table of interpolated frames has to say.
GEOMETRY_ONLY = message(
    "morphing.geometry-only",
    "Frames between surveys are geometry, not a record of the process: between surveys nothing is known. The volume is "
    "interpolated, and the shape is one of many.",
)
#: Cells of a mesh along the longest side of the body, at most.
MOST = 1024


@dataclass(frozen=True, eq=False)
class MorphBody:
    """The body at one moment between two surveys. Coordinates of its meshes are map coordinates in metres.

    Parameters
    ----------
    name : str
        Name.
    tau : float
        Share of the way from the first body to the last, 0 to 1, in the chosen pace.
    s : float
        Share of the way between its two surveys as the front measures it: 1 - exp(-t).
    date : datetime.date or None
        Its date, where the surveys have one.
    field : Field
        Negative inside, about ``origin``; of an end the field itself.
    origin : (3,) array
        Map coordinates of the local origin, metres.
    lattice : Lattice
        Nodes of the metamorphosis, about ``origin``.
    given : object
        The body that was given, if this is an end; else None.
    given_mesh : TriangleMesh or None
        Its triangles about ``origin``, if it was given as a mesh.
    """

    name: str
    tau: float
    s: float
    date: date | None
    field: Field
    origin: Floats
    lattice: Lattice
    given: Any = None
    given_mesh: TriangleMesh | None = None

    def __repr__(self) -> str:
        when = f", {self.date.isoformat()}" if self.date else ""
        return f"<MorphBody {self.name}: tau {self.tau:.4g}{when}>"

    @property
    def epsilon(self) -> float:
        """Distance that a file may have from the body, metres: half a spacing of the lattice."""
        return self.lattice.spacing / 2

    @property
    def contacts(self) -> Floats:
        """None: no place of its surface was measured."""
        return np.zeros((0, 3))

    @property
    def interpolated(self) -> bool:
        """Whether the body lies between surveys: geometry, not a record."""
        return self.given is None

    @property
    def note(self) -> Message | None:
        """What must be said of an interpolated frame; None for a survey itself."""
        return GEOMETRY_ONLY if self.interpolated else None

    @cached_property
    def overview(self) -> TriangleMesh:
        """Closed triangles about the local origin at the spacing of the metamorphosis; those given for a mesh."""
        if self.given_mesh is not None:
            return self.given_mesh
        return isosurface(self.field, self.lattice, capped=True)

    @cached_property
    def mesh(self) -> TriangleMesh:
        """The same triangles in map coordinates; of an end that was given as a mesh, that mesh."""
        if isinstance(self.given, TriangleMesh):
            return self.given
        return TriangleMesh(self.overview.vertices + self.origin, self.overview.triangles)

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return self.overview.volume

    @property
    def area(self) -> float:
        """Area, m2."""
        return float(self.overview.areas.sum())

    @property
    def euler(self) -> int:
        """Euler number of the surface: 2 for a ball, 0 for a ring."""
        return self.overview.euler

    @property
    def components(self) -> int:
        """Number of closed surfaces, cavities included."""
        return self.overview.components

    @cached_property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin, two spacings larger than it."""
        if not len(self.overview.vertices):
            raise FitError(message("morphing.frame-empty", "The body '{name}' is empty.", name=self.name))
        room = 2 * self.lattice.spacing
        return self.overview.vertices.min(axis=0) - room, self.overview.vertices.max(axis=0) + room

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field (n,) at (n, 3) places: negative inside, near the surface about the distance in metres."""
        return self.field.value(self._local(xyz))

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradient (n, 3) of the field at (n, 3) places; it points outwards."""
        return self.field.gradient(self._local(xyz))

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance (n,) of (n, 3) places to the surface, metres, positive outside."""
        from geofit.bodies.distance import signed_distance

        return signed_distance(self.field, self._local(xyz), self.lattice.spacing, lambda: self.overview)

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return closed triangles about the local origin at another spacing, metres."""
        lower, upper = self.extent
        longest = float((upper - lower).max())
        if not np.isfinite(spacing) or spacing <= 0 or longest / spacing > MOST:
            raise SettingsError(
                message(
                    "bodies.spacing-cannot-used",
                    "A spacing of {spacing} m cannot be used for a body {size:.1f} m long: give {least:.3g} m or more.",
                    spacing=spacing,
                    size=longest,
                    least=longest / MOST,
                )
            )
        counts = np.maximum(np.ceil((upper - lower) / spacing).astype(int), 1) + 4
        start = (lower + upper) / 2 - counts * spacing / 2
        shape = (int(counts[0]) + 1, int(counts[1]) + 1, int(counts[2]) + 1)
        return isosurface(self.field, Lattice(start, spacing, shape), capped=True)

    def triangulate(self, spacing: float | None = None) -> TriangleMesh:
        """Return closed triangles in map coordinates, by default those of :attr:`mesh`."""
        if spacing is None:
            return self.mesh
        mesh = self.local_mesh(spacing)
        return TriangleMesh(mesh.vertices + self.origin, mesh.triangles)

    def cut(self, surfaces: Mapping[str, Any] | Sequence[Any], spacing: float | None = None) -> tuple[BodyPiece, ...]:
        """Return the closed pieces into which surfaces cut the body; see :func:`geofit.bodies.cut.cut_body`."""
        from geofit.bodies.cut import cut_body

        return cut_body(self, surfaces, spacing)

    def write_step(self, path: str | PathLike[str], nurbs: bool = True) -> SolidReadBack:
        """Write the body as a STEP AP242 solid, read it back, and return what the reader found.

        Parameters
        ----------
        path : path
            The file, usually ``*.step``.
        nurbs : bool
            NURBS patches within half a spacing of the surface; otherwise, and where patches cannot follow the body, a
            tessellated solid.
        """
        from geofit.bodies.creased import write_solid
        from geofit.cad.solid import write_body

        return write_solid(self, path) if nurbs and self.given_mesh is None else write_body(self, path)

    def _local(self, xyz: ArrayLike) -> Floats:
        return np.asarray(np.atleast_2d(np.asarray(xyz, float)).reshape(-1, 3) - self.origin)

"""A frame of a metamorphosis: a body like any other, with its share of the way and its date."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.implicit_body import ImplicitBody
from geofit.data.errors import FitError
from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message
from geofit.implicit.field import Field
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.parts import solid_parts

if TYPE_CHECKING:
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.cad.step_origin import StepFields

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


@arguments_checked
@dataclass(frozen=True, eq=False)
class MorphBody(ImplicitBody):
    """The body at one moment between two surveys. Coordinates of its meshes are map coordinates in metres.

    Parameters
    ----------
    name : str
        Name.
    tau : float
        Progress from the first body to the last, 0 to 1, in the chosen pace.
    s : float
        Progress between its two surveys as the front measures it: 1 - exp(-t).
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
    def spacing(self) -> float:
        """Spacing of the lattice, metres: over about this length the surface is flat."""
        return self.lattice.spacing

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
        """Number of separate parts; cavities within them are not counted."""
        return solid_parts(self.overview)

    @cached_property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin, two spacings larger than it."""
        if not len(self.overview.vertices):
            raise FitError(message("morphing.frame-empty", "The body '{name}' is empty.", name=self.name))
        room = 2 * self.lattice.spacing
        return self.overview.vertices.min(axis=0) - room, self.overview.vertices.max(axis=0) + room

    def triangulate(self, spacing: float | None = None) -> TriangleMesh:
        """Return closed triangles in map coordinates, by default those of :attr:`mesh`."""
        return self.mesh if spacing is None else super().triangulate(spacing)

    def write_step(self, path: str | PathLike[str], nurbs: bool = True, **stated: Unpack[StepFields]) -> SolidReadBack:
        """Write the body as a STEP AP242 solid; an end that was given as triangles stays triangles."""
        return super().write_step(path, nurbs=nurbs and self.given_mesh is None, **stated)

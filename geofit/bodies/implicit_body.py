"""What every closed body can do, however it was made: values, distances, triangles, cuts, STEP."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, ClassVar, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import measurable_places
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.numbers import is_finite
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.volume import Extent, curved_extent

if TYPE_CHECKING:
    from geofit.bodies.cut import BodyPiece, CuttingSurface
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.cad.step_origin import StepFields
    from geofit.implicit.field import Field

__all__ = ["ImplicitBody", "OwnField"]

Floats = NDArray[np.float64]

#: Cells of the overview mesh along the longest side of the body.
OVERVIEW = 48
#: Numerical error of a volume that is good enough, and the most cells that are taken for it along the sides of a cube.
EXACT = 1e-3
FINEST = 192
#: Share of the volume by which flat triangles may differ from it: those of 48 cells lack up to 0.01 of a planted body.
SHOWN = 0.02


@arguments_checked
class ImplicitBody:
    """A closed body: the places where a field is negative. Coordinates are map coordinates in metres.

    A fit to drill holes is one (:class:`geofit.BodyFit`), and so are a frame of a metamorphosis, the pore space of a
    rock, a body of metaballs and the passages of a cave. Each kind has

    - ``name``;
    - ``field``, a :class:`geofit.implicit.field.Field` about ``origin``, (3,) map coordinates;
    - ``extent``, the corners (3,) of a box around the body about ``origin``;
    - ``spacing``, a length in metres over which its surface is about flat.
    """

    #: The most cells that a mesh may have along the longest side.
    most_cells: ClassVar[int] = 1024

    if TYPE_CHECKING:  # at run time a dataclass would take a property for the default of its field

        @property
        def name(self) -> str:
            """Name."""

        @property
        def field(self) -> Field:
            """The field about ``origin``, negative inside."""

        @property
        def origin(self) -> Floats:
            """Map coordinates (3,) of the local origin, metres."""

        @property
        def extent(self) -> tuple[Floats, Floats]:
            """Corners (3,) of a box around the body about ``origin``."""

        @property
        def spacing(self) -> float:
            """Length in metres over which the surface is about flat."""

    @property
    def epsilon(self) -> float:
        """Distance in metres that a file may have from the body."""
        return self.spacing / 2

    @property
    def contacts(self) -> Floats:
        """Measured places (n, 3) of the surface, map coordinates; may be none."""
        return np.zeros((0, 3))

    @property
    def cut_sides(self) -> tuple[str, ...]:
        """Sides of its box at which the body is cut: it has sharp edges there."""
        return ()

    @property
    def overview_spacing(self) -> float:
        """Edge of the overview's cells, metres."""
        lower, upper = self.extent
        return float((upper - lower).max()) / OVERVIEW

    @cached_property
    def overview(self) -> TriangleMesh:
        """Closed triangles of moderate size about the local origin, made once."""
        return self.local_mesh(self.overview_spacing)

    @cached_property
    def size(self) -> Extent:
        """Volume and area of the body with their numerical errors, m3 and m2.

        From triangles that are curved as the surface is (:func:`geofit.implicit.curved_extent`): flat ones lie within
        it where it bulges. The error is a third of what cells twice as wide change; where it is more than a thousandth
        of the volume, or no cell shows the body, smaller cells than those of the overview are taken. Where the
        smallest do not suffice either, as in a body thinner than they are, the error is all that they change.
        """
        return self._measured(self.overview)[0]

    def _measured(self, mesh: TriangleMesh) -> tuple[Extent, TriangleMesh]:
        """Return the size, and the first mesh, from that of the overview's cells on, that encloses about the volume."""
        lower, upper = self.extent
        least = max(float(np.cbrt(np.prod(upper - lower))) / FINEST, float((upper - lower).max()) / self.most_cells)
        spacing, meshes = self.overview_spacing, [mesh]
        coarse = curved_extent(self.field, self.local_mesh(2 * spacing))
        fine = curved_extent(self.field, mesh)
        while rough := abs(fine.volume - coarse.volume) / 3 >= EXACT * fine.volume:
            spacing /= 2
            if spacing < least:
                break
            meshes.append(self.local_mesh(spacing))
            coarse, fine = fine, curved_extent(self.field, meshes[-1])
        share = 1 if rough else 3
        off = abs(fine.volume - coarse.volume) / share, abs(fine.area - coarse.area) / share
        shown = (one for one in meshes if abs(one.volume - fine.volume) <= SHOWN * fine.volume)
        return Extent(fine.volume, fine.area, *off), next(shown, meshes[-1])

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field (n,) at (n, 3) places: negative inside; metres are what :meth:`distance` gives."""
        return self.field.value(self._local(xyz))

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradient (n, 3) of the field at (n, 3) places; it points outwards."""
        return self.field.gradient(self._local(xyz))

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance (n,) of (n, 3) places to the surface, metres, positive outside."""
        from geofit.bodies.distance import body_distance

        return body_distance(self.field, self._local(xyz), self.spacing, lambda: self._wall)

    @cached_property
    def _wall(self) -> TriangleMesh:
        """The overview without caps: where the body ends at a side of its box, that side is not part of its surface."""
        from geofit.bodies.distance import wall_of

        return wall_of(self.field, self.overview, self.spacing)

    def triangulate(self, spacing: float | None = None) -> TriangleMesh:
        """Return the surface as a closed triangle mesh in map coordinates.

        Parameters
        ----------
        spacing : float, optional
            Edge of the cells in metres; by default that of the overview.

        Raises
        ------
        SettingsError
            If the spacing is not a length, gives too many cells along a side, or is so large that no cell shows the
            body.
        """
        mesh = self.mesh_at(spacing)
        return TriangleMesh(mesh.vertices + self.origin, mesh.triangles)

    def mesh_at(self, spacing: float | None) -> TriangleMesh:
        """Return the same mesh about the local origin; errors as :meth:`triangulate`."""
        mesh = self.overview if spacing is None else self.local_mesh(spacing)
        if not len(mesh.triangles) and len(self.overview.triangles):
            raise SettingsError(
                message(
                    "bodies.spacing-misses-body",
                    "Cells of {spacing} m do not show the body at all: give {most:.3g} m or less.",
                    spacing=spacing,
                    most=self.overview_spacing,
                )
            )
        return mesh

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return triangles about the local origin, where coordinates keep all digits; none if cells miss the body."""
        lower, upper = self.extent
        longest = float((upper - lower).max())
        if not is_finite(spacing) or spacing <= 0 or longest / spacing > self.most_cells:
            raise SettingsError(
                message(
                    "bodies.spacing-unusable",
                    "A spacing of {spacing} m cannot be used for a body {size:.1f} m long: give {least:.3g} m or more.",
                    spacing=spacing,
                    size=longest,
                    least=longest / self.most_cells,
                )
            )
        return self._mesh_of_cells(spacing)

    def cut(
        self,
        surfaces: Mapping[str, CuttingSurface] | Sequence[CuttingSurface] | CuttingSurface,
        spacing: float | None = None,
    ) -> tuple[BodyPiece, ...]:
        """Return the closed pieces into which surfaces cut the body; see :func:`geofit.bodies.cut.cut_body`."""
        from geofit.bodies.cut import cut_body

        return cut_body(self, surfaces, spacing)

    def write_step(self, path: str | PathLike[str], nurbs: bool = True, **stated: Unpack[StepFields]) -> SolidReadBack:
        """Write the body as a STEP AP242 solid, read it back, and return what the reader found.

        Parameters
        ----------
        path : path
            The file, usually ``*.step``.
        nurbs : bool
            NURBS patches within :attr:`epsilon` of the surface; otherwise, and where patches cannot follow the body, a
            tessellated solid.
        **stated : StepFields
            ``author`` and ``organisation`` for the file's head; ``origin``: "map", "local" or the project datum (3,) in
            map coordinates, metres, as for :func:`geofit.cad.step.write_step`; ``colour``, ``#rrggbb``.
        """
        from geofit.bodies.creased import write_solid
        from geofit.cad.solid import write_body

        return write_solid(self, path, **stated) if nurbs else write_body(self, path, **stated)

    def _mesh_of_cells(self, spacing: float) -> TriangleMesh:
        """Return triangles from cubes of an edge that cover the body's box, and two more around it."""
        lower, upper = self.extent
        counts = np.maximum(np.ceil((upper - lower) / spacing).astype(int), 1) + 4
        start = (lower + upper) / 2 - counts * spacing / 2
        lattice = Lattice(start, spacing, (int(counts[0]) + 1, int(counts[1]) + 1, int(counts[2]) + 1))
        return isosurface(self.field, lattice, capped=True, near=self._known_surface(spacing))

    def _known_surface(self, spacing: float) -> Floats | None:
        """Return places (n, 3) about the local origin from which cells of an edge follow the surface; None: all do."""
        return None

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}>"

    def _local(self, xyz: ArrayLike) -> Floats:
        return np.asarray(measurable_places(xyz) - self.origin)


class OwnField(ImplicitBody):
    """A body that is a field itself, in its own coordinates: ``bounds`` is the box that contains it."""

    if TYPE_CHECKING:

        @property
        def bounds(self) -> tuple[Floats, Floats]:
            """Corners (3,) of a box that contains the body."""

    @property
    def origin(self) -> Floats:
        """(3,) zeros: coordinates are as they are."""
        return np.zeros(3)

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """The box that contains the body."""
        return self.bounds

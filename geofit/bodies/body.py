"""A fitted body: its field, distance, triangles, verdict, volumes, cuts and STEP file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.accuracy import BodyAccuracy
from geofit.bodies.data import BodyData, BodyIssue
from geofit.bodies.field import BodyField
from geofit.bodies.fitted import Fitted
from geofit.bodies.region import Region
from geofit.bodies.settings import BodySettings
from geofit.data.columns import measurable_places
from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.data.numbers import is_finite
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh

if TYPE_CHECKING:
    from geofit.bodies.cut import BodyPiece
    from geofit.bodies.simulate import BodyVolumes
    from geofit.cad.solid import SolidReadBack

__all__ = ["ImplicitBody"]

Floats = NDArray[np.float64]

#: Cells of the overview mesh along the longest side of the body, at least and at most, and between two holes: a deposit
#: of many holes has parts that 48 cells do not show. And the most cells that a mesh may have.
OVERVIEW = (48, 160)
BETWEEN_HOLES = 3
MOST = 1024


@dataclass(frozen=True, eq=False)
class ImplicitBody:
    """A closed body: the places where a C2 field is negative. Coordinates are map coordinates in metres.

    Parameters
    ----------
    name : str
        Name of the body.
    data : BodyData
        What it was fitted to.
    settings : BodySettings
        How.
    fitted : Fitted
        The field and its figures.
    accuracy : BodyAccuracy or None
        The verdict; None only while the fit is under way.
    """

    name: str
    data: BodyData
    settings: BodySettings
    fitted: Fitted
    accuracy: BodyAccuracy | None = None

    def with_accuracy(self, accuracy: BodyAccuracy) -> ImplicitBody:
        """Return the body with its verdict."""
        return replace(self, accuracy=accuracy)

    @property
    def field(self) -> BodyField:
        """The field about the local origin, for the algorithms of :mod:`geofit.implicit`."""
        return self.fitted.field

    @property
    def region(self) -> Region:
        """Box and scales."""
        return self.fitted.region

    @property
    def origin(self) -> Floats:
        """Map coordinates of the local origin, (3,)."""
        return self.field.frame.origin

    @property
    def epsilon(self) -> float:
        """Control error for sigma, metres."""
        return self.settings.epsilon

    @property
    def contacts(self) -> Floats:
        """Measured places (n, 3) of the surface, map coordinates."""
        return self.data.contacts

    @property
    def issues(self) -> tuple[BodyIssue, ...]:
        """What was merged, contradicted itself, or was left out."""
        return self.fitted.prepared.issues

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field (n,) at (n, 3) places: negative inside; near the surface about the distance in metres."""
        return self.field.value(self._local(xyz))

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradient (n, 3) of the field at (n, 3) places; it points outwards."""
        return self.field.gradient(self._local(xyz))

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance (n,) of (n, 3) places to the surface, metres, positive outside."""
        from geofit.bodies.distance import signed_distance

        return signed_distance(self.field, self._local(xyz), self.fitted.survey.spacing, lambda: self.overview)

    def triangulate(self, spacing: float | None = None) -> TriangleMesh:
        """Return the surface as a closed triangle mesh in map coordinates.

        Parameters
        ----------
        spacing : float, optional
            Edge of the cells in metres; by default a third of the distance between holes, and between 1/48 and 1/160 of
            the longest side of the body.

        Raises
        ------
        SettingsError
            If the spacing is not a length, or gives more than 1024 cells along a side.
        """
        mesh = self.overview if spacing is None else self.local_mesh(spacing)
        return TriangleMesh(mesh.vertices + self.origin, mesh.triangles)

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return the same mesh about the local origin, where coordinates keep all their digits."""
        lower, upper = self.extent
        longest = float((upper - lower).max())
        if not is_finite(spacing) or spacing <= 0 or longest / spacing > MOST:
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

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin, somewhat larger than it."""
        return self.fitted.survey.lower, self.fitted.survey.upper

    @cached_property
    def overview(self) -> TriangleMesh:
        """A mesh of moderate size about the local origin, made once."""
        lower, upper = self.extent
        longest = float((upper - lower).max())
        return self.local_mesh(longest / np.clip(BETWEEN_HOLES * longest / self.region.spacing, *OVERVIEW))

    def volumes(self) -> BodyVolumes:
        """Return P10, P50 and P90 of the volume by conditional simulation."""
        from geofit.bodies.simulate import simulate

        return simulate(self)

    def cut(self, surfaces: Mapping[str, Any] | Sequence[Any], spacing: float | None = None) -> tuple[BodyPiece, ...]:
        """Return the pieces into which surfaces cut the body; see :func:`geofit.bodies.cut.cut_body`."""
        from geofit.bodies.cut import cut_body

        return cut_body(self, surfaces, spacing)

    def write_step(self, path: str | PathLike[str], nurbs: bool = True) -> SolidReadBack:
        """Write the body as a STEP AP242 solid, read it back, and return what the reader found.

        Parameters
        ----------
        path : path
            The file, usually ``*.step``.
        nurbs : bool
            NURBS patches within epsilon of the surface; otherwise, and where patches cannot follow the body, a
            tessellated solid.
        """
        from geofit.bodies.creased import write_solid
        from geofit.cad.solid import write_body

        return write_solid(self, path) if nurbs else write_body(self, path)

    def _local(self, xyz: ArrayLike) -> Floats:
        return np.asarray(measurable_places(xyz) - self.origin)

"""A body fitted to drill holes, outlines or points: its field, its verdict, its volumes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.accuracy import BodyAccuracy
from geofit.bodies.data import BodyData, BodyIssue
from geofit.bodies.field import BodyField
from geofit.bodies.fitted import Fitted
from geofit.bodies.implicit_body import ImplicitBody
from geofit.bodies.region import Region
from geofit.bodies.settings import BodySettings
from geofit.data.given import arguments_checked
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.volume import Extent

if TYPE_CHECKING:
    from geofit.bodies.simulate import BodyVolumes

__all__ = ["BodyFit"]

Floats = NDArray[np.float64]

#: Cells of the overview mesh along the longest side of the body, at least and at most, and between two holes: a deposit
#: of many holes has parts that 48 cells do not show.
OVERVIEW = (48, 160)
BETWEEN_HOLES = 3


@arguments_checked
@dataclass(frozen=True, eq=False)
class BodyFit(ImplicitBody):
    """A body fitted to what holes, outlines or points say of it. Coordinates are map coordinates in metres.

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

    def __repr__(self) -> str:
        parts = [f"{len(self.contacts)} contacts"]
        if (a := self.accuracy) is not None:
            sign, verdict = ("<", "PASS") if a.passed else (">=", "FAIL")
            parts.append(f"sigma {a.sigma:.3g} m {sign} {self.epsilon:g} m {verdict}")
        return f"<BodyFit {self.name}: {', '.join(parts)}>"

    def with_accuracy(self, accuracy: BodyAccuracy) -> BodyFit:
        """Return the body with its verdict, and with the meshes that this took."""
        judged = replace(self, accuracy=accuracy)
        vars(judged).update({name: value for name, value in vars(self).items() if name != "accuracy"})
        return judged

    @property
    def field(self) -> BodyField:
        """The field about the local origin, for the algorithms of :mod:`geofit.implicit`."""
        return self.fitted.field

    @property
    def spacing(self) -> float:
        """Length over which the surface is about flat, metres."""
        return self.fitted.survey.spacing

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
    def cut_sides(self) -> tuple[str, ...]:
        """Sides of its box at which the body is cut: what lies beyond is not known."""
        return self.field.cut

    @property
    def contacts(self) -> Floats:
        """Measured places (n, 3) of the surface, map coordinates."""
        return self.data.contacts

    @property
    def issues(self) -> tuple[BodyIssue, ...]:
        """What was merged, contradicted itself, or was left out."""
        return self.fitted.prepared.issues

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin, somewhat larger than it."""
        return self.fitted.survey.lower, self.fitted.survey.upper

    @property
    def overview_spacing(self) -> float:
        """Edge of the overview's cells, metres: a third of the distance between holes."""
        lower, upper = self.extent
        longest = float((upper - lower).max())
        return float(longest / np.clip(BETWEEN_HOLES * longest / self.region.spacing, *OVERVIEW))

    @cached_property
    def _shown(self) -> tuple[Extent, TriangleMesh]:
        return self._measured(self._first)

    @cached_property
    def _first(self) -> TriangleMesh:
        """Triangles of cells of :attr:`overview_spacing`, which look for the surface everywhere."""
        return self.local_mesh(self.overview_spacing)

    def _known_surface(self, spacing: float) -> Floats | None:
        if spacing >= self.overview_spacing:
            return None
        return np.concatenate([self._first.vertices, self.data.contacts - self.origin])

    @property
    def size(self) -> Extent:
        """Volume and area of the body with their numerical errors, m3 and m2: see :attr:`ImplicitBody.size`."""
        return self._shown[0]

    @property
    def overview(self) -> TriangleMesh:
        """Closed triangles of moderate size about the local origin, made once.

        Their cells are smaller than :attr:`overview_spacing` where those lose more than a fiftieth of a thin body.
        """
        return self._shown[1]

    def volumes(self, scheduler: str = "local", workers: int | None = 1) -> BodyVolumes:
        """Return P10, P50 and P90 of the volume by conditional simulation.

        Parameters
        ----------
        scheduler, workers : str, int
            Where the simulations are kriged, see :func:`geofit.streaming.executors.run_tasks`; by default here.
        """
        from geofit.bodies.simulate import simulate
        from geofit.streaming.executors import Where

        return simulate(self, Where(scheduler, workers))

"""The field of a core's own points, where the field of all points cannot follow their relief.

Spans that suit the sparse points may be longer than the distances within a dense core, and relief that is sharp in the
core may be gentle around it. What one field for both cannot follow counts as noise, and the surface swings between
points that it is made to pass through. The core's own points then choose a field by their own likelihood, on spans of
their own spacing. It replaces the other one in the core, and fades over a margin around it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.long_arrays import everywhere
from geofit.data.prepared import Preparing
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data, degree_for
from geofit.fitting.contradiction import SHARED
from geofit.fitting.field import FieldChoice, choose_covariance, plane_trend, smooth
from geofit.fitting.likelihood import plane_coefficients
from geofit.fitting.resolution import EVEN, LOUDER, SKETCH, choose_field, even_space, longest_span
from geofit.splines import bspline
from geofit.splines.refined import abscissae
from geofit.splines.tensor import TensorSpace

__all__ = ["CoreRelief", "relief_of_core"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]

#: Spacing of a core's points, in units of that of the sparse ones, above which one field serves both.
DENSER = 0.8
#: Fewest points that choose a field of their own.
FEWEST = 30
#: Width of the margin over which it fades, in units of the core's own spacing.
MARGIN = 2.0
#: Longest knot spans of a surface that follows it, as a share of its own: longer ones would swing about it.
FOLLOWED = 0.7


@dataclass(frozen=True, eq=False)
class CoreRelief(Preparing):
    """A field over a core, (``space``, ``coefficients``), metres about the trend of all points.

    It was chosen, as ``field``, for the ``data`` of the core and its margin; their lengths are counted in units
    ``scale`` times as long as those of the whole surface. It replaces the field of all points in the rectangle ``core``
    and ends at the edge of ``reach``, both in units of the whole surface.
    """

    space: TensorSpace
    coefficients: Floats
    scale: float
    core: Rectangle
    reach: Rectangle
    field: FieldChoice
    data: Data

    def spans(self) -> tuple[Floats, Floats]:
        """Return, for u and v, the row (low, high, size) of spans that follow the field."""
        spans = FOLLOWED * self.scale * longest_span(self.space)
        low_u, high_u, low_v, high_v = self.reach
        return np.array([[low_u, high_u, spans]]), np.array([[low_v, high_v, spans]])

    def instead(self, plane: Floats, heights: Floats) -> Floats:
        """Return the (n,) heights at (n, 2) places where this field takes the place of another, of ``heights`` (n,)."""
        own = self.space.matrix(self.places(plane)) @ self.coefficients
        return np.asarray(heights + self.share(plane) * (own - heights))

    def blended(self, space: TensorSpace, coefficients: Floats) -> Floats:
        """Return the coefficients of a surface in which this field takes the place of another, both on ``space``."""
        return coefficients + self.departure(space, lambda plane: space.matrix(plane) @ coefficients)

    def departure(self, space: TensorSpace, height: Callable[[Floats], Floats]) -> Floats:
        """Return, as coefficients on ``space``, by how much this field departs from another, a function of places."""
        plane = abscissae(space)
        other = height(plane)
        off: Floats = (self.instead(plane, other) - other).reshape(space.shape)
        for knots in (space.knots_v, space.knots_u):
            table = bspline.collocation(knots, space.degree, bspline.greville(knots, space.degree))
            off = np.asarray(np.linalg.solve(table, off.T), np.float64)
        return np.asarray(off.ravel())

    def share(self, plane: Floats) -> Floats:
        """Return the (n,) share of this field at (n, 2) places: 1 in the core, 0 beyond its reach, C2 between."""
        return self._along(plane[:, 0], 0) * self._along(plane[:, 1], 2)

    def places(self, plane: Floats) -> Floats:
        """Return (n, 2) places in the field's own units; of those beyond it, the nearest of its edge."""
        knots = (self.space.knots_u, self.space.knots_v)
        return np.clip(plane / self.scale, [each[0] for each in knots], [each[-1] for each in knots])

    def _along(self, x: Floats, axis: int) -> Floats:
        t = np.ones(len(x))
        for edge, end in zip(self.core[axis : axis + 2], self.reach[axis : axis + 2], strict=True):
            # A core that reaches the edge of the study area has no margin there.
            if edge != end:
                t = np.minimum(t, np.clip((x - end) / (edge - end), 0.0, 1.0))
        return np.asarray(t**3 * (10 - 15 * t + 6 * t**2))


def relief_of_core(
    data: Data,
    core: Rectangle,
    inside: NDArray[np.bool_],
    field: FieldChoice,
    settings: FitSettings,
    most: int,
    near: Callable[[], float],
) -> CoreRelief | None:
    """Return the field of a core's own points; None where that of all points follows their relief.

    Parameters
    ----------
    data : Data
        All points.
    core : tuple of float
        The core's rectangle, in units.
    inside : (n,) array of bool
        The points that the surface is to pass through.
    field : FieldChoice
        The field of all points.
    settings : FitSettings
        Settings of the fit.
    most : int
        Control points at most.
    near : callable
        Returns the noise that the core's nearest points show (:func:`geofit.fitting.contradiction.near_noise`), metres.

    Notes
    -----
    Measured slopes join the field of all points alone: with them the core has no field of its own, nor has a fold.
    """
    low_u, high_u, low_v, high_v = core
    scale = math.sqrt((high_u - low_u) * (high_v - low_v) / max(int(inside.sum()), 1))
    few = scale > DENSER or inside.sum() < FEWEST
    if few or data.value.ndim > 1 or data.slopes is not None or settings.smoothing != "auto":
        return None
    aside, area, quiet = MARGIN * scale, data.area, field.noise / LOUDER
    reach = (
        max(low_u - aside, area[0]),
        min(high_u + aside, area[1]),
        max(low_v - aside, area[2]),
        min(high_v + aside, area[3]),
    )
    own, trend = _points_within(data, reach, inside, scale)
    space = even_space(own.area, EVEN, degree_for(len(own.plane)), SKETCH)
    try:
        # A cheap look first: does the same field leave less noise on spans of the core's own spacing? Where all relief
        # of the core counts as noise, no field of so long a range does, but the nearest points share it.
        look = choose_covariance(space, own.weighted, None, [_scaled(field, scale)], own.trend)[0][0].noise
        if look > quiet and (field.noise <= settings.interior_tolerance or near() > SHARED * field.noise):
            return None
        found, space = choose_field(own, settings, most)
    except FitError:
        return None  # rounding leaves no solution on spans so much shorter
    if found.noise > quiet:
        return None
    coefficients = smooth(space, found, own.weighted, own.trend).coefficients + plane_coefficients(space) @ trend
    return CoreRelief(space, coefficients, scale, core, reach, found, own)


def _points_within(data: Data, reach: Rectangle, inside: NDArray[np.bool_], scale: float) -> tuple[Data, Floats]:
    """Return the points of the core and of its margin in units of their own, and their trend about that of all."""
    u, v = data.plane[:].T
    near = inside | ((u >= reach[0]) & (u <= reach[1]) & (v >= reach[2]) & (v <= reach[3]))
    plane, value = data.plane[near] / scale, data.value[near]
    trend = plane_trend(plane, value, everywhere(1.0, len(plane)))
    whole = trend + data.trend * (1.0, scale, scale)
    area = (reach[0] / scale, reach[1] / scale, reach[2] / scale, reach[3] / scale)
    about = value - trend[0] - plane @ trend[1:]
    return Data(plane, about, data.accuracy[near], data.noise[near], area, data.unit * scale, whole), trend


def _scaled(field: FieldChoice, scale: float) -> FieldChoice:
    """Return the same field, its lengths counted in a unit ``scale`` times as long."""
    return replace(field, kappa=field.kappa * scale, rho=field.rho * scale ** (-2 * (field.alpha - 1)))

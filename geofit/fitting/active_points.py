"""The active points of a fit: in units of the spacing of the sparse ones, about their trend."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.data.long_arrays import LongArray, Rows, blocks, everywhere, inverse_squares, without
from geofit.data.settings import FitSettings
from geofit.fitting.density import CLOUD
from geofit.fitting.field import FieldChoice, Smoothed, plane_trend, relative_noise, smooth
from geofit.fitting.likelihood import plane_coefficients
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.slopes import Slopes
from geofit.fitting.split import Split
from geofit.fitting.weighted_points import WeightedPoints
from geofit.splines.refined import Space, outer_of, padded
from geofit.splines.tensor import TensorSpace

__all__ = ["Data", "degree_for", "gather_points"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Data:
    """The points that the fit honours, and measured slopes, in units, about the points' trend.

    ``accuracy`` is as stated or found, metres, nan where it is not; ``noise`` is relative
    (:func:`geofit.fitting.field.relative_noise`). The places of a cloud are made when read.
    """

    plane: Rows
    value: Rows
    accuracy: Floats
    noise: Floats
    area: Rectangle
    unit: float
    trend: Floats
    slopes: Slopes | None = None
    _last: dict[TensorSpace, tuple[FieldChoice, Smoothed]] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def weighted(self) -> WeightedPoints:
        """The points by the weights of their noise."""
        return WeightedPoints(self.plane, self.value, inverse_squares(self.noise))

    def smoothed(self, space: TensorSpace, choice: FieldChoice) -> Smoothed:
        """Return a chosen field on a space; the last one of each space is kept."""
        if space not in self._last or self._last[space][0] != choice:
            self._last[space] = choice, smooth(space, choice, self.weighted, self.trend, self.slopes)
        return self._last[space][1]

    def whole(self) -> Data:
        """Return the same points, all places held."""
        return replace(self, plane=np.asarray(self.plane[:]), value=np.asarray(self.value[:]))

    def over_trend(self, space: Space) -> Floats:
        """Return the trend's coefficients on a space."""
        return padded(space, plane_coefficients(outer_of(space)) @ self.trend)


def gather_points(
    accuracy: Floats,
    parametrization: Parametrization,
    settings: FitSettings,
    kept: NDArray[np.bool_],
    split: Split | None,
    slopes: Slopes | None = None,
    unit: float | None = None,
) -> Data:
    """Return the points that the fit honours, in units of the spacing of the sparse ones, about their trend.

    ``accuracy`` is that of all points, metres (nan: none). ``unit`` is that of a fit that stands already: which points
    count as its core may have changed since.
    """
    area = parametrization.area
    size, n = (area[1] - area[0]) * (area[3] - area[2]), int(kept.sum())
    sparse = int((~split.inside & kept).sum()) if split is not None else 0
    if split is not None and split.core is not None and sparse >= 10:
        c = split.core
        size, n = size - (c[1] - c[0]) * (c[3] - c[2]), sparse
    unit = float(np.sqrt(size / n)) if unit is None else unit
    plane, value = _active_rows(parametrization, kept, unit)
    trend = plane_trend(plane, value, everywhere(1.0, len(plane)))
    scaled = (area[0] / unit, area[1] / unit, area[2] / unit, area[3] / unit)
    about = np.empty(value.shape)
    for rest, heights, places in blocks(about, value, plane):
        np.subtract(heights, trend[0] + places @ trend[1:], out=rest)
    accuracy = accuracy[kept] if np.isfinite(accuracy).any() else everywhere(np.nan, len(plane))
    noise = relative_noise(accuracy, settings.interior_tolerance)
    turned = None if slopes is None else slopes.in_units(unit, trend)
    return Data(plane, about, accuracy, noise, scaled, unit, trend, turned)


def _active_rows(parametrization: Parametrization, kept: NDArray[np.bool_], unit: float) -> tuple[Rows, Rows]:
    """Return places in units and values of the points that are kept; those of a cloud are not copied."""
    if len(kept) <= CLOUD:
        return parametrization.plane[kept] / unit, parametrization.values[kept]
    gone = np.flatnonzero(~kept)
    places = without(parametrization.plane, gone)
    plane = LongArray((len(places), 2), lambda start, stop: places[start:stop] / unit)
    return plane, without(parametrization.values, gone)


def degree_for(n: int) -> int:
    """Fewer than 16 points cannot hold a bicubic patch."""
    return 3 if n >= 16 else 2 if n >= 6 else 1

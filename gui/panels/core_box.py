"""The core's rectangle while it is dragged: in the directions in which the fit cuts the surface. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import GeofitError
from geofit.data.messages import EMPTY
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.parametrize import Parametrization, parametrize
from geofit.fitting.split import split_rectangle
from geofit.geometry.frame import Frame

__all__ = ["CoreBox", "core_count", "parametrization_of"]

Floats = NDArray[np.float64]

#: Sides do not get shorter than this while dragged, metres.
SHORTEST = 1.0


@dataclass(frozen=True, eq=False)
class CoreBox:
    """A rectangle along the axes of a frame: ``low`` and ``high`` (2,) in the frame's plan, metres."""

    frame: Frame
    low: Floats
    high: Floats

    @classmethod
    def around(cls, frame: Frame, polygon: ArrayLike) -> CoreBox:
        """Return the smallest rectangle of the frame around a polygon of map coordinates, as the fit takes it."""
        plan = frame.plan(np.asarray(polygon, float))
        return cls(frame, plan.min(axis=0), plan.max(axis=0))

    @property
    def corners(self) -> Floats:
        """The four corners in map coordinates, (4, 2), in turn."""
        (u0, v0), (u1, v1) = self.low, self.high
        local = np.array([[u0, v0, 0.0], [u1, v0, 0.0], [u1, v1, 0.0], [u0, v1, 0.0]])
        return np.asarray((self.frame.turn_back(local) + self.frame.origin)[:, :2])

    @property
    def size(self) -> tuple[float, float]:
        """Lengths of the sides in metres."""
        width, height = self.high - self.low
        return float(width), float(height)

    def with_corner(self, corner: int, xy: ArrayLike) -> CoreBox:
        """Return the rectangle with one corner moved to a place; the corner across stays."""
        place = self.frame.plan(np.asarray(xy, float)[None])[0]
        low, high = self.low.copy(), self.high.copy()
        if corner in {0, 3}:
            low[0] = min(place[0], high[0] - SHORTEST)
        else:
            high[0] = max(place[0], low[0] + SHORTEST)
        if corner in {0, 1}:
            low[1] = min(place[1], high[1] - SHORTEST)
        else:
            high[1] = max(place[1], low[1] + SHORTEST)
        return replace(self, low=low, high=high)

    def moved(self, shift: ArrayLike) -> CoreBox:
        """Return the rectangle moved by map metres (2,)."""
        step = self.frame.axes[:2, :2] @ np.asarray(shift, float)
        return replace(self, low=self.low + step, high=self.high + step)

    def holds(self, xy: Floats) -> NDArray[np.bool_]:
        """Tell which places (n, 2) lie inside."""
        plan = self.frame.plan(xy)
        return np.asarray(((plan >= self.low - 1e-6) & (plan <= self.high + 1e-6)).all(axis=1))


def parametrization_of(
    points: PointSet, settings: FitSettings, boundary: Floats | None, surface: HorizonFit | None
) -> Parametrization | None:
    """Return the parametrization of a horizon's fit, done or to come; None where these points cannot be fitted."""
    if surface is not None and surface.model is not None:
        return surface.model.problem.parametrization
    try:
        return parametrize(points, settings, boundary)
    except GeofitError:
        return None


def core_count(parametrization: Parametrization, box: CoreBox) -> tuple[int, bool]:
    """Return how many points the fit takes into the core for a rectangle, and whether it widens the rectangle.

    The fit moves a side to the edge of the area where next to nothing lies between them.
    """
    low = np.maximum(box.low, (parametrization.area[0], parametrization.area[2]))
    high = np.minimum(box.high, (parametrization.area[1], parametrization.area[3]))
    if (high <= low).any():
        return 0, False
    given = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    split = split_rectangle(parametrization.plane, given, parametrization.area, EMPTY)
    widened = split.core is not None and not np.allclose(split.core, given)
    return int(split.inside.sum()), widened

"""A fault: a fitted surface or a trace in plan, on which side of it a place lies, and where a horizon meets it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.site.zero_contours import zero_contours

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["BEYOND_TRACE", "HALVINGS", "Fault", "Height", "longer", "longer_side"]

Floats = NDArray[np.float64]
Height = Callable[[Floats, Floats], Floats]

#: Cells along the longer side of the lattice on which a fault is traced.
CELLS = 40
#: A surface ends at the area's edge, and so its trace up to one cell before it: it is continued straight by so much,
#: as a share of the area's longer side.
BEYOND_TRACE = 3 / CELLS
#: Halvings of a cell's edge where it meets a fault: 24 leave 2e-6 m of 30 m.
HALVINGS = 24


class Fault:
    """A fault, as a surface or as the part of the plan on the left of its trace."""

    def __init__(self, name: str, surface: HorizonFit | None, left: Polygon | None) -> None:
        self.name, self._surface, self._left = name, surface, left

    @classmethod
    def of(cls, fault: HorizonFit | ArrayLike, number: int, area: Polygon) -> Fault:
        """Return the fault of a surface or of a trace in plan."""
        if isinstance(fault, HorizonFit):
            return cls(fault.name, fault, None)
        line = np.asarray(fault, float)
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2 or not np.isfinite(line).all():
            raise SettingsError(
                message(
                    "site.fault-wrong-shape",
                    "Fault {number} has shape {shape}; a fitted surface or at least two (easting, northing) corners of "
                    "its trace are needed.",
                    number=number + 1,
                    shape=line.shape,
                )
            )
        if not np.ptp(line, axis=0).any():
            raise SettingsError(
                message(
                    "site.fault-is-a-point",
                    "The trace of fault {number} is a single place; at least two different corners are needed.",
                    number=number + 1,
                )
            )
        return cls(f"fault {number + 1}", None, _left_of(line, area))

    def side(self, xyz: Floats) -> NDArray[np.int64]:
        """Return (n,) on which side places lie: 1 above or left of the fault, else 0."""
        import shapely

        if self._surface is not None:
            return (self._surface.distance(xyz) > 0).astype(np.int64)
        assert self._left is not None
        return np.asarray(shapely.intersects_xy(self._left, xyz[:, 0], xyz[:, 1])).astype(np.int64)

    def traces(self, area: Polygon, height: Height) -> list[Floats]:
        """Return the lines (k, 2) in plan along which a surface over an area meets the fault."""
        import shapely

        if self._left is not None:
            edge = shapely.intersection(self._left.exterior, shapely.buffer(area, 0.01 * longer_side(area)))
            return [shapely.get_coordinates(line) for line in shapely.get_parts(shapely.line_merge(edge))]
        plan = _lattice(area)

        def above(x: Floats, y: Floats) -> Floats:
            z = height(x, y)
            value = np.full(x.shape, np.nan)
            known = np.isfinite(z)
            value[known] = self.side(np.column_stack([x[known], y[known], z[known]])) - 0.5
            return value

        value = above(plan[..., 0].ravel(), plan[..., 1].ravel()).reshape(plan.shape[:2])
        return zero_contours(plan, value, above, HALVINGS)


def longer(line: Floats, length: float) -> Floats:
    """Return a line continued straight at both ends."""
    first, last = line[0] - line[1], line[-1] - line[-2]
    start, end = (length * way / np.linalg.norm(way) for way in (first, last))
    return np.vstack([line[0] + start, line, line[-1] + end])


def longer_side(area: Polygon) -> float:
    """Return the longer side of an area's rectangle, metres."""
    x0, y0, x1, y1 = area.bounds
    return float(max(x1 - x0, y1 - y0))


def _left_of(line: Floats, area: Polygon) -> Polygon:
    """Return the part of a wide box around an area on the left of a trace, continued straight at both ends."""
    import shapely
    from shapely.ops import split

    x0, y0, x1, y1 = area.bounds
    reach = max(x1 - x0, y1 - y0) + float(np.abs(line - (x0, y0)).max())
    whole = longer(line, 10 * reach)
    parts = split(shapely.box(x0 - reach, y0 - reach, x1 + reach, y1 + reach), shapely.LineString(whole)).geoms
    way = line[1] - line[0]
    beside = (line[0] + line[1]) / 2 + 1e-6 * reach * np.array([-way[1], way[0]]) / np.linalg.norm(way)
    return next(part for part in parts if isinstance(part, shapely.Polygon) and part.intersects(shapely.Point(*beside)))


def _lattice(area: Polygon) -> Floats:
    """Return (nu, nv, 2) nodes of square cells that reach just beyond an area."""
    x0, y0, x1, y1 = area.bounds
    step = max(x1 - x0, y1 - y0) / CELLS
    x, y = (np.arange(low - 0.5 * step, high + step, step) for low, high in ((x0, x1), (y0, y1)))
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)

"""Surfaces on regular grids: elevation, thickness between two horizons, deviation of data points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.data.numbers import is_finite
from geofit.data.points import PointSet
from geofit.data.site import Ground
from geofit.sampling.contours import interval_for
from geofit.surfaces.below_ground import below_ground
from geofit.surfaces.protocol import Surface

__all__ = ["deviation_grid", "elevation_grid", "thickness_grid"]

Floats = NDArray[np.float64]

#: Cells along the longer side of a grid, where no cell size is given: about.
CELLS = 200
MOST_CELLS = 100_000_000
#: The extent of a surface is taken from triangles of this tolerance, metres.
COARSE = 1.0


def elevation_grid(surface: Surface, cell: float | None = None) -> Ground:
    """Return the elevation of a surface at nodes that are at multiples of ``cell`` metres; nan outside.

    Raises
    ------
    SettingsError
        If the cell size is not above 0, or leaves no grid, or makes over 1e8 cells.
    """
    return _grid(_extent(surface), cell, surface.elevation)


def thickness_grid(upper: Surface, lower: Surface, cell: float | None = None, ground: Ground | None = None) -> Ground:
    """Return upper minus lower elevation, metres, nan where either is absent; errors as elevation_grid.

    Negative where the horizons cross. With a ground, only what lies below it counts; 0 where both horizons lie above.
    """
    boxes = [_extent(upper), _extent(lower)]
    box = np.max([b[0] for b in boxes], axis=0), np.min([b[1] for b in boxes], axis=0)

    def value(x: Floats, y: Floats) -> Floats:
        top, base = upper.elevation(x, y), lower.elevation(x, y)
        return below_ground(top, x, y, ground) - below_ground(base, x, y, ground)

    return _grid(box, cell, value)


def deviation_grid(surface: Surface, points: PointSet, cell: float | None = None) -> Ground:
    """Return, for each cell with data points, the deviation (m, positive above) of largest size; nan elsewhere.

    Nothing is interpolated between points. Errors as elevation_grid.
    """
    grid = _grid(_extent(surface), cell, lambda x, y: np.full_like(x, np.nan))
    off = surface.distance(points.xyz)
    step = grid.x[1] - grid.x[0]
    i = np.round((points.xyz[:, 0] - grid.x[0]) / step).astype(int)
    j = np.round((points.xyz[:, 1] - grid.y[0]) / step).astype(int)
    inside = (i >= 0) & (i < len(grid.x)) & (j >= 0) & (j < len(grid.y))
    order = np.argsort(np.abs(off), kind="stable")
    order = order[inside[order]]
    grid.z[j[order], i[order]] = off[order]
    return grid


def _extent(surface: Surface) -> tuple[Floats, Floats]:
    plan = surface.triangulate(COARSE).xyz[:, :2]
    return plan.min(axis=0), plan.max(axis=0)


def _grid(box: tuple[Floats, Floats], cell: float | None, value: Callable[[Floats, Floats], Floats]) -> Ground:
    low, high = box
    if not (high > low).all():
        raise SettingsError(
            message(
                "sampling.horizons-not-overlapping",
                "The surfaces do not overlap in plan; nothing can be measured between them.",
            )
        )
    step = interval_for(0.0, float((high - low).max()) * 20 / CELLS) if cell is None else cell
    if not is_finite(step) or step <= 0:
        raise SettingsError(
            message("sampling.cell-size-not-positive", "The cell size is {step}; give metres above 0.", step=step)
        )
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    count = last - first + 1
    if count.min() < 2:
        raise SettingsError(
            message(
                "sampling.cell-larger-than-surface",
                "Cells of {step:g} m are too large: the surface is {width:.1f} m wide. Give a smaller size.",
                step=step,
                width=(high - low).min(),
            )
        )
    if count.prod() > MOST_CELLS:
        raise SettingsError(
            message(
                "sampling.too-many-cells",
                "A cell of {step:g} m makes {count:.3g} cells; give a larger one.",
                step=step,
                count=count.prod(),
            )
        )
    x, y = (step * (first[k] + np.arange(int(count[k]))) for k in (0, 1))
    return Ground(x, y, np.stack([value(x, np.full_like(x, north)) for north in y]))

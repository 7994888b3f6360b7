"""Contour lines of a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown
from geofit.geometry.mesh import Mesh
from geofit.sampling.isolines import level_lines
from geofit.surfaces.protocol import Surface

__all__ = ["ContourLine", "contours", "interval_for"]

Floats = NDArray[np.float64]

#: More contours than this are a mistake in the interval.
MOST = 5_000


@dataclass(frozen=True, eq=False)
class ContourLine:
    """One contour line: ``line`` (k, 2) map coordinates at ``elevation``, metres; ``closed``: ends where it began."""

    elevation: float
    line: Floats
    closed: bool


def interval_for(low: float, high: float) -> float:
    """Return the interval 1, 2 or 5 times a power of ten that gives about 10 to 25 contours."""
    span = max(high - low, 1e-6)
    power = 10.0 ** math.floor(math.log10(span / 10))
    return next(step * power for step in (1, 2, 5, 10) if span / (step * power) <= 25)


@arguments_checked
def contours(
    surface: Surface,
    interval: float | None = None,
    *,
    tolerance: float = 0.05,
    mesh: Mesh | None = None,
) -> list[ContourLine]:
    """Return the contour lines of a surface, the lowest first.

    Parameters
    ----------
    surface : Surface
        Any surface; an overturned one gives lines for each of its limbs.
    interval : float, optional
        Metres between contours, which stand at its multiples; by default 1, 2 or 5 times a power of ten.
    tolerance : float
        Largest distance in metres between a line and the surface, between its vertices; these are exact.
    mesh : Mesh, optional
        Triangles of the surface, if they are there already.

    Returns
    -------
    list of Contour
        Each in plan, map coordinates in metres, with its elevation.

    Raises
    ------
    SettingsError
        If the interval is not above 0, or so small that it makes over 5,000 contours.

    Notes
    -----
    Lines are traced through the triangles, and their vertices moved along the surface until they lie on the level.
    """
    mesh = surface.triangulate(tolerance) if mesh is None else mesh
    z = mesh.points[:, 2] + surface.origin[2]
    low, high = float(z.min()), float(z.max())
    step = interval_for(low, high) if interval is None else interval
    if not is_finite(step) or step <= 0:
        raise SettingsError(
            message(
                "data.contour-interval-not-positive",
                "The contour interval is {step}; give metres above 0.",
                step=shown(step),
            )
        )
    first, last = math.ceil(low / step), math.floor(high / step)
    if last - first > MOST:
        raise SettingsError(
            message(
                "sampling.too-many-contours",
                "An interval of {step:g} m makes {count} contours from {low:.1f} to {high:.1f} m; give one above "
                "{least:.2g} m.",
                step=step,
                count=last - first,
                low=low,
                high=high,
                least=(high - low) / MOST,
            )
        )
    levels = [round(k * step, 9) for k in range(first, last + 1)]
    if not levels:
        return []
    found = []
    cuts = level_lines(surface, mesh, np.array([0.0, 0.0, 1.0]), [level - surface.origin[2] for level in levels])
    for elevation, lines in zip(levels, cuts, strict=True):
        for line in lines:
            closed = bool(np.array_equal(line[0], line[-1]))
            if np.ptp(line, axis=0).max() > 0:
                found.append(ContourLine(elevation, line[:, :2] + surface.origin[:2], closed))
    return found

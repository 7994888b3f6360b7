"""A body as vertical intervals on a grid in plan: volumes, whole and cut by horizons, that add up exactly.

Along each vertical line the walls are found by linear interpolation; in plan the rule of midpoints is used, whose error
falls with the square of the spacing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.caves.sweep_loops import paint

if TYPE_CHECKING:
    from geofit.caves.body import PassageBody

__all__ = ["Columns", "columns"]

Floats = NDArray[np.float64]

#: Nodes of a slab at most: three arrays of this size are held.
_NODES = 8_000_000


@dataclass(frozen=True, eq=False)
class Columns:
    """Vertical intervals inside a body.

    Parameters
    ----------
    x, y : (n,) array
        Place of each interval, metres.
    low, high : (n,) array
        Its ends, metres.
    spacing : float
        Distance of the vertical lines, metres.
    """

    x: Floats
    y: Floats
    low: Floats
    high: Floats
    spacing: float

    @property
    def volume(self) -> float:
        """Volume, cubic metres."""
        return float((self.high - self.low).sum() * self.spacing**2)


def columns(body: PassageBody, spacing: float) -> Columns:
    """Return the vertical intervals of a body of passages."""
    low, high = body.bounds
    origin = low - 1.5 * spacing
    nx, ny, nz = (np.ceil((high - origin) / spacing) + 2).astype(int).tolist()
    thick = max(1, _NODES // (ny * nz))
    found: list[tuple[Floats, ...]] = []
    for first in range(0, nx, thick):
        corner = origin + np.array([first * spacing, 0.0, 0.0])
        # Tall and wide caves: a slab of one layer is cut along y as well.
        wide = max(1, _NODES // nz)
        for side in range(0, ny, wide):
            start = corner + np.array([0.0, side * spacing, 0.0])
            shape = (min(thick, nx - first), min(wide, ny - side), nz)
            found.append(_intervals(paint(body.sweeps, body.blend, body.boxes, start, spacing, shape), start, spacing))
    x, y, bottom, top = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return Columns(x, y, bottom, top, spacing)


def _intervals(value: Floats, corner: Floats, spacing: float) -> tuple[Floats, ...]:
    """Return place and ends of the intervals below zero along the last axis, which begins and ends above zero."""
    inside = value < 0
    enter = np.nonzero(~inside[..., :-1] & inside[..., 1:])
    leave = np.nonzero(inside[..., :-1] & ~inside[..., 1:])

    def wall(at: tuple[NDArray[np.int64], ...]) -> Floats:
        i, j, k = at
        before, after = value[i, j, k], value[i, j, k + 1]
        return np.asarray(corner[2] + spacing * (k + before / (before - after)))

    return corner[0] + spacing * enter[0], corner[1] + spacing * enter[1], wall(enter), wall(leave)

"""Swept sections: one a shot, as arrays, and their volumes."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

__all__ = ["Sweeps", "swept_volumes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Sweeps:
    """One swept section a shot, as arrays for the compiled loops.

    Parameters
    ----------
    origin, along, right, up : (k, 3) array
        Start of each shot and its orthonormal frame.
    length : (k,) array
        Lengths, metres.
    walls : (k, 2, 4) array
        Semi-axes left, right, up and down across the shot at start and end, metres.
    cap : (k, 2) array
        Semi-axis of the ellipsoid along the shot at start and end; 0 for a flat end.
    onward : (k, 2, 3) array
        Unit vector from start and end into the only shot that goes on there; 0 where there is none, or several. The
        ellipsoid fills the outer side of the bend only: where the next shot has a section, that one counts.
    branch : (k,) array of int
        Branch of each shot: a chain of shots between junctions and ends.
    """

    origin: Floats
    along: Floats
    right: Floats
    up: Floats
    length: Floats
    walls: Floats
    cap: Floats
    onward: Floats
    branch: Ints

    def chosen(self, index: Ints | NDArray[np.bool_]) -> Sweeps:
        """Return some of the sweeps, by their numbers or a mask."""
        return Sweeps(*(getattr(self, one.name)[index] for one in fields(self)))

    @property
    def volumes(self) -> Floats:
        """Volume (k,) of each sweep without its caps, cubic metres."""
        return swept_volumes(self.length, self.walls)


def swept_volumes(length: Floats, walls: Floats) -> Floats:
    """Return the volumes (k,) of sections that are linear between walls (k, 2, 4), exactly (Simpson's rule)."""
    area = [_area(walls[:, 0]), _area(walls.mean(axis=1)), _area(walls[:, 1])]
    return np.asarray(length * (area[0] + 4 * area[1] + area[2]) / 6)


def _area(walls: Floats) -> Floats:
    return np.asarray(np.pi / 4 * (walls[:, 0] + walls[:, 1]) * (walls[:, 2] + walls[:, 3]))

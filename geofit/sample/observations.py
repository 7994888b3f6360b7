"""What has been observed of each horizon so far: the generator's own bookkeeping."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAST_DISTANCE", "NOISE", "Observations", "errors_of"]

Floats = NDArray[np.float64]

#: One standard deviation of an observation, metres, by kind of source.
NOISE = {"borehole": 0.025, "adit": 0.025, "section": 0.025, "outcrop": 0.1, "geophysics": 0.1}

#: Two observations of a horizon keep this distance, metres, so that none contradicts another.
_APART = 5.5
#: Horizons that are not height over the map keep it in space, the others in plan; in plan the former keep so
#: much that no reader takes two of their points for one place.
_IN_SPACE = ("F1", "M1")
LEAST_DISTANCE = 0.05


def errors_of(rng: np.random.Generator, kind: str, n: int) -> Floats:
    """Return n errors of observation, metres: normal, none beyond three standard deviations."""
    return NOISE[kind] * np.clip(rng.normal(0.0, 1.0, n), -3.0, 3.0)


class Observations:
    """Points of each horizon by kind of source, as they will be imported (to the rounding of the files)."""

    def __init__(self) -> None:
        self._rows: list[tuple[str, str, Floats]] = []

    def is_clear(self, horizon: str, xyz: Floats) -> bool:
        """Tell whether a (3,) point keeps its distance from all others of its horizon."""
        others = [row[2] for row in self._rows if row[0] == horizon]
        if not others:
            return True
        gap = np.array(others) - xyz
        plan = np.linalg.norm(gap[:, :2], axis=1).min()
        if horizon in _IN_SPACE:
            return bool(plan >= LEAST_DISTANCE and np.linalg.norm(gap, axis=1).min() >= _APART)
        return bool(plan >= _APART)

    def add(self, horizon: str, kind: str, xyz: Floats) -> None:
        """Enter one (3,) point."""
        self._rows.append((horizon, kind, np.asarray(xyz, float)))

    def count(self, horizon: str, *kinds: str) -> int:
        """Return the number of points of a horizon, of some kinds or of all."""
        return sum(row[0] == horizon and (not kinds or row[1] in kinds) for row in self._rows)

    def points(self, horizon: str) -> Floats:
        """Return the (n, 3) points of a horizon."""
        return np.array([row[2] for row in self._rows if row[0] == horizon])

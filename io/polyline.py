"""Places along a polyline, used by section lines (plan) and adits (space)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["along", "chainage"]

Floats = NDArray[np.float64]


def chainage(line: Floats) -> Floats:
    """Return the length (k,) of a polyline (k, 2 or 3) from its start to each corner."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])


def along(line: Floats, s: Floats) -> Floats:
    """Return the places (n, 2 or 3) at the distances s (n,) along a polyline, held at its ends."""
    length = chainage(line)
    return np.column_stack([np.interp(s, length, line[:, k]) for k in range(line.shape[1])])

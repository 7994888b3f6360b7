"""Logged boreholes of a site: paths and interval tables. Plain data, no algorithms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HolePath", "IntervalLog", "LoggedHoles"]

Floats = NDArray[np.float64]


class HolePath(Protocol):
    """The way of a hole through space."""

    def at(self, depth: ArrayLike) -> Floats:
        """Return the places (n, 3) at depths (n,) along the hole, metres."""
        ...


@dataclass(frozen=True, eq=False)
class IntervalLog:
    """One interval table: arrays of equal length, sorted by hole and depth; ``row`` is the file's line.

    ``ended`` are the intervals whose base was not reached, as the log states: their unit goes on below. None: no such.
    """

    file: str
    hole: NDArray[np.str_]
    top: Floats
    base: Floats
    code: NDArray[np.str_]
    row: NDArray[np.int64]
    ended: NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class LoggedHoles:
    """One campaign: the path of each hole, its depth in metres, and the interval tables. No two holes share a name."""

    paths: Mapping[str, HolePath]
    ends: Mapping[str, float]
    logs: tuple[IntervalLog, ...]

"""Logged intervals of holes as pieces of their paths in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Hole, Site

__all__ = ["HoleInterval", "hole_intervals", "log_files"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HoleInterval:
    """An interval of a hole: the table that states it, its code, and its path ``xyz`` (k, 3), map coordinates."""

    hole: str
    table: str
    code: str
    xyz: Floats


def log_files(site: Site) -> tuple[str, ...]:
    """Return the files of the interval tables, in their order."""
    return tuple(dict.fromkeys(log.file for campaign in site.boreholes for log in campaign.logs))


def hole_intervals(site: Site, hole: Hole, table: str | None = None) -> Iterator[HoleInterval]:
    """Return the logged intervals of a hole down to its end; of one table, or of all."""
    for campaign in site.boreholes:
        for log in campaign.logs:
            if table is not None and log.file != table:
                continue
            for i in np.flatnonzero(log.hole == hole.name):
                top, base = max(float(log.top[i]), 0.0), min(float(log.base[i]), float(hole.depth[-1]))
                if base > top:
                    yield HoleInterval(hole.name, log.file, str(log.code[i]), _between(hole, top, base))


def _between(hole: Hole, top: float, base: float) -> Floats:
    inner = hole.depth[(hole.depth > top) & (hole.depth < base)]
    depth = np.concatenate([[top], inner, [base]])
    return np.column_stack([np.interp(depth, hole.depth, hole.xyz[:, k]) for k in range(3)])

"""Boreholes and adits as lines in space, and where they meet a horizon."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["Path", "borehole_path", "crossings", "polyline_path", "zero_between"]

Floats = NDArray[np.float64]

#: Map points, (n, 3) metres, at (n,) metres along a hole or an adit.
Path = Callable[[Floats], Floats]

_STEP = 0.5


def borehole_path(collar: Floats, stations: Floats) -> Path:
    """Return the minimum-curvature line through survey stations.

    Parameters
    ----------
    collar : (3,) array
        Easting, northing, elevation.
    stations : (k, 3) array
        Depth (m, the first 0), azimuth and dip below the horizontal (degrees). Below the last station the
        hole goes straight on.
    """
    depth, azimuth, dip = stations[:, 0], np.radians(stations[:, 1]), np.radians(stations[:, 2])
    heading = np.column_stack([np.cos(dip) * np.sin(azimuth), np.cos(dip) * np.cos(azimuth), -np.sin(dip)])

    def arc(i: NDArray[np.int64], length: Floats) -> Floats:
        """Move ``length`` metres from station i along the circle that turns its heading into the next one."""
        j = np.minimum(i + 1, len(depth) - 1)
        span = np.where(j > i, depth[j] - depth[i], 1.0)
        bend = np.arccos(np.clip((heading[i] * heading[j]).sum(1), -1.0, 1.0))
        turned = bend * length / span
        straight = bend < 1e-7
        safe = np.where(straight, 1.0, bend)
        share = length / span
        there = np.where(
            straight[:, None],
            heading[i],
            (np.sin(safe - turned)[:, None] * heading[i] + np.sin(turned)[:, None] * heading[j])
            / np.sin(safe)[:, None],
        )
        small = turned < 1e-9
        ratio = np.where(small, 1.0, np.tan(turned / 2) / np.where(small, 1.0, turned / 2))
        return np.asarray((share * span * ratio / 2)[:, None] * (heading[i] + there))

    spans = np.arange(len(depth) - 1)
    nodes = np.vstack([collar, collar + np.cumsum(arc(spans, np.diff(depth)), axis=0)])

    def path(at: Floats) -> Floats:
        at = np.asarray(at, float)
        i = np.clip(np.searchsorted(depth, at, side="right") - 1, 0, len(depth) - 1)
        return np.asarray(nodes[i] + arc(i, at - depth[i]))

    return path


def polyline_path(nodes: Floats) -> Path:
    """Return the straight-edged line through (k, 3) nodes, by chainage from the first."""
    chainage = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])

    def path(at: Floats) -> Floats:
        return np.column_stack([np.interp(at, chainage, nodes[:, k]) for k in range(3)])

    return path


def crossings(path: Path, length: float, offset: Callable[[Floats], Floats]) -> list[float]:
    """Return the places along a path, in order, where its offset from a horizon goes through zero."""
    at = np.linspace(0.0, length, max(2, int(length / _STEP) + 1))
    value = offset(path(at))
    found = []
    for i in np.flatnonzero(np.sign(value[:-1]) * np.sign(value[1:]) < 0):
        # Past the rim of a surface that ends, the sign of the distance jumps where the distance is not zero.
        if abs(value[i]) > 3 * _STEP:
            continue
        place = zero_between(lambda d: offset(path(d)), at[i], at[i + 1])
        if abs(offset(path(np.array([place])))[0]) < 1e-4:
            found.append(place)
    return found


def zero_between(value: Callable[[Floats], Floats], low: float, high: float) -> float:
    """Return where, between two places of opposite sign, a function of an array changes its sign."""
    for _ in range(7):
        at = np.linspace(low, high, 33)
        sign = np.sign(value(at))
        i = int(np.argmax(sign != sign[0]))
        low, high = at[i - 1], at[i]
    return float(0.5 * (low + high))

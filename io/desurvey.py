"""The path of a borehole from its survey, by minimum curvature.

Between two stations the hole is an arc of a circle that is tangent to both attitudes (Sawaryn & Thorogood
2005, "A compendium of directional calculations based on the minimum curvature method", SPE 84246). Before
the first station and beyond the last it goes straight on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["METHODS", "Desurvey", "WellPath", "desurvey", "minimum_curvature", "tangential"]

Floats = NDArray[np.float64]
Desurvey = Literal["minimum-curvature", "tangential"]
METHODS: tuple[str, ...] = get_args(Desurvey)


@dataclass(frozen=True, eq=False)
class WellPath:
    """Stations of a hole: ``depth`` (k,) ascending, unit ``tangent`` (k, 3), ``xyz`` (k, 3), metres.

    ``straight``: the attitude of a station holds down to the next one.
    """

    depth: Floats
    tangent: Floats
    xyz: Floats
    straight: bool = False

    def at(self, depth: ArrayLike) -> Floats:
        """Return the places (n, 3) at depths (n,) along the hole, on the lines or arcs between the stations."""
        d = np.atleast_1d(np.asarray(depth, dtype=np.float64))
        k = len(self.depth)
        i = np.clip(np.searchsorted(self.depth, d, side="right") - 1, 0, k - 1)
        j = np.minimum(i + 1, k - 1)
        step = d - self.depth[i]
        if self.straight:
            return np.asarray(self.xyz[i] + step[:, None] * self.tangent[i])
        course = np.where(j > i, self.depth[j] - self.depth[i], 1.0)
        angle = _angle(self.tangent[i], self.tangent[j])
        turned = _slerp(self.tangent[i], self.tangent[j], angle, np.where(j > i, step / course, 0.0))
        arc = 0.5 * (step * _ratio(angle * np.where(j > i, step / course, 0.0)))[:, None]
        return self.xyz[i] + arc * (self.tangent[i] + turned)

    def depth_of(self, elevation: ArrayLike) -> Floats:
        """Return the depths (n,) at which the hole, going down, has elevations (n,); nan where it has not.

        Newton's method from the chords between the stations.
        """
        z = np.atleast_1d(np.asarray(elevation, dtype=np.float64))
        last = self.depth[-1] + np.maximum(self.xyz[-1, 2] - z, 0.0) / max(-self.tangent[-1, 2], 1e-3)
        rises = np.r_[-self.xyz[:, 2], np.inf]
        d = np.where(-z > rises[-2], last, np.interp(-z, np.maximum.accumulate(rises[:-1]), self.depth))
        for _ in range(30):
            here, ahead = self.at(d)[:, 2], self.at(d + 1e-3)[:, 2]
            slope = np.minimum((ahead - here) / 1e-3, -1e-3)
            d = np.maximum(d + (z - here) / slope, 0.0)
        return np.where(np.abs(self.at(d)[:, 2] - z) < 1e-6, d, np.nan)


def desurvey(method: Desurvey, collar: ArrayLike, depth: ArrayLike, azimuth: ArrayLike, dip: ArrayLike) -> WellPath:
    """Return the path of one hole by one of :data:`METHODS`; see :func:`minimum_curvature`."""
    path = tangential if method == "tangential" else minimum_curvature
    return path(collar, depth, azimuth, dip)


def minimum_curvature(collar: ArrayLike, depth: ArrayLike, azimuth: ArrayLike, dip: ArrayLike) -> WellPath:
    """Return the path of one hole.

    Parameters
    ----------
    collar : (3,) array_like
        Easting, northing, elevation of the hole's mouth, metres.
    depth : (k,) array_like
        Depth of each station along the hole, ascending, metres; the path starts at depth 0 with the attitude
        of the first station.
    azimuth, dip : (k,) array_like
        Degrees: azimuth clockwise from grid north, dip from the horizontal, positive downwards.
    """
    s, tangent = _stations(depth, azimuth, dip)
    first, second = tangent[:-1], tangent[1:]
    ratio = _ratio(_angle(first, second))
    arcs = 0.5 * (np.diff(s) * ratio)[:, None] * (first + second)
    xyz = np.asarray(collar, dtype=np.float64) + np.vstack([np.zeros(3), np.cumsum(arcs, axis=0)])
    return WellPath(s, tangent, xyz)


def tangential(collar: ArrayLike, depth: ArrayLike, azimuth: ArrayLike, dip: ArrayLike) -> WellPath:
    """Return the path of one hole, straight from each station to the next with the upper one's attitude.

    Parameters are those of :func:`minimum_curvature`.
    """
    s, tangent = _stations(depth, azimuth, dip)
    courses = np.diff(s)[:, None] * tangent[:-1]
    xyz = np.asarray(collar, dtype=np.float64) + np.vstack([np.zeros(3), np.cumsum(courses, axis=0)])
    return WellPath(s, tangent, xyz, straight=True)


def _stations(depth: ArrayLike, azimuth: ArrayLike, dip: ArrayLike) -> tuple[Floats, Floats]:
    """Return depths from 0 on and the unit tangents there."""
    s = np.asarray(depth, dtype=np.float64)
    a, d = np.radians(np.asarray(azimuth, dtype=np.float64)), np.radians(np.asarray(dip, dtype=np.float64))
    if s[0] > 0.0:
        s, a, d = np.r_[0.0, s], np.r_[a[0], a], np.r_[d[0], d]
    return s, np.column_stack([np.sin(a) * np.cos(d), np.cos(a) * np.cos(d), -np.sin(d)])


def _angle(first: Floats, second: Floats) -> Floats:
    """Return the angle (n,) between unit vectors, exact for small angles too."""
    sine = np.linalg.norm(np.cross(first, second), axis=1)
    return np.asarray(np.arctan2(sine, np.einsum("ij,ij->i", first, second)))


def _ratio(angle: Floats) -> Floats:
    """Return tan(angle / 2) / (angle / 2), the arc's ratio factor."""
    half = 0.5 * angle
    small = half < 1e-4
    return np.where(small, 1.0 + half**2 / 3.0, np.tan(half) / np.where(small, 1.0, half))


def _slerp(first: Floats, second: Floats, angle: Floats, share: Floats) -> Floats:
    """Return the unit vectors at a share of the way from the first to the second."""
    small = angle < 1e-9
    sine = np.where(small, 1.0, np.sin(angle))
    p = np.where(small, 1.0 - share, np.sin((1.0 - share) * angle) / sine)
    q = np.where(small, share, np.sin(share * angle) / sine)
    return np.asarray(p[:, None] * first + q[:, None] * second)

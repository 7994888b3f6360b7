"""The standard deviation held to what points left out show.

The posterior of a smoothing spline is right on the average only where its energy suits the relief. It is therefore
widened by a local factor, never narrowed, so that 90 % of left-out errors lie inside the 90 % band. Every place of the
surface speaks for left-out errors twice, and both count alike:

- by nearness: for the point next to it, left out alone, with its small block and with its section. A dense core's many
  points thus weigh no more than their area;
- by likeness: of the points near it, for the one whose standard deviation, when left out by any scheme, comes nearest
  to that of the place. A place between two sections is like a point whose section is left out as a whole, one beside a
  hole like a point left out alone.

At last the band is widened until it contains 90 % of the left-out holes themselves, if it does not yet. A factor below
1 would make the band narrower than the fit itself expects: the band would contain less than its name says wherever the
left-out points are nearer to data than the place in question.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from geofit.fitting.deletion import LinearFit, Prediction
from geofit.fitting.posterior import Posterior

__all__ = [
    "BAND",
    "LEAST_HELD",
    "Calibration",
    "LeftOutPoints",
    "calibrate",
    "common_factor",
    "factor_for",
    "gathered",
    "share_inside",
    "uncalibrated",
    "variance_of",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Half width of the 90 % band of a normal distribution, in standard deviations, and its share.
BAND, SHARE = 1.6448536269514722, 0.9
#: Share of the left-out holes that the 90 % band must contain at least: its name.
LEAST_HELD = SHARE
#: Points near a place among which its like is sought.
_NEAR = 8
#: Points that a local factor is estimated from, and the part of their weight that the whole area has in it.
_LOCAL, _WHOLE = 30, 0.25
#: A single point counts for no more than this many times the common square.
_CAP = 9.0
#: Least factor: where errors are no larger than the points' own noise, they say nothing about the surface.
_LEAST = 0.2
#: Fewer points left out than these tell nothing about a 90 % band.
FEWEST = 10


@dataclass(frozen=True, eq=False)
class LeftOutPoints:
    """Left-out errors to calibrate by; a point may be given here once for each scheme that left it out.

    ``point`` (m,) numbers of the points, ``error`` (m,) metres, ``variance`` (m,) of the surface as predicted, and
    ``noise`` (m,) variance of the point's own height, m^2.
    """

    point: Ints
    error: Floats
    variance: Floats
    noise: Floats

    def joined(self, other: LeftOutPoints) -> LeftOutPoints:
        """Return these errors and others after them."""
        both = zip(vars(self).values(), vars(other).values(), strict=True)
        return LeftOutPoints(*(np.concatenate(pair) for pair in both))


@dataclass(frozen=True, eq=False)
class Calibration:
    """Factors of the standard deviation: ``square`` and ``weight`` (n,) at the points, ``common`` for the whole."""

    plane: Floats
    square: Floats
    weight: Floats
    common: float
    scale: float

    def at(self, plane: Floats) -> Floats:
        """Return the (k,) factors at (k, 2) places, at least 1."""
        return np.maximum(self.scale * self.local(plane), 1.0)

    def local(self, plane: Floats) -> Floats:
        """Return the (k,) local factors before they are scaled for the whole; below 1 where the band is too wide."""
        if not len(self.plane):
            return np.full(len(plane), self.common)
        count = min(_LOCAL, len(self.plane))
        near = KDTree(self.plane).query(plane, k=count)[1].reshape(len(plane), count)
        whole = _WHOLE * count * self.weight.mean()
        mean = (self.square[near].sum(axis=1) + whole * self.common**2) / (self.weight[near].sum(axis=1) + whole)
        return np.asarray(np.sqrt(mean))


def uncalibrated() -> Calibration:
    """Return the calibration that changes nothing."""
    return Calibration(np.empty((0, 2)), np.empty(0), np.empty(0), 1.0, 1.0)


def calibrate(
    plane: Floats, near: LeftOutPoints, blocks: LeftOutPoints, holes: LeftOutPoints, places: Floats, variance: Floats
) -> Calibration:
    """Find the factors by which the standard deviation must be widened.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points.
    near : LeftOutPoints
        Points left out alone, by small blocks, and by sections.
    blocks : LeftOutPoints
        Points left out by large blocks: they are like the places farthest from data.
    holes : LeftOutPoints
        Points left out by holes, of which the band must hold :data:`LEAST_HELD`.
    places : (k, 2) array
        Places all over the surface.
    variance : (k,) array
        Variance of the surface there, m^2.
    """
    if len(np.unique(near.point)) < FEWEST:
        return uncalibrated()
    every = near.joined(blocks)
    area = np.bincount(KDTree(plane).query(places)[1], minlength=len(plane)).astype(float)
    by_area = np.concatenate([area[near.point], np.zeros(len(blocks.point))])
    by_likeness = _likeness(plane, every, places, variance)
    weight = _shares(by_area) + _shares(by_likeness)
    common = factor_for(every, 1.0, weight, SHARE)
    ratio = np.minimum(every.error**2 / (every.variance + every.noise), _CAP * common**2)
    n = len(plane)
    square = _sums(every.point, weight * ratio, n)
    local = Calibration(plane, square, _sums(every.point, weight, n), common, 1.0)
    at = local.local(plane)
    scale = factor_for(every, at[every.point], weight, SHARE)
    if len(holes.point) >= FEWEST:
        scale = max(scale, factor_for(holes, at[holes.point], np.ones(len(holes.point)), LEAST_HELD))
    return replace(local, scale=scale)


def share_inside(error: Floats, variance: Floats) -> float:
    """Return the share of errors within the 90 % band; nan of none."""
    known = np.isfinite(error)
    return float(np.mean(np.abs(error[known]) <= BAND * np.sqrt(variance[known]))) if known.any() else float("nan")


def _sums(point: Ints, values: Floats, n: int) -> Floats:
    return np.bincount(point, values, minlength=n).astype(np.float64, copy=False)


def _shares(weight: Floats) -> Floats:
    """Return weights whose sum is 1; alike where none counts, as where all points stand at one location."""
    total = weight.sum()
    return weight / total if total > 0 else np.full(len(weight), 1 / len(weight))


def _likeness(plane: Floats, left: LeftOutPoints, places: Floats, variance: Floats) -> Floats:
    """Return (m,) how many places each left-out error speaks for: the one nearest in variance of the nearest points."""
    count = min(_NEAR, len(plane))
    near = KDTree(plane).query(places, k=count)[1].reshape(len(places), count)
    order = np.argsort(left.point, kind="stable")
    copies = np.bincount(left.point, minlength=len(plane))
    start = np.cumsum(copies) - copies
    best = np.full(len(places), np.inf)
    chosen = np.full(len(places), -1)
    level = np.log(np.maximum(variance, 1e-300))
    for k in range(count):
        for copy in range(int(copies.max())):
            point = near[:, k]
            has = copies[point] > copy
            pair = order[np.where(has, start[point] + copy, 0)]
            gap = np.abs(np.log(np.maximum(left.variance[pair], 1e-300)) - level)
            nearer = has & (gap < best)
            best[nearer], chosen[nearer] = gap[nearer], pair[nearer]
    return np.bincount(chosen[chosen >= 0], minlength=len(left.point)).astype(float)


def factor_for(left: LeftOutPoints, local: Floats | float, weight: Floats, share: float) -> float:
    """Return the least factor of the standard deviation, beside the local one, with a share of the weight inside."""
    needed = np.maximum((left.error / BAND) ** 2 - left.noise, 0.0) / np.maximum(left.variance * local**2, 1e-300)
    order = np.argsort(needed, kind="stable")
    reached = np.cumsum(weight[order])
    k = int(np.searchsorted(reached, share * reached[-1] * (1 - 1e-12)))
    # The point that the factor is taken from lies inside, rounding or not.
    return max(float(np.sqrt(needed[order][min(k, len(needed) - 1)])) * (1 + 1e-9), _LEAST)


def common_factor(fit: LinearFit, judged: NDArray[np.bool_]) -> float:
    """Return the factor of the standard deviation that holds 90 % of the judged points, each left out alone."""
    alone = fit.without([np.array([k]) for k in np.flatnonzero(judged)])
    left = gathered(fit.posterior, [alone])
    return factor_for(left, 1.0, np.ones(len(left.point)), SHARE) if len(left.point) >= FEWEST else 1.0


def gathered(given: Posterior, predictions: list[Prediction]) -> LeftOutPoints:
    """Put the errors of several predictions one after another, without the points that were not left out."""
    noise = given.noise_variance
    point = np.tile(np.arange(len(given.value)), len(predictions))
    error = np.concatenate([np.empty(0), *(one.error for one in predictions)])
    variance = np.concatenate([np.empty(0), *(variance_of(one) for one in predictions)])
    known = np.isfinite(error)
    return LeftOutPoints(point[known], error[known], variance[known], noise[point[known]])


def variance_of(predicted: Prediction) -> Floats:
    """Mean square error of the surface at a point left out: the field's, and the surface's departure from the field."""
    return np.asarray(predicted.variance + (predicted.error - predicted.field_error) ** 2)

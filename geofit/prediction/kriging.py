"""Ordinary kriging, to be compared with (Journel & Huijbregts 1978, Mining Geostatistics, ch. V).

The variogram is estimated by Matheron's mean of squares on distances up to half the extent. A spherical and a linear
model with a nugget are fitted by least squares weighted as Cressie (1985, Math. Geology 17, 563-586) does, and the
better one is taken. Each place is estimated from its nearest points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial.distance import cdist, pdist

__all__ = ["Variogram", "fit_variogram", "krige_left_out"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points that one estimate is made of.
NEIGHBOURS = 50
#: Classes of distance of the experimental variogram.
CLASSES = 15
#: Ranges that are tried for the spherical model, as shares of the longest distance.
_RANGES = np.geomspace(0.1, 4.0, 24)
#: Points whose distances the variogram is estimated from.
_MOST = 2_000
#: Distances that may be looked at to fit a variogram without each group; where it takes more, one group out of so many
#: points hardly changes it, and all points give one variogram.
_AFFORDED = 20_000_000
#: Fewer points than these have no variogram of their own once one is left out.
_FEW = 10


@dataclass(frozen=True)
class Variogram:
    """``nugget`` + ``sill`` * spherical(h / ``reach``), or ``nugget`` + ``slope`` * h where ``reach`` is infinite."""

    nugget: float
    sill: float
    reach: float
    slope: float = 0.0

    def __call__(self, h: Floats) -> Floats:
        """Return half the mean square difference at distances h > 0; zero at 0."""
        t = np.minimum(h / self.reach, 1.0)
        value = self.nugget + self.sill * (1.5 * t - 0.5 * t**3) + self.slope * h
        return np.where(h > 0, value, 0.0)


def fit_variogram(plane: Floats, z: Floats) -> Variogram:
    """Fit a variogram model to (n,) values at (n, 2) places.

    Where no two places are nearer than half the extent (three boreholes, the corners of a square), all distances
    count; where there are no two places, the variogram is the line of slope 1.
    """
    part = np.linspace(0, len(z) - 1, min(len(z), _MOST)).astype(int)
    h = pdist(plane[part])
    half_square = pdist(z[part, None], "sqeuclidean") / 2
    if not h.any():
        return Variogram(0.0, 0.0, np.inf, 1.0)
    longest = float(h.max()) / 2
    if not (h[h > 0] < longest).any():
        longest = float(np.nextafter(h.max(), np.inf))
    cell = np.floor(h / longest * CLASSES).astype(int)
    near = cell < CLASSES
    count = np.bincount(cell[near], minlength=CLASSES)
    full = count > 0
    if not full.any():  # a few points, all farther apart than half the extent: nothing supports another model
        return Variogram(0.0, 0.0, np.inf, 1.0)
    distance = np.bincount(cell[near], h[near], minlength=CLASSES)[full] / count[full]
    gamma = np.bincount(cell[near], half_square[near], minlength=CLASSES)[full] / count[full]
    root = np.sqrt(count[full]) / np.maximum(gamma, 1e-6 * max(float(gamma.max()), 1e-12))
    best, model = np.inf, Variogram(0.0, 0.0, np.inf, 1.0)
    for reach in (*(_RANGES * longest), np.inf):
        shape = distance if np.isinf(reach) else Variogram(0.0, 1.0, reach)(distance)
        (nugget, rise), misfit = nnls(np.column_stack([np.ones_like(shape), shape]) * root[:, None], gamma * root)
        if misfit < best and nugget + rise > 0:
            best = misfit
            model = Variogram(nugget, 0.0, reach, rise) if np.isinf(reach) else Variogram(nugget, rise, reach)
    return model


def krige_left_out(plane: Floats, z: Floats, groups: Sequence[Ints]) -> Floats:
    """Return (n,) estimates at the points of each group from the nearest points of the other groups; else nan.

    The variogram too is that of the other groups, where their number allows it.
    """
    refitted = len(z) >= _FEW and len(groups) * min(len(z), _MOST) ** 2 <= _AFFORDED
    common = None if refitted else fit_variogram(plane, z)
    estimate = np.full(len(z), np.nan)
    every = np.arange(len(z))
    for group in groups:
        rest = np.delete(every, group)
        if not len(rest):
            continue
        h = cdist(plane[group], plane[rest])
        model = common or fit_variogram(plane[rest], z[rest])
        near = np.argsort(h, axis=1, kind="stable")[:, :NEIGHBOURS]
        estimate[group] = _ordinary(model, plane[rest][near], z[rest][near], np.take_along_axis(h, near, axis=1))
    return estimate


def _ordinary(model: Variogram, places: Floats, z: Floats, h: Floats) -> Floats:
    """Return the estimates of m places from (m, k) neighbours: weights of sum 1, least variance."""
    m, k = z.shape
    system = np.ones((m, k + 1, k + 1))
    system[:, :k, :k] = model(np.linalg.norm(places[:, :, None] - places[:, None], axis=-1))
    system[:, k, k] = 0.0
    right = np.ones((m, k + 1, 1))
    right[:, :k, 0] = model(h)
    weights = np.linalg.solve(system, right)[:, :k, 0]
    return np.asarray((weights * z).sum(axis=1))

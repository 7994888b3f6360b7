"""Where the next holes tell most: greedy, each where it lowers the mean standard deviation of the surface most.

A hole at place j with noise variance t turns the covariance S into S - S_j S_j' / (S_jj + t), whatever it will find
(a rank-one update). So the gain of every candidate is known beforehand, and holes keep apart by themselves: beside a
hole little is left to learn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.prediction import Suggestion
from geofit.prediction.bands import Grid, PredictionError

__all__ = ["DrillingPlan", "greedy_holes", "suggest_holes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Candidate places, about.
CANDIDATES = 1_200
#: Columns of candidates judged at once.
_CHUNK = 256


@dataclass(frozen=True, eq=False)
class DrillingPlan:
    """Candidates in greedy order, and the mean of the standard deviation after each, metres."""

    chosen: Ints
    mean_after: Floats


def greedy_holes(covariance: Floats, rest: Floats, noise: float, count: int) -> DrillingPlan:
    """Choose holes one after another.

    Parameters
    ----------
    covariance : (m, m) array
        Covariance of the surface among the candidate places, m^2.
    rest : (m,) array
        Variance that no hole lowers, m^2.
    noise : float
        Variance of the height that a hole gives, m^2.
    count : int
        Number of holes; fewer where no candidate gains anything.
    """
    left = covariance.copy()
    chosen: list[int] = []
    means: list[float] = []
    for _ in range(min(count, len(left))):
        variance = np.diag(left)
        after = np.empty(len(left))
        for start in range(0, len(left), _CHUNK):
            part = slice(start, start + _CHUNK)
            lowered = variance[:, None] - left[:, part] ** 2 / (variance[part] + noise)
            after[part] = np.sqrt(np.maximum(lowered, 0.0) + rest[:, None]).mean(axis=0)
        after[chosen] = np.inf
        best = int(np.argmin(after))
        if not after[best] < np.sqrt(np.maximum(variance, 0.0) + rest).mean() * (1 - 1e-9):
            break
        chosen.append(best)
        means.append(float(after[best]))
        left = left - np.outer(left[:, best], left[best]) / (left[best, best] + noise)
    return DrillingPlan(np.array(chosen, dtype=np.int64), np.array(means))


def suggest_holes(grid: Grid, error_model: PredictionError, count: int = 10) -> tuple[Suggestion, ...]:
    """Return the next holes over the study area, with what they leave on all nodes of the grid."""
    model, posterior = error_model.model, error_model.posterior
    index = _thinned(grid)
    factors = error_model.calibration.at(grid.plane)
    noise = error_model.contact_noise**2
    of_all, variance = posterior.variance(grid.plane), error_model.field(grid.plane)[1]
    rest = factors**2 * np.maximum(error_model.variance(grid.plane) - variance, 0.0)
    # In a core with a field of its own, the covariance keeps its form, and takes the variance of that field.
    scales = factors * np.sqrt(variance / np.maximum(of_all, np.finfo(float).tiny))
    scale = scales[index]
    among = posterior.covariance(grid.plane[index]) * np.outer(scale, scale)
    chosen = index[greedy_holes(among, rest[index], noise, count).chosen]
    if not len(chosen):
        return ()
    # The same updates once more, on every node: only the columns of the holes are needed.
    columns = posterior.covariance_with(grid.plane, grid.plane[chosen]) * np.outer(scales, scales[chosen])
    variance = factors**2 * variance
    before = np.sqrt(variance + rest)
    places = grid.places(model)
    suggestions = []
    for k, node in enumerate(chosen):
        column = columns[:, k].copy()
        gain = column / np.sqrt(column[node] + noise)
        variance = np.maximum(variance - gain**2, 0.0)
        columns -= np.outer(gain, gain[chosen])
        after = np.sqrt(variance + rest)
        x, y, z = (float(value) for value in places[node])
        suggestions.append(Suggestion(x, y, z, float(before[node]), float(after.mean()), float(after.max())))
    return tuple(suggestions)


def _thinned(grid: Grid) -> Ints:
    """Return the nodes on the surface of every so many rows and columns: about :data:`CANDIDATES`."""
    stride = max(int(np.ceil(np.sqrt(len(grid.plane) / CANDIDATES))), 1)
    number = np.full(grid.within.shape, -1)
    number[grid.within] = np.arange(len(grid.plane))
    some = number[stride // 2 :: stride, stride // 2 :: stride].ravel()
    some = some[some >= 0]
    return some if len(some) else np.arange(len(grid.plane))

"""Points of a small set left out by true refits: each time field, knots and noise are chosen anew.

The formulas of :mod:`geofit.fitting.deletion` keep what the fit of all points chose. Of many points one group hardly
changes that; of a few it does, and errors found so look smaller than they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.fitting.deletion import Prediction
from geofit.fitting.model import Model, Problem
from geofit.fitting.posterior import Posterior, posterior
from geofit.streaming.executors import HERE, Where

__all__ = ["SMALL", "Refits"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Sets of fewer points are left out by true refits.
SMALL = 30
#: Fewer points than these span no plane.
_LEAST = 3


@dataclass(frozen=True, eq=False)
class Refits:
    """A fit of few points that is made anew without each group; ``posterior`` is that of all points.

    ``where`` is where these fits are made.
    """

    model: Model
    posterior: Posterior
    where: Where = HERE
    _known: dict[tuple[int, ...], tuple[Floats, Floats, Floats]] = field(default_factory=dict)

    def without(self, groups: Sequence[Ints]) -> Prediction:
        """Predict each group of points from all others.

        Parameters
        ----------
        groups : sequence of arrays of int
            Numbers of points among those that the fit honours; no point in two groups. A group without which no
            surface can be fitted is not predicted.
        """
        error, field_error, variance = (np.full(len(self.posterior.value), np.nan) for _ in range(3))
        keys = [tuple(group.tolist()) for group in groups]
        new = [key for key in dict.fromkeys(keys) if key not in self._known]
        tasks = [(self.model.problem, self.posterior.kept[list(key)]) for key in new]
        for k, found in self.where.run(_predicted, tasks):
            self._known[new[k]] = found
        for group, key in zip(groups, keys, strict=True):
            error[group], field_error[group], variance[group] = self._known[key]
        return Prediction(error, field_error, variance)


def _predicted(task: tuple[Problem, Ints]) -> tuple[Floats, Floats, Floats]:
    """Return errors of the surface and of the field, and the field's variance, at points that are left out."""
    problem, out = task
    kept = problem.kept & problem.parametrization.parametrized
    kept[out] = False
    unknown = np.full(len(out), np.nan)
    if kept.sum() < _LEAST:
        return unknown, unknown, unknown
    try:
        without = replace(problem, kept=kept).fit(kept, lambda stage, fraction: None)
        given = posterior(without)
    except GeofitError:
        return unknown, unknown, unknown
    net, value = without.net, problem.parametrization.values[out]
    plane = problem.parametrization.plane[out] / net.unit
    surface = net.space.matrix(plane) @ net.coefficients
    return value - surface, value - given.height(plane), given.variance(plane)

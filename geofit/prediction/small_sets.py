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
from geofit.fitting.model import Model
from geofit.fitting.posterior import Posterior, posterior

__all__ = ["SMALL", "Refits"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Sets of fewer points are left out by true refits.
SMALL = 30
#: Fewer points than these span no plane.
_LEAST = 3


@dataclass(frozen=True, eq=False)
class Refits:
    """A fit of few points that is made anew without each group; ``posterior`` is that of all points."""

    model: Model
    posterior: Posterior
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
        for group in groups:
            key = tuple(group.tolist())
            if key not in self._known:
                self._known[key] = self._predicted(group)
            error[group], field_error[group], variance[group] = self._known[key]
        return Prediction(error, field_error, variance)

    def _predicted(self, group: Ints) -> tuple[Floats, Floats, Floats]:
        """Return errors of the surface and of the field, and the field's variance, at the points of one group."""
        problem, out = self.model.problem, self.posterior.kept[group]
        kept = problem.kept & problem.parametrization.parametrized
        kept[out] = False
        unknown = np.full(len(group), np.nan)
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

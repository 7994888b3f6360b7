"""Robust weights: peripheral points that their neighbours contradict take no part in the fit, and are named.

The weight of a point is 1 while its left-out error is within :data:`geofit.fitting.outliers.LIMIT` times its
standard deviation, and 0 beyond (Huber's skipped mean; Hampel et al. 1986, Robust Statistics, sec. 2.6). Weights and
fit are found in turn, each point being judged anew every round, until the weights stay. A weight between 0 and 1 would
still be pulled into the tolerance with its point. The core's points are exact, and are never judged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.fitting.calibration import common_factor
from geofit.fitting.deletion import linear_fit
from geofit.fitting.model import Model, names_of
from geofit.fitting.outliers import LIMIT, find_outliers
from geofit.fitting.posterior import noise_of_unused, posterior

__all__ = ["fit_robustly"]

#: Rounds of judging and fitting.
ROUNDS = 5
#: More points than these are not judged: their covariance would not fit.
MOST = 4_000


def fit_robustly(model: Model, stage: Callable[[str, float], None]) -> Model:
    """Fit again without the peripheral outliers, until no more are found and none comes back.

    Parameters
    ----------
    model : Model
        The ordinary fit of a height field.
    stage : callable
        Hears of the stages.
    """
    given = model.problem
    before = given.kept
    rejected = np.zeros(len(before), bool)
    for _ in range(ROUNDS):
        if int(model.problem.kept.sum()) > MOST:
            return _noted(
                model,
                message(
                    "fitting.too-many-points-for-robust",
                    "{count} points are too many for robust weights",
                    count=int(before.sum()),
                ),
            )
        now = _judge(model, rejected)
        if (now == rejected).all():
            break
        rejected = now
        problem = replace(given, kept=before & ~rejected)
        model = problem.fit(problem.kept, stage)
    if not rejected.any():
        return model
    text = message(
        "fitting.outliers-not-used",
        "robust: peripheral points that their neighbours contradict are not used in the fit "
        "({count}: {names}); sigma counts them all the same",
        count=int(rejected.sum()),
        names=names_of(given.points, np.flatnonzero(rejected)),
    )
    return _noted(model, text.with_severity("warning"))


def _judge(model: Model, rejected: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which points are outliers of the fit, those that took no part in it included."""
    given = posterior(model)
    fit = linear_fit(model, given)
    parametrization, unit = model.problem.parametrization, model.net.unit
    loose = ~model.problem.split.inside[given.kept]
    factor = common_factor(fit, loose)
    found = find_outliers(fit, np.full(len(given.value), factor), loose)
    result = np.zeros(len(rejected), bool)
    result[[outlier.index for outlier in found]] = True
    out = np.flatnonzero(rejected)
    if len(out):
        plane = parametrization.plane[out] / unit
        error = parametrization.values[out] - given.height(plane)
        sd = np.sqrt(factor**2 * given.variance(plane) + noise_of_unused(given, model, out) ** 2)
        result[out] = np.abs(error) > LIMIT * sd
    return result


def _noted(model: Model, note: Message) -> Model:
    return model.with_net(replace(model.net, notes=(*model.net.notes, note)))

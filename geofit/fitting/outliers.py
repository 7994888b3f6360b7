"""Points that their neighbours contradict: shown, never dropped by themselves.

A point's left-out error is set against its own standard deviation, which holds the field's without the point and the
noise, both as large as the other points find them: S_(i) = S - w_i r_i^2 / (1 - h_i) (externally studentised residuals;
Cook & Weisberg 1982, Residuals and Influence in Regression, sec. 2.2). The worst point is taken out before the next is
looked for: a blunder drags the field to itself, and would otherwise accuse its neighbours, or hide another beside it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.prediction import Outlier
from geofit.fitting.deletion import LinearFit

__all__ = ["LIMIT", "MOST", "find_outliers"]

Floats = NDArray[np.float64]

#: Left-out errors beyond this many times their standard deviation are listed.
LIMIT = 3.5
#: Largest share of the points that can be outliers: more of them are the rule.
MOST = 0.1


def find_outliers(fit: LinearFit, factor: Floats, judged: NDArray[np.bool_] | None = None) -> tuple[Outlier, ...]:
    """List the outliers among a fit's points, the worst first.

    Parameters
    ----------
    fit : LinearFit
        The fit.
    factor : (n,) array
        Local factor of the field's standard deviation at each point (:mod:`geofit.fitting.calibration`).
    judged : (n,) array of bool, optional
        Points that may be outliers; all by default.

    Returns
    -------
    tuple of Outlier
        ``index`` counts all points of the horizon, those that were dropped to others included.
    """
    given = fit.posterior
    covariance, residual, square = fit.covariance.copy(), given.residual.copy(), given.square
    present = np.ones(len(residual), bool)
    degrees = max(len(residual) - 3, 1)
    open_to = np.ones(len(residual), bool) if judged is None else judged
    found = []
    for _ in range(int(MOST * len(residual))):
        held = 1 - np.diag(covariance) * given.weight
        known = present & open_to & (held > 1e-9)
        if not known.any() or degrees < 2:
            break
        safe = np.where(known, held, 1.0)
        error = residual / safe
        others = np.maximum(square - given.weight * residual * error, 0.0) / max(square, 1e-300)
        others *= degrees / (degrees - 1)
        # The field's variance is a multiple of the noise's: a blunder swells both.
        scale = given.noise**2 * np.minimum(others, 1.0)
        variance = scale * (factor**2 * np.diag(covariance) / safe + 1 / given.weight)
        ratio = np.where(known, np.abs(error) / np.sqrt(np.maximum(variance, 1e-300)), 0.0)
        worst = int(np.argmax(ratio))
        if ratio[worst] <= LIMIT:
            break
        sd = float(np.sqrt(variance[worst]))
        found.append(Outlier(int(given.kept[worst]), float(error[worst]), sd, float(ratio[worst])))
        # Out it goes: the rank-one update of the field without it.
        square = max(square - float(given.weight[worst] * residual[worst] * error[worst]), 0.0)
        column = covariance[:, worst].copy()
        residual = residual + column * (given.weight[worst] * error[worst])
        covariance += np.outer(column, column) * (given.weight[worst] / held[worst])
        present[worst] = False
        degrees -= 1
    return tuple(sorted(found, key=lambda one: -one.ratio))

"""The predicted distribution at holes left out, scored and compared with that of a dense Gaussian process.

The continuous ranked probability score of a normal distribution, T. Gneiting & A. E. Raftery, J. Am. Stat. Assoc. 102,
2007, 359-378, eq. 21; metres, the less the better.
"""

from __future__ import annotations

from math import isfinite, nan, pi, sqrt

import numpy as np
from peers.gp import KERNELS, fit_process
from scipy.special import ndtr

from geofit import HorizonFit
from geofit.data.prediction import LeftOut
from geofit.prediction.folds import groups_of

__all__ = ["FEWEST", "no_worse", "process_score", "score_of"]

#: Fewer holes than these say little of a distribution.
FEWEST = 30


def score_of(error: np.ndarray, sd: np.ndarray) -> float:
    """Return the mean score of (m,) errors with the standard deviations that were predicted; nan where unknown."""
    known = np.isfinite(error) & (sd > 0)
    off = error[known] / sd[known]
    density = np.exp(-0.5 * off**2) / sqrt(2 * pi)
    each = sd[known] * (off * (2 * ndtr(off) - 1) + 2 * density - 1 / sqrt(pi))
    return float(each.mean()) if known.any() else nan


def process_score(surface: HorizonFit, holes: LeftOut) -> float:
    """Return the score of a Gaussian process with a plane as drift on the same holes, each left out of all points.

    Kernel, range and nugget are those of the greatest restricted likelihood of all points, as geofit's are.
    """
    assert surface.model is not None
    given = surface.model.problem
    kept = given.kept & given.parametrization.parametrized
    plane, z = given.parametrization.plane[kept], given.parametrization.values[kept]
    plane = plane - plane.mean(axis=0)
    process = min((fit_process(plane, z, kernel, 1) for kernel in KERNELS), key=lambda one: one.value)
    return score_of(*process.left_out(plane, z, groups_of(holes.group[kept])))


def no_worse(ours: float, theirs: float, limit: float) -> bool:
    """Return whether a score is known, and at most ``limit`` times another."""
    return isfinite(ours) and isfinite(theirs) and ours <= limit * theirs

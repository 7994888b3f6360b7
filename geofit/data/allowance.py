"""How far a point may lie from the surface: the tolerance, or what its stated accuracy explains."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

__all__ = ["allowance", "largest_noise"]

Floats = NDArray[np.float64]

#: Noise explains the misfits beyond which it predicts fewer points than this.
UNLIKELY = 0.5


def largest_noise(count: int) -> float:
    """Return the standard deviations beyond which normal noise puts half a point of so many."""
    return float(ndtri(1 - UNLIKELY / (2 * max(count, 1))))


def allowance(accuracy: Floats, tolerance: float, limit: float) -> Floats:
    """Return how far from the surface each point may lie, (n,) metres.

    Parameters
    ----------
    accuracy : (n,) array
        Stated accuracies, one standard deviation in metres; nan where none is stated.
    tolerance : float
        The interior tolerance. A point that is stated to be less accurate is not met within it: that would fit its
        noise.
    limit : float
        What all other points are allowed: the tolerance, or more where their noise is known from the fit.
    """
    coarse = accuracy > tolerance
    if not coarse.any():
        return np.full(len(accuracy), limit)
    return np.where(coarse, np.maximum(limit, accuracy * largest_noise(len(accuracy))), limit)

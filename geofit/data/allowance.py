"""How far a point may lie from the surface: the tolerance, or what its stated accuracy explains."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from geofit.data.points import PointSet

__all__ = ["accuracies", "allowance", "any_coarse", "largest_noise"]

Floats = NDArray[np.float64]

#: Noise explains the misfits beyond which it predicts fewer points than this.
UNLIKELY = 0.5


def largest_noise(count: int) -> float:
    """Return the standard deviations beyond which normal noise puts half a point of so many."""
    return float(ndtri(1 - UNLIKELY / (2 * max(count, 1))))


def accuracies(points: PointSet, sources: Mapping[str, float]) -> Floats:
    """Return the accuracy (n,) of points as stated, or the noise that the fit found for their kind; else nan."""
    if not sources:
        return points.accuracy
    kinds = points.labels["kind"]
    found = np.array([sources.get(kind, np.nan) for kind in kinds.table])[kinds.codes]
    return np.where(np.isnan(points.accuracy), found, points.accuracy)


def any_coarse(accuracy: Floats, tolerance: float) -> bool:
    """Tell whether any of (n,) stated accuracies is coarser than a tolerance; of a cloud that states none, at once."""
    some = accuracy if accuracy.strides != (0,) else accuracy[:1]
    return bool((some > tolerance).any())


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
    if not any_coarse(accuracy, tolerance):
        return np.full(len(accuracy), limit)
    explained = np.maximum(limit, accuracy * largest_noise(len(accuracy)))
    return np.where(accuracy > tolerance, explained, limit)

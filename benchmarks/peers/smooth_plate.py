"""A smoothing thin plate whose weight is that of generalised cross-validation, to compare with.

Source: G. Wahba, Spline Models for Observational Data, SIAM, 1990, sec. 2.4 and 4.4.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.spatial.distance import cdist
from scipy.special import xlogy

__all__ = ["smooth_plate"]


def smooth_plate(xyz: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the spline of (n, 3) points, all places different, at (m, 2) places."""
    centre, scale = xyz[:, :2].mean(axis=0), np.ptp(xyz[:, :2], axis=0).max()
    plane, z = (xyz[:, :2] - centre) / scale, xyz[:, 2]
    drift, radial = _planes(plane), _radial(plane, plane)
    orthogonal, _ = np.linalg.qr(drift, mode="complete")
    free = orthogonal[:, 3:]
    size, turn = np.linalg.eigh(free.T @ radial @ free)
    size, value = np.maximum(size, 0.0), turn.T @ (free.T @ z)

    def score(log_weight: float) -> float:
        left = np.exp(log_weight) / (size + np.exp(log_weight))
        return len(z) * float(((left * value) ** 2).sum()) / float(left.sum()) ** 2

    low, high = np.log(size.max()) - 30, np.log(size.max()) + 5
    start = min(np.linspace(low, high, 60), key=score)
    weight = np.exp(minimize_scalar(score, bounds=(start - 1, start + 1), method="bounded").x)
    pull = free @ (turn @ (value / (size + weight)))
    slope = np.linalg.lstsq(drift, z - radial @ pull - weight * pull, rcond=None)[0]
    there = (places - centre) / scale
    return _radial(there, plane) @ pull + _planes(there) @ slope


def _radial(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    square = cdist(first, second, "sqeuclidean")
    return xlogy(square, square)


def _planes(plane: np.ndarray) -> np.ndarray:
    return np.column_stack([np.ones(len(plane)), plane])

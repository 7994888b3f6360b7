"""Chamfer weights: how far a chamfer distance is from the Euclidean one, and the weights that are nearest to it.

A chamfer distance adds steps to the 8 (plane) or 26 (space) neighbours of a voxel, with one weight a kind of step. For
an offset m_1 >= m_2 >= m_3 >= 0 it is D = m_3 d_3 + (m_2 - m_3) d_2 + (m_1 - m_2) d_1 (Borgefors 1984, "Distance
transformations in arbitrary dimensions"). D is linear in the weights, so the smallest largest error over all
directions is a linear program.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message

__all__ = ["INTEGER_WEIGHTS", "ChamferError", "chamfer_error", "optimal_weights", "world_factor"]

Floats = NDArray[np.float64]

#: The integers next to the optimum with d_1 = 1, times 3.
INTEGER_WEIGHTS = (3, 4, 5)
#: Directions a unit of the largest coordinate; the error is smooth, so its extremes are good to about 1e-6.
_STEPS = 400


@dataclass(frozen=True)
class ChamferError:
    """Extremes of a chamfer distance minus the Euclidean one.

    Parameters
    ----------
    absolute : (2,) tuple of float
        Smallest and largest error of an offset whose largest coordinate is 1.
    relative : (2,) tuple of float
        Smallest and largest error of an offset of length 1.
    """

    absolute: tuple[float, float]
    relative: tuple[float, float]


def chamfer_error(weights: ArrayLike) -> ChamferError:
    """Return the error of 2 (plane) or 3 (space) chamfer weights over all directions.

    Raises
    ------
    SettingsError
        If the weights are not 2 or 3 numbers above 0 that ascend.

    Examples
    --------
    >>> low, high = chamfer_error([1, 4 / 3, 5 / 3]).absolute
    >>> round(low, 4), round(high, 4)
    (-0.0809, 0.1181)
    """
    w = _checked(weights)
    steps, length = _directions(len(w))
    error = steps @ w - length
    return ChamferError(
        (float(error.min()), float(error.max())),
        (float((error / length).min()), float((error / length).max())),
    )


def optimal_weights(dimension: int = 3, *, first: float | None = None, relative: bool = False) -> tuple[float, ...]:
    """Return the chamfer weights whose largest error over all directions is smallest.

    Parameters
    ----------
    dimension : int
        2 or 3.
    first : float, optional
        Weight of a step to a face neighbour, where it is prescribed.
    relative : bool
        Minimise the error of an offset of length 1 instead of that of an offset whose largest coordinate is 1.

    Returns
    -------
    tuple of float
        Weights of face, edge and (in space) corner neighbours. With ``first`` the edge weight in space may be any of
        a range; the smallest is returned.

    Raises
    ------
    SettingsError
        If the dimension is neither 2 nor 3.

    Notes
    -----
    The linear program min t, |D(direction) - length| <= t is solved on few directions; those where its solution
    errs most are added until no direction errs by more than t.
    """
    if dimension not in (2, 3):
        raise SettingsError(
            message("medial.dimension-unknown", "The dimension is {dimension}; give 2 or 3.", dimension=dimension)
        )
    from scipy.optimize import linprog

    steps, length = _directions(dimension)
    if relative:
        steps, length = steps / length[:, None], np.ones_like(length)
    chosen = list(range(0, len(length), max(len(length) // 50, 1)))
    bounds = [(first, first) if first is not None else (0, None), *[(0, None)] * dimension]
    # The range of equal optima is resolved to its smallest weights by a cost too small to matter to t.
    cost = np.r_[np.full(dimension, 1e-9), 1.0]
    for _ in range(100):
        a, b = steps[chosen], length[chosen]
        ones = np.ones((len(chosen), 1))
        solved = linprog(cost, np.vstack([np.hstack([a, -ones]), np.hstack([-a, -ones])]), np.r_[b, -b], bounds=bounds)
        *found, bound = np.asarray(solved.x).tolist()
        error = np.abs(steps @ np.array(found) - length)
        worst = int(error.argmax())
        if error[worst] <= bound + 1e-9:
            break
        chosen.append(worst)
    return tuple(found)


def world_factor(weights: ArrayLike) -> float:
    """Return the factor that turns a chamfer distance into a Euclidean one with the smallest relative error.

    Examples
    --------
    >>> round(world_factor([3, 4, 5]) * 3, 4)
    0.9764
    """
    low, high = chamfer_error(weights).relative
    return 2.0 / (2.0 + low + high)


def _checked(weights: ArrayLike) -> Floats:
    w = np.asarray(weights, dtype=np.float64)
    if w.ndim != 1 or len(w) not in (2, 3) or not (w[0] > 0 and (np.diff(w) >= 0).all() and np.isfinite(w).all()):
        raise SettingsError(
            message(
                "medial.chamfer-weights-fall",
                "The chamfer weights are {weights}; give 2 or 3 numbers above 0 that do not fall, such as 3, 4, 5.",
                weights=weights,
            )
        )
    return w


def _directions(dimension: int) -> tuple[Floats, Floats]:
    """Return how often each step is used in every direction (largest coordinate 1), and the direction's length."""
    grid = np.linspace(0.0, 1.0, _STEPS + 1 if dimension == 3 else 20 * _STEPS + 1)
    if dimension == 2:
        return np.column_stack([1.0 - grid, grid]), np.sqrt(1.0 + grid**2)
    a, b = (m.ravel() for m in np.meshgrid(grid, grid, indexing="ij"))
    a, b = a[b <= a], b[b <= a]
    return np.column_stack([1.0 - a, a - b, b]), np.sqrt(1.0 + a**2 + b**2)

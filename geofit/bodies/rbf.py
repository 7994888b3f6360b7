"""A radial basis function through values and gradients: r^3 or -r with a drift, or a compact correction.

The drift has a free linear part, and a quadratic part whose six coefficients are random: independent, of mean zero,
their variances about ``CURVED`` in fitted coordinates (a Bayesian drift; Omre, "Bayesian kriging", Math. Geol. 19,
1987). r^3 alone has no notion of a body: away from the holes its field soon is a plane, and bodies end too early
between them. With the quadratic part a field that closes like an ellipsoid costs little, and data that show another
shape win. A shift of the origin changes the linear part only, so it changes nothing. The drift of -r is a constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.kernels import CUBIC, LINEAR, gradients, gram, values
from geofit.data.errors import FitError
from geofit.data.messages import message

__all__ = ["DRIFTS", "Rbf", "Saddle", "rows_of"]

Floats = NDArray[np.float64]
NONE = np.zeros((0, 3))

#: Variance of each quadratic coefficient, for a unit field of covariance r^3. Chosen on planted bodies of ten shapes
#: (benchmarks/bodies.py): volumes do not change much between 30 and 300.
CURVED = 100.0
#: Rows and columns of x x^T that the six quadratic terms come from.
FIRST, SECOND = np.triu_indices(3)
#: Mixed terms occur twice in x^T A x: with twice the variance no direction is preferred.
VARIANCE = CURVED * np.where(FIRST == SECOND, 1.0, 2.0)
#: Terms of the drift by kernel, and how many of them are free; compact kernels have none.
DRIFTS = {CUBIC: (10, 4), LINEAR: (1, 1)}


@dataclass(frozen=True, eq=False)
class Rbf:
    """The function ``sum w_j k(|x - c_j|) + sum v_k . grad_c k(|x - g_k|) + trend . (1, x, xx)``; C2 everywhere.

    Parameters
    ----------
    centres, weights : (m, 3), (m,) arrays
        Places of values and their weights.
    dipoles, moments : (k, 3), (k, 3) arrays
        Places of gradients and their weights.
    trend : (10,) array
        Constant, slopes, and the coefficients of xx, xy, xz, yy, yz, zz.
    reach : float
        Radius of the compact kernel, which has no drift; 0 for r^3, -1 for -r.
    """

    centres: Floats
    weights: Floats
    dipoles: Floats
    moments: Floats
    trend: Floats
    reach: float = 0.0

    def value(self, x: Floats) -> Floats:
        """Return the values (n,) at (n, 3) places."""
        sums = values(x, self.centres, self.weights, self.dipoles, self.moments, self.reach)
        linear, square = self._drift
        return np.asarray(sums + self.trend[0] + (x * (linear + x @ square)).sum(axis=1))

    def gradient(self, x: Floats) -> Floats:
        """Return the gradients (n, 3) at (n, 3) places."""
        sums = gradients(x, self.centres, self.weights, self.dipoles, self.moments, self.reach)
        linear, square = self._drift
        return np.asarray(sums + linear + 2 * (x @ square))

    @cached_property
    def _drift(self) -> tuple[Floats, Floats]:
        """The trend's linear part, (3,), and its square part as a symmetric matrix, (3, 3)."""
        square = np.zeros((3, 3))
        square[FIRST, SECOND] = self.trend[4:] / 2
        return self.trend[1:4], square + square.T


class Saddle:
    """The factorised system of given functionals: solved for any values, and the kriging covariance given them.

    Parameters
    ----------
    points : (n, 3) array
        Where values are given; no two may coincide.
    oriented : (k, 3) array
        Where gradients are given.
    reach : float
        Radius of the compact kernel; 0 for r^3, -1 for -r.

    Raises
    ------
    FitError
        If the places leave a linear function free (all on one plane, or fewer than four).
    """

    def __init__(self, points: Floats, oriented: Floats = NONE, reach: float = 0.0) -> None:
        from scipy.linalg import get_lapack_funcs

        self.points, self.oriented, self.reach = points, oriented, reach
        self._trends, free = DRIFTS.get(reach, (0, 0))
        side = _trend(points, oriented)[:, : self._trends]
        if np.linalg.matrix_rank(side[:, :free], tol=1e-9 * max(len(side), 4)) < free:
            raise FitError(
                message(
                    "bodies.trend-undetermined",
                    "{count} places lie on one plane or fewer than four are given: they leave the trend of the field "
                    "free. Add contacts, or samples inside and outside, off that plane.",
                    count=len(points) + len(oriented),
                )
            )
        size = len(side)
        matrix = np.zeros((size + self._trends, size + self._trends), order="F")
        matrix[:size, :size] = gram(points, oriented, points, oriented, reach)
        matrix[:size, size:] = side
        matrix[size:, :size] = side.T
        matrix[size + free :, size + free :] = -np.diag(1.0 / VARIANCE[: self._trends - free])
        if not len(matrix):
            return
        routines: Any = get_lapack_funcs(("sytrf", "sytrf_lwork"), (matrix,))
        sytrf, work = routines
        length = int(work(len(matrix), lower=1)[0])
        self._factor, self._pivots, info = sytrf(matrix, lower=1, lwork=length, overwrite_a=1)
        if info:
            raise FitError(
                message(
                    "bodies.conditions-singular",
                    "The system of {count} conditions is singular: two of them coincide. Merge them.",
                    count=size,
                )
            )

    def solve(self, right: Floats) -> Floats:
        """Return the weights for right-hand sides (n + 3k,) or (n + 3k, m), the drift's rows last."""
        whole = np.zeros((len(right) + self._trends, *right.shape[1:]), order="F")
        whole[: len(right)] = right
        return self._solved(whole)

    def interpolate(self, values_: Floats, gradients_: Floats = NONE) -> Rbf:
        """Return the function with these values (n,) and gradients (k, 3); one step of refinement."""
        right = np.concatenate([values_, gradients_.ravel()])
        solution = self.solve(right)
        rbf = self._function(solution)
        rest = np.concatenate([values_ - rbf.value(self.points), (gradients_ - rbf.gradient(self.oriented)).ravel()])
        return self._function(solution + self.solve(rest))

    def _function(self, solution: Floats) -> Rbf:
        n, size = len(self.points), len(self.points) + 3 * len(self.oriented)
        trend = np.zeros(10)
        trend[: self._trends] = solution[size:]
        moments = solution[n:size].reshape(-1, 3)
        return Rbf(self.points, solution[:n], self.oriented, moments, trend, self.reach)

    def rows(self, x: Floats) -> Floats:
        """Return the rows (m, n + 3k, and those of the drift) that give values at x from weights."""
        return rows_of(x, self.points, self.oriented, self.reach)

    def covariance(self, x: Floats) -> Floats:
        """Return the (m, m) covariance of the field's values at x, given those of the system, for a unit field.

        The dual view of kriging: an intrinsic random field of order one with generalised covariance r^3
        (Matheron, "The intrinsic random functions", Adv. Appl. Prob. 5, 1973).
        """
        rows = self.rows(x)
        whole = gram(x, NONE, x, NONE, self.reach) - rows @ self.solve_rows(rows)
        return np.asarray((whole + whole.T) / 2)

    def variance(self, x: Floats) -> Floats:
        """Return the (m,) diagonal of :meth:`covariance`; never below zero."""
        parts = []
        for block in np.array_split(x, max(1, len(x) // 2000)):
            rows = self.rows(block)
            own = 0.0 if self.reach in DRIFTS else 1.0
            parts.append(own - np.einsum("ij,ji->i", rows, self.solve_rows(rows)))
        return np.asarray(np.maximum(np.concatenate(parts), 0.0))

    def precision(self) -> Floats:
        """Return the diagonal (n + 3k,) of the inverse: one over the variance of each value left out."""
        size = len(self.points) + 3 * len(self.oriented)
        return np.array([self.solve(np.eye(1, size, k)[0])[k] for k in range(size)])

    def solve_rows(self, rows: Floats) -> Floats:
        """Return the inverse of the system times rows (m, ...) of :meth:`rows`, as columns."""
        return self._solved(np.asfortranarray(rows.T))

    def _solved(self, right: Floats) -> Floats:
        # Not kept: a routine of LAPACK cannot be sent to another process.
        from scipy.linalg.lapack import dsytrs

        # LAPACK takes no empty system.
        return np.asarray(dsytrs(self._factor, self._pivots, right, lower=1)[0]) if right.size else right


def rows_of(x: Floats, points: Floats, oriented: Floats, reach: float) -> Floats:
    """Return the rows (m, n + 3k, and those of the drift where there is one) that give values at x from weights."""
    rows = gram(x, NONE, points, oriented, reach)
    terms = DRIFTS.get(reach, (0, 0))[0]
    return np.hstack([rows, _monomials(x)[:, :terms]]) if terms else rows


def _trend(points: Floats, oriented: Floats) -> Floats:
    """Return the (n + 3k, 10) values and gradients of the drift's terms."""
    return np.vstack([_monomials(points), _slopes(oriented)])


def _monomials(x: Floats) -> Floats:
    """Return 1, x, y, z, xx, xy, xz, yy, yz, zz at (n, 3) places, (n, 10)."""
    return np.hstack([np.ones((len(x), 1)), x, x[:, FIRST] * x[:, SECOND]])


def _slopes(x: Floats) -> Floats:
    """Return their derivatives by x, y and z, (3n, 10)."""
    slopes = np.zeros((len(x), 3, 10))
    slopes[:, :, 1:4] = np.eye(3)
    terms = np.arange(6)
    for axis in range(3):
        slopes[:, axis, 4 + terms] += (axis == FIRST) * x[:, SECOND] + (axis == SECOND) * x[:, FIRST]
    return slopes.reshape(-1, 10)

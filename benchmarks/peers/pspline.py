"""A plain sparse P-spline of scipy: what a careful person writes in an afternoon, and fast at that.

Sources: P. Eilers, B. Marx, Statistical Science 11 (1996), 89-121; the row-wise Kronecker product is theirs (2003).
Generalised cross-validation: P. Craven, G. Wahba, Numerische Mathematik 31 (1979), 377-403; the trace by random signs:
M. Hutchinson, Communications in Statistics 18 (1989), 1059-1076.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize_scalar
from scipy.sparse import csr_array, diags_array, eye_array, kron
from scipy.sparse.linalg import SuperLU, splu

__all__ = ["PSpline"]

DEGREE = 3
#: Points whose rows are held at a time; more gains nothing, and 16 numbers a point fill the memory.
CHUNK = 200_000
#: Range of the logarithm of the penalty, how near to the best one the search ends, and its random signs.
LOG_PENALTY, NEAR, SIGNS = (-12.0, 8.0), 0.2, 8


class PSpline:
    """Cubic tensor-product spline with even spans and a penalty on second differences.

    Parameters
    ----------
    area : (x0, x1, y0, y1)
        Rectangle of the surface, metres.
    spans : int
        Spans along each side.
    penalty : float, optional
        Weight of the squared differences; None: that of the least generalised cross-validation.
    """

    def __init__(self, area: tuple[float, float, float, float], spans: int, penalty: float | None = None) -> None:
        self.penalty = penalty
        self.knots = [_knots(area[k], area[k + 1], spans) for k in (0, 2)]
        self.count = spans + DEGREE
        self.coefficients = np.zeros(self.count**2)
        self.mean = 0.0

    def fit(self, xyz: np.ndarray) -> PSpline:
        """Solve the normal equations of (n, 3) points."""
        self.mean = float(xyz[:, 2].mean())
        differences = self._differences()
        normal, right, square = 0 * differences, np.zeros(self.count**2), 0.0
        for start in range(0, len(xyz), CHUNK):
            part = xyz[start : start + CHUNK]
            rows, heights = self._rows(part[:, 0], part[:, 1]), part[:, 2] - self.mean
            normal = normal + rows.T @ rows
            right += rows.T @ heights
            square += float(heights @ heights)

        def solver(penalty: float) -> SuperLU:
            system = (normal + penalty * differences).tocsc()
            return splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

        signs = np.random.default_rng(0).choice([-1.0, 1.0], (self.count**2, SIGNS))

        def validation(log_penalty: float) -> float:
            solve = solver(np.exp(log_penalty)).solve
            found, freedom = solve(right), float((signs * solve(normal @ signs)).sum()) / SIGNS
            misfit = square - 2 * float(found @ right) + float(found @ (normal @ found))
            return misfit / (len(xyz) - freedom) ** 2

        if self.penalty is None:
            found = minimize_scalar(validation, bounds=LOG_PENALTY, method="bounded", options={"xatol": NEAR})
            self.penalty = float(np.exp(found.x))
        self.coefficients = solver(self.penalty).solve(right)
        return self

    def elevation(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return heights (n,) at places (n,), (n,)."""
        return self._rows(x, y) @ self.coefficients + self.mean

    def _rows(self, x: np.ndarray, y: np.ndarray) -> csr_array:
        """Return the row-wise Kronecker product of both axes' design matrices."""
        u, v = (BSpline.design_matrix(a, knots, DEGREE) for a, knots in zip((x, y), self.knots, strict=True))
        wide = DEGREE + 1
        values = u.data.reshape(-1, wide, 1) * v.data.reshape(-1, 1, wide)
        index = u.indices.reshape(-1, wide, 1) * self.count + v.indices.reshape(-1, 1, wide)
        pointer = np.arange(len(x) + 1) * wide**2
        return csr_array((values.ravel(), index.ravel(), pointer), shape=(len(x), self.count**2))

    def _differences(self) -> csr_array:
        n = self.count
        second = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 2, n))
        first = diags_array([-1.0, 1.0], offsets=[0, 1], shape=(n - 1, n))
        along, once = second.T @ second, first.T @ first
        return csr_array(kron(along, eye_array(n)) + 2 * kron(once, once) + kron(eye_array(n), along))


def _knots(low: float, high: float, spans: int) -> np.ndarray:
    """Return even knots, carried on beyond both ends: only there do differences of a plane's coefficients vanish."""
    return low + (high - low) / spans * np.arange(-DEGREE, spans + DEGREE + 1)

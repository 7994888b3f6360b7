"""A dense Gaussian process with drift: kriging with a covariance chosen by restricted likelihood, to compare with.

Source: C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.7 and 5.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

__all__ = ["KERNELS", "Process", "fit_process"]

KERNELS = {
    "exponential": lambda t: np.exp(-t),
    "Matérn 3/2": lambda t: (1 + t) * np.exp(-t),
    "Matérn 5/2": lambda t: (1 + t + t * t / 3) * np.exp(-t),
    "Gaussian": lambda t: np.exp(-0.5 * t * t),
}


@dataclass(frozen=True, eq=False)
class Process:
    """A kernel of one range, its nugget relative to the sill, and a drift of degree 0 (constant) or 1 (plane)."""

    kernel: str
    reach: float
    nugget: float
    drift: int
    value: float

    def covariance(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Return the (n, m) correlations of the field among (n, 2) and (m, 2) places."""
        return KERNELS[self.kernel](cdist(first, second) / self.reach)

    def predict(self, plane: np.ndarray, z: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the (m,) means at places from (n,) values, and the standard deviations of new values there."""
        system = self.covariance(plane, plane)
        system.flat[:: len(z) + 1] += self.nugget
        factor = cho_factor(system, lower=True)
        f, f0 = _drift(plane, self.drift), _drift(places, self.drift)
        k0 = self.covariance(places, plane)
        solved = cho_solve(factor, np.column_stack([z, f]))
        plane_matrix = np.linalg.inv(f.T @ solved[:, 1:])
        b = plane_matrix @ (f.T @ solved[:, 0])
        mean = f0 @ b + k0 @ (solved[:, 0] - solved[:, 1:] @ b)
        rest = f0 - k0 @ solved[:, 1:]
        variance = 1 + self.nugget - (k0 * cho_solve(factor, k0.T).T).sum(axis=1)
        variance += ((rest @ plane_matrix) * rest).sum(axis=1)
        sill = float((z - f @ b) @ (solved[:, 0] - solved[:, 1:] @ b)) / (len(z) - f.shape[1])
        return mean, np.sqrt(np.maximum(sill * variance, 0.0))

    def draw(self, plane: np.ndarray, z: np.ndarray, seed: int) -> np.ndarray:
        """Return other values (n,) at the places, of this process with the drift and the sill that it has on ``z``."""
        system = self.covariance(plane, plane)
        system.flat[:: len(z) + 1] += self.nugget
        lower, f = cholesky(system, lower=True), _drift(plane, self.drift)
        half = solve_triangular(lower, np.column_stack([z, f]), lower=True)
        b = np.linalg.lstsq(half[:, 1:], half[:, 0], rcond=None)[0]
        sill = float(np.square(half[:, 0] - half[:, 1:] @ b).sum()) / (len(z) - f.shape[1])
        return f @ b + np.sqrt(sill) * (lower @ np.random.default_rng(seed).normal(size=len(z)))

    def left_out(self, plane: np.ndarray, z: np.ndarray, groups: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return the (n,) errors at the points of each group left out, and their standard deviations; else nan.

        By blocks of one inverse (O. Dubrule, Math. Geology 15, 1983, 687-699).
        """
        system = self.covariance(plane, plane)
        system.flat[:: len(z) + 1] += self.nugget
        f = _drift(plane, self.drift)
        inverse = cho_solve(cho_factor(system, lower=True), np.eye(len(z)))
        over = inverse @ f
        inverse -= over @ np.linalg.solve(f.T @ over, over.T)
        pulled = inverse @ z
        sill = float(z @ pulled) / (len(z) - f.shape[1])
        error, variance = (np.full(len(z), np.nan) for _ in range(2))
        for group in groups:
            own = np.linalg.inv(inverse[np.ix_(group, group)])
            error[group], variance[group] = own @ pulled[group], sill * np.diag(own)
        return error, np.sqrt(variance)


def fit_process(plane: np.ndarray, z: np.ndarray, kernel: str, drift: int, most: int = 500) -> Process:
    """Choose range and nugget by restricted likelihood, on a part of many points."""
    if len(z) > most:
        part = np.random.default_rng(0).choice(len(z), most, replace=False)
        plane, z = plane[part], z[part]
    distance, f = cdist(plane, plane), _drift(plane, drift)
    spacing = float(np.sqrt(np.prod(np.ptp(plane, axis=0)) / len(z)))

    def negative(log: np.ndarray) -> float:
        system = KERNELS[kernel](distance / (spacing * np.exp(log[0])))
        system.flat[:: len(z) + 1] += np.exp(log[1])
        try:
            lower = cholesky(system, lower=True)
        except np.linalg.LinAlgError:
            return 1e12
        half = solve_triangular(lower, np.column_stack([z, f]), lower=True)
        q, r = np.linalg.qr(half[:, 1:])
        rest = half[:, 0] - q @ (q.T @ half[:, 0])
        free = len(z) - f.shape[1]
        determinant = 2 * np.log(np.diag(lower)).sum() + 2 * np.log(np.abs(np.diag(r))).sum()
        return float(free * np.log(rest @ rest / free) + determinant)

    starts = [(a, b) for a in (0.0, 1.5, 3.0) for b in (-7.0, -2.0)]
    start = min(starts, key=lambda one: negative(np.array(one)))
    found = minimize(negative, start, method="L-BFGS-B", bounds=[(-2.0, 5.0), (-14.0, 5.0)], options={"maxiter": 25})
    return Process(kernel, spacing * float(np.exp(found.x[0])), float(np.exp(found.x[1])), drift, float(found.fun))


def _drift(plane: np.ndarray, degree: int) -> np.ndarray:
    return np.column_stack([np.ones(len(plane)), plane])[:, : 1 + 2 * degree]

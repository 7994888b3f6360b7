"""Restricted likelihood of a Matérn field on a spline space, from the sums of its points alone.

The heights are z = F b + A x + e: a plane, a field with the precision tau E (:mod:`geofit.splines.matern`) and noise
of variance s^2 / w. With rho = s^2 tau, K = rho E and P = K + A' W A, all that the likelihood asks for is found from
A' W A, A' W z and z' W z (F is A times the plane's coefficients):

    -2 l = (n - r) log Q + log|P| - log|K| + log|F' V^-1 F|,   Q = (z - F b)' V^-1 (z - F b),   s^2 = Q / (n - r)

(D. A. Harville, J. Am. Stat. Assoc. 72, 1977, 320-338). Waves shorter than the spans are no part of the space, and
count as noise: spans of half the points' spacing leave out what the points themselves could not tell from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.optimize import minimize

from geofit.splines import bspline
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace, band_times

__all__ = ["Likelihood", "Optimum", "plane_coefficients"]

Floats = NDArray[np.float64]

#: Range of the logarithm of kappa per unit of the points' spacing, and of that of rho.
LOG_KAPPA, LOG_RHO = (math.log(0.003), math.log(4.0)), (-16.0, 6.0)
#: Largest part of the stretch: beyond it, sections alone can talk the likelihood into ridges that no hole between them
#: has seen.
STRETCH = 0.3
#: Least kappa per unit of the fields that are bent less than a thin plate between their points: of a longer range they
#: run on as parabolas where no points are.
CURVED = 0.5
#: (kappa * span)^(2 alpha) below which E is singular to working precision.
_LEAST = 1e-11
#: No elevation is known better than this, metres: keeps the likelihood finite on exact planes.
FINEST = 1e-4
#: Standard deviation of each part of the stretch a priori.
DOUBT = 0.5
#: Value of parameters whose system has no solution; finite, for the search.
UNSOLVABLE = 1e12
#: Step of the differences that give the search its direction.
_STEP = 1e-3


@dataclass(frozen=True)
class Optimum:
    """Parameters of the greatest restricted likelihood: lengths in units, the variances in m^2.

    ``value`` is -2 log of it but for a constant of the data; ``variance`` that of the noise.
    """

    alpha: int
    kappa: float
    rho: float
    stretch: tuple[float, float]
    value: float
    variance: float


def plane_coefficients(space: TensorSpace) -> Floats:
    """Return the (size, 3) coefficients of the functions 1, u and v: the Greville abscissae."""
    u = bspline.greville(space.knots_u, space.degree)
    v = bspline.greville(space.knots_v, space.degree)
    stacked = np.stack([np.ones(space.shape), *np.meshgrid(u, v, indexing="ij")], axis=-1)
    return np.asarray(stacked.reshape(space.size, 3))


class Likelihood:
    """Restricted likelihood of the fields of one smoothness on a space of even spans.

    Parameters
    ----------
    space : TensorSpace
        The space, no longer in v than in u for a narrow band.
    alpha : int
        Exponent of the operator.
    band, right, square : arrays
        A' W A, (bandwidth + 1, size), A' W z, (size,) or (size, k), and z' W z of the data.
    drift : (size, r) array
        Coefficients of the planes that the data determine.
    n : int
        Number of points.
    """

    def __init__(
        self, space: TensorSpace, alpha: int, band: Floats, right: Floats, square: float, drift: Floats, n: int
    ) -> None:
        self.precision = MaternPrecision(space, alpha)
        self.alpha, self.band, self.right, self.square, self.drift = alpha, band, right, square, drift
        self.columns = right.reshape(len(right), -1)
        self.free = max(n - drift.shape[1], 1) * self.columns.shape[1]
        self.floor = n * self.columns.shape[1] * FINEST**2
        spans = [np.diff(np.unique(knots)) for knots in (space.knots_u, space.knots_v)]
        span = math.sqrt(float(np.median(spans[0])) * float(np.median(spans[1])))
        least = math.log(CURVED) if alpha > 2 else LOG_KAPPA[0]
        self.least = max(least, math.log(_LEAST) / (2 * alpha) - math.log(span))
        self._known: dict[tuple[float, ...], tuple[float, float]] = {}
        self._priors: dict[tuple[float, ...], tuple[Floats, Floats, float]] = {}

    def __call__(self, parameters: Floats) -> float:
        """Return -2 log of the restricted likelihood for (log kappa, log rho, p, q), but for a constant of the data.

        A prior holds the stretch where few points say little of it.
        """
        key = tuple(float(x) for x in parameters)
        if key not in self._known:
            self._known[key] = self._evaluate(key)
        return self._known[key][0] + (key[2] / DOUBT) ** 2 + (key[3] / DOUBT) ** 2

    def _prior(self, log_kappa: float, stretch: tuple[float, float]) -> tuple[Floats, Floats, float]:
        """Return E, E times the planes, and log|E|."""
        key = (log_kappa, *stretch)
        if key not in self._priors:
            energy = self.precision.band(math.exp(log_kappa), stretch)
            lower = cholesky_banded(energy, lower=True, check_finite=False)
            self._priors = {key: (energy, band_times(energy, self.drift), 2 * float(np.log(lower[0]).sum()))}
        return self._priors[key]

    def _evaluate(self, key: tuple[float, ...]) -> tuple[float, float]:
        rho = math.exp(key[1])
        try:
            energy, bent, determinant = self._prior(key[0], (key[2], key[3]))
            lower = cholesky_banded(self.band + rho * energy, lower=True, overwrite_ab=True, check_finite=False)
        except LinAlgError:
            return UNSOLVABLE, math.nan
        held = rho * bent
        solved = cho_solve_banded((lower, True), np.column_stack([self.columns, held]), check_finite=False)
        count = self.columns.shape[1]
        free, drifted = solved[:, :count], solved[:, count:]
        # Differences of large numbers are avoided: A' W A = P - K, and K acts on planes through kappa alone.
        moment = self.drift.T @ held - held.T @ drifted
        cross = held.T @ free
        try:
            slopes = np.linalg.solve(moment, cross)
        except np.linalg.LinAlgError:
            return UNSOLVABLE, math.nan
        sign, volume = np.linalg.slogdet(moment)
        if sign <= 0:
            return UNSOLVABLE, math.nan
        misfit = self.square - float((self.columns * free).sum()) - float((cross * slopes).sum())
        misfit = max(misfit, self.floor)
        size = len(self.right)
        value = self.free * math.log(misfit / self.free)
        value += count * (2 * float(np.log(lower[0]).sum()) - determinant - size * math.log(rho) + volume)
        return value, misfit / self.free

    def variance(self, parameters: Floats) -> float:
        """Return the variance of the noise and of what the space cannot follow, m^2."""
        self(parameters)
        return self._known[tuple(float(x) for x in parameters)][1]

    def bounds(self) -> list[tuple[float, float]]:
        """Return the bounds of (log kappa, log rho, p, q)."""
        return [(self.least, LOG_KAPPA[1]), LOG_RHO, (-STRETCH, STRETCH), (-STRETCH, STRETCH)]

    def best(self, starts: list[tuple[float, float, float, float]], free: int, rounds: int) -> Optimum:
        """Search from the best of several starts, over the first ``free`` parameters."""
        low, high = np.array(self.bounds()).T
        start: Floats = min((np.clip(np.array(one), low, high) for one in starts), key=self)
        if free and rounds and self(start) < UNSOLVABLE:

            def judged(part: Floats) -> tuple[float, Floats]:
                return self._with_slope(np.concatenate([part, start[free:]]), free)

            found = minimize(
                judged,
                start[:free],
                jac=True,
                method="L-BFGS-B",
                bounds=self.bounds()[:free],
                options={"maxiter": rounds, "maxfun": 2 * rounds, "ftol": 3e-5},
            )
            if found.fun <= self(start):
                start = np.concatenate([found.x, start[free:]])
        kappa, rho = math.exp(start[0]), math.exp(start[1])
        return Optimum(self.alpha, kappa, rho, (float(start[2]), float(start[3])), self(start), self.variance(start))

    def _with_slope(self, parameters: Floats, free: int) -> tuple[float, Floats]:
        value, slope = self(parameters), np.zeros(free)
        # The slope along rho first: it needs no new E.
        for k in sorted(range(free), key=lambda k: k != 1):
            step = np.zeros(4)
            step[k] = -_STEP if parameters[k] + _STEP > self.bounds()[k][1] else _STEP
            slope[k] = (self(parameters + step) - value) / step[k]
        return value, slope

"""Restricted likelihood of a Matérn field on a spline space, from the sums of its points alone.

The heights are z = F b + A x + e: a plane, a field with the precision tau E (:mod:`geofit.splines.matern`) and noise
of variance s^2 / w. With rho = s^2 tau, K = rho E and P = K + A' W A, all that the likelihood asks for is found from
A' W A, A' W z and z' W z (F is A times the plane's coefficients):

    -2 l = (n - r) log Q + log|P| - log|K| + log|F' V^-1 F|,   Q = (z - F b)' V^-1 (z - F b),   s^2 = Q / (n - r)

(D. A. Harville, J. Am. Stat. Assoc. 72, 1977, 320-338). The plane's slope has a Cauchy prior about zero, as a normal
one whose variance is found with the others: few points far apart say little of a slope, and beyond them it is all that
is left of the field. Waves shorter than the spans are not part of the space, and count as noise: spans of half the
points' spacing leave out what the points themselves could not tell from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from geofit.splines import bspline
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace

__all__ = ["Likelihood", "Optimum", "Slope", "plane_coefficients"]

Floats = NDArray[np.float64]

#: Range of the logarithm of kappa per unit of the points' spacing, and of that of rho.
LOG_KAPPA, LOG_RHO = (math.log(0.003), math.log(4.0)), (-16.0, 6.0)
#: How much farther down log rho goes for fields whose form is applied twice.
SMALLER = 12.0
#: Largest part of the stretch: beyond it, sections alone can talk the likelihood into ridges that no hole between them
#: has seen.
STRETCH = 0.3
#: Least kappa per unit of the fields that are bent less than a thin plate between their points, for each time that
#: their form is applied: of a longer range they run on as parabolas where no points are.
CURVED = 0.5
#: (kappa * span)^(2 order) below which the form is singular to working precision.
_LEAST = 1e-11
#: No elevation is known better than this, metres: keeps the likelihood finite on exact planes.
FINEST = 1e-4
#: Standard deviation of each part of the stretch a priori.
DOUBT = 0.5
#: Value of parameters whose system has no solution; finite, for the search.
UNSOLVABLE = 1e12
#: Width of the slope's prior: the rise over the points' extent relative to the field's own deviation, squared.
RISE = 0.25
#: How many times that the variance of the slope is tried.
_WIDER = np.exp(np.arange(0.0, 14.5))
#: First steps along each parameter, the least gain that another round of steps is worth, and how far behind a rival
#: a search is given up.
STEPS, SETTLED, BEHIND = (0.7, 1.5, 0.12, 0.12), 0.5, 60.0


@dataclass(frozen=True)
class Slope:
    """What the plane's slope is held to.

    Parameters
    ----------
    directions : (3, r) array
        The combinations of 1, u and v that the data determine, the constant first.
    aim : (r,) array
        Where the prior's middle lies, in these combinations: the heights count from a plane of that slope less.
    extent : float
        Mean square distance of the points from their centre; 0 leaves the slope free.
    """

    directions: Floats
    aim: Floats
    extent: float

    def precision(self, hold: float) -> Floats:
        """Return the (r, r) precision of the prior for one of the slope."""
        return np.diag(np.where(np.arange(self.directions.shape[1]) > 0, hold, 0.0))


@dataclass(frozen=True)
class Optimum:
    """Parameters of the greatest restricted likelihood: lengths in units, the variances in m^2.

    ``value`` is -2 log of it but for a constant of the data; ``variance`` that of the noise; ``hold`` the precision of
    the slope's prior in units of the noise's.
    """

    alpha: int
    kappa: float
    rho: float
    stretch: tuple[float, float]
    value: float
    variance: float
    hold: float


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
    slope : Slope
        The planes that the data determine, and what is known of them.
    n : int
        Number of points.
    """

    def __init__(
        self, space: TensorSpace, alpha: int, band: Floats, right: Floats, square: float, slope: Slope, n: int
    ) -> None:
        self.precision = MaternPrecision(space, alpha)
        self.alpha, self.band, self.right, self.square, self.slope = alpha, band, right, square, slope
        self.columns = right.reshape(len(right), -1)
        self.drift = plane_coefficients(space) @ slope.directions
        # A field of alpha = 1 has no variance that a slope could be measured by.
        self.held = alpha > 1 and slope.extent > 0 and self.columns.shape[1] == 1
        fixed = 1 if self.held else self.drift.shape[1]
        self.free = max(n - fixed, 1) * self.columns.shape[1]
        self.floor = n * self.columns.shape[1] * FINEST**2
        spans = [np.diff(np.unique(knots)) for knots in (space.knots_u, space.knots_v)]
        span = math.sqrt(float(np.median(spans[0])) * float(np.median(spans[1])))
        least = math.log(CURVED * self.precision.power) if alpha > 2 else LOG_KAPPA[0]
        self.least = max(least, math.log(_LEAST) / (2 * self.precision.order) - math.log(span))
        # kappa^(2 nu) is part of rho.
        self.rhos = (LOG_RHO[0] - SMALLER * (self.precision.power - 1), LOG_RHO[1])
        self._known: dict[tuple[float, ...], tuple[float, float, float]] = {}
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
            bent = self.precision.times_planes(math.exp(log_kappa), stretch) @ self.slope.directions
            self._priors = {key: (energy, bent, self.precision.logdet(math.exp(log_kappa), stretch))}
        return self._priors[key]

    def _evaluate(self, key: tuple[float, ...]) -> tuple[float, float, float]:
        rho = math.exp(key[1])
        try:
            energy, bent, determinant = self._prior(key[0], (key[2], key[3]))
            system = rho * energy
            system[: len(self.band)] += self.band
            lower = cholesky_banded(system, lower=True, overwrite_ab=True, check_finite=False)
        except LinAlgError:
            return UNSOLVABLE, math.nan, 0.0
        held = rho * bent
        solved = cho_solve_banded((lower, True), np.column_stack([self.columns, held]), check_finite=False)
        count = self.columns.shape[1]
        free, drifted = solved[:, :count], solved[:, count:]
        # Differences of large numbers are avoided: A' W A = P - K, and K acts on planes through kappa alone.
        moment, cross = self.drift.T @ held - held.T @ drifted, held.T @ free
        square = self.square - float((self.columns * free).sum())
        size = len(self.right)
        value = count * (2 * float(np.log(lower[0]).sum()) - determinant - size * math.log(rho))
        over, variance, hold = self._over_planes(moment, cross, square, *self._holds(math.exp(key[0]), rho))
        return (value + over, variance, hold) if over < UNSOLVABLE else (UNSOLVABLE, math.nan, 0.0)

    def _holds(self, kappa: float, rho: float) -> tuple[Floats, Floats]:
        """Return how many times wider than the field's own rise the slope's prior is tried, and its precisions."""
        if not self.held:
            return np.ones(1), np.zeros(1)
        nu = self.alpha - 1
        own = rho * 4 * math.pi * nu * kappa ** (2 * nu) * self.slope.extent / RISE
        return _WIDER, own / _WIDER

    def _over_planes(
        self, moment: Floats, cross: Floats, square: float, wider: Floats, hold: Floats
    ) -> tuple[float, float, float]:
        """Return what the planes add to -2 l, the least misfit's part included, the noise's variance, and the hold."""
        aim, slopes = self.slope.aim, len(moment) - 1
        prior = np.zeros((len(hold), *moment.shape))
        for k in range(1, slopes + 1):
            prior[:, k, k] = hold
        pull = cross + (prior @ aim)[..., None]
        try:
            found = np.linalg.solve(moment + prior, pull)
        except np.linalg.LinAlgError:
            return UNSOLVABLE, math.nan, 0.0
        sign, volume = np.linalg.slogdet(moment + prior)
        misfit = square + hold * float(aim[1:] @ aim[1:]) - (pull * found).sum(axis=(1, 2))
        misfit = np.maximum(misfit, self.floor)
        value = self.free * np.log(misfit / self.free) + self.columns.shape[1] * volume
        if self.held:
            # The scales of a Cauchy distribution as a mixture of normal ones.
            value += 3 * np.log(wider) + 1 / wider - slopes * np.log(hold)
        best = int(np.where(sign > 0, value, UNSOLVABLE).argmin())
        return float(value[best]) if sign[best] > 0 else UNSOLVABLE, float(misfit[best]) / self.free, float(hold[best])

    def bounds(self) -> list[tuple[float, float]]:
        """Return the bounds of (log kappa, log rho, p, q)."""
        return [(self.least, LOG_KAPPA[1]), self.rhos, (-STRETCH, STRETCH), (-STRETCH, STRETCH)]

    def best(
        self,
        starts: list[tuple[float, float, float, float]],
        free: int,
        rounds: int,
        steps: tuple[float, ...] = STEPS,
        rival: float = math.inf,
    ) -> Optimum:
        """Search from the best of several starts, along one of the first ``free`` parameters after the other.

        Range and noise relative to the field hardly depend on each other, nor the stretch on both: a parabola along
        each leads near the optimum, where the gradient by differences would ask for as many values a step. ``rival`` is
        the value of another smoothness.
        """
        low, high = np.array(self.bounds()).T
        at: Floats = min((np.clip(np.array(one), low, high) for one in starts), key=self)
        size = np.array(steps)
        for _ in range(rounds):
            before = self(at)
            # The noise first: it needs no new E.
            for k in sorted(range(free), key=lambda k: k != 1):
                if size[k] > 0 and self(at) < min(UNSOLVABLE, rival + BEHIND):
                    at, size[k] = self._along(at, k, size[k])
            if before - self(at) < SETTLED:
                break
        value, (kappa, rho) = self(at), np.exp(at[:2]).tolist()
        _, variance, hold = self._known[tuple(float(x) for x in at)]
        return Optimum(self.alpha, kappa, rho, (float(at[2]), float(at[3])), value, variance, hold)

    def _along(self, at: Floats, k: int, step: float) -> tuple[Floats, float]:
        """Move one parameter to the vertex of a parabola through three values; return the next step too."""
        low, high = self.bounds()[k]

        def moved(by: float) -> Floats:
            place = at.copy()
            place[k] = min(max(at[k] + by, low), high)
            return place

        sides = [moved(-step), moved(step)]
        (left, middle, right), x = (self(sides[0]), self(at), self(sides[1])), (sides[0][k], at[k], sides[1][k])
        places = [at, *sides]
        # Divided differences: the sides may be nearer where a bound cuts them.
        before = (middle - left) / (x[1] - x[0]) if x[1] > x[0] else None
        after = (right - middle) / (x[2] - x[1]) if x[2] > x[1] else None
        if before is not None and after is not None and after > before:
            curvature = 2 * (after - before) / (x[2] - x[0])
            slope = (before * (x[2] - x[1]) + after * (x[1] - x[0])) / (x[2] - x[0])
            if slope**2 / (2 * curvature) > SETTLED / 8:
                places.append(moved(float(np.clip(-slope / curvature, -2 * step, 2 * step))))
        else:
            places.append(moved(2 * step if right < left else -2 * step))
        found = min(places, key=self)
        return found, float(np.clip(abs(found[k] - at[k]), step / 4, 2 * step))

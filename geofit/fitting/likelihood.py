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
from geofit.splines.blocks import inverse_band
from geofit.splines.couplings import dyads, from_band
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace, band_times

__all__ = ["Likelihood", "Optimum", "Slope", "plane_coefficients"]

Floats = NDArray[np.float64]
_Key = tuple[float, float, float, float]

#: Range of the logarithm of the inverse range per unit of the points' spacing, and of that of rho.
LOG_KAPPA, LOG_RHO = (math.log(0.003), math.log(4.0)), (-16.0, 6.0)
#: How much farther down log rho goes for fields whose form is applied twice.
SMALLER = 12.0
#: Largest part of the stretch, which its prior hardly ever lets it reach.
STRETCH = 1.0
#: Least inverse range, in the direction of the longest, of the fields that are bent less than a thin plate between
#: their points, for each time that their form is applied. A gentle bowl asks for a range of ten spacings and more; one
#: of fifty has come to grief on rounding. Of very many points, which can tell, half the area may be within the range.
CURVED, ACROSS = 0.1, 2.0
#: Size of a stretch below which the direction of the longest range hardly counts: keeps the likelihood smooth there.
ROUND = 0.05
#: (kappa * span)^(2 order) below which the form is singular to working precision.
_LEAST = 1e-11
#: No elevation is known better than this, metres: keeps the likelihood finite on exact planes.
FINEST = 1e-4
#: Standard deviation of each part of the stretch a priori: sections alone could talk the likelihood into ridges that no
#: hole between them has seen.
DOUBT = 0.25
#: Value of parameters whose system has no solution; finite, for the search.
UNSOLVABLE = 1e12
#: Width of the slope's prior: the rise over the points' extent relative to the field's own deviation, squared.
RISE = 0.25
#: How many times that the variance of the slope is tried.
_WIDER = np.exp(np.arange(0.0, 14.5))


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


@dataclass(frozen=True, eq=False)
class _Solved:
    """The parameters evaluated last, the factor of P, and K times the planes with what P gives for heights and it.

    ``floor`` is the least misfit that stands out from rounding.
    """

    key: _Key
    lower: Floats
    columns: tuple[Floats, Floats, Floats]
    floor: float


@dataclass(frozen=True, eq=False)
class _Point:
    """What the derivatives at a set of parameters are made of.

    ``hold`` is the precision of the slope's prior, ``misfit`` is Q and ``weight`` 1 / s^2, ``lower`` the factor of P;
    ``slopes`` (r, k) are those of the planes and ``covariance`` (r, r) is S; ``own`` (size, k) is x and ``planes``
    (size, r) is Y; ``bent`` and ``bent_planes`` are K x and what K does to the planes that the noise takes.
    """

    kappa: float
    rho: float
    stretch: tuple[float, float]
    hold: float
    misfit: float
    weight: float
    lower: Floats
    slopes: Floats
    covariance: Floats
    planes: Floats
    own: Floats
    bent: Floats
    bent_planes: Floats


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
        # The spans that grow lie beyond the area.
        side = math.sqrt(math.prod(float((part < 1.5 * np.median(part)).sum() * np.median(part)) for part in spans))
        curved = self.precision.power * min(CURVED, ACROSS / side)
        least = math.log(curved) if alpha > 2 else LOG_KAPPA[0]
        self.least = max(least, math.log(_LEAST) / (2 * self.precision.order) - math.log(span))
        # kappa^(2 nu) is part of rho.
        longest = 2 * alpha * math.log(side / (2 * math.pi))
        # Waves as long as the area may pass for noise.
        self.rhos = (LOG_RHO[0] - SMALLER * (self.precision.power - 1), max(LOG_RHO[1], longest))
        self._known: dict[_Key, tuple[float, float, float]] = {}
        self._prior_of: tuple[tuple[float, ...], tuple[Floats, Floats, float]] | None = None
        self._solved: _Solved | None = None

    def __call__(self, parameters: Floats) -> float:
        """Return -2 log of the restricted likelihood of parameters, but for a constant of the data.

        These are (4,): the logarithms of the inverse range in the direction of the longest, kappa but for the stretch,
        and of rho, and both parts of the stretch. A prior holds the stretch where few points say little of it.
        """
        key = _key_of(parameters)
        if key not in self._known:
            self._known[key] = self._evaluate(key)
        return self._known[key][0] + (key[2] / DOUBT) ** 2 + (key[3] / DOUBT) ** 2

    def parameters(self, kappa: float, rho: float, stretch: tuple[float, float]) -> Floats:
        """Return the (4,) parameters of a field, as near as their bounds let them be.

        Where the range is cut, the field keeps its variance, which is proportional to 1 / (rho kappa^(2 nu)).
        """
        low, high = np.array(self.bounds()).T
        stretch = tuple(np.clip(stretch, low[2:], high[2:]).tolist())
        longest = math.log(kappa) - _widening(*stretch)
        cut = min(max(longest, low[0]), high[0])
        log_rho = math.log(rho) - 2 * (self.alpha - 1) * (cut - longest)
        return np.array([cut, min(max(log_rho, low[1]), high[1]), *stretch])

    def optimum(self, parameters: Floats) -> Optimum:
        """Return what the likelihood finds for given parameters."""
        value, key = self(parameters), _key_of(parameters)
        _, variance, hold = self._known[key]
        return Optimum(self.alpha, _kappa(key), math.exp(key[1]), key[2:], value, variance, hold)

    def derivatives(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the (4,) derivatives of the value by the parameters, and a (4, 4) matrix close to its second ones.

        Both are nan where the system has no solution.
        """
        at = self._point(parameters)
        if at is None:
            return np.full(4, np.nan), np.full((4, 4), np.nan)
        return self._gradient(at), self._information(at)

    def _point(self, parameters: Floats) -> _Point | None:
        key = _key_of(parameters)
        self(parameters)
        if self._solved is None or self._solved.key != key:
            self._evaluate(key)
        _, variance, hold = self._known[key]
        if self._solved is None or not math.isfinite(variance):
            return None
        (held, free, drifted), prior = self._solved.columns, self.slope.precision(hold)
        moment = self.drift.T @ held - held.T @ drifted + prior
        covariance = np.asarray(np.linalg.inv(moment), np.float64)
        slopes = covariance @ (held.T @ free + (prior @ self.slope.aim)[:, None])
        planes = self.drift - drifted
        # K acts on x and Y as A' W A does on what they leave to the noise.
        taken = band_times(self.band, np.column_stack([free + drifted @ slopes, drifted]))
        count = self.columns.shape[1]
        return _Point(
            kappa=_kappa(key),
            rho=math.exp(key[1]),
            stretch=key[2:],
            hold=hold,
            misfit=variance * self.free,
            # At its floor the misfit says nothing of the parameters.
            weight=1 / variance if variance * self.free > self._solved.floor else 0.0,
            lower=self._solved.lower,
            slopes=slopes,
            covariance=covariance,
            planes=planes,
            own=free - planes @ slopes,
            bent=self.columns - taken[:, :count],
            bent_planes=taken[:, count:],
        )

    def _gradient(self, at: _Point) -> Floats:
        """Return the (4,) derivatives of the value by the parameters.

        Notes
        -----
        With S = (F' V^-1 F)^-1, the field's own coefficients x, and those of the planes that the noise leaves them, Y,

            d(-2 l) = tr(G dK) - tr(K^-1 dK),   G = P^-1 + Y S Y' + x x' / s^2,

        which asks for the entries of the inverses near the diagonal only (K. Takahashi, J. Fagan, M. Chin, 1973;
        S. P. Smith, J. Comput. Graph. Stat. 4, 1995, 134-147). The planes and the hold of their slope are the best ones
        for each set of parameters, and add nothing.
        """
        precision, count = self.precision, self.columns.shape[1]
        near, shape = inverse_band(at.lower), precision.space.shape
        columns = np.column_stack(
            [math.sqrt(at.weight) * at.own, at.planes @ np.linalg.cholesky(count * at.covariance)]
        )
        couplings = count * from_band(near, shape, precision.reach)
        couplings += dyads(columns.reshape(*shape, -1), precision.reach)
        by_form = at.rho * precision.trace_slopes(at.kappa, at.stretch, couplings)
        by_form -= count * precision.logdet_slopes(at.kappa, at.stretch)
        by_rho = at.weight * (at.own * at.bent).sum()
        by_rho += count * ((at.covariance * (at.planes.T @ at.bent_planes)).sum() - _trace(near, self.band))
        if self.held:
            off = at.slopes[1:, 0] - self.slope.aim[1:]
            by_hold = at.weight * at.hold * (off @ off)
            by_hold += (at.covariance * self.slope.precision(at.hold)).sum() - len(off)
            by_rho += by_hold
            by_form[0] += 2 * (self.alpha - 1) * by_hold
        turned = np.array(at.stretch)
        by_stretch = by_form[1:] + by_form[0] * _widening_slopes(at.stretch) + 2 * turned / DOUBT**2
        return np.array([by_form[0], by_rho, *by_stretch])

    def _information(self, at: _Point) -> Floats:
        """Return the average information, (4, 4), the mean of the observed and the expected one, of -2 l.

        Notes
        -----
        It asks for no more than products, and solutions with the factors at hand: with q_i = (dK / d theta_i) x,

            s^2 J_ij = q_i' (K^-1 - P^-1 - Y S Y') q_j - (x' q_i) (x' q_j) / Q

        (A. R. Gilmour, R. Thompson, B. R. Cullis, Biometrics 51, 1995, 1440-1450), the noise's variance being the best
        one for the other parameters.
        """
        found, along = np.zeros((4, 4)), np.zeros(4)
        for x, by_rho in zip(at.own.T, at.bent.T, strict=True):
            by_form = at.rho * self.precision.times_slopes(at.kappa, at.stretch, x)
            by_stretch = by_form[:, 1:] + by_form[:, :1] * _widening_slopes(at.stretch)
            q = np.column_stack([by_form[:, 0], by_rho, by_stretch])
            before = self.precision.solve(at.kappa, at.stretch, q) / at.rho
            after = cho_solve_banded((at.lower, True), q, check_finite=False)
            planes = at.planes.T @ q
            found += q.T @ (before - after) - planes.T @ at.covariance @ planes
            along += x @ q
        found -= np.outer(along, along) / at.misfit
        return np.asarray(at.weight * found + np.diag([0.0, 0.0, 2 / DOUBT**2, 2 / DOUBT**2]))

    def _prior(self, kappa: float, stretch: tuple[float, float]) -> tuple[Floats, Floats, float]:
        """Return E, E times the planes, and log|E|; the last ones are kept."""
        key = (kappa, *stretch)
        if self._prior_of is None or self._prior_of[0] != key:
            energy = self.precision.band(kappa, stretch)
            bent = self.precision.times_planes(kappa, stretch) @ self.slope.directions
            self._prior_of = key, (energy, bent, self.precision.logdet(kappa, stretch))
        return self._prior_of[1]

    def _evaluate(self, key: _Key) -> tuple[float, float, float]:
        kappa, rho = _kappa(key), math.exp(key[1])
        try:
            energy, bent, determinant = self._prior(kappa, key[2:])
            system = rho * energy
            system[: len(self.band)] += self.band
            largest = float(system[0].max())
            lower = cholesky_banded(system, lower=True, overwrite_ab=True, check_finite=False)
        except LinAlgError:
            return UNSOLVABLE, math.nan, 0.0
        held = rho * bent
        solved = cho_solve_banded((lower, True), np.column_stack([self.columns, held]), check_finite=False)
        count = self.columns.shape[1]
        free, drifted = solved[:, :count], solved[:, count:]
        # Sums that smooth fields of long range nearly cancel leave no more of the misfit than their rounding; it counts
        # for each point, so that the value is certain to about 1.
        rounding = float(np.finfo(np.float64).eps) * largest * float((free**2).sum())
        floor = max(self.floor, self.free * rounding)
        self._solved = _Solved(key, lower, (held, free, drifted), floor)
        # Differences of large numbers are avoided: A' W A = P - K, and K acts on planes through kappa alone.
        moment, cross = self.drift.T @ held - held.T @ drifted, held.T @ free
        square = self.square - float((self.columns * free).sum())
        size = len(self.right)
        value = count * (2 * float(np.log(lower[0]).sum()) - determinant - size * math.log(rho))
        over, variance, hold = self._over_planes(moment, cross, square, floor, *self._holds(kappa, rho))
        return (value + over, variance, hold) if over < UNSOLVABLE else (UNSOLVABLE, math.nan, 0.0)

    def _holds(self, kappa: float, rho: float) -> tuple[Floats, Floats]:
        """Return how many times wider than the field's own rise the slope's prior is tried, and its precisions."""
        if not self.held:
            return np.ones(1), np.zeros(1)
        nu = self.alpha - 1
        own = rho * 4 * math.pi * nu * kappa ** (2 * nu) * self.slope.extent / RISE
        return _WIDER, own / _WIDER

    def _over_planes(
        self, moment: Floats, cross: Floats, square: float, floor: float, wider: Floats, hold: Floats
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
        misfit = np.maximum(misfit, floor)
        value = self.free * np.log(misfit / self.free) + self.columns.shape[1] * volume
        if self.held:
            # The scales of a Cauchy distribution as a mixture of normal ones.
            value += 3 * np.log(wider) + 1 / wider - slopes * np.log(hold)
        best = int(np.where(sign > 0, value, UNSOLVABLE).argmin())
        return float(value[best]) if sign[best] > 0 else UNSOLVABLE, float(misfit[best]) / self.free, float(hold[best])

    def bounds(self) -> list[tuple[float, float]]:
        """Return the bounds of the parameters."""
        return [(self.least, LOG_KAPPA[1]), self.rhos, (-STRETCH, STRETCH), (-STRETCH, STRETCH)]


def _key_of(parameters: Floats) -> _Key:
    longest, log_rho, p, q = parameters.tolist()
    return longest, log_rho, p, q


def _kappa(key: _Key) -> float:
    return math.exp(key[0] + _widening(*key[2:]))


def _widening(p: float, q: float) -> float:
    """Return the logarithm of kappa to the inverse range in the direction of the longest, for a stretch."""
    return (math.hypot(p, q, ROUND) - ROUND) / 2


def _widening_slopes(stretch: tuple[float, float]) -> Floats:
    """Return the (2,) derivatives of :func:`_widening` by both parts of the stretch."""
    return np.array(stretch) / (2 * math.hypot(*stretch, ROUND))


def _trace(one: Floats, other: Floats) -> float:
    """Return the trace of the product of two symmetric matrices, of the second of which only a band is not zero."""
    products = (one[: len(other)] * other).sum(axis=1)
    return float(2 * products.sum() - products[0])

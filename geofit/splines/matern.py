"""Precision of Matérn fields on a tensor-product spline space.

A field with the spectral density 1 / (tau (kappa^2 + w' H w)^alpha) has the precision tau * E, where

    E = sum over m of binomial(alpha, m) kappa^(2 (alpha - m)) E_m,
    E_m = integral of H_(i1 j1) ... H_(im jm) f_(i1 ... im) f_(j1 ... jm),   det H = 1

(P. Whittle, Biometrika 41, 1954, 434-449; F. Lindgren, H. Rue, J. Lindström, J. R. Stat. Soc. B 73, 2011, 423-498).
E_m is a positive form of the derivatives of order m; with kappa -> 0 and alpha = 2 it is the thin plate's energy.
In terms of how many of the indices are v, k of the i and n of the j, the weight of f_(u^(m-k) v^k) f_(u^(m-n) v^n) is
the coefficient of x^k y^n in (a + b x + b y + c x y)^m for H = [[a, b], [b, c]]. Each term is a Kronecker product of
Gram matrices of both directions, so that E is the sum of M_ij A_i (x) B_j for a small matrix M of the parameters.

Splines of degree p have no derivatives of an order beyond p. The operator of the exponent 2 p is that of p applied
twice (Lindgren et al., sec. 2.3): E = F D^-1 F, where F is the matrix of p, and D the lumped Gram matrix of the basis.
D is a Kronecker product as well, so E is the sum of M_ij M_kl (A_i Du^-1 A_k) (x) (B_j Dv^-1 B_l).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property, wraps

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded

from geofit.splines import bspline
from geofit.splines.blocks import inverse_band
from geofit.splines.couplings import banded, from_band
from geofit.splines.tensor import TensorSpace

__all__ = ["MaternPrecision", "metric", "metric_slopes"]

Floats = NDArray[np.float64]
_Made = Callable[["MaternPrecision", float, tuple[float, float]], Floats]


def metric(stretch: tuple[float, float]) -> tuple[float, float, float]:
    """Return (a, b, c) of H = exp([[p, q], [q, -p]]), det H = 1; its larger eigenvalue is exp(hypot(p, q))."""
    p, q = stretch
    size = math.hypot(p, q)
    even, odd = math.cosh(size), math.sinh(size) / size if size > 1e-12 else 1.0
    return even + odd * p, odd * q, even - odd * p


def metric_slopes(stretch: tuple[float, float]) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the derivatives of (a, b, c) of :func:`metric` by p and by q."""
    p, q = stretch
    size = math.hypot(p, q)
    small = size < 1e-4
    odd = 1.0 if small else math.sinh(size) / size
    curved = 1 / 3 if small else (math.cosh(size) - odd) / size**2
    by_p = odd * p + odd + p * p * curved, p * q * curved, odd * p - odd - p * p * curved
    by_q = odd * q + p * q * curved, odd + q * q * curved, odd * q - p * q * curved
    return by_p, by_q


def _powers(form: tuple[float, float, float], highest: int) -> list[Floats]:
    """Return the coefficients of x^k y^n in the powers 0, 1, ... of a + b x + b y + c x y."""
    powers = [np.ones((1, 1))]
    for _ in range(highest):
        powers.append(_grown(powers[-1], form))
    return powers


def _grown(power: Floats, form: tuple[float, float, float]) -> Floats:
    """Return the coefficients of a polynomial in x and y times a + b x + b y + c x y."""
    a, b, c = form
    grown = np.zeros((len(power) + 1, len(power) + 1))
    grown[:-1, :-1] += a * power
    grown[1:, :-1] += b * power
    grown[:-1, 1:] += b * power
    grown[1:, 1:] += c * power
    return grown


def _kept(make: _Made) -> _Made:
    """Keep what a method returned for the last parameters: several matrices are made of it."""

    @wraps(make)
    def method(self: MaternPrecision, kappa: float, stretch: tuple[float, float]) -> Floats:
        key = kappa, stretch
        if make.__name__ not in self._last or self._last[make.__name__][0] != key:
            self._last[make.__name__] = key, make(self, kappa, stretch)
        return self._last[make.__name__][1]

    return method


class MaternPrecision:
    """The matrix E of a space for any kappa and anisotropy.

    Parameters
    ----------
    space : TensorSpace
        The space.
    alpha : int
        Exponent of the operator kappa^2 - div H grad; the smoothness nu of the field is alpha - 1. At most the degree
        of the space, or twice that.
    """

    def __init__(self, space: TensorSpace, alpha: int) -> None:
        self.space, self.alpha = space, alpha
        #: Exponent of the form F, made of derivatives, and how many times it is applied.
        self.order = min(alpha, space.degree)
        self.power = alpha // self.order
        #: How many steps apart E couples control points, in each direction.
        self.reach = self.power * space.degree
        self._last: dict[str, tuple[tuple[float, tuple[float, float]], Floats]] = {}

    @cached_property
    def _terms(self) -> NDArray[np.int64]:
        """Return (3, terms) the m, k and n of each term of F."""
        numbers = range(self.order + 1)
        return np.array([(m, k, n) for m in numbers for k in range(m + 1) for n in range(m + 1)]).T

    @cached_property
    def _grams(self) -> tuple[Floats, Floats]:
        """Diagonals of the matrices A_i and B_j, upmost first: (q, 2 p + 1, nu) and (q, 2 p + 1, nv)."""
        count = self.order + 1
        along, across = (
            diagonals[:count, :count].reshape(count**2, *diagonals.shape[2:]) for diagonals in self.space.gram_diagonals
        )
        return along, across

    @cached_property
    def _masses(self) -> tuple[Floats, Floats]:
        """Diagonals of both factors of D, (nu,) and (nv,): the integrals of the basis functions."""
        p = self.space.degree
        along, across = (
            (knots[p + 1 :] - knots[: -p - 1]) / (p + 1) for knots in (self.space.knots_u, self.space.knots_v)
        )
        return along, across

    @cached_property
    def _factors(self) -> tuple[Floats, Floats]:
        """Diagonals of the factors of E, (q, 2 r + 1, nu) and (q, 2 r + 1, nv); (q, q, ...) if F is applied twice."""
        if self.power == 1:
            return self._grams
        along, across = (_products(grams, mass) for grams, mass in zip(self._grams, self._masses, strict=True))
        return along, across

    @cached_property
    def _of_planes(self) -> tuple[list[Floats], list[Floats]]:
        """The factors of E times those of 1 and u, (q, nu) each or (q, q, nu), and times those of 1 and v."""
        found: tuple[list[Floats], list[Floats]] = [], []
        knots = self.space.knots_u, self.space.knots_v
        for grams, mass, own, products in zip(self._grams, self._masses, knots, found, strict=True):
            place = bspline.greville(own, self.space.degree)
            for x in (np.ones_like(place), place):
                once = _times(grams, x)
                products.append(once if self.power == 1 else _times(grams, once / mass))
        return found

    @_kept
    def _weights(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the weight of each term of F."""
        tables = _powers(metric(stretch), self.order)
        order = [math.comb(self.order, m) * kappa ** (2 * (self.order - m)) for m in range(self.order + 1)]
        return np.array([order[m] * tables[m][k, n] for m, k, n in self._terms.T])

    def _weight_slopes(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return (3, terms) the derivatives of the weights by log kappa and both parts of the stretch."""
        tables, slopes = _powers(metric(stretch), self.order), metric_slopes(stretch)
        order = [math.comb(self.order, m) * kappa ** (2 * (self.order - m)) for m in range(self.order + 1)]
        rows = [[2 * (self.order - m) * order[m] * tables[m][k, n] for m, k, n in self._terms.T]]
        for slope in slopes:
            turned = [np.zeros((1, 1)), *(m * _grown(tables[m - 1], slope) for m in range(1, self.order + 1))]
            rows.append([order[m] * turned[m][k, n] for m, k, n in self._terms.T])
        return np.array(rows)

    @_kept
    def _mixing(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return M, (q, q)."""
        return self._mixed_by(self._weights(kappa, stretch))

    @_kept
    def _mixing_slopes(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return (3, q, q) the derivatives of M by log kappa and both parts of the stretch."""
        return self._mixed_by(self._weight_slopes(kappa, stretch))

    def _mixed_by(self, weights: Floats) -> Floats:
        """Return M, (..., q, q), of the weights of the terms, (..., terms)."""
        (m, k, n), count = self._terms, self.order + 1
        mixing = np.zeros((*weights.shape[:-1], *[count] * 4))
        mixing[..., m - k, m - n, k, n] = weights
        return mixing.reshape(*weights.shape[:-1], count**2, count**2)

    def _mixed(self, mixing: Floats, first: Floats, across: Floats) -> Floats:
        """Return what stands beside each factor along u, of those across: (q, ...), (q, q, ...).

        Where F is applied twice, ``first`` is the M of the form that is applied first.
        """
        mixed = np.tensordot(mixing, across, axes=1)
        if self.power == 1:
            return mixed
        count = len(mixing)
        return np.asarray(np.matmul(first, mixed.reshape(count, count, -1)).reshape(mixed.shape))

    @_kept
    def _form(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the band of F."""
        along, across = self._grams
        return _summed(along, np.tensordot(self._mixing(kappa, stretch), across, axes=1))

    @_kept
    def _factor(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the banded Cholesky factor of F."""
        return np.asarray(cholesky_banded(self._form(kappa, stretch), lower=True, check_finite=False))

    def band(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return the band of E for a kappa per unit of length and a stretch (see `metric`), (bandwidth + 1, size).

        It is wider than the space's own where the exponent is beyond the degree. It may be kept: do not write to it.
        """
        if self.power == 1:
            return self._form(kappa, stretch)
        mixing = self._mixing(kappa, stretch)
        along, across = self._factors
        return _summed(along, self._mixed(mixing, mixing, across))

    def logdet(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> float:
        """Return the logarithm of the determinant of E.

        Raises
        ------
        scipy.linalg.LinAlgError
            If F is not positive definite to working precision.
        """
        lower = self._factor(kappa, stretch)
        once = 2 * float(np.log(lower[0]).sum())
        return once if self.power == 1 else 2 * once - float(np.log(np.outer(*self._masses)).sum())

    def logdet_slopes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return (3,) the derivatives of :meth:`logdet` by log kappa and both parts of the stretch."""
        near = from_band(inverse_band(self._factor(kappa, stretch)), self.space.shape, self.space.degree)
        along, across = (grams.reshape(len(grams), -1) for grams in self._grams)
        met = along @ near.reshape(along.shape[1], -1) @ across.T
        return self.power * self._by_parameters(kappa, stretch, met)

    def trace_slopes(self, kappa: float, stretch: tuple[float, float], couplings: Floats) -> Floats:
        """Return (3,) the derivatives of tr(G E) by log kappa and both parts of the stretch.

        Parameters
        ----------
        kappa : float
            Inverse range per unit of length.
        stretch : tuple of float
            See `metric`.
        couplings : (2 r + 1, nu, 2 r + 1, nv) array
            Those of a symmetric matrix G (:mod:`geofit.splines.couplings`) of the reach of E: the degree of the space,
            twice that where F is applied twice.
        """
        along, across = self._factors
        flat = along.reshape(-1, along.shape[-2] * along.shape[-1])
        met = flat @ couplings.reshape(flat.shape[1], -1)
        if self.power == 2:
            # By the first of the two forms: that by the other one is the same.
            mixing = self._mixing(kappa, stretch)
            across = np.matmul(mixing, across.reshape(*across.shape[:2], -1))
        count = len(along)
        once = met.reshape(count, -1) @ across.reshape(count, -1).T
        return self.power * self._by_parameters(kappa, stretch, once)

    def _by_parameters(self, kappa: float, stretch: tuple[float, float], by_mixing: Floats) -> Floats:
        """Return (3,) the derivatives by log kappa and both parts of the stretch of those by M, (q, q)."""
        return np.tensordot(self._mixing_slopes(kappa, stretch), by_mixing, axes=2)

    def times_slopes(self, kappa: float, stretch: tuple[float, float], x: Floats) -> Floats:
        """Return (size, 3) the derivatives of E times (size,) coefficients, by log kappa and both stretches."""
        net, slopes = x.reshape(1, *self.space.shape), self._mixing_slopes(kappa, stretch)
        found = self._applied(slopes, net)
        if self.power == 2:
            mixing, mass = self._mixing(kappa, stretch)[None], np.outer(*self._masses)
            found = self._applied(mixing, found / mass) + self._applied(slopes, self._applied(mixing, net) / mass)
        return np.asarray(found.reshape(3, -1).T)

    def solve(self, kappa: float, stretch: tuple[float, float], right: Floats) -> Floats:
        """Return the inverse of E times (size, k) columns."""
        factor = self._factor(kappa, stretch), True
        solved = cho_solve_banded(factor, right, check_finite=False)
        for _ in range(self.power - 1):
            solved = cho_solve_banded(factor, np.outer(*self._masses).reshape(-1, 1) * solved, check_finite=False)
        return np.asarray(solved)

    @cached_property
    def _matrices(self) -> tuple[Floats, Floats]:
        """The matrices A_i and B_j: (q, nu, nu), (q, nv, nv)."""
        along, across = (np.array([_matrix(diagonals) for diagonals in grams]) for grams in self._grams)
        return along, across

    def _applied(self, mixing: Floats, nets: Floats) -> Floats:
        """Return the forms F of given M, (k, q, q), times (k, nu, nv) nets; one M or one net serves all."""
        along, across = self._matrices
        (count, nu, nv), q = nets.shape, len(along)
        once = (along.reshape(-1, nu) @ nets).reshape(count, q, nu * nv)
        mixed = np.matmul(mixing.swapaxes(1, 2), once).reshape(-1, q, nu, nv)
        return np.asarray(np.matmul(mixed, across.swapaxes(1, 2)).sum(axis=1))

    def times_planes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return E times the coefficients of 1, u and v, (size, 3)."""
        weights = self._weights(kappa, stretch)
        # The other terms take derivatives of an order at which planes vanish.
        first = self._mixed_by(np.where(self._terms[0] < 2, weights, 0.0))
        mixing = first if self.power == 1 else self._mixing(kappa, stretch)
        along, across = self._of_planes
        ones, u = (one.reshape(-1, one.shape[-1]) for one in along)
        constant, v = (self._mixed(mixing, first, one).reshape(-1, one.shape[-1]) for one in across)
        return np.stack([(ones.T @ constant).ravel(), (u.T @ constant).ravel(), (ones.T @ v).ravel()], axis=1)


def _summed(along: Floats, across: Floats) -> Floats:
    """Return the band of the sum of Kronecker products whose factors are given by diagonals, (..., 2 r + 1, n)."""
    width, nu = along.shape[-2:]
    reach, nv = width // 2, across.shape[-1]
    rows = along[..., reach:, :].reshape(-1, (reach + 1) * nu)
    return banded((rows.T @ across.reshape(-1, width * nv)).reshape(reach + 1, nu, width, nv))


def _products(diagonals: Floats, mass: Floats) -> Floats:
    """Return A_i D^-1 A_k of the matrices of given diagonals, (q, 2 p + 1, n), and a diagonal D, (n,).

    Their diagonals are (q, q, 4 p + 1, n).
    """
    q, width, n = diagonals.shape
    p = width // 2
    over = np.pad(diagonals / mass, ((0, 0), (0, 0), (p, p)))
    result = np.zeros((q, q, 2 * width - 1, n))
    for step in range(width):
        # From i to i + step - p, and on from there.
        result[:, :, step : step + width] += over[:, None, :, step : step + n] * diagonals[:, step, None]
    return result


def _matrix(diagonals: Floats) -> Floats:
    """Return the matrix of the given diagonals, (2 p + 1, count) from the upmost on."""
    p, count = len(diagonals) // 2, diagonals.shape[1]
    result = np.zeros((count + 2 * p, count))
    for below, diagonal in enumerate(diagonals):
        np.fill_diagonal(result[below:], diagonal)
    return result[p : p + count]


def _times(diagonals: Floats, x: Floats) -> Floats:
    """Return the matrices of given diagonals, (q, 2 p + 1, n) from the upmost on, times x, (..., n): (q, ..., n)."""
    (q, width, n), p = diagonals.shape, diagonals.shape[1] // 2
    result = np.zeros((q, *x.shape[:-1], n + 2 * p))
    for step in range(width):
        result[..., step : step + n] += diagonals[:, step].reshape(q, *[1] * (x.ndim - 1), n) * x
    return result[..., p : p + n]

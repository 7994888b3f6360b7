"""Precision of Matérn fields on a tensor-product spline space.

A field with the spectral density 1 / (tau (kappa^2 + w' H w)^alpha) has the precision tau * E, where

    E = sum over m of binomial(alpha, m) kappa^(2 (alpha - m)) E_m,
    E_m = integral of H_(i1 j1) ... H_(im jm) f_(i1 ... im) f_(j1 ... jm),   det H = 1

(P. Whittle, Biometrika 41, 1954, 434-449; F. Lindgren, H. Rue, J. Lindström, J. R. Stat. Soc. B 73, 2011, 423-498).
E_m is a positive form of the derivatives of order m; with kappa -> 0 and alpha = 2 it is the thin plate's energy.
In terms of how many of the indices are v, k of the i and n of the j, the weight of f_(u^(m-k) v^k) f_(u^(m-n) v^n) is
the coefficient of x^k y^n in (a + b x + b y + c x y)^m for H = [[a, b], [b, c]]. Each term is a Kronecker product of
the Gram matrices of both directions.

Splines of degree p have no derivatives of an order beyond p. The operator of the exponent 2 p is that of p applied
twice (Lindgren et al., sec. 2.3): E = F D^-1 F, where F is the matrix of p, and D the lumped Gram matrix of the basis.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded

from geofit.splines import bspline
from geofit.splines.blocks import inverse_band
from geofit.splines.couplings import applied, banded, from_band, product_near, squared
from geofit.splines.tensor import TensorSpace

__all__ = ["MaternPrecision", "metric", "metric_slopes"]

Floats = NDArray[np.float64]


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
        self._formed: tuple[tuple[float, tuple[float, float]], Floats] = (math.nan, (0.0, 0.0)), np.empty(0)
        self._factored = self._formed

    @cached_property
    def _terms(self) -> list[tuple[int, int, int]]:
        return [(m, k, n) for m in range(self.order + 1) for k in range(m + 1) for n in range(m + 1)]

    @cached_property
    def _factors(self) -> tuple[Floats, Floats]:
        """Diagonals of the factors of each term of F, upmost first: (terms, 2 p + 1, nu), (terms, 2 p + 1, nv)."""
        gu, gv = self.space.gram_diagonals
        m, k, n = np.array(self._terms).T
        return gu[m - k, m - n], gv[k, n]

    @cached_property
    def _masses(self) -> Floats:
        """Return (nu, nv) the diagonal of D: the integrals of the basis functions."""
        p = self.space.degree
        along, across = (
            (knots[p + 1 :] - knots[: -p - 1]) / (p + 1) for knots in (self.space.knots_u, self.space.knots_v)
        )
        return np.outer(along, across)

    @cached_property
    def _of_planes(self) -> Floats:
        """Return (terms, nu, nv, 3) each term times the coefficients of 1, u, v; those of order 2 and more vanish."""
        p, (gu, gv) = self.space.degree, self.space.gram_diagonals
        u, v = (bspline.greville(knots, p) for knots in (self.space.knots_u, self.space.knots_v))
        planes = ((np.ones_like(u), np.ones_like(v)), (u, np.ones_like(v)), (np.ones_like(u), v))
        terms = [(m, k, n) for m, k, n in self._terms if m < 2]
        products = [
            [np.outer(_times(gu[m - k, m - n], along), _times(gv[k, n], across)) for along, across in planes]
            for m, k, n in terms
        ]
        return np.ascontiguousarray(np.moveaxis(np.array(products), 1, 3))

    def _weights(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the weight of each term of F."""
        tables = _powers(metric(stretch), self.order)
        order = [math.comb(self.order, m) * kappa ** (2 * (self.order - m)) for m in range(self.order + 1)]
        return np.array([order[m] * tables[m][k, n] for m, k, n in self._terms])

    def _weight_slopes(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return (3, terms) the derivatives of the weights by log kappa and both parts of the stretch."""
        tables, slopes = _powers(metric(stretch), self.order), metric_slopes(stretch)
        order = [math.comb(self.order, m) * kappa ** (2 * (self.order - m)) for m in range(self.order + 1)]
        rows = [[2 * (self.order - m) * order[m] * tables[m][k, n] for m, k, n in self._terms]]
        for slope in slopes:
            turned = [np.zeros((1, 1)), *(m * _grown(tables[m - 1], slope) for m in range(1, self.order + 1))]
            rows.append([order[m] * turned[m][k, n] for m, k, n in self._terms])
        return np.array(rows)

    def _form(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return F, (2 p + 1, nu, 2 p + 1, nv); the last one is kept.

        Entry (a, i, b, j) couples control point (i + a - p, j + b - p) with (i, j).
        """
        if (kappa, stretch) != self._formed[0]:
            width, (nu, nv) = 2 * self.space.degree + 1, self.space.shape
            along, across = (factor.reshape(len(factor), -1) for factor in self._factors)
            form = (along * self._weights(kappa, stretch)[:, None]).T @ across
            self._formed = (kappa, stretch), form.reshape(width, nu, width, nv)
        return self._formed[1]

    def _factor(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the banded Cholesky factor of F; the last one is kept."""
        if (kappa, stretch) != self._factored[0]:
            form = banded(self._form(kappa, stretch)[self.space.degree :])
            lower = cholesky_banded(form, lower=True, overwrite_ab=True, check_finite=False)
            self._factored = (kappa, stretch), lower
        return self._factored[1]

    def band(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return the band of E for a kappa per unit of length and a stretch (see `metric`), (bandwidth + 1, size).

        It is wider than the space's own where the exponent is beyond the degree.
        """
        form = self._form(kappa, stretch)
        return banded(form[self.space.degree :] if self.power == 1 else squared(form, self._masses))

    def logdet(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> float:
        """Return the logarithm of the determinant of E.

        Raises
        ------
        scipy.linalg.LinAlgError
            If F is not positive definite to working precision.
        """
        lower = self._factor(kappa, stretch)
        return float(self.power * 2 * np.log(lower[0]).sum() - (self.power - 1) * np.log(self._masses).sum())

    def logdet_slopes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return (3,) the derivatives of :meth:`logdet` by log kappa and both parts of the stretch."""
        inverse = from_band(inverse_band(self._factor(kappa, stretch)), self.space.shape, self.space.degree)
        return self.power * self._of_terms(kappa, stretch, inverse)

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
        if self.power == 1:
            return self._of_terms(kappa, stretch, couplings)
        return 2 * self._of_terms(kappa, stretch, product_near(self._form(kappa, stretch), self._masses, couplings))

    def times_slopes(self, kappa: float, stretch: tuple[float, float], x: Floats) -> Floats:
        """Return (size, 3) the derivatives of E times (size,) coefficients, by log kappa and both stretches."""
        weights, slopes = self._weights(kappa, stretch), self._weight_slopes(kappa, stretch)
        products = self._products(x.reshape(self.space.shape))
        found = np.tensordot(slopes, products, axes=1)
        if self.power == 2:
            once = np.tensordot(weights, products, axes=1) / self._masses
            again = [np.tensordot(weights, self._products(one / self._masses), axes=1) for one in found]
            found = np.array(again) + np.tensordot(slopes, self._products(once), axes=1)
        return np.asarray(found.reshape(3, -1).T)

    def solve(self, kappa: float, stretch: tuple[float, float], right: Floats) -> Floats:
        """Return the inverse of E times (size, k) columns."""
        factor = self._factor(kappa, stretch), True
        solved = cho_solve_banded(factor, right, check_finite=False)
        for _ in range(self.power - 1):
            solved = cho_solve_banded(factor, self._masses.reshape(-1, 1) * solved, check_finite=False)
        return np.asarray(solved)

    @cached_property
    def _matrices(self) -> tuple[Floats, Floats]:
        """Factors of each term of F: (terms, nu, nu), (terms, nv, nv)."""
        along, across = (np.array([_matrix(diagonals) for diagonals in factor]) for factor in self._factors)
        return along, across

    def _products(self, net: Floats) -> Floats:
        """Return (terms, nu, nv) each term of F times a (nu, nv) net."""
        along, across = self._matrices
        return np.asarray(along @ net @ across.swapaxes(1, 2))

    def _of_terms(self, kappa: float, stretch: tuple[float, float], couplings: Floats) -> Floats:
        """Return (3,) the derivatives of tr(G F) for couplings G, (2 p + 1, nu, 2 p + 1, nv)."""
        along, across = (factor.reshape(len(factor), -1) for factor in self._factors)
        met = along @ couplings.reshape(along.shape[1], across.shape[1])
        return np.asarray(self._weight_slopes(kappa, stretch) @ (met * across).sum(axis=1))

    def times_planes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return E times the coefficients of 1, u and v, (size, 3)."""
        terms = self._of_planes
        flat = np.tensordot(self._weights(kappa, stretch)[: len(terms)], terms, axes=1)
        for _ in range(self.power - 1):
            flat = applied(self._form(kappa, stretch), flat / self._masses[..., None])
        return np.asarray(flat.reshape(-1, 3))


def _matrix(diagonals: Floats) -> Floats:
    """Return the matrix of the given diagonals, (2 p + 1, count) from the upmost on."""
    p, count = len(diagonals) // 2, diagonals.shape[1]
    result = np.zeros((count + 2 * p, count))
    for below, diagonal in enumerate(diagonals):
        np.fill_diagonal(result[below:], diagonal)
    return result[p : p + count]


def _times(diagonals: Floats, x: Floats) -> Floats:
    """Return the matrix of the given diagonals, (2 p + 1, count) from the upmost on, times x."""
    p, count = len(diagonals) // 2, len(x)
    result = np.zeros(count)
    for below, diagonal in enumerate(diagonals, -p):
        low, high = max(-below, 0), count - max(below, 0)
        result[low + below : high + below] += diagonal[low:high] * x[low:high]
    return result

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
from scipy.linalg import cholesky_banded

from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

__all__ = ["MaternPrecision", "metric"]

Floats = NDArray[np.float64]


def metric(stretch: tuple[float, float]) -> tuple[float, float, float]:
    """Return (a, b, c) of H = exp([[p, q], [q, -p]]), det H = 1; its larger eigenvalue is exp(hypot(p, q))."""
    p, q = stretch
    size = math.hypot(p, q)
    even, odd = math.cosh(size), math.sinh(size) / size if size > 1e-12 else 1.0
    return even + odd * p, odd * q, even - odd * p


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
        self._last: tuple[tuple[float, tuple[float, float]], Floats] = (math.nan, (0.0, 0.0)), np.empty(0)

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
        a, b, c = metric(stretch)
        power = np.ones((1, 1))
        tables = []
        for _ in range(self.order + 1):
            tables.append(power)
            grown = np.zeros((len(power) + 1, len(power) + 1))
            grown[:-1, :-1] += a * power
            grown[1:, :-1] += b * power
            grown[:-1, 1:] += b * power
            grown[1:, 1:] += c * power
            power = grown
        order = [math.comb(self.order, m) * kappa ** (2 * (self.order - m)) for m in range(self.order + 1)]
        return np.array([order[m] * tables[m][k, n] for m, k, n in self._terms])

    def _form(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return F, (2 p + 1, nu, 2 p + 1, nv); the last one is kept.

        Entry (a, i, b, j) couples control point (i + a - p, j + b - p) with (i, j).
        """
        if (kappa, stretch) != self._last[0]:
            width, (nu, nv) = 2 * self.space.degree + 1, self.space.shape
            along, across = (factor.reshape(len(factor), -1) for factor in self._factors)
            form = (along * self._weights(kappa, stretch)[:, None]).T @ across
            self._last = (kappa, stretch), form.reshape(width, nu, width, nv)
        return self._last[1]

    def band(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return the band of E for a kappa per unit of length and a stretch (see `metric`), (bandwidth + 1, size).

        It is wider than the space's own where the exponent is beyond the degree.
        """
        form = self._form(kappa, stretch)
        return self._banded(form[self.space.degree :] if self.power == 1 else _squared(form, self._masses))

    def _banded(self, blocks: Floats) -> Floats:
        """Return the band of couplings with the control points not before, (r + 1, nu, 2 r + 1, nv)."""
        reach, (nu, nv) = len(blocks) - 1, self.space.shape
        # Column by column, as LAPACK takes it.
        width = min(reach * nv + reach, self.space.size - 1) + 1
        band = np.zeros((nu, nv, width))
        for a in range(reach + 1):
            for b in range(-reach, reach + 1):
                if 0 <= a * nv + b < width:
                    band[:, :, a * nv + b] += blocks[a, :, b + reach]
        return band.reshape(self.space.size, width).T

    def logdet(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> float:
        """Return the logarithm of the determinant of E.

        Raises
        ------
        scipy.linalg.LinAlgError
            If F is not positive definite to working precision.
        """
        form = self._banded(self._form(kappa, stretch)[self.space.degree :])
        lower = cholesky_banded(form, lower=True, overwrite_ab=True, check_finite=False)
        return float(self.power * 2 * np.log(lower[0]).sum() - (self.power - 1) * np.log(self._masses).sum())

    def times_planes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return E times the coefficients of 1, u and v, (size, 3)."""
        terms = self._of_planes
        flat = np.tensordot(self._weights(kappa, stretch)[: len(terms)], terms, axes=1)
        for _ in range(self.power - 1):
            flat = _applied(self._form(kappa, stretch), flat / self._masses[..., None])
        return np.asarray(flat.reshape(-1, 3))


def _squared(form: Floats, mass: Floats) -> Floats:
    """Return F D^-1 F of couplings F, (2 p + 1, nu, 2 p + 1, nv), and masses D, (nu, nv).

    Its couplings with the control points not before, (2 p + 1, nu, 4 p + 1, nv).
    """
    p, (nu, nv) = len(form) // 2, mass.shape
    over = np.pad(form / mass[:, None], ((0, 0), (p, p), (0, 0), (p, p)))
    result = np.zeros((2 * p + 1, nu, 4 * p + 1, nv))
    for a in range(2 * p + 1):
        # From i to i + a - p, and on to i + a - p + k - p, which is not before i.
        first = 2 * p - a
        for b in range(2 * p + 1):
            met = over[first:, a : a + nu, :, b : b + nv]
            result[: a + 1, :, b : b + 2 * p + 1] += met * form[a, :, b][:, None]
    return result


def _applied(form: Floats, net: Floats) -> Floats:
    """Return couplings, (2 p + 1, nu, 2 p + 1, nv), times a net, (nu, nv, k)."""
    p, (nu, nv) = len(form) // 2, net.shape[:2]
    result = np.zeros((nu + 2 * p, nv + 2 * p, net.shape[2]))
    for a in range(2 * p + 1):
        for b in range(2 * p + 1):
            result[a : a + nu, b : b + nv] += form[a, :, b, :, None] * net
    return result[p : p + nu, p : p + nv]


def _times(diagonals: Floats, x: Floats) -> Floats:
    """Return the matrix of the given diagonals, (2 p + 1, count) from the upmost on, times x."""
    p, count = len(diagonals) // 2, len(x)
    result = np.zeros(count)
    for below, diagonal in enumerate(diagonals, -p):
        low, high = max(-below, 0), count - max(below, 0)
        result[low + below : high + below] += diagonal[low:high] * x[low:high]
    return result

"""Precision of Matérn fields on a tensor-product spline space.

A field with the spectral density 1 / (tau (kappa^2 + w' H w)^alpha) has the precision tau * E, where

    E = sum over m of binomial(alpha, m) kappa^(2 (alpha - m)) E_m,
    E_m = integral of H_(i1 j1) ... H_(im jm) f_(i1 ... im) f_(j1 ... jm),   det H = 1

(P. Whittle, Biometrika 41, 1954, 434-449; F. Lindgren, H. Rue, J. Lindström, J. R. Stat. Soc. B 73, 2011, 423-498).
E_m is a positive form of the derivatives of order m; with kappa -> 0 and alpha = 2 it is the thin plate's energy.
In terms of how many of the indices are v, k of the i and n of the j, the weight of f_(u^(m-k) v^k) f_(u^(m-n) v^n) is
the coefficient of x^k y^n in (a + b x + b y + c x y)^m for H = [[a, b], [b, c]]. Each term is a Kronecker product of
the Gram matrices of both directions.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

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
        The space; its degree must be at least ``alpha``.
    alpha : int
        Exponent of the operator kappa^2 - div H grad; the smoothness nu of the field is alpha - 1.
    """

    def __init__(self, space: TensorSpace, alpha: int) -> None:
        self.space, self.alpha = space, alpha

    @cached_property
    def _terms(self) -> list[tuple[int, int, int]]:
        return [(m, k, n) for m in range(self.alpha + 1) for k in range(m + 1) for n in range(m + 1)]

    @cached_property
    def _factors(self) -> tuple[Floats, Floats]:
        """Diagonals of the factors of each term: (terms, (p + 1) nu) at and below, (terms, (2 p + 1) nv) of all."""
        p, (gu, gv) = self.space.degree, self.space.gram_diagonals
        m, k, n = np.array(self._terms).T
        return gu[m - k, m - n, p:].reshape(len(m), -1), gv[k, n].reshape(len(m), -1)

    @cached_property
    def _of_planes(self) -> Floats:
        """Return (terms, size, 3) each term times the coefficients of 1, u and v; those of order 2 and more vanish."""
        p, (gu, gv) = self.space.degree, self.space.gram_diagonals
        u, v = (bspline.greville(knots, p) for knots in (self.space.knots_u, self.space.knots_v))
        planes = ((np.ones_like(u), np.ones_like(v)), (u, np.ones_like(v)), (np.ones_like(u), v))
        terms = [(m, k, n) for m, k, n in self._terms if m < 2]
        products = [
            [np.outer(_times(gu[m - k, m - n], along), _times(gv[k, n], across)).ravel() for along, across in planes]
            for m, k, n in terms
        ]
        return np.ascontiguousarray(np.swapaxes(np.array(products), 1, 2))

    def weights(self, kappa: float, stretch: tuple[float, float]) -> Floats:
        """Return the weight of each term."""
        a, b, c = metric(stretch)
        power = np.ones((1, 1))
        tables = []
        for _ in range(self.alpha + 1):
            tables.append(power)
            grown = np.zeros((len(power) + 1, len(power) + 1))
            grown[:-1, :-1] += a * power
            grown[1:, :-1] += b * power
            grown[:-1, 1:] += b * power
            grown[1:, 1:] += c * power
            power = grown
        order = [math.comb(self.alpha, m) * kappa ** (2 * (self.alpha - m)) for m in range(self.alpha + 1)]
        return np.array([order[m] * tables[m][k, n] for m, k, n in self._terms])

    def band(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return the band of E, (bandwidth + 1, size), for a kappa per unit of length and a stretch (see `metric`)."""
        p, (nu, nv) = self.space.degree, self.space.shape
        along, across = self._factors
        blocks = ((along * self.weights(kappa, stretch)[:, None]).T @ across).reshape(p + 1, nu, 2 * p + 1, nv)
        # Column by column, as LAPACK takes it.
        band = np.zeros((nu, nv, self.space.bandwidth + 1))
        for a in range(p + 1):
            for b in range(-p, p + 1):
                if a * nv + b >= 0:
                    band[:, :, a * nv + b] += blocks[a, :, b + p]
        return band.reshape(self.space.size, self.space.bandwidth + 1).T

    def times_planes(self, kappa: float, stretch: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Return E times the coefficients of 1, u and v, (size, 3)."""
        terms = self._of_planes
        return np.asarray(np.tensordot(self.weights(kappa, stretch)[: len(terms)], terms, axes=1))


def _times(diagonals: Floats, x: Floats) -> Floats:
    """Return the matrix of the given diagonals, (2 p + 1, count) from the upmost on, times x."""
    p, count = len(diagonals) // 2, len(x)
    result = np.zeros(count)
    for below, diagonal in enumerate(diagonals, -p):
        low, high = max(-below, 0), count - max(below, 0)
        result[low + below : high + below] += diagonal[low:high] * x[low:high]
    return result

"""Compiled: tricubic B-splines on a lattice."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["coefficient_range", "spline_jet", "spline_value"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, inline="always")
def _weights(u: float, w: Floats) -> None:
    v = 1 - u
    w[0] = v * v * v / 6
    w[1] = (4 - 6 * u * u + 3 * u * u * u) / 6
    w[2] = (4 - 6 * v * v + 3 * v * v * v) / 6
    w[3] = u * u * u / 6


@njit(cache=True)
def spline_value(places: Floats, c: Floats) -> Floats:
    """Return values at (n, 3) places in units of the spacing, within 0 and shape - 3 of the padded coefficients."""
    n = places.shape[0]
    value = np.empty(n)
    w = np.empty((3, 4))
    cell = np.empty(3, np.int64)
    for p in range(n):
        for a in range(3):
            # A coordinate that is not a number must not index beyond the array; its weights are nan.
            cell[a] = max(min(math.floor(places[p, a]), c.shape[a] - 4), 0)
            _weights(places[p, a] - cell[a], w[a])
        total = 0.0
        for i in range(4):
            for j in range(4):
                row = 0.0
                for k in range(4):
                    row += w[2, k] * c[cell[0] + i, cell[1] + j, cell[2] + k]
                total += w[0, i] * w[1, j] * row
        value[p] = total
    return value


@njit(cache=True)
def spline_jet(places: Floats, c: Floats) -> tuple[Floats, Floats, Floats]:
    """Return values, gradients (n, 3) and second derivatives (n, 6: xx, yy, zz, xy, xz, yz), per unit of spacing."""
    n = places.shape[0]
    value, gradient, hessian = np.empty(n), np.empty((n, 3)), np.empty((n, 6))
    w, d, s = np.empty((3, 4)), np.empty((3, 4)), np.empty((3, 4))
    cell = np.empty(3, np.int64)
    for p in range(n):
        for a in range(3):
            # A coordinate that is not a number must not index beyond the array; its weights are nan.
            cell[a] = max(min(math.floor(places[p, a]), c.shape[a] - 4), 0)
            u = places[p, a] - cell[a]
            v = 1 - u
            _weights(u, w[a])
            d[a, 0], d[a, 3] = -v * v / 2, u * u / 2
            d[a, 1], d[a, 2] = (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2
            s[a, 0], s[a, 1], s[a, 2], s[a, 3] = v, 3 * u - 2, 3 * v - 2, u
        f = fx = fy = fz = fxx = fyy = fzz = fxy = fxz = fyz = 0.0
        for i in range(4):
            for j in range(4):
                r = rz = rzz = 0.0
                for k in range(4):
                    value_at = c[cell[0] + i, cell[1] + j, cell[2] + k]
                    r += w[2, k] * value_at
                    rz += d[2, k] * value_at
                    rzz += s[2, k] * value_at
                ww = w[0, i] * w[1, j]
                f += ww * r
                fz += ww * rz
                fzz += ww * rzz
                fx += d[0, i] * w[1, j] * r
                fxz += d[0, i] * w[1, j] * rz
                fxx += s[0, i] * w[1, j] * r
                fy += w[0, i] * d[1, j] * r
                fyz += w[0, i] * d[1, j] * rz
                fyy += w[0, i] * s[1, j] * r
                fxy += d[0, i] * d[1, j] * r
        value[p] = f
        gradient[p, 0], gradient[p, 1], gradient[p, 2] = fx, fy, fz
        hessian[p, 0], hessian[p, 1], hessian[p, 2] = fxx, fyy, fzz
        hessian[p, 3], hessian[p, 4], hessian[p, 5] = fxy, fxz, fyz
    return value, gradient, hessian


@njit(cache=True)
def coefficient_range(first: Ints, last: Ints, c: Floats) -> tuple[Floats, Floats]:
    """Return the smallest and largest coefficient between (k, 3) indices, both included."""
    count = first.shape[0]
    low, high = np.empty(count), np.empty(count)
    for b in range(count):
        lo = hi = c[first[b, 0], first[b, 1], first[b, 2]]
        for i in range(first[b, 0], last[b, 0] + 1):
            for j in range(first[b, 1], last[b, 1] + 1):
                for k in range(first[b, 2], last[b, 2] + 1):
                    lo = min(lo, c[i, j, k])
                    hi = max(hi, c[i, j, k])
        low[b], high[b] = lo, hi
    return low, high

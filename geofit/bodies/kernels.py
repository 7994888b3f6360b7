"""Sums of a kernel and of its derivatives over many centres: the compiled loops of the body's field.

Three kernels: r^3; -r; and where a field is corrected locally, Wendland's compact C2 function of radius R
(Adv. Comput. Math. 4, 1995), (1 - q)^4 (4 q + 1) with q = r / R, which is as smooth as r^3 at its centre. r^3 is
conditionally positive definite of order two and -r of order one, so their fields carry a drift (Turk & O'Brien,
"Modelling with implicit surfaces that interpolate", ACM TOG 21(4), 2002). A weight may act on a value of the kernel or,
where a normal was measured, on its gradient (Hermite interpolation; Wendland, *Scattered Data Approximation*, ch. 16);
not of -r, which has a kink at its centre.
With d = x - c, r = |d|, the kernel k(r), first = k' / r and second = first' / r::

    value on value        k
    value on gradient    -first d
    gradient on value     first d
    gradient on gradient -(first I + second d d^T)
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["CUBIC", "KERNELS", "LINEAR", "blend", "gradients", "gram", "sweep", "values"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: The kernels r^3 and -r, given in place of a compact kernel's radius.
CUBIC, LINEAR = 0.0, -1.0
#: The same by their names in the settings.
KERNELS = {"r3": CUBIC, "r": LINEAR}


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _radial(square: float, reach: float) -> tuple[float, float, float]:
    """Return k, first and second of the module's docstring; ``reach`` is R, 0 for r^3 or -1 for -r."""
    r = math.sqrt(square)
    if reach < 0.0:
        # A kernel adds nothing to the slope at its own centre, as from all sides around it.
        return -r, -1.0 / r if r > 0.0 else 0.0, 1.0 / (square * r) if r > 0.0 else 0.0
    if reach == 0.0:
        # The limit of d d^T / r at the centre is zero.
        return square * r, 3.0 * r, 3.0 / r if r > 0.0 else 0.0
    q = r / reach
    if q >= 1.0:
        return 0.0, 0.0, 0.0
    p = (1.0 - q) * (1.0 - q)
    over = 1.0 / (reach * reach)
    second = 60.0 * over * p / (reach * r) if r > 0.0 else 0.0
    return p * p * (4.0 * q + 1.0), -20.0 * over * p * (1.0 - q), second


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _cubes(x: Floats, c: Floats, w: Floats, out: Floats) -> None:
    # The loop that takes nearly all of the time, kept free of branches so that it runs on vectors.
    for i in range(x.shape[0]):
        px, py, pz = x[i, 0], x[i, 1], x[i, 2]
        total = 0.0
        for j in range(c.shape[1]):
            dx, dy, dz = px - c[0, j], py - c[1, j], pz - c[2, j]
            square = dx * dx + dy * dy + dz * dz
            total += w[j] * square * math.sqrt(square)
        out[i] += total


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _value_at(
    p: Floats, c: Floats, w: Floats, own: tuple[int, int], g: Floats, v: Floats, turned: tuple[int, int], reach: float
) -> float:
    """Return the sum at p (3,) of the kernels ``own[0]`` to ``own[1]`` and the gradients ``turned[0]`` to [1]."""
    px, py, pz = p[0], p[1], p[2]
    total = 0.0
    for j in range(own[0], own[1]):
        dx, dy, dz = px - c[0, j], py - c[1, j], pz - c[2, j]
        total += w[j] * _radial(dx * dx + dy * dy + dz * dz, reach)[0]
    for j in range(turned[0], turned[1]):
        dx, dy, dz = px - g[0, j], py - g[1, j], pz - g[2, j]
        first = _radial(dx * dx + dy * dy + dz * dz, reach)[1]
        total -= first * (v[0, j] * dx + v[1, j] * dy + v[2, j] * dz)
    return total


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _gradient_at(
    p: Floats, c: Floats, w: Floats, own: tuple[int, int], g: Floats, v: Floats, turned: tuple[int, int], reach: float
) -> tuple[float, float, float, float]:
    """Return what :func:`_value_at` returns, and its gradient."""
    px, py, pz = p[0], p[1], p[2]
    total, sx, sy, sz = 0.0, 0.0, 0.0, 0.0
    for j in range(own[0], own[1]):
        dx, dy, dz = px - c[0, j], py - c[1, j], pz - c[2, j]
        k, first, _ = _radial(dx * dx + dy * dy + dz * dz, reach)
        total += w[j] * k
        f = w[j] * first
        sx += f * dx
        sy += f * dy
        sz += f * dz
    for j in range(turned[0], turned[1]):
        dx, dy, dz = px - g[0, j], py - g[1, j], pz - g[2, j]
        _, first, second = _radial(dx * dx + dy * dy + dz * dz, reach)
        along = v[0, j] * dx + v[1, j] * dy + v[2, j] * dz
        total -= first * along
        f = second * along
        sx -= first * v[0, j] + f * dx
        sy -= first * v[1, j] + f * dy
        sz -= first * v[2, j] + f * dz
    return total, sx, sy, sz


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _values(x: Floats, c: Floats, w: Floats, g: Floats, v: Floats, reach: float, out: Floats) -> None:
    for i in range(x.shape[0]):
        out[i] += _value_at(x[i], c, w, (0, c.shape[1]), g, v, (0, g.shape[1]), reach)


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _gradients(x: Floats, c: Floats, w: Floats, g: Floats, v: Floats, reach: float, out: Floats) -> None:
    for i in range(x.shape[0]):
        _, sx, sy, sz = _gradient_at(x[i], c, w, (0, c.shape[1]), g, v, (0, g.shape[1]), reach)
        out[i, 0] += sx
        out[i, 1] += sy
        out[i, 2] += sz


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def blend(
    x: Floats, centre: Floats, half: Floats, reach: Floats, first: Ints, c: Floats, w: Floats, turned: Ints, g: Floats,
    v: Floats, slopes: bool, out: Floats, out_slopes: Floats,
) -> None:  # fmt: skip
    """Add to ``out`` (n,), and to ``out_slopes`` (n, 3) if wanted, the blended corrections of overlapping boxes.

    Box b has the kernels ``first[b]`` to ``first[b + 1]`` of c (3, m) and w (m,), the gradients ``turned[b]`` to
    ``turned[b + 1]`` of g (3, k) and v (3, k), and weights that are products of 1 - t^3 (10 - 15 t + 6 t^2).
    """
    one, slope = np.zeros(3), np.zeros(3)
    for i in range(x.shape[0]):
        weights, total = 0.0, 0.0
        wx, wy, wz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for b in range(len(reach)):
            if (
                abs(x[i, 0] - centre[b, 0]) >= half[b, 0]
                or abs(x[i, 1] - centre[b, 1]) >= half[b, 1]
                or abs(x[i, 2] - centre[b, 2]) >= half[b, 2]
            ):
                continue
            for a in range(3):
                t = (x[i, a] - centre[b, a]) / half[b, a]
                sign = 1.0 if t > 0.0 else -1.0
                t = abs(t)
                one[a] = 1.0 - t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
                slope[a] = -30.0 * sign * t * t * (1.0 - t) * (1.0 - t) / half[b, a]
            weight = one[0] * one[1] * one[2]
            own, dipoles = (first[b], first[b + 1]), (turned[b], turned[b + 1])
            if slopes:
                value, sx, sy, sz = _gradient_at(x[i], c, w, own, g, v, dipoles, reach[b])
            else:
                value, sx, sy, sz = _value_at(x[i], c, w, own, g, v, dipoles, reach[b]), 0.0, 0.0, 0.0
            weights += weight
            total += weight * value
            if slopes:
                px, py, pz = slope[0] * one[1] * one[2], one[0] * slope[1] * one[2], one[0] * one[1] * slope[2]
                wx, wy, wz = wx + px, wy + py, wz + pz
                tx += px * value + weight * sx
                ty += py * value + weight * sy
                tz += pz * value + weight * sz
        if weights > 0.0:
            mean = total / weights
            out[i] += mean
            if slopes:
                out_slopes[i, 0] += (tx - mean * wx) / weights
                out_slopes[i, 1] += (ty - mean * wy) / weights
                out_slopes[i, 2] += (tz - mean * wz) / weights


def values(x: Floats, centres: Floats, weights: Floats, dipoles: Floats, moments: Floats, reach: float = 0.0) -> Floats:
    """Return the sum of kernels at x (n, 3).

    Parameters
    ----------
    x : (n, 3) array
        Places.
    centres, weights : (m, 3), (m,) arrays
        Kernels and their weights.
    dipoles, moments : (k, 3), (k, 3) arrays
        Gradients of kernels and their weights.
    reach : float
        Radius of the compact kernel; 0 for r^3 (CUBIC), -1 for -r (LINEAR).
    """
    out = np.zeros(len(x))
    x = np.ascontiguousarray(x)
    if reach == 0.0 and not len(dipoles):
        given: Any = (x, *_columns(centres), weights, out)
        _cubes(*given)
    else:
        given = (x, *_columns(centres), weights, *_columns(dipoles, moments), reach, out)
        _values(*given)
    return out


def gradients(
    x: Floats, centres: Floats, weights: Floats, dipoles: Floats, moments: Floats, reach: float = 0.0
) -> Floats:
    """Return the gradient (n, 3) of the sum of kernels; arguments as :func:`values`."""
    out = np.zeros((len(x), 3))
    given: Any = (np.ascontiguousarray(x), *_columns(centres), weights, *_columns(dipoles, moments), reach, out)
    _gradients(*given)
    return out


def _columns(*arrays: Floats) -> list[Floats]:
    return [np.ascontiguousarray(a.T) for a in arrays]


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def _gram(a: Floats, p: Floats, b: Floats, q: Floats, reach: float, out: Floats) -> None:
    n, m = a.shape[0], b.shape[0]
    for i in range(n):
        for j in range(m):
            dx, dy, dz = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
            out[i, j] = _radial(dx * dx + dy * dy + dz * dz, reach)[0]
        for j in range(q.shape[0]):
            dx, dy, dz = a[i, 0] - q[j, 0], a[i, 1] - q[j, 1], a[i, 2] - q[j, 2]
            first = _radial(dx * dx + dy * dy + dz * dz, reach)[1]
            out[i, m + 3 * j], out[i, m + 3 * j + 1], out[i, m + 3 * j + 2] = -first * dx, -first * dy, -first * dz
    d = np.zeros(3)
    for i in range(p.shape[0]):
        for j in range(m):
            dx, dy, dz = p[i, 0] - b[j, 0], p[i, 1] - b[j, 1], p[i, 2] - b[j, 2]
            first = _radial(dx * dx + dy * dy + dz * dz, reach)[1]
            out[n + 3 * i, j], out[n + 3 * i + 1, j], out[n + 3 * i + 2, j] = first * dx, first * dy, first * dz
        for j in range(q.shape[0]):
            d[0], d[1], d[2] = p[i, 0] - q[j, 0], p[i, 1] - q[j, 1], p[i, 2] - q[j, 2]
            _, first, second = _radial(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], reach)
            for s in range(3):
                for t in range(3):
                    out[n + 3 * i + s, m + 3 * j + t] = -second * d[s] * d[t] - (first if s == t else 0.0)


def gram(a: Floats, a_gradients: Floats, b: Floats, b_gradients: Floats, reach: float = 0.0) -> Floats:
    """Return the kernel between two sets of functionals.

    Parameters
    ----------
    a, b : (n, 3), (m, 3) arrays
        Places of values.
    a_gradients, b_gradients : (k, 3), (l, 3) arrays
        Places of gradients; each counts for three rows or columns: x, y, z of the first place, then of the second.
    reach : float
        Radius of the compact kernel; 0 for r^3 (CUBIC), -1 for -r (LINEAR).

    Returns
    -------
    (n + 3k, m + 3l) array
    """
    out = np.empty((len(a) + 3 * len(a_gradients), len(b) + 3 * len(b_gradients)))
    given: Any = (*(np.ascontiguousarray(part) for part in (a, a_gradients, b, b_gradients)), reach, out)
    _gram(*given)
    return out


@njit(cache=True, fastmath=True, nogil=True, error_model="numpy")
def sweep(matrix: Floats, right: Floats, forced: Any, x: Floats, count: int) -> None:
    """Take ``count`` Gauss-Seidel sweeps of matrix @ x = right in place, with x >= 0 wherever not forced."""
    for _ in range(count):
        for i in range(len(x)):
            total = right[i]
            for j in range(len(x)):
                total -= matrix[i, j] * x[j]
            new = x[i] + total / matrix[i, i]
            x[i] = new if new > 0.0 or forced[i] else 0.0

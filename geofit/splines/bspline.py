"""B-spline bases, their knots, and the energies of derivatives. Pure functions over arrays.

Knot vectors are clamped: the first and last knot stand ``degree + 1`` times.
Source of the recurrences: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed. 1997, chapters 2 and 5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "basis",
    "bins",
    "clamped_knots",
    "collocation",
    "common_knots",
    "energy_matrix",
    "gram_diagonals",
    "greville",
    "insertion_matrix",
    "intervals",
    "spans",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def clamped_knots(breaks: ArrayLike, degree: int, multiplicity: ArrayLike = 1) -> Floats:
    """Return the clamped knot vector of strictly ascending ``breaks``.

    Parameters
    ----------
    breaks : (k,) array_like
        Ends of the spans, ascending.
    degree : int
        Degree of the spline.
    multiplicity : int or (k - 2,) array_like of int
        How often each inner break stands.

    Examples
    --------
    >>> clamped_knots([0, 1, 2], 2).tolist()
    [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]
    """
    breaks = np.asarray(breaks, float)
    inner = np.repeat(breaks[1:-1], np.broadcast_to(multiplicity, (len(breaks) - 2,)))
    return np.concatenate([np.repeat(breaks[0], degree + 1), inner, np.repeat(breaks[-1], degree + 1)])


def spans(knots: Floats, degree: int, x: Floats) -> Ints:
    """Return the index k of the span with knots[k] <= x < knots[k + 1]; the last span holds its right end."""
    count = len(knots) - degree - 1
    return np.clip(np.searchsorted(knots, x, side="right") - 1, degree, count - 1).astype(np.int64)


def bins(breaks: Floats, count: int) -> Ints:
    """Return which interval holds the start of each of so many even bins, or a rounding error before it.

    The bins fill the room between the outermost breaks; one more begins at the last of them.
    """
    length = float(breaks[-1] - breaks[0])
    starts = np.linspace(breaks[0], breaks[-1], count + 1) - 1e-6 * length / count
    return np.asarray(np.clip(np.searchsorted(breaks, starts, side="right") - 1, 0, len(breaks) - 2), np.int64)


def intervals(breaks: Floats, x: Floats) -> Ints:
    """Return the index k with breaks[k] <= x < breaks[k + 1]; the first and the last hold what lies beyond.

    For many places a table of even bins names which interval begins there, or a rounding error before; each bin is
    shorter than half an interval, so a look at the next break settles the rest in half a search's time.
    """
    last, length = len(breaks) - 2, float(breaks[-1] - breaks[0])
    count = int(np.ceil(2 * length / np.diff(breaks).min()))
    if len(x) < 16 * count:
        return np.asarray(np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, last), np.int64)
    found = bins(breaks, count).take(((x - breaks[0]) * (count / length)).clip(0, count).astype(np.intp))
    found = found + (x >= np.append(breaks[1:-1], np.inf).take(found))
    return np.asarray(found, np.int64)


def basis(knots: Floats, degree: int, x: ArrayLike, derivative: int = 0) -> tuple[Ints, Floats]:
    """Evaluate the basis functions that do not vanish at ``x``.

    Outside the knots the first and last polynomial are continued.

    Parameters
    ----------
    knots : (m,) array
        Clamped knot vector.
    degree : int
        Degree of the spline.
    x : (n,) array_like
        Parameters.
    derivative : int
        Order of the derivative.

    Returns
    -------
    first : (n,) array of int
        Index of the first function that does not vanish.
    values : (n, degree + 1) array
        Their values (A2.2), or derivatives (eq. 2.7 applied ``derivative`` times).
    """
    x = np.asarray(x, float)
    span = spans(knots, degree, x)
    first = span - degree
    if derivative > degree:
        return first, np.zeros((len(x), degree + 1))
    low = degree - derivative
    # Functions by places, not places by functions: numpy runs along the longer axis.
    values = np.ones((1, len(x)))
    around = knots[span + np.arange(1 - degree, degree + 1)[:, None]]
    for p in range(1, degree + 1):
        # One degree up: N_{i,p} from N_{i,p-1}; i runs over the p + 1 functions of the span.
        left, right = around[degree - p : degree], around[degree : degree + p]
        width = right - left
        ratio = values / np.where(width > 0, width, np.inf)
        falling, rising = (ratio * (right - x), ratio * (x - left)) if p <= low else (-p * ratio, p * ratio)
        values = np.zeros((p + 1, len(x)))
        values[:-1] += falling
        values[1:] += rising
    return first, np.ascontiguousarray(values.T)


def collocation(knots: Floats, degree: int, x: ArrayLike, derivative: int = 0) -> Floats:
    """Return the dense (n, count) matrix of all basis functions at ``x``."""
    first, values = basis(knots, degree, x, derivative)
    matrix = np.zeros((len(first), len(knots) - degree - 1))
    np.put_along_axis(matrix, first[:, None] + np.arange(degree + 1), values, axis=1)
    return matrix


def greville(knots: Floats, degree: int) -> Floats:
    """Return the Greville abscissae: the control points of the identity (x(u) = u)."""
    count = len(knots) - degree - 1
    abscissae: Floats = np.mean([knots[1 + j : 1 + j + count] for j in range(degree)], axis=0)
    return abscissae


def energy_matrix(knots: Floats, degree: int, order: int) -> Floats:
    """Return the (count, count) Gram matrix of the derivatives: c @ G @ c is the integral of (s^(order))^2.

    Gauss points are taken so that the integral is exact on each span.
    """
    nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
    breaks = np.unique(knots)
    half = np.diff(breaks) / 2
    x = (breaks[:-1] + half)[:, None] + half[:, None] * nodes
    w = np.sqrt(half[:, None] * weights)
    matrix = collocation(knots, degree, x.ravel(), order) * w.reshape(-1, 1)
    return matrix.T @ matrix


def gram_diagonals(knots: Floats, degree: int) -> Floats:
    """Return the diagonals of the Gram matrices G[r][s] of all derivatives, the integrals of B_i^(r) B_j^(s).

    Returns
    -------
    diagonals : (degree + 1, degree + 1, 2 degree + 1, count) array
        ``diagonals[r, s, degree + k, j]`` is G[r][s][j + k, j], zero where that leaves the matrix.

    Notes
    -----
    Gauss points are taken so that the integrals are exact on each span.
    """
    nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
    breaks = np.unique(knots)
    half = np.diff(breaks) / 2
    x = ((breaks[:-1] + half)[:, None] + half[:, None] * nodes).ravel()
    root = np.sqrt(half[:, None] * weights).reshape(-1, 1)
    tables = [basis(knots, degree, x, order) for order in range(degree + 1)]
    values = np.stack([table * root for _, table in tables]).reshape(degree + 1, len(half), degree + 1, degree + 1)
    blocks = np.einsum("rcqi,scqj->rsijc", values, values, optimize=True)
    first = tables[0][0][:: degree + 1]
    result = np.zeros((degree + 1, degree + 1, 2 * degree + 1, len(knots) - degree - 1))
    for i in range(degree + 1):
        for j in range(degree + 1):
            result[:, :, degree + i - j, first + j] += blocks[:, :, i, j]
    return result


def common_knots(*knots: Floats) -> Floats:
    """Return the knots of several vectors, each as often as the one that has it most often."""
    values = np.unique(np.concatenate(knots))
    counts = [
        np.searchsorted(each, values, side="right") - np.searchsorted(each, values, side="left") for each in knots
    ]
    return np.repeat(values, np.max(counts, axis=0))


def insertion_matrix(coarse: Floats, fine: Floats, degree: int) -> Floats:
    """Return T with c_fine = T @ c_coarse for a knot vector ``fine`` that contains ``coarse``.

    Source: E. Cohen, T. Lyche, R. Riesenfeld, Computer Graphics and Image Processing 14, 1980, 87-111 (the Oslo
    algorithm): the matrix of one degree from that of the degree below.
    """
    count = len(fine) - degree - 1
    matrix = np.zeros((count, len(coarse) - 1))
    at = np.searchsorted(coarse, fine[:count], side="right") - 1
    matrix[np.arange(count), np.minimum(at, len(coarse) - degree - 2)] = 1.0
    for k in range(1, degree + 1):
        new = fine[k : count + k, None]
        width = coarse[k:] - coarse[:-k]
        over = 1 / np.where(width > 0, width, np.inf)
        rising = matrix * ((new - coarse[:-k]) * over)
        falling = matrix * ((coarse[k:] - new) * over)
        matrix = rising[:, :-1] + falling[:, 1:]
    return matrix

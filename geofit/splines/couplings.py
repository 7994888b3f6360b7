"""Matrices of a tensor space by their couplings: which control point acts on which of its neighbours.

The matrices of a fit couple control points at most r steps apart in both directions. Couplings are an array
(2 r + 1, nu, 2 r + 1, nv): entry (a, i, b, j) is that of row (i + a - r, j + b - r) and column (i, j), and zero where
that row lies outside the space. Products of such matrices are sums of a few products of whole arrays.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

__all__ = ["applied", "banded", "dyads", "from_band", "product_near", "squared"]

Floats = NDArray[np.float64]


def banded(below: Floats) -> Floats:
    """Return the lower band of a symmetric matrix, (bandwidth + 1, size), of its couplings with the rows not before.

    These are the last r + 1 of the couplings, (r + 1, nu, 2 r + 1, nv).
    """
    reach, (nu, nv) = len(below) - 1, (below.shape[1], below.shape[3])
    # Column by column, as LAPACK takes it.
    width = min(reach * nv + reach, nu * nv - 1) + 1
    band = np.zeros((nu, nv, width))
    for a in range(reach + 1):
        for b in range(-reach, reach + 1):
            if 0 <= a * nv + b < width:
                band[:, :, a * nv + b] += below[a, :, b + reach]
    return band.reshape(nu * nv, width).T


def from_band(band: Floats, shape: tuple[int, int], reach: int) -> Floats:
    """Return the couplings of a symmetric matrix from its lower band, (bandwidth + 1, size)."""
    nu, nv = shape
    result = np.zeros((2 * reach + 1, nu, 2 * reach + 1, nv))
    for a in range(min(reach, nu - 1) + 1):
        for b in range(-reach if a else 0, reach + 1):
            if abs(b) < nv:
                diagonal = band[a * nv + b].reshape(nu, nv)
                left, right = max(-b, 0), nv - max(b, 0)
                met = diagonal[: nu - a, left:right]
                result[reach + a, : nu - a, reach + b, left:right] = met
                result[reach - a, a:, reach - b, left + b : right + b] = met
    return result


def dyads(columns: Floats, reach: int) -> Floats:
    """Return the couplings of C C', of the (nu, nv, k) columns of C."""
    padded = np.pad(columns, ((reach, reach), (reach, reach), (0, 0)))
    rows = sliding_window_view(padded, columns.shape[:2], axis=(0, 1))
    return np.asarray(np.einsum("abkij,ijk->aibj", rows, columns))


def squared(form: Floats, mass: Floats) -> Floats:
    """Return F D^-1 F of couplings F, (2 p + 1, nu, 2 p + 1, nv), and a diagonal D, (nu, nv).

    Its couplings with the rows not before, (2 p + 1, nu, 4 p + 1, nv).
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


def product_near(form: Floats, mass: Floats, couplings: Floats) -> Floats:
    """Return D^-1 F G of couplings F of reach p, a diagonal D, (nu, nv), and couplings G of reach 2 p.

    Its couplings of reach p: those farther away would ask for more of G.
    """
    p, (nu, nv) = len(form) // 2, mass.shape
    width = 2 * p + 1
    # F is symmetric: its column is the row of the product.
    over = np.pad(form / mass[:, None], ((0, 0), (p, p), (0, 0), (p, p)))
    result = np.zeros((width, nu, width, nv))
    for a in range(width):
        for b in range(width):
            rows = sliding_window_view(over[a, :, b], (nu, nv)).transpose(0, 2, 1, 3)
            result += rows * couplings[a : a + width, :, b : b + width]
    return result


def applied(form: Floats, net: Floats) -> Floats:
    """Return a symmetric matrix of couplings, (2 p + 1, nu, 2 p + 1, nv), times a net, (nu, nv, k)."""
    p, (nu, nv) = len(form) // 2, net.shape[:2]
    result = np.zeros((nu + 2 * p, nv + 2 * p, net.shape[2]))
    for a in range(2 * p + 1):
        for b in range(2 * p + 1):
            result[a : a + nu, b : b + nv] += form[a, :, b, :, None] * net
    return result[p : p + nu, p : p + nv]

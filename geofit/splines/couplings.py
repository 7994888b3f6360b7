"""Matrices of a tensor space by their couplings: which control point acts on which of its neighbours.

The matrices of a fit couple control points at most r steps apart in both directions. Couplings are an array
(2 r + 1, nu, 2 r + 1, nv): entry (a, i, b, j) is that of row (i + a - r, j + b - r) and column (i, j), and zero where
that row lies outside the space.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

__all__ = ["banded", "dyads", "from_band"]

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

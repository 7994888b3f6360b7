"""Banded systems as block tridiagonal ones: many right-hand sides, and the inverse near its diagonal.

A banded matrix cut into blocks as wide as its band is block tridiagonal, and so are its Cholesky factor and the part
of its inverse that a spline's values ask for. All work is products of dense blocks.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import as_strided, sliding_window_view
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.linalg.blas import dsymm, dtrmm
from scipy.linalg.lapack import dlauum, dtrtri
from scipy.sparse import csr_array

from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.splines.tensor import RIDGES

__all__ = ["BlockFactor", "InverseBlocks", "inverse_band"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Half the size of a triangle from which on it is inverted by halves.
_SMALL = 32


class BlockFactor:
    """Cholesky factor L of a symmetric positive definite banded matrix, by blocks.

    Parameters
    ----------
    band : (bandwidth + 1, size) array
        Lower band: ``band[k, j] = A[j + k, j]``.

    Attributes
    ----------
    ridge : (size,) array
        What was added to the diagonal.

    Raises
    ------
    FitError
        If the matrix is not positive definite to working precision.
    """

    def __init__(self, band: Floats) -> None:
        self.size = band.shape[1]
        self.width = max(min(len(band) - 1, self.size), 1)
        if not (band[0] > 0).all():
            raise FitError(
                message(
                    "splines.control-points-unconstrained",
                    "The posterior of the fit is improper: some control points are not constrained.",
                )
            )
        # Scaled to a unit diagonal, as in geofit.splines.tensor.Factor.
        self._scale = 1 / np.sqrt(band[0])
        self._starts = np.arange(0, self.size, self.width)
        diagonal, below = _cut(_scaled(band, self._scale), self.width)
        for ridge in RIDGES:
            try:
                self._factorise(diagonal, below, ridge)
                self.ridge: Floats = ridge * band[0]
                return
            except LinAlgError:
                continue
        raise FitError(
            message(
                "splines.control-points-free",
                "The posterior of the fit is improper: points and energy leave control points free.",
            )
        )

    def _factorise(self, diagonal: list[Floats], below: list[Floats], ridge: float) -> None:
        self._lower: list[Floats] = []
        self._below: list[Floats] = []
        left: Floats | float = 0.0
        for k, block in enumerate(diagonal):
            full = block - left
            full.flat[:: len(full) + 1] += ridge
            lower = cholesky(full, lower=True, check_finite=False)
            self._lower.append(lower)
            if k < len(below):
                off = solve_triangular(lower, below[k].T, lower=True, check_finite=False).T
                self._below.append(np.ascontiguousarray(off))
                left = off @ off.T

    def half(self, right: Floats) -> Floats:
        """Return L^-1 times (size, k) right-hand sides: its inner products are those of the inverse matrix."""
        result: Floats = right * self._scale[:, None]
        for k in range(len(self._starts)):
            result[self._rows(k)] = self._step(k, result[self._rows(k)], result[self._rows(k - 1)] if k else None)
        return result

    def gram(self, matrix: csr_array) -> Floats:
        """Return B Z B', (n, n), of the inverse Z and a sparse (n, size) matrix B, block by block.

        Columns of L^-1 B' are zero above the first entry of their row of B, so the rows are taken in that order.
        """
        scaled = csr_array(matrix * self._scale)
        first = np.array([scaled.indices[a:b].min() if b > a else self.size for a, b in pairwise(scaled.indptr)])
        order = np.argsort(first, kind="stable")
        columns = scaled[order].T.tocsr()
        begun = np.searchsorted(first[order], self._starts + self.width)
        result = np.zeros((len(order), len(order)))
        before = None
        for k in range(len(self._starts)):
            count = int(begun[k])
            right = columns[self._rows(k), :count].toarray()
            if before is not None:
                before = np.pad(before, ((0, 0), (0, count - before.shape[1])))
            before = self._step(k, right, before)
            result[:count, :count] += before.T @ before
        back = np.empty(len(order), dtype=np.int64)
        back[order] = np.arange(len(order))
        return np.asarray(result[np.ix_(back, back)])

    def _rows(self, k: int) -> slice:
        return slice(int(self._starts[k]), int(self._starts[k]) + len(self._lower[k]))

    def _step(self, k: int, right: Floats, before: Floats | None) -> Floats:
        """Eliminate block k, given what block k - 1 came to."""
        if before is not None:
            right = right - self._below[k - 1] @ before
        return np.asarray(solve_triangular(self._lower[k], right, lower=True, check_finite=False))

    def solve(self, right: Floats) -> Floats:
        """Solve for (size, k) right-hand sides."""
        result = self.half(right)
        for k in range(len(self._starts) - 1, -1, -1):
            rows = self._rows(k)
            if k + 1 < len(self._starts):
                result[rows] -= self._below[k].T @ result[self._rows(k + 1)]
            result[rows] = solve_triangular(self._lower[k], result[rows], lower=True, trans=1, check_finite=False)
        return np.asarray(result * self._scale[:, None])

    def inverse(self) -> InverseBlocks:
        """Return the inverse within the band."""
        diagonal, below = _inverted(self._lower, self._below)
        whole = [np.tril(block) + np.tril(block, -1).T for block in diagonal]
        return InverseBlocks(self.width, whole, below, self._scale)


class InverseBlocks:
    """Entries of an inverse within the band of the matrix."""

    def __init__(self, width: int, diagonal: list[Floats], below: list[Floats], scale: Floats) -> None:
        self._width, self._diagonal, self._below, self._scale = width, diagonal, below, scale

    def quadratic(self, index: Ints, values: Floats) -> Floats:
        """Return (n,) b' Z b of sparse vectors b: (n, k) ascending indices within one band, and their values."""
        scaled = values * self._scale[index]
        first = index[:, 0] // self._width
        result = np.empty(len(index))
        for k in np.unique(first):
            mine = np.flatnonzero(first == k)
            local = index[mine] - k * self._width
            block = self._diagonal[k]
            if local.max() >= len(block):
                block = np.block([[block, self._below[k].T], [self._below[k], self._diagonal[k + 1]]])
            part = block[local[:, :, None], local[:, None, :]]
            result[mine] = np.einsum("na,nab,nb->n", scaled[mine], part, scaled[mine])
        return result


def inverse_band(lower: Floats) -> Floats:
    """Return the entries of the inverse of L L' within the band, (width + 1, size), of a banded Cholesky factor L."""
    width, size = max(min(len(lower) - 1, lower.shape[1]), 1), lower.shape[1]
    diagonal, below = _inverted(*_cut(lower, width))
    band = np.empty((width + 1, width * len(diagonal)))
    for k, own in enumerate(diagonal):
        column = np.zeros((2 * width, width))
        column[: len(own), : len(own)] = own
        if k < len(below):
            column[width : width + len(below[k])] = below[k]
        band[:, k * width : (k + 1) * width] = _by_diagonals(column)
    return band[:, :size]


def _by_diagonals(column: Floats) -> Floats:
    """Return the view of a block column, (2 w, w), whose row k is the diagonal k steps below the main one."""
    return as_strided(column, (column.shape[1] + 1, column.shape[1]), (column.strides[0], sum(column.strides)))


def _cut(band: Floats, width: int) -> tuple[list[Floats], list[Floats]]:
    """Return the diagonal blocks of a lower band, their lower triangles, and the blocks below them."""
    size = band.shape[1]
    padded = np.pad(band[: width + 1], ((0, 0), (0, -size % width)))
    diagonal, below = [], []
    for start in range(0, size, width):
        end = min(start + width, size)
        column = np.zeros((2 * width, width))
        _by_diagonals(column)[: len(padded)] = padded[:, start : start + width]
        diagonal.append(column[: end - start, : end - start])
        below.append(column[width : width + size - end, : end - start])
    return diagonal, below[:-1]


def _inverted(lower: list[Floats], below: list[Floats]) -> tuple[list[Floats], list[Floats]]:
    """Return the blocks on and below the diagonal of the inverse Z of L L' (recursion of Takahashi et al., 1973).

    With G = L_(k+1,k) L_kk^-1: Z_(k+1,k) = -Z_(k+1,k+1) G and Z_kk = L_kk^-T L_kk^-1 - G' Z_(k+1,k). Of the blocks on
    the diagonal only the lower triangles are filled.
    """
    diagonal: list[Floats] = []
    off: list[Floats] = []
    for k in range(len(lower) - 1, -1, -1):
        inverse = _triangle_inverse(lower[k])
        own = dlauum(inverse, lower=True)[0]
        if k < len(below):
            step = dtrmm(1.0, inverse, below[k], side=True, lower=True)
            off.append(dsymm(-1.0, diagonal[-1], step, lower=True))
            own -= step.T @ off[-1]
        diagonal.append(own)
    return diagonal[::-1], off[::-1]


def _triangle_inverse(lower: Floats) -> Floats:
    """Return the inverse of a lower triangle, by halves: LAPACK's own takes three times as long."""
    half = len(lower) // 2
    if half < _SMALL:
        return np.asarray(dtrtri(lower, lower=True)[0])
    result = np.zeros(lower.shape, order="F")
    result[:half, :half] = first = _triangle_inverse(lower[:half, :half])
    result[half:, half:] = second = _triangle_inverse(lower[half:, half:])
    result[half:, :half] = -second @ (lower[half:, :half] @ first)
    return result


def _scaled(band: Floats, scale: Floats) -> Floats:
    """Return the lower band of a matrix whose rows and columns are multiplied by (size,) numbers."""
    beyond = np.concatenate([scale, np.zeros(len(band) - 1)])
    return np.asarray(band * scale * sliding_window_view(beyond, len(scale)))

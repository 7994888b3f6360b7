"""Tensor-product spline spaces: their rows, normal equations, energies, and banded systems.

The coefficients of a space with ``nu x nv`` control points are numbered ``i * nv + j``. Every matrix of a
fit couples only neighbours within one degree in both directions, so it is banded with half width
``degree * nv + degree``; a banded Cholesky factorisation of 4,000 unknowns takes some 0.02 s.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import comb

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.linalg.blas import dsbmv
from scipy.sparse import csr_array

from geofit.data.errors import FitError
from geofit.data.long_arrays import Rows
from geofit.data.messages import message
from geofit.splines import bspline
from geofit.splines.sums import CellSums, cell_sums

__all__ = ["Factor", "TensorSpace", "band_sum", "band_times"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: From this many points a control point on, normal equations are summed by cells instead of by points: a cell takes as
#: long as two points do.
CELLWISE = 2
#: Added to a unit diagonal, more where rounding has made a system indefinite: it settles what neither data nor
#: energy hold by the trend, far below any noise.
RIDGES = (1e-13, 1e-12, 1e-10)


@dataclass(frozen=True, eq=False)
class TensorSpace:
    """Tensor product of two clamped B-spline bases.

    Parameters
    ----------
    knots_u, knots_v : (m,) arrays
        Knot vectors.
    degree : int
        Degree in both directions.
    """

    knots_u: Floats
    knots_v: Floats
    degree: int = 3

    @classmethod
    def on_breaks(cls, breaks_u: Floats, breaks_v: Floats, degree: int) -> TensorSpace:
        """Return the space with simple knots at ascending breaks."""
        return cls(bspline.clamped_knots(breaks_u, degree), bspline.clamped_knots(breaks_v, degree), degree)

    @property
    def shape(self) -> tuple[int, int]:
        """Number of control points in u and v."""
        return len(self.knots_u) - self.degree - 1, len(self.knots_v) - self.degree - 1

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return self.shape[0] * self.shape[1]

    @property
    def bandwidth(self) -> int:
        """Half width of the band of its matrices."""
        return self.degree * self.shape[1] + self.degree

    @property
    def turned(self) -> TensorSpace:
        """The space with u and v exchanged: its band is the narrower one if v has the more control points."""
        return TensorSpace(self.knots_v, self.knots_u, self.degree)

    def support(self, index: int) -> tuple[float, float, float, float]:
        """Return the rectangle (u0, u1, v0, v1) outside of which a function is zero."""
        a, b = divmod(index, self.shape[1])
        reach, u, v = self.degree + 1, self.knots_u, self.knots_v
        return float(u[a]), float(u[a + reach]), float(v[b]), float(v[b + reach])

    def rows(self, plane: Floats) -> tuple[Ints, Floats]:
        """Return the coefficients that act at (n, 2) places and their basis values, both (n, (degree + 1)^2)."""
        iu, bu = bspline.basis(self.knots_u, self.degree, plane[:, 0])
        iv, bv = bspline.basis(self.knots_v, self.degree, plane[:, 1])
        step = np.arange(self.degree + 1)
        index = (iu[:, None] + step)[:, :, None] * self.shape[1] + (iv[:, None] + step)[:, None, :]
        count = (self.degree + 1) ** 2
        return index.reshape(-1, count), (bu[:, :, None] * bv[:, None, :]).reshape(-1, count)

    def gradient_rows(self, plane: Floats, along: Floats) -> tuple[Ints, Floats]:
        """Return the coefficients that act on the derivative along (n, 2) vectors at (n, 2) places, and their values.

        The derivative is ``along . gradient``: vectors are not scaled to a length of 1.
        """
        index, _ = self.rows(plane)
        (_, bu), (_, bv) = (bspline.basis(k, self.degree, x) for k, x in zip(self._knots, plane.T, strict=True))
        (_, du), (_, dv) = (bspline.basis(k, self.degree, x, 1) for k, x in zip(self._knots, plane.T, strict=True))
        values = along[:, 0, None, None] * du[:, :, None] * bv[:, None, :]
        values += along[:, 1, None, None] * bu[:, :, None] * dv[:, None, :]
        return index, values.reshape(len(plane), -1)

    @property
    def _knots(self) -> tuple[Floats, Floats]:
        return self.knots_u, self.knots_v

    def matrix(self, plane: Floats) -> csr_array:
        """Return the sparse (n, size) collocation matrix of (n, 2) places."""
        index, values = self.rows(plane)
        pointer = np.arange(len(index) + 1) * index.shape[1]
        return csr_array((values.ravel(), index.ravel(), pointer), shape=(len(index), self.size))

    def normal_equations(self, plane: Rows, z: Rows, weight: Floats) -> tuple[Floats, Floats]:
        """Return the band of X' W X, (bandwidth + 1, size), and X' W z, (size,) or (size, k)."""
        few = len(plane) < CELLWISE * self.size
        if isinstance(plane, np.ndarray) and isinstance(z, np.ndarray) and (few or z.ndim > 1):
            return self._by_points(plane, z, weight)
        return self.equations(self.sums(plane, z, weight))

    def _by_points(self, plane: Floats, z: Floats, weight: Floats) -> tuple[Floats, Floats]:
        return self.equations_of(*self.rows(plane), z, weight)

    def equations_of(self, index: Ints, values: Floats, z: Floats, weight: Floats) -> tuple[Floats, Floats]:
        """Return the normal equations of any rows, given as :meth:`rows` returns them, with (n,) or (n, k) values."""
        weighted = values * weight[:, None]
        blocks = weighted[:, :, None] * values[:, None, :]
        columns = [_sums(index, weighted * column[:, None], self.size) for column in z.reshape(len(z), -1).T]
        return self._scatter(index, blocks), np.stack(columns, axis=1).reshape(self.size, *z.shape[1:])

    def _scatter(self, index: Ints, blocks: Floats) -> Floats:
        below = index[:, :, None] - index[:, None, :]
        column = np.broadcast_to(index[:, None, :], below.shape)
        lower = below >= 0
        # Column by column, as LAPACK takes it.
        place = column[lower] * (self.bandwidth + 1) + below[lower]
        band = _sums(place, blocks[lower], (self.bandwidth + 1) * self.size)
        return band.reshape(self.size, self.bandwidth + 1).T

    def sums(self, plane: Rows, z: Rows, weight: Floats) -> CellSums:
        """Return what (n,) heights at (n, 2) places say, summed by cells."""
        return cell_sums(self.knots_u, self.knots_v, self.degree, plane, z, weight)

    def equations(self, sums: CellSums) -> tuple[Floats, Floats]:
        """Return the normal equations of points that were summed on this space."""
        return self._scatter(sums.index, sums.blocks), _sums(sums.index, sums.right, self.size)

    def energy(self, order: int) -> Floats:
        """Return the band of the energy of all derivatives of one order.

        Order 2 is the thin plate, the integral of z_uu^2 + 2 z_uv^2 + z_vv^2; in general the binomial sum
        that does not change when the axes turn.
        """
        terms = [(comb(order, k), self._grams_u[order - k], self._grams_v[k]) for k in range(order + 1)]
        nu, nv = self.shape
        below = range(-self.degree, self.degree + 1)
        along = {a: np.stack([factor * _diagonal(gu, a) for factor, gu, _ in terms]) for a in below if a >= 0}
        across = {b: np.stack([_diagonal(gv, b) for _, _, gv in terms]) for b in below}
        band = np.zeros((self.bandwidth + 1, nu, nv))
        for a, b in product(along, across):
            if a * nv + b >= 0:
                band[a * nv + b] += along[a].T @ across[b]
        return band.reshape(self.bandwidth + 1, self.size)

    @cached_property
    def gram_diagonals(self) -> tuple[Floats, Floats]:
        """Diagonals of the Gram matrices of both directions (see :func:`geofit.splines.bspline.gram_diagonals`)."""
        return bspline.gram_diagonals(self.knots_u, self.degree), bspline.gram_diagonals(self.knots_v, self.degree)

    @cached_property
    def _grams_u(self) -> list[Floats]:
        return [bspline.energy_matrix(self.knots_u, self.degree, m) for m in range(self.degree + 1)]

    @cached_property
    def _grams_v(self) -> list[Floats]:
        return [bspline.energy_matrix(self.knots_v, self.degree, m) for m in range(self.degree + 1)]


class Factor:
    """Banded Cholesky factor of a symmetric positive definite matrix.

    ``ridge`` (size,) is what was added to its diagonal.

    Raises
    ------
    FitError
        If the matrix is not positive definite to working precision: the data and the energy leave a
        combination of control points free.
    """

    def __init__(self, band: Floats) -> None:
        # The diagonal is scaled to one: exact points and far corners differ by ten orders of magnitude.
        diagonal = band[0]
        if not (diagonal > 0).all():
            raise FitError(
                message(
                    "splines.control-points-without-data",
                    "Control points constrained by neither data nor energy: {count}. Use fewer knots, or a "
                    "larger smoothing.",
                    count=int((diagonal <= 0).sum()),
                )
            )
        self._scale = 1 / np.sqrt(diagonal)
        beyond = np.concatenate([self._scale, np.zeros(len(band) - 1)])
        scaled = np.array(band, order="F")
        scaled *= self._scale
        scaled *= sliding_window_view(beyond, band.shape[1])
        added = 0.0
        for ridge in RIDGES:
            scaled[0] += ridge
            added += ridge
            try:
                self._band = cholesky_banded(scaled, lower=True, check_finite=False)
                self.ridge: Floats = added * diagonal
                return
            except LinAlgError:
                continue
        raise FitError(
            message(
                "splines.system-not-positive",
                "The system of the fit is not positive definite: too few points, or points that contradict "
                "each other, leave control points free. Use fewer knots, or a larger smoothing.",
            )
        )

    def solve(self, right: Floats) -> Floats:
        """Solve for one (size,) or several (size, k) right-hand sides."""
        scale = self._scale if right.ndim == 1 else self._scale[:, None]
        solution: Floats = cho_solve_banded((self._band, True), right * scale, check_finite=False) * scale
        return solution

    @property
    def logdet(self) -> float:
        """Logarithm of the determinant of the matrix."""
        return float(2 * np.log(self._band[0]).sum() - 2 * np.log(self._scale).sum())


def band_sum(one: Floats, other: Floats) -> Floats:
    """Return the sum of two symmetric banded matrices of one size, whose bands may differ in width."""
    wide, narrow = (one, other) if len(one) >= len(other) else (other, one)
    # Column by column, as LAPACK takes it.
    result = np.array(wide, order="F")
    result[: len(narrow)] += narrow
    return result


def band_times(band: Floats, x: Floats) -> Floats:
    """Return the symmetric banded matrix times x, (size,) or (size, k)."""
    width = min(len(band), band.shape[1])
    products = [dsbmv(width - 1, 1.0, band[:width], column, lower=1) for column in x.reshape(band.shape[1], -1).T]
    return np.stack(products, axis=1).reshape(x.shape)


def _sums(index: Ints, values: Floats, size: int) -> Floats:
    """Return the (size,) sums of the values that share an index."""
    return np.bincount(index.ravel(), values.ravel(), minlength=size).astype(np.float64, copy=False)


def _diagonal(matrix: Floats, below: int) -> Floats:
    """Return d with d[i] = matrix[i + below, i], zero where that leaves the matrix."""
    diagonal = np.diagonal(matrix, -below)
    pad = np.zeros(abs(below))
    return np.concatenate([diagonal, pad] if below >= 0 else [pad, diagonal])

"""Tensor-product spline spaces: their rows, normal equations, energies, and banded systems.

The coefficients of a space with ``nu x nv`` control points are numbered ``i * nv + j``. Every matrix of a
fit couples only neighbours within one degree in both directions, so it is banded with half width
``degree * nv + degree``; a banded Cholesky factorisation of 4,000 unknowns takes some 0.02 s.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import comb

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.sparse import csr_array

from geofit.errors import FitError
from geofit.splines import bspline

__all__ = ["Factor", "TensorSpace", "band_times", "values_at"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: From this many points on, normal equations are summed by cells instead of by points.
CELLWISE = 20_000
#: Added to a unit diagonal, more where rounding has made a system indefinite: it settles what neither data nor
#: energy hold by the trend, far below any noise.
RIDGES = (1e-13, 1e-12, 1e-10)
_CHUNK = 65_536


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

    def rows(self, plane: Floats) -> tuple[Ints, Floats]:
        """Return the coefficients that act at (n, 2) places and their basis values, both (n, (degree + 1)^2)."""
        iu, bu = bspline.basis(self.knots_u, self.degree, plane[:, 0])
        iv, bv = bspline.basis(self.knots_v, self.degree, plane[:, 1])
        step = np.arange(self.degree + 1)
        index = (iu[:, None] + step)[:, :, None] * self.shape[1] + (iv[:, None] + step)[:, None, :]
        count = (self.degree + 1) ** 2
        return index.reshape(-1, count), (bu[:, :, None] * bv[:, None, :]).reshape(-1, count)

    def matrix(self, plane: Floats) -> csr_array:
        """Return the sparse (n, size) collocation matrix of (n, 2) places."""
        index, values = self.rows(plane)
        pointer = np.arange(len(index) + 1) * index.shape[1]
        return csr_array((values.ravel(), index.ravel(), pointer), shape=(len(index), self.size))

    def normal_equations(self, plane: Floats, z: Floats, weight: Floats) -> tuple[Floats, Floats]:
        """Return the band of X' W X, (bandwidth + 1, size), and X' W z, (size,) or (size, k)."""
        if len(plane) < CELLWISE or z.ndim > 1:
            return self._by_points(plane, z, weight)
        return self._by_cells(plane, z, weight)

    def _by_points(self, plane: Floats, z: Floats, weight: Floats) -> tuple[Floats, Floats]:
        index, values = self.rows(plane)
        weighted = values * weight[:, None]
        blocks = weighted[:, :, None] * values[:, None, :]
        columns = [_sums(index, weighted * column[:, None], self.size) for column in z.reshape(len(z), -1).T]
        return self._scatter(index, blocks), np.stack(columns, axis=1).reshape(self.size, *z.shape[1:])

    def _scatter(self, index: Ints, blocks: Floats) -> Floats:
        below = index[:, :, None] - index[:, None, :]
        column = np.broadcast_to(index[:, None, :], below.shape)
        lower = below >= 0
        place = below[lower] * self.size + column[lower]
        band = _sums(place, blocks[lower], (self.bandwidth + 1) * self.size)
        return band.reshape(self.bandwidth + 1, self.size)

    def _by_cells(self, plane: Floats, z: Floats, weight: Floats) -> tuple[Floats, Floats]:
        """Sum Legendre moments in each cell, then turn them into the normal equations.

        On one cell each product of two basis functions is a polynomial of degree 2p in u and in v, so
        (2p + 1)^2 moments hold all that n points have to say: the state does not grow with n.
        """
        p = self.degree
        cells_u, cells_v = _cells(self.knots_u), _cells(self.knots_v)
        count = (len(cells_u) - 1) * (len(cells_v) - 1)
        moments = np.zeros(((2 * p + 1) ** 2, count))
        right = np.zeros(((p + 1) ** 2, count))
        u, v = plane.T
        for start in range(0, len(plane), _CHUNK):
            part = slice(start, start + _CHUNK)
            cu, pu = _legendre(cells_u, u[part], 2 * p)
            cv, pv = _legendre(cells_v, v[part], 2 * p)
            cell = cu * (len(cells_v) - 1) + cv
            w, wz = weight[part], weight[part] * z[part]
            for k in range(2 * p + 1):
                wk, zk = w * pu[k], wz * pu[k]
                for m in range(2 * p + 1):
                    moments[k * (2 * p + 1) + m] += np.bincount(cell, wk * pv[m], minlength=count)
                    if k <= p and m <= p:
                        right[k * (p + 1) + m] += np.bincount(cell, zk * pv[m], minlength=count)
        lu, lv = _local_polynomials(self.knots_u, p, cells_u), _local_polynomials(self.knots_v, p, cells_v)
        return self._from_moments(moments, right, lu, lv, cells_u, cells_v)

    def _from_moments(
        self, moments: Floats, right: Floats, lu: Floats, lv: Floats, cells_u: Floats, cells_v: Floats
    ) -> tuple[Floats, Floats]:
        p = self.degree
        product = _legendre_products(p)
        qu = np.einsum("cai,cbj,ijk->cabk", lu, lu, product)
        qv = np.einsum("cai,cbj,ijk->cabk", lv, lv, product)
        shape = (len(cells_u) - 1, len(cells_v) - 1)
        grid = moments.reshape(2 * p + 1, 2 * p + 1, *shape)
        half = np.einsum("cabk,klcd->cdabl", qu, grid, optimize=True)
        blocks = np.einsum("cdabl,defl->cdaebf", half, qv, optimize=True)
        sums = np.einsum("cai,dej,ijcd->cdae", lu, lv, right.reshape(p + 1, p + 1, *shape), optimize=True)
        fu = bspline.spans(self.knots_u, p, (cells_u[1:] + cells_u[:-1]) / 2) - p
        fv = bspline.spans(self.knots_v, p, (cells_v[1:] + cells_v[:-1]) / 2) - p
        step = np.arange(p + 1)
        index = ((fu[:, None] + step)[:, None, :, None] * self.shape[1]) + (fv[:, None] + step)[None, :, None, :]
        index = index.reshape(-1, (p + 1) ** 2)
        band = self._scatter(index, blocks.reshape(-1, (p + 1) ** 2, (p + 1) ** 2))
        return band, _sums(index, sums, self.size)

    def energy(self, order: int) -> Floats:
        """Return the band of the energy of all derivatives of one order.

        Order 2 is the thin plate, the integral of z_uu^2 + 2 z_uv^2 + z_vv^2; in general the binomial sum
        that does not change when the axes turn.
        """
        terms = [(comb(order, k), self._grams_u[order - k], self._grams_v[k]) for k in range(order + 1)]
        nu, nv = self.shape
        band = np.zeros((self.bandwidth + 1, nu, nv))
        for a in range(self.degree + 1):
            for b in range(-self.degree, self.degree + 1):
                if a * nv + b >= 0:
                    band[a * nv + b] += sum(
                        factor * np.outer(_diagonal(gu, a), _diagonal(gv, b)) for factor, gu, gv in terms
                    )
        return band.reshape(self.bandwidth + 1, self.size)

    @cached_property
    def _grams_u(self) -> list[Floats]:
        return [bspline.energy_matrix(self.knots_u, self.degree, m) for m in range(self.degree + 1)]

    @cached_property
    def _grams_v(self) -> list[Floats]:
        return [bspline.energy_matrix(self.knots_v, self.degree, m) for m in range(self.degree + 1)]


class Factor:
    """Banded Cholesky factor of a symmetric positive definite matrix.

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
                f"{int((diagonal <= 0).sum())} control points are held by neither data nor energy. "
                "Use fewer knots, or a larger smoothing."
            )
        self._scale = 1 / np.sqrt(diagonal)
        scaled = band * self._scale
        size = band.shape[1]
        for k in range(len(band)):
            scaled[k, : size - k] *= self._scale[k:]
        for ridge in RIDGES:
            scaled[0] += ridge
            try:
                self._band = cholesky_banded(scaled, lower=True, check_finite=False)
                return
            except LinAlgError:
                continue
        raise FitError(
            "The system of the fit is not positive definite: too few points, or points that contradict "
            "each other, leave control points free. Use fewer knots, or a larger smoothing."
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


def values_at(space: TensorSpace, coefficients: Floats, plane: Floats) -> Floats:
    """Return the (n,) values of a spline at (n, 2) places, cell polynomials evaluated in chunks."""
    p = space.degree
    cells_u, cells_v = _cells(space.knots_u), _cells(space.knots_v)
    lu = _local_polynomials(space.knots_u, p, cells_u)
    lv = _local_polynomials(space.knots_v, p, cells_v)
    fu = bspline.spans(space.knots_u, p, (cells_u[1:] + cells_u[:-1]) / 2) - p
    fv = bspline.spans(space.knots_v, p, (cells_v[1:] + cells_v[:-1]) / 2) - p
    step = np.arange(p + 1)
    net = coefficients.reshape(space.shape)[
        (fu[:, None] + step)[:, None, :, None], (fv[:, None] + step)[None, :, None, :]
    ]
    local = np.einsum("cai,cdab,dbj->ijcd", lu, net, lv, optimize=True).reshape((p + 1) ** 2, -1)
    result = np.empty(len(plane))
    for start in range(0, len(plane), _CHUNK):
        part = slice(start, start + _CHUNK)
        cu, pu = _legendre(cells_u, plane[part, 0], p)
        cv, pv = _legendre(cells_v, plane[part, 1], p)
        cell = cu * (len(cells_v) - 1) + cv
        result[part] = sum(
            pu[i] * sum(local[i * (p + 1) + j][cell] * pv[j] for j in range(p + 1)) for i in range(p + 1)
        )
    return result


def band_times(band: Floats, x: Floats) -> Floats:
    """Return the symmetric banded matrix times x, (size,) or (size, k)."""
    size = band.shape[1]
    columns = x.reshape(size, -1)
    result: Floats = band[0][:, None] * columns
    for k in range(1, len(band)):
        below = band[k, : size - k, None]
        if below.any():
            result[k:] += below * columns[: size - k]
            result[: size - k] += below * columns[k:]
    return result.reshape(x.shape)


def _sums(index: Ints, values: Floats, size: int) -> Floats:
    """Return the (size,) sums of the values that share an index."""
    return np.bincount(index.ravel(), values.ravel(), minlength=size).astype(np.float64, copy=False)


def _diagonal(matrix: Floats, below: int) -> Floats:
    """Return d with d[i] = matrix[i + below, i], zero where that leaves the matrix."""
    diagonal = np.diagonal(matrix, -below)
    pad = np.zeros(abs(below))
    return np.concatenate([diagonal, pad] if below >= 0 else [pad, diagonal])


def _cells(knots: Floats) -> Floats:
    return np.unique(knots)


def _legendre(cells: Floats, x: Floats, degree: int) -> tuple[Ints, Floats]:
    cell = np.clip(np.searchsorted(cells, x, side="right") - 1, 0, len(cells) - 2)
    left = cells[cell]
    t = 2 * (x - left) / (cells[cell + 1] - left) - 1
    return cell, np.ascontiguousarray(legendre.legvander(t, degree).T)


def _local_polynomials(knots: Floats, degree: int, cells: Floats) -> Floats:
    """Return (cells, degree + 1, degree + 1): Legendre coefficients of each basis function on each cell."""
    nodes = legendre.leggauss(degree + 1)[0]
    inverse = np.linalg.inv(legendre.legvander(nodes, degree))
    half = np.diff(cells) / 2
    x = cells[:-1, None] + half[:, None] * (1 + nodes)
    _, values = bspline.basis(knots, degree, x.ravel())
    at_nodes = values.reshape(len(half), degree + 1, degree + 1)
    local: Floats = np.einsum("kq,cqa->cak", inverse, at_nodes)
    return local


def _legendre_products(degree: int) -> Floats:
    """Return L with P_i P_j = sum_k L[i, j, k] P_k."""
    size = degree + 1
    table = np.zeros((size, size, 2 * degree + 1))
    unit = np.eye(size)
    for i in range(size):
        for j in range(size):
            product = legendre.legmul(unit[i], unit[j])
            table[i, j, : len(product)] = product
    return table

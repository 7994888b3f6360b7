"""What many points say to a tensor-product spline, summed cell by cell: the state does not grow with the points.

On one cell (a span of u times a span of v) each product of two basis functions is a polynomial of degree 2p in u and
in v, so (2p + 1)^2 moments hold all that its points have to say. Heights count from the mean of their cell: what a
spline leaves of them is then found from the sums as well, without a second look at the points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from geofit.data.long_arrays import Rows, blocks
from geofit.splines import bspline

__all__ = ["CellSums", "cell_sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points that are worked on together: their polynomials stay in the processor's cache.
_CHUNK = 16_384


@dataclass(frozen=True, eq=False)
class CellSums:
    """Sums over the points of each cell, for the b = (p + 1)^2 control points that act there.

    ``index`` (cells, p + 1, p + 1) numbers of these control points; ``blocks`` (cells, b, b) sums of w B_i B_j and
    ``over_mean`` (cells, b) of w B_i (z - mean), with ``mean`` (cells,) the cell's mean height; ``squares`` the sum of
    all w (z - mean)^2.
    """

    index: Ints
    blocks: Floats
    over_mean: Floats
    mean: Floats
    squares: float

    @property
    def right(self) -> Floats:
        """Sums of w B_i z, (cells, b): the basis functions of a cell add up to one."""
        return np.asarray(self.over_mean + self.mean[:, None] * self.blocks.sum(axis=2))

    def misfit(self, coefficients: Floats) -> float:
        """Return the weighted sum of squares that a spline leaves of the heights."""
        local = coefficients[self.index] - self.mean[:, None]
        twice = np.einsum("cij,cj->ci", self.blocks, local) - 2 * self.over_mean
        return max(self.squares + float((local * twice).sum()), 0.0)


def cell_sums(knots_u: Floats, knots_v: Floats, degree: int, plane: Rows, z: Rows, weight: Floats) -> CellSums:
    """Sum (n, 2) places with heights (n,) and weights (n,) by the cells of two knot vectors."""
    cells_u, cells_v = np.unique(knots_u), np.unique(knots_v)
    shape = len(cells_u) - 1, len(cells_v) - 1
    total = _Moments.none(shape[0] * shape[1], degree)
    for parts in blocks(plane, z, weight):
        total.add(_moments(cells_u, cells_v, degree, *parts))
    grid = total.sums.reshape(*shape, *total.sums.shape[1:])
    moments, heights = grid[..., : 2 * degree + 1], grid[..., : degree + 1, 2 * degree + 1 :]
    return _of_basis(knots_u, knots_v, degree, moments, heights, total.mean, total.squares)


@dataclass(eq=False)
class _Moments:
    """Sums of Legendre polynomials over the points of each cell, heights counted from the cell's mean.

    ``sums`` (cells, 2p + 1, 3p + 2): of w P_i(u) P_j(v), then of w P_i(u) P_j(v) (z - mean); ``count``, ``mean``
    (cells,); ``squares`` the sum of all w (z - mean)^2.
    """

    sums: Floats
    count: Floats
    mean: Floats
    squares: float

    @classmethod
    def none(cls, cells: int, p: int) -> _Moments:
        """Return the sums of no points."""
        return cls(np.zeros((cells, 2 * p + 1, 3 * p + 2)), np.zeros(cells), np.zeros(cells), 0.0)

    def add(self, other: _Moments) -> None:
        """Add the sums of other points; both count their heights from the common mean then."""
        count = self.count + other.count
        mean = (self.count * self.mean + other.count * other.mean) / np.maximum(count, 1)
        for part in (self, other):
            part.move(mean)
        self.sums += other.sums
        self.count = count
        self.squares += other.squares

    def move(self, mean: Floats) -> None:
        """Count heights from another mean of each cell."""
        shift = np.where(self.count > 0, self.mean - mean, 0.0)
        heights = self.sums.shape[1]
        weights, first = self.sums[:, 0, 0], self.sums[:, 0, heights]
        self.squares += float((shift * (2 * first + shift * weights)).sum())
        self.sums[:, :, heights:] += shift[:, None, None] * self.sums[:, :, : self.sums.shape[2] - heights]
        self.mean = mean


def _moments(cells_u: Floats, cells_v: Floats, p: int, plane: Floats, z: Floats, weight: Floats) -> _Moments:
    shape = len(cells_u) - 1, len(cells_v) - 1
    found = _Moments.none(shape[0] * shape[1], p)
    if not len(z):
        return found
    cell = bspline.intervals(cells_u, plane[:, 0]) * shape[1] + bspline.intervals(cells_v, plane[:, 1])
    order = np.argsort(cell.astype(np.min_scalar_type(len(found.count))), kind="stable")
    cell, plane, z, weight = cell[order], plane.take(order, axis=0), z[order], weight[order]
    starts = np.flatnonzero(np.diff(cell, prepend=-1))
    found.count[cell[starts]] = np.diff(starts, append=len(z))
    found.mean[cell[starts]] = np.add.reduceat(z, starts) / found.count[cell[starts]]
    z -= found.mean[cell]
    found.squares = float(weight @ (z * z))
    for start in range(0, len(z), _CHUNK):
        part = slice(start, start + _CHUNK)
        first = np.flatnonzero(np.diff(cell[part], prepend=-1))
        ends = np.append(first[1:], len(cell[part]))
        at = cell[part][first]
        left, right = np.empty((2 * p + 1, ends[-1])), np.empty((3 * p + 2, ends[-1]))
        _legendre(cells_u, at // shape[1], ends - first, plane[part, 0], left)
        _legendre(cells_v, at % shape[1], ends - first, plane[part, 1], right[: 2 * p + 1])
        np.multiply(right[: p + 1], z[part], out=right[2 * p + 1 :])
        left *= weight[part]
        for k, low, high in zip(at.tolist(), first.tolist(), ends.tolist(), strict=True):
            found.sums[k] += left[:, low:high] @ right[:, low:high].T
    return found


def _of_basis(
    knots_u: Floats, knots_v: Floats, p: int, moments: Floats, right: Floats, mean: Floats, squares: float
) -> CellSums:
    """Turn sums of Legendre polynomials into sums of basis functions."""
    (fu, lu), (fv, lv) = _local_polynomials(knots_u, p), _local_polynomials(knots_v, p)
    product = _legendre_products(p)
    qu = np.einsum("cai,cbj,ijk->cabk", lu, lu, product)
    qv = np.einsum("cai,cbj,ijk->cabk", lv, lv, product)
    half = np.einsum("cabk,cdkl->cdabl", qu, moments, optimize=True)
    blocks = np.einsum("cdabl,defl->cdaebf", half, qv, optimize=True)
    sums = np.einsum("cai,dej,cdij->cdae", lu, lv, right, optimize=True)
    step, across = np.arange(p + 1), len(knots_v) - p - 1
    index = ((fu[:, None] + step)[:, None, :, None] * across) + (fv[:, None] + step)[None, :, None, :]
    b = (p + 1) ** 2
    return CellSums(index.reshape(-1, b), blocks.reshape(-1, b, b), sums.reshape(-1, b), mean, squares)


def _legendre(cells: Floats, span: Ints, count: Ints, x: Floats, rows: Floats) -> None:
    """Fill rows with the Legendre polynomials at ``count`` places on each span in turn, by Bonnet's recurrence."""
    middle, half = (cells[1:] + cells[:-1]) / 2, np.diff(cells) / 2
    rows[0] = 1.0
    t = np.subtract(x, np.repeat(middle[span], count), out=rows[1])
    t *= np.repeat(1 / half[span], count)
    for k in range(1, len(rows) - 1):
        np.multiply(rows[k], t, out=rows[k + 1])
        rows[k + 1] *= (2 * k + 1) / (k + 1)
        rows[k + 1] -= k / (k + 1) * rows[k - 1]


def _local_polynomials(knots: Floats, degree: int) -> tuple[Ints, Floats]:
    """Return the first basis function of each cell, and Legendre coefficients (cells, p + 1, p + 1) of all there."""
    cells = np.unique(knots)
    nodes = legendre.leggauss(degree + 1)[0]
    inverse = np.linalg.inv(legendre.legvander(nodes, degree))
    half = np.diff(cells) / 2
    x = cells[:-1, None] + half[:, None] * (1 + nodes)
    first, values = bspline.basis(knots, degree, x.ravel())
    at_nodes = values.reshape(len(half), degree + 1, degree + 1)
    return first[:: degree + 1], np.einsum("kq,cqa->cak", inverse, at_nodes)


@cache
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

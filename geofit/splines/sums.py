"""What many points say to a tensor-product spline, summed cell by cell: the state does not grow with the points.

On one cell (a span of u times a span of v) each product of two basis functions is a polynomial of degree 2p in u and
in v, so (2p + 1)^2 moments hold all that its points have to say. Those of small cells add up to those of a larger one:
one look at the points serves several splines whose knots are lines of one mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from geofit.data.long_arrays import Rows, blocks
from geofit.data.threads import alongside
from geofit.splines import bspline

__all__ = ["CellSums", "Moments", "cell_sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points from which on the sums are compiled: loading them costs as much as a few thousand points.
COMPILED = 5_000
#: Points from which on two threads share them.
APART = 100_000
#: Even bins for each line of the mesh, which lead to the cells.
BINS = 4


@dataclass(frozen=True, eq=False)
class CellSums:
    """Sums over the points of each cell, for the b = (p + 1)^2 control points that act there.

    ``index`` (cells, b) numbers of these control points; ``blocks`` (cells, b, b) sums of w B_i B_j, ``right``
    (cells, b) of w B_i z.
    """

    index: Ints
    blocks: Floats
    right: Floats


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums of Legendre polynomials over the points of each cell of a mesh.

    They serve every spline of the degree p whose knots are lines of the mesh.

    Parameters
    ----------
    lines_u, lines_v : (k + 1,), (m + 1,) arrays
        Lines of the mesh, ascending; the outermost cells hold what lies beyond.
    weights : (k, m, 2p + 1, 2p + 1) array
        Sums of w P_i(u) P_j(v).
    heights : (k, m, p + 1, p + 1) array
        Sums of w P_i(u) P_j(v) z.
    """

    lines_u: Floats
    lines_v: Floats
    weights: Floats
    heights: Floats

    @classmethod
    def of(cls, lines_u: Floats, lines_v: Floats, degree: int, plane: Rows, z: Rows, weight: Floats) -> Moments:
        """Sum (n, 2) places with heights (n,) and weights (n,)."""
        sums = np.zeros((len(lines_u) - 1, len(lines_v) - 1, 2 * degree + 1, 3 * degree + 2))
        add = _add_by_cell if len(z) < COMPILED else _add_by_point
        for parts in blocks(plane, z, weight):
            add(sums, lines_u, lines_v, *parts)
        return cls(lines_u, lines_v, sums[..., : 2 * degree + 1], sums[..., : degree + 1, 2 * degree + 1 :])

    @property
    def turned(self) -> Moments:
        """The same sums with u and v exchanged."""
        weights, heights = (sums.transpose(1, 0, 3, 2) for sums in (self.weights, self.heights))
        return Moments(self.lines_v, self.lines_u, weights, heights)

    def serve(self, knots_u: Floats, knots_v: Floats) -> bool:
        """Return whether all knots are lines of the mesh, and all points lie between the outermost ones."""
        count = self.weights[:, :, 0, 0]
        return all(
            np.isin(knots, lines).all() and not held[(lines[1:] <= knots[0]) | (lines[:-1] >= knots[-1])].any()
            for knots, lines, held in ((knots_u, self.lines_u, count), (knots_v, self.lines_v, count.T))
        )

    def on(self, knots_u: Floats, knots_v: Floats) -> CellSums:
        """Return the sums for the splines of two knot vectors, all of which are lines of the mesh."""
        cells_u, cells_v = np.unique(knots_u), np.unique(knots_v)
        weights, heights = self.weights, self.heights
        if len(cells_u) < len(self.lines_u) or len(cells_v) < len(self.lines_v):
            weights, heights = (
                _merged(self.lines_v, cells_v, _merged(self.lines_u, cells_u, sums)) for sums in (weights, heights)
            )
        return _of_basis(knots_u, knots_v, heights.shape[2] - 1, weights, heights)


def cell_sums(knots_u: Floats, knots_v: Floats, degree: int, plane: Rows, z: Rows, weight: Floats) -> CellSums:
    """Sum (n, 2) places with heights (n,) and weights (n,) by the cells of two knot vectors."""
    return Moments.of(np.unique(knots_u), np.unique(knots_v), degree, plane, z, weight).on(knots_u, knots_v)


def _add_by_cell(sums: Floats, lines_u: Floats, lines_v: Floats, plane: Floats, z: Floats, weight: Floats) -> None:
    """Add (n, 2) places with heights and weights to sums (k, m, 2p + 1, 3p + 2), those with the heights last."""
    if not len(z):
        return
    across, count = len(lines_v) - 1, sums.shape[2]
    flat = sums.reshape(-1, *sums.shape[2:])
    cell = bspline.intervals(lines_u, plane[:, 0]) * across + bspline.intervals(lines_v, plane[:, 1])
    order = np.argsort(cell.astype(np.min_scalar_type(len(flat))), kind="stable")
    cell, plane, z, weight = cell[order], plane.take(order, axis=0), z[order], weight[order]
    first = np.flatnonzero(np.diff(cell, prepend=-1))
    ends, at = np.append(first[1:], len(cell)), cell[first]
    left, right = np.empty((count, len(z))), np.empty((sums.shape[3], len(z)))
    _legendre(lines_u, at // across, ends - first, plane[:, 0], left)
    _legendre(lines_v, at % across, ends - first, plane[:, 1], right[:count])
    np.multiply(right[: len(right) - count], z, out=right[count:])
    left *= weight
    for k, low, high in zip(at.tolist(), first.tolist(), ends.tolist(), strict=True):
        flat[k] += left[:, low:high] @ right[:, low:high].T


def _add_by_point(sums: Floats, lines_u: Floats, lines_v: Floats, *points: Floats) -> None:
    """Do the same by compiled loops, which are quicker for very many points."""
    from geofit.splines.sum_loops import add_points

    plane, z, weight = (np.require(rows, np.float64, ("C", "W")) for rows in points)
    bins_u, bins_v = (bspline.bins(lines, BINS * len(lines)) for lines in (lines_u, lines_v))
    mesh = lines_u, lines_v, bins_u, bins_v
    if len(z) < APART:
        add_points(sums, *mesh, plane, z, weight)
        return
    # Two parts, however many processors there are: sums are rounded in the order of their terms.
    half, others = len(z) // 2, np.zeros_like(sums)
    rest = alongside(lambda: add_points(others, *mesh, plane[half:], z[half:], weight[half:]))
    add_points(sums, *mesh, plane[:half], z[:half], weight[:half])
    rest()
    sums += others


def _merged(lines: Floats, cells: Floats, sums: Floats) -> Floats:
    """Return sums (k, m, i, j) over the cells along u of a mesh as those over longer cells: (m, cells, j, i).

    Cells of the mesh that lie beyond are left out. Called once more, with the lines along v, it brings both axes back
    in their order.
    """
    within = slice(*np.searchsorted(lines, (cells[0], cells[-1])))
    lines, sums, count = lines[within.start : within.stop + 1], sums[within], sums.shape[2]
    own = np.searchsorted(cells, (lines[1:] + lines[:-1]) / 2) - 1
    nodes = legendre.leggauss(count)[0]
    at = (lines[:-1, None] + np.diff(lines)[:, None] * (1 + nodes) / 2 - cells[own, None]) / np.diff(cells)[own, None]
    # The polynomials of the longer cell in those of the shorter one.
    table = np.linalg.solve(legendre.legvander(nodes, count - 1), legendre.legvander(2 * at - 1, count - 1))
    flat = np.matmul(table.swapaxes(1, 2), sums.transpose(0, 2, 1, 3).reshape(len(own), count, -1))
    whole = np.add.reduceat(flat, np.searchsorted(own, np.arange(len(cells) - 1)), axis=0)
    return np.asarray(whole.reshape(len(cells) - 1, count, sums.shape[1], sums.shape[3]).transpose(2, 0, 3, 1))


def _of_basis(knots_u: Floats, knots_v: Floats, p: int, moments: Floats, heights: Floats) -> CellSums:
    """Turn sums of Legendre polynomials into sums of basis functions."""
    (fu, lu), (fv, lv) = _local_polynomials(knots_u, p), _local_polynomials(knots_v, p)
    product = _legendre_products(p)
    qu = np.einsum("cai,cbj,ijk->cabk", lu, lu, product)
    qv = np.einsum("cai,cbj,ijk->cabk", lv, lv, product)
    half = np.einsum("cabk,cdkl->cdabl", qu, moments, optimize=True)
    blocks = np.einsum("cdabl,defl->cdaebf", half, qv, optimize=True)
    sums = np.einsum("cai,dej,cdij->cdae", lu, lv, heights, optimize=True)
    step, across = np.arange(p + 1), len(knots_v) - p - 1
    index = ((fu[:, None] + step)[:, None, :, None] * across) + (fv[:, None] + step)[None, :, None, :]
    b = (p + 1) ** 2
    return CellSums(index.reshape(-1, b), blocks.reshape(-1, b, b), sums.reshape(-1, b))


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

"""Solution of the Laplace equation on pore voxels: conjugate gradients with two levels of preconditioning.

An incomplete Cholesky factor takes what varies from voxel to voxel off the error. What is left is nearly constant in
the connected pieces that blocks of voxels cut out of the pores; the equations of these pieces, summed up from those of
their voxels, are few and are solved directly (additive coarse correction: Nicolaides 1987).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.pores.laplace_loops import apply, combine, incomplete_cholesky, precondition, step_along, sum_up, to_voxels

__all__ = ["conjugate_gradients", "pieces_in_blocks"]

#: Steps between two looks at the error.
_LOOK = 25
#: Edge of the blocks, voxels.
_BLOCK = 6

Floats = NDArray[np.float64]
Links = tuple[NDArray[np.int32], Floats]


def conjugate_gradients(
    links: Links, diagonal: Floats, source: Floats, piece: NDArray[np.int32], start: Floats, tolerance: float, most: int
) -> tuple[Floats, float, int]:
    """Return the pressures, the flow between the faces, and the steps that it took.

    The flow is the energy of the pressures: its error is of second order in theirs, the square of their error in the
    norm of the matrix. What the last steps took off that bounds what is left (Hestenes & Stiefel 1952). A residual
    says less: a rock lets a thousandth of its faces' conductance through.

    Parameters
    ----------
    links, diagonal : arrays
        The matrix, from :func:`geofit.pores.laplace_loops.assemble`.
    source : ndarray, shape (n,)
        Conductances to the face of pressure 1.
    piece : ndarray of int, shape (n,)
        The piece of each voxel, from :func:`pieces_in_blocks`.
    start : ndarray, shape (n,)
        Pressures to begin with.
    tolerance : float
        Largest relative error of the flow.

    Returns
    -------
    pressure : ndarray, shape (n,)
    flow : float
    steps : int
        -1 if ``most`` steps were not enough.
    """
    neighbour, conductance = links
    pivot = incomplete_cholesky(neighbour, conductance, diagonal)
    solve = _coarse(links, diagonal, piece)
    sums = np.zeros(int(piece.max()) + 1)
    z, image = np.empty(len(diagonal)), np.empty(len(diagonal))

    def improve() -> float:
        precondition(neighbour, conductance, pivot, residual, z)
        sum_up(piece, residual, sums)
        to_voxels(piece, solve(sums), z)
        return float((residual * z).sum())

    x, residual = start.copy(), source.copy()
    apply(neighbour, conductance, diagonal, x, residual, -1.0)
    product = improve()
    direction = z.copy()
    gained, rounding = 0.0, 1e-24 * float(source.sum())
    for step in range(most):
        if step % _LOOK == 0 or product <= rounding:
            flow = float((source * (1.0 - x)).sum() - (x * residual).sum())
            if product <= rounding or (step and gained <= tolerance * flow):
                return x, flow, step
            gained = 0.0
        image[:] = 0.0
        apply(neighbour, conductance, diagonal, direction, image, 1.0)
        alpha = product / float((direction * image).sum())
        gained += alpha * product
        step_along(x, residual, direction, image, alpha)
        before, product = product, improve()
        combine(direction, z, product / before)
    return x, 0.0, -1


def pieces_in_blocks(
    neighbour: NDArray[np.int32], order: NDArray[np.int64], shape: tuple[int, ...]
) -> NDArray[np.int32]:
    """Return the piece (n,) of each voxel: voxels of one block that links within the block connect."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(order)
    cells = [-(-size // _BLOCK) for size in shape]
    block = np.ravel_multi_index([index // _BLOCK for index in np.unravel_index(order, shape)], cells)
    row, side = np.nonzero(neighbour >= 0)
    other = neighbour[row, side]
    same = block[row] == block[other]
    row, other = row[same].astype(np.int32), other[same]
    links = coo_array((np.ones(len(row), np.int8), (row, other)), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int32)


def _coarse(links: Links, diagonal: Floats, piece: NDArray[np.int32]) -> Callable[[Floats], Floats]:
    """Return what solves the equations of the pieces: P^T A P, where P spreads a piece's pressure over its voxels."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    neighbour, conductance = links
    count = int(piece.max()) + 1
    row, side = np.nonzero(neighbour >= 0)
    one, other, g = piece[row], piece[neighbour[row, side]], conductance[row, side]
    own = np.arange(count)
    matrix = coo_array(
        (
            np.concatenate([np.bincount(piece, diagonal, count), -g, -g]),
            (np.concatenate([own, one, other]), np.concatenate([own, other, one])),
        ),
        shape=(count, count),
    ).tocsc()
    factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    solve: Callable[[Floats], Floats] = factor.solve
    return solve

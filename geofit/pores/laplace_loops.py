"""Compiled assembly and solution of the Laplace equation on pore voxels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["assemble", "conjugate_gradients"]

#: Steps between two looks at the error.
_LOOK = 25


@njit(cache=True)
def assemble(
    weights: NDArray[np.float64],
    number: NDArray[np.int32],
    order: NDArray[np.int64],
    axis: int,
    edges: NDArray[np.float64],
) -> tuple[tuple[NDArray[np.int32], NDArray[np.float64]], NDArray[np.float64], NDArray[np.float64]]:
    """Return the conductances to the three lower neighbours of each voxel, the diagonal, and those to both faces."""
    _, n1, n2 = weights.shape
    count = len(order)
    neighbour = np.full((count, 3), -1, np.int32)
    conductance = np.zeros((count, 3))
    diagonal = np.zeros(count)
    source = np.zeros((2, count))
    area = edges.prod() / edges**2
    for row in range(count):
        here = order[row]
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        own = weights[i, j, k]
        for d in range(3):
            a, b, c = i - (d == 0), j - (d == 1), k - (d == 2)
            place, last = (i, j, k)[d], weights.shape[d] - 1
            if d == axis and place == 0:
                source[0, row] = 2.0 * own * area[d]
                diagonal[row] += source[0, row]
            if d == axis and place == last:
                source[1, row] = 2.0 * own * area[d]
                diagonal[row] += source[1, row]
            if place == 0 or number[a, b, c] < 0:
                continue
            other = number[a, b, c]
            there = weights[a, b, c]
            link = area[d] * 2.0 * own * there / (own + there)
            neighbour[row, d], conductance[row, d] = other, link
            diagonal[row] += link
            diagonal[other] += link
    return (neighbour, conductance), diagonal, source


@njit(cache=True)
def conjugate_gradients(
    links: tuple[NDArray[np.int32], NDArray[np.float64]],
    diagonal: NDArray[np.float64],
    source: NDArray[np.float64],
    start: NDArray[np.float64],
    tolerance: float,
    most: int,
) -> tuple[float, int]:
    """Solve with an incomplete Cholesky factor without fill as preconditioner.

    The flow is the energy of the pressures: its error is of second order in theirs, the square of their error in the
    norm of the matrix. What the last steps took off that bounds what is left (Hestenes & Stiefel 1952). A residual
    says less: a rock lets a thousandth of its faces' conductance through.

    Parameters
    ----------
    source : ndarray, shape (n,)
        Conductances to the face of pressure 1.
    tolerance : float
        Largest relative error of the flow.

    Returns
    -------
    flow : float
    steps : int
        -1 if ``most`` steps were not enough.
    """
    neighbour, conductance = links
    n = len(diagonal)
    pivot = np.empty(n)
    for row in range(n):
        value = diagonal[row]
        for d in range(3):
            other = neighbour[row, d]
            if other >= 0:
                value -= conductance[row, d] ** 2 / pivot[other]
        pivot[row] = value
    x = start.copy()
    residual = source.copy()
    _apply(neighbour, conductance, diagonal, x, residual, -1.0)
    z = np.empty(n)
    _precondition(neighbour, conductance, pivot, residual, z)
    direction = z.copy()
    image = np.empty(n)
    product = (residual * z).sum()
    gained, rounding = 0.0, 1e-24 * source.sum()
    for step in range(most):
        if step % _LOOK == 0 or product <= rounding:
            flow = (source * (1.0 - x)).sum() - (x * residual).sum()
            if product <= rounding or (step and gained <= tolerance * flow):
                return flow, step
            gained = 0.0
        image[:] = 0.0
        _apply(neighbour, conductance, diagonal, direction, image, 1.0)
        alpha = product / (direction * image).sum()
        gained += alpha * product
        for row in range(n):
            x[row] += alpha * direction[row]
            residual[row] -= alpha * image[row]
        _precondition(neighbour, conductance, pivot, residual, z)
        new = (residual * z).sum()
        beta = new / product
        product = new
        for row in range(n):
            direction[row] = z[row] + beta * direction[row]
    return 0.0, -1


@njit(cache=True)
def _apply(
    neighbour: NDArray[np.int32],
    conductance: NDArray[np.float64],
    diagonal: NDArray[np.float64],
    x: NDArray[np.float64],
    out: NDArray[np.float64],
    sign: float,
) -> None:
    """Add ``sign`` times the matrix times x to ``out``."""
    for row in range(len(x)):
        value = diagonal[row] * x[row]
        for d in range(3):
            other = neighbour[row, d]
            if other >= 0:
                g = conductance[row, d]
                value -= g * x[other]
                out[other] -= sign * g * x[row]
        out[row] += sign * value


@njit(cache=True)
def _precondition(
    neighbour: NDArray[np.int32],
    conductance: NDArray[np.float64],
    pivot: NDArray[np.float64],
    residual: NDArray[np.float64],
    z: NDArray[np.float64],
) -> None:
    n = len(pivot)
    for row in range(n):
        value = residual[row]
        for d in range(3):
            other = neighbour[row, d]
            if other >= 0:
                value += conductance[row, d] * z[other]
        z[row] = value / pivot[row]
    for row in range(n - 1, -1, -1):
        for d in range(3):
            other = neighbour[row, d]
            if other >= 0:
                z[other] += conductance[row, d] * z[row] / pivot[other]

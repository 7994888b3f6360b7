"""Compiled loops over pore voxels: assembly of the Laplace equation, and the steps of its solution."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["apply", "assemble", "combine", "incomplete_cholesky", "precondition", "step_along", "sum_up", "to_voxels"]


@njit(cache=True)
def assemble(
    weights: NDArray[np.float64],
    number: NDArray[np.int32],
    order: NDArray[np.int64],
    axis: int,
    edges: NDArray[np.float64],
) -> tuple[tuple[NDArray[np.int32], NDArray[np.float64]], NDArray[np.float64], NDArray[np.float64]]:
    """Return the conductances to the three lower neighbours of each voxel, the diagonal, and those to both faces."""
    _, n1, n2 = number.shape
    count = len(order)
    neighbour = np.full((count, 3), -1, np.int32)
    conductance = np.zeros((count, 3))
    diagonal = np.zeros(count)
    source = np.zeros((2, count))
    area = edges.prod() / edges**2
    for row in range(count):
        here = order[row]
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        own = weights[row]
        for d in range(3):
            a, b, c = i - (d == 0), j - (d == 1), k - (d == 2)
            place, last = (i, j, k)[d], number.shape[d] - 1
            if d == axis and place == 0:
                source[0, row] = 2.0 * own * area[d]
                diagonal[row] += source[0, row]
            if d == axis and place == last:
                source[1, row] = 2.0 * own * area[d]
                diagonal[row] += source[1, row]
            if place == 0 or number[a, b, c] < 0:
                continue
            other = number[a, b, c]
            there = weights[other]
            link = area[d] * 2.0 * own * there / (own + there)
            neighbour[row, d], conductance[row, d] = other, link
            diagonal[row] += link
            diagonal[other] += link
    return (neighbour, conductance), diagonal, source


@njit(cache=True)
def incomplete_cholesky(
    neighbour: NDArray[np.int32], conductance: NDArray[np.float64], diagonal: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the pivots of the incomplete Cholesky factor without fill."""
    pivot = np.empty(len(diagonal))
    for row in range(len(diagonal)):
        value = diagonal[row]
        for d in range(3):
            other = neighbour[row, d]
            if other >= 0:
                value -= conductance[row, d] ** 2 / pivot[other]
        pivot[row] = value
    return pivot


@njit(cache=True)
def step_along(
    x: NDArray[np.float64],
    residual: NDArray[np.float64],
    direction: NDArray[np.float64],
    image: NDArray[np.float64],
    alpha: float,
) -> None:
    """Move x along a direction, and the residual along its image."""
    for row in range(len(x)):
        x[row] += alpha * direction[row]
        residual[row] -= alpha * image[row]


@njit(cache=True)
def combine(direction: NDArray[np.float64], z: NDArray[np.float64], beta: float) -> None:
    """Put z + beta * direction in the place of the direction."""
    for row in range(len(z)):
        direction[row] = z[row] + beta * direction[row]


@njit(cache=True)
def sum_up(piece: NDArray[np.int32], values: NDArray[np.float64], sums: NDArray[np.float64]) -> None:
    """Sum values over each piece."""
    sums[:] = 0.0
    for row in range(len(values)):
        sums[piece[row]] += values[row]


@njit(cache=True)
def to_voxels(piece: NDArray[np.int32], of_piece: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Add the value of its piece to each row."""
    for row in range(len(out)):
        out[row] += of_piece[piece[row]]


@njit(cache=True)
def apply(
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
def precondition(
    neighbour: NDArray[np.int32],
    conductance: NDArray[np.float64],
    pivot: NDArray[np.float64],
    residual: NDArray[np.float64],
    z: NDArray[np.float64],
) -> None:
    """Solve with the incomplete factor for a residual; the result is z."""
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

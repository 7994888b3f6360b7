r"""Flow through a duct of any section: Poisson's equation on the voxels of the section.

The conductance c of a straight duct, with Q = c / mu * pressure gradient, is the integral of u over the section, where
-laplace u = 1 and u = 0 at the wall. No formula for circles, triangles and squares is needed.

Walls lie half a voxel from the last cell's centre. With u = 0 there, the derivative at the wall is taken through the
two nearest cells, (9 u1 - u2) / 3; the mean of u over a cell is its value in the middle plus 1/24 of its second
differences. Both are exact for a slit of two voxels or more; ends of one voxel take 4 u, which makes a slit of one
voxel exact too. A section whose conductance is just below that of the ellipse with its area and second moments is taken
for that ellipse.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["OUTSIDE", "PORE", "ROCK", "duct_conductance"]

#: Cells of a section. What lies outside the sample is not a wall: the flow is mirrored there.
ROCK, PORE, OUTSIDE = 0, 1, 2

_TOLERANCE = 1e-4
#: The staircase of voxels costs a round section up to this share of the ellipse's formula; a square reaches the other.
_ROUND, _SQUARE = 0.94, 0.925


@njit(cache=True)
def duct_conductance(cell: NDArray[np.uint8], h0: float, h1: float) -> float:
    """Return the conductance of a section in units of length^4.

    Parameters
    ----------
    cell : ndarray of uint8, shape (n0, n1)
        ``ROCK``, ``PORE`` or ``OUTSIDE``; the outermost rows and columns must not be pore.
    h0, h1 : float
        Edge lengths of a cell.

    Returns
    -------
    float
        Infinite if the section has no wall.
    """
    n0, n1 = cell.shape
    u = np.zeros((n0, n1))
    diagonal = np.zeros((n0, n1))
    across = np.zeros((n0, n1))
    pull = np.zeros((n0, n1, 4))
    wall = False
    steps = ((1, 0), (-1, 0), (0, 1), (0, -1))
    count = 0
    for i in range(1, n0 - 1):
        for j in range(1, n1 - 1):
            if cell[i, j] != PORE:
                continue
            count += 1
            for s in range(4):
                if s == 2:
                    across[i, j] = diagonal[i, j]
                a, b = steps[s]
                weight = 1.0 / (h0 * h0) if s < 2 else 1.0 / (h1 * h1)
                there, back = cell[i + a, j + b], cell[i - a, j - b]
                if there == PORE:
                    diagonal[i, j] += weight
                    pull[i, j, s] += weight
                elif there == ROCK:
                    wall = True
                    if back == PORE:
                        diagonal[i, j] += 3.0 * weight
                        pull[i, j, s ^ 1] += weight / 3.0
                    else:
                        diagonal[i, j] += (4.0 if back == ROCK else 2.0) * weight
    if count == 0:
        return 0.0
    if not wall:
        return np.inf
    if count == 1 and cell[:, :].max() == PORE:
        # A single voxel: the series of a rectangle, which the difference formula misses by 40 %.
        return _rectangle(h0, h1)
    # Over-relaxation by the narrow width of the section, which rules how fast errors fade; a mirror doubles it.
    narrow = max(_narrow_width(cell, h0, h1), 2) * (2 if cell.max() == OUTSIDE else 1)
    omega = 2.0 / (1.0 + np.sin(np.pi / (narrow + 1.0)))
    for _ in range(20 * narrow + 200):
        change, largest = 0.0, 0.0
        for i in range(1, n0 - 1):
            for j in range(1, n1 - 1):
                if cell[i, j] != PORE:
                    continue
                total = 1.0
                if pull[i, j, 0] != 0.0:
                    total += pull[i, j, 0] * u[i + 1, j]
                if pull[i, j, 1] != 0.0:
                    total += pull[i, j, 1] * u[i - 1, j]
                if pull[i, j, 2] != 0.0:
                    total += pull[i, j, 2] * u[i, j + 1]
                if pull[i, j, 3] != 0.0:
                    total += pull[i, j, 3] * u[i, j - 1]
                step = omega * (total / diagonal[i, j] - u[i, j])
                u[i, j] += step
                change, largest = max(change, abs(step)), max(largest, u[i, j])
        if change < _TOLERANCE * largest / narrow:
            break
    total = 0.0
    for i in range(1, n0 - 1):
        for j in range(1, n1 - 1):
            if cell[i, j] == PORE:
                bend = pull[i, j, 0] * u[i + 1, j] + pull[i, j, 1] * u[i - 1, j] - across[i, j] * u[i, j]
                total += u[i, j] + (bend * h0 * h0 - (1.0 + bend) * h1 * h1) / 24.0
    computed = total * h0 * h1
    if not _may_be_round(cell, count):
        return computed
    ellipse = _ellipse(cell, h0, h1)
    if computed >= ellipse:
        return computed
    # Gradually, so that no rounding decides.
    return computed + (ellipse - computed) * min(max((computed / ellipse - _SQUARE) / (_ROUND - _SQUARE), 0.0), 1.0)


@njit(cache=True)
def _may_be_round(cell: NDArray[np.uint8], count: int) -> bool:
    """Return False for rectangles, which have no staircase, and for sections cut by a face of the sample."""
    n0, n1 = cell.shape
    low0, high0, low1, high1 = n0, -1, n1, -1
    for i in range(n0):
        for j in range(n1):
            if cell[i, j] == OUTSIDE:
                return False
            if cell[i, j] == PORE:
                low0, high0, low1, high1 = min(low0, i), max(high0, i), min(low1, j), max(high1, j)
    return bool((high0 - low0 + 1) * (high1 - low1 + 1) > count)


@njit(cache=True)
def _ellipse(cell: NDArray[np.uint8], h0: float, h1: float) -> float:
    """Return Saint-Venant's A^4 / (16 pi^2 J), J the polar second moment: exact for every ellipse."""
    n0, n1 = cell.shape
    count, s0, s1, s00, s11 = 0, 0.0, 0.0, 0.0, 0.0
    for i in range(n0):
        for j in range(n1):
            if cell[i, j] == PORE:
                count += 1
                s0, s1, s00, s11 = s0 + i, s1 + j, s00 + i * i, s11 + j * j
    area = count * h0 * h1
    polar = h0 * h0 * (s00 - s0 * s0 / count) + h1 * h1 * (s11 - s1 * s1 / count)
    polar = h0 * h1 * (polar + count * (h0 * h0 + h1 * h1) / 12.0)
    return area**4 / (16.0 * np.pi**2 * polar)


@njit(cache=True)
def _narrow_width(cell: NDArray[np.uint8], h0: float, h1: float) -> int:
    """Return the longest run of pore along the axis in which the section is narrower, in cells.

    Where they are not square, it is the run in square cells in which errors fade as fast.
    """
    n0, n1 = cell.shape
    widest0, widest1 = 0, 0
    for i in range(n0):
        run = 0
        for j in range(n1):
            run = run + 1 if cell[i, j] == PORE else 0
            widest1 = max(widest1, run)
    for j in range(n1):
        run = 0
        for i in range(n0):
            run = run + 1 if cell[i, j] == PORE else 0
            widest0 = max(widest0, run)
    return int(np.ceil(min(widest0 * h0, widest1 * h1) * np.sqrt((h0**-2 + h1**-2) / 2.0) - 1e-6))


@njit(cache=True)
def _rectangle(a: float, b: float) -> float:
    """Conductance of a rectangle by its Fourier series."""
    long, short = max(a, b), min(a, b)
    total = 0.0
    for n in range(1, 40, 2):
        total += np.tanh(n * np.pi * long / (2.0 * short)) / n**5
    return long * short**3 / 12.0 * (1.0 - 192.0 * short / (np.pi**5 * long) * total)

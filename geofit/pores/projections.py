"""Windows as seen along the axes: the sections through which straight ducts are solved.

A window is a staircase of voxel faces. Seen along an axis it is a plane section, squeezed if the window lies at a
slant. Each axis gives an estimate of its own, with the share of the window's vector along it, so that a rotated volume
has the same throats. An axis more than 60 degrees off the window's normal sees too little of it.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.duct import OUTSIDE, PORE, ROCK, duct_conductance
from geofit.pores.packed import PackedSpace, slot
from geofit.pores.windows import Windows

__all__ = ["section_ducts"]

#: Least square of the cosine between an axis and the normal of a window that it may see.
_SEEN = 0.25
#: The four cells beside a cell.
_BESIDE = ((1, 0), (-1, 0), (0, 1), (0, -1))


@njit(cache=True)
def section_ducts(
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    windows: Windows,
    vector: NDArray[np.float64],
    edges: NDArray[np.float64],
    in_faces: bool,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what a straight duct with the section of each window conducts, and the length of its wall.

    Parameters
    ----------
    space : PackedSpace
        The pore space.
    pore_of : ndarray of int32
        Number of the pore of each pore voxel, counted from 1.
    windows : Windows
    vector : ndarray of float, shape (n, 3)
        Sum of the face vectors of each window.
    edges : ndarray of float, shape (3,)
        Edge lengths of a voxel, in units of the shortest one.
    in_faces : bool
        Whether the windows lie in the sample's faces or between pores.

    Returns
    -------
    conductance : ndarray of float, shape (n,)
        In units of length^4.
    perimeter : ndarray of float, shape (n,)
    """
    count = len(windows.start) - 1
    conductance, perimeter = np.zeros(count), np.zeros(count)
    for window in range(count):
        own = slice(windows.start[window], windows.start[window + 1])
        voxel, axis, sign = windows.voxel[own], windows.axis[own], windows.sign[own]
        first = windows.first[window] + 1
        second = first if in_faces else windows.second[window] + 1
        area = np.sqrt((vector[window] ** 2).sum())
        weight = _weights(vector[window], axis)
        for normal in range(3):
            if weight[normal] == 0.0:
                continue
            u, v = (normal + 1) % 3, (normal + 2) % 3
            cell, low = _projected(space.shape, voxel, axis, sign, normal)
            _open_to_third_pores(cell, space, pore_of, voxel, axis, low, normal, first, second, in_faces)
            flow = duct_conductance(cell, edges[u], edges[v])
            if np.isinf(flow):
                # No rock bounds the section: the sample's own faces are the only walls there are.
                flow = duct_conductance(np.where(cell == PORE, PORE, ROCK).astype(np.uint8), edges[u], edges[v])
            projected = (cell == PORE).sum() * edges[u] * edges[v]
            tilt = min(max(area / projected, 1.0), np.sqrt(3.0)) if projected > 0 else 1.0
            # A circle seen at a slant is an ellipse with one shorter axis.
            conductance[window] += weight[normal] * flow * tilt * (1.0 + tilt**2) / 2.0
            perimeter[window] += weight[normal] * _perimeter(cell, edges[u], edges[v]) * (1.0 + tilt) / 2.0
    return conductance, perimeter


@njit(cache=True)
def _weights(vector: NDArray[np.float64], axis: NDArray[np.int8]) -> NDArray[np.float64]:
    """Return how much the view along each axis counts; a window that closes on itself goes by its faces."""
    weight = vector**2
    if weight.sum() == 0.0:
        for a in range(3):
            weight[a] = (axis == a).sum() ** 2
    seen = np.where(weight < _SEEN * weight.sum(), 0.0, weight)
    shares: NDArray[np.float64] = seen / seen.sum()
    return shares


@njit(cache=True)
def _projected(
    shape: NDArray[np.int64], voxel: NDArray[np.int64], axis: NDArray[np.int8], sign: NDArray[np.int8], normal: int
) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """Return a window as seen along an axis, with a rim of one cell, and the low corner of its voxels."""
    u, v = (normal + 1) % 3, (normal + 2) % 3
    low, high = np.full(3, 1 << 40), np.full(3, -1)
    for row in range(len(voxel)):
        if axis[row] == normal:
            place = _place(voxel[row], shape)
            for a in range(3):
                low[a], high[a] = min(low[a], place[a]), max(high[a], place[a])
    winding = np.zeros((high[u] - low[u] + 3, high[v] - low[v] + 3), np.int64)
    for row in range(len(voxel)):
        if axis[row] == normal:
            place = _place(voxel[row], shape)
            winding[place[u] - low[u] + 1, place[v] - low[v] + 1] += sign[row]
    cell = np.zeros(winding.shape, np.uint8)
    for i in range(winding.shape[0]):
        for j in range(winding.shape[1]):
            a, b = low[u] + i - 1, low[v] + j - 1
            if a < 0 or b < 0 or a >= shape[u] or b >= shape[v]:
                cell[i, j] = OUTSIDE
            elif winding[i, j] != 0:
                cell[i, j] = PORE
    return cell, low


@njit(cache=True)
def _open_to_third_pores(
    cell: NDArray[np.uint8],
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    voxel: NDArray[np.int64],
    axis: NDArray[np.int8],
    low: NDArray[np.int64],
    normal: int,
    first: int,
    second: int,
    in_faces: bool,
) -> None:
    """Mark as OUTSIDE the rim without rock: where three pores meet, a window ends at the window of the third."""
    shape = space.shape
    steps = (shape[1] * shape[2], shape[2], 1)
    u, v = (normal + 1) % 3, (normal + 2) % 3
    opened = False
    for row in range(len(voxel)):
        if axis[row] != normal:
            continue
        place = _place(voxel[row], shape)
        i, j = place[u] - low[u] + 1, place[v] - low[v] + 1
        for a, b in _BESIDE:
            if cell[i, j] != PORE or cell[i + a, j + b] != ROCK:
                continue
            one = slot(space, voxel[row] + a * steps[u] + b * steps[v])
            other = one if in_faces else slot(space, voxel[row] + a * steps[u] + b * steps[v] + steps[normal])
            if one < 0 or other < 0:
                continue
            for pore in (pore_of[one], pore_of[other]):
                if pore != first and pore != second:
                    cell[i + a, j + b] = OUTSIDE
                    opened = True
    if opened:
        _close_pieces_without_wall(cell)


@njit(cache=True)
def _close_pieces_without_wall(cell: NDArray[np.uint8]) -> None:
    """Wall in the pieces of a section that no rock touches: their flow would have no bound."""
    walled = np.zeros(cell.shape, np.bool_)
    changed, some = True, False
    while changed:
        changed = False
        for i in range(1, cell.shape[0] - 1):
            for j in range(1, cell.shape[1] - 1):
                if cell[i, j] != PORE or walled[i, j]:
                    continue
                for a, b in _BESIDE:
                    if cell[i + a, j + b] == ROCK or walled[i + a, j + b]:
                        walled[i, j] = changed = some = True
    if not some:
        return
    for i in range(1, cell.shape[0] - 1):
        for j in range(1, cell.shape[1] - 1):
            if cell[i, j] == PORE and not walled[i, j]:
                for a, b in _BESIDE:
                    if cell[i + a, j + b] == OUTSIDE:
                        cell[i + a, j + b] = ROCK


@njit(cache=True)
def _place(voxel: int, shape: NDArray[np.int64]) -> tuple[int, int, int]:
    return voxel // (shape[1] * shape[2]), voxel // shape[2] % shape[1], voxel % shape[2]


@njit(cache=True)
def _perimeter(cell: NDArray[np.uint8], h0: float, h1: float) -> float:
    """Return the length of the wall by Crofton's formula: crossings of rows, columns and both diagonals."""
    n0, n1 = cell.shape
    along0, along1, diagonal = 0, 0, 0
    for i in range(n0):
        for j in range(n1):
            if cell[i, j] != PORE:
                continue
            along0 += (cell[i - 1, j] == ROCK) + (cell[i + 1, j] == ROCK)
            along1 += (cell[i, j - 1] == ROCK) + (cell[i, j + 1] == ROCK)
            diagonal += (cell[i - 1, j - 1] == ROCK) + (cell[i + 1, j + 1] == ROCK)
            diagonal += (cell[i - 1, j + 1] == ROCK) + (cell[i + 1, j - 1] == ROCK)
    slant = np.hypot(h0, h1)
    # Each direction represents the angles nearer to it than to its neighbours.
    theta = np.arctan2(h1, h0)
    return float(
        0.5 * (along0 * h1 * theta + along1 * h0 * (np.pi / 2 - theta) + diagonal * h0 * h1 / slant * (np.pi / 4))
    )

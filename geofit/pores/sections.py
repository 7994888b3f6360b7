"""Sections of windows: area, width, middle, and the flow that a straight duct of this section would carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.duct import OUTSIDE, PORE, ROCK, duct_conductance
from geofit.pores.packed import PackedSpace
from geofit.pores.spots import widest_balls
from geofit.pores.windows import Windows

__all__ = ["PoreSections", "measure_sections"]


class PoreSections(NamedTuple):
    """One row a window; lengths in units of the shortest voxel edge, ``middle`` in indices."""

    radius: NDArray[np.float64]
    inscribed: NDArray[np.float64]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    middle: NDArray[np.float64]
    conductance: NDArray[np.float64]


def measure_sections(
    windows: Windows, space: PackedSpace, edges: NDArray[np.float64], radius_at: NDArray[np.float64], *, in_faces: bool
) -> PoreSections:
    """Return the sections of windows.

    Parameters
    ----------
    windows : Windows
    space : PackedSpace
        The pore space.
    edges : ndarray of float, shape (3,)
        Edge lengths of a voxel, in units of the shortest one.
    radius_at : ndarray of float
        Radius of a ball of each level.
    in_faces : bool
        Whether the windows lie in the sample's faces or between pores.
    """
    count = len(windows.first)
    if count == 0:
        empty = np.zeros(0)
        return PoreSections(empty, empty, empty, empty, np.zeros((0, 3)), empty)
    begin = windows.start[:-1]
    face_area = edges.prod() / edges
    radius = radius_at[np.maximum.reduceat(windows.level, begin)]
    vector = np.zeros((count, 3))
    for axis in range(3):
        turned = np.where(windows.axis == axis, windows.sign, 0) * face_area[axis]
        vector[:, axis] = np.add.reduceat(turned, begin)
    # A window that closes on itself has no border curve, and so no vector; it is at least as wide as its ball.
    area = np.maximum(np.linalg.norm(vector, axis=1), np.maximum(np.pi * radius**2, face_area.min()))
    index = np.stack(np.unravel_index(windows.voxel, tuple(space.shape.tolist())), axis=1).astype(np.float64)
    index[np.arange(len(index)), windows.axis] += np.where(in_faces & (windows.sign < 0), -0.5, 0.5)
    faces = np.diff(windows.start)
    middle = np.stack([np.add.reduceat(index[:, axis], begin) for axis in range(3)], axis=1) / faces[:, None]
    conductance, perimeter = _ducts(
        windows.start, windows.voxel, windows.axis, windows.sign, vector, edges, space.shape
    )
    inscribed = np.maximum(_inscribed(windows, index, vector, space, edges) - 0.5, radius)
    return PoreSections(radius, inscribed, area, perimeter, middle, conductance)


def _inscribed(
    windows: Windows,
    index: NDArray[np.float64],
    vector: NDArray[np.float64],
    space: PackedSpace,
    edges: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the distance to the rock from the best place of each window near the middle of its widest faces."""
    begin, faces = windows.start[:-1], np.diff(windows.start)
    widest = windows.level == np.repeat(np.maximum.reduceat(windows.level, begin), faces)
    count = np.add.reduceat(widest.astype(np.int64), begin)
    middle = np.stack([np.add.reduceat(index[:, axis] * widest, begin) for axis in range(3)], axis=1) / count[:, None]
    gap = np.where(widest, ((index - np.repeat(middle, faces, axis=0)) ** 2).sum(axis=1), np.inf)
    face = np.lexsort((gap, np.repeat(np.arange(len(begin)), faces)))[begin]
    normal = vector / np.maximum(np.linalg.norm(vector, axis=1), 1e-9)[:, None]
    return widest_balls(windows.voxel[face], normal, space, edges, index[face])


@njit(cache=True)
def _ducts(
    start: NDArray[np.int64],
    voxel: NDArray[np.int64],
    axis: NDArray[np.int8],
    sign: NDArray[np.int8],
    vector: NDArray[np.float64],
    edges: NDArray[np.float64],
    shape: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return conductance and perimeter of each window, from its projection along the axis it faces most."""
    count = len(start) - 1
    conductance, perimeter = np.empty(count), np.empty(count)
    for window in range(count):
        faces = np.zeros(3, np.int64)
        for row in range(start[window], start[window + 1]):
            faces[axis[row]] += 1
        normal = np.argmax(np.abs(vector[window]) + 1e-9 * faces)
        u, v = (normal + 1) % 3, (normal + 2) % 3
        low, high = np.full(3, 1 << 40), np.full(3, -1)
        for row in range(start[window], start[window + 1]):
            place = _place(voxel[row], shape)
            for a in range(3):
                low[a], high[a] = min(low[a], place[a]), max(high[a], place[a])
        winding = np.zeros((high[u] - low[u] + 3, high[v] - low[v] + 3), np.int64)
        for row in range(start[window], start[window + 1]):
            if axis[row] == normal:
                place = _place(voxel[row], shape)
                winding[place[u] - low[u] + 1, place[v] - low[v] + 1] += sign[row]
        cell = np.zeros(winding.shape, np.uint8)
        cells = 0
        for i in range(winding.shape[0]):
            for j in range(winding.shape[1]):
                a, b = low[u] + i - 1, low[v] + j - 1
                if a < 0 or b < 0 or a >= shape[u] or b >= shape[v]:
                    cell[i, j] = OUTSIDE
                elif winding[i, j] != 0:
                    cell[i, j] = PORE
                    cells += 1
        projected = cells * edges[u] * edges[v]
        flow = duct_conductance(cell, edges[u], edges[v])
        if np.isinf(flow):
            # No rock bounds the section: the sample's own faces are the only walls there are.
            flow = duct_conductance(np.where(cell == PORE, PORE, ROCK).astype(np.uint8), edges[u], edges[v])
        tilt = 1.0
        if projected > 0:
            area = np.sqrt((vector[window] ** 2).sum())
            tilt = min(max(area / projected, 1.0), np.sqrt(3.0))
        # A circle seen at a slant is an ellipse with one shorter axis.
        conductance[window] = flow * tilt * (1.0 + tilt**2) / 2.0
        perimeter[window] = _perimeter(cell, edges[u], edges[v]) * (1.0 + tilt) / 2.0
    return conductance, perimeter


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

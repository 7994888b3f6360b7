"""Compiled loops over pore voxels: a velocity profile for every passage, and the work of viscosity in a flow.

A wall with six pore voxels or more before it lies where the voxels round it say (:func:`_wall`), others half a voxel
from the middle of the last voxel. Derivatives there are taken through the two nearest middles, which makes a slit of
any width exact (see :mod:`geofit.pores.duct`). Faces of the sample mirror.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["LAYERS", "profile", "work_and_flow"]

#: Mirrored layers that the work needs beyond both faces of the sample.
LAYERS = 2
_RELAXATION = 1.7
#: Pore voxels behind one another that a wall needs to be smoothed: with fewer, narrow tubes were opened or closed.
_DEPTH = 6
_NEAREST_WALL, _FARTHEST_WALL = 0.2, 1.0
#: A duct of one voxel: the mean velocity of a square over that which the differences give its middle, 0.0351 / 0.0625.
_LEAST_MEAN = 0.5625


@njit(cache=True)
def profile(
    number: NDArray[np.int32], order: NDArray[np.int64], edges: NDArray[np.float64], tolerance: float, most: int
) -> tuple[NDArray[np.float64], NDArray[np.float32], int]:
    """Solve -laplace u = 1 in the pores, u = 0 at the rock, by over-relaxation.

    Parameters
    ----------
    number : ndarray of int32, shape of the volume
        Row of each pore voxel; -1 in rock.
    order : ndarray of int64, shape (n,)
        Flat index of each row.
    edges : ndarray, shape (3,)
    tolerance : float
        Largest change in the last sweep, as a share of the largest u.
    most : int
        Sweeps.

    Returns
    -------
    u : ndarray, shape (n,)
    wall : ndarray of float32, shape (n, 6)
        Distance of the wall from the middle of a voxel, in voxels: low and high side of axis 0, of axis 1, of axis 2.
    sweeps : int
        -1 if ``most`` were not enough.
    """
    shape = number.shape
    count = len(order)
    beside = np.empty((count, 6), np.int32)
    wall = np.full((count, 6), np.float32(0.5))
    diagonal = np.zeros(count)
    steps = (shape[1] * shape[2], shape[2], 1)
    flat = number.ravel()
    for row in range(count):
        here = order[row]
        i, j, k = here // steps[0], here // steps[1] % shape[1], here % shape[2]
        for d in range(3):
            place = (i, j, k)[d]
            low = flat[here - steps[d]] if place > 0 else -2
            high = flat[here + steps[d]] if place < shape[d] - 1 else -2
            beside[row, 2 * d], beside[row, 2 * d + 1] = low, high
            weight = 1.0 / edges[d] ** 2
            if low == -1 and high == -1:
                diagonal[row] += 8.0 * weight
            elif low == -1 or high == -1:
                side = 0 if low == -1 else 1
                near = _wall(number, d, 2 * side - 1, i, j, k)
                wall[row, 2 * d + side] = near
                mirrored = low == -2 or high == -2
                diagonal[row] += weight * (2.0 / near - (2.0 / (1.0 + near) if mirrored else 0.0))
            else:
                diagonal[row] += weight * ((low >= 0) + (high >= 0))
    u = np.zeros(count)
    for sweep in range(most):
        change, largest = 0.0, 0.0
        for row in range(count):
            total = 1.0
            for d in range(3):
                low, high = beside[row, 2 * d], beside[row, 2 * d + 1]
                pull = 1.0 / edges[d] ** 2
                if low == -1:
                    pull *= 2.0 / (1.0 + wall[row, 2 * d])
                elif high == -1:
                    pull *= 2.0 / (1.0 + wall[row, 2 * d + 1])
                if low >= 0:
                    total += pull * u[low]
                if high >= 0:
                    total += pull * u[high]
            step = _RELAXATION * (total / diagonal[row] - u[row])
            u[row] += step
            change, largest = max(change, abs(step)), max(largest, u[row])
        if change <= tolerance * largest:
            return u, wall, sweep
    return u, wall, -1


@njit(cache=True)
def _wall(number: NDArray[np.int32], d: int, side: int, i: int, j: int, k: int) -> float:
    """Return how far the wall is from the middle of a pore voxel whose next on a side is rock, in voxels.

    It is the mean over the 3 x 3 columns round the voxel that run through the wall, as heights of a free surface are
    found (Hirt & Nichols 1981), if in all of them pore voxels end in rock within a voxel of here; else 0.5.
    """
    shape = number.shape
    e, f = (d + 1) % 3, (d + 2) % 3
    place = np.empty(3, np.int64)
    total, columns = 0, 0
    for r in range(-1, 2):
        for s in range(-1, 2):
            place[0], place[1], place[2] = i, j, k
            place[e] += r
            place[f] += s
            if min(place[e], place[f]) < 0 or place[e] >= shape[e] or place[f] >= shape[f]:
                continue
            height, before = 0, True
            for t in range(1 - _DEPTH, 3):
                place[d] = (i, j, k)[d] + side * t
                outside = place[d] < 0 or place[d] >= shape[d]
                pore = t <= 0 if outside else number[place[0], place[1], place[2]] >= 0
                if pore and not before:
                    return 0.5
                before = pore
                height += pore
            if abs(height - _DEPTH) > 1:
                return 0.5
            total += height - _DEPTH
            columns += 1
    return min(max(0.5 + total / columns, _NEAREST_WALL), _FARTHEST_WALL)


@njit(cache=True)
def work_and_flow(
    number: NDArray[np.int32],
    wall: NDArray[np.float32],
    weights: NDArray[np.float64],
    pressure: NDArray[np.float64],
    axis: int,
    edges: NDArray[np.float64],
) -> tuple[float, float]:
    """Return the work of viscosity, and the sum of the velocities along an axis, both times the volume of a voxel.

    Parameters
    ----------
    number : ndarray of int32, shape of the volume with ``LAYERS`` mirrored layers more at both ends of the axis
        Row of each voxel; -1 in rock.
    wall : ndarray, shape (n, 6)
        From :func:`profile`.
    weights, pressure : ndarray, shape (n,)
        The velocity between two voxels is the fall of the pressure times the harmonic mean of their weights, as in
        :func:`geofit.pores.laplace_loops.assemble`.
    axis : int
    edges : ndarray, shape (3,)
    """
    n0, n1, n2 = number.shape
    first, last = LAYERS, number.shape[axis] - LAYERS
    flow_of = number, wall, weights, pressure, axis, edges
    work, flow = 0.0, 0.0
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                at = (i, j, k)[axis]
                if number[i, j, k] < 0 or at < first or at > last:
                    continue
                for d in range(3):
                    if d != axis and at == last:
                        continue
                    v = _velocity(flow_of, d, i, j, k)
                    if v == 0.0:
                        continue
                    drag, bend = _drag(flow_of, d, v, i, j, k)
                    # The mean over a face is the velocity in its middle and 1 / 24 of its second differences.
                    mean = v * max(1.0 - max(bend / v, 0.0) / 24.0, _LEAST_MEAN)
                    # Faces of the sample belong to it by half.
                    share = 0.5 if d == axis and at in (first, last) else 1.0
                    work += share * mean * drag
                    if d == axis:
                        flow += share * mean
    voxel = edges[0] * edges[1] * edges[2]
    return work * voxel, flow * voxel


_Flow = tuple[
    NDArray[np.int32], NDArray[np.float32], NDArray[np.float64], NDArray[np.float64], int, NDArray[np.float64]
]


@njit(cache=True)
def _velocity(flow_of: _Flow, d: int, i: int, j: int, k: int) -> float:
    """Return the velocity along d through the low face of a voxel."""
    number, _, weights, pressure, axis, edges = flow_of
    here = number[i, j, k]
    if here < 0 or (i, j, k)[d] == 0:
        return 0.0
    before = number[i - (d == 0), j - (d == 1), k - (d == 2)]
    if before < 0:
        return 0.0
    at, end = (i, j, k)[axis], number.shape[axis] - LAYERS
    own, other = _mirrored(pressure[here], at, end), _mirrored(pressure[before], at - (d == axis), end)
    return float(2.0 * weights[here] * weights[before] / (weights[here] + weights[before]) * (other - own) / edges[d])


@njit(cache=True)
def _mirrored(pressure: float, at: int, end: int) -> float:
    """Pressures are 1 at the low face of the sample and 0 at the high one, and odd about them."""
    if at < LAYERS:
        return 2.0 - pressure
    return -pressure if at >= end else pressure


@njit(cache=True)
def _drag(flow_of: _Flow, d: int, v: float, i: int, j: int, k: int) -> tuple[float, float]:
    """Return -laplace v of the velocity v along d on the low face of a voxel, and the sum of its second differences."""
    number, wall, edges = flow_of[0], flow_of[1], flow_of[5]
    a, b, c = i - (d == 0), j - (d == 1), k - (d == 2)
    total, bend = 0.0, 0.0
    for e in range(3):
        walls, others, near = 0, 0.0, 0.5
        for side in (-1, 1):
            x, y, z = side * (e == 0), side * (e == 1), side * (e == 2)
            if (i, j, k)[e] + side < 0 or (i, j, k)[e] + side >= number.shape[e]:
                # A closed face of the sample lets nothing through and slips along.
                others += 0.0 if e == d else v
            elif e != d and number[i + x, j + y, k + z] < 0 and number[a + x, b + y, c + z] < 0:
                walls += 1
                column = 2 * e + (side > 0)
                near = 0.5 * (wall[number[i, j, k], column] + wall[number[a, b, c], column])
            else:
                others += _velocity(flow_of, d, i + x, j + y, k + z)
        if walls == 0:
            step = 2.0 * v - others
        elif walls == 1:
            step = 2.0 * v / near - 2.0 / (1.0 + near) * others
        else:
            step = 8.0 * v
        total += step / edges[e] ** 2
        bend += step
    return total, bend

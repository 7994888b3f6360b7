"""Compiled: the sum of the potentials of balls that are sorted into cells."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["density", "density_gradient", "density_range"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, inline="always")
def _f(code: int, q: float) -> float:
    if code == 4:
        return math.exp(-q)
    if q >= 1:
        return 0.0
    if code == 0:
        return (1 - q) * (1 - q) * (1 - q)
    if code == 1:
        return 1 + q * (-22 / 9 + q * (17 / 9 - q * 4 / 9))
    if code == 2:
        return (1 - q) * (1 - q)
    return 1 - 3 * q if q <= 1 / 9 else 1.5 * (1 - math.sqrt(q)) ** 2


@njit(cache=True, inline="always")
def _df(code: int, q: float) -> float:
    if code == 4:
        return -math.exp(-q)
    if q >= 1:
        return 0.0
    if code == 0:
        return -3 * (1 - q) * (1 - q)
    if code == 1:
        return -22 / 9 + q * (34 / 9 - q * 12 / 9)
    if code == 2:
        return -2 * (1 - q)
    return -3.0 if q <= 1 / 9 else -1.5 * (1 - math.sqrt(q)) / math.sqrt(q)


@njit(cache=True, inline="always")
def _cell(x: float, y: float, z: float, corner: Floats, side: float, counts: Ints) -> int:
    i, j, k = math.floor((x - corner[0]) / side), math.floor((y - corner[1]) / side), math.floor((z - corner[2]) / side)
    if i < 0 or j < 0 or k < 0 or i >= counts[0] or j >= counts[1] or k >= counts[2]:
        return -1
    return int((i * counts[1] + j) * counts[2] + k)


@njit(cache=True, inline="always")
def _within(point: Floats, centre: Floats, a: Floats) -> tuple[float, float, float]:
    """Return A (x - c): the place of a point (3,) in a ball's own coordinates."""
    x, y, z = point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]
    return (
        a[0, 0] * x + a[0, 1] * y + a[0, 2] * z,
        a[1, 0] * x + a[1, 1] * y + a[1, 2] * z,
        a[2, 0] * x + a[2, 1] * y + a[2, 2] * z,
    )


@njit(cache=True)
def density(
    xyz: Floats, corner: Floats, side: float, counts: Ints, start: Ints, ball: Ints,
    centres: Floats, shapes: Floats, densities: Floats, ends: Floats, code: int,
) -> Floats:  # fmt: skip
    """Return sum b f(|A (x - c)|^2) at (n, 3) points."""
    total = np.zeros(xyz.shape[0])
    for p in range(xyz.shape[0]):
        cell = _cell(xyz[p, 0], xyz[p, 1], xyz[p, 2], corner, side, counts)
        if cell < 0:
            # A place with a coordinate that is not a number has no value.
            total[p] = math.nan if math.isnan(xyz[p].sum()) else 0.0
            continue
        for i in range(start[cell], start[cell + 1]):
            b = ball[i]
            u, v, w = _within(xyz[p], centres[b], shapes[b])
            q = u * u + v * v + w * w
            if q < ends[b]:
                total[p] += densities[b] * _f(code, q)
    return total


@njit(cache=True)
def density_gradient(
    xyz: Floats, corner: Floats, side: float, counts: Ints, start: Ints, ball: Ints,
    centres: Floats, shapes: Floats, densities: Floats, ends: Floats, code: int,
) -> Floats:  # fmt: skip
    """Return the gradient of :func:`density`, (n, 3)."""
    total = np.zeros(xyz.shape)
    for p in range(xyz.shape[0]):
        cell = _cell(xyz[p, 0], xyz[p, 1], xyz[p, 2], corner, side, counts)
        if cell < 0:
            continue
        for i in range(start[cell], start[cell + 1]):
            b = ball[i]
            a = shapes[b]
            u, v, w = _within(xyz[p], centres[b], a)
            q = u * u + v * v + w * w
            if q < ends[b]:
                f = 2 * densities[b] * _df(code, q)
                for j in range(3):
                    total[p, j] += f * (a[0, j] * u + a[1, j] * v + a[2, j] * w)
    return total


@njit(cache=True)
def density_range(
    lower: Floats, upper: Floats, centres: Floats, shapes: Floats, densities: Floats, ends: Floats, code: int
) -> tuple[Floats, Floats]:
    """Return bounds of :func:`density` in boxes, by bounds of every component of A (x - c)."""
    lowest, highest = np.zeros(lower.shape[0]), np.zeros(lower.shape[0])
    for k in range(lower.shape[0]):
        for b in range(centres.shape[0]):
            nearest = farthest = 0.0
            for j in range(3):
                middle = reach = 0.0
                for i in range(3):
                    a = shapes[b, j, i]
                    middle += a * ((lower[k, i] + upper[k, i]) / 2 - centres[b, i])
                    reach += abs(a) * (upper[k, i] - lower[k, i]) / 2
                middle = abs(middle)
                nearest += max(middle - reach, 0.0) ** 2
                farthest += (middle + reach) ** 2
                if nearest >= ends[b]:
                    break
            if nearest >= ends[b]:
                continue
            near = densities[b] * _f(code, nearest)
            far = densities[b] * _f(code, farthest) if farthest < ends[b] else 0.0
            lowest[k] += min(near, far)
            highest[k] += max(near, far)
    return lowest, highest

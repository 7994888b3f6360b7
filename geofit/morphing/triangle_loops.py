"""Compiled: signed distances of the nodes of a lattice from closed triangle meshes."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["nearest_places", "spread_triangles", "winding_inside"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Shift of the columns against the nodes, in spacings: a column must not meet a vertex of a triangle.
SHIFT_X, SHIFT_Y = 1.37e-6, 0.71e-6


@njit(cache=True)
def _nearest(p: Floats, a: Floats, b: Floats, c: Floats, out: Floats) -> float:
    """Write the place of a triangle nearest to a point to ``out``; return the squared distance."""
    d1 = d2 = d3 = d4 = d5 = d6 = 0.0
    for k in range(3):
        ab, ac = b[k] - a[k], c[k] - a[k]
        d1 += ab * (p[k] - a[k])
        d2 += ac * (p[k] - a[k])
        d3 += ab * (p[k] - b[k])
        d4 += ac * (p[k] - b[k])
        d5 += ab * (p[k] - c[k])
        d6 += ac * (p[k] - c[k])
    v = w = 0.0
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0 and d2 <= 0:
        pass
    elif d3 >= 0 and d4 <= d3:
        v = 1.0
    elif d6 >= 0 and d5 <= d6:
        w = 1.0
    elif vc <= 0 and d1 >= 0 and d3 <= 0:
        v = d1 / (d1 - d3) if d1 != d3 else 0.0
    elif vb <= 0 and d2 >= 0 and d6 <= 0:
        w = d2 / (d2 - d6) if d2 != d6 else 0.0
    elif va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        total = (d4 - d3) + (d5 - d6)
        w = (d4 - d3) / total if total > 0 else 0.0
        v = 1.0 - w
    else:
        total = va + vb + vc
        if total != 0:
            v, w = vb / total, vc / total
    square = 0.0
    for k in range(3):
        out[k] = a[k] + v * (b[k] - a[k]) + w * (c[k] - a[k])
        square += (p[k] - out[k]) ** 2
    return square


@njit(cache=True)
def nearest_places(points: Floats, corners: Floats) -> Floats:
    """Return the places (n, 3) of triangles (n, 3, 3) nearest to (n, 3) points."""
    found = np.empty_like(points)
    for n in range(len(points)):
        _nearest(points[n], corners[n, 0], corners[n, 1], corners[n, 2], found[n])
    return found


@njit(cache=True)
def spread_triangles(
    vertices: Floats, triangles: Ints, shape: tuple[int, int, int], wanted: NDArray[np.bool_], band: float
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return unsigned distances and nearest triangles of nodes; vertices and distances in spacings.

    Distances are exact next to the triangles; from there each node offers its triangle to its neighbours. Nodes that
    are neither ``wanted`` nor within ``band`` keep infinity and -1.
    """
    nx, ny, nz = shape
    best = np.full(nx * ny * nz, np.inf, np.float32)
    owner = np.full(nx * ny * nz, -1, np.int32)
    p, out = np.empty(3), np.empty(3)
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for t in range(len(triangles)):
        a, b, c = vertices[triangles[t, 0]], vertices[triangles[t, 1]], vertices[triangles[t, 2]]
        for k in range(3):
            low[k] = max(0, math.floor(min(a[k], b[k], c[k])) - 1)
            high[k] = min(shape[k] - 1, math.ceil(max(a[k], b[k], c[k])) + 1)
        for i in range(low[0], high[0] + 1):
            for j in range(low[1], high[1] + 1):
                for k in range(low[2], high[2] + 1):
                    p[0], p[1], p[2] = i, j, k
                    at = (i * ny + j) * nz + k
                    distance = np.float32(math.sqrt(_nearest(p, a, b, c, out)))
                    if distance < best[at]:
                        best[at], owner[at] = distance, t
    count = 0
    for at in range(len(owner)):
        if owner[at] >= 0:
            count += 1
    size = 2 * count + 1024
    queue = np.empty(size, np.int64)
    waiting = np.zeros(len(owner), np.bool_)
    first = last = 0
    for at in range(len(owner)):
        if owner[at] >= 0:
            queue[last] = at
            waiting[at] = True
            last += 1
    filled = last
    steps = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
    while filled > 0:
        at = queue[first]
        first = first + 1 if first + 1 < size else 0
        filled -= 1
        waiting[at] = False
        t = owner[at]
        a, b, c = vertices[triangles[t, 0]], vertices[triangles[t, 1]], vertices[triangles[t, 2]]
        i, j, k = at // (ny * nz), at // nz % ny, at % nz
        for m in range(6):
            x, y, z = i + steps[m, 0], j + steps[m, 1], k + steps[m, 2]
            if x < 0 or y < 0 or z < 0 or x >= nx or y >= ny or z >= nz:
                continue
            to = (x * ny + y) * nz + z
            if owner[to] == t or best[to] + 1 < best[at] or (best[at] > band and not wanted[to]):
                continue
            p[0], p[1], p[2] = x, y, z
            distance = np.float32(math.sqrt(_nearest(p, a, b, c, out)))
            if distance < best[to]:
                best[to], owner[to] = distance, t
                if not waiting[to]:
                    waiting[to] = True
                    if filled == size:
                        larger = np.empty(2 * size, np.int64)
                        for n in range(filled):
                            larger[n] = queue[(first + n) % size]
                        queue, size, first, last = larger, 2 * size, 0, filled
                    queue[last] = to
                    last = last + 1 if last + 1 < size else 0
                    filled += 1
    return best, owner


@njit(cache=True)
def _side(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Return twice the signed area of (a, b, p), to the last bit opposite for the opposite direction."""
    if ax < bx or (ax == bx and ay < by):
        return (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    return -((ax - bx) * (y - by) - (ay - by) * (x - bx))


@njit(cache=True)
def winding_inside(vertices: Floats, triangles: Ints, shape: tuple[int, int, int]) -> NDArray[np.bool_]:
    """Return whether each node has a positive winding number, by the crossings of vertical columns.

    Triangles that share an edge decide by the same number on which side of it a column is: nothing leaks.
    """
    nx, ny, nz = shape
    turns = np.zeros((nx, ny, nz + 1), np.int16)
    for t in range(len(triangles)):
        a, b, c = vertices[triangles[t, 0]], vertices[triangles[t, 1]], vertices[triangles[t, 2]]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0:
            continue
        for i in range(
            max(0, math.floor(min(a[0], b[0], c[0])) - 1), min(nx - 1, math.ceil(max(a[0], b[0], c[0]))) + 1
        ):
            x = i + SHIFT_X
            for j in range(
                max(0, math.floor(min(a[1], b[1], c[1])) - 1), min(ny - 1, math.ceil(max(a[1], b[1], c[1]))) + 1
            ):
                y = j + SHIFT_Y
                u = _side(b[0], b[1], c[0], c[1], x, y)
                v = _side(c[0], c[1], a[0], a[1], x, y)
                w = _side(a[0], a[1], b[0], b[1], x, y)
                if not ((u > 0 and v > 0 and w > 0) or (u < 0 and v < 0 and w < 0)):
                    continue
                z = (u * a[2] + v * b[2] + w * c[2]) / (u + v + w)
                above = min(max(math.ceil(z), 0), nz)
                turns[i, j, above] += 1 if u < 0 else -1
    inside = np.zeros(nx * ny * nz, np.bool_)
    for i in range(nx):
        for j in range(ny):
            total = 0
            for k in range(nz):
                total += turns[i, j, k]
                inside[(i * ny + j) * nz + k] = total > 0
    return inside

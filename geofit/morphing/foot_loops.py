"""Compiled: foot points on the zero surface of a tricubic B-spline, alone and ring by ring. Lengths in spacings."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.implicit.grid_loops import _weights

__all__ = ["polish_feet", "ring_distances"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STEPS = 20
#: The part of a step across the surface is not divided by less: at a centre of curvature it would have no end.
LEAST = 0.2
#: No step is longer.
REACH = 1.0
#: Rings beyond the band whose distances are those from their neighbours' feet: the spline goes on smoothly there.
BEYOND = 3.0


@njit(cache=True)
def _jet(x: Floats, c: Floats, w: Floats, jet: Floats) -> None:
    """Write value, gradient (3) and second derivatives (xx, yy, zz, xy, xz, yz) at a place to ``jet``."""
    i0 = min(max(math.floor(x[0]), 0), c.shape[0] - 4)
    j0 = min(max(math.floor(x[1]), 0), c.shape[1] - 4)
    k0 = min(max(math.floor(x[2]), 0), c.shape[2] - 4)
    for a in range(3):
        start = i0 if a == 0 else (j0 if a == 1 else k0)
        u = x[a] - start
        v = 1 - u
        _weights(u, w[a])
        w[3 + a, 0], w[3 + a, 3] = -v * v / 2, u * u / 2
        w[3 + a, 1], w[3 + a, 2] = (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2
        w[6 + a, 0], w[6 + a, 1], w[6 + a, 2], w[6 + a, 3] = v, 3 * u - 2, 3 * v - 2, u
    for m in range(10):
        jet[m] = 0.0
    for i in range(4):
        for j in range(4):
            r = rz = rzz = 0.0
            for k in range(4):
                value = c[i0 + i, j0 + j, k0 + k]
                r += w[2, k] * value
                rz += w[5, k] * value
                rzz += w[8, k] * value
            ww = w[0, i] * w[1, j]
            jet[0] += ww * r
            jet[3] += ww * rz
            jet[6] += ww * rzz
            jet[1] += w[3, i] * w[1, j] * r
            jet[8] += w[3, i] * w[1, j] * rz
            jet[4] += w[6, i] * w[1, j] * r
            jet[2] += w[0, i] * w[4, j] * r
            jet[9] += w[0, i] * w[4, j] * rz
            jet[5] += w[0, i] * w[7, j] * r
            jet[7] += w[3, i] * w[4, j] * r


@njit(cache=True)
def _project(p: Floats, x: Floats, c: Floats, tolerance: float, w: Floats, jet: Floats) -> bool:
    """Move ``x`` to the foot point of ``p``; return whether the steps ended (see implicit.foot for the step)."""
    for _ in range(STEPS):
        _jet(x, c, w, jet)
        length = math.sqrt(jet[1] ** 2 + jet[2] ** 2 + jet[3] ** 2)
        if not length > 1e-12:
            return False
        n0, n1, n2 = jet[1] / length, jet[2] / length, jet[3] / length
        o0, o1, o2 = p[0] - x[0], p[1] - x[1], p[2] - x[2]
        height = o0 * n0 + o1 * n1 + o2 * n2
        t0, t1, t2 = o0 - height * n0, o1 - height * n1, o2 - height * n2
        square = t0 * t0 + t1 * t1 + t2 * t2
        factor = 1.0
        if square > 1e-24:
            bend = (
                t0 * t0 * jet[4]
                + t1 * t1 * jet[5]
                + t2 * t2 * jet[6]
                + 2 * (t0 * t1 * jet[7] + t0 * t2 * jet[8] + t1 * t2 * jet[9])
            ) / (square * length)
            factor = 1 / max(1 + bend * height, LEAST)
        away = jet[0] / length
        s0, s1, s2 = factor * t0 - away * n0, factor * t1 - away * n1, factor * t2 - away * n2
        size = math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
        cut = REACH / size if size > REACH else 1.0
        x[0] += cut * s0
        x[1] += cut * s1
        x[2] += cut * s2
        if size <= tolerance:
            return True
    return False


@njit(cache=True)
def polish_feet(points: Floats, start: Floats, c: Floats, tolerance: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Return distances (n,) of (n, 3) points from their feet, sought from ``start``, and whether they converged."""
    distance, done = np.empty(len(points)), np.zeros(len(points), np.bool_)
    w, jet, x = np.empty((9, 4)), np.empty(10), np.empty(3)
    for n in range(len(points)):
        x[:] = start[n]
        done[n] = _project(points[n], x, c, tolerance, w, jet)
        distance[n] = math.sqrt((points[n, 0] - x[0]) ** 2 + (points[n, 1] - x[1]) ** 2 + (points[n, 2] - x[2]) ** 2)
    return distance, done


@njit(cache=True)
def ring_distances(phi: Floats, c: Floats, band: float, tolerance: float) -> tuple[Floats, int]:
    """Return signed distances from the zero surface within ``band``, about them in the next rings, and steps not ended.

    Nodes next to the surface find their feet from where they are; each further node starts at its neighbour's foot.
    """
    nx, ny, nz = phi.shape
    out = np.empty((nx, ny, nz))
    slot = np.full((nx, ny, nz), -1, np.int32)
    count = 0
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                side = phi[i, j, k] < 0
                out[i, j, k] = -(band + BEYOND) if side else band + BEYOND
                if (
                    (i + 1 < nx and (phi[i + 1, j, k] < 0) != side)
                    or (i > 0 and (phi[i - 1, j, k] < 0) != side)
                    or (j + 1 < ny and (phi[i, j + 1, k] < 0) != side)
                    or (j > 0 and (phi[i, j - 1, k] < 0) != side)
                    or (k + 1 < nz and (phi[i, j, k + 1] < 0) != side)
                    or (k > 0 and (phi[i, j, k - 1] < 0) != side)
                ):
                    slot[i, j, k] = count
                    count += 1
    size = max(16 * count, 1024)
    nodes, feet = np.empty((size, 3), np.int32), np.empty((size, 3))
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                if slot[i, j, k] >= 0:
                    m = slot[i, j, k]
                    nodes[m, 0], nodes[m, 1], nodes[m, 2] = i, j, k
    near = count
    w, jet, x, p = np.empty((9, 4)), np.empty(10), np.empty(3), np.empty(3)
    lost = 0
    steps = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
    n = 0
    while n < count:
        i, j, k = nodes[n, 0], nodes[n, 1], nodes[n, 2]
        p[0], p[1], p[2] = i, j, k
        x[:] = p if n < near else feet[n]
        before = 0.0 if n < near else math.sqrt((x[0] - i) ** 2 + (x[1] - j) ** 2 + (x[2] - k) ** 2)
        ended = before >= band or _project(p, x, c, tolerance, w, jet)
        distance = math.sqrt((x[0] - i) ** 2 + (x[1] - j) ** 2 + (x[2] - k) ** 2)
        if n < near:
            if not ended or distance > 1.8:
                # A crease: the node's value over its slope is the best that is known.
                lost += 1
                x[:] = p
                _jet(x, c, w, jet)
                length = math.sqrt(jet[1] ** 2 + jet[2] ** 2 + jet[3] ** 2)
                distance = min(abs(jet[0]) / max(length, 1e-12), 1.0)
                for m in range(3):
                    x[m] = p[m] - distance * jet[1 + m] / max(length, 1e-12) * (1.0 if jet[0] > 0 else -1.0)
        elif not ended or distance > before + 1e-9:
            lost += not ended
            distance = before
            x[:] = feet[n]
        feet[n] = x
        out[i, j, k] = -distance if phi[i, j, k] < 0 else distance
        if distance < band + BEYOND - 1:
            for m in range(6):
                a, b, d = i + steps[m, 0], j + steps[m, 1], k + steps[m, 2]
                if a < 0 or b < 0 or d < 0 or a >= nx or b >= ny or d >= nz:
                    continue
                other = slot[a, b, d]
                if other < 0:
                    if count == size:
                        size *= 2
                        more, farther = np.empty((size, 3), np.int32), np.empty((size, 3))
                        more[:count], farther[:count] = nodes, feet
                        nodes, feet = more, farther
                    slot[a, b, d] = count
                    nodes[count, 0], nodes[count, 1], nodes[count, 2] = a, b, d
                    feet[count] = x
                    count += 1
                elif other > n and other >= near:
                    old = (feet[other, 0] - a) ** 2 + (feet[other, 1] - b) ** 2 + (feet[other, 2] - d) ** 2
                    if (x[0] - a) ** 2 + (x[1] - b) ** 2 + (x[2] - d) ** 2 < old:
                        feet[other] = x
        n += 1
    return out, lost

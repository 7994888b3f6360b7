"""Compiled: the arrival at places that see A and B as two planes, the factor that makes the march exact there.

With the plane of B at the angle 0, that of A at the angle q and a node at the angle p between them, the front of speed
|d_B| has u = tan(p / 2) / tan(q / 2). Parallel planes and concentric spheres give the limit |d_B| / (|d_A| + |d_B|).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["LEAST", "wedge_angles", "wedges"]

Floats = NDArray[np.float64]

#: A slope of a distance differs from 1, or between two stencils, by this much at a crease.
CREASE = 0.03
#: Least cosine: where a node's nearest place on A lies rather ahead than behind, the front came from elsewhere.
FACING = 0.0
#: |d_B| counts as this many spacings at least where its logarithm is taken.
LEAST = 1e-3
#: The change of the cosine over one spacing may differ by this much between two stencils.
BENT = 0.01


@njit(cache=True)
def _central(f: Floats, at: int, step: int) -> tuple[float, float]:
    """Return the difference over one spacing, of order 4, and by how much that of order 2 differs from it."""
    near, far = (f[at + step] - f[at - step]) / 2, (f[at + 2 * step] - f[at - 2 * step]) / 4
    return (4 * near - far) / 3, abs(near - far) / 3


@njit(cache=True)
def wedge_angles(d_a: Floats, d_b: Floats, wanted: NDArray[np.bool_], h: float) -> Floats:
    """Return the cosine of the angle between both distances' slopes, nan where one has a crease or is not wanted."""
    nx, ny, nz = d_a.shape
    strides = np.array([ny * nz, nz, 1])
    a, b, some = d_a.ravel(), d_b.ravel(), wanted.ravel()
    cosine = np.full(a.size, np.nan)
    for i in range(2, nx - 2):
        for j in range(2, ny - 2):
            for k in range(2, nz - 2):
                at = (i * ny + j) * nz + k
                if not some[at]:
                    continue
                both = aa = bb = off = 0.0
                for m in range(3):
                    ga, oa = _central(a, at, strides[m])
                    gb, ob = _central(b, at, strides[m])
                    both, aa, bb = both + ga * gb, aa + ga * ga, bb + gb * gb
                    off = max(off, max(oa, ob))
                if abs(aa / (h * h) - 1) < CREASE and abs(bb / (h * h) - 1) < CREASE and off < CREASE * h:
                    cosine[at] = min(both / math.sqrt(aa * bb), 1.0)
    return cosine.reshape(d_a.shape)


@njit(cache=True)
def wedges(
    d_a: Floats, d_b: Floats, cosine: Floats, wanted: NDArray[np.bool_], h: float, floor: float
) -> tuple[NDArray[np.int32], Floats, Floats]:
    """Return u of two planes at the distances and the angle that a node sees.

    Returns
    -------
    slot : (nx, ny, nz) array
        Row of a node in the others, -1 where a distance has a crease.
    base : (n,) array
        u of two planes; nearer to B than ``floor`` as large as makes floor / u what |d_B| / u is.
    slope : (n, 3) array
        Change of its logarithm over one spacing along each axis.
    """
    _nx, ny, nz = d_a.shape
    strides = np.array([ny * nz, nz, 1])
    a, b, c, some = d_a.ravel(), d_b.ravel(), cosine.ravel(), wanted.ravel()
    slot = np.full(a.size, -1, np.int32)
    count = 0
    for at in range(a.size):
        # A comparison with nan fails: nodes next to a crease have no row.
        if some[at] and b[at] != 0 and c[at] > FACING:
            bent = 0.0
            for m in range(3):
                off = _central(c, at, strides[m])[1]
                bent = max(bent, off) if off >= 0 else 2.0
            if bent < BENT:
                slot[at] = count
                count += 1
    base, slope = np.empty(count), np.empty((count, 3))
    change_a, change_b = np.empty(3), np.empty(3)
    for at in range(a.size):
        n = slot[at]
        if n < 0:
            continue
        sign = 1.0 if b[at] > 0 else -1.0
        rest, way, cos = max(sign * b[at], LEAST * h), -sign * a[at], c[at]
        edge = math.sqrt(max(rest * rest + way * way + 2 * rest * way * cos, 1e-300))
        span = cos * rest + way + edge
        if span <= 1e-3 * edge:
            slot[at] = -1
            continue
        base[n] = max(rest, floor) * (1 + cos) / span
        by_rest = 1 / rest - (cos + (rest + cos * way) / edge) / span
        by_way = -(1 + (way + cos * rest) / edge) / span
        by_cos = 1 / (1 + cos) - (rest + rest * way / edge) / span
        aa = bb = 0.0
        for m in range(3):
            change_a[m], change_b[m] = _central(a, at, strides[m])[0], _central(b, at, strides[m])[0]
            aa, bb = aa + change_a[m] ** 2, bb + change_b[m] ** 2
        # Distances change by h along their slopes to the last bit: next to B, 1 / |d_B| is as large as it likes.
        to_a, to_b = h / math.sqrt(aa), h / math.sqrt(bb)
        for m in range(3):
            turn = _central(c, at, strides[m])[0]
            slope[n, m] = sign * (by_rest * to_b * change_b[m] - by_way * to_a * change_a[m]) + by_cos * turn
    return slot.reshape(d_a.shape), base, slope

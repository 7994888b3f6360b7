"""Compiled: the level-set equation phi_t = (d_B(foot) + eps kappa) |grad phi| at the nodes of a narrow band.

Lengths in spacings. Transport by WENO5 and Godunov's Hamiltonian, curvature from the C2 tricubic spline.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.implicit.grid_loops import _weights

__all__ = ["band_nodes", "fastest_front", "rates", "sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Nodes this near to the border of the lattice do not move: the stencils end there.
BORDER = 3


@njit(cache=True)
def band_nodes(phi: Floats, width: float) -> Ints:
    """Return the flat indices of nodes with |phi| < width, without the border of the lattice."""
    nx, ny, nz = phi.shape
    count = 0
    for i in range(BORDER, nx - BORDER):
        for j in range(BORDER, ny - BORDER):
            for k in range(BORDER, nz - BORDER):
                count += abs(phi[i, j, k]) < width
    nodes = np.empty(count, np.int64)
    count = 0
    for i in range(BORDER, nx - BORDER):
        for j in range(BORDER, ny - BORDER):
            for k in range(BORDER, nz - BORDER):
                if abs(phi[i, j, k]) < width:
                    nodes[count] = (i * ny + j) * nz + k
                    count += 1
    return nodes


@njit(cache=True, inline="always")
def _weno(v1: float, v2: float, v3: float, v4: float, v5: float) -> float:
    """Fifth-order one-sided slope from five divided differences (G.-S. Jiang & D. Peng, 2000)."""
    s1 = 13 / 12 * (v1 - 2 * v2 + v3) ** 2 + 0.25 * (v1 - 4 * v2 + 3 * v3) ** 2
    s2 = 13 / 12 * (v2 - 2 * v3 + v4) ** 2 + 0.25 * (v2 - v4) ** 2
    s3 = 13 / 12 * (v3 - 2 * v4 + v5) ** 2 + 0.25 * (3 * v3 - 4 * v4 + v5) ** 2
    a1, a2, a3 = 0.1 / (s1 + 1e-6) ** 2, 0.6 / (s2 + 1e-6) ** 2, 0.3 / (s3 + 1e-6) ** 2
    p1 = (2 * v1 - 7 * v2 + 11 * v3) / 6
    p2 = (-v2 + 5 * v3 + 2 * v4) / 6
    p3 = (2 * v3 + 5 * v4 - v5) / 6
    return (a1 * p1 + a2 * p2 + a3 * p3) / (a1 + a2 + a3)


@njit(cache=True)
def _spline(x: float, y: float, z: float, c: Floats, w: Floats) -> float:
    """Value of a tricubic spline at a place, within the lattice."""
    i0 = min(max(math.floor(x), 0), c.shape[0] - 4)
    j0 = min(max(math.floor(y), 0), c.shape[1] - 4)
    k0 = min(max(math.floor(z), 0), c.shape[2] - 4)
    _weights(min(max(x - i0, 0.0), 1.0), w[0])
    _weights(min(max(y - j0, 0.0), 1.0), w[1])
    _weights(min(max(z - k0, 0.0), 1.0), w[2])
    total = 0.0
    for i in range(4):
        for j in range(4):
            row = 0.0
            for k in range(4):
                row += w[2, k] * c[i0 + i, j0 + j, k0 + k]
            total += w[0, i] * w[1, j] * row
    return total


@njit(cache=True)
def _curvature(c: Floats, i: int, j: int, k: int) -> float:
    """Curvature times the slope at a node, from the 27 coefficients around it; at most 2 slopes a spacing."""
    f = g0 = g1 = g2 = h00 = h11 = h22 = h01 = h02 = h12 = 0.0
    for a in range(3):
        va = 4.0 / 6 if a == 1 else 1.0 / 6
        da = (a - 1) / 2
        sa = -2.0 if a == 1 else 1.0
        for b in range(3):
            vb = 4.0 / 6 if b == 1 else 1.0 / 6
            db = (b - 1) / 2
            sb = -2.0 if b == 1 else 1.0
            for d in range(3):
                vd = 4.0 / 6 if d == 1 else 1.0 / 6
                dd = (d - 1) / 2
                sd = -2.0 if d == 1 else 1.0
                f = c[i + a, j + b, k + d]
                g0 += da * vb * vd * f
                g1 += va * db * vd * f
                g2 += va * vb * dd * f
                h00 += sa * vb * vd * f
                h11 += va * sb * vd * f
                h22 += va * vb * sd * f
                h01 += da * db * vd * f
                h02 += da * vb * dd * f
                h12 += va * db * dd * f
    square = g0 * g0 + g1 * g1 + g2 * g2
    if square < 1e-8:
        return 0.0
    along = g0 * g0 * h00 + g1 * g1 * h11 + g2 * g2 * h22 + 2 * (g0 * g1 * h01 + g0 * g2 * h02 + g1 * g2 * h12)
    found = (square * (h00 + h11 + h22) - along) / square
    limit = 2 * math.sqrt(square)
    return min(max(found, -limit), limit)


@njit(cache=True)
def rates(phi: Floats, nodes: Ints, speed: Floats, spline: Floats, eps: float) -> Floats:
    """Return phi_t (n,) at nodes.

    ``speed`` are the spline coefficients of d_B, taken at the foot of each node so that phi stays a distance;
    ``spline`` those of phi itself, used where ``eps`` > 0.
    """
    _nx, ny, nz = phi.shape
    flat = phi.ravel()
    strides = np.array([ny * nz, nz, 1])
    rate = np.empty(len(nodes))
    minus, plus = np.empty(3), np.empty(3)
    w = np.empty((3, 4))
    for n in range(len(nodes)):
        at = nodes[n]
        i, j, k = at // (ny * nz), at // nz % ny, at % nz
        g0 = (flat[at + strides[0]] - flat[at - strides[0]]) / 2
        g1 = (flat[at + strides[1]] - flat[at - strides[1]]) / 2
        g2 = (flat[at + strides[2]] - flat[at - strides[2]]) / 2
        square = max(g0 * g0 + g1 * g1 + g2 * g2, 0.25)
        here = flat[at] / square
        f = _spline(i - here * g0, j - here * g1, k - here * g2, speed, w)
        for m in range(3):
            s = strides[m]
            a, b, d = flat[at - 2 * s] - flat[at - 3 * s], flat[at - s] - flat[at - 2 * s], flat[at] - flat[at - s]
            e, g, h = flat[at + s] - flat[at], flat[at + 2 * s] - flat[at + s], flat[at + 3 * s] - flat[at + 2 * s]
            minus[m], plus[m] = _weno(a, b, d, e, g), _weno(h, g, e, d, b)
        total = 0.0
        for m in range(3):
            # phi_t = f |grad phi|: the front moves outwards where f < 0.
            if f < 0:
                total += max(max(minus[m], 0.0) ** 2, min(plus[m], 0.0) ** 2)
            else:
                total += max(min(minus[m], 0.0) ** 2, max(plus[m], 0.0) ** 2)
        rate[n] = f * math.sqrt(total)
        if eps > 0:
            rate[n] += eps * _curvature(spline, i, j, k)
    return rate


@njit(cache=True)
def fastest_front(phi: Floats, nodes: Ints, speed: Floats) -> float:
    """Return the largest |d_B| at the feet of the nodes next to the front."""
    _nx, ny, nz = phi.shape
    flat = phi.ravel()
    w = np.empty((3, 4))
    found = 0.0
    for n in range(len(nodes)):
        at = nodes[n]
        value = flat[at]
        if abs(value) > 0.9:
            continue
        g0 = (flat[at + ny * nz] - flat[at - ny * nz]) / 2
        g1 = (flat[at + nz] - flat[at - nz]) / 2
        g2 = (flat[at + 1] - flat[at - 1]) / 2
        square = max(g0 * g0 + g1 * g1 + g2 * g2, 0.25)
        i, j, k = at // (ny * nz), at // nz % ny, at % nz
        here = value / square
        found = max(found, abs(_spline(i - here * g0, j - here * g1, k - here * g2, speed, w)))
    return found


@njit(cache=True)
def sums(phi: Floats, d_b: Floats) -> tuple[float, float, float]:
    """Return volume, integral of d_B over the body, and volume of the symmetric difference from B, in spacings.

    A node counts for the part of its cube that a plane at its distance leaves inside.
    """
    volume = energy = different = 0.0
    a, b = phi.ravel(), d_b.ravel()
    for n in range(a.size):
        if a[n] >= 0.5 and b[n] >= 0.5:
            continue
        own = min(max(0.5 - a[n], 0.0), 1.0)
        other = min(max(0.5 - b[n], 0.0), 1.0)
        volume += own
        energy += own * b[n]
        different += abs(own - other)
    return volume, energy, different

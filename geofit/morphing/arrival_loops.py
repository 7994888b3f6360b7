"""Compiled: when the front that starts from A reaches each place on its way to B.

With the speed |d_B|, u = exp(-T) of the arrival time T satisfies |grad u| = u / |d_B|: it falls from 1 on the surface
of A to 0 on that of B, linearly between concentric spheres. The nodes are accepted in the order of falling u.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.morphing.wedge_loops import LEAST

__all__ = ["march", "start_values", "widen"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Slots = NDArray[np.int32]

#: Buckets that sort u: nodes of one bucket are accepted in the order in which they came.
BUCKETS = 1 << 16
#: Nodes within this many spacings of A's surface start with their value along its normal.
START = 2.0
#: Where u grows by more than this factor from node to node its differences are of first order: extrapolated it ends.
STEEP = 2.5
#: From node to node, the quotient by u of two planes changes by this factor at most.
NEAR = 1.5
#: Largest start value behind A's surface.
FARTHEST = 1e8


@njit(cache=True)
def _cubic(t: float, w: Floats) -> None:
    """Weights of the cubic through four neighbours (Catmull & Rom)."""
    w[0] = ((-0.5 * t + 1.0) * t - 0.5) * t
    w[1] = (1.5 * t - 2.5) * t * t + 1.0
    w[2] = ((-1.5 * t + 2.0) * t + 0.5) * t
    w[3] = (0.5 * t - 0.5) * t * t


@njit(cache=True)
def start_values(d_a: Floats, d_b: Floats, slot: Slots, base: Floats, h: float, floor: float) -> Floats:
    """Return u where A's surface is near, nan elsewhere; greater than 1 on the side that the front comes from.

    It is that of two planes; at creases the speed along the normal is taken as linear: T = a ln(v0 / v1) / (v0 - v1)
    over the distance a.
    """
    nx, ny, nz = d_a.shape
    u = np.full((nx, ny, nz), np.nan)
    w = np.empty((3, 4))
    foot, cell = np.empty(3), np.empty(3, np.int64)
    for i in range(3, nx - 3):
        for j in range(3, ny - 3):
            for k in range(3, nz - 3):
                a = d_a[i, j, k]
                if abs(a) > START * h or d_b[i, j, k] == 0:
                    continue
                if slot[i, j, k] >= 0:
                    u[i, j, k] = min(base[slot[i, j, k]], FARTHEST)
                    continue
                gx = (d_a[i + 1, j, k] - d_a[i - 1, j, k]) / 2
                gy = (d_a[i, j + 1, k] - d_a[i, j - 1, k]) / 2
                gz = (d_a[i, j, k + 1] - d_a[i, j, k - 1]) / 2
                length = math.sqrt(gx * gx + gy * gy + gz * gz)
                if length < 0.1 * h:
                    continue
                foot[0], foot[1], foot[2] = i - a * gx / length / h, j - a * gy / length / h, k - a * gz / length / h
                for m in range(3):
                    cell[m] = min(max(math.floor(foot[m]), 1), d_a.shape[m] - 3)
                    _cubic(foot[m] - cell[m], w[m])
                there = 0.0
                for x in range(4):
                    for y in range(4):
                        for z in range(4):
                            there += (
                                w[0, x] * w[1, y] * w[2, z] * d_b[cell[0] + x - 1, cell[1] + y - 1, cell[2] + z - 1]
                            )
                sign = 1.0 if d_b[i, j, k] > 0 else -1.0
                if sign * there <= 0:
                    # The foot lies across B's surface: another front, or none, starts there.
                    continue
                v0, v1 = max(sign * there, floor), max(sign * d_b[i, j, k], floor)
                # The signed way from A's surface, positive where the front goes.
                way = a if sign < 0 else -a
                if abs(way) > v0:
                    # Where both surfaces meet, the front comes from the side, before that along the normal.
                    continue
                mean = (v0 - v1) / math.log(v0 / v1) if abs(v0 - v1) > 1e-6 * v0 else (v0 + v1) / 2
                u[i, j, k] = math.exp(min(-way / mean, math.log(FARTHEST)))
    return u


@njit(cache=True)
def _update(
    u: Floats, done: NDArray[np.bool_], at: int, strides: Ints, rest: float, floor: float, slot: Slots, base: Floats,
    slope: Floats,
) -> float:  # fmt: skip
    """Return u at a node from its accepted neighbours: sum of (change of u along an axis)^2 = (u / rest)^2.

    ``rest`` and ``floor`` are |d_B| and its least value, in spacings.

    Differences are of second order where two neighbours are known: of u itself, and where the node has a row, of its
    quotient w by u of two planes, which hardly changes.
    """
    value, scale, side = np.zeros(3), np.zeros(3), np.zeros(3, np.int64)
    axis = np.zeros(3, np.int64)
    count = 0
    q = 1 / max(rest, floor)
    for m in range(3):
        step = strides[m]
        best, to = -1.0, 0
        for way in (-step, step):
            other = at + way
            if done[other] and u[other] > best:
                best, to = u[other], way
        if best <= 0:
            continue
        s = 1.0
        far = at + 2 * to
        if done[far] and best <= u[far] <= STEEP * best:
            s = 1.5
            best = (4 * best - u[far]) / 3
        # Kept in falling order.
        n = count
        while n > 0 and value[n - 1] < best:
            value[n], scale[n], side[n], axis[n] = value[n - 1], scale[n - 1], side[n - 1], axis[n - 1]
            n -= 1
        value[n], scale[n], side[n], axis[n] = best, s, to, m
        count += 1
    found = -1.0
    a = b = c = 0.0
    used = 0
    for n in range(count):
        if n > 0 and found >= value[n]:
            break
        s2 = scale[n] ** 2
        a += s2
        b += s2 * value[n]
        c += s2 * value[n] ** 2
        if n == 0:
            found = scale[0] * value[0] / (scale[0] + q)
            used = 1
            continue
        # (a - q^2) u^2 - 2 b u + c = 0, the root below every value.
        lead = a - q * q
        inner = b * b - lead * c
        if inner < 0:
            break
        found = c / (b + math.sqrt(inner))
        used = n + 1
    if slot[at] >= 0 and used > 0:
        found = _refined(found, u, done, at, max(rest, LEAST), floor, slot, base, slope, side[:used], axis[:used])
    # Nodes behind A's surface have more than 1; no front starts there.
    return min(found, 1.0)


@njit(cache=True)
def _refined(
    found: float, u: Floats, done: NDArray[np.bool_], at: int, rest: float, floor: float, slot: Slots, base: Floats,
    slope: Floats, side: Ints, axis: Ints,
) -> float:  # fmt: skip
    """Return u by differences of w = u / u0 from the neighbours that gave ``found``, which stays where these fail.

    With p the change of ln u0 towards a neighbour, u changes by u0 (s (v - w) + p w); where no neighbour counts, by
    u0 p w.
    """
    row = slot[at]
    a, b, c, least, most, highest = -1 / rest**2, 0.0, 0.0, np.inf, 0.0, 0.0
    free = slope[row, 0] ** 2 + slope[row, 1] ** 2 + slope[row, 2] ** 2
    for n in range(len(side)):
        near, far = at + side[n], at + 2 * side[n]
        p = slope[row, axis[n]]
        free -= p * p
        p = p if side[n] > 0 else -p
        if slot[near] < 0:
            # A crease lies between: differences of u itself.
            v, s, p = u[near] / base[row], 1.0, 0.0
            if done[far] and u[far] <= STEEP * u[near]:
                v, s = (4 * u[near] - u[far]) / (3 * base[row]), 1.5
        else:
            v, s = u[near] / base[slot[near]], 1.0
            if done[far] and slot[far] >= 0:
                v, s = (4 * v - u[far] / base[slot[far]]) / 3, 1.5
        if v <= 0:
            return found
        least, most, highest = min(least, v), max(most, v), max(highest, u[near])
        a += (s - p) ** 2
        b += s * (s - p) * v
        c += s * s * v * v
    a += max(free, 0.0)
    inner = b * b - a * c
    if inner < 0:
        return found
    below = b + math.sqrt(inner)
    if below <= 0:
        return found
    w = c / below
    # What is farther on the way comes later: no value above all of those it comes from.
    later = base[row] * w * min(rest / floor, 1.0) <= highest
    return base[row] * w if least / NEAR <= w <= most * NEAR and later else found


@njit(cache=True)
def march(
    u: Floats, d_b: Floats, region: NDArray[np.bool_], slot: Slots, base: Floats, slope: Floats, h: float, floor: float
) -> None:
    """Complete u in a region from its start values (not nan); nodes that no front reaches stay nan.

    Only neighbours on the same side of B's surface count. All arrays are flat views of (nx, ny, nz).
    """
    _nx, ny, nz = d_b.shape
    strides = np.array([ny * nz, nz, 1])
    flat, speed, wanted, rows = u.ravel(), d_b.ravel(), region.ravel(), slot.ravel()
    known = ~np.isnan(flat)
    head = np.full(BUCKETS + 1, -1, np.int64)
    size = max(1024, 2 * known.sum())
    following, node = np.empty(size, np.int64), np.empty(size, np.int64)
    key = np.empty(size)
    count = 0
    # Start values on both sides of A's surface are known to the differences, never changed.
    same = np.zeros(flat.size, np.bool_)
    trial = np.full(flat.size, -1.0)
    for side in range(2):
        head[:] = -1
        count = 0
        for at in range(flat.size):
            same[at] = known[at] and ((speed[at] > 0) == (side == 1))
        for at in range(flat.size):
            if same[at]:
                for m in range(3):
                    for way in (-strides[m], strides[m]):
                        to = at + way
                        if not wanted[to] or known[to] or (speed[to] > 0) != (side == 1):
                            continue
                        value = _update(flat, same, to, strides, abs(speed[to]) / h, floor / h, rows, base, slope)
                        if value != trial[to]:
                            trial[to] = value
                            if count == size:
                                size *= 2
                                f2, n2, k2 = np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size)
                                f2[:count], n2[:count], k2[:count] = following, node, key
                                following, node, key = f2, n2, k2
                            bucket = min(max(int((1 - value) * BUCKETS), 0), BUCKETS)
                            node[count], key[count], following[count] = to, value, head[bucket]
                            head[bucket] = count
                            count += 1
        for bucket in range(BUCKETS + 1):
            while head[bucket] >= 0:
                entry = head[bucket]
                head[bucket] = following[entry]
                at = node[entry]
                if known[at] or key[entry] != trial[at]:
                    continue
                known[at] = same[at] = True
                flat[at] = trial[at]
                for m in range(3):
                    for way in (-strides[m], strides[m]):
                        to = at + way
                        if not wanted[to] or known[to] or (speed[to] > 0) != (side == 1):
                            continue
                        value = _update(flat, same, to, strides, abs(speed[to]) / h, floor / h, rows, base, slope)
                        if value != trial[to]:
                            trial[to] = value
                            if count == size:
                                size *= 2
                                f2, n2, k2 = np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size)
                                f2[:count], n2[:count], k2[:count] = following, node, key
                                following, node, key = f2, n2, k2
                            lower = max(min(max(int((1 - value) * BUCKETS), 0), BUCKETS), bucket)
                            node[count], key[count], following[count] = to, value, head[lower]
                            head[lower] = count
                            count += 1


@njit(cache=True)
def widen(field: Floats, layers: int) -> None:
    """Fill nan next to known nodes with the mean of those, layer by layer, in place."""
    _nx, ny, nz = field.shape
    flat = field.ravel()
    strides = np.array([ny * nz, nz, 1])
    edge = np.empty(0, np.int64)
    for layer in range(layers):
        found = 0
        places = np.empty(1024, np.int64)
        means = np.empty(1024)
        total = flat.size if layer == 0 else len(edge) * 6
        for n in range(total):
            at = n if layer == 0 else edge[n // 6] + (strides[n % 3] if n % 6 < 3 else -strides[n % 3])
            if at < strides[0] or at >= flat.size - strides[0] or not np.isnan(flat[at]):
                continue
            amount, sum_ = 0, 0.0
            for m in range(3):
                for way in (-strides[m], strides[m]):
                    value = flat[at + way]
                    if not np.isnan(value):
                        amount += 1
                        sum_ += value
            if amount == 0:
                continue
            if found == len(places):
                p2, m2 = np.empty(2 * found, np.int64), np.empty(2 * found)
                p2[:found], m2[:found] = places, means
                places, means = p2, m2
            places[found], means[found] = at, sum_ / amount
            found += 1
        for n in range(found):
            flat[places[n]] = means[n]
        edge = places[:found]

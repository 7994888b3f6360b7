"""Compiled: the walks to the nearest place of a surface, for very many points.

The steps are those of :mod:`geofit.geometry.cells`, point by point instead of all points step by step: no point waits
for another, and nothing is held but the point itself. Loading the compiled code takes longer than a few thousand walks.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["feet_over_plan", "foot", "jet_at", "walks"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

LAST_STEP, LAST_SLOW_STEP, MAX_STEPS = 1e-7, 1e-9, 80
#: Nearer by less is not nearer, metres; rounds of the search behind walls.
NEARER, ROUNDS = 1e-12, 3


@njit(cache=True, nogil=True, error_model="numpy")
def jet_at(table: Floats, cell: int, s: float, t: float, jet: Floats) -> None:
    """Write S, S_s, S_t, S_ss, S_st, S_tt (6, 4) at a place, by Horner's scheme in s within one in t."""
    q, p, d = table.shape[1], table.shape[2], table.shape[3]
    for k in range(d):
        h0 = h1 = h2 = h3 = h4 = h5 = 0.0
        for i in range(q - 1, -1, -1):
            value = slope = bend = 0.0
            for j in range(p - 1, -1, -1):
                bend = bend * s + slope
                slope = slope * s + value
                value = value * s + table[cell, i, j, k]
            h5 = h5 * t + h2
            h2 = h2 * t + h0
            h0 = h0 * t + value
            h4 = h4 * t + h1
            h1 = h1 * t + slope
            h3 = h3 * t + bend
        jet[0, k], jet[1, k], jet[2, k], jet[3, k], jet[4, k], jet[5, k] = h0, h1, h2, 2 * h3, h4, 2 * h5
    if d == 4:
        w, w_s, w_t = jet[0, 3], jet[1, 3], jet[2, 3]
        for k in range(3):  # The NURBS Book, eq. 4.20
            x = jet[0, k] / w
            x_s, x_t = (jet[1, k] - w_s * x) / w, (jet[2, k] - w_t * x) / w
            jet[3, k] = (jet[3, k] - 2 * w_s * x_s - jet[3, 3] * x) / w
            jet[4, k] = (jet[4, k] - w_s * x_t - w_t * x_s - jet[4, 3] * x) / w
            jet[5, k] = (jet[5, k] - 2 * w_t * x_t - jet[5, 3] * x) / w
            jet[0, k], jet[1, k], jet[2, k] = x, x_s, x_t


@njit(cache=True, nogil=True, error_model="numpy")
def _dot(a: Floats, b: Floats) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@njit(cache=True, nogil=True, error_model="numpy")
def _box_step(
    s: float, t: float, gs: float, gt: float, hss: float, hst: float, htt: float, held_s: bool, held_t: bool
) -> tuple[float, float]:
    """Step to the minimum of the quadratic model in the box [-1, 1]^2, with some coordinates held."""
    det = hss * htt - hst * hst
    regular = det > 1e-14 * abs(hss * htt)
    cross = hst if regular else 0.0
    det = max(det if regular else hss * htt, 1e-300)
    alone_s, alone_t = -gs / max(hss, 1e-300), -gt / max(htt, 1e-300)
    step_s, step_t = -(htt * gs - cross * gt) / det, -(hss * gt - cross * gs) / det
    if not math.isfinite(step_s):
        step_s = alone_s
    if not math.isfinite(step_t):
        step_t = alone_t
    if held_s or held_t:
        step_s, step_t = 0.0 if held_s else alone_s, 0.0 if held_t else alone_t
    low_s, high_s, low_t, high_t = -1 - s, 1 - s, -1 - t, 1 - t
    over_s, over_t = max(step_s - high_s, low_s - step_s), max(step_t - high_t, low_t - step_t)
    step_s, step_t = min(max(step_s, low_s), high_s), min(max(step_t, low_t), high_t)
    if not (held_s or held_t):
        # One coordinate stops at the wall: the other goes to its minimum given that.
        if over_s > 0 and over_s >= over_t:
            step_t = min(max(-(gt + cross * step_s) / max(htt, 1e-300), low_t), high_t)
        elif over_t > 0:
            step_s = min(max(-(gs + cross * step_t) / max(hss, 1e-300), low_s), high_s)
    if gs * step_s + gt * step_t > 0:
        step_s = 0.0 if held_s else min(max(alone_s, low_s), high_s)
        step_t = 0.0 if held_t else min(max(alone_t, low_t), high_t)
    return step_s, step_t


@njit(cache=True, nogil=True, error_model="numpy")
def _walk(
    table: Floats, neighbour: Ints, noise: float, cell: int, s: float, t: float, target: Floats, jet: Floats
) -> tuple[int, float, float, bool]:
    """Walk from a place down to a foot of a point; see :func:`geofit.geometry.cells.refine_foot_points`."""
    r = jet[6]
    entered_s = entered_t = 0.0
    back_s, back_t, step_s, step_t, before = s, t, 0.0, 0.0, np.inf
    for _ in range(MAX_STEPS):
        jet_at(table, cell, s, t, jet)
        for k in range(3):
            r[k] = jet[0, k] - target[k]
        value = math.sqrt(_dot(r, r))
        rose = value > before + noise
        gs, gt = _dot(r, jet[1]), _dot(r, jet[2])
        e, f, g = _dot(jet[1], jet[1]), _dot(jet[1], jet[2]), _dot(jet[2], jet[2])
        hss, hst, htt = e + _dot(r, jet[3]), f + _dot(r, jet[4]), g + _dot(r, jet[5])
        held_s, held_t = abs(s) >= 1 and s * gs < 0, abs(t) >= 1 and t * gt < 0
        if held_t:
            least = hss / max(e, 1e-300)
        elif held_s:
            least = htt / max(g, 1e-300)
        else:
            det = max(e * g - f * f, 1e-300)
            trace = (hss * g - 2 * hst * f + htt * e) / (2 * det)
            least = trace - math.sqrt(max(trace * trace - (hss * htt - hst * hst) / det, 0.0))
        convex = least > 1e-3
        if not convex:
            shift = abs(least) - least + 1e-3
            hss, hst, htt = hss + shift * e, hst + shift * f, htt + shift * g
        sign_s, sign_t = 1.0 if s > 0 else -1.0, 1.0 if t > 0 else -1.0
        behind = -1
        hop_s = hop_t = False
        if not rose:
            if held_s and entered_s != sign_s:
                behind = neighbour[1 if s > 0 else 0, cell]
                hop_s = behind >= 0
            if not hop_s and held_t and entered_t != sign_t:
                behind = neighbour[3 if t > 0 else 2, cell]
                hop_t = behind >= 0
        if hop_s:
            entered_s, s, cell = -sign_s, -sign_s, behind
        elif hop_t:
            entered_t, t, cell = -sign_t, -sign_t, behind
        if hop_s or hop_t:
            before, back_s, back_t, step_s, step_t = value, s, t, 0.0, 0.0
            continue
        if rose:
            move_s, move_t = 0.25 * step_s, 0.25 * step_t
        else:
            move_s, move_t = _box_step(s, t, gs, gt, hss, hst, htt, held_s, held_t)
            back_s, back_t, before = s, t, value
        step_s, step_t = move_s, move_t
        s, t = min(max(back_s + move_s, -1.0), 1.0), min(max(back_t + move_t, -1.0), 1.0)
        if abs(s) < 1:
            entered_s = 0.0
        if abs(t) < 1:
            entered_t = 0.0
        length = math.sqrt(max(e * move_s * move_s + 2 * f * move_s * move_t + g * move_t * move_t, 0.0))
        if length < (LAST_STEP if convex and not rose else LAST_SLOW_STEP):
            return cell, s, t, True
    return cell, s, t, False


@njit(cache=True, nogil=True, error_model="numpy")
def _apart(table: Floats, cell: int, s: float, t: float, target: Floats) -> float:
    """Return the distance of a point from a place."""
    q, p, d = table.shape[1], table.shape[2], table.shape[3]
    total, weight = 0.0, 1.0
    for k in range(d - 1, -1, -1):
        at = 0.0
        for i in range(q - 1, -1, -1):
            value = 0.0
            for j in range(p - 1, -1, -1):
                value = value * s + table[cell, i, j, k]
            at = at * t + value
        if k == 3:
            weight = at
        else:
            total += (at / weight - target[k]) ** 2
    return math.sqrt(total)


@njit(cache=True, nogil=True, error_model="numpy")
def foot(
    table: Floats, neighbour: Ints, noise: float, cell: int, s: float, t: float, target: Floats, jet: Floats
) -> tuple[int, float, float, bool, float]:
    """Walk to a foot, and look behind the walls of its cell where it was held at one."""
    cell, s, t, done = _walk(table, neighbour, noise, cell, s, t, target, jet)
    best = _apart(table, cell, s, t, target)
    for _ in range(ROUNDS):
        if abs(s) < 1 and abs(t) < 1:
            break
        next_s = neighbour[1 if s > 0 else 0, cell] if abs(s) >= 1 else -1
        next_t = neighbour[3 if t > 0 else 2, cell] if abs(t) >= 1 else -1
        corner = neighbour[3 if t > 0 else 2, next_s] if next_s >= 0 and next_t >= 0 else -1
        improved, own_s, own_t = False, s, t
        for way in range(3):
            other = next_s if way == 0 else (next_t if way == 1 else corner)
            if other < 0:
                continue
            from_s, from_t = -own_s if way != 1 else own_s, -own_t if way != 0 else own_t
            c, a, b, fine = _walk(table, neighbour, noise, other, from_s, from_t, target, jet)
            far = _apart(table, c, a, b, target)
            if far < best - NEARER:
                cell, s, t, done, best, improved = c, a, b, fine, far, True
        if not improved:
            break
    return cell, s, t, done, best


@njit(cache=True, nogil=True, error_model="numpy")
def walks(table: Floats, neighbour: Ints, noise: float, cell: Ints, local: Floats, target: Floats, done: Bools) -> None:
    """Walk from n places to feet of (n, 3) points; ``cell`` (n,) and ``local`` (2, n) are overwritten."""
    jet = np.empty((7, 4))
    for i in range(len(cell)):
        c, s, t, fine, _ = foot(table, neighbour, noise, cell[i], local[0, i], local[1, i], target[i], jet)
        cell[i], local[0, i], local[1, i], done[i] = c, s, t, fine


@njit(cache=True, nogil=True, error_model="numpy")
def _interval(breaks: Floats, x: float) -> int:
    """Return the index k with breaks[k] <= x < breaks[k + 1]; the first and the last hold what lies beyond."""
    low, high = 0, len(breaks) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x < breaks[middle]:
            high = middle
        else:
            low = middle
    return low


@njit(cache=True, nogil=True, error_model="numpy")
def feet_over_plan(
    table: Floats,
    breaks_u: Floats,
    breaks_v: Floats,
    domain: Floats,
    start: Floats,
    matrix: Floats,
    inverse: Floats,
    slope: float,
    bend: float,
    limits: tuple[int, float, float, float],
    target: Floats,
    distance: Floats,
    foot: Floats,
    u: Floats,
    v: Floats,
    done: Bools,
) -> None:
    """Walk to the feet of (n, 3) points on a height field, as :mod:`geofit.geometry.foot_points` does step by step.

    ``limits`` are its STEPS, CONVEX, LAST and TOUCHING; what is found is written to ``distance`` (n,), ``foot`` (n, 3),
    ``u``, ``v`` and ``done`` (n,). Points that are done are left alone.
    """
    steps, convex, last, touching = limits
    low_u, high_u, low_v, high_v = domain[0], domain[1], domain[2], domain[3]
    m00 = matrix[0, 0] * matrix[0, 0] + matrix[1, 0] * matrix[1, 0]
    m01 = matrix[0, 0] * matrix[0, 1] + matrix[1, 0] * matrix[1, 1]
    m11 = matrix[0, 1] * matrix[0, 1] + matrix[1, 1] * matrix[1, 1]
    wide_u, wide_v = math.hypot(inverse[0, 0], inverse[0, 1]), math.hypot(inverse[1, 0], inverse[1, 1])
    jet = np.empty((6, 4))
    for i in range(len(target)):
        x, y = target[i, 0] - start[0], target[i, 1] - start[1]
        u0, v0 = inverse[0, 0] * x + inverse[0, 1] * y, inverse[1, 0] * x + inverse[1, 1] * y
        if done[i] or not (low_u <= u0 <= high_u and low_v <= v0 <= high_v):
            continue
        at_u, at_v, apart = u0, v0, np.inf
        for step in range(steps):
            k, m = _interval(breaks_u, at_u), _interval(breaks_v, at_v)
            half_u, half_v = (breaks_u[k + 1] - breaks_u[k]) / 2, (breaks_v[m + 1] - breaks_v[m]) / 2
            s, t = (at_u - breaks_u[k]) / half_u - 1, (at_v - breaks_v[m]) / half_v - 1
            jet_at(table, k * (len(breaks_v) - 1) + m, s, t, jet)
            zu, zv = jet[1, 0] / half_u, jet[2, 0] / half_v
            zuu, zuv, zvv = jet[3, 0] / half_u**2, jet[4, 0] / (half_u * half_v), jet[5, 0] / half_v**2
            r, du, dv = jet[0, 0] - target[i, 2], at_u - u0, at_v - v0
            if step == 0:
                apart = abs(r)
                reach = 0.0 if apart < touching else apart
                if not apart * (1 + slope) * bend <= convex:
                    break
                if u0 - wide_u * reach < low_u or u0 + wide_u * reach > high_u:
                    break
                if v0 - wide_v * reach < low_v or v0 + wide_v * reach > high_v:
                    break
            gu, gv = m00 * du + m01 * dv + r * zu, m01 * du + m11 * dv + r * zv
            e, f, g = m00 + zu * zu, m01 + zu * zv, m11 + zv * zv
            a, b, c = e + r * zuu, f + r * zuv, g + r * zvv
            det = a * c - b * b
            su, sv = (b * gv - c * gu) / det, (b * gu - a * gv) / det
            at_u, at_v, du, dv = at_u + su, at_v + sv, du + su, dv + sv
            if e * su * su + 2 * f * su * sv + g * sv * sv < last * last:
                bend_u, bend_v = zuu * su + zuv * sv, zuv * su + zvv * sv
                r += (zu + bend_u / 2) * su + (zv + bend_v / 2) * sv
                off_x, off_y = matrix[0, 0] * du + matrix[0, 1] * dv, matrix[1, 0] * du + matrix[1, 1] * dv
                if math.hypot(off_x, off_y) <= apart + last:
                    length = math.sqrt(off_x * off_x + off_y * off_y + r * r)
                    side = du * (zu + bend_u) + dv * (zv + bend_v) - r
                    distance[i] = -length if side < 0 else length
                    foot[i, 0], foot[i, 1], foot[i, 2] = target[i, 0] + off_x, target[i, 1] + off_y, target[i, 2] + r
                    u[i], v[i] = min(max(at_u, low_u), high_u), min(max(at_v, low_v), high_v)
                    done[i] = True
                break

"""Compiled: the search for the nearest of all feet, on a surface and along its trim loops, point by point.

Balls of places (:mod:`geofit.geometry.ball_tree`) show which walks may lead to a nearer foot; the bound is that of
:mod:`geofit.geometry.projection`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.geometry.ball_tree import LEAF
from geofit.geometry.foot_loops import foot, jet_at

__all__ = ["explore_tree", "rim_feet"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: A place within so many lattice steps of a known foot belongs to its basin; walks for one point.
SAME_FOOT, MOST_WALKS = 1.6, 24
#: Steps of Newton's method along a piece of a loop, and the last one, of 0 to 1: it leaves an error near its square.
NEWTON, REST = 60, 1e-7


@njit(cache=True, nogil=True, error_model="numpy")
def _from(rows: Floats, k: int, x: Floats) -> float:
    """Return the distance of a point from what row k begins with."""
    return math.sqrt((rows[k, 0] - x[0]) ** 2 + (rows[k, 1] - x[1]) ** 2 + (rows[k, 2] - x[2]) ** 2)


@njit(cache=True, nogil=True, error_model="numpy")
def _children(nodes: Floats, node: int, x: Floats, stack: Ints, far: Floats, top: int) -> int:
    """Put both halves of a ball on the stack with the distances of their centres, the nearer one on top."""
    left = 2 * node + 1
    to_left, to_right = _from(nodes, left, x), _from(nodes, left + 1, x)
    nearer = to_left <= to_right
    stack[top], far[top] = (left + 1, to_right) if nearer else (left, to_left)
    stack[top + 1], far[top + 1] = (left, to_left) if nearer else (left + 1, to_right)
    return top + 2


@njit(cache=True, nogil=True, error_model="numpy")
def _near(order: Ints, nodes: Floats, leaves: Floats, x: Floats) -> int:
    """Return a place near to a point: of each two balls' centres the nearer one leads on."""
    node, inner = 0, len(nodes) // 2
    while node < inner:
        node = 2 * node + 1
        if _from(nodes, node + 1, x) < _from(nodes, node, x):
            node += 1
    found, best = order[0], np.inf
    for k in range(LEAF * (node - inner), LEAF * (node - inner + 1)):
        far = _from(leaves, k, x)
        if far < best:
            best, found = far, order[k]
    return int(found)


@njit(cache=True, nogil=True, error_model="numpy")
def _enclosed(loops: Any, patch: int, u: float, v: float) -> bool:
    """Whether parameters of a patch lie inside its loops (even-odd), whose sides are listed by strips of v."""
    trimmed, domain, strips, listed, sides = loops
    if not trimmed[patch]:
        return True
    low, high = domain[patch, 2], domain[patch, 3]
    count = strips.shape[1] - 1
    row = min(max(int((v - low) / (high - low) * count), 0), count - 1)
    within = False
    for k in range(strips[patch, row], strips[patch, row + 1]):
        side = sides[listed[k]]
        if (side[1] > v) != (side[3] > v) and u < side[0] + (v - side[1]) / (side[3] - side[1]) * (side[2] - side[0]):
            within = not within
    return within


@njit(cache=True, nogil=True, error_model="numpy")
def _known(places: Any, one: int, patch: Ints, at: Floats, count: int, margin: float) -> bool:
    """Whether a place is the start of a walk, or next to the foot of one: it leads to the same foot."""
    own, a, b = places[3][one], places[4][0, one], places[4][1, one]
    for m in range(count):
        if patch[m, 0] == own and max(abs(a - at[m, 0]), abs(b - at[m, 1])) < 0.5:
            return True
        if patch[m, 1] == own and max(abs(a - at[m, 2]), abs(b - at[m, 3])) <= margin:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def _walked(
    cells: Any,
    places: Any,
    loops: Any,
    one: int,
    i: int,
    x: Floats,
    found: Any,
    patch: Ints,
    at: Floats,
    count: int,
    jet: Floats,
) -> None:
    """Walk from a place, note its basin, and keep its foot if it is nearer and inside the loops."""
    table, neighbour, noise, patch_of, origin, steps, centre, half = cells
    apart, cell, local, done = found
    c, s, t, fine, far = foot(table, neighbour, noise, places[1][one], places[2][0, one], places[2][1, one], x, jet)
    patch[count, 0], patch[count, 1] = places[3][one], patch_of[c]
    at[count, 0], at[count, 1] = places[4][0, one], places[4][1, one]
    at[count, 2] = origin[0, c] + steps[0, c] * (s + 1) / 2
    at[count, 3] = origin[1, c] + steps[1, c] * (t + 1) / 2
    if far < apart[i] and _enclosed(loops, patch_of[c], centre[0, c] + half[0, c] * s, centre[1, c] + half[1, c] * t):
        apart[i], cell[i], local[0, i], local[1, i], done[i] = far, c, s, t, fine


@njit(cache=True, nogil=True, error_model="numpy")
def explore_tree(cells: Any, places: Any, tree: Any, loops: Any, target: Floats, known: Bools, found: Any) -> None:
    """Find feet inside the loops that are nearer to (n, 3) points than what is found already.

    ``cells``: table, neighbours, rounding error, patches, lattice origin and steps, centres and half widths of the
    cells. ``places``: position, cell, local coordinates, patch, lattice coordinates. ``tree``: order, nodes and leaves
    of their ball tree. ``loops``: which patches are trimmed, domains, where
    the sides of each strip begin in the list, the list, the sides. ``found``: distance (inf: nothing yet), cell, local
    coordinates, converged, overwritten. ``known`` marks points whose cell and local coordinates are a foot that counts
    as walked to, though it may lie outside the loops.
    """
    order, nodes, leaves = tree
    origin, steps, patch_of = cells[4], cells[5], cells[3]
    apart, cell, local = found[0], found[1], found[2]
    inner = len(nodes) // 2
    jet, stack, away = np.empty((7, 4)), np.empty(128, np.int64), np.empty(128)
    patch, at = np.empty((MOST_WALKS + 2, 2), np.int64), np.empty((MOST_WALKS + 2, 4))
    for i in range(len(target)):
        x, count = target[i], 0
        if known[i]:
            c = cell[i]
            patch[0, 0], patch[0, 1] = -1, patch_of[c]
            at[0, 2] = origin[0, c] + steps[0, c] * (local[0, i] + 1) / 2
            at[0, 3] = origin[1, c] + steps[1, c] * (local[1, i] + 1) / 2
            count = 1
        else:
            _walked(cells, places, loops, _near(order, nodes, leaves, x), i, x, found, patch, at, count, jet)
            count = 1
        top = 1
        stack[0], away[0] = 0, _from(nodes, 0, x)
        while top and count <= MOST_WALKS:
            top -= 1
            node, best = stack[top], apart[i]
            off = max(away[top] - nodes[node, 3], 0.0)
            if off * off > best * best + nodes[node, 4] ** 2 * (1 + best * nodes[node, 5]):
                continue
            if node < inner:
                top = _children(nodes, node, x, stack, away, top)
                continue
            for k in range(LEAF * (node - inner), LEAF * (node - inner + 1)):
                best = apart[i]
                far = _from(leaves, k, x)
                if far * far > best * best + leaves[k, 3] ** 2 * (1 + best * leaves[k, 4]):
                    continue
                one = order[k]
                # Within the radius of curvature the squared distance is convex around a foot.
                margin = SAME_FOOT if best * leaves[k, 4] < 0.5 else 0.5
                if not _known(places, one, patch, at, count, margin):
                    _walked(cells, places, loops, one, i, x, found, patch, at, count, jet)
                    count += 1
                    if count > MOST_WALKS:
                        break


@njit(cache=True, nogil=True, error_model="numpy")
def _on_piece(
    rim: Any, cells: Any, piece: int, share: float, x: Floats, jet: Floats, slope: Floats
) -> tuple[float, float, float]:
    """Return distance, and first and second derivative of half its square, along a piece of a loop."""
    start, way, owner, breaks_u, breaks_v, span_u, span_v, first = rim
    k = owner[piece]
    u, v = start[piece, 0] + share * way[piece, 0], start[piece, 1] + share * way[piece, 1]
    i = np.searchsorted(breaks_u[span_u[k] : span_u[k + 1]], u, side="right") - 1
    j = np.searchsorted(breaks_v[span_v[k] : span_v[k + 1]], v, side="right") - 1
    i = min(max(i, 0), span_u[k + 1] - span_u[k] - 2)
    j = min(max(j, 0), span_v[k + 1] - span_v[k] - 2)
    c = first[k] + i * (span_v[k + 1] - span_v[k] - 1) + j
    centre, half = cells[6], cells[7]
    jet_at(cells[0], c, (u - centre[0, c]) / half[0, c], (v - centre[1, c]) / half[1, c], jet)
    a, b = way[piece, 0] / half[0, c], way[piece, 1] / half[1, c]
    square = along = bend = total = 0.0
    for m in range(3):
        away = jet[0, m] - x[m]
        slope[m] = a * jet[1, m] + b * jet[2, m]
        total += away * away
        along += away * slope[m]
        square += slope[m] * slope[m]
        bend += away * (a * a * jet[3, m] + 2 * a * b * jet[4, m] + b * b * jet[5, m])
    return math.sqrt(total), along, square + bend


@njit(cache=True, nogil=True, error_model="numpy")
def _nearest_on_piece(rim: Any, cells: Any, piece: int, x: Floats, jet: Floats, slope: Floats) -> tuple[float, float]:
    """Return where a piece of a loop is nearest to a point, 0 to 1, and how far it is there.

    A piece is so short that the distance along it has one extreme at most: a least one lies between ends from both of
    which it falls inwards, and Newton's method, kept between them, finds it.
    """
    first, fall, _ = _on_piece(rim, cells, piece, 0.0, x, jet, slope)
    last, rise, _ = _on_piece(rim, cells, piece, 1.0, x, jet, slope)
    if fall >= 0 or rise <= 0:
        return (0.0, first) if first <= last else (1.0, last)
    low, high, t, far = 0.0, 1.0, fall / (fall - rise), first
    for _ in range(NEWTON):
        far, along, second = _on_piece(rim, cells, piece, t, x, jet, slope)
        if along > 0:
            high = t
        else:
            low = t
        moved = t - along / second if second > 0 else np.inf
        if not low <= moved <= high:
            moved = (low + high) / 2
        step = abs(moved - t)
        t = moved
        if step <= REST:
            break
    return t, far


@njit(cache=True, nogil=True, error_model="numpy")
def _from_chord(a: Floats, b: Floats, x: Floats) -> float:
    """Return the distance of a point from a straight line between two others."""
    along = square = 0.0
    for k in range(3):
        along += (x[k] - a[k]) * (b[k] - a[k])
        square += (b[k] - a[k]) ** 2
    t, total = min(max(along / max(square, 1e-300), 0.0), 1.0), 0.0
    for k in range(3):
        total += (x[k] - a[k] - t * (b[k] - a[k])) ** 2
    return math.sqrt(total)


@njit(cache=True, nogil=True, error_model="numpy")
def rim_feet(
    cells: Any,
    rim: Any,
    tree: Any,
    ends: Floats,
    bent: Floats,
    target: Floats,
    piece: Ints,
    share: Floats,
    apart: Floats,
) -> None:
    """Write the nearest place on the loops to (n, 3) points: the piece, where on it (0 to 1), and how far.

    ``rim``: start and way of short pieces in the parameters of their patch, the patch, then the breaks of all patches
    in u and v, where those of each begin, and its first cell. No place of a piece is farther than ``bent`` from the
    chord of its ``ends``; ``tree``: order, nodes and leaves of a ball tree of their middles.
    """
    order, nodes, leaves = tree
    inner = len(nodes) // 2
    jet, slope, stack, away = np.empty((7, 4)), np.empty(3), np.empty(128, np.int64), np.empty(128)
    for i in range(len(target)):
        x = target[i]
        near = _near(order, nodes, leaves, x)
        share[i], apart[i] = _nearest_on_piece(rim, cells, near, x, jet, slope)
        piece[i] = near
        top = 1
        stack[0], away[0] = 0, _from(nodes, 0, x)
        while top:
            top -= 1
            node = stack[top]
            if away[top] - nodes[node, 3] >= apart[i]:
                continue
            if node < inner:
                top = _children(nodes, node, x, stack, away, top)
                continue
            for k in range(LEAF * (node - inner), LEAF * (node - inner + 1)):
                one = order[k]
                if one != piece[i] and _from_chord(ends[one, 0], ends[one, 1], x) - bent[one] < apart[i]:
                    t, far = _nearest_on_piece(rim, cells, one, x, jet, slope)
                    if far < apart[i]:
                        piece[i], share[i], apart[i] = one, t, far

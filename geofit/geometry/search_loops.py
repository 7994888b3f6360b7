"""Compiled: the search for the nearest of all feet, on a surface and along its trim loops, point by point.

Boxes of places (:mod:`geofit.geometry.box_tree`) show which walks may lead to a nearer foot; the bound is that of
:mod:`geofit.geometry.projection`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.geometry.box_tree import LEAF
from geofit.geometry.foot_loops import foot, jet_at
from geofit.geometry.foot_points import CONVEX

__all__ = ["explore_tree", "rim_feet"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: A place within so many lattice steps of a known foot belongs to its basin; walks for one point.
SAME_FOOT, MOST_WALKS = 1.6, 24
#: Steps of Newton's method along a piece of a loop, and the last one, of 0 to 1: it leaves an error near its square.
NEWTON, REST = 60, 1e-7

#: For what is called very often with many arrays: handing these over takes longer than the call's work.
inlined = njit(cache=True, nogil=True, error_model="numpy", forceinline=True)


@inlined
def _to_place(leaves: Floats, k: int, x: Floats) -> float:
    """Return the square of the distance of a point from a place in a leaf."""
    return float((leaves[k, 0] - x[0]) ** 2 + (leaves[k, 1] - x[1]) ** 2 + (leaves[k, 2] - x[2]) ** 2)


@inlined
def _to_box(nodes: Floats, node: int, x: Floats) -> float:
    """Return the square of the distance of a point from a box, 0 within it."""
    total = 0.0
    for k in range(3):
        off = max(nodes[node, k] - x[k], x[k] - nodes[node, k + 3], 0.0)
        total += off * off
    return total


@inlined
def _children(nodes: Floats, node: int, x: Floats, stack: Ints, off: Floats, top: int) -> int:
    """Put both halves of a box on the stack with the squares of their distances, the nearer one on top."""
    left = 2 * node + 1
    to_left, to_right = _to_box(nodes, left, x), _to_box(nodes, left + 1, x)
    nearer = 1 if to_left <= to_right else 0
    stack[top + nearer], off[top + nearer] = left, to_left
    stack[top + 1 - nearer], off[top + 1 - nearer] = left + 1, to_right
    return top + 2


@inlined
def _nearest_in_leaf(leaves: Floats, first: int, x: Floats) -> int:
    """Return the row of the place of a leaf that is nearest to a point."""
    found, best = first, np.inf
    for k in range(first, first + LEAF):
        off = _to_place(leaves, k, x)
        if off < best:
            found, best = k, off
    return found


@inlined
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


@inlined
def _known(places: Any, one: int, piece: Ints, at: Floats, count: int, margin: float) -> bool:
    """Whether a place is the start of a walk, or next to the foot of one: it leads to the same foot."""
    own, a, b = places[3][one], places[4][0, one], places[4][1, one]
    for m in range(count):
        if piece[m, 0] == own and max(abs(a - at[m, 0]), abs(b - at[m, 1])) < 0.5:
            return True
        if piece[m, 1] == own and max(abs(a - at[m, 2]), abs(b - at[m, 3])) <= margin:
            return True
    return False


@inlined
def _walked(
    cells: Any,
    places: Any,
    loops: Any,
    one: int,
    i: int,
    x: Floats,
    found: Any,
    piece: Ints,
    at: Floats,
    count: int,
    jet: Floats,
) -> None:
    """Walk from a place, note its basin, and keep its foot if it is nearer and inside the loops."""
    table, neighbour, noise, patch_of, origin, steps, centre, half, piece_of = cells
    apart, cell, local, done = found
    c, s, t, fine, far = foot(table, neighbour, noise, places[1][one], places[2][0, one], places[2][1, one], x, jet)
    piece[count, 0], piece[count, 1] = places[3][one], piece_of[c]
    at[count, 0], at[count, 1] = places[4][0, one], places[4][1, one]
    at[count, 2] = origin[0, c] + steps[0, c] * (s + 1) / 2
    at[count, 3] = origin[1, c] + steps[1, c] * (t + 1) / 2
    if far < apart[i] and _enclosed(loops, patch_of[c], centre[0, c] + half[0, c] * s, centre[1, c] + half[1, c] * t):
        apart[i], cell[i], local[0, i], local[1, i], done[i] = far, c, s, t, fine


@njit(cache=True, nogil=True, error_model="numpy")
def explore_tree(cells: Any, places: Any, tree: Any, loops: Any, target: Floats, known: Bools, found: Any) -> None:
    """Find feet inside the loops that are nearer to (n, 3) points than what is found already.

    ``cells``: table, neighbours, rounding error, patches, lattice origin and steps, centres, half widths and smooth
    pieces of the cells. ``places``: position, cell, local coordinates, smooth piece, lattice coordinates. ``tree``:
    order, nodes and leaves of a tree of boxes around them. ``loops``: which patches are trimmed, domains, where the
    sides of each strip begin in the list, the list, the sides. ``found``: distance (inf: nothing yet), cell, local
    coordinates, converged, overwritten. ``known`` marks points whose cell and local coordinates are a foot that counts
    as walked to, though it may lie outside the loops.
    """
    order, nodes, leaves = tree
    origin, steps, piece_of = cells[4], cells[5], cells[8]
    apart, cell, local = found[0], found[1], found[2]
    inner = len(nodes) // 2
    jet, stack, off = np.empty((7, 4)), np.empty(128, np.int64), np.empty(128)
    piece, at = np.empty((MOST_WALKS + 2, 2), np.int64), np.empty((MOST_WALKS + 2, 4))
    for i in range(len(target)):
        x, count = target[i], 0
        if known[i]:
            c = cell[i]
            piece[0, 0], piece[0, 1] = -1, piece_of[c]
            at[0, 2] = origin[0, c] + steps[0, c] * (local[0, i] + 1) / 2
            at[0, 3] = origin[1, c] + steps[1, c] * (local[1, i] + 1) / 2
            count = 1
        top = 1
        stack[0], off[0] = 0, 0.0
        while top and count <= MOST_WALKS:
            top -= 1
            node, best = stack[top], apart[i]
            if off[top] > best * best + nodes[node, 6] ** 2 * (1 + best * nodes[node, 7]):
                continue
            if node < inner:
                top = _children(nodes, node, x, stack, off, top)
                continue
            first = LEAF * (node - inner)
            if not count:
                one = order[_nearest_in_leaf(leaves, first, x)]
                _walked(cells, places, loops, one, i, x, found, piece, at, count, jet)
                count = 1
            for k in range(first, first + LEAF):
                best = apart[i]
                if _to_place(leaves, k, x) > best * best + leaves[k, 3] ** 2 * (1 + best * leaves[k, 4]):
                    continue
                one = order[k]
                # Within the radius of curvature the squared distance is convex around a foot.
                margin = SAME_FOOT if best * leaves[k, 4] < CONVEX else 0.5
                if not _known(places, one, piece, at, count, margin):
                    _walked(cells, places, loops, one, i, x, found, piece, at, count, jet)
                    count += 1
                    if count > MOST_WALKS:
                        break


@inlined
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


@inlined
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


@inlined
def _to_chord(ends: Floats, piece: int, x: Floats) -> float:
    """Return the square of the distance of a point from the straight line between the ends of a piece."""
    along = square = total = 0.0
    for k in range(3):
        side = ends[piece, 1, k] - ends[piece, 0, k]
        along += (x[k] - ends[piece, 0, k]) * side
        square += side * side
    t = min(max(along / max(square, 1e-300), 0.0), 1.0)
    for k in range(3):
        total += (x[k] - ends[piece, 0, k] - t * (ends[piece, 1, k] - ends[piece, 0, k])) ** 2
    return total


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
    chord of its ``ends``; ``tree``: order, nodes and leaves of a tree of boxes around them.
    """
    order, nodes, leaves = tree
    inner = len(nodes) // 2
    jet, slope, stack, off = np.empty((7, 4)), np.empty(3), np.empty(128, np.int64), np.empty(128)
    for i in range(len(target)):
        x = target[i]
        piece[i], apart[i] = -1, np.inf
        top = 1
        stack[0], off[0] = 0, 0.0
        while top:
            top -= 1
            node = stack[top]
            if off[top] >= apart[i] ** 2:
                continue
            if node < inner:
                top = _children(nodes, node, x, stack, off, top)
                continue
            first = LEAF * (node - inner)
            if piece[i] < 0:
                piece[i] = order[_nearest_in_leaf(leaves, first, x)]
                share[i], apart[i] = _nearest_on_piece(rim, cells, piece[i], x, jet, slope)
            for k in range(first, first + LEAF):
                one = order[k]
                if one != piece[i] and _to_chord(ends, one, x) < (apart[i] + bent[one]) ** 2:
                    t, far = _nearest_on_piece(rim, cells, one, x, jet, slope)
                    if far < apart[i]:
                        piece[i], share[i], apart[i] = one, t, far

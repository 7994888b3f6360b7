"""Cutting triangles along plan polygons, without cracks between neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["clip", "inside"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Cells of a raster along the longer side of an outline.
CELLS = 256
#: The corner after each corner of a triangle.
NEXT = [1, 2, 0]
#: Vertices nearer to the outline than this (metres) are on it.
ON = 1e-7


def clip(points: Floats, triangles: Ints, uv: Floats, *outlines: Floats) -> tuple[Floats, Ints, Ints, Floats]:
    """Return the part of a mesh over a plan polygon, or between several: one within another is a hole.

    Corners of the outlines become vertices first, then each of their sides cuts the triangles that it runs
    through. A new vertex belongs to the edge that it divides, so both triangles at the edge get the same one.

    Parameters
    ----------
    points : (n, 3) array
        Vertices, metres.
    triangles : (m, 3) array of int
        Their numbers; several may cover one location (an overturned fold).
    uv : (m, 3, 2) array
        Anything linear on each triangle, at its corners.
    outlines : (k, 2) arrays
        Corners of simple polygons, not closed, of which none crosses another.

    Returns
    -------
    points, triangles, parent, uv
        Vertices (the old ones first), triangles, the triangle that each comes from, its corners' ``uv``.
    """
    rings = [_distinct(outline) for outline in outlines]
    plan = np.ascontiguousarray(points[:, :2])
    corners = [plan[triangles[:, k]] for k in range(3)]
    candidates = [own for ring in rings for own in _touched(corners, ring)]
    touched = np.zeros(len(triangles), bool)
    touched[np.concatenate(candidates)] = True
    rest, near = np.flatnonzero(~touched), np.flatnonzero(touched)
    # Only the triangles along the outlines are worked on, with their own vertices.
    used, numbers = np.unique(triangles[near], return_inverse=True)
    work = _Work(points[used], numbers.reshape(-1, 3), uv[near])
    candidates = [np.searchsorted(near, own) for own in candidates]
    starts, ends = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    for corner, own in zip(starts, candidates, strict=True):
        work.insert(corner, own)
    for start, end, own in zip(starts, ends, candidates, strict=True):
        work.split(start, end, own)
    made = len(work.points) - len(used)
    back = np.concatenate([used, len(points) + np.arange(made)])
    every = np.concatenate([points, work.points[len(used) :]])
    cut = np.concatenate([triangles[rest], back[work.triangles]]).astype(np.int64)
    parent = np.concatenate([rest, near[work.parent]])
    # A triangle that no outline touches is inside where its corners are.
    sides = np.logical_xor.reduce([inside(ring, plan) for ring in rings])
    middle = every[cut[len(rest) :], :2].mean(axis=1)
    keep = np.concatenate([sides[triangles[rest, 0]], np.logical_xor.reduce([inside(ring, middle) for ring in rings])])
    return every, cut[keep], parent[keep], np.concatenate([uv[rest], work.uv])[keep]


def _touched(corners: list[Floats], outline: Floats) -> list[Ints]:
    """Return of each side of the outline the triangles, three times (m, 2), that it may run through: never too few."""
    a, b, c = corners
    low, high = np.minimum(np.minimum(a, b), c) - ON, np.maximum(np.maximum(a, b), c) + ON
    known = np.flatnonzero(_Raster(outline).near(low, high))
    # From south to north, so that the triangles along a side are a slice.
    known = known[np.argsort(low[known, 1], kind="stable")]
    low, high, plan = low[known], high[known], np.stack([a[known], b[known], c[known]], axis=1)
    tallest = float((high - low)[:, 1].max(initial=0.0))
    found = []
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        (x0, y0), (x1, y1) = np.minimum(start, end), np.maximum(start, end)
        own = slice(*np.searchsorted(low[:, 1], (y0 - tallest, y1 + ON)))
        some = own.start + np.flatnonzero((low[own, 0] <= x1) & (high[own, 0] >= x0) & (high[own, 1] >= y0))
        way = (end - start) / np.linalg.norm(end - start)
        off = (plan[some] - start) @ np.array([-way[1], way[0]])
        found.append(known[some[(off.min(axis=1) <= ON) & (off.max(axis=1) >= -ON)]])
    return found


class _Raster:
    """The cells of a grid that an outline runs through or next to: of many triangles it is far from nearly all."""

    def __init__(self, outline: Floats) -> None:
        self._low = outline.min(axis=0)
        self._cell = max(float(np.ptp(outline, axis=0).max()) / CELLS, 100 * ON)
        way = np.roll(outline, -1, axis=0) - outline
        # Places half a cell apart: what lies between two of them is in their cells or next to these.
        pieces = 1 + (2 * np.linalg.norm(way, axis=1) / self._cell).astype(np.int64)
        number = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        share = (number / np.repeat(pieces, pieces))[:, None]
        x, y = self._cells(np.repeat(outline, pieces, axis=0) + share * np.repeat(way, pieces, axis=0)).T
        marked = np.zeros((CELLS + 5, CELLS + 5), np.int64)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                marked[x + i, y + j] = 1
        self._sums = np.pad(marked.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))

    def _cells(self, plan: Floats) -> Ints:
        """Return the cells (n, 2) of places; those outside are at the rim, which no outline marks."""
        cells: Ints = np.clip((plan - self._low) / self._cell + 2, 0, CELLS + 4).astype(np.int64)
        return cells

    def near(self, low: Floats, high: Floats) -> NDArray[np.bool_]:
        """Which boxes, (n, 2) least and (n, 2) largest coordinates, have a marked cell."""
        (x0, y0), (x1, y1) = self._cells(low).T, self._cells(high).T + 1
        count = self._sums[x1, y1] - self._sums[x0, y1] - self._sums[x1, y0] + self._sums[x0, y0]
        return np.asarray(count > 0)


def inside(outline: Floats, plan: Floats) -> NDArray[np.bool_]:
    """Whether (n, 2) places are inside a polygon (k, 2), by the parity of crossings."""
    order = np.argsort(plan[:, 1], kind="stable")
    x, y = plan[order].T
    odd = np.zeros(len(plan), bool)
    for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if y0 != y1:
            # Of the places from south to north those beside this side of the polygon.
            beside = slice(*np.searchsorted(y, sorted((y0, y1))))
            odd[beside] ^= x[beside] < x0 + (y[beside] - y0) * ((x1 - x0) / (y1 - y0))
    found = np.empty(len(plan), bool)
    found[order] = odd
    return found


def _distinct(outline: Floats) -> Floats:
    apart = np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1) > ON
    return np.asarray(outline[apart])


class _Rows:
    """An array that grows row by row, by doubling its room."""

    def __init__(self, start: NDArray[Any]) -> None:
        self._room, self._count = start.copy(), len(start)

    @property
    def filled(self) -> NDArray[Any]:
        return self._room[: self._count]

    def add(self, row: NDArray[Any]) -> None:
        self.extend(row[None])

    def extend(self, rows: NDArray[Any]) -> None:
        count = self._count + len(rows)
        if count > len(self._room):
            self._room = np.concatenate([self._room, np.empty((count, *rows.shape[1:]), self._room.dtype)])
        self._room[self._count : count] = rows
        self._count = count


class _Work:
    """A mesh while it is being cut."""

    def __init__(self, points: Floats, triangles: Ints, uv: Floats) -> None:
        self._points, self._triangles, self._uv = _Rows(points), _Rows(triangles), _Rows(uv)
        self._parent = _Rows(np.arange(len(triangles)))
        self._marked = np.zeros(len(triangles), bool)

    def _pieces(self, parents: Ints) -> Ints:
        """Return what is left of triangles of the start."""
        self._marked[parents] = True
        pieces = np.flatnonzero(self._marked[self.parent])
        self._marked[parents] = False
        return pieces

    @property
    def points(self) -> Floats:
        return self._points.filled

    @property
    def triangles(self) -> Ints:
        return self._triangles.filled

    @property
    def uv(self) -> Floats:
        return self._uv.filled

    @property
    def parent(self) -> Ints:
        return self._parent.filled

    def insert(self, corner: Floats, candidates: Ints) -> None:
        """Make a corner of the outline a vertex of every sheet over it; only ``candidates`` may hold it."""
        pieces = self._pieces(candidates)
        corners = self.points[self.triangles[pieces], :2]
        near = (corners.min(axis=1) - ON <= corner).all(axis=1) & (corners.max(axis=1) + ON >= corner).all(axis=1)
        divided: dict[tuple[int, int], int] = {}
        for k, plan in zip(pieces[near], corners[near], strict=True):
            distance, share = _heights(plan, corner)
            if distance is None or distance.min() < -ON:
                continue
            if np.linalg.norm(plan - corner, axis=1).min() <= ON:
                continue
            close = int(np.argmin(distance))
            if distance[close] <= ON:
                # On an edge: its two triangles are halved at one vertex.
                i, j = (close + 1) % 3, (close + 2) % 3
                a, b = int(self.triangles[k, i]), int(self.triangles[k, j])
                t = share[j] / (share[i] + share[j])
                key = (min(a, b), max(a, b))
                if key not in divided:
                    divided[key] = self._new(self.points[a] + t * (self.points[b] - self.points[a]), corner)
                self._halve(int(k), i, j, divided[key], t)
            else:
                number = self._new(share @ self.points[self.triangles[k]], corner)
                self._fan(int(k), number, share)

    def split(self, start: Floats, end: Floats, candidates: Ints) -> None:
        """Cut triangles along one side of the outline; ``candidates`` are those that it may run through."""
        length = np.linalg.norm(end - start)
        direction = (end - start) / length
        pieces = self._pieces(candidates)
        x, y = np.moveaxis(self.points[self.triangles[pieces], :2] - start, 2, 0)
        offs, alongs = direction[0] * y - direction[1] * x, direction[0] * x + direction[1] * y
        signs = np.where(np.abs(offs) <= ON, 0, np.sign(offs)).astype(int)
        crossed = (signs.min(axis=1) < 0) & (signs.max(axis=1) > 0)
        crossed &= (alongs.max(axis=1) > 0) & (alongs.min(axis=1) < length)
        pieces, signs, offs, alongs = pieces[crossed], signs[crossed], offs[crossed], alongs[crossed]
        cutting = signs * signs[:, NEXT] < 0
        t = np.divide(offs, offs - offs[:, NEXT], out=np.zeros_like(offs), where=cutting)
        # Of each triangle the side enters and leaves through two edges, or through an edge and a corner.
        ends = np.where(cutting, alongs + t * (alongs[:, NEXT] - alongs), 0.0) + np.where(signs == 0, alongs, 0.0)
        middle = 0.5 * ends.sum(axis=1)
        within = (middle > 0) & (middle < length)
        self._cut(pieces[within], cutting[within], offs[within])

    def _cut(self, crossed: Ints, cutting: NDArray[np.bool_], offs: Floats) -> None:
        """Divide triangles at the one or two edges, (m, 3), along which ``offs``, at their corners, change sign."""
        row, edge = np.nonzero(cutting)
        numbers = self.triangles[crossed[row]]
        a, b = (numbers[np.arange(len(row)), corner % 3] for corner in (edge, edge + 1))
        low, high = np.minimum(a, b), np.maximum(a, b)
        # Both triangles at an edge get one vertex.
        _, first, which = np.unique(low * len(self.points) + high, return_index=True, return_inverse=True)
        known = np.sort(first)
        off_a, off_b = offs[row, edge], offs[row, (edge + 1) % 3]
        off_low, off_high = np.where(a == low, off_a, off_b), np.where(a == low, off_b, off_a)
        t = off_low / (off_low - off_high)
        start, end = self.points[low[known]], self.points[high[known]]
        number = len(self.points) + np.searchsorted(known, first)[which]
        self._points.extend(start + t[known, None] * (end - start))
        from_low = np.where(a == low, edge, (edge + 1) % 3)
        to_high = np.where(a == low, (edge + 1) % 3, edge)
        second = np.flatnonzero(np.diff(row, prepend=-1) == 0)
        one = np.flatnonzero(np.diff(row, prepend=-1) != 0)
        new = len(self.triangles) + np.arange(len(row))
        for rows in (self._triangles, self._uv, self._parent):
            rows.extend(rows.filled[crossed[row]])
        self._halve_all(crossed[row[one]], new[one], from_low[one], to_high[one], number[one], t[one])
        # The second edge is of the half that kept the corner of both edges.
        before = low[second - 1]
        kept = (before == a[second]) | (before == b[second])
        piece = np.where(kept, crossed[row[second]], new[second - 1])
        for rows in (self._triangles, self._uv, self._parent):
            rows.filled[new[second]] = rows.filled[piece]
        self._halve_all(piece, new[second], from_low[second], to_high[second], number[second], t[second])

    def _halve_all(self, k: Ints, new: Ints, i: Ints, j: Ints, number: Ints, t: Floats) -> None:
        """Divide triangles k at vertices on their edges (i, j), at t from i; ``new`` are copies of them."""
        triangles, corners = self.triangles, self.uv
        uv = corners[k, i] + t[:, None] * (corners[k, j] - corners[k, i])
        triangles[k, j] = triangles[new, i] = number
        corners[k, j] = corners[new, i] = uv

    def _new(self, point: Floats, plan: Floats | None = None) -> int:
        point = np.array(point)
        if plan is not None:
            point[:2] = plan
        self._points.add(point)
        return len(self.points) - 1

    def _halve(self, k: int, i: int, j: int, number: int, t: float) -> int:
        """Divide triangle k at a vertex on its edge (i, j), at t from i; return the number of the new half."""
        self._copy(k, 1)
        triangles, corners = self.triangles, self.uv
        uv = corners[k, i] + t * (corners[k, j] - corners[k, i])
        triangles[k, j] = triangles[-1, i] = number
        corners[k, j] = corners[-1, i] = uv
        return len(triangles) - 1

    def _fan(self, k: int, number: int, share: Floats) -> None:
        """Divide triangle k into three at a vertex inside it."""
        uv = share @ self.uv[k]
        self._copy(k, 2)
        for place, corner in ((k, 0), (-1, 1), (-2, 2)):
            self.triangles[place, corner] = number
            self.uv[place, corner] = uv

    def _copy(self, k: int, times: int) -> None:
        for _ in range(times):
            for rows in (self._triangles, self._uv, self._parent):
                rows.add(rows.filled[k])


def _heights(triangle: Floats, place: Floats) -> tuple[Floats | None, Floats]:
    """Return the distances (m, positive inside) of a place from the three edges in plan, and its barycentric shares.

    None where the triangle stands upright.
    """
    a, b, c = triangle
    area = _cross(b - a, c - a)
    sides = np.array([np.linalg.norm(c - b), np.linalg.norm(a - c), np.linalg.norm(b - a)])
    if abs(area) <= ON * sides.max():
        return None, np.zeros(3)
    share = np.array([_cross(b - place, c - place), _cross(c - place, a - place), _cross(a - place, b - place)]) / area
    return share * abs(area) / sides, share


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])

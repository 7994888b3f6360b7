"""Nearest places of trimmed patches to very many points: compiled searches along the loops and within them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.threads import side_by_side
from geofit.geometry.box_tree import BoxTree
from geofit.geometry.foot_points import Projection
from geofit.geometry.projection import Searchable, searchable
from geofit.splines.patch import Patch

__all__ = ["Pieces", "TrimSearch"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Loops = tuple[tuple[Floats, ...], ...]

#: Strips of v in which the sides of a patch's loops are listed.
STRIPS = 512


@dataclass(frozen=True, eq=False)
class Pieces:
    """Short pieces of loops, straight in the parameters.

    ``start`` and ``way`` (n, 2) in the parameters of ``patch`` (n,); no place of a piece is farther than ``reach`` (n,)
    metres from its ``middle`` (n, 3), nor than ``bent`` (n,) from the chord of its ``ends`` (n, 2, 3).
    """

    start: Floats
    way: Floats
    patch: Ints
    middle: Floats
    reach: Floats
    ends: Floats
    bent: Floats


class TrimSearch:
    """Trimmed patches with what compiled loops take of them.

    Parameters
    ----------
    patches : sequence of Patch
        The surface.
    loops : Loops
        Trim loops of each patch.
    pieces : Pieces
        The loops in short pieces.
    inside : (places,) array of bool
        Which places of the patches' search lattice are on the face.
    """

    def __init__(self, patches: Sequence[Patch], loops: Loops, pieces: Pieces, inside: Bools) -> None:
        self.surface: Searchable = searchable(patches)
        self.pieces = pieces
        none = np.zeros(len(pieces.start))
        self._rim_tree = BoxTree.of(pieces.middle, pieces.reach, none, none).arrays
        breaks = self.surface.cells.breaks
        ends = [np.cumsum([0, *(len(pair[axis]) for pair in breaks)]) for axis in (0, 1)]
        knots = [np.concatenate([pair[axis] for pair in breaks]) for axis in (0, 1)]
        self._rim = (pieces.start, pieces.way, pieces.patch, *knots, *ends, self.surface.cells.first)
        self._loops = _strips(patches, loops)
        # A foot within the loops is within one step of a place there: no farther than twice half the spacing.
        self._places = self.surface.some_places(np.flatnonzero(inside | self._slivers(inside)), 2.0)

    def _slivers(self, inside: Bools) -> Bools:
        """Mark the places around those pieces of loops that have no place of the face around them."""
        surface, marked = self.surface, np.zeros(len(inside), bool)
        middle = self.pieces.start + self.pieces.way / 2
        for k in np.unique(self.pieces.patch):
            own = np.flatnonzero(surface.patch == k)
            mine = self.pieces.patch == k
            place = surface.cells.locate(int(k), *middle[mine].T)
            at = surface.cell_origin[:, place.cell] + surface.cell_steps[:, place.cell] * (place.local + 1) / 2
            shape = surface.lattice[:, own].max(axis=1).astype(int) + 1
            low = np.minimum(at.astype(np.int64), (shape - 2)[:, None])
            corners = np.stack([own[(low[0] + a) * shape[1] + low[1] + b] for a in (0, 1) for b in (0, 1)], axis=1)
            marked[corners[~inside[corners].any(axis=1)].ravel()] = True
        return marked

    def nearest(self, target: Floats, beyond: Projection) -> tuple[Projection, Bools]:
        """Return the nearest places on the face to (n, 3) points whose feet on the patches, ``beyond``, are off it.

        Also which of them are on the loops.
        """
        from geofit.geometry.search_loops import rim_feet

        surface, pieces, n = self.surface, self.pieces, len(target)
        piece, share, rim = np.empty(n, np.int64), np.empty(n), np.empty(n)

        def along(some: slice) -> None:
            rim_feet(
                surface.of_cells,
                self._rim,
                self._rim_tree,
                pieces.ends,
                pieces.bent,
                target[some],
                piece[some],
                share[some],
                rim[some],
            )

        side_by_side(along, n)
        cell, local = np.empty(n, np.int64), np.empty((2, n))
        for k in np.unique(beyond.patch):
            own = np.flatnonzero(beyond.patch == k)
            place = surface.cells.locate(int(k), beyond.u[own], beyond.v[own])
            cell[own], local[:, own] = place.cell, place.local
        apart = rim.copy()
        surface.explore(target, np.ones(n, bool), (apart, cell, local, np.ones(n, bool)), self._loops, self._places)
        on_rim = apart >= rim
        place = surface.place_at(cell, local)
        u, v = surface.cells.parameters(place)
        on_loop = pieces.start[piece] + share[:, None] * pieces.way[piece]
        patch = np.where(on_rim, pieces.patch[piece], surface.cells.patch[cell])
        u, v = np.where(on_rim, on_loop[:, 0], u), np.where(on_rim, on_loop[:, 1], v)
        foot = np.empty((n, 3))
        for k in np.unique(patch):
            own = np.flatnonzero(patch == k)
            foot[own] = surface.cells.points(surface.cells.locate(int(k), u[own], v[own])).T
        return Projection(apart, foot, patch, u, v, np.ones(n, bool)), on_rim


def _strips(patches: Sequence[Patch], loops: Loops) -> tuple[Any, ...]:
    """List the sides of each patch's loops by strips of v, as compiled loops take them."""
    trimmed = np.array([bool(own) for own in loops])
    domain = np.array([patch.domain for patch in patches])
    begins, listed, sides, count, known = [], [], [], 0, 0
    for own, (_, _, low, high) in zip(loops, domain, strict=True):
        each = [np.column_stack([loop, np.roll(loop, -1, axis=0)]) for loop in own]
        side = np.concatenate([np.empty((0, 4)), *each])
        ends = np.sort(side[:, [1, 3]], axis=1)
        first, last = np.clip(((ends - low) / (high - low) * STRIPS).astype(np.int64), 0, STRIPS - 1).T
        # One strip more on both sides: a side on a border counts in both.
        first, last = np.maximum(first - 1, 0), np.minimum(last + 1, STRIPS - 1)
        reach = last - first + 1
        strip = np.repeat(first, reach) + np.arange(reach.sum()) - np.repeat(np.cumsum(reach) - reach, reach)
        order = np.argsort(strip, kind="stable")
        listed.append(known + np.repeat(np.arange(len(side)), reach)[order])
        begins.append(count + np.searchsorted(strip[order], np.arange(STRIPS + 1)))
        sides.append(side)
        count, known = count + len(order), known + len(side)
    return trimmed, domain, np.array(begins), np.concatenate(listed), np.concatenate(sides)

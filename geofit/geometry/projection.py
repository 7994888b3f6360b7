"""Orthogonal distance from points to a surface of many patches (the d_i of eq. 3).

Points near to a height field have foot points that need no search (:mod:`geofit.geometry.foot_points`). For the
others a KD-tree of places on the surface gives the starts, :func:`geofit.geometry.cells.refine_foot_points` walks
down from them.
The nearest place of the tree need not lie in the basin of the nearest foot point: a foot point at distance d with a
tree place e metres from it has that place within sqrt(d^2 + e^2 (1 + d kappa)) of the point, kappa the curvature there.
So every tree place within that reach, and not near a foot point that is known already, starts another walk.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from geofit.data.threads import side_by_side
from geofit.geometry.box_tree import BoxTree, neighbours_together
from geofit.geometry.cells import Cells, Place, refine_foot_points, tabulate
from geofit.geometry.elevation import plan_map
from geofit.geometry.foot_points import CONVEX, Projection, creases, foot_points_over_plan
from geofit.splines.patch import Patch, Patches

__all__ = ["COMPILED", "Projection", "Searchable", "project", "searchable"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Places of the tree that are looked at first, and at most, for each point.
FIRST_LOOK, LAST_LOOK = 8, 512
#: Wanted number of places in the tree, and the steps of a span.
PLACES, MOST_STEPS = 16_000, 16
#: A tree place within so many lattice steps of a known foot belongs to that foot's basin.
SAME_FOOT = 1.6
MOST_WALKS = 24
#: Points that are searched for together (memory), and from how many on compiled loops are worth loading.
CHUNK, COMPILED = 20_000, 5_000


def project(patches: Sequence[Patch], xyz: ArrayLike) -> Projection:
    """Find the nearest place of a surface to each point, and the signed orthogonal distance.

    A point beside the surface has its foot on the outer edge. The upper side is the side of S_u x S_v, or of
    its opposite if the mean of S_u x S_v over all patches points downwards: above, for a height field. A
    vertical surface has its upper side towards growing y, or else growing x. Patches of one surface are
    expected to run the same way (neighbours with normals on one side).

    Parameters
    ----------
    patches : sequence of Patch
        The surface.
    xyz : (n, 3) array_like
        Points in the patches' coordinates (map coordinates minus the surface's origin), metres.

    Returns
    -------
    Projection
        Distances, feet and parameters.

    Notes
    -----
    Newton's method with second derivatives on piecewise polynomials; see *The NURBS Book*, sec. 6.1. The foot
    is the nearest of all as long as no two feet of a point lie within one step of the search lattice (half a
    span or less): farther from the surface than its radius of curvature, on a wiggle of a single span, a foot
    some millimetres farther may be returned (3 of 100,000 points at three times that radius).
    """
    target = np.asarray(xyz, float).reshape(-1, 3)
    found = foot_points_over_plan(patches, target)
    rest = np.flatnonzero(~found.converged)
    if len(rest):
        found.fill(rest, foot_points_by_search(patches, target[rest]))
    return found


def foot_points_by_search(patches: Sequence[Patch], target: Floats) -> Projection:
    """Find the nearest places by walks from all places that may lead to them."""
    surface = searchable(patches)
    if len(target) >= COMPILED:
        feet = surface.feet(target)
    else:
        feet = Place.join([_nearest(surface, target[k : k + CHUNK]) for k in range(0, max(len(target), 1), CHUNK)])
    feet = _no_farther_than_below(patches, surface.cells, target, feet)
    s, ds, dt, *_ = surface.cells.jets(feet)
    normal = np.cross(ds.T, dt.T) * surface.upwards
    away = target - s.T
    below = np.einsum("nk,nk->n", away, normal) < 0
    distance = np.linalg.norm(away, axis=1)
    u, v = surface.cells.parameters(feet)
    return Projection(
        distance=np.where(below, -distance, distance),
        foot=np.ascontiguousarray(s.T),
        patch=surface.cells.patch[feet.cell],
        u=u,
        v=v,
        converged=feet.converged,
    )


def _no_farther_than_below(patches: Sequence[Patch], cells: Cells, target: Floats, feet: Place) -> Place:
    """Walk again from the place above or below a point of a height field, where that is nearer than its foot.

    Between points that pull it up and down within a span, a surface has more feet than the search finds.
    """
    found = np.linalg.norm(target - cells.points(feet).T, axis=1)
    for index, patch in enumerate(patches):
        mapping = plan_map(patch)
        if mapping is None:
            continue
        u, v = mapping.parameters(target[:, :2].T)
        u0, u1, v0, v1 = patch.domain
        over = np.flatnonzero((u >= u0) & (u <= u1) & (v >= v0) & (v <= v1))
        if not len(over):
            continue
        below = cells.locate(index, u[over], v[over])
        nearer = np.abs(target[over, 2] - cells.points(below)[2]) < found[over] - 1e-12
        if nearer.any():
            again = refine_foot_points(cells, below[nearer], target[over[nearer]].T)
            cell, local, converged = feet.cell.copy(), feet.local.copy(), feet.converged.copy()
            cell[over[nearer]], local[:, over[nearer]] = again.cell, again.local
            converged[over[nearer]] = again.converged
            feet = Place(cell, local, converged)
            found[over[nearer]] = np.linalg.norm(target[over[nearer]] - cells.points(again).T, axis=1)
    return feet


@dataclass(frozen=True, eq=False)
class Searchable:
    """Patches with a tree of places: their lattice rows and columns, half spacing (m) and curvature (1/m).

    ``piece`` (cells,): the number of the smooth piece, between creases of a patch, to which a cell belongs. A point may
    have two feet close to each other on both sides of a crease.
    """

    cells: Cells
    tree: cKDTree
    place: Place
    patch: Ints
    lattice: Floats
    spacing: Floats
    curvature: Floats
    piece: Ints
    # Lattice coordinates of the cells: origin (2, cells) and steps a cell (2, cells).
    cell_origin: Floats
    cell_steps: Floats
    upwards: float

    def feet(self, target: Floats) -> Place:
        """Return the nearest places to (n, 3) points by compiled loops."""
        apart, done = np.full(len(target), np.inf), np.zeros(len(target), bool)
        cell, local = np.zeros(len(target), np.int64), np.zeros((2, len(target)))
        order, back = neighbours_together(target)
        self.explore(
            target[order], done.copy(), (apart, cell, local, done), untrimmed_patches(len(self.cells.breaks)),
            self.balls,
        )  # fmt: skip
        return Place(cell[back], local[:, back], done[back])

    def explore(
        self, target: Floats, known: Bools, found: tuple[Floats, Ints, Floats, Bools], loops: Any, places: Any
    ) -> None:
        """Look for nearer feet inside loops; see :func:`geofit.geometry.search_loops.explore_tree`."""
        from geofit.geometry.search_loops import explore_tree

        points, (apart, cell, local, done) = np.ascontiguousarray(target), found
        some_places, tree = places

        def work(some: slice) -> None:
            part = (apart[some], cell[some], local[:, some], done[some])
            explore_tree(self.of_cells, some_places, tree, loops, points[some], known[some], part)

        side_by_side(work, len(target))

    def place_at(self, cell: Ints, local: Floats) -> Place:
        """Return places by their cells and local coordinates."""
        return Place(cell, local)

    @property
    def of_cells(self) -> tuple[Any, ...]:
        """The cells as compiled loops take them."""
        c = self.cells
        return (
            c.table, c.neighbour, c.noise, c.patch, self.cell_origin, self.cell_steps, c.centre, c.half, self.piece,
        )  # fmt: skip

    @cached_property
    def balls(self) -> tuple[Any, Any]:
        """All places and a tree of boxes of them as compiled loops take them."""
        return self.some_places(np.arange(self.tree.n), 1.0)

    def some_places(self, rows: Ints, wider: float) -> tuple[Any, Any]:
        """Return some places, each for so many times its spacing, and a tree of boxes of them."""
        points, spacing, curvature = self.tree.data[rows], wider * self.spacing[rows], self.curvature[rows]
        tree = BoxTree.of(points, np.zeros(len(rows)), spacing, curvature)
        local, lattice = (np.ascontiguousarray(values[:, rows]) for values in (self.place.local, self.lattice))
        cell = self.place.cell[rows]
        return (points, cell, local, self.piece[cell], lattice), tree.arrays


def untrimmed_patches(patches: int) -> tuple[Any, ...]:
    """Return the loops of patches that have none, as compiled loops take them."""
    return (
        np.zeros(patches, bool),
        np.zeros((patches, 4)),
        np.zeros((patches, 2), np.int64),
        np.zeros(0, np.int64),
        np.zeros((0, 4)),
    )


def searchable(patches: Sequence[Patch]) -> Searchable:
    """Return patches with what a search for foot points needs; it is made once."""
    return Patches.of(patches).prepared(_prepare)


def _prepare(patches: Patches) -> Searchable:
    cells = tabulate(patches)
    parts = [_lattice(cells, index, len(patches)) for index in range(len(patches))]
    place = Place(np.concatenate([p.place.cell for p in parts]), np.concatenate([p.place.local for p in parts], axis=1))
    area = np.sum([p.area for p in parts], axis=0)
    size = np.abs(area).max()
    upwards = next((float(np.sign(c)) for c in (area[2], area[1], area[0]) if abs(c) > 1e-9 * size), 1.0)
    lattice = np.concatenate([p.lattice for p in parts], axis=1)
    piece = _pieces(patches)
    rows, place = _both_sides(cells, place, piece)
    return Searchable(
        cells=cells,
        tree=cKDTree(np.concatenate([p.points for p in parts])[rows]),
        place=place,
        patch=cells.patch[place.cell],
        lattice=lattice[:, rows],
        spacing=np.concatenate([p.spacing for p in parts])[rows],
        curvature=np.concatenate([p.curvature for p in parts])[rows],
        piece=piece,
        cell_origin=np.concatenate([p.cell_origin for p in parts], axis=1),
        cell_steps=np.concatenate([p.cell_steps for p in parts], axis=1),
        upwards=upwards,
    )


def _pieces(patches: Patches) -> Ints:
    """Return the number of the smooth piece of each cell."""
    found, count = [], 0
    for patch in patches:
        u, v = (
            np.cumsum(creases(knots, p)) for knots, p in zip((patch.knots_u, patch.knots_v), patch.degree, strict=True)
        )
        found.append(count + (u[:, None] * (v[-1] + 1) + v).ravel())
        count = found[-1][-1] + 1
    return np.concatenate(found)


def _both_sides(cells: Cells, place: Place, piece: Ints) -> tuple[Ints, Place]:
    """Add the places on creases once more, as places of the cells on the lower side; also return which each is.

    Walks from both sides of a crease lead to different feet. The added ones come last.
    """
    rows = np.arange(len(place.cell))
    for axis in (0, 1):
        behind = np.where(place.local[axis] == -1, cells.neighbour[2 * axis, place.cell], -1)
        on_crease = np.flatnonzero((behind >= 0) & (piece[behind] != piece[place.cell]))
        local = place.local[:, on_crease].copy()
        local[axis] = 1.0
        joined = np.concatenate([place.cell, behind[on_crease]]), np.concatenate([place.local, local], axis=1)
        place, rows = Place(*joined), np.concatenate([rows, rows[on_crease]])
    return rows, place


@dataclass(frozen=True, eq=False)
class _Lattice:
    place: Place
    points: Floats
    lattice: Floats
    spacing: Floats
    curvature: Floats
    cell_origin: Floats
    cell_steps: Floats
    area: Floats


def _lattice(cells: Cells, patch: int, patches: int) -> _Lattice:
    """Lay places over a patch: on every knot line (creases and edges are met), and evenly between."""
    bu, bv = cells.breaks[patch]
    corners = _grid(cells, patch, bu, bv)[1].reshape(len(bu), len(bv), 3)
    length_u = np.linalg.norm(np.diff(corners, axis=0), axis=2).max(axis=1)
    length_v = np.linalg.norm(np.diff(corners, axis=1), axis=2).max(axis=0)
    wanted = np.sqrt(max(length_u.sum() * length_v.sum(), 1e-30) / (PLACES / patches))
    least = 2 if len(bu) * len(bv) > 64 else 6
    steps_u = np.clip(np.ceil(length_u / wanted), least, MOST_STEPS).astype(int)
    steps_v = np.clip(np.ceil(length_v / wanted), least, MOST_STEPS).astype(int)
    place, points, jets = _grid(cells, patch, _subdivide(bu, steps_u), _subdivide(bv, steps_v))
    nu, nv = steps_u.sum() + 1, steps_v.sum() + 1
    grid = points.reshape(nu, nv, 3)
    diagonal = np.maximum(
        np.linalg.norm(grid[1:, 1:] - grid[:-1, :-1], axis=2),
        np.linalg.norm(grid[1:, :-1] - grid[:-1, 1:], axis=2),
    )
    spacing = np.pad(diagonal / 2, 1)
    around = np.stack([spacing[1:, 1:], spacing[:-1, 1:], spacing[1:, :-1], spacing[:-1, :-1]]).max(axis=0)
    normal = np.cross(jets[1].T, jets[2].T)
    span_u, span_v = np.diff(bu), np.diff(bv)
    rows, columns = np.concatenate([[0], np.cumsum(steps_u)]), np.concatenate([[0], np.cumsum(steps_v)])
    share = np.prod(cells.half[:, place.cell], axis=0)
    return _Lattice(
        place=place,
        points=points,
        lattice=np.stack([np.repeat(np.arange(nu), nv), np.tile(np.arange(nv), nu)]).astype(float),
        spacing=around.ravel(),
        curvature=_curvature(jets, normal),
        cell_origin=np.stack([np.repeat(rows[:-1], len(span_v)), np.tile(columns[:-1], len(span_u))]).astype(float),
        cell_steps=np.stack([np.repeat(steps_u, len(span_v)), np.tile(steps_v, len(span_u))]).astype(float),
        area=np.asarray((normal / share[:, None]).sum(axis=0) / len(normal)),
    )


def _grid(cells: Cells, patch: int, u: Floats, v: Floats) -> tuple[Place, Floats, list[Floats]]:
    place = cells.locate(patch, np.repeat(u, len(v)), np.tile(v, len(u)))
    jets = cells.jets(place)
    return place, np.ascontiguousarray(jets[0].T), jets


def _subdivide(breaks: Floats, steps: Ints) -> Floats:
    parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(breaks[:-1], breaks[1:], steps, strict=True)]
    return np.concatenate([*parts, breaks[-1:]])


def _curvature(jets: list[Floats], normal: Floats) -> Floats:
    """Largest principal curvature |H| + sqrt(H^2 - K); 0 where the patch is degenerate."""
    _, ds, dt, dss, dst, dtt = jets
    e, f, g = ((a * b).sum(axis=0) for a, b in ((ds, ds), (ds, dt), (dt, dt)))
    length = np.linalg.norm(normal, axis=1)
    regular = length > 1e-9 * np.maximum(e, g)
    unit = (normal / np.where(regular, length, 1)[:, None]).T
    l_, m, n = ((a * unit).sum(axis=0) for a in (dss, dst, dtt))
    det = np.where(regular, e * g - f * f, 1.0)
    mean, gauss = (e * n - 2 * f * m + g * l_) / (2 * det), (l_ * n - m * m) / det
    bound = np.abs(mean) + np.sqrt(np.maximum(mean**2 - gauss, 0))
    return np.asarray(np.where(regular, bound, 0.0))


def _nearest(surface: Searchable, target: Floats) -> Place:
    """Feet of the points: the best of all the walks that could lead to the nearest place."""
    count = min(FIRST_LOOK, surface.tree.n)
    reach, near = _look(surface.tree, target, count)
    best = _walk(surface, near[:, 0], target)
    known = [_basin(surface, near[:, 0], best.place)]
    todo = np.arange(len(target))
    while todo.size:
        _explore(surface, target, best, known, todo, reach, near)
        distance = best.distance[todo]
        widest = surface.spacing.max() ** 2 * (1 + distance * surface.curvature.max())
        unseen = reach[:, -1] ** 2 <= distance**2 + widest
        count = min(count * 4, LAST_LOOK, surface.tree.n)
        if count <= reach.shape[1]:
            break
        todo = todo[unseen]
        reach, near = _look(surface.tree, target[todo], count)
    return best.place


def _explore(
    surface: Searchable,
    target: Floats,
    best: _Walks,
    known: list[_Basin],
    todo: Ints,
    reach: Floats,
    near: Ints,
) -> None:
    """Walk from every tree place that may hide a nearer foot, nearest first; ``best`` and ``known`` grow."""
    pairs = _Pairs(np.repeat(todo, near.shape[1]), near.ravel(), reach.ravel())
    pairs = pairs[pairs.within(surface, best.distance)]
    for basin in known:
        pairs = pairs[~pairs.settled(surface, basin, best.distance)]
    for _ in range(MOST_WALKS):
        if not pairs.point.size:
            return
        index, nearest = np.unique(pairs.point, return_index=True)
        start = pairs.place[nearest]
        walks = _walk(surface, start, target[index])
        best.better(index, walks)
        basin = _basin(surface, start, walks.place).spread(index, len(target))
        known.append(basin)
        pairs = pairs[pairs.within(surface, best.distance)]
        pairs = pairs[~pairs.settled(surface, basin, best.distance)]


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Points with tree places near to them: indices of both, and how far they are apart; nearest first."""

    point: Ints
    place: Ints
    reach: Floats

    def __getitem__(self, mask: Bools) -> _Pairs:
        return _Pairs(self.point[mask], self.place[mask], self.reach[mask])

    def within(self, surface: Searchable, distance: Floats) -> Bools:
        """Which places may have a foot beside them that is nearer than ``distance``."""
        d = distance[self.point]
        room = surface.spacing[self.place] ** 2 * (1 + d * surface.curvature[self.place])
        return np.asarray(self.reach**2 <= d**2 + room)

    def settled(self, surface: Searchable, basin: _Basin, distance: Floats) -> Bools:
        """Which places are next to the start or the foot of a walk: they lead to the same foot.

        Where the squared distance is not convex around the foot two feet may be close together, and only the very
        same place is left out.
        """
        piece, lattice = surface.piece[surface.place.cell[self.place]], surface.lattice[:, self.place]
        walk = basin[self.point]
        at_start = (piece == walk.piece) & (np.abs(lattice - walk.start) < 0.5).all(axis=0)
        convex = distance[self.point] * surface.curvature[self.place] < CONVEX
        margin = np.where(convex, SAME_FOOT, 0.5)
        at_foot = (piece == walk.foot_piece) & (np.abs(lattice - walk.foot).max(axis=0) <= margin)
        return np.asarray(at_start | at_foot)


@dataclass(frozen=True, eq=False)
class _Basin:
    """What a walk has settled for each point: smooth piece (-1: none) and lattice coordinates of start and foot."""

    piece: Ints
    start: Floats
    foot_piece: Ints
    foot: Floats

    def __getitem__(self, index: Ints) -> _Basin:
        return _Basin(self.piece[index], self.start[:, index], self.foot_piece[index], self.foot[:, index])

    def spread(self, index: Ints, count: int) -> _Basin:
        """Return the same for ``count`` points, of which ``index`` have walked."""
        piece, start = np.full(count, -1), np.zeros((2, count))
        foot_piece, foot = piece.copy(), start.copy()
        piece[index], start[:, index] = self.piece, self.start
        foot_piece[index], foot[:, index] = self.foot_piece, self.foot
        return _Basin(piece, start, foot_piece, foot)


def _basin(surface: Searchable, start: Ints, foot: Place) -> _Basin:
    cell = foot.cell
    lattice = surface.cell_origin[:, cell] + surface.cell_steps[:, cell] * (foot.local + 1) / 2
    of_start = surface.piece[surface.place.cell[start]]
    return _Basin(of_start, surface.lattice[:, start], surface.piece[cell], lattice)


def _look(tree: cKDTree, target: Floats, count: int) -> tuple[Floats, Ints]:
    reach, near = tree.query(target, k=np.arange(1, count + 1), workers=-1)
    return np.asarray(reach), np.asarray(near)


class _Walks:
    """The best feet so far, and their distances."""

    def __init__(self, place: Place, distance: Floats) -> None:
        self.place, self.distance = place, distance

    def better(self, index: Ints, other: _Walks) -> None:
        wins = other.distance < self.distance[index]
        rows = index[wins]
        self.place.cell[rows] = other.place.cell[wins]
        self.place.local[:, rows] = other.place.local[:, wins]
        self.place.converged[rows] = other.place.converged[wins]
        self.distance[rows] = other.distance[wins]


def _walk(surface: Searchable, start: Ints, target: Floats) -> _Walks:
    place = refine_foot_points(surface.cells, surface.place[start], np.ascontiguousarray(target.T))
    return _Walks(place, np.linalg.norm(surface.cells.points(place).T - target, axis=1))

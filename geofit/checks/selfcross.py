"""Places where a surface crosses itself: none by construction in a height field, by its triangles elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geofit.checks.lattice import PatchLattice
from geofit.data.accuracy import Check
from geofit.data.messages import message
from geofit.geometry.one_sheet import one_sheet
from geofit.surfaces.protocol import FittedSurface

__all__ = ["self_crossing"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Triangles that are looked at; a larger surface is looked at more coarsely.
MOST = 40_000
#: An edge that meets a triangle within this share of its rim touches it only, as neighbours do.
TOUCH = 1e-6
NAMED = 20


def self_crossing(surface: FittedSurface, parts: Sequence[PatchLattice]) -> Check:
    """Look for places where the surface passes through itself.

    A height field over one plane cannot: over each place of the plane it stands once. Any other surface is looked at
    as triangles between the ends and middles of its spans: a crossing smaller than these is left to OpenCASCADE's test
    of the file.
    """
    if one_sheet(surface.patches):
        text = message(
            "checks.height-fields-apart",
            "a height field over one plane has one value at each location: it cannot cross itself",
        )
        return Check("self-intersection", True, 0, 0, "places", text)
    triangles = _triangles(parts)
    crossed, where = _crossings(triangles) if len(triangles) else (0, triangles)
    if not crossed:
        text = message(
            "checks.surface-does-not-cross-itself",
            "no two of {n} triangles between the ends and middles of its spans cross",
            n=len(triangles),
        )
        return Check("self-intersection", True, 0, 0, "places", text)
    place = where[0] + surface.origin
    text = message(
        "checks.surface-crosses-itself",
        "the surface passes through itself: crossing pairs of triangles: {crossed} (triangles: {n}), one at "
        "{x:.1f}, {y:.1f}, {z:.1f}",
        crossed=crossed,
        n=len(triangles),
        x=place[0],
        y=place[1],
        z=place[2],
    )
    named = tuple((float(a), float(b), float(c)) for a, b, c in where[:NAMED] + surface.origin)
    return Check("self-intersection", False, crossed, 0, "places", text, named)


def _triangles(parts: Sequence[PatchLattice]) -> Floats:
    """Corners (m, 3, 3) of two triangles a cell of the lattices that the outline and the loops leave."""
    step = 1
    while sum(2 * (p.points.shape[0] // step) * (p.points.shape[1] // step) for p in parts) > MOST:
        step += 1
    found = []
    for part in parts:
        grid = part.points
        rows, columns = (np.unique(np.append(np.arange(0, n, step), n - 1)) for n in grid.shape[:2])
        grid = grid[np.ix_(rows, columns)]
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        within = part.within[np.ix_(rows, columns)]
        held = within[:-1, :-1] | within[1:, :-1] | within[1:, 1:] | within[:-1, 1:]
        found += [np.stack(t, axis=-2)[held] for t in ((a, b, c), (a, c, d))]
    return np.concatenate(found)


def _crossings(triangles: Floats) -> tuple[int, Floats]:
    """Count the pairs of triangles that cross, and say where an edge of one passes through the other."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    centre = (low + high) / 2
    radius = np.linalg.norm(high - low, axis=1) / 2
    pairs = _near(centre, radius)
    for k in range(3):
        # Each axis looks only at the pairs that the ones before it leave.
        one, other = pairs.T
        pairs = pairs[(low[one, k] <= high[other, k]) & (low[other, k] <= high[one, k])]
    pairs = pairs[_both_sides(triangles, pairs)]
    pairs = np.unique(pairs[_both_sides(triangles, pairs[:, ::-1])], axis=0)
    hit = np.zeros(len(pairs), bool)
    where = np.zeros((len(pairs), 3))
    for first, second in ((0, 1), (1, 0)):
        edges, faces = triangles[pairs[:, first]], triangles[pairs[:, second]]
        for k in range(3):
            meets, place = _pierce(edges[:, k], edges[:, (k + 1) % 3], faces)
            where[meets & ~hit] = place[meets & ~hit]
            hit |= meets
    return int(hit.sum()), where[hit]


def _near(centre: Floats, radius: Floats) -> Ints:
    """All pairs whose balls meet, with others whose balls nearly do; some come twice.

    The large balls are compared apart, so that they do not widen everybody's search.
    """
    usual = 3 * float(np.median(radius))
    small, large = np.flatnonzero(radius <= usual), np.flatnonzero(radius > usual)
    pairs = [small[cKDTree(centre[small]).query_pairs(2 * float(radius[small].max()), output_type="ndarray")]]
    tree = cKDTree(centre)
    around = tree.query_ball_point(centre[large], radius[large] + radius.max())
    pairs += [np.column_stack([np.full(len(near), k), near]) for k, near in zip(large.tolist(), around, strict=True)]
    found = np.concatenate(pairs).reshape(-1, 2)
    return np.sort(found[found[:, 0] != found[:, 1]], axis=1)


def _both_sides(triangles: Floats, pairs: Ints) -> Bools:
    """Whether the second triangle of each pair has corners on both sides of the first one's plane."""
    face, other = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    normal = np.cross(face[:, 1] - face[:, 0], face[:, 2] - face[:, 0])
    side = np.einsum("nkj,nj->nk", other - face[:, :1], normal)
    least = TOUCH * np.abs(side).max(axis=1)
    return np.asarray((side.max(axis=1) > least) & (side.min(axis=1) < -least))


def _pierce(start: Floats, end: Floats, face: Floats) -> tuple[Bools, Floats]:
    """Which segments pass through the inside of a triangle, and where (Moeller & Trumbore 1997)."""
    along, one, two = end - start, face[:, 1] - face[:, 0], face[:, 2] - face[:, 0]
    cross = np.cross(along, two)
    determinant = (one * cross).sum(axis=1)
    size = np.linalg.norm(along, axis=1) * np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    slanted = np.abs(determinant) > 1e-9 * size
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=slanted)
    away = start - face[:, 0]
    other = np.cross(away, one)
    u = inverse * (away * cross).sum(axis=1)
    v = inverse * (along * other).sum(axis=1)
    t = inverse * (two * other).sum(axis=1)
    inner = np.minimum.reduce([u, v, 1 - u - v, t, 1 - t]) > TOUCH
    return np.asarray(slanted & inner), start + t[:, None] * along

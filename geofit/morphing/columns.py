"""Columns of rock between two surfaces, down from the ground: their tops and bases, and closed triangles around them.

A layer is far thinner than wide. Triangles of a field on cubes would lose one thinner than a cube; these follow the
surfaces themselves, end where the layer thins out to nothing, and stand upright where a surface ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Ground
from geofit.implicit.mesh import TriangleMesh
from geofit.surfaces.below_ground import below_ground
from geofit.surfaces.protocol import HasElevation

__all__ = ["RockColumns", "column_mesh", "heights"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Halvings of an edge of the raster: 30 leave 1e-8 m of 10 m.
HALVINGS = 30
#: The layer ends at least so far from a node of the raster that is in it, as a share of the edge: no triangle is flat.
LEAST = 1e-3
#: A layer thinner than this at its edge has thinned out to nothing, metres.
TOUCH = 1e-4


@dataclass(frozen=True, eq=False)
class RockColumns:
    """The rock below one surface and above another, and below the ground: surfaces, or elevations in metres.

    Where the ground is not known it ends nothing.
    """

    upper: HasElevation | float
    lower: HasElevation | float
    ground: Ground | HasElevation | None = None

    def __call__(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return top and base (n,) of the columns at map coordinates (n,), metres; nan where a surface is absent.

        Where the top is not above the base there is no rock between the surfaces.
        """
        top, base = heights(self.upper, x, y), heights(self.lower, x, y)
        return below_ground(top, x, y, self.ground), below_ground(base, x, y, self.ground)


def heights(surface: Any, x: Floats, y: Floats) -> Floats:
    """Return the elevation of a surface, or of a plane at one elevation, at map coordinates of any shape; metres."""
    if isinstance(surface, int | float):
        return np.full(np.shape(x), float(surface))
    return np.asarray(surface.elevation(np.ravel(x), np.ravel(y)), float).reshape(np.shape(x))


def column_mesh(columns: RockColumns, x: Floats, y: Floats, origin: Floats) -> TriangleMesh:
    """Return closed triangles about ``origin`` around the rock of the columns.

    Parameters
    ----------
    columns : RockColumns
        Tops and bases.
    x, y : (nx,), (ny,) arrays
        Lines of the raster, ascending map coordinates, metres: triangles are linear between them.
    origin : (3,) array
        Local origin, map coordinates, metres.

    Notes
    -----
    Vertices at the edge of the layer are where the edges of the raster leave it, to 1e-9 of their length.
    """
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    top, base = columns(*plan.T)
    with np.errstate(invalid="ignore"):
        solid = top > base
    triangles = _lattice(len(x), len(y))
    triangles = triangles[solid[triangles].any(axis=1)]
    # The edges that leave the layer, from the node within it.
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    edges = edges[solid[edges[:, 0]] != solid[edges[:, 1]]]
    inner = np.where(solid[edges[:, 0]], edges[:, 0], edges[:, 1])
    keys = np.unique(inner * len(plan) + edges.sum(axis=1) - inner)
    place, high, low = _ends(columns, plan[keys // len(plan)], plan[keys % len(plan)])
    thin = high - low <= TOUCH

    def end(inner: Ints, outer: Ints) -> Ints:
        """Return the vertices (k,) at which edges leave the layer."""
        return np.asarray(len(solid) + np.searchsorted(keys, inner * len(solid) + outer))

    plan, top, base = np.concatenate([plan, place]), np.concatenate([top, high]), np.concatenate([base, low])
    faces = _cut(triangles, solid, end)
    pinched = np.concatenate([np.zeros(len(solid), bool), thin])
    # Where the layer thins out its top and base share a vertex.
    used = np.unique(faces)
    upper, lower = np.zeros(len(plan), np.int64), np.zeros(len(plan), np.int64)
    upper[used] = np.arange(len(used))
    below = used[~pinched[used]]
    lower[used] = upper[used]
    lower[below] = len(used) + np.arange(len(below))
    vertices = np.concatenate([np.column_stack([plan[used], top[used]]), np.column_stack([plan[below], base[below]])])
    return TriangleMesh(
        vertices - origin, np.concatenate([upper[faces], lower[faces][:, ::-1], _walls(faces, upper, lower)])
    )


def _lattice(nx: int, ny: int) -> Ints:
    """Return the triangles (m, 3) of a raster, two a cell, anticlockwise seen from above."""
    node = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = node[:-1, :-1].ravel(), node[1:, :-1].ravel(), node[1:, 1:].ravel(), node[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _ends(columns: RockColumns, inner: Floats, outer: Floats) -> tuple[Floats, Floats, Floats]:
    """Return where edges leave the layer, (k, 2), and its top and base there."""
    last, first = np.zeros(len(inner)), np.ones(len(inner))
    for _ in range(HALVINGS):
        middle = (last + first) / 2
        top, base = columns(*(inner + middle[:, None] * (outer - inner)).T)
        with np.errstate(invalid="ignore"):
            within = top > base
        last, first = np.where(within, middle, last), np.where(within, first, middle)
    top, base = columns(*(inner + last[:, None] * (outer - inner)).T)
    share = np.clip(last, LEAST, 1 - LEAST)
    return inner + share[:, None] * (outer - inner), top, base


def _cut(triangles: Ints, solid: Bools, end: Callable[[Ints, Ints], Ints]) -> Ints:
    """Return the parts of triangles that are in the layer, (m, 3)."""
    count = solid[triangles].sum(axis=1)
    parts = [triangles[count == 3]]
    # One corner within: the corner comes first. Two: the corner without comes last.
    for many, corner in ((1, True), (2, False)):
        some = triangles[count == many]
        turn = np.argmax(solid[some] == corner, axis=1) + (0 if corner else 1)
        a, b, c = np.take_along_axis(some, (turn[:, None] + np.arange(3)) % 3, axis=1).T
        if corner:
            parts.append(np.stack([a, end(a, b), end(a, c)], axis=1))
        else:
            right, left = end(b, c), end(a, c)
            parts += [np.stack([a, b, right], axis=1), np.stack([a, right, left], axis=1)]
    return np.concatenate(parts)


def _walls(faces: Ints, upper: Ints, lower: Ints) -> Ints:
    """Return the upright triangles at the edges of the faces; none where the layer thins out to nothing."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = int(faces.max(initial=0)) + 1
    i, j = edges[~np.isin(edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0])].T
    walls = np.concatenate(
        [np.stack([lower[i], lower[j], upper[j]], axis=1), np.stack([lower[i], upper[j], upper[i]], axis=1)]
    )
    a, b, c = walls.T
    return np.asarray(walls[(a != b) & (b != c) & (c != a)])

"""Grids of places on a surface, one a quadrilateral, that share their edges and are spread evenly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.layout import QuadMesh, Sides
from geofit.implicit.field import Field
from geofit.implicit.foot import project_along_gradient

__all__ = ["CELLS", "relaxed_grids"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Cells along each side of a quadrilateral while the grids become finer, and the sweeps at each of them.
LEVELS = ((1, 40), (2, 30), (4, 20), (8, 20))
CELLS = LEVELS[-1][0]
#: Part of the way to the neighbours' middle that a place moves in a sweep.
PART = 0.7


def relaxed_grids(field: Field, layout: QuadMesh) -> Floats | None:
    """Return places (q, 9, 9, 3) on the surface, u before v; None where a grid folds over.

    Every place moves to the middle of the quadrilaterals around it, each weighing as much as its area: without that
    weight a closed grid has no rest but in a point. Then it returns to the surface along the gradient.
    """
    places, grid = layout.corners, np.zeros(0)
    for cells, sweeps in LEVELS:
        index, count = _numbers(layout, cells)
        if len(grid):
            finer = np.empty((count, 3))
            finer[index] = _halved(grid)
            places = finer
        small = np.stack([index[:, :-1, :-1], index[:, 1:, :-1], index[:, 1:, 1:], index[:, :-1, 1:]], axis=-1).reshape(
            -1, 4
        )
        around, reach = small.T.ravel(), layout.spacing / 2
        places = project_along_gradient(field, places, reach=reach, steps=2)
        for _ in range(sweeps):
            middle, area = places[small].mean(axis=1), np.linalg.norm(_normals(places, small), axis=1)
            weight = np.bincount(around, np.tile(area, 4), len(places))
            pulled = np.tile(middle * area[:, None], (4, 1))
            total = np.column_stack([np.bincount(around, pulled[:, k], len(places)) for k in range(3)])
            places = (1 - PART) * places + PART * total / np.maximum(weight, 1e-300)[:, None]
            places = project_along_gradient(field, places, reach=reach, steps=2)
        grid = places[index]
    normals = _normals(places, small)
    outward = (normals * field.gradient(places[small].mean(axis=1))).sum(axis=1)
    return np.asarray(grid) if (outward > 0).all() else None


def _normals(places: Floats, quads: Ints) -> Floats:
    a, b, c, d = (places[quads[:, k]] for k in range(4))
    return np.asarray(np.cross(c - a, d - b))


def _numbers(layout: QuadMesh, cells: int) -> tuple[Ints, int]:
    """Return the numbers (q, cells + 1, cells + 1) of the places of each grid, the corners first, and their count."""
    quads, sides, start = layout.quads, Sides.of(layout.quads), len(layout.corners)
    inner = cells - 1
    index = np.empty((len(quads), cells + 1, cells + 1), np.int64)
    index[:, 0, 0], index[:, -1, 0], index[:, -1, -1], index[:, 0, -1] = quads.T
    along = (start + np.arange(len(sides.edges) * inner).reshape(len(sides.edges), inner))[sides.edge]
    along[sides.reverse] = along[sides.reverse][:, ::-1]
    index[:, 1:-1, 0], index[:, 1:-1, -1], index[:, 0, 1:-1], index[:, -1, 1:-1] = np.moveaxis(along, 1, 0)
    start += len(sides.edges) * inner
    index[:, 1:-1, 1:-1] = start + np.arange(len(quads) * inner**2).reshape(len(quads), inner, inner)
    return index, start + len(quads) * inner**2


def _halved(grid: Floats) -> Floats:
    """Return grids with the middles of their cells and edges, (q, 2n - 1, 2n - 1, 3)."""
    for axis in (1, 2):
        first, last = (np.take(grid, np.arange(grid.shape[axis])[part], axis) for part in (slice(-1), slice(1, None)))
        shape = list(grid.shape)
        shape[axis] = 2 * shape[axis] - 1
        finer = np.empty(shape)
        at: list[slice] = [slice(None)] * 4
        at[axis] = slice(None, None, 2)
        finer[tuple(at)] = grid
        at[axis] = slice(1, None, 2)
        finer[tuple(at)] = (first + last) / 2
        grid = finer
    return grid

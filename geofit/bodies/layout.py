"""Quadrilaterals over a closed surface: the corners and sides of the NURBS patches of a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field
from geofit.implicit.foot import project_along_gradient
from geofit.implicit.mesh import TriangleMesh

__all__ = ["QuadMesh", "quad_mesh"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SMOOTHING = 40


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Corners (v, 3) on the surface, and quadrilaterals (q, 4), counter-clockwise seen from outside."""

    corners: Floats
    quads: Ints

    @property
    def triangles(self) -> TriangleMesh:
        """Each quadrilateral as two triangles: the topology of the layout."""
        return TriangleMesh(self.corners, np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]]))


def quad_mesh(field: Field, component: TriangleMesh, others: TriangleMesh, cells: int) -> QuadMesh | None:
    """Return quadrilaterals over one component of a surface, or None if the raster is too coarse for its topology.

    The dual of a coarse raster ("surface nets", S. Gibson, MICCAI 1998): a corner in each cell that the surface
    crosses, a quadrilateral around each edge of the raster that it crosses; then smoothed along the surface.

    Parameters
    ----------
    field : Field
        The field; its zero set is the surface.
    component, others : TriangleMesh
        The component's triangles, and those of the rest of the surface (maybe none).
    cells : int
        Cells of the raster along the longest side of the component.
    """
    lower, upper = component.vertices.min(axis=0), component.vertices.max(axis=0)
    spacing = float((upper - lower).max()) / cells
    counts = np.ceil((upper - lower) / spacing - 1e-9).astype(int) + 3
    origin = (lower + upper) / 2 - spacing * (counts - 1) / 2
    nodes = origin + spacing * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    value = field.value(nodes.reshape(-1, 3))
    _mask_others(value, nodes.reshape(-1, 3), component, others)
    value = value.reshape(counts)
    inside = value < 0
    layout = _net(origin, spacing, value, inside)
    if layout is None or not _same_topology(layout.triangles, component):
        return None
    return QuadMesh(_smoothed(field, layout, spacing), layout.quads)


def _mask_others(value: Floats, nodes: Floats, component: TriangleMesh, others: TriangleMesh) -> None:
    """Give nodes that belong to another component of the surface the sign that this one alone would have."""
    from scipy.spatial import cKDTree

    if not len(others.triangles):
        return
    own, normals = component.corners.mean(axis=1), component.area_vectors
    near, triangle = cKDTree(own).query(nodes)
    closer = cKDTree(others.corners.mean(axis=1)).query(nodes)[0] < near
    outward = ((nodes - own[triangle]) * normals[triangle]).sum(axis=1)
    value[closer] = np.where(outward < 0, -near, near)[closer]


def _net(origin: Floats, spacing: float, value: Floats, inside: NDArray[np.bool_]) -> QuadMesh | None:
    shape = np.array(value.shape) - 1
    corner, weight = np.zeros((*shape, 3)), np.zeros(shape)
    crossings = []
    for axis in range(3):
        low = [slice(None)] * 3
        high = [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        changed = inside[tuple(low)] != inside[tuple(high)]
        at = np.argwhere(changed)
        first, second = value[tuple(low)][changed], value[tuple(high)][changed]
        place = at.astype(float)
        place[:, axis] += first / (first - second)
        b, c = (axis + 1) % 3, (axis + 2) % 3
        around = []
        for db, dc in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
            cell = at.copy()
            cell[:, b] += db
            cell[:, c] += dc
            if len(cell) and ((cell < 0) | (cell >= shape)).any():
                return None
            np.add.at(corner, tuple(cell.T), place)
            np.add.at(weight, tuple(cell.T), 1.0)
            around.append(cell)
        ring = np.stack(around, axis=1)
        ring[~inside[tuple(at.T)]] = ring[~inside[tuple(at.T)]][:, ::-1]
        crossings.append(ring)
    rings = np.concatenate(crossings)
    flat = np.ravel_multi_index(tuple(np.moveaxis(rings, -1, 0)), tuple(shape))
    used, quads = np.unique(flat, return_inverse=True)
    places = corner.reshape(-1, 3)[used] / weight.reshape(-1)[used][:, None]
    return QuadMesh(origin + spacing * places, quads.reshape(-1, 4).astype(np.int64))


def _same_topology(layout: TriangleMesh, component: TriangleMesh) -> bool:
    return layout.is_closed and layout.is_manifold and layout.components == 1 and layout.euler == component.euler


def _smoothed(field: Field, layout: QuadMesh, spacing: float) -> Floats:
    """Return the corners moved along the surface towards the middles of their quadrilaterals."""
    corners, quads = layout.corners, layout.quads
    count = np.bincount(quads.ravel(), minlength=len(corners))[:, None]
    for _ in range(SMOOTHING):
        middle = corners[quads].mean(axis=1)
        total = np.zeros_like(corners)
        for k in range(4):
            np.add.at(total, quads[:, k], middle)
        corners = project_along_gradient(field, total / count, reach=spacing, steps=3)
    return project_along_gradient(field, corners, reach=spacing, steps=12)

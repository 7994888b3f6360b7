"""Quadrilaterals over a closed surface: the corners and sides of the NURBS patches of a body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.dual import dual_quads
from geofit.implicit.field import Field
from geofit.implicit.mesh import TriangleMesh

__all__ = ["QuadMesh", "Sides", "quad_meshes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Cells along the longest side of the rasters that are tried, and how much flatter their cells are than the body.
CELLS = (2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 24, 28)
FLATTEST = 0.1


@dataclass(frozen=True, eq=False)
class Sides:
    """Sides of quadrilaterals: the edges (e, 2), the edge (q, 4) of each side, whether it runs against it (q, 4).

    Sides in the order bottom (v = 0), top (v = 1), left (u = 0), right (u = 1), each with growing parameter.
    """

    edges: Ints
    edge: Ints
    reverse: NDArray[np.bool_]

    @classmethod
    def of(cls, quads: Ints) -> Sides:
        """Return the sides of quadrilaterals (q, 4)."""
        ends = quads[:, [[0, 1], [3, 2], [0, 3], [1, 2]]]
        edges, index = np.unique(np.sort(ends.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        return cls(edges, index.reshape(-1, 4).astype(np.int64), ends[:, :, 0] > ends[:, :, 1])


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Corners (v, 3) near the surface, quadrilaterals (q, 4), counter-clockwise from outside, and their usual size."""

    corners: Floats
    quads: Ints
    spacing: float

    @property
    def triangles(self) -> TriangleMesh:
        """Each quadrilateral as two triangles: the topology of the layout."""
        return TriangleMesh(self.corners, np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]]))


def quad_meshes(field: Field, component: TriangleMesh, others: TriangleMesh, most: int) -> Iterator[QuadMesh]:
    """Return quadrilaterals over one component of a surface, few first: duals of coarse rasters of its topology.

    Rasters along the map's axes and along the component's main axes; cells that are cubes, as flat as the component,
    or between the two: each suits other shapes.

    Parameters
    ----------
    field : Field
        The field; its zero set is the surface.
    component, others : TriangleMesh
        The component's triangles, and those of the rest of the surface (maybe none).
    most : int
        Quadrilaterals at most.
    """
    middles, weight = component.corners.mean(axis=1), component.areas / component.area
    off = middles - weight @ middles
    main = np.linalg.eigh((off * weight[:, None]).T @ off)[1].T
    # A mirrored raster would turn the quadrilaterals inside out.
    main *= np.sign(np.linalg.det(main))
    found = []
    for axes, power in ((np.eye(3), 0.0), (main, 0.0), (main, 0.5), (main, 1.0)):
        turned = component.vertices @ axes.T
        lower, upper = turned.min(axis=0), turned.max(axis=0)
        longest = float((upper - lower).max())
        shape = np.maximum((upper - lower) / longest, FLATTEST) ** power
        for cells in CELLS:
            layout = _layout(field, component, others, axes, (lower, upper), longest * shape / cells)
            if layout is None:
                continue
            if len(layout.quads) > most:
                # Finer rasters have more.
                break
            if _same_topology(layout.triangles, component):
                found.append(layout)
    yield from sorted(found, key=lambda layout: len(layout.quads))


def _layout(
    field: Field, component: TriangleMesh, others: TriangleMesh, axes: Floats, box: tuple[Floats, Floats], size: Floats
) -> QuadMesh | None:
    lower, upper = box
    counts = np.ceil((upper - lower) / size - 1e-9).astype(int) + 3
    origin = (lower + upper) / 2 - size * (counts - 1) / 2
    nodes = (origin + size * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)).reshape(-1, 3)
    places = nodes @ axes
    value = field.value(places)
    _mask_others(value, places, component, others)
    found = dual_quads(value.reshape(counts))
    if found is None:
        return None
    return QuadMesh((origin + size * found[0]) @ axes, found[1], float(size.max()))


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


def _same_topology(layout: TriangleMesh, component: TriangleMesh) -> bool:
    return layout.is_closed and layout.is_manifold and layout.components == 1 and layout.euler == component.euler

"""Triangles that bound bodies: volume, area, topology, and whether they are closed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = ["TriangleMesh"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Vertices and triangles; the normals of a body's triangles point outwards.

    Parameters
    ----------
    vertices : (n, 3) array
        Vertices in metres about the local origin.
    triangles : (m, 3) array of int
        Vertices of each triangle, counter-clockwise seen from outside.

    Examples
    --------
    >>> tetrahedron = TriangleMesh(
    ...     np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
    ...     np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
    ... )
    >>> round(tetrahedron.volume, 6), tetrahedron.euler, tetrahedron.is_closed
    (0.166667, 2, True)
    """

    vertices: Floats
    triangles: Ints

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, float).reshape(-1, 3)
        triangles = np.array(self.triangles, np.int64).reshape(-1, 3)
        if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise SettingsError(
                message(
                    "implicit.triangle-vertex-unknown",
                    "a triangle names vertex {vertex}, but there are {count}: number them from 0",
                    vertex=int(triangles.max() if triangles.min() >= 0 else triangles.min()),
                    count=len(vertices),
                )
            )
        vertices.flags.writeable = triangles.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", triangles)

    @property
    def corners(self) -> Floats:
        """Corners of the triangles, (m, 3, 3)."""
        return self.vertices[self.triangles]

    @cached_property
    def area_vectors(self) -> Floats:
        """Normals of the triangles, (m, 3), as long as the triangle's area in m2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        (ux, uy, uz), (vx, vy, vz) = (b - a).T, (c - a).T
        return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], axis=1) / 2

    @cached_property
    def areas(self) -> Floats:
        """Areas of the triangles, (m,), m2."""
        return np.asarray(np.linalg.norm(self.area_vectors, axis=1))

    @property
    def area(self) -> float:
        """Area in m2."""
        return float(self.areas.sum())

    @cached_property
    def volume(self) -> float:
        """Volume in m3 by signed tetrahedra; it means something for a closed mesh only."""
        return float(self._tetrahedra.sum())

    @cached_property
    def _tetrahedra(self) -> Floats:
        # About the middle of the vertices: far from the origin the tetrahedra would cancel.
        middle = self.vertices.mean(axis=0) if len(self.vertices) else np.zeros(3)
        return np.asarray(((self.corners.mean(axis=1) - middle) * self.area_vectors).sum(axis=1) / 3)

    @cached_property
    def _edges(self) -> tuple[Ints, Ints, Ints]:
        """Undirected edges (k, 2), triangles at each, and how often it runs from the lower to the upper vertex."""
        directed = self.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        low, high = directed.min(axis=1), directed.max(axis=1)
        keys, index, count = np.unique(low * len(self.vertices) + high, return_inverse=True, return_counts=True)
        forward = np.bincount(index, weights=directed[:, 0] == low, minlength=len(keys)).astype(np.int64)
        size = max(len(self.vertices), 1)
        return np.stack([keys // size, keys % size], axis=1), count.astype(np.int64), forward

    @property
    def edges(self) -> Ints:
        """Edges, each once, (k, 2)."""
        return self._edges[0]

    @property
    def boundary_edges(self) -> Ints:
        """Edges with one triangle, (k, 2): the mesh is open there."""
        edges, count, _ = self._edges
        return np.asarray(edges[count == 1])

    @property
    def nonmanifold_edges(self) -> Ints:
        """Edges with more than two triangles, or with two that are oriented differently, (k, 2)."""
        edges, count, forward = self._edges
        return np.asarray(edges[(count > 2) | ((count == 2) & (forward != 1))])

    @cached_property
    def nonmanifold_vertices(self) -> Ints:
        """Vertices whose triangles form more than one fan: two parts of the mesh touch in a point."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        corners = self.triangles.ravel()
        # Corners of one vertex are joined where their triangles share an edge at that vertex.
        ends = np.stack([self.triangles, np.roll(self.triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
        slot = np.arange(corners.size).reshape(-1, 3)
        slots = np.stack([slot, np.roll(slot, -1, axis=1)], axis=-1).reshape(-1, 2)
        swap = ends[:, 0] > ends[:, 1]
        ends[swap], slots[swap] = ends[swap][:, ::-1], slots[swap][:, ::-1]
        order = np.lexsort((ends[:, 1], ends[:, 0]))
        same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1)
        left, right = slots[order[:-1]][same].ravel(), slots[order[1:]][same].ravel()
        graph = coo_array((np.ones(len(left)), (left, right)), shape=(corners.size, corners.size))
        _, fan = connected_components(graph, directed=False)
        # All corners of a fan are at one vertex.
        vertex, count = np.unique(corners[np.unique(fan, return_index=True)[1]], return_counts=True)
        return np.asarray(vertex[count > 1], np.int64)

    @property
    def is_closed(self) -> bool:
        """Whether the mesh bounds a body: every edge has two triangles of one orientation."""
        return len(self.triangles) > 0 and not len(self.boundary_edges) and not len(self.nonmanifold_edges)

    @property
    def is_manifold(self) -> bool:
        """Whether the neighbourhood of every vertex is a disc, or half a disc at a boundary."""
        return not len(self.nonmanifold_edges) and not len(self.nonmanifold_vertices)

    @property
    def euler(self) -> int:
        """Euler number V - E + F of the vertices in use: 2 for each ball, 0 for each torus."""
        return len(np.unique(self.triangles)) - len(self.edges) + len(self.triangles)

    @cached_property
    def component_of(self) -> Ints:
        """Component of each triangle, (m,), numbered from 0 in the order of their first triangle."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        if not len(self.triangles):
            return np.zeros(0, np.int64)
        a, b = self.edges.T
        size = len(self.vertices)
        _, label = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(size, size)), directed=False)
        label = label[self.triangles[:, 0]]
        _, first, index = np.unique(label, return_index=True, return_inverse=True)
        return np.asarray(np.argsort(np.argsort(first))[index], np.int64)

    @property
    def components(self) -> int:
        """Number of connected components."""
        return int(self.component_of.max()) + 1 if len(self.triangles) else 0

    def split(self) -> tuple[TriangleMesh, ...]:
        """Return the components as meshes of their own, in the order of ``component_of``."""
        return tuple(self.only(self.component_of == i) for i in range(self.components))

    def only(self, keep: NDArray[np.bool_]) -> TriangleMesh:
        """Return a part of the triangles, with the vertices that it uses.

        Parameters
        ----------
        keep : (m,) array of bool
            The part: true for each of its triangles.
        """
        used, triangles = np.unique(self.triangles[keep], return_inverse=True)
        return TriangleMesh(self.vertices[used], triangles.reshape(-1, 3))

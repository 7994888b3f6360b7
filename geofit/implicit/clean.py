"""Triangles without area removed from a mesh that stays manifold."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.implicit.mesh import TriangleMesh

__all__ = ["collapse_slivers"]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

#: Edges longer than this part of the spacing are not collapsed: a vertex must not leave its place.
SHORT = 0.1
PASSES = 20


@arguments_checked
def collapse_slivers(mesh: TriangleMesh, smallest: float, spacing: float) -> TriangleMesh:
    """Remove the triangles below an area by collapsing their short edges and swapping their long ones.

    Parameters
    ----------
    mesh : TriangleMesh
        A manifold mesh, closed or not.
    smallest : float
        Area below which a triangle is a sliver, m2.
    spacing : float
        Spacing of the lattice that the mesh comes from, metres.

    Returns
    -------
    TriangleMesh
        The mesh itself if it has no slivers. Components of slivers only are left out: bodies about a single node, far
        below the spacing. A sliver stays where its removal would make the mesh non-manifold.
    """
    vertices, triangles = mesh.vertices, mesh.triangles
    areas = mesh.areas
    for _ in range(PASSES):
        bad = np.nonzero(areas < smallest)[0]
        # Two rings about the slivers: there every vertex that an operation looks at has all its triangles.
        near = _touching(triangles, _touching(triangles, bad))
        patch = _Patch(vertices, triangles[near], smallest, SHORT * spacing)
        if not sum([patch.remove(int(i)) for i in np.searchsorted(near, bad)]):
            break
        changed = patch.remaining()
        triangles = np.concatenate([np.delete(triangles, near, axis=0), changed])
        areas = np.append(np.delete(areas, near), np.linalg.norm(_area_vectors(vertices[changed]), axis=1))
    if triangles is mesh.triangles and not (areas < smallest).any():
        return mesh
    used = np.zeros(len(vertices), bool)
    used[triangles] = True
    cleaned = TriangleMesh(vertices[used], (np.cumsum(used) - 1)[triangles])
    if not (areas < smallest).any():
        return cleaned
    largest = np.zeros(cleaned.components)
    np.maximum.at(largest, cleaned.component_of, cleaned.areas)
    return cleaned.only(largest[cleaned.component_of] >= smallest)


def _touching(triangles: Ints, some: Ints) -> Ints:
    """Triangles that share a vertex with some of them, those included."""
    marked = np.zeros(triangles.max(initial=0) + 1, bool)
    marked[triangles[some]] = True
    return np.nonzero(marked[triangles].any(axis=1))[0]


def _area_vectors(corners: Floats) -> Floats:
    (ax, ay, az), (bx, by, bz) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    # np.cross spends more time on its axes than on the products of a few triangles.
    return 0.5 * np.column_stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


class _Patch:
    """A part of a mesh whose triangles can be removed one by one."""

    def __init__(self, vertices: Floats, triangles: Ints, smallest: float, short: float) -> None:
        self.vertices, self.smallest, self.short = vertices, smallest, short
        self.corners: list[tuple[int, int, int] | None] = [(int(a), int(b), int(c)) for a, b, c in triangles]
        self.star: dict[int, set[int]] = {}
        for i, (a, b, c) in enumerate(triangles.tolist()):
            for vertex in (a, b, c):
                self.star.setdefault(vertex, set()).add(i)

    def remaining(self) -> Ints:
        return np.array([c for c in self.corners if c is not None], np.int64).reshape(-1, 3)

    def remove(self, i: int) -> bool:
        """Remove triangle i if it is a sliver; return whether anything was changed."""
        corners = self.corners[i]
        if corners is None or np.linalg.norm(self.normals([corners])[0]) >= self.smallest:
            return False
        sides = sorted((self.length(u, v), u, v) for u, v in pairwise((*corners, corners[0])))
        for length, u, v in sides:
            if length < self.short and (self.collapse(u, v) or self.collapse(v, u)):
                return True
        return self.swap(i, *sides[-1][1:])

    def length(self, u: int, v: int) -> float:
        return float(np.linalg.norm(self.vertices[u] - self.vertices[v]))

    def normals(self, triangles: list[tuple[int, int, int]]) -> Floats:
        return _area_vectors(self.vertices[np.array(triangles).reshape(-1, 3)])

    def of(self, triangles: set[int]) -> list[tuple[int, int, int]]:
        return [c for i in sorted(triangles) if (c := self.corners[i]) is not None]

    def around(self, vertex: int) -> set[int]:
        return {v for corners in self.of(self.star[vertex]) for v in corners} - {vertex}

    def collapse(self, kept: int, lost: int) -> bool:
        """Move a vertex onto its neighbour if the link condition is met and no triangle turns over."""
        shared = self.star[kept] & self.star[lost]
        wings = {v for corners in self.of(shared) for v in corners} - {kept, lost}
        around = self.around(lost)
        inner = len(around) == len(self.star[lost])
        if self.around(kept) & around != wings or len(shared) != 2 or len(wings) != 2 or not inner:
            return False
        if any(len(self.star[wing]) <= 3 for wing in wings):
            return False
        moving = sorted(self.star[lost] - shared)
        before = self.of(set(moving))
        after = [(a, b, c) for a, b, c in ([kept if v == lost else v for v in corners] for corners in before)]
        old, new = self.normals(before), self.normals(after)
        large = np.linalg.norm(old, axis=1) >= self.smallest
        if ((old * new).sum(axis=1)[large] <= 0).any():
            return False
        for i in shared:
            for vertex in self.corners[i] or ():
                self.star[vertex].discard(i)
            self.corners[i] = None
        for i, corners in zip(moving, after, strict=True):
            self.corners[i] = corners
            self.star[kept].add(i)
        self.star[lost] = set()
        return True

    def swap(self, i: int, u: int, v: int) -> bool:
        """Replace the edge u-v of two triangles by that between their other corners."""
        shared = self.star[u] & self.star[v]
        if len(shared) != 2:
            return False
        j = next(iter(shared - {i}))
        a, b = (({*(self.corners[k] or ())} - {u, v}).pop() for k in (i, j))
        if a == b or b in self.around(a):
            return False
        # (u, v) is in the direction of triangle i.
        after = [(u, b, a), (b, v, a)]
        before = self.normals(self.of({i, j}))
        new = self.normals(after)
        sizes = np.linalg.norm(new, axis=1)
        if (new @ before.sum(axis=0) <= 0).any() or sizes.min() <= np.linalg.norm(before, axis=1).min():
            return False
        self.corners[i], self.corners[j] = after[0], after[1]
        self.star[u].discard(j)
        self.star[v].discard(i)
        self.star[b].add(i)
        self.star[a].add(j)
        return True

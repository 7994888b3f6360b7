"""The faces along which a body is cut: triangles between closed lines on a surface z = h(x, y)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.messages import message

__all__ = ["cap_triangles"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Height = Callable[[Floats, Floats], Floats]

#: Inner edges longer than this many edge lengths of the body's mesh are halved, this often at most.
LONG = 1.5
ROUNDS = 8


def cap_triangles(
    vertices: Floats, segments: Sequence[tuple[int, int]], height: Height, size: float, name: str
) -> tuple[Floats, Ints]:
    """Return triangles that fill closed lines, seen from above counter-clockwise.

    Parameters
    ----------
    vertices : (n, 3) array
        Places; those of the lines lie on the surface.
    segments : sequence of (int, int)
        Pieces of the lines, each vertex in two of them.
    height : callable
        Elevation of the surface.
    size : float
        Edge length of the body's mesh, metres.
    name : str
        Of the surface, for messages.

    Returns
    -------
    added : (k, 3) array
        Vertices inside the faces, on the surface; they are numbered from n.
    triangles : (m, 3) array of int
        The faces.

    Raises
    ------
    FitError
        If a line crosses itself in plan.
    """
    loops = _loops(segments)
    plain: list[list[int]] = []
    flat: list[list[int]] = []
    for loop in loops:
        twice = _twice_area(vertices[loop, :2])
        # What is smaller than any triangle is closed by a fan: no library need look at it.
        (flat if len(loop) < 4 or abs(twice) < 1e-6 * size * size else plain).append(loop)
    triangles = [_delaunay(vertices, plain, name)] + [_fan(vertices, loop) for loop in flat]
    whole = np.concatenate(triangles)
    return _refined(vertices, whole, height, LONG * size)


def _loops(segments: Sequence[tuple[int, int]]) -> list[list[int]]:
    onward: dict[int, int] = dict(segments)
    loops = []
    while onward:
        start, at = onward.popitem()
        loop = [start]
        while at != start:
            loop.append(at)
            at = onward.pop(at)
        loops.append(loop)
    return loops


def _twice_area(plan: Floats) -> float:
    x, y = (plan - plan[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def _fan(vertices: Floats, loop: list[int]) -> Ints:
    fan = np.array([(loop[0], loop[k], loop[k + 1]) for k in range(1, len(loop) - 1)], np.int64).reshape(-1, 3)
    return fan if _twice_area(vertices[loop, :2]) >= 0 else fan[:, ::-1]


def _delaunay(vertices: Floats, loops: Sequence[list[int]], name: str) -> Ints:
    """Return the constrained Delaunay triangles of the regions that the loops bound, even-odd."""
    import shapely

    if not loops:
        return np.zeros((0, 3), np.int64)
    rings: list[Any] = [shapely.Polygon(vertices[loop, :2]) for loop in loops]
    number = {tuple(vertices[k, :2].tolist()): k for loop in loops for k in loop}
    if not all(ring.is_valid for ring in rings) or len(number) < sum(map(len, loops)):
        raise FitError(
            message(
                "bodies.cut-crosses-itself",
                "The cut along '{name}' crosses itself: the body's triangles are too coarse for it. Give cut() a "
                "smaller spacing.",
                name=name,
            )
        )
    order = sorted(range(len(rings)), key=lambda k: -rings[k].area)
    parent: dict[int, int | None] = {}
    for at, k in enumerate(order):
        holders = [j for j in order[:at] if rings[j].contains(rings[k])]
        parent[k] = holders[-1] if holders else None

    def depth(k: int | None) -> int:
        return 0 if k is None else 1 + depth(parent[k])

    found = []
    for k in order:
        if depth(k) % 2 == 1:
            holes = [vertices[loops[j], :2] for j in order if parent[j] == k]
            region = shapely.Polygon(vertices[loops[k], :2], holes)
            parts: Any = shapely.constrained_delaunay_triangles(region)
            for triangle in parts.geoms:
                corners = [number[(x, y)] for x, y in triangle.exterior.coords[:3]]
                found.append(corners if triangle.exterior.is_ccw else corners[::-1])
    return np.array(found, np.int64).reshape(-1, 3)


def _refined(vertices: Floats, triangles: Ints, height: Height, longest: float) -> tuple[Floats, Ints]:
    """Halve long inner edges; new vertices lie on the surface, those of the border stay as they are."""
    count, places = len(vertices), vertices
    for _ in range(ROUNDS):
        directed = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges, index, shared = np.unique(directed, axis=0, return_inverse=True, return_counts=True)
        length = np.linalg.norm(places[edges[:, 0], :2] - places[edges[:, 1], :2], axis=1)
        long = (shared == 2) & (length > longest)
        if not long.any():
            break
        middle = (places[edges[long, 0]] + places[edges[long, 1]]) / 2
        middle[:, 2] = height(middle[:, 0], middle[:, 1])
        number = np.full(len(edges), -1)
        number[long] = len(places) + np.arange(int(long.sum()))
        places = np.concatenate([places, middle])
        triangles = _halved(triangles, number[index.reshape(-1)].reshape(-1, 3))
    return places[count:], triangles


def _halved(triangles: Ints, middle: Ints) -> Ints:
    """Split triangles at the middles of their edges 01, 12, 20; -1 where an edge stays whole."""
    parts = [triangles[(middle < 0).all(axis=1)]]
    for k in range(3):
        a, b, c = (triangles[:, (k + i) % 3] for i in range(3))
        ab, bc, ca = (middle[:, (k + i) % 3] for i in range(3))
        one = (ab >= 0) & (bc < 0) & (ca < 0)
        parts += [np.stack(t, axis=1)[one] for t in ((a, ab, c), (ab, b, c))]
        two = (ab >= 0) & (bc >= 0) & (ca < 0)
        parts += [np.stack(t, axis=1)[two] for t in ((ab, b, bc), (a, ab, c), (ab, bc, c))]
    every = (middle >= 0).all(axis=1)
    a, b, c = triangles[every].T
    ab, bc, ca = middle[every].T
    parts += [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(parts)

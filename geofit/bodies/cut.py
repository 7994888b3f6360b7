"""A body cut by horizons, faults and topography into closed pieces that share their cut faces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.cap import cap_triangles
from geofit.data.errors import FitError, SettingsError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh

if TYPE_CHECKING:
    from geofit.bodies.implicit_body import ImplicitBody

__all__ = ["BodyPiece", "CuttingSurface", "cut_body", "split_mesh"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Side = Literal["above", "below"]
Height = Callable[[Floats, Floats], Floats]

#: Share of an edge that a cut stays away from its ends.
NODE_GAP = 1e-7
HALVINGS = 45
#: Heights above a surface, in sizes of a triangle, that are none: cuts lie on it but for their gaps.
LEVEL = 1e-6


class CuttingSurface(Protocol):
    """A surface with one elevation at each place: a horizon, a fault, the ground."""

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the elevation at map coordinates, metres; nan where the surface does not reach."""
        ...


@dataclass(frozen=True, eq=False)
class BodyPiece:
    """A closed piece of a body: ``sides`` names the side of each cutting surface that it lies on.

    ``mesh`` is in map coordinates. Pieces on the two sides of a cut have the same vertices and triangles there.
    """

    name: str
    sides: Mapping[str, Side]
    mesh: TriangleMesh

    @property
    def volume(self) -> float:
        """Volume in m3."""
        return self.mesh.volume


def cut_body(
    body: ImplicitBody,
    surfaces: Mapping[str, CuttingSurface] | Sequence[CuttingSurface] | CuttingSurface,
    spacing: float | None = None,
) -> tuple[BodyPiece, ...]:
    """Cut a body along surfaces.

    Parameters
    ----------
    body : ImplicitBody
        The body.
    surfaces : mapping of str to surface, sequence of surfaces, or one surface
        What cuts it, in turn; unnamed surfaces take their ``name``, or a number.
    spacing : float, optional
        Of the body's triangles, see :meth:`ImplicitBody.triangulate`.

    Returns
    -------
    tuple of BodyPiece
        Closed pieces. Their volumes add up to that of the triangulated body, to rounding.

    Raises
    ------
    FitError
        If a surface does not reach all over the body, or folds over within one triangle.
    """
    mesh = body.mesh_at(spacing)
    pieces: list[tuple[dict[str, Side], TriangleMesh]] = [({}, mesh)]
    origin = body.origin
    for name, surface in _named(surfaces):

        def height(x: Floats, y: Floats, surface: Any = surface) -> Floats:
            heights: Floats = np.asarray(surface.elevation(x + origin[0], y + origin[1]), float) - origin[2]
            return heights

        parts: list[tuple[dict[str, Side], TriangleMesh]] = []
        for sides, piece in pieces:
            above, below = split_mesh(piece, height, name)
            parts += [({**sides, name: "above"}, above)] if len(above.triangles) else []
            parts += [({**sides, name: "below"}, below)] if len(below.triangles) else []
        pieces = parts
    return tuple(
        BodyPiece(_label(body.name, sides), sides, TriangleMesh(piece.vertices + origin, piece.triangles))
        for sides, piece in pieces
    )


def _named(surfaces: Any) -> list[tuple[str, CuttingSurface]]:
    if isinstance(surfaces, Mapping):
        named = list(surfaces.items())
    else:
        several = [surfaces] if hasattr(surfaces, "elevation") else list(surfaces)
        named = [(str(getattr(s, "name", "") or f"surface {k}"), s) for k, s in enumerate(several, 1)]
    names = [name for name, _ in named]
    for name, surface in named:
        if names.count(name) > 1 or not hasattr(surface, "elevation"):
            raise SettingsError(
                message(
                    "bodies.cutting-surface-unusable",
                    "Surface '{name}' cannot cut the body: each needs a name of its own and elevation(x, y).",
                    name=name,
                )
            )
    return named


def _label(body: str, sides: Mapping[str, Side]) -> str:
    words = [
        message("bodies.part-above-surface", "above {surface}", surface=k)
        if v == "above"
        else message("bodies.part-below-surface", "below {surface}", surface=k)
        for k, v in sides.items()
    ]
    return f"{body}: {', '.join(map(str, words))}" if words else body


def split_mesh(mesh: TriangleMesh, height: Height, name: str = "") -> tuple[TriangleMesh, TriangleMesh]:
    """Split a closed mesh along z = height(x, y) into two closed meshes, above and below; one may be empty.

    Parameters
    ----------
    mesh : TriangleMesh
        A closed mesh.
    height : callable
        (n,), (n,) -> (n,) elevations in the mesh's coordinates.
    name : str
        Of the surface, for messages.

    Raises
    ------
    FitError
        If the height is not a number somewhere on the mesh, or the cut crosses itself in plan.
    """
    vertices, triangles = mesh.vertices, mesh.triangles
    level = vertices[:, 2] - height(vertices[:, 0], vertices[:, 1])
    if not np.isfinite(level).all():
        raise FitError(
            message(
                "bodies.cutting-surface-too-small",
                "Surface '{name}' does not reach {share:.1%} of the body. Enlarge the surface, or leave it out.",
                name=name,
                share=float((~np.isfinite(level)).mean()),
            )
        )
    nothing = mesh.only(np.zeros(len(triangles), bool))
    if not len(triangles):
        return nothing, nothing
    size = float(np.sqrt(mesh.areas.mean()))
    # Along an earlier cut by the same surface, rounding alone would make a piece.
    if level.min() >= -LEVEL * size:
        return mesh, nothing
    if level.max() <= LEVEL * size:
        return nothing, mesh
    up = level >= 0
    edges = mesh.edges
    cut = edges[up[edges[:, 0]] != up[edges[:, 1]]]
    crossing = _crossings(vertices, cut, height)
    all_vertices = np.concatenate([vertices, crossing])
    number = {(int(a), int(b)): len(vertices) + k for k, (a, b) in enumerate(cut.tolist())}
    kept = {True: [triangles[up[triangles].all(axis=1)]], False: [triangles[~up[triangles].any(axis=1)]]}
    pieces: dict[bool, list[tuple[int, int, int]]] = {True: [], False: []}
    segments: list[tuple[int, int]] = []
    rank = np.empty(len(vertices), np.int64)
    rank[np.lexsort(vertices.T)] = np.arange(len(vertices))
    for corners in triangles[up[triangles].any(axis=1) & ~up[triangles].all(axis=1)].tolist():
        flags = [bool(up[c]) for c in corners]
        k = flags.index(sum(flags) == 1)
        alone, second, third = corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]
        p = number[(min(alone, second), max(alone, second))]
        q = number[(min(alone, third), max(alone, third))]
        pieces[flags[k]].append((alone, p, q))
        # The diagonal starts at the corner that comes first in space: the other piece's triangle chooses the same.
        if rank[second] < rank[third]:
            pieces[not flags[k]] += [(second, third, q), (second, q, p)]
        else:
            pieces[not flags[k]] += [(third, q, p), (third, p, second)]
        # Along the upper side's border, in its triangles' direction.
        segments.append((p, q) if flags[k] else (q, p))
    added, cap = cap_triangles(all_vertices, segments, height, size, name)
    all_vertices = np.concatenate([all_vertices, added])
    found = []
    for side in (True, False):
        own = np.concatenate([*kept[side], np.array(pieces[side], np.int64).reshape(-1, 3)])
        lid = cap[:, ::-1] if side else cap
        whole = TriangleMesh(all_vertices, np.concatenate([own, lid]))
        found.append(whole.only(np.ones(len(whole.triangles), bool)))
    return found[0], found[1]


def _crossings(vertices: Floats, edges: Ints, height: Height) -> Floats:
    """Return the places (n, 3) where edges cross the surface, the same whichever way an edge is numbered."""
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    swap = np.zeros(len(edges), bool)
    equal = np.ones(len(edges), bool)
    for axis in range(3):
        swap |= equal & (a[:, axis] > b[:, axis])
        equal &= a[:, axis] == b[:, axis]
    a[swap], b[swap] = b[swap], a[swap]
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    start = a[:, 2] - height(a[:, 0], a[:, 1]) >= 0
    for _ in range(HALVINGS):
        t = (low + high) / 2
        at = a + t[:, None] * (b - a)
        same = (at[:, 2] - height(at[:, 0], at[:, 1]) >= 0) == start
        low, high = np.where(same, t, low), np.where(same, high, t)
    t = np.clip((low + high) / 2, NODE_GAP, 1 - NODE_GAP)
    return np.asarray(a + t[:, None] * (b - a))

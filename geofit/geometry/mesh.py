"""Triangles of a surface: within a chordal tolerance, without cracks at the seams, trimmed to the outline."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown
from geofit.geometry.cells import Place, tabulate
from geofit.geometry.clip import clip
from geofit.geometry.elevation import plan_map
from geofit.splines import bspline
from geofit.splines.patch import Patch

__all__ = ["Mesh", "Tolerance", "cell_boxes", "triangle_count", "triangulate", "trim_to_outline"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Metres everywhere; or, from the least and the largest map coordinates of n boxes, (n, 3) each, the metres in each.
Tolerance = float | Callable[[Floats, Floats], Floats]

#: Corners and edges of patches nearer than this (metres) are one, as in the sewn shell.
WELD = 1e-6
#: No span is cut into more pieces than this: of a surface bent in both directions they are too many triangles.
FINEST = 4_000
#: Triangles of one surface.
MOST = 20_000_000


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one surface.

    Parameters
    ----------
    points : (n, 3) array
        Vertices in metres, relative to ``origin``.
    triangles : (m, 3) array of int
        Vertices of each triangle; its normal is on the side of S_u x S_v.
    patch : (m,) array of int
        Which patch of the surface a triangle belongs to.
    uv : (m, 3, 2) array
        Parameters, in that patch, of each corner.
    origin : (3,) array
        Offset that turns the vertices into map coordinates, metres.
    names : tuple of str
        Names of the patches.
    """

    points: Floats
    triangles: Ints
    patch: Ints
    uv: Floats
    origin: Floats
    names: tuple[str, ...]

    @property
    def xyz(self) -> Floats:
        """Vertices in map coordinates, metres."""
        return self.points + self.origin

    def only(self, keep: NDArray[np.bool_]) -> Mesh:
        """Return some of the triangles, with the vertices that they use."""
        whole = bool(keep.all())
        some = slice(None) if whole else np.flatnonzero(keep)
        triangles, patch, uv = self.triangles[some], self.patch[some], self.uv[some]
        used = np.zeros(len(self.points), bool)
        used[triangles] = True
        if not used.all():
            triangles = (np.cumsum(used) - 1)[triangles]
        return Mesh(self.points[used], triangles, patch, uv, self.origin, self.names)


def triangulate(patches: Sequence[Patch], origin: Floats, tolerance: Tolerance = 0.05) -> Mesh:
    """Return triangles of whole patches.

    Every knot span is cut so finely that a triangle leaves the surface by about ``tolerance`` at most; spans
    that bend little stay whole. Neighbouring patches that share an edge curve share its vertices, so seams
    are closed exactly.

    Parameters
    ----------
    patches : sequence of Patch
        Any patches, steep and overturned ones included.
    origin : (3,) array
        Offset that turns the patches' coordinates into map coordinates, metres.
    tolerance : float or callable
        Largest distance between triangle and surface in metres. A function gives it for the cells between
        neighbouring knots, from boxes that hold them: a view asks for more where it is near.

    Raises
    ------
    SettingsError
        If the tolerance is not above 0, or so small that the triangles do not fit into memory.

    Notes
    -----
    A triangle with sides h_u, h_v in the parameters leaves the surface by at most
    (h_u^2 |S_uu.n| + 2 h_u h_v |S_uv.n| + h_v^2 |S_vv.n|) / 8 (Filip, Magedson, Markot 1986, "Surface
    algorithms using bounds on derivatives"). Second derivatives of a cubic are largest at the ends of spans.
    """
    if not callable(tolerance) and (not is_finite(tolerance) or tolerance <= 0):
        raise SettingsError(
            message(
                "geometry.chordal-tolerance-not-positive",
                "The chordal tolerance is {tolerance}; give metres above 0.",
                tolerance=shown(tolerance),
            )
        )
    origin = np.asarray(origin, float)
    lines = [_lines(patch, _in_cells(patch, origin, tolerance)) for patch in patches]
    count = _count(lines)
    if count > MOST:
        raise SettingsError(
            message(
                "geometry.too-many-triangles",
                "A chordal tolerance of {tolerance:.3g} m makes {count:.2g} triangles; at most {most:.0e} are made. "
                "Give a larger tolerance.",
                tolerance=min(float(np.min(_in_cells(patch, origin, tolerance))) for patch in patches),
                count=count,
                most=MOST,
            )
        )
    table = _Vertices()
    edges = _shared_edges(tuple(patches), lines)
    parts = [_patch_triangles(patch, lines[k], edges[k], table) for k, patch in enumerate(patches)]
    mesh = Mesh(
        points=np.concatenate(table.points),
        triangles=np.concatenate([triangles for triangles, _ in parts]),
        patch=np.repeat(np.arange(len(parts)), [len(triangles) for triangles, _ in parts]),
        uv=np.concatenate([uv for _, uv in parts]),
        origin=origin,
        names=tuple(patch.name for patch in patches),
    )
    t = mesh.triangles
    return mesh.only((t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0]))


def triangle_count(patches: Sequence[Patch], origin: Floats, tolerance: Tolerance) -> int:
    """Return about how many triangles :func:`triangulate` makes of whole patches."""
    return _count([_lines(patch, _in_cells(patch, np.asarray(origin, float), tolerance)) for patch in patches])


def _count(lines: list[tuple[Floats, Floats]]) -> int:
    return sum(2 * (len(u) - 1) * (len(v) - 1) for u, v in lines)


def cell_boxes(patch: Patch, origin: Floats) -> tuple[Floats, Floats]:
    """Return the least and the largest map coordinates, (nu, nv, 3), of each cell's control points, which hold it."""
    first = [
        np.searchsorted(knots, np.unique(knots)[:-1], side="right") - 1 - degree
        for knots, degree in zip((patch.knots_u, patch.knots_v), patch.degree, strict=True)
    ]
    ends = []
    for least in (np.minimum, np.maximum):
        rows = least.reduce([patch.control[first[0] + k] for k in range(patch.degree[0] + 1)])
        ends.append(least.reduce([rows[:, first[1] + k] for k in range(patch.degree[1] + 1)]) + origin)
    return ends[0], ends[1]


def _in_cells(patch: Patch, origin: Floats, tolerance: Tolerance) -> Floats:
    """Return the tolerance in each cell (nu, nv), or one for all (1, 1)."""
    if not callable(tolerance):
        return np.array([[tolerance]], float)
    low, high = cell_boxes(patch, origin)
    return tolerance(low.reshape(-1, 3), high.reshape(-1, 3)).reshape(low.shape[:2])


def _lines(patch: Patch, tolerance: Floats) -> tuple[Floats, Floats]:
    """Choose the parameter lines in u and v: every knot, and between as many as bend and tolerance (nu, nv) ask."""
    breaks = np.unique(patch.knots_u), np.unique(patch.knots_v)
    asked = [bend / tolerance for bend in patch.prepared(_bends)]
    return _cut(breaks[0], asked[0].max(axis=1)), _cut(breaks[1], asked[1].max(axis=0))


def _bends(patch: Patch) -> tuple[Floats, Floats]:
    """Return the tolerance in metres for which a cell (nu, nv) stays whole along u, and along v; k^2 of it make k."""
    cells = tabulate((patch,))
    # The corners of each cell, from its inside: at double knots the second derivative jumps.
    s, t = (np.repeat(np.array(ends) * (1 - 2e-9), len(cells.patch)) for ends in ((-1, 1, -1, 1), (-1, -1, 1, 1)))
    _, ds, dt, dss, dst, dtt = cells.jets(Place(np.tile(np.arange(len(cells.patch)), 4), np.stack([s, t])))
    cross = np.stack([ds[i] * dt[j] - ds[j] * dt[i] for i, j in ((1, 2), (2, 0), (0, 1))])
    normal = cross / np.maximum(np.linalg.norm(cross, axis=0), 1e-300)
    ss, st, tt = (np.abs((second * normal).sum(axis=0)) for second in (dss, dst, dtt))
    length_s, length_t = (np.maximum(np.linalg.norm(first, axis=0), 1e-300) for first in (ds, dt))
    along = ss + st * length_s / length_t, tt + st * length_t / length_s
    bend_u, bend_v = (bend.reshape(4, *cells.shape[0]).max(axis=0) for bend in along)
    return bend_u, bend_v


def _cut(breaks: Floats, asked: Floats) -> Floats:
    pieces = np.ceil(np.sqrt(asked)).clip(1, FINEST).astype(int)
    if pieces.sum() == 1:
        pieces[0] = 2  # the triangles between edge and inside need one line inside
    spans = zip(breaks[:-1], breaks[1:], pieces, strict=True)
    return np.append(np.concatenate([np.linspace(a, b, n, endpoint=False) for a, b, n in spans]), breaks[-1])


class _Vertices:
    """Vertices as they are made, by number."""

    def __init__(self) -> None:
        self.points: list[Floats] = []
        self.count = 0
        self._corners: list[tuple[Floats, int]] = []

    def add(self, points: Floats) -> Ints:
        self.points.append(points)
        self.count += len(points)
        return np.arange(self.count - len(points), self.count)

    def corner(self, point: Floats) -> int:
        for known, number in self._corners:
            if np.abs(known - point).max() <= WELD:
                return number
        number = int(self.add(point[None])[0])
        self._corners.append((point, number))
        return number


@dataclass(eq=False)
class _Curve:
    """One edge curve: its parameters, and its vertices once the first patch has made them."""

    t: Floats
    inner: Ints | None = None


@dataclass(frozen=True, eq=False)
class _Edge:
    """A patch's edge on a curve; ``flip`` if it runs against it."""

    curve: _Curve
    flip: bool


def _shared_edges(patches: tuple[Patch, ...], lines: list[tuple[Floats, Floats]]) -> list[list[_Edge]]:
    """Give each patch its edges south, east, north, west; edges with one curve share their parameters."""
    known: list[tuple[Floats, Floats, _Curve]] = []
    result = []
    for patch, (u, v) in zip(patches, lines, strict=True):
        edges = []
        for side, t in enumerate((u, v, u, v)):
            poles, knots = _edge_curve(patch, side)
            share = (t - t[0]) / (t[-1] - t[0])
            for other, other_knots, curve in known:
                flip = _same(poles, knots, other, other_knots)
                if flip is not None:
                    curve.t = _union(curve.t, 1 - share[::-1] if flip else share)
                    edges.append(_Edge(curve, flip))
                    break
            else:
                curve = _Curve(share)
                known.append((poles, knots, curve))
                edges.append(_Edge(curve, False))
        result.append(edges)
    return result


def _edge_curve(patch: Patch, side: int) -> tuple[Floats, Floats]:
    """Return homogeneous control points and knots, scaled to 0..1, of an edge in ascending u or v."""
    weights = (np.ones(patch.control.shape[:2]) if patch.weights is None else patch.weights)[..., None]
    poles = np.concatenate([weights * patch.control, weights], axis=2)
    poles = (poles[:, 0], poles[-1], poles[:, -1], poles[0])[side]
    knots = patch.knots_u if side % 2 == 0 else patch.knots_v
    return poles, (knots - knots[0]) / (knots[-1] - knots[0])


def _same(poles: Floats, knots: Floats, other: Floats, other_knots: Floats) -> bool | None:
    """Whether two curves are one: False as they stand, True if one is reversed, None if they are not."""
    degree = len(knots) - len(poles) - 1
    if degree != len(other_knots) - len(other) - 1:
        return None
    for flip in (False, True):
        turned, scale = (poles[::-1], 1 - knots[::-1]) if flip else (poles, knots)
        if np.abs(turned[[0, -1]] - other[[0, -1]]).max() <= WELD and _one_curve(
            turned, scale, other, other_knots, degree
        ):
            return flip
    return None


def _one_curve(poles: Floats, knots: Floats, other: Floats, other_knots: Floats, degree: int) -> bool:
    """Whether two curves with equal ends are one on the knots of both: one may have been refined."""
    own, others = np.round(knots, 9), np.round(other_knots, 9)
    if np.array_equal(own, others):
        return bool(np.abs(poles - other).max() <= WELD)
    both = bspline.common_knots(own, others)
    first, second = (bspline.insertion_matrix(k, both, degree) @ p for k, p in ((own, poles), (others, other)))
    return bool(np.abs(first - second).max() <= WELD)


def _union(first: Floats, second: Floats) -> Floats:
    both = np.sort(np.concatenate([first, second]))
    merged = both[np.append(np.diff(both) > 1e-9, True)]
    merged[0], merged[-1] = 0.0, 1.0
    return np.asarray(merged)


def _patch_triangles(
    patch: Patch, lines: tuple[Floats, Floats], edges: list[_Edge], table: _Vertices
) -> tuple[Ints, Floats]:
    """Triangulate a patch: a grid inside, and four strips that join it to the edges' own vertices."""
    u, v = lines
    inside = table.add(patch.evaluate(u[1:-1, None], v[None, 1:-1]).reshape(-1, 3)).reshape(len(u) - 2, len(v) - 2)
    where = {}
    grid_uv = np.stack(np.meshgrid(u[1:-1], v[1:-1], indexing="ij"), axis=-1)
    a, b, c, d = inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]
    pa, pb, pc, pd = grid_uv[:-1, :-1], grid_uv[1:, :-1], grid_uv[1:, 1:], grid_uv[:-1, 1:]
    triangles = [np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    uvs = [np.stack(t, axis=-2).reshape(-1, 3, 2) for t in ((pa, pb, pc), (pa, pc, pd))]
    for side, edge in enumerate(edges):
        where[side] = _edge_vertices(patch, side, edge, table)
    # Counter-clockwise around the patch: the edge outside on the right hand, the grid on the left.
    inner = (
        (inside[:, 0], grid_uv[:, 0], u[1:-1]),
        (inside[-1], grid_uv[-1], v[1:-1]),
        (inside[::-1, -1], grid_uv[::-1, -1], -u[-2:0:-1]),
        (inside[0, ::-1], grid_uv[0, ::-1], -v[-2:0:-1]),
    )
    for side, (numbers, places, t) in enumerate(inner):
        outer_numbers, outer_places = where[side]
        outer_t = outer_places[:, side % 2]
        if side >= 2:
            outer_numbers, outer_places, outer_t = outer_numbers[::-1], outer_places[::-1], -outer_t[::-1]
        strip, strip_uv = _strip(outer_numbers, outer_places, outer_t, numbers, places, t)
        triangles.append(strip)
        uvs.append(strip_uv)
    return np.concatenate(triangles), np.concatenate(uvs)


def _edge_vertices(patch: Patch, side: int, edge: _Edge, table: _Vertices) -> tuple[Ints, Floats]:
    """Return numbers and parameters of an edge's vertices in ascending u or v; make them if they are new."""
    u0, u1, v0, v1 = patch.domain
    share = 1 - edge.curve.t[::-1] if edge.flip else edge.curve.t
    start, end = (u0, u1) if side % 2 == 0 else (v0, v1)
    t = start + share * (end - start)
    t[-1] = end
    fixed = np.full_like(t, (v0, u1, v1, u0)[side])
    uv = np.stack([t, fixed] if side % 2 == 0 else [fixed, t], axis=-1)
    ends = patch.evaluate(uv[[0, -1], 0], uv[[0, -1], 1])
    first, last = table.corner(ends[0]), table.corner(ends[1])
    if edge.curve.inner is None:
        numbers = table.add(patch.evaluate(uv[1:-1, 0], uv[1:-1, 1]))
        edge.curve.inner = numbers[::-1] if edge.flip else numbers
    inner = edge.curve.inner[::-1] if edge.flip else edge.curve.inner
    return np.concatenate([[first], inner, [last]]), uv


def _strip(
    outer: Ints, outer_uv: Floats, outer_t: Floats, inner: Ints, inner_uv: Floats, inner_t: Floats
) -> tuple[Ints, Floats]:
    """Join two chains that run side by side, outer to the right: always advance where the next middle is first."""
    steps_o, steps_i = len(outer) - 1, len(inner) - 1
    middle = np.concatenate([(outer_t[:-1] + outer_t[1:]) / 2, (inner_t[:-1] + inner_t[1:]) / 2])
    order = np.argsort(middle, kind="stable")
    of_outer = order < steps_o
    at_o: Ints = np.cumsum(of_outer) - of_outer
    at_i: Ints = np.cumsum(~of_outer) - ~of_outer
    corner = np.where(of_outer, at_o + 1, at_i + 1)
    numbers = np.where(of_outer, outer[corner.clip(0, steps_o)], inner[corner.clip(0, steps_i)])
    places = np.where(of_outer[:, None], outer_uv[corner.clip(0, steps_o)], inner_uv[corner.clip(0, steps_i)])
    triangles = np.stack([outer[at_o], numbers, inner[at_i]], axis=-1)
    return triangles, np.stack([outer_uv[at_o], places, inner_uv[at_i]], axis=1)


def trim_to_outline(mesh: Mesh, patches: Sequence[Patch], outline: Floats) -> Mesh:
    """Return the triangles of patches that lie within a plan polygon (k, 2) of map coordinates.

    On the outline the vertices of a height field lie on the surface, those of any other patch on the triangle that
    was cut.
    """
    before = len(mesh.points)
    plan = np.asarray(outline, float) - mesh.origin[:2]
    points, triangles, parent, uv = clip(mesh.points, mesh.triangles, mesh.uv, plan)
    patch = mesh.patch[parent]
    for k, one in enumerate(patches):
        if plan_map(one) is not None:
            corner = (triangles >= before) & (patch == k)[:, None]
            points[triangles[corner], 2] = one.evaluate(uv[corner][:, 0], uv[corner][:, 1])[:, 2]
    whole = Mesh(points, triangles, patch, uv, mesh.origin, mesh.names)
    return whole.only(np.ones(len(triangles), bool))

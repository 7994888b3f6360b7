"""Faces of a file that end at curves within their patches: distance, height and triangles end there too.

The patch of a trimmed face reaches beyond the face. A point whose foot on the patch lies outside the loops is
measured again, to the loops themselves and to the feet that lie inside them, whichever is nearest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from geofit.geometry.box_tree import neighbours_together
from geofit.geometry.cells import Cells, Place, refine_foot_points, tabulate
from geofit.geometry.clip import clip
from geofit.geometry.elevation import plan_map
from geofit.geometry.mesh import WELD, Mesh
from geofit.geometry.mesh_projection import ASIDE
from geofit.geometry.projection import COMPILED, Projection, project, searchable
from geofit.geometry.trim_search import Pieces, TrimSearch
from geofit.splines.patch import Patch

__all__ = ["Loops", "beyond_edge", "inside_loops", "nearest_on_trimmed", "trim"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
#: Loops of each patch in its parameters, (k, 2) each, not closed; none where the patch is whole.
Loops = tuple[tuple[Floats, ...], ...]

#: A place within this share of the patch beyond a loop is on it.
ON = 1e-9
#: Places in a patch that searches start from, along each side, and about so many along all loops of a patch.
LATTICE, AROUND = 60, 2000
#: Starts of each point on the loops and inside them, and steps of the golden section along a loop.
STARTS, STEPS = 4, 60
#: How much longer than its chord half a piece of a loop may be; steps of Newton's method, and the last one, of 0 to 1.
SLACK, NEWTON, REST = 1.5, 12, 1e-11
#: How much farther from its chord a piece may be than at three places of it.
BENT = 2.0


def nearest_on_trimmed(patches: Sequence[Patch], xyz: ArrayLike, loops: Loops = ()) -> Projection:
    """Find the nearest place of trimmed patches to each point.

    Parameters
    ----------
    patches : sequence of Patch
        The surface.
    xyz : (n, 3) array_like
        Points in the patches' coordinates, metres.
    loops : Loops
        Loops of each patch; what they enclose (even-odd) is the face.

    Returns
    -------
    Projection
        ``beyond`` marks points beyond the edge, whose foot point is on it.
        A loop that is curved in the parameters is the polygon that was sampled along it.
    """
    target = np.asarray(xyz, float).reshape(-1, 3)
    found = project(patches, target)
    found = replace(found, beyond=beyond_edge(patches, target, found))
    assert found.beyond is not None
    if any(loops):
        within = np.ones(len(target), bool)
        for k in range(len(patches)):
            own = found.patch == k
            within[own] = inside_loops(patches[k], loops[k], found.u[own], found.v[own])
        again = np.flatnonzero(~within)
        if again.size:
            measured = _measured_again if len(again) < COMPILED else _searched_again
            better, on_rim = measured(patches, loops, target[again], found[again])
            found.u[again], found.v[again] = better.u, better.v
            found.foot[again], found.patch[again] = better.foot, better.patch
            found.distance[again] = np.copysign(better.distance, found.distance[again])
            found.beyond[again] = on_rim
    return found


def _measured_again(patches: Sequence[Patch], loops: Loops, target: Floats, _: Projection) -> tuple[Projection, Bools]:
    """Return the nearest places on the loops or inside them, and which are on the loops."""
    rim, face = _rim_foot_points(patches, loops, target), _inner_foot_points(patches, loops, target)
    on_rim = rim.distance <= face.distance
    return Projection(
        np.minimum(rim.distance, face.distance),
        np.where(on_rim[:, None], rim.foot, face.foot),
        np.where(on_rim, rim.patch, face.patch),
        np.where(on_rim, rim.u, face.u),
        np.where(on_rim, rim.v, face.v),
        np.ones(len(target), bool),
    ), on_rim


def _searched_again(
    patches: Sequence[Patch], loops: Loops, target: Floats, beyond: Projection
) -> tuple[Projection, Bools]:
    """Return the same for very many points, by compiled loops."""
    surface = searchable(patches)
    u, v = surface.cells.parameters(surface.place)
    on_face = np.zeros(len(u), bool)
    for k, patch in enumerate(patches):
        own = surface.patch == k
        on_face[own] = inside_loops(patch, loops[k], u[own], v[own])
    order, back = neighbours_together(target)
    found, on_rim = TrimSearch(patches, loops, _pieces(patches, loops), on_face).nearest(target[order], beyond[order])
    return found[back], on_rim[back]


def beyond_edge(patches: Sequence[Patch], target: Floats, found: Projection) -> Bools:
    """Mark points (n, 3) whose foot point is on an outer edge of the patches, and not straight below them."""
    result = np.zeros(len(target), bool)
    for k, patch in enumerate(patches):
        own = np.flatnonzero(found.patch == k)
        low, high = np.array(patch.domain).reshape(2, 2).T
        at = np.stack([found.u[own], found.v[own]], axis=1)
        own = own[((at - low <= ON * (high - low)) | (high - at <= ON * (high - low))).any(axis=1)]
        if not own.size:
            continue
        u, v = found.u[own], found.v[own]
        cross = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1))
        normal = cross / np.maximum(np.linalg.norm(cross, axis=1), 1e-300)[:, None]
        away = target[own] - found.foot[own]
        aside = away - np.einsum("nk,nk->n", away, normal)[:, None] * normal
        own = own[np.linalg.norm(aside, axis=1) > ASIDE]
        others = [other for j, other in enumerate(patches) if j != k]
        if own.size and others:
            own = own[np.abs(project(others, found.foot[own]).distance) > ASIDE]
        result[own] = True
    return result


def _region(patch: Patch, loops: tuple[Floats, ...]) -> Any:
    """Return what the loops enclose, in the patch's parameters stretched to a unit square."""
    import shapely

    low, high = np.array(patch.domain).reshape(2, 2).T
    region: Any = shapely.Polygon()
    for loop in loops:
        region = region.symmetric_difference(shapely.make_valid(shapely.Polygon((loop - low) / (high - low))))
    return region.buffer(ON, join_style="mitre")


def inside_loops(patch: Patch, loops: tuple[Floats, ...], u: Floats, v: Floats) -> Bools:
    """Whether parameters of a patch, arrays of one shape, lie inside its loops; all do where it has none."""
    import shapely

    if not loops:
        return np.ones(np.shape(u), bool)
    region = _region(patch, loops)
    shapely.prepare(region)
    u0, u1, v0, v1 = patch.domain
    return np.asarray(shapely.intersects_xy(region, (u - u0) / (u1 - u0), (v - v0) / (v1 - v0)))


def _rim_foot_points(patches: Sequence[Patch], loops: Loops, target: Floats) -> Projection:
    """Return the nearest places on the loops: on the short pieces around the nearest samples."""
    pieces = _pieces(patches, loops)
    start, way, part, middle, reach = pieces.start, pieces.way, pieces.patch, pieces.middle, pieces.reach
    count = min(2 * STARTS, len(start))
    found = cKDTree(middle).query(target, k=np.arange(1, count + 1))
    far, near = (np.asarray(values) for values in found)
    # A piece can hold the nearest place only if it reaches nearer than the middle of the nearest piece.
    point, column = np.nonzero(far - reach[near] <= far[:, :1])
    piece = near[point, column]
    t, distance, foot = np.empty(len(piece)), np.empty(len(piece)), np.empty((len(piece), 3))
    for k in np.unique(part[piece]):
        own = np.flatnonzero(part[piece] == k)
        t[own] = _nearest_along(patches[k], start[piece[own]], way[piece[own]], target[point[own]])
        foot[own] = patches[k].evaluate(*(start[piece[own]] + t[own, None] * way[piece[own]]).T)
        distance[own] = np.linalg.norm(foot[own] - target[point[own]], axis=1)
    order = np.lexsort((distance, point))
    best = order[np.flatnonzero(np.diff(point[order], prepend=-1))]
    u, v = (start[piece[best]] + t[best, None] * way[piece[best]]).T
    return Projection(distance[best], foot[best], part[piece[best]], u, v, np.ones(len(target), bool))


def _pieces(patches: Sequence[Patch], loops: Loops) -> Pieces:
    """Cut loops into short pieces of like length."""
    sides = []
    for k, patch in enumerate(patches):
        for loop in loops[k]:
            ends = np.roll(loop, -1, axis=0)
            chord = patch.evaluate(*ends.T) - patch.evaluate(*loop.T)
            sides.append((k, loop, ends - loop, np.linalg.norm(chord, axis=1)))
    # Pieces of like length: the nearest one of a straight side would not be among the first next to a finely bent side.
    length = sum(float(side[3].sum()) for side in sides) / (AROUND * sum(map(bool, loops)))
    starts, ways, places, owner = [], [], [], []
    for k, loop, way, size in sides:
        count = np.maximum(2, np.ceil(size / length)).astype(int)
        side = np.repeat(np.arange(len(loop)), count)
        share = (np.arange(len(side)) - np.repeat(np.cumsum(count) - count, count)) / count[side]
        starts.append(loop[side] + share[:, None] * way[side])
        ways.append(way[side] / count[side, None])
        places.append(patches[k].evaluate(*(starts[-1] + ways[-1] / 2).T))
        owner.append(np.full(len(side), k))
    start, way, part = np.concatenate(starts), np.concatenate(ways), np.concatenate(owner)
    middle = np.concatenate(places)
    at = np.empty((5, len(start), 3))
    for k in np.unique(part):
        own = part == k
        for edge in range(5):
            at[edge, own] = patches[k].evaluate(*(start[own] + edge / 4 * way[own]).T)
    reach = SLACK * np.linalg.norm(at[[0, 4]] - middle, axis=2).max(axis=0)
    share = np.array([0.25, 0.5, 0.75])[:, None, None]
    bent = np.linalg.norm(at[1:4] - (1 - share) * at[0] - share * at[4], axis=2).max(axis=0)
    return Pieces(start, way, part, middle, reach, np.ascontiguousarray(at[[0, 4]].swapaxes(0, 1)), BENT * bent)


def _nearest_along(patch: Patch, start: Floats, way: Floats, target: Floats) -> Floats:
    """Return where short pieces of curves, straight in a patch's parameters, are nearest to points, 0 to 1.

    Newton's method; a golden section where it does not come to rest.
    """
    t, left = np.full(len(start), 0.5), np.arange(len(start))
    for _ in range(NEWTON):
        u, v = (start[left] + t[left, None] * way[left]).T
        a, b = way[left].T[:, :, None]
        slope = a * patch.evaluate(u, v, 1, 0) + b * patch.evaluate(u, v, 0, 1)
        bend = a * a * patch.evaluate(u, v, 2, 0) + 2 * a * b * patch.evaluate(u, v, 1, 1)
        bend += b * b * patch.evaluate(u, v, 0, 2)
        away = patch.evaluate(u, v) - target[left]
        first = np.einsum("nk,nk->n", away, slope)
        square = np.einsum("nk,nk->n", slope, slope)
        second = square + np.einsum("nk,nk->n", away, bend)
        step = first / np.maximum(np.where(second > 0, second, square), 1e-300)
        moved = np.clip(t[left] - step, 0.0, 1.0)
        resting = np.abs(moved - t[left]) <= REST
        # Uphill of a bend there may be a nearer place.
        resting &= second > 0
        t[left] = moved
        left = left[~resting]
        if not left.size:
            return t

    def far(share: Floats) -> Floats:
        return np.asarray(
            np.linalg.norm(patch.evaluate(*(start[left] + share[:, None] * way[left]).T) - target[left], axis=1)
        )

    t[left] = _golden(far, len(left))
    return t


def _golden(value: Any, count: int) -> Floats:
    """Return where each of ``count`` functions of one variable is least in 0 to 1 (golden section)."""
    ratio = (np.sqrt(5) - 1) / 2
    low, high = np.zeros(count), np.ones(count)
    a, b = 1 - ratio * np.ones(count), ratio * np.ones(count)
    at_a, at_b = value(a), value(b)
    for _ in range(STEPS):
        left = at_a <= at_b
        low, high = np.where(left, low, a), np.where(left, b, high)
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        at_a, at_b = value(a), value(b)
    middle = (low + high) / 2
    ends = np.stack([np.zeros(count), middle, np.ones(count)])
    values = np.stack([value(t) for t in ends])
    return np.asarray(np.take_along_axis(ends, values.argmin(axis=0)[None], axis=0)[0])


def _inner_foot_points(patches: Sequence[Patch], loops: Loops, target: Floats) -> Projection:
    """Return the nearest feet inside the loops, infinitely far where there is none."""
    cells, tree, place = _lattice(patches, loops)
    count = min(STARTS, tree.n)
    start = np.asarray(tree.query(target, k=np.arange(1, count + 1))[1]).ravel()
    point = np.repeat(np.arange(len(target)), count)
    end = refine_foot_points(cells, place[start], np.ascontiguousarray(target[point].T))
    (u, v), part = cells.parameters(end), cells.patch[end.cell]
    foot = np.ascontiguousarray(cells.points(end).T)
    distance = np.linalg.norm(foot - target[point], axis=1)
    for k, patch in enumerate(patches):
        own = np.flatnonzero(part == k)
        distance[own[~inside_loops(patch, loops[k], u[own], v[own])]] = np.inf
    best = np.lexsort((distance, point))[::count]
    return Projection(distance[best], foot[best], part[best], u[best], v[best], np.ones(len(target), bool))


def _lattice(patches: Sequence[Patch], loops: Loops) -> tuple[Cells, cKDTree, Place]:
    """Return places inside the loops with a tree of them; one at least of each patch."""
    cells = tabulate(patches)
    parts = []
    for k, patch in enumerate(patches):
        u0, u1, v0, v1 = patch.domain
        u, v = (a.ravel() for a in np.meshgrid(np.linspace(u0, u1, LATTICE), np.linspace(v0, v1, LATTICE)))
        held = inside_loops(patch, loops[k], u, v)
        if not held.any():  # a sliver between the lattice's places
            some = _region(patch, loops[k]).representative_point()
            u, v, held = np.array([u0 + some.x * (u1 - u0)]), np.array([v0 + some.y * (v1 - v0)]), np.ones(1, bool)
        parts.append(cells.locate(k, u[held], v[held]))
    place = Place(np.concatenate([p.cell for p in parts]), np.concatenate([p.local for p in parts], axis=1))
    return cells, cKDTree(cells.points(place).T), place


def trim(mesh: Mesh, patches: Sequence[Patch], loops: Loops) -> Mesh:
    """Return the part of the patches' triangles that the loops enclose; new vertices lie on the patches.

    The triangles are cut in the parameters, where the loops are. New vertices of two patches at one location are one.
    Where parameters run so unevenly that a sliver would turn over, its vertices stay on the triangle that was cut.
    """
    points, triangles, uvs, owner = [mesh.points], [], [], []
    count = len(mesh.points)
    for k, patch in enumerate(patches):
        own = mesh.patch == k
        numbers, uv = mesh.triangles[own], mesh.uv[own]
        if loops[k]:
            stretch = _lengths(patch)
            # A patch that closes on itself has two parameters at each vertex of the line where it does.
            corners = np.column_stack([numbers.ravel(), uv.reshape(-1, 2)])
            corners, local = np.unique(corners, axis=0, return_inverse=True)
            known = corners[:, 0].astype(np.int64)
            flat = np.column_stack([corners[:, 1:] * stretch, mesh.points[known]])
            flat, cut, _, uv = clip(flat, local.reshape(-1, 3), uv, *(loop * stretch for loop in loops[k]))
            made = (flat[len(known) :, :2] / stretch).clip(patch.domain[::2], patch.domain[1::2])
            curved = np.concatenate([flat[: len(known), 2:], patch.evaluate(*made.T)])
            if plan_map(patch) is None:
                curved = _unturned(curved, flat[:, 2:], cut)
            points.append(curved[len(known) :])
            numbers = np.concatenate([known, count + np.arange(len(made))])[cut]
            count += len(made)
        triangles.append(numbers)
        uvs.append(uv)
        owner.append(np.full(len(numbers), k))
    every = np.concatenate(points)
    one = np.arange(count)
    first = len(mesh.points)
    for a, b in sorted(cKDTree(every[first:]).query_pairs(WELD)) if count > first else ():
        one[first + b] = one[first + a]
    t = one[np.concatenate(triangles)]
    whole = Mesh(every, t, np.concatenate(owner), np.concatenate(uvs), mesh.origin, mesh.names)
    return whole.only((t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0]))


def _unturned(curved: Floats, flat: Floats, triangles: Ints) -> Floats:
    """Return the curved places (n, 3) of vertices, but the flat ones where a triangle's normal would turn round."""

    def normals(at: Floats) -> Floats:
        a, b, c = np.moveaxis(at[triangles], 1, 0)
        return np.cross(b - a, c - a)

    facing, place = normals(flat), curved.copy()
    while True:
        turned = np.unique(triangles[(normals(place) * facing).sum(axis=1) <= 0])
        if np.array_equal(place[turned], flat[turned]):
            return place
        place[turned] = flat[turned]


def _lengths(patch: Patch) -> Floats:
    """Metres for one of each parameter: mean lengths of the control net's rows."""
    u0, u1, v0, v1 = patch.domain
    along, across = (np.linalg.norm(np.diff(patch.control, axis=k), axis=2).sum(axis=k).mean() for k in (0, 1))
    return np.array([along / (u1 - u0), across / (v1 - v0)])

"""Triangles as a surface: the nearest place to a point, and the height over the map. Pure functions over arrays."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from geofit.geometry.foot_points import Projection
from geofit.geometry.mesh import Mesh

__all__ = ["mesh_elevation", "nearest_on_mesh"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Triangles whose middle is nearest are measured first: the rest has to lie within what they give.
FIRST = 4
#: Places nearer than this (metres) are one.
SAME = 1e-9
#: A point counts as beside the triangles if its foot on the rim is farther than this from straight below, metres.
ASIDE = 1e-6
#: A place counts as over the triangles up to so many times their size beyond the edge (1e-6 m on a kilometre).
RIM = 1e-9
#: Points that are searched for together (memory).
CHUNK = 5_000


def nearest_on_mesh(mesh: Mesh, xyz: ArrayLike) -> Projection:
    """Find the nearest place of triangles to each point, exactly.

    The upper side is that of the triangles' normals, turned round if their mean points downwards. Where the
    foot is an edge or a corner, the triangle that looks at the point most squarely gives the side.

    Parameters
    ----------
    mesh : Mesh
        Triangles; those without an area are left out.
    xyz : (n, 3) array_like
        Points in the mesh's own coordinates (map coordinates minus its origin), metres.
    """
    target = np.asarray(xyz, float).reshape(-1, 3)
    corners = mesh.points[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    sound = np.flatnonzero(size > 1e-12 * size.max())
    corners, unit = corners[sound], normal[sound] / size[sound, None]
    mean = normal[sound].sum(axis=0)
    upwards = next((np.sign(c) for c in mean[::-1] if abs(c) > 1e-9 * np.abs(mean).max()), 1.0)
    finder = _Finder(corners)
    result = Projection.unknown(len(target))
    beyond = np.zeros(len(target), bool)
    rim_edges, rim_corners = _rim(mesh.triangles[sound])
    for k in range(0, len(target), CHUNK):
        batch = slice(k, k + CHUNK)
        point, triangle, foot, distance = finder.nearest(target[batch])
        square = np.abs(np.einsum("nk,nk->n", target[batch][point] - foot, unit[triangle]))
        best = _first_of_each(point, np.lexsort((-square, point)), len(target[batch]))
        chosen, foot = triangle[best], foot[best]
        away = target[batch] - foot
        height = np.einsum("nk,nk->n", away, unit[chosen])
        aside = np.sqrt(np.maximum((away**2).sum(axis=1) - height**2, 0.0)) > ASIDE
        result.distance[batch] = np.where(height * upwards < 0, -distance[best], distance[best])
        result.foot[batch], result.patch[batch] = foot, mesh.patch[sound[chosen]]
        beyond[batch] = aside & _on_rim(corners[chosen], foot, rim_edges[chosen], rim_corners[chosen])
    result.u[:], result.v[:], result.converged[:] = np.nan, np.nan, True
    return replace(result, beyond=beyond)


def _first_of_each(key: Ints, order: Ints, count: int) -> Ints:
    """Return for each of ``count`` keys the first member in an order that is sorted by key."""
    return np.asarray(order[np.searchsorted(key[order], np.arange(count))])


class _Finder:
    """Trees of the triangles' middles, one for each size of triangle: a small reach for the many small ones."""

    def __init__(self, corners: Floats) -> None:
        self.corners = corners
        self.middle = corners.mean(axis=1)
        self.radius = np.linalg.norm(corners - self.middle[:, None], axis=2).max(axis=1)
        self.all = cKDTree(self.middle)
        size = np.floor(np.log2(self.radius / self.radius.min())).astype(int)
        self.classes = [
            (members, cKDTree(self.middle[members]), float(self.radius[members].max()))
            for members in (np.flatnonzero(size == k) for k in np.unique(size))
        ]

    def nearest(self, target: Floats) -> tuple[Ints, Ints, Floats, Floats]:
        """Return pairs (point, triangle) with foot and distance, of which none is farther than the nearest."""
        first = min(FIRST, len(self.middle))
        near = self.all.query(target, k=np.arange(1, first + 1))[1]
        point, triangle = np.repeat(np.arange(len(target)), first), np.asarray(near).ravel()
        reach = np.full(len(target), np.inf)
        np.minimum.at(reach, point, self._measure(target, point, triangle)[1])
        points, triangles = [], []
        for members, tree, radius in self.classes:
            found = tree.query_ball_point(target, reach + radius + SAME)
            points.append(np.repeat(np.arange(len(target)), [len(some) for some in found]))
            triangles.append(members[np.fromiter(chain.from_iterable(found), np.int64)])
        point, triangle = np.concatenate(points), np.concatenate(triangles)
        foot, distance = self._measure(target, point, triangle)
        np.minimum.at(reach, point, distance)
        keep = distance <= reach[point] + SAME
        return point[keep], triangle[keep], foot[keep], distance[keep]

    def _measure(self, target: Floats, point: Ints, triangle: Ints) -> tuple[Floats, Floats]:
        p, corners = target[point], self.corners[triangle]
        foot = _foot(p, corners)
        return foot, np.linalg.norm(p - foot, axis=1)


def _foot(p: Floats, corners: Floats) -> Floats:
    """Return the nearest place (n, 3) of triangles (n, 3, 3) to points (n, 3): inside, or on one of the sides."""
    a = corners[:, 0]
    ab, ac = corners[:, 1] - a, corners[:, 2] - a
    normal = np.cross(ab, ac)
    square = np.einsum("nk,nk->n", normal, normal)
    best = p - (np.einsum("nk,nk->n", p - a, normal) / square)[:, None] * normal
    v = np.einsum("nk,nk->n", np.cross(best - a, ac), normal) / square
    w = np.einsum("nk,nk->n", np.cross(ab, best - a), normal) / square
    outside = (v < 0) | (w < 0) | (v + w > 1)
    least = np.where(outside, np.inf, 0.0)
    for k in range(3):
        start, way = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        t = np.einsum("nk,nk->n", p - start, way) / np.einsum("nk,nk->n", way, way)
        place = start + t.clip(0, 1)[:, None] * way
        far = np.linalg.norm(p - place, axis=1)
        nearer = far < least
        best[nearer], least = place[nearer], np.minimum(far, least)
    return np.asarray(best)


def _rim(triangles: Ints) -> tuple[Bools, Bools]:
    """Return (m, 3) which sides (corner k to the next one) belong to one triangle only, and which corners to such."""
    ends = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    _, number, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    free = count[number.reshape(-1)] == 1
    return free.reshape(-1, 3), np.isin(triangles, ends[free])


def _on_rim(corners: Floats, foot: Floats, edges: Bools, ends: Bools) -> Bools:
    """Whether each foot lies on a free side of its triangle, or on a corner of a free side of any."""
    at_corner = np.linalg.norm(corners - foot[:, None], axis=2) <= SAME
    way = np.roll(corners, -1, axis=1) - corners
    off = np.linalg.norm(np.cross(foot[:, None] - corners, way), axis=2) / np.linalg.norm(way, axis=2)
    return np.asarray(((off <= SAME) & edges).any(axis=1) | (at_corner & ends).any(axis=1))


def mesh_elevation(mesh: Mesh, x: ArrayLike, y: ArrayLike) -> Floats:
    """Return the height of triangles at map coordinates, metres: nan outside, the highest of several."""
    import shapely

    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    plan = np.stack([x.ravel() - mesh.origin[0], y.ravel() - mesh.origin[1]], axis=1)
    corners = mesh.points[mesh.triangles]
    low, high = corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)
    room = RIM * np.ptp(mesh.points[:, :2], axis=0).max()
    tree = shapely.STRtree(shapely.box(*(low - room).T, *(high + room).T))
    height = np.full(len(plan), -np.inf)
    for k in range(0, len(plan), CHUNK):
        point, triangle = tree.query(shapely.points(plan[k : k + CHUNK]))
        a, b, c = np.moveaxis(corners[triangle], 1, 0)
        d = plan[k + point] - a[:, :2]
        ab, ac = (b - a)[:, :2], (c - a)[:, :2]
        area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            margin = room * np.abs(np.concatenate([ab, ac], axis=1)).sum(axis=1) / np.abs(area)
            v = (d[:, 0] * ac[:, 1] - d[:, 1] * ac[:, 0]) / area
            w = (ab[:, 0] * d[:, 1] - ab[:, 1] * d[:, 0]) / area
            inside = (v >= -margin) & (w >= -margin) & (v + w <= 1 + margin) & (area != 0)
        z = a[:, 2] + v * (b - a)[:, 2] + w * (c - a)[:, 2]
        np.maximum.at(height, k + point[inside], z[inside])
    height[np.isneginf(height)] = np.nan
    return np.asarray((height + mesh.origin[2]).reshape(x.shape))

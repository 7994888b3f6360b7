"""The triangles of a surface that a control point moves: cut out of it, refined, and bent as it moves. No Qt."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.fitting.preview import MovePreview
from geofit.gui.view3d.shape import Shape, split

__all__ = ["MovedRegion", "moved_region"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Sides of the support a triangle's side, at least; triangles, at most.
STEPS, MOST = 24, 40_000


@dataclass(frozen=True, eq=False)
class MovedRegion:
    """What a control point moves, as triangles.

    Parameters
    ----------
    touched : (m,) array of bool
        Which triangles of the whole shape overlap the support.
    beside : Shape
        The parts of these that lie outside the support.
    inside : Shape
        Fine triangles of the support.
    share : (n,) array
        By how many metres each vertex of ``inside`` moves for a metre of the control point.
    """

    touched: Bools
    beside: Shape
    inside: Shape
    share: Floats

    def moved(self, by: Floats) -> Shape:
        """Return the triangles of the support after a move by (3,) metres, with their normals."""
        if not by.any():
            return self.inside
        xyz = self.inside.xyz + self.share[:, None] * by
        return replace(self.inside, xyz=xyz, normals=_normals(xyz, self.inside.triangles))


def moved_region(shape: Shape, preview: MovePreview) -> MovedRegion:
    """Cut what a control point moves out of a surface's triangles."""
    rim = preview.rim(0.0)
    low, high = rim.min(axis=0), rim.max(axis=0)
    wide = float(np.linalg.norm(high - low))
    corners = shape.xyz[shape.triangles]
    # Places on a fold have to be searched for: only those of triangles near to the support are.
    touched = _overlap(corners.min(axis=1), corners.max(axis=1), low - wide, high + wide)
    plane = np.full((len(shape.xyz), 2), np.nan)
    used = np.unique(shape.triangles[touched])
    plane[used] = preview.parameters(shape.xyz[used])
    u0, u1, v0, v1 = preview.support
    uv = plane[shape.triangles[touched]]
    touched[touched] = _overlap(uv.min(axis=1), uv.max(axis=1), np.array([u0, v0]), np.array([u1, v1]))
    piece = _compact(shape, shape.triangles[touched])
    for axis, sign, limit in ((0, 1, u0), (0, -1, u1), (1, 1, v0), (1, -1, v1)):
        piece = split(piece, sign * (preview.parameters(piece.xyz)[:, axis] - limit))
    middle = preview.parameters(piece.xyz[piece.triangles].mean(axis=1))
    within = (middle[:, 0] > u0) & (middle[:, 0] < u1) & (middle[:, 1] > v0) & (middle[:, 1] < v1)
    inside = _refined(_compact(piece, piece.triangles[within]), wide / STEPS)
    return MovedRegion(touched, _compact(piece, piece.triangles[~within]), inside, preview.shares(inside.xyz))


def _overlap(low: Floats, high: Floats, least: Floats, most: Floats) -> Bools:
    """Return which of (m, k) boxes share more than a border with another box."""
    return np.asarray(((low < most) & (high > least)).all(axis=1))


def _compact(shape: Shape, triangles: Ints) -> Shape:
    """Return some triangles with their own vertices alone."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return Shape(shape.xyz[used], numbers.reshape(-1, 3), shape.normals[used])


def _refined(shape: Shape, longest: float) -> Shape:
    """Return the triangles quartered until their sides are short enough, or there are many."""
    while len(shape.triangles) and 4 * len(shape.triangles) <= MOST:
        a, b, c = (shape.xyz[shape.triangles[:, k]] for k in range(3))
        if max(float(np.linalg.norm(side, axis=1).max()) for side in (b - a, c - b, a - c)) <= longest:
            break
        edges = np.sort(shape.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        pairs, number = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = (len(shape.xyz) + number.reshape(-1, 3)).T
        i, j, k = shape.triangles.T
        normals = shape.normals[pairs].mean(axis=1)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        shape = Shape(
            np.concatenate([shape.xyz, shape.xyz[pairs].mean(axis=1)]),
            np.concatenate([np.stack(t, axis=1) for t in ((i, ab, ca), (ab, j, bc), (ca, bc, k), (ab, bc, ca))]),
            np.concatenate([shape.normals, normals]),
        )
    return shape


def _normals(xyz: Floats, triangles: Ints) -> Floats:
    """Return unit normals at the vertices, upwards."""
    a, b, c = (xyz[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    cross *= np.where(cross[:, 2:] < 0, -1.0, 1.0)
    total = np.stack([np.bincount(triangles.ravel(), np.repeat(cross[:, k], 3), len(xyz)) for k in range(3)], axis=1)
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12))

"""Where the maximal balls touch the rock."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.balls import MaximalBalls

__all__ = ["contact_points"]

#: Least length of the mean of unit normals at a voxel that one plane may represent: below it, balls touch the voxel
#: from sides that oppose each other, as they do a single voxel of rock or a wall one voxel thick.
_ONE_SIDED = 0.25


def contact_points(balls: MaximalBalls, pore: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the points where balls touch the rock, and the outward normals there.

    A contact is a rock voxel at exactly F² from a centre. Its point lies half a voxel before its middle, towards the
    ball; its normal points from the centre to it, and is the mean over all balls that touch it, weighted by radius.
    Where these balls oppose each other, and at single voxels of rock, the contacts are the middles of the voxel's faces
    to the pores.

    Returns
    -------
    points : ndarray, shape (n, 3)
        In indices.
    normals : ndarray, shape (n, 3)
        Unit vectors in space (not in indices).
    """
    edges = np.array(balls.edges)
    flat, vectors = _contacts(balls.centre, balls.reach2.astype(np.float64), pore, edges)
    voxel, row = np.unique(flat, return_inverse=True)
    normals: NDArray[np.float64] = np.stack(
        [np.bincount(row, weights=vectors[:, axis], minlength=len(voxel)) for axis in range(3)], axis=1
    )
    length = np.linalg.norm(normals, axis=1)
    reach = np.bincount(row, weights=np.linalg.norm(vectors, axis=1), minlength=len(voxel))
    index = np.stack(np.unravel_index(voxel, pore.shape), axis=1)
    own, inward = _faces(index, pore)
    opposed = (length < _ONE_SIDED * reach) | (np.bincount(own, minlength=len(voxel)) == 6)
    faces = np.flatnonzero(opposed[own])
    one = np.ones(len(voxel), bool)
    one[own[faces]] = False
    normals = normals[one] / np.maximum(length[one], 1e-12)[:, None]
    points = np.concatenate([index[one] - 0.5 * normals / edges, index[own[faces]] - 0.5 * inward[faces]])
    return points, np.concatenate([normals, inward[faces]])


def _faces(index: NDArray[np.int64], pore: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the row of the rock voxel and the inward normal of each face between rock voxels and pores."""
    rows, normals = [], []
    for axis in range(3):
        for side in (-1, 1):
            step = side * (np.arange(3) == axis)
            inside = np.flatnonzero(((index + step >= 0) & (index + step < pore.shape)).all(axis=1))
            rows.append(inside[pore[tuple((index[inside] + step).T)]])
            normals.append(np.broadcast_to(-step.astype(np.float64), (len(rows[-1]), 3)))
    return np.concatenate(rows), np.concatenate(normals)


@njit(cache=True)
def _contacts(
    centre: NDArray[np.int32], reach2: NDArray[np.float64], pore: NDArray[np.bool_], edges: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    n = pore.shape
    flat = np.empty(4 * len(centre) + 16, np.int64)
    vectors = np.empty((len(flat), 3))
    count = 0
    for ball in range(len(centre)):
        radius = np.sqrt(reach2[ball])
        r0, r1 = int(radius / edges[0] + 1e-9), int(radius / edges[1] + 1e-9)
        for a in range(-r0, r0 + 1):
            for b in range(-r1, r1 + 1):
                rest = reach2[ball] - (a * edges[0]) ** 2 - (b * edges[1]) ** 2
                if rest < -1e-9:
                    continue
                c = int(np.sqrt(max(rest, 0.0)) / edges[2] + 0.5)
                if abs((c * edges[2]) ** 2 - rest) > 1e-9 * max(reach2[ball], 1.0):
                    continue
                for turn in range(2 if c > 0 else 1):
                    d = c if turn == 0 else -c
                    i, j, k = centre[ball, 0] + a, centre[ball, 1] + b, centre[ball, 2] + d
                    if i < 0 or j < 0 or k < 0 or i >= n[0] or j >= n[1] or k >= n[2] or pore[i, j, k]:
                        continue
                    if count == len(flat):
                        wider, longer = np.empty(2 * count, np.int64), np.empty((2 * count, 3))
                        wider[:count], longer[:count] = flat, vectors
                        flat, vectors = wider, longer
                    flat[count] = (i * n[1] + j) * n[2] + k
                    vectors[count, 0], vectors[count, 1], vectors[count, 2] = a * edges[0], b * edges[1], d * edges[2]
                    count += 1
    return flat[:count].copy(), vectors[:count].copy()

"""Medial points of a voxel body by a chamfer distance: the centres of its maximal chamfer balls.

The exact Euclidean counterpart is :func:`geofit.pores.balls.maximal_balls`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.medial.chamfer import chamfer_distance, step_weights
from geofit.medial.weights import INTEGER_WEIGHTS, world_factor

__all__ = ["MedialPoints", "chamfer_length", "including_values", "medial_points"]

Floats = NDArray[np.float64]

#: Face, edge and corner neighbour, of which every other is a mirror image or a permutation.
_KINDS = np.array([[1, 0, 0], [1, 1, 0], [1, 1, 1]])
_NEIGHBOURS = np.array(
    [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) != (0, 0, 0)]
)


@dataclass(frozen=True, eq=False)
class MedialPoints:
    """Medial points of a voxel body.

    Parameters
    ----------
    index : (n, 3) array of int
        Voxels, in the order of memory.
    value : (n,) array
        Chamfer distance from the nearest rock voxel, in units of the weights.
    distance : (n,) array
        The Euclidean distance that it approximates, in voxels.
    """

    index: NDArray[np.int64]
    value: Floats
    distance: Floats


def medial_points(void: ArrayLike, weights: ArrayLike = INTEGER_WEIGHTS, *, corrected: bool = True) -> MedialPoints:
    """Return the voxels whose chamfer ball no ball of a neighbour includes.

    Parameters
    ----------
    void : (nx, ny, nz) array of bool
        The body. The voxels beyond the faces of the volume count as rock.
    weights : (3,) array
        Chamfer weights of face, edge and corner steps.
    corrected : bool
        For integer weights, compare with the smallest ball that includes the ball of the voxel
        (:func:`including_values`). Without it, the comparison is the article's v[n] < v + w[n], which leaves included
        balls of small radius in the axis.

    Returns
    -------
    MedialPoints
        The union of the balls {q : d(p, q) < v} over these points is the body, exactly.

    Notes
    -----
    Guo, Peng and Li 1999, step 4, with the correction of Remy and Thiel 2002.
    """
    body = np.pad(np.asarray(void, dtype=bool), 1)
    w = np.asarray(weights)
    field = chamfer_distance(body, w)
    steps = step_weights(w)
    inside = np.argwhere(body)
    values = field[tuple(inside.T)]
    medial = np.ones(len(inside), dtype=bool)
    exact = corrected and np.issubdtype(steps.dtype, np.integer)
    table = including_values(int(values.max(initial=0)), w) if exact else None
    for step in _NEIGHBOURS:
        kind = int(np.abs(step).sum()) - 1
        there = field[tuple((inside + step).T)]
        # Sums of real weights are equal up to rounding only.
        medial &= there < (values + w[kind]) * (1.0 - 1e-12) if table is None else there < table[kind, values]
    chosen = values[medial].astype(np.float64)
    return MedialPoints(inside[medial] - 1, chosen, chosen * world_factor(w))


def including_values(largest: int, weights: ArrayLike = INTEGER_WEIGHTS) -> NDArray[np.int64]:
    """Return the smallest value of a neighbour whose ball includes that of a voxel.

    Parameters
    ----------
    largest : int
        Largest value of the distance map.
    weights : (3,) array of int
        Chamfer weights.

    Returns
    -------
    (3, largest + 1) array of int
        For face, edge and corner neighbours: 1 + max {d(q - g) : d(q) < r} for r = 0 .. largest (Remy and Thiel 2002).
    """
    w = np.asarray(weights)
    axis = np.arange(largest // int(w[0]) + 2)
    # The points of a ball that are farthest from g lie opposite to it: one octant is enough, with g reflected.
    q = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    own = chamfer_length(q, w)
    q, own = q[own < largest], own[own < largest]
    table = np.zeros((3, largest + 1), dtype=np.int64)
    for row, g in zip(table, _KINDS, strict=True):
        for turned in {tuple(np.roll(g, shift).tolist()) for shift in range(3)}:
            np.maximum.at(row, own + 1, chamfer_length(q + np.array(turned), w) + 1)
        np.maximum.accumulate(row, out=row)
    return table


def chamfer_length(offset: ArrayLike, weights: ArrayLike = INTEGER_WEIGHTS) -> NDArray[np.int64]:
    """Return the chamfer lengths (n,) of offsets (n, 3), in closed form, for integer weights."""
    m = np.sort(np.abs(np.asarray(offset)), axis=1)[:, ::-1]
    steps = np.column_stack([m[:, 0] - m[:, 1], m[:, 1] - m[:, 2], m[:, 2]])
    return np.asarray(steps @ np.asarray(weights))

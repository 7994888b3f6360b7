"""A tree of balls around places: what may lie near to a point is found without a number of neighbours fixed before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAF", "BallTree"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Places of a leaf.
LEAF = 8


@dataclass(frozen=True, eq=False)
class BallTree:
    """Balls of a full binary tree: node k has the nodes 2 k + 1 and 2 k + 2, the last level is the leaves.

    ``order`` (leaves * LEAF,) numbers of the places leaf by leaf, some of them twice; ``centre`` (nodes, 3) and
    ``radius`` (nodes,) of balls that contain the places with what each reaches around itself, metres; ``spacing`` and
    ``curvature`` (nodes,) the largest of a node's places.
    """

    order: Ints
    centre: Floats
    radius: Floats
    spacing: Floats
    curvature: Floats

    @classmethod
    def of(cls, points: Floats, reach: Floats, spacing: Floats, curvature: Floats) -> BallTree:
        """Return the tree of (n, 3) places with figures (n,) of each.

        Halved across the longest side, level by level (S. M. Omohundro, Five balltree construction algorithms, 1989).
        """
        levels = max(int(np.ceil(np.log2(max(len(points) / LEAF, 1)))), 0)
        order = np.resize(np.arange(len(points)), LEAF << levels)
        parts: list[list[Floats]] = [[], [], [], []]
        for level in range(levels + 1):
            members = order.reshape(1 << level, -1)
            at = points[members]
            low, high = at.min(axis=1), at.max(axis=1)
            centre = (low + high) / 2
            radius = (np.linalg.norm(at - centre[:, None], axis=2) + reach[members]).max(axis=1)
            for part, values in zip(
                parts, (centre, radius, spacing[members].max(axis=1), curvature[members].max(axis=1)), strict=True
            ):
                part.append(values)
            if level < levels:
                axis = np.argmax(high - low, axis=1)[:, None, None]
                along = np.take_along_axis(at, axis, axis=2)[..., 0]
                order = np.take_along_axis(members, np.argsort(along, axis=1, kind="stable"), axis=1).ravel()
        return cls(order, *(np.concatenate(part) for part in parts))

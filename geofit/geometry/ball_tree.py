"""A tree of balls around places: what may lie near to a point is found without a number of neighbours fixed before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAF", "BallTree", "neighbours_together"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Places of a leaf.
LEAF = 8


def neighbours_together(points: Floats) -> tuple[Ints, Ints]:
    """Return an order of (n, 3) points in which neighbours follow each other, and the one that leads back.

    A search finds the data of the next point in the cache. Z-order on a grid of 1,024 cells a side (G. M. Morton,
    1966).
    """
    low = points.min(axis=0)
    size = max(float((points.max(axis=0) - low).max()), 1e-300)
    code = np.zeros(len(points), np.int64)
    for k in range(3):
        x = ((points[:, k] - low[k]) * (1023 / size)).astype(np.int64)
        # Two zeros between any two binary digits.
        for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
            x = (x | (x << shift)) & mask
        code |= x << k
    order = np.argsort(code)
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return order, back


@dataclass(frozen=True, eq=False)
class BallTree:
    """Balls of a full binary tree: node k has the nodes 2 k + 1 and 2 k + 2, the last level is the leaves.

    ``order`` (leaves * LEAF,) numbers of the places leaf by leaf, some of them twice. ``nodes`` (nodes, 6): centre and
    radius of a ball that contains the places with what each reaches around itself, metres, the largest spacing and
    curvature of its places. ``leaves`` (leaves * LEAF, 5): position, spacing and curvature of the places in their
    order: what is looked at together lies together in memory.
    """

    order: Ints
    nodes: Floats
    leaves: Floats

    @classmethod
    def of(cls, points: Floats, reach: Floats, spacing: Floats, curvature: Floats) -> BallTree:
        """Return the tree of (n, 3) places with figures (n,) of each.

        Halved across the longest side, level by level (S. M. Omohundro, Five balltree construction algorithms, 1989).
        """
        levels = max(int(np.ceil(np.log2(max(len(points) / LEAF, 1)))), 0)
        order = np.resize(np.arange(len(points)), LEAF << levels)
        parts: list[Floats] = []
        for level in range(levels + 1):
            members = order.reshape(1 << level, -1)
            at = points[members]
            low, high = at.min(axis=1), at.max(axis=1)
            centre = (low + high) / 2
            radius = (np.linalg.norm(at - centre[:, None], axis=2) + reach[members]).max(axis=1)
            widest, bent = spacing[members].max(axis=1), curvature[members].max(axis=1)
            parts.append(np.column_stack([centre, radius, widest, bent]))
            if level < levels:
                axis = np.argmax(high - low, axis=1)[:, None, None]
                along = np.take_along_axis(at, axis, axis=2)[..., 0]
                order = np.take_along_axis(members, np.argsort(along, axis=1, kind="stable"), axis=1).ravel()
        leaves = np.column_stack([points, spacing, curvature])[order]
        return cls(order, np.concatenate(parts), leaves)

    @property
    def arrays(self) -> tuple[Ints, Floats, Floats]:
        """The tree as compiled loops take it."""
        return self.order, self.nodes, self.leaves

"""A tree of boxes around places: what may lie near to a point is found without a number of neighbours fixed before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAF", "BoxTree", "neighbours_together"]

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
class BoxTree:
    """Boxes of a full binary tree: node k has the nodes 2 k + 1 and 2 k + 2, the last level is the leaves.

    ``order`` (leaves * LEAF,) numbers of the places leaf by leaf, some of them twice. ``nodes`` (nodes, 8): lowest and
    highest corner of a box that contains the places with what each reaches around itself, metres, the largest spacing
    and curvature of its places. ``leaves`` (leaves * LEAF, 5): position, spacing and curvature of the places in their
    order: what is looked at together lies together in memory.
    """

    order: Ints
    nodes: Floats
    leaves: Floats

    @classmethod
    def of(cls, points: Floats, reach: Floats, spacing: Floats, curvature: Floats) -> BoxTree:
        """Return the tree of (n, 3) places with figures (n,) of each, halved across the longest side level by level."""
        levels = max(int(np.ceil(np.log2(max(len(points) / LEAF, 1)))), 0)
        order = np.resize(np.arange(len(points)), LEAF << levels)
        parts: list[Floats] = []
        for level in range(levels + 1):
            members = order.reshape(1 << level, -1)
            at, around = points[members], reach[members][..., None]
            low, high = at.min(axis=1), at.max(axis=1)
            widest, bent = spacing[members].max(axis=1), curvature[members].max(axis=1)
            parts.append(np.column_stack([(at - around).min(axis=1), (at + around).max(axis=1), widest, bent]))
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

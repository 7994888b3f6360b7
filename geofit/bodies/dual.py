"""The dual of a marching-cubes surface: quadrilaterals around the edges of a raster at which a field changes sign.

A corner for each polygon that marching cubes would draw in a cell (G. Nielson, "Dual marching cubes", IEEE
Visualization 2004): where two sheets pass through one cell each has its own corner, so the result is a manifold also
on coarse rasters. On a face with two inside nodes across, the inside is taken as separated, from both sides alike.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["dual_quads"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Places of the four edges along an axis, in the two other axes of a cell, counter-clockwise.
AROUND = ((0, 0), (1, 0), (1, 1), (0, 1))


def dual_quads(value: Floats) -> tuple[Floats, Ints] | None:
    """Return the corners (v, 3), in cells, and the quadrilaterals (q, 4) around a field's inside.

    None if the inside meets a side of the raster.

    Parameters
    ----------
    value : (nx, ny, nz) array
        The field at the nodes, negative inside.
    """
    inside = value < 0
    shape = np.array(value.shape) - 1
    pattern = np.zeros(shape, np.int64)
    for bit in range(8):
        x, y, z = bit & 1, bit >> 1 & 1, bit >> 2
        pattern |= inside[x : x + shape[0], y : y + shape[1], z : z + shape[2]].astype(np.int64) << bit
    rings, places = [], []
    for axis in range(3):
        low, high = [slice(None)] * 3, [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        changed = inside[tuple(low)] != inside[tuple(high)]
        at = np.argwhere(changed)
        first, second = value[tuple(low)][changed], value[tuple(high)][changed]
        place = at.astype(float)
        place[:, axis] += first / (first - second)
        ring = []
        for b, c in ((1, 1), (0, 1), (0, 0), (1, 0)):
            cell = at.copy()
            cell[:, (axis + 1) % 3] -= b
            cell[:, (axis + 2) % 3] -= c
            if len(cell) and ((cell < 0) | (cell >= shape)).any():
                return None
            polygon = _polygons()[pattern[tuple(cell.T)], 4 * axis + AROUND.index((b, c))]
            ring.append(4 * np.ravel_multi_index(tuple(cell.T), tuple(shape)) + polygon)
        quads = np.stack(ring, axis=1)
        out = ~inside[tuple(at.T)]
        quads[out] = quads[out][:, ::-1]
        rings.append(quads)
        places.append(place)
    used, index = np.unique(np.concatenate(rings), return_inverse=True)
    if not len(used):
        return None
    found = index.reshape(-1, 4).astype(np.int64)
    total, count = np.zeros((len(used), 3)), np.bincount(found.ravel(), minlength=len(used))
    for k in range(4):
        np.add.at(total, found[:, k], np.concatenate(places))
    return total / count[:, None], found


@cache
def _polygons() -> Ints:
    """Return the polygon (256, 12) to which each edge of a cell belongs, for each pattern of inside nodes."""
    edges = []
    for axis in range(3):
        for b, c in AROUND:
            start = (b << (axis + 1) % 3) | (c << (axis + 2) % 3)
            edges.append((start, start | 1 << axis))
    number = {frozenset(edge): k for k, edge in enumerate(edges)}
    faces = [
        [side << axis | b << (axis + 1) % 3 | c << (axis + 2) % 3 for b, c in AROUND]
        for axis in range(3)
        for side in (0, 1)
    ]
    table = np.full((256, 12), -1, np.int64)
    for pattern in range(256):
        inside = [bool(pattern >> node & 1) for node in range(8)]
        crossed = [k for k, (a, b) in enumerate(edges) if inside[a] != inside[b]]
        group = {k: k for k in crossed}
        for face in faces:
            sides = [number[frozenset((face[k - 1], face[k]))] for k in range(4)]
            met = [k for k in sides if k in group]
            # Side k ends at node k of the face, side k + 1 starts there: an inside node joins the two.
            pairs = [(sides[k], sides[(k + 1) % 4]) for k in range(4) if inside[face[k]]] if len(met) == 4 else [met]
            for a, b in (pair for pair in pairs if pair):
                old, new = group[a], group[b]
                group = {k: new if g == old else g for k, g in group.items()}
        names = sorted(set(group.values()))
        for k, g in group.items():
            table[pattern, k] = names.index(g)
    return table

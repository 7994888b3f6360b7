"""Voxel bodies with analytic truth: capsules and trees of round cones."""

from __future__ import annotations

import numpy as np


def cone_distance(points, a, b, ra, rb):
    """Distance of points from a round cone's axis, less the radius there: exact for capsules."""
    along = b - a
    t = np.clip(((points - a) @ along) / (along @ along), 0, 1)
    return np.linalg.norm(points - a - t[:, None] * along, axis=1) - (ra + (rb - ra) * t)


def branches(seed, levels=3, stem=55.0, radius=10.0):
    """A tree of 2^(levels + 1) - 1 branches: (start, end, radius at start, radius at end)."""
    rng = np.random.default_rng(seed)
    found = []

    def grow(start, direction, length, r, level):
        end = start + direction * length
        found.append((start, end, r, 0.7 * r))
        if level == 0:
            return
        side = np.cross(direction, rng.standard_normal(3))
        side /= np.linalg.norm(side)
        for sign in (-1, 1):
            angle = np.radians(rng.uniform(28, 42))
            grow(end, np.cos(angle) * direction + sign * np.sin(angle) * side, 0.8 * length, 0.68 * r, level - 1)

    grow(np.zeros(3), np.array([0.0, 0.0, 1.0]), stem, radius, levels)
    return found


def voxels(cones, edges=(1.0, 1.0, 1.0), pad=6.0):
    """Voxels whose centre is in the union of the cones, and the corner of the volume."""
    edges = np.asarray(edges)
    low = np.min([np.minimum(a, b) - max(ra, rb) for a, b, ra, rb in cones], axis=0) - pad
    high = np.max([np.maximum(a, b) + max(ra, rb) for a, b, ra, rb in cones], axis=0) + pad
    body = np.zeros(np.ceil((high - low) / edges).astype(int), dtype=bool)
    for a, b, ra, rb in cones:
        wide = max(ra, rb) + 2
        first = np.maximum(np.floor((np.minimum(a, b) - wide - low) / edges).astype(int), 0)
        last = np.minimum(np.ceil((np.maximum(a, b) + wide - low) / edges).astype(int), body.shape)
        box = tuple(slice(i, j) for i, j in zip(first, last, strict=True))
        grid = np.stack(np.meshgrid(*(np.arange(i, j) for i, j in zip(first, last, strict=True)), indexing="ij"), -1)
        inside = cone_distance((grid.reshape(-1, 3) + 0.5) * edges + low, a, b, ra, rb) < 0
        body[box] |= inside.reshape(grid.shape[:3])
    return body, low

"""Pore spaces with known truth."""

from __future__ import annotations

import numpy as np

LATTICES = {
    "sc": ([(0, 0, 0)], 0.5),
    "fcc": ([(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)], np.sqrt(2) / 4),
    "bcc": ([(0, 0, 0), (0.5, 0.5, 0.5)], np.sqrt(3) / 4),
}


def pack(lattice, a, cells, *, offset=0.5, radius=None):
    """Pores between spheres of a lattice with constant a; spheres touch unless a radius (in units of a) is given."""
    sites, touching = LATTICES[lattice]
    radius = touching if radius is None else radius
    x = (np.arange(a * cells) + offset) / a
    grid = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1)
    rock = np.zeros((a * cells,) * 3, bool)
    for site in sites:
        rock |= ((((grid - np.array(site) + 0.5) % 1) - 0.5) ** 2).sum(axis=-1) <= radius**2
    return ~rock


def capsules(shape, sticks, offset=0.0):
    """Union of thick sticks (start, end, radius)."""
    grid = np.stack(np.meshgrid(*(np.arange(n, dtype=float) for n in shape), indexing="ij"), axis=-1) + offset
    out = np.zeros(shape, bool)
    for start, end, radius in sticks:
        a, b = np.asarray(start, float), np.asarray(end, float)
        along = b - a
        t = np.clip(((grid - a) @ along) / max(along @ along, 1e-12), 0, 1)
        out |= ((grid - a - t[..., None] * along) ** 2).sum(axis=-1) <= radius**2
    return out


def turns(array):
    """The 48 rotations and reflections of a cubic array."""
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        for bits in range(8):
            turned = array.transpose(order)
            for axis in range(3):
                if bits >> axis & 1:
                    turned = np.flip(turned, axis)
            yield np.ascontiguousarray(turned)

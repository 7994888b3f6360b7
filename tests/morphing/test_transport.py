"""T25: a notched disc turned once on C2 splines comes back."""

from __future__ import annotations

import numpy as np

import geofit.implicit as implicit
from geofit.morphing.distance import redistanced

#: The disc of S. Zalesak (J. Comput. Phys. 31, 1979): radius 15, slot 5 wide and 25 long, in a square of 100.
RADIUS, WIDTH, LENGTH, AREA = 15.0, 5.0, 25.0, 582.207
STEPS = 90


def notched(xyz: np.ndarray) -> np.ndarray:
    """Signed distance by construction: disc less slot, upright columns."""
    x, y = xyz[:, 0] - 50.0, xyz[:, 1] - 75.0
    disc = np.hypot(x, y) - RADIUS
    slot = np.maximum(np.abs(x) - WIDTH / 2, y - (LENGTH - RADIUS))
    return np.maximum(disc, -slot)


def area(phi: np.ndarray, spacing: float) -> float:
    """Return the area of the middle layer: linear in triangles."""
    lattice = implicit.Lattice([0, 0, 0], spacing, (*phi.shape[:2], 2))
    return implicit.extent_of_samples(np.repeat(phi[:, :, 2:3], 2, axis=2), lattice).volume / spacing


def test_a_notched_disc_keeps_its_area_over_one_turn() -> None:
    for cells, limit in ((100, 0.02), (200, 0.005)):
        spacing = 100.0 / cells
        lattice = implicit.Lattice([0, 0, 0], spacing, (cells + 1, cells + 1, 5))
        phi = redistanced(notched(lattice.nodes()).reshape(lattice.shape), lattice, 8.0)
        xyz = lattice.nodes()
        middle = np.array([50.0, 50.0, 0.0])
        angle = 2 * np.pi / STEPS
        c, s = np.cos(angle), np.sin(angle)
        back = (xyz - middle) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) + middle
        low, high = lattice.bounds
        near = ((back >= low) & (back <= high)).all(axis=1)
        for _ in range(STEPS):
            moved = implicit.spline_grid(phi, lattice).value(np.clip(back, low, high))
            phi = np.where(near, moved, np.abs(moved) + spacing).reshape(lattice.shape)
        assert abs(area(phi, spacing) / AREA - 1) <= limit
        front = implicit.isosurface_of_samples(phi, lattice)
        assert np.abs(notched(front.vertices)).max() <= 1.5 * spacing

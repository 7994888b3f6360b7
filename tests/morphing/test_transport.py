"""T25: a notched disc and a notched sphere turned once on C2 splines come back."""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad

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


def once_around(phi: np.ndarray, lattice: implicit.Lattice) -> np.ndarray:
    """Return the samples after one turn about the upright line through the middle of the square."""
    xyz = lattice.nodes()
    middle = np.array([50.0, 50.0, 0.0])
    angle = 2 * np.pi / STEPS
    c, s = np.cos(angle), np.sin(angle)
    back = (xyz - middle) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) + middle
    low, high = lattice.bounds
    near = ((back >= low) & (back <= high)).all(axis=1)
    back = np.clip(back, low, high)
    for _ in range(STEPS):
        moved = implicit.spline_grid(phi, lattice).value(back)
        phi = np.where(near, moved, np.abs(moved) + lattice.spacing).reshape(lattice.shape)
    return phi


def test_a_notched_disc_keeps_its_area_over_one_turn() -> None:
    for cells, limit in ((100, 0.02), (200, 0.005)):
        spacing = 100.0 / cells
        lattice = implicit.Lattice([0, 0, 0], spacing, (cells + 1, cells + 1, 5))
        phi = redistanced(notched(lattice.nodes()).reshape(lattice.shape), lattice, 8.0)
        phi = once_around(phi, lattice)
        assert abs(area(phi, spacing) / AREA - 1) <= limit
        front = implicit.isosurface_of_samples(phi, lattice)
        assert np.abs(notched(front.vertices)).max() <= 1.5 * spacing


def test_a_notched_sphere_keeps_its_volume_over_one_turn() -> None:
    """On 100 cells a side, the slot that of the disc; layers without the sphere are left out."""

    def sphere(xyz: np.ndarray) -> np.ndarray:
        ball = np.linalg.norm(xyz - [50.0, 75.0, 50.0], axis=1) - RADIUS
        slot = np.maximum(np.abs(xyz[:, 0] - 50.0) - WIDTH / 2, xyz[:, 1] - 75.0 - (LENGTH - RADIUS))
        return np.maximum(ball, -slot)

    lattice = implicit.Lattice([0, 0, 25], 1.0, (101, 101, 51))
    phi = redistanced(sphere(lattice.nodes()).reshape(lattice.shape), lattice, 8.0)
    phi = once_around(phi, lattice)
    # Discs x = const of the sphere; the slot leaves of them what is above its end.
    cut = quad(lambda x: segment(np.sqrt(RADIUS**2 - x**2), LENGTH - RADIUS), -WIDTH / 2, WIDTH / 2)[0]
    truth = 4 / 3 * np.pi * RADIUS**3 - cut
    assert abs(implicit.extent_of_samples(phi, lattice).volume / truth - 1) <= 0.02
    front = implicit.isosurface_of_samples(phi, lattice)
    assert front.is_closed
    assert (front.components, front.euler) == (1, 2)
    assert np.abs(sphere(front.vertices)).max() <= 1.5 * lattice.spacing


def segment(radius: float, top: float) -> float:
    """Return the area of the part of a disc that lies below a line, from which its middle is ``top`` away."""
    return float(np.pi * radius**2 - radius**2 * np.arccos(top / radius) + top * np.sqrt(radius**2 - top**2))

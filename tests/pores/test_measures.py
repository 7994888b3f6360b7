"""Surface area, Euler number and connectivity."""

import numpy as np
import pytest
from brute import blobs
from scipy import ndimage
from shapes import capsules

from geofit.pores import RockVolume, connectivity, euler_number, surface_area


@pytest.mark.parametrize("radius", [10, 17.3, 40])
@pytest.mark.parametrize("offset", [0.0, 0.37])
def test_area_of_spheres(radius, offset):
    x = np.arange(-int(radius) - 2, int(radius) + 3) + offset
    ball = x[:, None, None] ** 2 + x[:, None] ** 2 + x**2 <= radius**2
    assert surface_area(ball) == pytest.approx(4 * np.pi * radius**2, rel=0.02)


def test_area_in_long_voxels():
    i, j, k = np.ogrid[-22:23, -22:23, -12:13]
    ball = i**2 + j**2 + (2 * k) ** 2 <= 400
    assert surface_area(ball, (1.0, 1.0, 2.0)) == pytest.approx(4 * np.pi * 400, rel=0.03)


@pytest.mark.parametrize(("body", "euler"), [("ball", 1), ("ring", 0), ("shell", 2), ("two", 2)])
def test_euler_numbers(body, euler):
    i, j, k = np.ogrid[-15:16, -15:16, -15:16]
    r2 = i**2 + j**2 + k**2
    shapes = {
        "ball": r2 <= 100,
        "ring": (np.sqrt(i**2 + j**2) - 9) ** 2 + k**2 <= 12,
        "shell": (r2 <= 150) & (r2 >= 50),
        "two": ((i - 8) ** 2 + j**2 + k**2 <= 16) | ((i + 8) ** 2 + j**2 + k**2 <= 16),
    }
    assert euler_number(shapes[body]) == euler
    assert euler_number(shapes[body], neighbours=26) == euler


def test_euler_number_is_parts_less_tunnels_plus_holes():
    """The Euler numbers of a body (6) and of its complement (26) agree up to the outside."""
    for seed in range(12):
        pore = np.pad(blobs(seed, (9, 8, 7)), 1)
        assert euler_number(pore) == euler_number(~np.pad(pore, 1), neighbours=26) - 1


def test_percolation_and_porosities():
    pore = capsules(
        (20, 20, 20), [((0, 5, 5), (19, 5, 5), 2), ((10, 15, 15), (10, 15, 19), 2), ((10, 14, 6), (10, 14, 6), 2)]
    )
    found = connectivity(RockVolume(pore, pore=True, voxel=1))
    assert found.percolates == (True, False, False)
    label, parts = ndimage.label(pore)
    assert found.parts == parts == 3
    size = np.bincount(label.ravel())[1:]
    assert found.connected == pytest.approx((size.sum() - size.min()) / pore.size)
    assert found.percolating == (pytest.approx(size.max() / pore.size), 0.0, 0.0)

"""Surface area, Euler number and connectivity."""

import numpy as np
import pytest
from brute import blobs
from scipy import ndimage
from shapes import capsules, turns

from geofit.pores import RockVolume, connectivity, euler_number, surface_area
from geofit.pores.representative import representative_volume


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


@pytest.mark.parametrize("slices", [1, 2, 4, 8, 20, 100])
def test_area_of_a_tube_through_few_slices(slices):
    """Slanted lines have fewer pairs of voxels than there are voxels, and missed walls next to the faces."""
    x = np.arange(-40, 41)
    disc = x[:, None] ** 2 + x**2 <= 30**2
    for axis in range(3):
        tube = np.moveaxis(np.repeat(disc[None], slices, axis=0), 0, axis)
        assert surface_area(tube) == pytest.approx(2 * np.pi * 30 * slices, rel=0.015)


def test_area_per_volume_does_not_depend_on_the_size_of_the_sample():
    whole = ndimage.gaussian_filter(np.random.default_rng(0).normal(size=(120,) * 3), 2.5, mode="wrap") > 0
    dense = surface_area(whole) / whole.size
    for edge in (10, 20, 40):
        cuts = [
            whole[i : i + edge, j : j + edge, k : k + edge]
            for i in range(0, 120, edge)
            for j in range(0, 120, edge)
            for k in range(0, 120, edge)
        ]
        assert np.mean([surface_area(cut) for cut in cuts]) / edge**3 == pytest.approx(dense, rel=0.01)


def test_area_does_not_depend_on_how_the_sample_is_turned():
    pore = blobs(3, (9, 8, 7))
    areas = [surface_area(turned) for turned in turns(pore)]
    assert areas == pytest.approx([areas[0]] * 48, rel=1e-12)


def test_area_of_planes_is_as_far_off_as_stated():
    layers = np.zeros((30, 30, 30), bool)
    layers[:15] = True
    assert surface_area(layers) / 900 == pytest.approx(1 - 0.074, abs=0.001)


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


@pytest.mark.parametrize("voxel", [(1e-6, 1e-6, 4e-6), (3e-6, 1e-6, 2e-6)])
def test_representative_cubes_are_cubes_in_metres(voxel):
    """Blocks of equal numbers of voxels are as long as the voxels; their edge was stated as if voxels were cubes."""
    shape = tuple(round(48e-6 / edge) for edge in voxel)
    pore = np.zeros(shape, bool)
    pore[:, :, : shape[2] // 2] = True
    found = representative_volume(RockVolume(pore, pore=True, voxel=voxel))
    assert found.edge[-1] == pytest.approx(48e-6)
    assert (found.count[-1], found.mean[-1]) == (1, 0.5)
    assert found.edge[0] == pytest.approx(4 * max(voxel), rel=0.15)
    assert found.count[0] == pytest.approx((48e-6 / found.edge[0]) ** 3, rel=0.3)

"""Networks of shapes with a known graph, of sphere packs and of real rock."""

import numpy as np
import pytest
from brute import blobs
from scipy import ndimage
from shapes import capsules, pack, turns

from geofit.pores import RockVolume, VolumeError, connectivity, network_permeability, pore_network


def network_of(pore, **options):
    return pore_network(RockVolume(pore, pore=True, voxel=1.0), **options)


@pytest.mark.parametrize("offset", [0.0, 0.5])
@pytest.mark.parametrize("a", [20, 40])
def test_simple_cubic_pack(a, offset):
    network = network_of(pack("sc", a, 3, offset=offset))
    assert len(network.pores) == 27
    assert len(network.throats) == 54
    assert network.coordination.max() == 6
    np.testing.assert_allclose(network.pores.inscribed, 0.366 * a, atol=0.5)
    np.testing.assert_allclose(network.throats.inscribed, 0.2071 * a, atol=0.5)


@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_face_centred_pack(offset):
    a = 40
    network = network_of(pack("fcc", a, 2, offset=offset))
    inner = ((network.pores.centre > a / 4) & (network.pores.centre < 2 * a - a / 4 - 1)).all(axis=1)
    wide = network.pores.inscribed > 0.11 * a
    assert set(network.coordination[inner & wide].tolist()) == {8}
    assert set(network.coordination[inner & ~wide].tolist()) == {4}
    sphere = a * np.sqrt(2) / 4
    np.testing.assert_allclose(network.pores.inscribed[inner & wide], 0.4142 * sphere, atol=0.5)
    np.testing.assert_allclose(network.pores.inscribed[inner & ~wide], 0.2247 * sphere, atol=0.5)
    np.testing.assert_allclose(network.throats.inscribed, 0.1547 * sphere, atol=0.5)


@pytest.mark.parametrize("a", [24, 40, 50])
def test_body_centred_pack(a):
    """In the middle of each face of a cell four pores meet in a wide place that is no throat of two of them."""
    network = network_of(pack("bcc", a, 2))
    sphere = a * np.sqrt(3) / 4
    inner = ~network.pores.faces.any(axis=1)
    np.testing.assert_allclose(network.pores.inscribed[inner], 0.2910 * sphere, atol=0.5)
    assert set(network.coordination[inner].tolist()) == {4}
    both = inner[network.throats.pores].all(axis=1)
    np.testing.assert_allclose(network.throats.inscribed[both], 0.2247 * sphere, atol=0.5)


def test_dumb_bell_two_pores_and_a_throat():
    body = capsules(
        (30, 30, 60),
        [((15, 15, 14), (15, 15, 14), 10), ((15, 15, 45), (15, 15, 45), 8), ((15, 15, 14), (15, 15, 45), 3)],
    )
    network = network_of(body)
    assert (len(network.pores), len(network.throats)) == (2, 1)
    assert network.pores.volume.sum() == body.sum()
    assert network.throats.radius[0] == pytest.approx(3, abs=0.5)
    assert network.percolates == (False, False, False)


def test_a_junction_of_three_arms_with_bulbs():
    middle = (32, 32, 32)
    tips = [(10, 32, 32), (45, 52, 32), (45, 12, 32)]
    sticks = [(middle, tip, 3) for tip in tips] + [(tip, tip, 7) for tip in tips] + [(middle, middle, 8)]
    network = network_of(capsules((64, 64, 64), sticks))
    assert len(network.pores) == 4
    assert sorted(network.coordination.tolist()) == [1, 1, 1, 3]


def test_two_windows_between_two_pores_are_two_throats():
    ends = [((20, 20, 12), (20, 20, 12), 9), ((20, 20, 48), (20, 20, 48), 9)]
    loops = [((12, 20, 12), (12, 20, 48), 2.5), ((28, 20, 12), (28, 20, 48), 2.5)]
    network = network_of(capsules((40, 40, 60), ends + loops))
    assert len(network.pores) == 2
    assert len(network.throats) == 2
    assert network.coordination.tolist() == [1, 1]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_straight_tube_is_one_pore_with_two_face_throats(axis):
    x = np.arange(24) - 11.5
    tube = np.moveaxis(np.repeat((x[:, None] ** 2 + x**2 <= 64)[None], 30, axis=0), 0, axis)
    for turned in (tube, np.flip(tube, axis)):
        network = network_of(np.ascontiguousarray(turned))
        assert (len(network.pores), len(network.throats), len(network.face_throats)) == (1, 0, 2)
        assert network.percolates == tuple(a == axis for a in range(3))


@pytest.mark.parametrize("shape", [(30, 8, 30), (20, 20, 20)])
def test_plates_and_cubes_are_one_pore(shape):
    network = network_of(np.pad(np.ones(shape, bool), 2))
    assert (len(network.pores), len(network.throats)) == (1, 0)


def signature(network):
    throats = np.sort(np.round(network.throats.area, 9))
    return (
        sorted(
            zip(
                network.pores.radius.tolist(), network.pores.volume.tolist(), network.coordination.tolist(), strict=True
            )
        ),
        throats.tolist(),
    )


def test_the_48_rotations_give_isomorphic_networks():
    field = ndimage.gaussian_filter(np.random.default_rng(5).random((32, 32, 32)), 1.6)
    pore = field < np.quantile(field, 0.3)
    truth = None
    for turned in turns(pore):
        found = signature(network_of(turned))
        truth = truth or found
        assert found == truth


@pytest.mark.parametrize("seed", range(24))
def test_the_network_connects_what_voxel_faces_connect(seed):
    volume = RockVolume(blobs(seed, (20, 18, 16)), pore=True, voxel=1)
    network, exact = pore_network(volume), connectivity(volume)
    assert network.percolates == exact.percolates
    assert network.pores.volume.sum() + network.dropped.volume.sum() == volume.pore.sum()
    if exact.connected > 0:
        assert network.porosity == pytest.approx(exact.connected)
    assert (network.throats.radius <= network.pores.radius[network.throats.pores].min(axis=1)).all()


def test_the_same_bytes_every_time(rock):
    volume = rock("berea_110")
    one, two = pore_network(volume), pore_network(volume)
    for name, column in vars(one.throats).items():
        assert column.tobytes() == getattr(two.throats, name).tobytes()
    assert one.pore_of.tobytes() == two.pore_of.tobytes()


def test_berea_200_against_lattice_boltzmann(rock):
    """1,433 mD along axis 0 by a lattice-Boltzmann run on the same voxels."""
    network = pore_network(rock("berea_200"))
    assert network_permeability(network).millidarcy[0] == pytest.approx(1433, rel=0.15)
    assert network.percolates == (True, True, True)


def test_parameters_out_of_range_are_errors():
    volume = RockVolume(np.zeros((3, 3, 3)), pore=0, voxel=1)
    for options in ({"tau": 0}, {"r_min": -1}, {"hierarchy": "tree"}):
        with pytest.raises(VolumeError):
            pore_network(volume, **options)

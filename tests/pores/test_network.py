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


def test_face_centred_pack_of_spheres_of_40_voxels():
    """PORES.md, test 9: octahedral and tetrahedral pores of one period, with 16 / 3 links on average.

    Contacts of spheres lie between voxels here; elsewhere on the grid they leak, and wide pores meet through them.
    """
    cell = 112
    network = network_of(np.tile(pack("fcc", cell, 1), (2, 2, 2)))
    period = ((network.pores.centre >= 0.6 * cell) & (network.pores.centre < 1.6 * cell)).all(axis=1)
    wide = network.pores.inscribed > 0.11 * cell
    assert (period & wide).sum() == 4
    assert (period & ~wide).sum() == 8
    assert network.coordination[period].mean() == pytest.approx(16 / 3, abs=1e-12)
    sphere = cell * np.sqrt(2) / 4
    np.testing.assert_allclose(network.pores.inscribed[period & wide], 0.4142 * sphere, atol=0.5)
    np.testing.assert_allclose(network.pores.inscribed[period & ~wide], 0.2247 * sphere, atol=0.5)
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


def labelled(network, rounds=4):
    """The graph without numbers: what each pore is, what its neighbours are, and so on outwards; and its throats."""
    pores, throats = network.pores, network.throats
    name = [hash(one) for one in zip(pores.radius.tolist(), pores.volume.tolist(), strict=True)]
    sections = np.round(np.column_stack([throats.radius, throats.area]), 9).tolist()
    links = list(zip(throats.pores.tolist(), map(tuple, sections), strict=True))
    for _ in range(rounds):
        around = [[] for _ in name]
        for (one, other), section in links:
            around[one].append((name[other], section))
            around[other].append((name[one], section))
        name = [hash((own, tuple(sorted(others)))) for own, others in zip(name, around, strict=True)]
    return sorted(name), sorted((*sorted((name[one], name[other])), section) for (one, other), section in links)


def test_the_48_rotations_give_isomorphic_networks():
    """PORES.md, test 29, on 64³ voxels."""
    field = ndimage.gaussian_filter(np.random.default_rng(5).random((64, 64, 64)), 1.9)
    truth, sums = None, None
    for turned in turns(field < np.quantile(field, 0.3)):
        network = network_of(turned)
        found = labelled(network)
        total = [network.pores.volume.sum(), *np.sort(network.throats.conductance)]
        truth, sums = truth or found, sums or total
        assert found == truth
        # The section of a throat is solved row by row to four digits.
        assert total == pytest.approx(sums, rel=1e-4)
    # Names tell nearly all pores apart, so equal names are an isomorphism; a few of a voxel or two are alike.
    assert len(truth[0]) > 100
    assert len(set(truth[0])) > 0.95 * len(truth[0])


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


def test_the_published_network_of_berea_400(rock, pore_data):
    """PORES.md, test 26: maximal balls of others on the same voxels; radii are those of balls centred on voxels."""
    from geofit.io.export.network import read_statoil

    volume, published = rock("berea_400"), read_statoil(pore_data / "icl_berea", "Berea")
    network = pore_network(volume)
    assert 3.3 <= network.coordination.mean() <= 4.5
    unit = network.unit
    assert network.pores.radius.mean() * unit == pytest.approx(published.pore_radius.mean(), rel=0.15)
    assert network.throats.radius.mean() * unit == pytest.approx(published.radius.mean(), rel=0.15)
    assert network.porosity == pytest.approx(connectivity(volume).connected, rel=0.005)
    assert network.porosity == pytest.approx(0.1961, rel=0.005)
    assert network.percolates == (True, True, True)


def test_parameters_out_of_range_are_errors():
    volume = RockVolume(np.zeros((3, 3, 3)), pore=0, voxel=1)
    for options in ({"tau": 0}, {"r_min": -1}, {"hierarchy": "tree"}):
        with pytest.raises(VolumeError):
            pore_network(volume, **options)

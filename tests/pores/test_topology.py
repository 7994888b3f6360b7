"""Parts, tunnels and cavities of the rebuilt pore space are those of its voxels."""

import numpy as np
import pytest
from shapes import pack

from geofit.medial.agreement import betti
from geofit.pores import RockVolume, pore_network, pore_surface
from geofit.pores import surface as surface_module
from geofit.pores.topology import topology_faults


@pytest.mark.parametrize("seed", range(60))
def test_volumes_without_faults_have_equal_betti_numbers(seed):
    """Turning simple voxels changes no Betti number, whatever is left."""
    rng = np.random.default_rng(seed)
    first = rng.random((7, 8, 9)) < rng.uniform(0.3, 0.8)
    second = first ^ (rng.random(first.shape) < rng.uniform(0.02, 0.3))
    left = topology_faults(first, second)
    turned = second.copy()
    turned[tuple(left.T)] ^= True
    assert betti(turned) == betti(first)
    assert set(map(tuple, left)) <= set(map(tuple, np.argwhere(first != second)))
    assert len(topology_faults(second, second)) == 0


def test_a_closed_throat_a_broken_wall_and_a_filled_cavity_are_faults():
    pore = np.ones((9, 9, 9), bool)
    pore[4] = False
    open_ = pore.copy()
    open_[4, 4, 4] = True
    assert topology_faults(pore, open_).tolist() == topology_faults(open_, pore).tolist() == [[4, 4, 4]]
    pore[4] = True
    grain = pore.copy()
    grain[4, 4, 4] = False
    assert topology_faults(pore, grain).tolist() == [[4, 4, 4]]
    thinner = pore.copy()
    thinner[0] = False
    assert len(topology_faults(thinner, pore)) == 0


def rebuilt(volume):
    network = pore_network(volume)
    return network.pore_of > 0, pore_surface(volume, network)


@pytest.mark.parametrize("lattice", ["sc", "bcc", "fcc"])
def test_packs_keep_their_betti_numbers(lattice):
    pore, body = rebuilt(RockVolume(pack(lattice, 30, 1), pore=True, voxel=1e-6))
    assert betti(body.voxels()) == betti(pore)


def test_without_the_rescue_contacts_of_spheres_are_torn_open(monkeypatch):
    volume = RockVolume(pack("fcc", 30, 1), pore=True, voxel=1e-6)
    pore, body = rebuilt(volume)
    assert len(body.held_open) + len(body.held_closed) > 0
    assert pore[tuple(body.held_open.T)].all()
    assert not pore[tuple(body.held_closed.T)].any()
    monkeypatch.setattr(surface_module, "RESCUES", 0)
    _, torn = rebuilt(volume)
    assert len(torn.held_open) == len(torn.held_closed) == 0
    assert betti(torn.voxels()) != betti(pore) == betti(body.voxels())


@pytest.mark.parametrize("name", ["berea_200", "ketton_256"])
def test_real_rocks_keep_their_betti_numbers(rock, name):
    volume = rock(name)
    pore, body = rebuilt(RockVolume(volume.pore[:80, :80, :80], pore=True, voxel=volume.voxel))
    assert betti(body.voxels()) == betti(pore)
    assert len(body.held_open) + len(body.held_closed) < 0.01 * pore.sum()
    assert body.porosity == pytest.approx(pore.mean(), rel=0.01)


def test_gradients_beside_held_voxels_are_those_of_the_values():
    _, body = rebuilt(RockVolume(pack("fcc", 30, 1), pore=True, voxel=1.0))
    places = np.concatenate([body.held_open, body.held_closed])[:40] + 0.5
    places = places + np.random.default_rng(0).uniform(-0.9, 0.9, places.shape)
    step = 1e-5
    differences = np.stack(
        [(body.value(places + step * e) - body.value(places - step * e)) / (2 * step) for e in np.eye(3)], 1
    )
    error = np.abs(body.gradient(places) - differences).max(axis=1) / (1 + np.linalg.norm(differences, axis=1))
    assert np.quantile(error, 0.95) < 1e-4

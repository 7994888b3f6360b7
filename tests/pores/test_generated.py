"""Networks of generated rocks with known pores: tau and R_min were settled on Berea, so they are tried elsewhere."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from shapes import capsules, pack

from geofit.pores import RockVolume, euler_number, maximal_balls, pore_network, pore_surface


def network_of(pore):
    return pore_network(RockVolume(pore, pore=True, voxel=1e-6))


def ball_and_stick(seed, cells=3, pitch=26.0):
    """Bulbs near the nodes of a lattice, tubes between neighbours, some left out: its bulbs, radii and links."""
    rng = np.random.default_rng(seed)
    nodes = np.array(list(np.ndindex(cells, cells, cells)))
    centre = (nodes + 0.5) * pitch + rng.uniform(-2, 2, nodes.shape)
    radius = rng.uniform(6.0, 9.0, len(nodes))
    sticks = [(c, c, r) for c, r in zip(centre, radius, strict=True)]
    links = []
    for a in range(len(nodes)):
        for b in range(a + 1, len(nodes)):
            if np.abs(nodes[a] - nodes[b]).sum() == 1 and rng.random() < 0.75:
                width = rng.uniform(1.8, 0.6 * min(radius[a], radius[b]))
                sticks.append((centre[a], centre[b], width))
                links.append((a, b, width))
    # Tubes to two opposite faces, so that the network reaches the sample's faces.
    for a in range(len(nodes)):
        for end in (0, cells - 1):
            if nodes[a, 0] == end:
                out = centre[a].copy()
                out[0] = -20 if end == 0 else cells * pitch + 20
                sticks.append((centre[a], out, 2.5))
    size = round(cells * pitch)
    return capsules((size,) * 3, sticks, offset=0.0), centre, radius, links


def links_of_bulbs(network, bulb):
    """The links between bulbs with their narrowest throat; a pore within a tube only lengthens its link."""
    found, inside = [], {}
    for (a, b), width in zip(network.throats.pores.tolist(), network.throats.inscribed.tolist(), strict=True):
        if bulb[a] >= 0 and bulb[b] >= 0:
            found.append((*sorted((bulb[a], bulb[b])), width))
        else:
            inside.setdefault(a if bulb[a] < 0 else b, []).append((bulb[b if bulb[a] < 0 else a], width))
    for ends in inside.values():
        if len(ends) == 2:
            found.append((*sorted(end for end, _ in ends), min(width for _, width in ends)))
    return sorted(found)


@pytest.mark.parametrize("seed", range(4))
def test_balls_and_sticks_are_found_again(seed):
    """Bulbs and links exactly. In a slanting tube of 2 to 3 voxels the grid alone makes a wider place now and then."""
    pore, centre, radius, links = ball_and_stick(seed)
    network = network_of(pore)
    gap = np.linalg.norm(network.pores.centre[:, None] - centre[None], axis=2)
    bulb = np.where(gap.min(axis=1) <= 2.0, gap.argmin(axis=1), -1)
    at = bulb >= 0
    assert sorted(bulb[at].tolist()) == list(range(len(centre)))
    np.testing.assert_allclose(network.pores.inscribed[at], radius[bulb[at]], atol=0.75)
    assert (~at).sum() <= 0.15 * len(centre)
    assert (network.pores.radius[~at] < 4.0).all()
    found = links_of_bulbs(network, bulb)
    assert [(a, b) for a, b, _ in found] == sorted((a, b) for a, b, _ in links)
    for (_, _, width), (_, _, truth) in zip(found, sorted(links), strict=True):
        assert width == pytest.approx(truth, abs=0.75)


@pytest.mark.parametrize("seed", range(4))
def test_refining_a_random_rock_keeps_its_network(seed):
    """The same grains on a grid twice as fine: pores wider than 2 voxels of the coarse one are the same in number."""
    rng = np.random.default_rng(seed)
    middles, radii = rng.random((140, 3)), rng.uniform(0.06, 0.13, 140)

    def rock(n):
        x = (np.arange(n) + 0.5) / n
        out = np.ones((n,) * 3, bool)
        for middle, radius in zip(middles, radii, strict=True):
            i, j, k = ((x - one) ** 2 for one in middle)
            out &= i[:, None, None] + j[:, None] + k > radius**2
        return out

    coarse, fine = network_of(rock(48)), network_of(rock(96))
    wide = [(coarse.pores.radius > 3.0).sum(), (fine.pores.radius > 6.0).sum()]
    assert wide[0] == pytest.approx(wide[1], rel=0.2, abs=3)
    assert coarse.porosity == pytest.approx(fine.porosity, rel=0.03)
    assert fine.percolates == coarse.percolates


def test_a_ring_has_one_tunnel_and_its_network_closes():
    """PORES.md, test 11: a torus with two wide places, so that the network has something to run between."""
    angle = np.linspace(0, 2 * np.pi, 61)
    ring = np.column_stack([28 + 18 * np.cos(angle), 28 + 18 * np.sin(angle), np.full(61, 12.0)])
    sticks = [(a, b, 3.6) for a, b in pairwise(ring)]
    sticks += [(ring[0], ring[0], 7.0), (ring[30], ring[30], 7.0)]
    pore = capsules((57, 57, 25), sticks)
    assert euler_number(pore) == 0
    network = network_of(pore)
    assert len(network.pores) == 2
    assert np.sort(network.throats.pores, axis=1).tolist() == [[0, 1], [0, 1]]


@pytest.mark.parametrize("radius", [6.0, 8.0])
def test_a_helix_is_one_pore_and_has_pappus_volume(radius):
    angle = np.linspace(0, 4 * np.pi, 120)
    line = np.column_stack([36 + 22 * np.cos(angle), 36 + 22 * np.sin(angle), 12 + 50 * angle / (4 * np.pi)])
    pore = capsules((72, 72, 74), [(a, b, radius) for a, b in pairwise(line)])
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    truth = np.pi * radius**2 * length + 4 / 3 * np.pi * radius**3
    assert pore.sum() == pytest.approx(truth, rel=0.01)
    network = network_of(pore)
    assert network.pores.volume.sum() == pore.sum()
    assert len(network.pores) == 1


@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 1, 0), (3, 2, 1)])
def test_balls_of_a_body_of_revolution_have_its_axis_and_radius(direction):
    """PORES.md, test 20: the largest ball of each piece lies on the axis and has the radius there."""
    d = np.array(direction) / np.linalg.norm(direction)
    grid = np.argwhere(np.ones((56, 56, 56), bool)) + 0.5 - 28
    along = grid @ d
    off = np.linalg.norm(grid - along[:, None] * d, axis=1)
    body = ((off < 9 + 2 * np.sin(along / 9)) & (np.abs(along) < 22)).reshape(56, 56, 56)
    balls = maximal_balls(RockVolume(body, pore=True, voxel=1.0))
    where = balls.centre + 0.5 - 28
    position = where @ d
    away = np.linalg.norm(where - position[:, None] * d, axis=1)
    for low in range(-9, 9, 3):
        here = np.flatnonzero((position >= low) & (position < low + 3))
        best = here[np.lexsort((away[here], -balls.radius[here]))[0]]
        assert away[best] <= np.sqrt(3) / 2
        # A narrower place of the body may lie within the ball's own length: the wall is not parallel to the axis.
        wall = 9 + 2 * np.sin((position[best] + np.linspace(-9, 9, 181)) / 9)
        nearest = np.hypot(wall - away[best], np.linspace(-9, 9, 181)).min()
        assert balls.radius[best] == pytest.approx(nearest, abs=0.5)


def test_a_sphere_in_long_voxels_keeps_its_porosity():
    """PORES.md, test 31; off the grid, where the count of its voxels is its volume."""
    radius = 20.0
    i, j, k = (one + 0.3 for one in np.ogrid[-22:23, -22:23, -12:13])
    volume = RockVolume(i**2 + j**2 + (2 * k) ** 2 <= radius**2, pore=True, voxel=(1.0, 1.0, 2.0))
    truth = 4 / 3 * np.pi * radius**3 / (45 * 45 * 50)
    assert volume.porosity == pytest.approx(truth, rel=0.005)
    network = pore_network(volume)
    assert network.porosity == pytest.approx(truth, rel=0.005)
    assert pore_surface(volume, network).porosity == pytest.approx(truth, rel=0.005)


@pytest.mark.parametrize(("lattice", "phi", "cell"), [("sc", 0.4764, 40), ("bcc", 0.3198, 46), ("fcc", 0.2595, 57)])
def test_the_contact_surface_keeps_the_porosity_of_packs(lattice, phi, cell):
    """PORES.md, test 21: spheres of 20 voxels, as near as a whole number of voxels in a cell comes to it."""
    volume = RockVolume(pack(lattice, cell, 1), pore=True, voxel=1e-6)
    body = pore_surface(volume, pore_network(volume))
    assert body.porosity == pytest.approx(phi, abs=0.002)


@pytest.mark.parametrize("lattice", ["sc", "bcc", "fcc"])
def test_the_contact_surface_has_the_volume_of_coarse_voxels(lattice):
    """Windows of three voxels and less, where triangles lose rock."""
    volume = RockVolume(pack(lattice, 20, 2), pore=True, voxel=1e-6)
    body = pore_surface(volume, pore_network(volume))
    assert body.porosity == pytest.approx(volume.pore.mean(), abs=0.0015)


@pytest.mark.parametrize("name", ["berea_200", "ketton_256"])
def test_other_rocks_have_networks_of_the_published_kind(rock, name):
    """Coordination, order of radii and connected porosity of rocks that did not settle tau and R_min."""
    from geofit.pores import connectivity

    volume = rock(name)
    network, exact = pore_network(volume), connectivity(volume)
    assert network.percolates == exact.percolates
    assert network.porosity == pytest.approx(exact.connected, rel=0.005)
    assert 2.3 <= network.coordination.mean() <= 4.5
    assert 0.3 < network.throats.radius.mean() / network.pores.radius.mean() < 0.75

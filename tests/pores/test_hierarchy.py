"""The article's super balls and slaves (``hierarchy="paper"``) against their literal definition."""

from __future__ import annotations

import numpy as np
import pytest
from brute import blobs
from scipy import ndimage
from shapes import capsules, turns

from geofit.pores import RockVolume, maximal_balls, network_permeability, pore_network


def literal_families(balls):
    """The super ball of each ball by the article's words: slaves of slaves belong to the largest super ball."""
    centre, radius = balls.centre.astype(float), np.sqrt(balls.radius2.astype(float))
    gap2 = ((centre[:, None] - centre[None]) ** 2).sum(axis=2)
    meets = gap2 <= (radius[:, None] + radius[None]) ** 2 + 1e-9
    family = np.full(len(radius), -1)
    supers = 0
    for ball in range(len(radius)):
        # Balls are listed from large to small: masters come before their slaves.
        masters = [other for other in range(ball) if meets[ball, other] and gap2[ball, other] <= 4 * radius[other] ** 2]
        if masters:
            family[ball] = family[masters].min()
        else:
            family[ball] = supers
            supers += 1
    return family


@pytest.mark.parametrize("seed", range(30))
def test_pores_are_the_literal_super_balls(seed):
    volume = RockVolume(blobs(seed, (16, 15, 14)), pore=True, voxel=1)
    balls = maximal_balls(volume, border="open")
    family = literal_families(balls)
    network = pore_network(volume, hierarchy="paper")
    # A pore is what belongs to one super ball; super balls whose basins hold only slaves of wider ones make none.
    assert 1 <= len(network.pores) + len(network.dropped) <= len(np.unique(family))
    again = pore_network(volume, balls, hierarchy="paper")
    assert again.pore_of.tobytes() == network.pore_of.tobytes()
    total = network.pores.volume.sum() + network.dropped.volume.sum()
    assert total == volume.pore.sum()
    # The largest ball of a basin decides: voxels of the widest super ball's centre and of the widest pore agree.
    widest = tuple(balls.centre[0])
    if network.pore_of[widest] > 0:
        assert network.pores.radius[network.pore_of[widest] - 1] == pytest.approx(balls.radius[0])


def disc():
    x = np.arange(13) - 6.3
    return x[:, None] ** 2 + x**2 <= 5.5**2


#: Bodies in which many balls are equally large.
LEVEL = {
    "square tube": np.ones((20, 9, 9), bool),
    "round tube": np.repeat(disc()[None], 20, axis=0),
    "plate": np.ones((20, 8, 20), bool),
    "cube": np.ones((16, 16, 16), bool),
    "even cube in rock": np.pad(np.ones((10, 10, 10), bool), 2),
}


@pytest.mark.parametrize("hierarchy", ["paper", "merge-tree"])
@pytest.mark.parametrize("body", LEVEL)
def test_equal_balls_are_one_super_ball_however_the_body_is_turned(body, hierarchy):
    """PORES.md, test 7."""
    pore = LEVEL[body]
    for turned in turns(pore):
        assert len(pore_network(RockVolume(turned, pore=True, voxel=1), hierarchy=hierarchy).pores) == 1


def test_two_bulbs_apart_are_two_super_balls_with_a_throat():
    """Bulbs of 8 and 7 voxels, joined by a tube of 2: no ball of one meets a ball of the other's size."""
    sticks = [((20, 20, 15), (20, 20, 15), 8.2), ((20, 20, 60), (20, 20, 60), 7.2), ((20, 20, 15), (20, 20, 60), 2.2)]
    network = pore_network(RockVolume(capsules((41, 41, 76), sticks), pore=True, voxel=1), hierarchy="paper")
    bulbs = network.pores.radius > 5
    assert bulbs.sum() == 2
    assert len(network.throats) >= 1
    # Taken literally the rule also makes pores of the tube between them; the merge tree does not.
    assert len(network.pores) >= 2
    assert len(pore_network(RockVolume(capsules((41, 41, 76), sticks), pore=True, voxel=1)).pores) == 2


def gaussian_blobs(seed):
    field = ndimage.gaussian_filter(np.random.default_rng(seed).random((90, 90, 90)), 3.0)
    return field < np.quantile(field, 0.3)


@pytest.mark.parametrize("source", ["berea_200", "ketton_256", 1, 2])
def test_tau_and_the_smallest_pore_change_the_count_of_pores_and_tau_hardly_changes_the_flow(source, rock):
    """The sweep of docs/pores.md in short, on crops of two rocks and on blobs."""
    pore = gaussian_blobs(source) if isinstance(source, int) else rock(source).pore[:120, :120, :120]
    volume = RockVolume(pore, pore=True, voxel=1e-6)
    by_tau = [pore_network(volume, tau=tau) for tau in (0.6, 0.8, 0.9, 1.0)]
    by_r_min = [pore_network(volume, r_min=r_min) for r_min in (0.0, 1.25, 2.0, 3.0)]
    assert np.all(np.diff([len(network.pores) for network in by_tau]) > 0)
    assert np.all(np.diff([len(network.pores) for network in by_r_min]) < 0)
    assert len(by_tau[2].pores) > 1.3 * len(by_tau[1].pores)
    k = np.array([network_permeability(network).square_metres for network in by_tau[1:3]])
    assert (k > 0).any()
    assert np.exp(np.abs(np.log(k[1, k[0] > 0] / k[0, k[0] > 0])).mean()) < 1.25

"""Maximal balls against the literal definition, and their union against the input."""

import numpy as np
import pytest
from brute import ball_inside, blobs, maximal
from conftest import ROCKS

from geofit.pores import RockVolume, VolumeError, maximal_balls
from geofit.pores.ball_tables import DIRECTIONS, ball_directions, inclusion_table
from geofit.pores.distance import squared_distance


def mask_of(balls):
    mask = np.zeros(balls.shape, bool)
    mask[tuple(balls.centre.T)] = True
    return mask


@pytest.mark.parametrize("border", ["closed", "open"])
def test_the_same_balls_as_brute_force_for_200_volumes(border):
    for seed in range(200):
        pore = blobs(seed, (24, 24, 24) if seed < 40 else (14, 13, 12))
        balls = maximal_balls(RockVolume(pore, pore=True, voxel=1e-6), border=border)
        reach2 = squared_distance(pore, border)
        np.testing.assert_array_equal(mask_of(balls), maximal(reach2), err_msg=f"seed {seed}")
        np.testing.assert_array_equal(balls.union(), pore)
        np.testing.assert_array_equal(balls.reach2, reach2[tuple(balls.centre.T)])
        assert (np.diff(balls.radius2) <= 0).all()
        assert (balls.radius2 < balls.reach2).all()


@pytest.mark.parametrize("name", [name for name in ROCKS if name != "berea_400"])
def test_the_union_is_the_rock_voxel_for_voxel(rock, name):
    volume = rock(name)
    assert np.count_nonzero(maximal_balls(volume).union() != volume.pore) == 0


@pytest.mark.parametrize("radius", [5.0, 12.3, 31.7])
def test_a_digital_ball_is_covered_and_its_centre_kept(radius):
    x = np.arange(-33, 34)
    ball = x[:, None, None] ** 2 + x[:, None] ** 2 + x**2 <= radius**2
    balls = maximal_balls(RockVolume(ball, pore=True, voxel=1))
    assert balls.centre.tolist() == [[33, 33, 33]]
    np.testing.assert_array_equal(balls.union(), ball)


def test_the_shipped_directions_are_the_grown_ones():
    assert ball_directions(400) == [entry for entry in DIRECTIONS if entry[3] <= 400]


def test_the_inclusion_table_is_the_literal_inclusion():
    for entry in DIRECTIONS[:12]:
        table = inclusion_table(*entry[:3], 60)
        for own in (1, 2, 3, 7, 20, 45, 60):
            inside = [other for other in range(1, 400) if ball_inside(own, *entry[:3], other)]
            assert inside[0] == table[own]


def test_the_articles_rule_errs_both_ways_and_its_loss_shows():
    lost = 0
    for seed in range(6):
        pore = blobs(seed)
        volume = RockVolume(pore, pore=True, voxel=1)
        paper, exact = maximal_balls(volume, rule="paper"), maximal_balls(volume)
        lost += np.count_nonzero(paper.union() != pore)
        assert set(map(tuple, paper.centre)) != set(map(tuple, exact.centre))
    # Figure 4 of the article: the ball of R^2 = 1 at distance sqrt 8 lies in that of R^2 = 13, whose L^2 is 15.
    assert 1 + np.sqrt(8) <= np.sqrt(15)
    assert ball_inside(2, 2, 2, 0, 14)
    # Its smallest error: R^2 = 2 and R^2 = 1 one voxel apart.
    assert np.sqrt(4) >= 1 + 1
    assert not ball_inside(2, 1, 0, 0, 3)


@pytest.mark.parametrize("voxel", [(1e-6, 1e-6, 2e-6), (3e-6, 1.1e-6, 1e-6)])
def test_other_voxels_are_covered_exactly_too(voxel):
    for seed in range(8):
        volume = RockVolume(blobs(seed, (16, 15, 14)), pore=True, voxel=voxel)
        balls = maximal_balls(volume)
        np.testing.assert_array_equal(balls.union(), volume.pore)
        assert len(np.unique(balls.centre, axis=0)) == len(balls) <= volume.pore.sum()


def test_a_sphere_in_long_voxels_keeps_its_radius():
    radius = 12.0
    i, j, k = np.ogrid[-14:15, -14:15, -7:8]
    sphere = i**2 + j**2 + (2 * k) ** 2 <= radius**2
    balls = maximal_balls(RockVolume(sphere, pore=True, voxel=(1e-6, 1e-6, 2e-6)))
    assert np.sqrt(balls.radius2[0]) == pytest.approx(radius, rel=0.01)


def test_rules_that_do_not_fit_are_errors():
    volume = RockVolume(np.zeros((3, 3, 3)), pore=0, voxel=(1, 1, 2))
    with pytest.raises(VolumeError, match="cubic"):
        maximal_balls(volume, rule="exact")
    with pytest.raises(VolumeError, match="border"):
        maximal_balls(volume, border="half")

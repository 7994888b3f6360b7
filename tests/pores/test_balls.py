"""Maximal balls against the literal definition, and their union against the input."""

import numpy as np
import pytest
from brute import ball_inside, blobs, maximal
from conftest import ROCKS

from geofit.pores import RockVolume, VolumeError, maximal_balls
from geofit.pores.ball_selection import paper
from geofit.pores.ball_tables import DIRECTIONS, ball_directions, inclusion_table
from geofit.pores.distance import squared_distance, sums_of_squares


def mask_of(balls):
    mask = np.zeros(balls.shape, bool)
    mask[tuple(balls.centre.T)] = True
    return mask


@pytest.mark.parametrize("border", ["closed", "open"])
def test_the_same_balls_as_brute_force_for_200_volumes(border):
    for seed in range(200):
        pore = blobs(seed)
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


def test_the_articles_rule_on_all_pairs_of_balls():
    """PORES.md, test 6: of two balls with R1² <= 100 the rule deletes 684 that are not included, and keeps 1,181."""
    below = sums_of_squares(110)
    squares = [s for s in range(1, 101) if below[s + 1] == s]
    following = {s: min(t for t in range(s + 1, 110) if below[t + 1] == t) for s in [0, *squares]}
    false = missed = 0
    for a, b, c in np.ndindex(11, 11, 11):
        gap2 = a * a + b * b + c * c
        if not a >= b >= c or not 0 < gap2 <= 100:
            continue
        pair = np.zeros((a + 1, b + 1, c + 1), np.int32)
        for own in squares:
            for other in (s for s in squares if s < own and gap2 <= own):
                pair[0, 0, 0], pair[a, b, c] = following[own], following[other]
                deleted = len(paper(pair)) == 1
                # The rule looks only within R1: a ball round a centre farther off is never included.
                included = ball_inside(following[other], -a, -b, -c, following[own])
                false, missed = false + (deleted and not included), missed + (included and not deleted)
    assert (false, missed) == (684, 1181)


def test_the_case_of_figure_4_is_deleted():
    """The ball of R² = 1 at distance sqrt 8 of that of R² = 13, whose L² is 15."""
    pair = np.zeros((3, 3, 1), np.int32)
    pair[0, 0, 0], pair[2, 2, 0] = 14, 2
    assert paper(pair).tolist() == [0]


@pytest.mark.parametrize("seed", range(200))
def test_the_articles_rule_loses_no_voxel_of_a_volume(seed):
    """It looks only at centres within R1, so the centre of a deleted ball lies in a ball that is kept."""
    volume = RockVolume(blobs(seed), pore=True, voxel=1)
    balls = maximal_balls(volume, rule="paper")
    np.testing.assert_array_equal(balls.union(), volume.pore)


def test_the_articles_rule_keeps_other_balls_than_the_exact_one():
    more = fewer = 0
    for seed in range(6):
        volume = RockVolume(blobs(seed), pore=True, voxel=1)
        article, exact = (mask_of(maximal_balls(volume, rule=rule)) for rule in ("paper", "exact"))
        more, fewer = more + np.count_nonzero(article & ~exact), fewer + np.count_nonzero(exact & ~article)
    assert more > 0
    assert fewer > 0


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

"""Missing walls: linear along a branch, minding left and right, listed one by one."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.caves.adjust import adjust_survey
from geofit.caves.sections import sections
from geofit.caves.shots import ShotList
from geofit.caves.survey import SurveyError

NAN = np.nan


def passage(ends, walls, step=10.0):
    """Stations along x, shots between the given ends, walls {station: (shot, four walls)}."""
    shots = ShotList()
    for row, (a, b) in enumerate(ends):
        shots.add(str(a), str(b), np.array([(b - a) * step, 0.0, 0.0]), row)
    for station, (shot, four) in walls.items():
        shots.add_walls(str(station), shot, four)
    return adjust_survey(shots.survey("passage"))


def test_missing_walls_are_linear_along_the_branch():
    found = sections(
        passage([(0, 1), (1, 2), (2, 3)], {0: (0, (1, 2, 3, 4)), 1: (1, (NAN,) * 4), 3: (2, (4, 2, 3, 1))})
    )
    np.testing.assert_allclose(found.walls[:, 0], [[1, 2, 3, 4], [2, 2, 3, 3], [3, 2, 3, 2]], atol=1e-6)
    np.testing.assert_allclose(found.walls[:, 1], [[2, 2, 3, 3], [3, 2, 3, 2], [4, 2, 3, 1]], atol=1e-6)
    assert {(f.station, f.wall) for f in found.filled} == {
        (s, w) for s in "12" for w in ("left", "right", "up", "down")
    }


def test_a_shot_measured_backwards_swaps_left_and_right():
    # The second shot runs from 2 to 1; its walls at 2 are seen against the direction of the first.
    found = sections(passage([(0, 1), (2, 1)], {0: (0, (1, 5, 2, 2)), 2: (1, (5, 1, 2, 2))}))
    np.testing.assert_allclose(found.walls[0], [[1, 5, 2, 2], [1, 5, 2, 2]], atol=1e-6)
    np.testing.assert_allclose(found.walls[1], [[5, 1, 2, 2], [5, 1, 2, 2]], atol=1e-6)


def test_a_dead_end_keeps_the_last_section():
    found = sections(passage([(0, 1), (1, 2)], {0: (0, (1, 2, 3, 4))}))
    np.testing.assert_allclose(found.walls[-1, 1], [1, 2, 3, 4], atol=1e-6)


def test_zero_on_one_side_is_a_wall_and_on_both_sides_is_missing():
    found = sections(passage([(0, 1), (1, 2)], {0: (0, (0, 2, 3, 4)), 1: (1, (0, 0, 3, 0)), 2: (1, (1, 2, 3, 4))}))
    np.testing.assert_allclose(found.walls[0, 0], [0, 2, 3, 4])
    np.testing.assert_allclose(found.walls[1, 0], [0.5, 2, 3, 0], atol=1e-6)
    assert {(f.station, f.wall) for f in found.filled} == {("1", "left"), ("1", "right")}


def test_a_passage_without_any_wall_gets_the_mean_or_a_radius():
    shots = ShotList()
    shots.add("0", "1", np.array([5.0, 0, 0]), 0)
    adjusted = adjust_survey(shots.survey("bare"))
    with pytest.raises(SurveyError, match=r"wall distance \(in scripts: radius"):
        sections(adjusted)
    np.testing.assert_allclose(sections(adjusted, radius=1.5).walls, 1.5, atol=1e-6)


def test_surface_shots_get_no_section():
    shots = ShotList()
    shots.add("0", "1", np.array([5.0, 0, 0]), 0, passage=False)
    with pytest.raises(SurveyError, match="no shot along a passage"):
        sections(adjust_survey(shots.survey("surface")), radius=1.0)


def test_stations_that_a_shot_of_no_length_ties_are_one():
    """Compass ties surveys together by shots of length 0: walls beyond were the mean of the whole survey."""
    shots = ShotList()
    first = shots.add("a", "b", np.array([20.0, 0, 0]), 0)
    tie = shots.add("b", "c", np.zeros(3), 1)
    shots.add("c", "d", np.array([30.0, 10.0, 0]), 2)
    shots.add("a", "e", np.array([0, 60.0, 0]), 3)
    shots.add_walls("a", first, [3.0] * 4)
    shots.add_walls("b", tie, [3.0, 2.0, 3.0, 3.0])
    shots.add_walls("e", 3, [0.5] * 4)
    found = sections(adjust_survey(shots.survey("tied")))
    assert found.shot.tolist() == [0, 2, 3]
    assert found.place[1].tolist() == [1, 3]
    np.testing.assert_allclose(found.walls[1], [[3, 2, 3, 3]] * 2, atol=1e-6)
    assert {f.station for f in found.filled} == {"d"}

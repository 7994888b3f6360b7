"""Volumes with uncertainty, strata, and distance to excavations, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from cave_surveys import chain

from geofit.caves.body import centreline_body
from geofit.caves.clearance import clearance
from geofit.caves.shots import ShotList
from geofit.caves.strata import strata
from geofit.caves.uncertainty import volume_estimate
from geofit.data.errors import SettingsError


class Plane:
    def __init__(self, height):
        self.height = height

    def elevation(self, x, y):
        return self.height(x, y)


def tube(n=21, radius=2.0, length=100.0):
    return centreline_body(chain(np.column_stack([np.linspace(0, length, n), np.zeros((n, 2))]), radius), ends="flat")


def test_independent_walls_of_a_tube():
    """The volume of a tube by walls with independent errors: their sum of squares, each wall with its share."""
    body = tube()
    found = volume_estimate(body, wall_error=0.1, correlation=0.0, spacing=0.25)
    step = 5.0
    shares = np.r_[step / 2, np.full(19, step), step / 2]
    # A wall moves a quarter of the perimeter's effect: 2 pi r s sigma / 4.
    expected = np.sqrt(4 * ((2 * np.pi * 2.0 * shares * 0.2 / 4) ** 2).sum())
    assert found.walls == pytest.approx(expected, rel=0.05)
    assert found.missing == 0
    assert found.survey == 0


def test_fully_correlated_walls_move_together():
    found = volume_estimate(tube(), wall_error=0.1, correlation=1.0, spacing=0.25)
    assert found.walls == pytest.approx(2 * np.pi * 2.0 * 100 * 0.2, rel=0.05)
    assert found.p10 < found.volume < found.p90
    assert found.p90 - found.volume == pytest.approx(1.2816 * found.sigma, rel=1e-4)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 1.0])
def test_the_standard_deviation_is_that_of_random_tubes(correlation):
    rng = np.random.default_rng(3)
    radii = 2.0 + np.sin(np.arange(21) / 3)
    points = np.column_stack([np.linspace(0, 100, 21), np.zeros((21, 2))])
    body = centreline_body(chain(points, radii), ends="flat")
    draws = []
    for _ in range(1500):
        error = np.sqrt(correlation) * rng.normal() + np.sqrt(1 - correlation) * rng.normal(size=(21, 4))
        walls = radii[:, None] * (1 + 0.1 * error)
        area = [np.pi / 4 * (w[:, 0] + w[:, 1]) * (w[:, 2] + w[:, 3]) for w in (walls, (walls[1:] + walls[:-1]) / 2)]
        draws.append(5.0 * (area[0][:-1] + 4 * area[1] + area[0][1:]).sum() / 6)
    found = volume_estimate(body, wall_error=0.1, correlation=correlation, spacing=0.3)
    assert found.walls == pytest.approx(np.std(draws), rel=0.07)


def test_missing_walls_and_shots_count_apart():
    survey = chain([[0, 0, 0], [50, 0, 0], [100, 0, 0]], [2.0, np.nan, 2.0], across=False)
    found = volume_estimate(centreline_body(survey, ends="flat"), spacing=0.3)
    assert found.missing > found.walls > 0
    # Two shots of 0.054 m along themselves, times the section.
    assert found.survey == pytest.approx(np.pi * 4 * np.hypot(0.05, 0.02) * np.sqrt(2), rel=0.05)
    assert found.sigma == pytest.approx(np.sqrt(found.walls**2 + found.missing**2 + found.survey**2))
    with pytest.raises(SettingsError, match="between 0 and 1"):
        volume_estimate(tube(), correlation=2)


def test_a_tilted_plane_cuts_a_tube_in_known_parts():
    body = tube()
    # A plane through x = 30 and one through x = 70: the cut is antisymmetric about the axis.
    found = strata(
        body, {"top": Plane(lambda x, y: 0.5 * (x - 30)), "base": Plane(lambda x, y: 0.5 * (x - 70))}, spacing=0.2
    )
    above, between, below, unknown = found
    assert [s.length for s in found] == pytest.approx([30, 40, 30, 0], abs=1e-9)
    area = np.pi * 4
    assert [above.volume, between.volume, below.volume] == pytest.approx([30 * area, 40 * area, 30 * area], rel=0.01)
    assert unknown.volume == 0
    assert sum(s.volume for s in found) == pytest.approx(body.volume(0.2), rel=1e-12)
    assert (above.top, above.base, between.base, below.base) == ("", "top", "base", "")


def test_parts_add_up_where_horizons_cross_or_end():
    body = centreline_body(chain([[0, 0, 0], [40, 0, 8], [60, 30, -5]], 3.0))
    horizons = {
        "a": Plane(lambda x, y: 2 * np.sin(x / 7)),
        "b": Plane(lambda x, y: 2 * np.cos(y / 5)),
        "c": Plane(lambda x, y: np.where(x > 50, np.nan, -1.0)),
    }
    found = strata(body, horizons, spacing=0.4)
    assert sum(s.volume for s in found) == pytest.approx(body.volume(0.4), rel=1e-12)
    assert sum(s.length for s in found) == pytest.approx(body.length, rel=1e-12)
    assert min(s.volume for s in found) >= 0
    assert found[-1].volume > 0
    assert not found[-1].known
    with pytest.raises(SettingsError, match="No horizon to cut with"):
        strata(body, {})


def test_clearance_of_a_tunnel_beside_a_tube():
    body = tube(5)
    found = clearance(body, [[50, -40, 9], [50, 40, 9]], radius=3.0, spacing=0.5)
    assert found.least == pytest.approx(9 - 2 - 3, abs=0.03)
    assert np.abs(found.points[found.nearest] - [50, 0, 9]).max() < 1.01
    assert found.wall[found.nearest][2] == pytest.approx(2, abs=0.05)
    assert found.station[found.nearest] == "2"
    assert found.sigma[found.nearest] > 0


def test_clearance_is_negative_inside_and_takes_points():
    body = tube(5)
    points = np.array([[50.0, 0, 1], [50, 0, 12], [-6, 0, 0], [50, 7, 7]])
    found = clearance(body, points, polyline=False, spacing=0.4)
    np.testing.assert_allclose(found.distance, [-1, 10, 6, np.hypot(7, 7) - 2], atol=0.03)
    assert found.nearest == 0
    with pytest.raises(SettingsError, match="give finite points"):
        clearance(body, [[1, 2]])
    with pytest.raises(SettingsError, match="radius"):
        clearance(body, points, radius=-1)


@pytest.mark.parametrize(("walls", "least"), [([0.2] * 4, 1.3), ([0.1, 0.1, 3.0, 3.0], -0.0866)])
def test_clearance_sees_a_passage_that_is_too_thin_for_the_triangles(walls, least):
    """A crawl off a gallery is lost between cells that suit the gallery: the clearance was the gallery's, 31 m."""
    shots = ShotList(across=True)
    for k in range(6):
        shot = shots.add(str(k), str(k + 1), np.array([10.0, 0, 0]), k)
        shots.add_walls(str(k), shot, [4.0] * 4)
    shots.add_walls("6", shot, [4.0] * 4)
    shots.add_walls("t", shots.add("3", "t", np.array([0, 4.0, 0]), 6), walls)
    shots.add_walls("u", shots.add("t", "u", np.array([0, 40.0, 0]), 7), walls)
    found = clearance(centreline_body(shots.survey("crawl")), [[-50, 35, 1.5], [80, 35, 1.5]])
    assert found.least == pytest.approx(least, abs=0.02)
    assert found.station[found.nearest] == "u"
    assert np.abs(found.wall[found.nearest] - [30, 35, 1.5]).max() < 1.5

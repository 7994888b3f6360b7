"""What a section shows: traces on their surfaces, holes with their intervals, points within the thickness."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geofit.data.errors import SettingsError
from geofit.data.logs import IntervalLog, LoggedHoles
from geofit.data.points import PointSet
from geofit.data.site import Ground, Hole, Site
from geofit.fitting.calibration import BAND
from geofit.fitting.pipeline import fit_horizon
from geofit.prediction.bands import prediction_sd
from geofit.prediction.examine import examine
from geofit.site.section_view import lithologies, parallel_lines, section_view

LINE = np.array([[0.0, 100.0], [200.0, 100.0]])


@pytest.fixture(scope="module")
def site():
    """A plane that dips to the east, a hole on the line, one beside it, ground that the plane pierces in the west."""
    rng = np.random.default_rng(2)
    xy = rng.uniform((20, 20), (180, 180), (80, 2))
    points = PointSet(np.column_stack([xy, 110 - 0.2 * xy[:, 0]]))
    x = y = np.linspace(-50, 250, 31)
    depth = np.array([0.0, 30.0])
    holes = tuple(
        Hole(name, "borehole", depth, np.column_stack([[x0, x0], [y0, y0], 100 - depth]))
        for name, x0, y0 in (("A", 60.0, 104.0), ("B", 120.0, 140.0), ("C", 230.0, 100.0))
    )
    log = IntervalLog(
        "lith.csv", np.array(["A", "A"]), np.array([0.0, 8.0]), np.array([8.0, 40.0]), np.array(["clay", "rock"]),
        np.array([2, 3]),
    )  # fmt: skip
    return Site(
        "S", {"low": points}, ground=Ground(x, y, np.full((31, 31), 100.0)), holes=holes,
        boreholes=(LoggedHoles({}, {"A": 30.0}, (log,)),),
    )  # fmt: skip


@pytest.fixture(scope="module")
def surface(site):
    # The study area reaches beyond the points.
    boundary = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 200.0], [0.0, 200.0]])
    return fit_horizon(site.horizons["low"], boundary=boundary, name="low")


def test_traces_lie_on_the_surface_and_say_where_they_are_supported(site, surface):
    uncertainty = examine(surface).uncertainty
    view = section_view(site, {"low": surface}, LINE, 20.0, uncertainty={"low": uncertainty})
    assert view.length == 200.0
    for one in view.traces["low"]:
        np.testing.assert_allclose(one.z, 110 - 0.2 * one.distance, atol=1e-3)
        places = np.column_stack([one.distance, np.full(len(one.z), 100.0)])
        half = BAND * prediction_sd(surface, uncertainty, places, "contact")
        np.testing.assert_allclose(one.band.upper, np.column_stack([one.distance, one.z + half]), atol=1e-9)
        np.testing.assert_allclose(one.band.lower, np.column_stack([one.distance, one.z - half]), atol=1e-9)
    cut = section_view(site, {"low": surface}, [[0, 100], [48, 100], [100, 100], [200, 100]], 20.0).traces["low"]
    solid = np.concatenate([one.distance for one in cut if one.supported])
    dashed = np.concatenate([one.distance for one in cut if not one.supported])
    assert solid.min() > 40, "further west the plane is above the ground"
    assert solid.max() < 190, "further east there are no points"
    assert dashed.min() < 30
    assert dashed.max() > 195


def test_holes_within_the_thickness_have_their_intervals(site, surface):
    view = section_view(site, {"low": surface}, LINE, 20.0)
    assert [hole.name for hole in view.holes] == ["A"], "B is 40 m beside, C beyond the end"
    (hole,) = view.holes
    assert hole.beside == pytest.approx(4.0)
    assert [interval.code for interval in hole.intervals] == ["clay", "rock"]
    np.testing.assert_allclose(hole.intervals[0].track, [[60, 100], [60, 92]])
    np.testing.assert_allclose(hole.intervals[1].track, [[60, 92], [60, 70]], err_msg="to the end of the hole")
    assert lithologies([view]) == ("clay", "rock")
    near = np.abs(site.horizons["low"].xyz[:, 1] - 100) <= 10
    assert len(view.points["low"]) == near.sum()


def test_an_inclined_hole_is_shown_where_it_passes_the_section(site, surface):
    """A straight hole has a vertex at its mouth and its end alone: both are 100 m off the section that it passes."""
    depth = np.array([0.0, 200.0])
    across = Hole("X", "borehole", depth, np.array([[80.0, 0.0, 100.0], [120.0, 200.0, 0.0]]))
    log = IntervalLog(
        "lith.csv", np.array(["X", "X"]), np.array([0.0, 100.0]), np.array([100.0, 200.0]), np.array(["clay", "rock"]),
        np.array([2, 3]),
    )  # fmt: skip
    inclined = replace(site, holes=(across,), boreholes=(LoggedHoles({}, {"X": 200.0}, (log,)),))
    (hole,) = section_view(inclined, {"low": surface}, LINE, 20.0).holes
    assert hole.beside == pytest.approx(0.0, abs=1.0)
    # It is within 10 m of the line for 20 m of northing, a tenth of its way.
    np.testing.assert_allclose(hole.track, [[98, 55], [102, 45]], atol=0.8)
    assert [interval.code for interval in hole.intervals] == ["clay", "rock"]
    np.testing.assert_allclose(hole.intervals[0].track, [[98, 55], [100, 50]], atol=0.8)
    # One that starts within the section and leaves it is shown as far as it is within.
    out = replace(inclined, holes=(replace(across, xyz=np.array([[100.0, 100.0, 100.0], [100.0, 300.0, 0.0]])),))
    (hole,) = section_view(out, {"low": surface}, LINE, 20.0).holes
    np.testing.assert_allclose(hole.track, [[100, 100], [100, 95]], atol=0.8)


def test_a_polyline_counts_the_distance_round_its_corners(site, surface):
    view = section_view(site, {"low": surface}, [[20, 20], [100, 20], [100, 120]], 20.0)
    assert view.bends.tolist() == [0.0, 80.0, 180.0]
    for one in view.traces["low"]:
        inner = one.distance > 80
        np.testing.assert_allclose(one.z[inner], 90.0, atol=1e-3)


@pytest.mark.parametrize(("azimuth", "spacing"), [(0.0, 50.0), (33.0, 40.0), (250.0, 75.0)])
def test_sections_stand_across_the_axis_at_their_chainages(azimuth, spacing):
    way = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
    start = np.array([4e5, 3e6])
    lines = parallel_lines([start, start + 300 * way], spacing, 80.0)
    assert len(lines) == int(300 // spacing) + 1
    for k, (name, line) in enumerate(lines.items()):
        assert name == f"0+{k * spacing:03.0f}"
        np.testing.assert_allclose(line.mean(axis=0), start + k * spacing * way)
        across = line[1] - line[0]
        assert np.linalg.norm(across) == pytest.approx(160.0)
        assert across @ way == pytest.approx(0.0, abs=1e-6)
        assert way[0] * across[1] - way[1] * across[0] < 0, "from left to right"


@pytest.mark.parametrize(("spacing", "half"), [(0.0, 10.0), (-5.0, 10.0), (10.0, 0.0), (0.01, 10.0)])
def test_numbers_that_make_no_section_are_refused(spacing, half):
    with pytest.raises(SettingsError, match="give a spacing"):
        parallel_lines(LINE, spacing, half)


def test_a_section_without_thickness_is_refused(site, surface):
    with pytest.raises(SettingsError, match="thickness"):
        section_view(site, {"low": surface}, LINE, 0.0)


def test_every_logged_interval_of_a_hole_on_the_line_is_shown():
    from geofit.io.site_file import read_site

    site = read_site(Path(__file__).parents[2] / "sample_data" / "site.toml")
    hole = next(hole for hole in site.holes if hole.name == "ZK402")
    x, y = hole.xyz[0, :2]
    view = section_view(site, {}, [[x - 300, y], [x + 300, y]], 400.0)
    shown = next(one for one in view.holes if one.name == "ZK402")
    logged = sum(int((log.hole == "ZK402").sum()) for campaign in site.boreholes for log in campaign.logs)
    assert len(shown.intervals) == logged
    assert len({interval.table for interval in shown.intervals}) > 1

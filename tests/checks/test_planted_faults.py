"""The matrix of planted faults: each check finds its own fault, and all are silent on clean horizons.

A fault is planted in a fitted horizon of the sample site, or in a surface made for it, with nothing else changed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from surfaces import ORIGIN, fold, height_field, horizon, split
from truth import paper_arrangement

from geofit import FitSettings, fit_horizon
from geofit.checks.check import check
from geofit.data.messages import Message
from geofit.data.site import Ground, Orientations
from geofit.sample import horizon_truth
from geofit.sample.truth import HORIZONS
from geofit.site.dips import check_dips
from geofit.site.topography import check_ground
from geofit.splines.patch import Patch

ALWAYS = {"normals", "patches", "self-intersection"}


def named(accuracy):
    return {one.name: one for one in accuracy.checks}


def failing(accuracy):
    return {one.name for one in accuracy.checks if one.passed is False}


def checked(surface):
    assert surface.accuracy is not None
    return check(surface, surface.accuracy.conflicts)


def changed(surface, name, change):
    """The surface with the control points of one patch changed, and its check."""
    patches = [replace(p, control=change(p.control.copy())) if p.name == name else p for p in surface.patches]
    return checked(surface.with_(patches=tuple(patches)))


def moved(surface, rows, by):
    """The surface with some points moved up, and its check."""
    xyz = surface.points.xyz.copy()
    xyz[rows, 2] += by
    return checked(surface.with_(points=surface.points.with_(xyz=xyz)))


def loose(surface, patch=None):
    """Indices of the approximated points, of one patch or all."""
    mine = ~surface.core if patch is None else ~surface.core & (surface.accuracy.patch == patch)
    return np.flatnonzero(mine)


# Silence.


@pytest.mark.parametrize("name", HORIZONS)
def test_all_checks_are_silent_on_the_clean_sample(sample_surfaces, name):
    accuracy = sample_surfaces[name].accuracy
    assert failing(accuracy) == set()
    assert set(named(accuracy)) >= ALWAYS
    assert ("area" in named(accuracy)) == (sample_surfaces[name].frame == "map")


@pytest.mark.parametrize("seed", range(0, 16, 3))
def test_all_checks_are_silent_on_seeded_truths(seed):
    truth = paper_arrangement(seed)
    accuracy = fit_horizon(truth.points, None, truth.boundary).accuracy
    assert failing(accuracy) == set()
    assert {"bias", "clustering", "normality", "oscillation", "trend", "area"} <= set(named(accuracy))


def test_every_text_of_the_check_can_be_told_in_another_language(sample_surfaces):
    for surface in sample_surfaces.values():
        accuracy = surface.accuracy
        texts = [one.text for one in accuracy.checks] + [*accuracy.notes, surface.partition.reason]
        assert [text for text in texts if not isinstance(text, Message)] == []


# Residuals.


def test_a_blunder_in_the_periphery_is_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    point = loose(surface)[40]
    found = moved(surface, [point], 5.0)
    assert {"interior tolerance", "normality"} <= failing(found)
    assert found.worst[0] == point
    assert named(found)["interior tolerance"].value == pytest.approx(5.0, rel=0.05)


def test_a_blunder_in_the_core_is_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    assert "core" in failing(moved(surface, np.flatnonzero(surface.core)[[100]], 0.5))


@pytest.mark.parametrize(("by", "code"), [(0.06, "checks.bias-low"), (-0.06, "checks.bias-high")])
def test_a_bias_within_the_tolerance_is_found(sample_surfaces, by, code):
    surface = sample_surfaces["T2-T1"]
    found = named(moved(surface, loose(surface, "west"), by))["bias"]
    assert found.passed is False
    assert found.value == pytest.approx(0.06, rel=0.15)
    assert (found.text.code, found.text.params["patch"]) == (code, "west")


def test_a_bias_below_a_tenth_of_the_tolerance_does_not_matter(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    assert named(moved(surface, loose(surface, "west"), 0.005))["bias"].passed


def test_a_pattern_in_the_residuals_is_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    rows = loose(surface)
    x, y = (surface.points.xyz[rows, :2] - surface.origin[:2]).T
    pattern = 0.3 * np.sin(x / 120) * np.cos(y / 120)
    found = moved(surface, rows, pattern)
    assert "clustering" in failing(found)
    assert named(found)["clustering"].value == pytest.approx(pattern.std(), rel=0.35)


def test_noise_of_the_same_size_makes_no_pattern(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    rows = loose(surface)
    found = moved(surface, rows, np.random.default_rng(3).normal(0, 0.2, len(rows)))
    assert {"clustering", "bias", "normality"} & failing(found) == set()


def test_tails_of_a_few_points_are_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    rows = loose(surface)[::25]
    found = moved(surface, rows, np.where(np.arange(len(rows)) % 2, 1.5, -1.5))
    assert "normality" in failing(found)
    assert named(found)["normality"].text.code == "checks.residuals-not-normal"


# Geometry.


def test_a_control_point_moved_over_its_neighbours_is_found():
    patch = height_field(20, 16)
    control = patch.control.copy()
    control[8, 7, :2] += 2.5 * (control[11, 7, :2] - control[8, 7, :2])
    surface = horizon([patch]).with_(frame="map")
    assert failing(check(surface)) == set()
    found = check(surface.with_(patches=(replace(patch, control=control),)))
    assert {"normals", "patches"} <= failing(found)
    assert named(found)["normals"].places


def test_a_swing_between_the_points_is_found(sample_surfaces):
    surface = sample_surfaces["T3-T2"]
    core = next(p for p in surface.patches if p.name == "core")
    row, column = (count // 2 for count in core.control.shape[:2])

    def lift(control):
        # Spans beside the sections are short: a few control points make a swing as wide as their distance.
        control[row - 2 : row + 2, column - 2 : column + 2, 2] += 8.0
        return control

    one = named(changed(surface, "core", lift))["oscillation"]
    assert one.passed is False
    place = core.control[row, column] + surface.origin
    assert np.hypot(*(np.array(one.places)[:, :2] - place[:2]).T).min() < 60


def test_a_narrow_spike_of_a_fine_net_is_found():
    patch = height_field(83, 63, z=lambda x, y: 0.2 * x)
    u, v = np.random.default_rng(0).uniform((0, 0), (1000, 700), (200, 2)).T
    points = patch.evaluate(u, v) + ORIGIN
    control = patch.control.copy()
    control[40, 30, 2] += 20.0
    spiked = horizon([replace(patch, control=control)], points).with_(frame="map")
    assert named(check(horizon([patch], points)))["oscillation"].passed
    assert named(check(spiked))["oscillation"].passed is False


def test_flipped_normals_are_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    turned = [
        replace(
            p,
            control=p.control[::-1].copy(),
            knots_u=p.knots_u.sum() * 0 + (p.knots_u[-1] + p.knots_u[0]) - p.knots_u[::-1],
        )
        if p.name == "west"
        else p
        for p in surface.patches
    ]
    found = checked(surface.with_(patches=tuple(turned)))
    assert {"normals", "seam angle"} <= failing(found)
    unknown = checked(surface.with_(patches=tuple(turned), frame=""))
    assert 0 < named(unknown)["normals"].value < 0.5 * sum(p.control.size for p in surface.patches)


def test_a_collapsed_edge_is_found():
    patch = height_field(12, 10)
    control = patch.control.copy()
    control[0] = control[0, 0]
    found = check(horizon([replace(patch, control=control)]))
    assert "patches" in failing(found)
    assert "core" in named(found)["patches"].text.params["names"]


@pytest.mark.parametrize("gap", [2e-6, 0.01])
def test_an_open_seam_is_found(sample_surfaces, gap):
    def lift(control):
        control[-1, :, 2] += gap
        return control

    found = changed(sample_surfaces["T2-T1"], "core", lift)
    assert "seam gap" in failing(found)
    assert named(found)["seam gap"].value == pytest.approx(gap, rel=0.1)


def test_a_kink_at_a_seam_is_found(sample_surfaces):
    def tilt(control):
        control[-2, 5:-5, 2] += 1.0
        return control

    found = changed(sample_surfaces["T2-T1"], "core", tilt)
    assert "seam angle" in failing(found)
    assert "seam gap" not in failing(found)


def test_a_parametric_surface_that_crosses_itself_is_found():
    sound = horizon([fold()]).with_(frame="sections")
    assert failing(check(sound)) == set()
    one = fold()
    control = one.control.copy()
    # The upper limb is pushed down through the lower one.
    bent = control[:, :, 2].copy()
    control[:, :, 2] = np.where(control[:, :, 2] > 100, 200 - bent, bent)
    crossed = horizon([replace(one, control=control)]).with_(frame="sections")
    found = named(check(crossed))["self-intersection"]
    assert found.passed is False
    z = np.array(found.places)[:, 2] - ORIGIN[2]
    assert (z < 110).all()


def test_two_sheets_that_pass_through_each_other_are_found():
    level = height_field(12, 10, z=lambda x, y: 0 * x)
    slanted = height_field(14, 11, z=lambda x, y: 0.3 * x - 110)
    bent = [replace(p, control=p.control + 0.5 * np.sin(p.control[..., [1, 0, 2]] / 50)) for p in (level, slanted)]
    found = named(check(horizon(bent)))["self-intersection"]
    assert found.passed is False
    assert np.abs(np.array(found.places)[:, 0] - ORIGIN[0] - 367).max() < 20


def test_an_elevation_that_runs_away_is_found(sample_surfaces):
    def away(control):
        control[:, 2 * control.shape[1] // 3 :, 2] += 300.0
        return control

    surface = sample_surfaces["T2-T1"]
    found = failing(changed(surface, "core", away))
    assert "elevation range" in found


def test_an_extrapolation_that_leaves_the_trend_is_found():
    rng = np.random.default_rng(2)
    patch = height_field(20, 16, z=lambda x, y: 0.1 * x + 3 * np.sin(y / 90))
    u, v = rng.uniform((0, 0), (450, 700), (120, 2)).T
    points = patch.evaluate(u, v) + ORIGIN
    assert named(check(horizon([patch], points)))["trend"].passed
    control = patch.control.copy()
    control[..., 2] += np.maximum(control[..., 0] - 550, 0) ** 2 / 7000
    found = named(check(horizon([replace(patch, control=control)], points)))
    assert found["trend"].passed is False
    assert np.array(found["trend"].places)[0, 0] - ORIGIN[0] > 900
    assert found["oscillation"].passed


def test_a_study_area_left_uncovered_is_found(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    less = surface.with_(patches=tuple(p for p in surface.patches if p.name != "west"))
    found = named(checked(less))["area"]
    assert found.passed is False
    assert found.value > 1.0
    assert named(surface.accuracy)["area"].value < 1e-6


def test_the_area_of_patches_that_are_no_height_field_counts_too():
    outline = [[0, 0], [900, 0], [900, 600], [0, 600]]
    patch = height_field(12, 10)
    bent = replace(patch, control=patch.control + 1e-6 * np.sin(patch.control[..., [1, 0, 2]] / 50))
    whole = horizon([bent], outline=outline)
    assert named(check(whole))["area"].passed
    half = replace(bent, control=bent.control * [0.5, 1, 1])
    assert named(check(whole.with_(patches=(half,))))["area"].value == pytest.approx(100 * 400 / 900, rel=1e-3)


# What was seen on the ground.


def orientations(xyz, azimuth, dip, name):
    n = len(xyz)
    azimuth, dip = np.broadcast_to(azimuth, n), np.broadcast_to(dip, n)
    return Orientations(xyz, azimuth, dip, np.full(n, name), np.full(n, "dips.csv"), np.arange(n))


def dips_of(normal):
    up = np.where(normal[:, 2:] < 0, -normal, normal)
    return np.degrees(np.arctan2(up[:, 0], up[:, 1])) % 360, np.degrees(
        np.arccos(up[:, 2] / np.linalg.norm(up, axis=1))
    )


def test_dips_of_a_plane_are_its_own():
    plane = horizon([height_field(8, 8, z=lambda x, y: -0.5 * x)])
    xyz = np.array([[500.0, 300, -200], [200, 500, -100]]) + ORIGIN
    deviations, one = check_dips(plane, orientations(xyz, [90.0, 120.0], [np.degrees(np.arctan(0.5)), 0.0], "T1"))
    first, second = deviations
    assert (first.surface_azimuth, first.surface_dip) == pytest.approx((90.0, np.degrees(np.arctan(0.5))))
    assert first.angle == pytest.approx(0.0, abs=1e-6)
    assert first.distance == pytest.approx(50 / np.hypot(1, 0.5))
    assert second.angle == pytest.approx(np.degrees(np.arctan(0.5)))
    assert one.passed


def test_dips_of_another_horizon_are_left_out():
    plane = horizon([height_field(8, 8)])
    assert check_dips(plane, orientations(np.array([[0, 0, 0.0]]), 0.0, 80.0, "other")) == ((), None)
    assert check_dips(plane, None) == ((), None)


def test_a_dip_that_contradicts_the_surface_is_found(sample_surfaces):
    surface, truth = sample_surfaces["T2-T1"], horizon_truth("T2-T1")
    xyz = truth.places(40, core=True)
    x, y = xyz[:, :2].T
    slope = [
        (truth.height(x + 1, y) - truth.height(x - 1, y)) / 2,
        (truth.height(x, y + 1) - truth.height(x, y - 1)) / 2,
    ]
    azimuth, dip = dips_of(np.column_stack([-slope[0], -slope[1], np.ones(40)]))
    assert check_dips(surface, orientations(xyz, azimuth, dip, "T2-T1"))[1].passed
    dip[7] += 55.0
    _, found = check_dips(surface, orientations(xyz, azimuth, dip, "T2-T1"))
    assert found.passed is False
    assert found.value == pytest.approx(55.0, abs=8.0)
    np.testing.assert_allclose(found.places, xyz[[7]])


@pytest.mark.parametrize("name", HORIZONS)
def test_clean_horizons_obey_the_ground(sample_surfaces, sample_site, name):
    assert check_ground(sample_surfaces[name], sample_site.ground, 2.0).passed is not False


def test_a_horizon_above_the_ground_is_found(sample_surfaces, sample_site):
    surface = sample_surfaces["W"]
    lifted = surface.with_(origin=surface.origin + np.array([0, 0, 45.0]))
    found = check_ground(lifted, sample_site.ground, 2.0)
    assert found.passed is False
    assert len(found.places) > 0
    x, y, z = np.array(found.places).T
    assert (z - sample_site.ground.elevation(x, y) > 2.0).all()
    assert found.value == pytest.approx((z - sample_site.ground.elevation(x, y)).max())


def test_rock_that_is_eroded_is_told_and_no_fault():
    x = np.linspace(ORIGIN[0], ORIGIN[0] + 1000, 51)
    y = np.linspace(ORIGIN[1], ORIGIN[1] + 700, 36)
    valley = 100 - 200 * np.exp(-(((x - x.mean()) / 150) ** 2)) + 0 * y[:, None] + ORIGIN[2]
    level = height_field(8, 8, z=lambda x, y: 0 * x)
    west = np.random.default_rng(0).uniform((0, 0), (250, 700), (60, 2))
    banks = np.concatenate([west, west + np.array([750, 0])])
    points = np.column_stack([banks, np.zeros(120)]) + ORIGIN
    found = check_ground(horizon([level], points), Ground(x, y, valley), 1.0)
    assert found.passed is None
    assert found.value == pytest.approx(100.0, abs=2.0)
    over = (100 - 200 * np.exp(-((np.linspace(-500, 500, 2001) / 150) ** 2)) < -1).mean() * 7e5
    area = found.text.params["area"]
    assert area == pytest.approx(over, rel=0.1)
    buried = check_ground(horizon([level], points), Ground(x, y, np.full_like(valley, ORIGIN[2] + 50)), 1.0)
    assert buried.passed
    assert check_ground(horizon([level], points), None, 1.0) is None


# Sizes.


def test_many_points_are_thinned_and_it_is_said():
    patch = height_field(20, 16)
    u, v = np.random.default_rng(0).uniform((0, 0), (1000, 700), (12_000, 2)).T
    points = patch.evaluate(u, v) + ORIGIN
    points[:, 2] += np.random.default_rng(1).normal(0, 0.05, len(points))
    found = named(check(horizon([patch], points).with_(frame="map")))
    for name in ("clustering", "oscillation"):
        assert found[name].text.code == "checks.sample-examined"
        assert (found[name].text.params["part"], found[name].text.params["n"]) == (5000, 12_000)
    assert found["clustering"].passed
    assert found["bias"].passed


def test_the_trend_of_many_points_says_how_many_it_looked_at():
    """What the points show is the most that any of them shows, not only those of the part."""
    patch = height_field(8, 8, z=lambda x, y: 0 * x)
    plan = np.random.default_rng(0).uniform((0, 0), (500, 700), (30_000, 2))
    points = np.column_stack([plan, np.random.default_rng(1).normal(0, 0.05, 30_000)]) + ORIGIN
    left_out = np.setdiff1d(np.arange(30_000), np.random.default_rng(0).choice(30_000, 20_000, replace=False))
    points[left_out[0], 2] += 7.0
    found = named(check(horizon([patch], points).with_(frame="map")))["trend"]
    assert found.text.code == "checks.sample-examined"
    assert (found.text.params["part"], found.text.params["n"]) == (20_000, 30_000)
    assert found.limit == pytest.approx(14.0, abs=0.5)
    fewer = named(check(horizon([patch], points[:400]).with_(frame="map")))
    assert all(one.text.code != "checks.sample-examined" for one in fewer.values())


def test_few_points_are_not_judged():
    patch = height_field(8, 8)
    points = patch.evaluate([300.0, 400, 500], [100.0, 200, 300]) + ORIGIN
    found = named(check(horizon([patch], points)))
    assert [found[name].passed for name in ("bias", "clustering", "normality")] == [None] * 3
    assert "oscillation" not in found
    assert "trend" not in found


def test_limits_follow_the_tolerance(sample_surfaces):
    surface = sample_surfaces["T2-T1"]
    wider = surface.with_(settings=FitSettings(interior_tolerance=1.0))
    found = moved(wider, loose(surface, "west"), 0.06)
    assert named(found)["bias"].passed


def test_a_patch_turned_over_in_an_unknown_frame_is_the_smaller_part():
    whole = height_field()
    u = np.unique(whole.knots_u)
    parts = split(whole, [u[4]], [])
    small = parts[0]
    flipped = Patch(small.name, small.degree, small.knots_u, small.knots_v, small.control[:, ::-1].copy())
    found = named(check(horizon([flipped, *parts[1:]])))["normals"]
    assert found.passed is False
    assert found.value < 0.4 * found_total(found)


def found_total(one):
    return int(str(one.text).split("of ")[1].split()[0])


def test_a_valley_between_deep_points_is_erosion_and_a_bulge_there_is_wrong():
    """Points 50 m below a plateau on a grid of 100 m; between two rows of them lies a valley 70 m deep."""
    x = y = np.linspace(0, 1000, 101)
    places = np.stack(np.meshgrid(np.linspace(50, 950, 10), np.linspace(50, 950, 10)), axis=-1).reshape(-1, 2)
    points = np.column_stack([places, np.zeros(100)]) + ORIGIN
    plateau = np.full((101, 101), ORIGIN[2] + 50.0)
    valley = plateau - 70 * np.exp(-(((x - 500) / 15) ** 2))

    def found(horizon_height, ground):
        patch = height_field(60, 60, size=(1000.0, 1000.0), z=horizon_height)
        return check_ground(horizon([patch], points), Ground(ORIGIN[0] + x, ORIGIN[1] + y, ground), 1.0)

    eroded = found(lambda x, y: 0 * x, valley)
    assert eroded.passed is None
    assert eroded.value == pytest.approx(20.0, abs=1.0)
    bulge = found(lambda x, y: 90 * np.exp(-(((x - 500) / 30) ** 2) - ((y - 500) / 30) ** 2), plateau)
    assert bulge.passed is False

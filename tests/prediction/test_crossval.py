"""Cross-validation, its references, calibration, outliers and robust weights, against brute force and known truths."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from refusals import refused, with_code
from scipy.interpolate import RBFInterpolator
from truth import paper_arrangement, rms

import geofit
from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import SettingsError
from geofit.data.prediction import PredictionResult
from geofit.fitting.calibration import BAND, LeftOutPoints, calibrate, factor_for, share_inside, uncalibrated
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.sections import crossing_lines, find_sections
from geofit.prediction.bands import grid_over
from geofit.prediction.examine import examine
from geofit.prediction.folds import beyond_hull, block_labels, groups_of, hole_labels
from geofit.prediction.kriging import NEIGHBOURS, Variogram, fit_variogram, krige_left_out
from geofit.prediction.thinplate import thin_plate_left_out
from geofit.sample import horizon_truth

SITE = Path(__file__).parents[2] / "sample_data" / "site.toml"


@cache
def cloud() -> tuple[np.ndarray, np.ndarray]:
    plane = np.random.default_rng(5).uniform(0, 10, (80, 2))
    return plane, np.sin(plane[:, 0] / 2) + 0.3 * plane[:, 1]


def grid(nx: int, ny: int) -> np.ndarray:
    """Places of holes on a grid over 1 km x 1 km."""
    lines = np.meshgrid(np.linspace(30, 970, nx), np.linspace(30, 970, ny), indexing="ij")
    return np.stack(lines, axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize(("nx", "ny"), [(7, 7), (7, 12), (20, 6)])
def test_points_on_a_grid_lie_on_lines_of_two_directions(nx, ny, turn):
    plan = grid(nx, ny) @ np.array([(np.cos(turn), np.sin(turn)), (-np.sin(turn), np.cos(turn))])
    lines = find_sections(plan)
    crossing = crossing_lines(plan, lines)
    counts = {len(np.unique(lines)), len(np.unique(crossing))}
    assert counts == {nx, ny}
    assert "" not in lines
    assert "" not in crossing
    # Two points of one line are not on one of the others.
    assert len(set(zip(lines.tolist(), crossing.tolist(), strict=True))) == nx * ny


def test_coincident_points_do_not_hide_crossing_lines():
    plan = np.repeat(grid(7, 9), 8, axis=0)
    lines = np.array([f"line {x:.0f}" for x in plan[:, 0]])
    assert len(np.unique(crossing_lines(plan, lines))) == 9


def test_lines_without_common_places_are_not_crossed():
    rng = np.random.default_rng(4)
    along = [np.column_stack([np.full(30, 60.0 * k), rng.uniform(0, 600, 30)]) for k in range(8)]
    plan = np.concatenate(along)
    lines = find_sections(plan)
    assert len(np.unique(lines)) == 8
    assert (crossing_lines(plan, lines) == "").all()


def test_a_grid_along_the_strike_is_judged_as_one_across_it():
    """Along the strike each left-out line has a twin, which says nothing of the ground between the other lines."""
    plan, ends = grid(7, 7), np.array([(0, 0), (1000, 0), (1000, 1000), (0, 1000)])
    noise = np.random.default_rng(1).normal(0, 0.03, len(plan))
    for xy in (plan, plan[:, ::-1]):
        ramp = 50 + np.clip((xy[:, 0] - 400) / 2, 0, 100)
        found = examine(fit_horizon(PointSet(np.column_stack([xy, ramp + noise])), None, ends))
        (section,) = [one for one in found.left_out if one.scheme == "section"]
        assert section.groups == 7
        assert section.rms > 10


def test_labels_of_holes_sections_and_blocks():
    points = PointSet(np.zeros((4, 3)), hole=["A", "A", "", ""], section=["", "", "S", ""])
    assert hole_labels(points).tolist() == ["A", "A", "", "#4"]
    assert [group.tolist() for group in groups_of(hole_labels(points))] == [[3], [0, 1]]
    labels = block_labels(np.array([[0, 0], [0.9, 0.1], [1.1, 0], [0, 2.5]]), 1.0)
    assert labels.tolist() == ["0-0", "0-0", "1-0", "0-2"]


def test_points_beyond_the_hull_of_the_others():
    plane = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [2, 2], [1, 2.0]])
    groups = [np.array([k]) for k in range(6)]
    assert beyond_hull(plane, groups).tolist() == [True] * 4 + [False] * 2


def test_thin_plate_left_out_is_scipy_s():
    plane, z = cloud()
    groups = [np.array([3]), np.arange(10, 25)]
    found = thin_plate_left_out(plane, z, groups)
    for group in groups:
        rest = np.setdiff1d(np.arange(80), group)
        spline = RBFInterpolator(plane[rest], z[rest], kernel="thin_plate_spline", degree=1)
        assert found[group] == pytest.approx(spline(plane[group]), abs=1e-8)
    assert np.isnan(found[40])


def test_kriging_solves_its_system_and_honours_a_plane():
    plane, z = cloud()
    model = fit_variogram(plane, z)
    group = np.array([7])
    rest = np.setdiff1d(np.arange(80), group)
    distance = np.linalg.norm(plane[rest] - plane[7], axis=1)
    near = rest[np.argsort(distance)[:NEIGHBOURS]]
    h = np.linalg.norm(plane[near][:, None] - plane[near][None], axis=2)
    system = np.block([[model(h), np.ones((50, 1))], [np.ones((1, 50)), np.zeros((1, 1))]])
    right = np.append(model(np.linalg.norm(plane[near] - plane[7], axis=1)), 1)
    expected = np.linalg.solve(system, right)[:50] @ z[near]
    assert krige_left_out(plane, z, [group])[7] == pytest.approx(expected, rel=1e-9)
    constant = krige_left_out(plane, np.full(80, 3.5), [group])
    assert constant[7] == pytest.approx(3.5)


def test_variogram_of_a_known_field_is_found():
    """A Gaussian field of spherical covariance, range 3 and sill 2, over many places."""
    rng = np.random.default_rng(2)
    plane = rng.uniform(0, 30, (900, 2))
    h = np.linalg.norm(plane[:, None] - plane[None], axis=2)
    covariance = 2.0 - Variogram(0.0, 2.0, 3.0)(h)
    z = np.linalg.cholesky(covariance + 1e-9 * np.eye(900)) @ rng.normal(size=900)
    model = fit_variogram(plane, z)
    far = float(model(np.array([12.0]))[0])
    assert far == pytest.approx(2.0, rel=0.3)
    assert float(model(np.array([1.5]))[0]) == pytest.approx(1.375, rel=0.4)


def test_factor_holds_the_weighted_share():
    rng = np.random.default_rng(3)
    error, n = 3.0 * rng.normal(size=4000), 4000
    left = LeftOutPoints(np.arange(n), error, np.full(n, 2.0), np.full(n, 1.0))
    factor = factor_for(left, 1.0, np.ones(n), 0.9)
    # 9 = factor^2 * 2 + 1.
    assert factor == pytest.approx(2.0, rel=0.05)
    assert share_inside(error, factor**2 * left.variance + left.noise) == pytest.approx(0.9, abs=1e-3)


def test_calibration_finds_a_wrong_scale_here_and_not_there():
    """West the errors are three times what was predicted, east a third."""
    rng = np.random.default_rng(9)
    plane = rng.uniform(0, 1, (3000, 2))
    true = np.where(plane[:, 0] < 0.5, 3.0, 1 / 3)
    left = LeftOutPoints(np.arange(3000), true * rng.normal(size=3000), np.ones(3000), np.full(3000, 1e-9))
    none = LeftOutPoints(*(np.empty(0, t) for t in (int, float, float, float)))
    places = rng.uniform(0, 1, (4000, 2))
    found = calibrate(plane, left, none, none, places, np.ones(4000))
    west, east = found.at(np.array([[0.2, 0.5]]))[0], found.at(np.array([[0.8, 0.5]]))[0]
    # A quarter of each local factor's weight is the whole area's.
    assert west > 2 * east
    assert east == 1.0, "never narrowed"
    inside = share_inside(left.error, found.at(plane) ** 2)
    assert 0.88 <= inside <= 0.97
    few = LeftOutPoints(np.arange(5), np.ones(5), np.ones(5), np.ones(5))
    assert calibrate(plane, few, none, none, places, np.ones(4000)).at(places[:3]).tolist() == [1.0] * 3


def test_the_band_is_widened_for_the_holes():
    n = 200
    rng = np.random.default_rng(1)
    plane = rng.uniform(size=(n, 2))
    left = LeftOutPoints(np.arange(n), rng.normal(size=n), np.ones(n), np.full(n, 1e-9))
    worse = LeftOutPoints(np.arange(20), np.full(20, 9.0), np.ones(20), np.full(20, 1e-9))
    none = LeftOutPoints(*(np.empty(0, t) for t in (int, float, float, float)))
    found = calibrate(plane, left, none, worse, plane, np.ones(n))
    assert (BAND * found.at(plane[:20]) >= 9.0 * (1 - 1e-9)).mean() >= 0.85
    assert calibrate(plane, left, none, none, plane, np.ones(n)).at(plane).max() < 3


@cache
def sample(name: str) -> tuple[HorizonFit, PredictionResult]:
    site = geofit.io.read_site(SITE)
    surface = fit_horizon(site.horizons[name], site.settings[name], boundary=site.boundary, name=name)
    return surface, examine(surface)


@pytest.mark.parametrize("name", ["T3-T2", "T2-T1", "W", "F1"])
def test_the_truth_lies_inside_the_band_of_each_sample_horizon(name):
    surface, found = sample(name)
    grid = grid_over(surface)
    off = horizon_truth(name).offset(grid.places(surface.model))
    inside = np.mean(np.abs(off) <= BAND * found.uncertainty.sd[grid.within])
    # Wider than its name where the posterior is: calibration never narrows it.
    assert 0.85 <= round(inside, 2) <= 0.98
    assert found.uncertainty.factors[np.isfinite(found.uncertainty.factors)].min() >= 1.0


@pytest.mark.parametrize("name", ["T3-T2", "T2-T1", "W", "F1"])
def test_holes_left_out_of_the_sample_horizons(name):
    found = sample(name)[1]
    holes = next(one for one in found.left_out if one.scheme == "hole")
    assert 0.9 <= round(holes.inside, 2) <= 0.97
    assert all(one.inside >= one.inside_raw for one in found.left_out)
    assert holes.rms <= 1.01 * min(holes.references.values())
    known = np.isfinite(holes.error)
    assert holes.rms == pytest.approx(np.sqrt(np.mean(holes.error[known] ** 2)))
    assert ((holes.group != "") == known).all()
    assert holes.inside == pytest.approx(np.mean(np.abs(holes.error[known]) <= BAND * holes.sd[known]))
    assert len(found.suggestions) == 10
    assert {one.scheme for one in found.left_out} == {"hole", "section", "block"}


def test_the_truth_lies_inside_the_band_of_seeded_sites():
    """Over sixteen sites at least nine tenths of all places, and of each site between eight and ten tenths."""
    shares = []
    for seed in range(16):
        truth = paper_arrangement(seed)
        surface = fit_horizon(truth.points, boundary=truth.boundary)
        found = examine(surface)
        grid = grid_over(surface)
        places = grid.places(surface.model)
        off = places[:, 2] - truth.height(places[:, 0], places[:, 1])
        shares.append(np.mean(np.abs(off) <= BAND * found.uncertainty.sd[grid.within]))
    assert 0.9 <= np.mean(shares) <= 0.96
    assert min(shares) >= 0.8
    assert np.mean([share >= 0.85 for share in shares]) >= 0.9


def test_an_overturned_fold_leaves_out_its_sections_by_new_fits():
    surface, found = sample("M1")
    (sections,) = found.left_out
    assert sections.scheme == "section"
    assert sections.groups >= 5
    assert 0 < sections.rms < 10
    assert found.uncertainty is not None
    assert found.uncertainty.frame == "sections"
    assert found.uncertainty.factors[np.isfinite(found.uncertainty.factors)].min() >= 1.0
    grid = grid_over(surface)
    off = horizon_truth("M1").offset(grid.places(surface.model))
    assert np.mean(np.abs(off) <= BAND * found.uncertainty.sd[grid.within]) >= 0.9


def test_nothing_is_said_of_an_imported_surface():
    found = examine(sample("T3-T2")[0].with_(model=None))
    assert found.left_out == ()
    assert found.uncertainty is None
    assert found.notes[0].code == "prediction.nothing-to-leave-out"


def test_examine_can_be_stopped():
    with refused(geofit.GeofitError, "data.cancelled-in-stage"):
        examine(sample("T3-T2")[0], lambda stage, fraction: fraction < 0.4)


@cache
def blundered() -> tuple[PointSet, np.ndarray, np.ndarray]:
    truth = paper_arrangement(1)
    xyz = truth.points.xyz.copy()
    wrong = np.flatnonzero(truth.points.section == "")[[20, 70, 120]]
    xyz[wrong, 2] += (12.0, -15.0, 80.0)
    return truth.points.with_(xyz=xyz), wrong, truth.boundary


def test_planted_blunders_are_listed_and_not_dropped():
    points, wrong, boundary = blundered()
    surface = fit_horizon(points, boundary=boundary)
    found = examine(surface)
    assert set(wrong) <= {outlier.index for outlier in found.outliers}
    assert len(found.outliers) <= 6
    assert found.outliers[0].index == wrong[2]
    assert found.outliers[0].name == points.describe(wrong[2])
    assert found.outliers[0].ratio == pytest.approx(abs(found.outliers[0].error) / found.outliers[0].sd)
    assert surface.model.problem.kept.all()


def test_robust_weights_find_the_truth_behind_blunders_and_leave_clean_data_alone():
    points, wrong, boundary = blundered()
    truth = paper_arrangement(1)
    x, y = truth.places(3000).T
    height = truth.height(x, y)
    plain = fit_horizon(points, boundary=boundary)
    robust = fit_horizon(points, FitSettings(robust=True), boundary=boundary)
    clean = fit_horizon(truth.points, boundary=boundary)
    assert rms(robust.elevation(x, y) - height) < 0.5 * rms(plain.elevation(x, y) - height)
    assert rms(robust.elevation(x, y) - height) < 1.1 * rms(clean.elevation(x, y) - height)
    assert np.flatnonzero(~robust.model.problem.kept).tolist() == wrong.tolist()
    assert with_code(robust.accuracy.notes, "fitting.outliers-not-used").params["count"] == 3
    assert np.abs(robust.accuracy.residuals[robust.core]).max() < 1e-9
    assert robust.accuracy.n == len(points)
    same = fit_horizon(truth.points, FitSettings(robust=True), boundary=boundary)
    assert np.abs(same.elevation(x, y) - clean.elevation(x, y)).max() < 0.1


def test_robust_is_true_or_false():
    with refused(SettingsError, "data.setting-not-true-or-false"):
        FitSettings(robust="yes")


def test_uncalibrated_changes_nothing():
    assert uncalibrated().at(np.zeros((2, 2))).tolist() == [1.0, 1.0]

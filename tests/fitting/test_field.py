from __future__ import annotations

import numpy as np
import pytest
from threadpoolctl import threadpool_limits
from truth import EASTING, NORTHING, hills, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.long_arrays import BLOCK
from geofit.fitting import resolution
from geofit.fitting.active_points import Data
from geofit.fitting.field import (
    choose_covariance,
    drift_of,
    plane_trend,
    precision_band,
    relative_noise,
    restricted,
    smooth,
    widened_space,
)
from geofit.fitting.resolution import EVEN, choose_field, even_space, longest_span
from geofit.fitting.weighted_points import WeightedPoints
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

SIZE = 2000.0
N = 600


@pytest.fixture(autouse=True)
def _one_thread():
    """As fit_horizon does: on small banded systems threads wait for each other."""
    with threadpool_limits(limits=1):
        yield


def rugged(seed):
    """A self-affine relief, rough down to 40 m: waves whose height falls with the wavelength's power 0.6."""
    rng = np.random.default_rng(seed)
    length = 10 ** rng.uniform(np.log10(40), np.log10(SIZE), 400)
    azimuth, phase = rng.uniform(0, 2 * np.pi, (2, 400))
    amplitude = length**0.6 * rng.normal(size=400)
    amplitude *= 25 / np.sqrt((amplitude**2).sum() / 2)
    kx, ky = 2 * np.pi / length * np.cos(azimuth), 2 * np.pi / length * np.sin(azimuth)

    def height(x, y):
        x, y = np.asarray(x, float) - EASTING, np.asarray(y, float) - NORTHING
        return 1000 + np.sin(np.multiply.outer(x, kx) + np.multiply.outer(y, ky) + phase) @ amplitude

    return height


def cloud(n, seed, noise, height):
    """Places in units of their spacing, heights about their trend, and that trend."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, SIZE, (n, 2))
    z = height(xy[:, 0] + EASTING, xy[:, 1] + NORTHING) + rng.normal(0, noise, n)
    plane = xy / (SIZE / np.sqrt(n))
    trend = plane_trend(plane, z, np.ones(n))
    return plane, z - np.column_stack([np.ones(n), plane]) @ trend, trend


def space_over(n, degree=3):
    side = np.sqrt(n)
    knots = bspline.clamped_knots(np.linspace(0, side, int(np.ceil(side / 0.6)) + 1), degree)
    return TensorSpace(knots, knots, degree)


def chosen(space, plane, z, smoothing=None):
    return choose_covariance(space, WeightedPoints(plane, z, np.ones(len(z))), smoothing)[0][0]


def smoothed(space, field, plane, z):
    return smooth(space, field, WeightedPoints(plane, z, np.ones(len(z)))).coefficients


def points_of(n, seed, noise, height, scale=1.0):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, SIZE, (n, 2))
    z = height(xy[:, 0] + EASTING, xy[:, 1] + NORTHING) + rng.normal(0, noise, n)
    return PointSet(np.column_stack([xy * scale + (EASTING, NORTHING), z]))


@pytest.mark.parametrize("noise", [0.5, 2.0])
@pytest.mark.parametrize("seed", range(2))
def test_the_noise_of_a_smooth_surface_is_found(noise, seed):
    plane, z, _ = cloud(N, seed, noise, hills(seed))
    field = chosen(space_over(N), plane, z)
    assert field.alpha >= 3
    assert field.noise == pytest.approx(noise, rel=0.2)
    assert not field.contradictory


def test_the_reported_noise_is_that_of_the_points():
    noise = [
        fit_horizon(points_of(800, seed, 0.5, hills(seed)), FitSettings(core="none")).diagnostics["noise"]
        for seed in range(3)
    ]
    assert 0.8 * 0.5 < np.median(noise) < 1.1 * 0.5


@pytest.mark.parametrize("seed", range(2))
def test_the_field_is_nearer_to_the_truth_than_its_data(seed):
    plane, z, trend = cloud(N, seed, 2.0, hills(seed))
    space = space_over(N)
    coefficients = smoothed(space, chosen(space, plane, z), plane, z)
    at = np.random.default_rng(9).uniform(0.05, 0.95, (2000, 2)) * np.sqrt(N)
    metres = at * (SIZE / np.sqrt(N)) + (EASTING, NORTHING)
    found = space.matrix(at) @ coefficients + np.column_stack([np.ones(2000), at]) @ trend
    assert rms(found - hills(seed)(*metres.T)) < 0.85 * 2.0


@pytest.mark.parametrize("seed", range(2))
def test_a_rugged_surface_takes_the_rougher_field(seed):
    plane, z, _ = cloud(N, seed, 0.05, rugged(seed))
    assert chosen(space_over(N), plane, z).alpha == 2


def groups_of_holes(seed, height):
    """Twenty groups of six holes each, 30 m wide, and 600 places in the groups."""
    rng = np.random.default_rng(seed)
    middle = rng.uniform(100, SIZE - 100, (20, 1, 2))
    holes, places = ((middle + rng.normal(0, 30, (20, each, 2))).reshape(-1, 2) for each in (6, 30))
    xy, at = (np.clip(part, 0, SIZE) + np.array([EASTING, NORTHING]) for part in (holes, places))
    return PointSet(np.column_stack([xy, height(*xy.T)])), at


def field_alone(points):
    corners = np.array([[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]]) + np.array([EASTING, NORTHING])
    return fit_horizon(points, FitSettings(core="none", max_iterations=0), corners)


@pytest.mark.parametrize("seed", [1, 2])
def test_holes_in_groups_on_a_rugged_surface_take_a_finer_field(seed, monkeypatch):
    """What holes near to each other tell of short waves is not noise: the field between them is nearer to the truth."""
    points, at = groups_of_holes(seed, rugged(seed))
    fine = field_alone(points)
    monkeypatch.setattr("geofit.fitting.resolution.CLOSE", EVEN)
    even = field_alone(points)
    assert longest_span(fine.model.net.base) < 0.3 < longest_span(even.model.net.base)
    assert fine.diagnostics["noise"] < 0.85 * even.diagnostics["noise"]
    truth = rugged(seed)(*at.T)
    assert rms(fine.elevation(*at.T) - truth) < 0.96 * rms(even.elevation(*at.T) - truth)


@pytest.mark.parametrize("seed", [0, 1])
def test_holes_in_groups_on_a_smooth_surface_take_no_more_control_points(seed, monkeypatch):
    monkeypatch.setattr("geofit.fitting.smoothness.SMOOTHER", {})
    points, _ = groups_of_holes(seed, hills(seed))
    assert longest_span(field_alone(points).model.net.base) > 0.4


def noisy_points(seed, height, noise=0.3, n=1000):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, SIZE, (n, 2)) + np.array([EASTING, NORTHING])
    at = rng.uniform(0.05 * SIZE, 0.95 * SIZE, (3000, 2)) + np.array([EASTING, NORTHING])
    return PointSet(np.column_stack([xy, height(*xy.T) + rng.normal(0, noise, n)])), at


@pytest.mark.parametrize("seed", [1, 2])
def test_a_surface_far_smoother_than_its_points_are_dense_takes_longer_spans(seed, monkeypatch):
    height = hills(seed, shortest=1000.0)
    points, at = noisy_points(seed, height, n=3000)
    simple = field_alone(points)
    monkeypatch.setattr("geofit.fitting.resolution.COARSEST", 10**9)
    even = field_alone(points)
    assert longest_span(simple.model.net.base) > 1.2 * longest_span(even.model.net.base)
    truth = height(*at.T)
    assert rms(simple.elevation(*at.T) - truth) < 1.05 * rms(even.elevation(*at.T) - truth)


@pytest.mark.parametrize(("n", "noise", "most"), [(60, 0.5, 0.38), (120, 0.01, 0.0085)])
def test_a_gentle_bowl_is_met_by_a_range_far_beyond_the_spacing(n, noise, most):
    """Ranges of two and a half spacings at most gave 0.48 and 0.010 m; now it is 0.28 and 0.0065 m."""

    def bowl(x, y):
        return 40 * (((x - EASTING) / 1000 - 1) ** 2 + 1.1 * ((y - NORTHING) / 1000 - 0.9) ** 2)

    errors = []
    for seed in range(4):
        points, at = noisy_points(seed, bowl, noise, n)
        off = fit_horizon(points).elevation(*at.T) - bowl(*at.T)
        errors.append(rms(off[np.isfinite(off)]))
    assert np.median(errors) < most


@pytest.mark.parametrize("seed", [1, 2])
def test_a_rugged_surface_keeps_the_spans_that_its_relief_needs(seed):
    points, _ = noisy_points(seed, rugged(seed))
    assert longest_span(field_alone(points).model.net.base) < 1


def test_accurate_points_keep_the_spans_that_noise_alone_does_not_explain(monkeypatch):
    """On longer spans the noise would be several times as large: they cut the truth, which the points resolve."""
    monkeypatch.setattr("geofit.fitting.smoothness.SMOOTHER", {})
    points, at = noisy_points(1, hills(1), noise=0.01)
    found = field_alone(points)
    assert found.diagnostics["noise"] < 0.02
    monkeypatch.setattr("geofit.fitting.resolution.LOUDER", np.inf)
    cut = field_alone(points)
    truth = hills(1)(*at.T)
    assert rms(found.elevation(*at.T) - truth) < rms(cut.elevation(*at.T) - truth)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_smooth_surface_takes_the_smoothest_field_and_gains_by_it(seed, monkeypatch):
    points, at = noisy_points(seed, hills(seed), n=600, noise=0.02)
    truth = hills(seed)(*at.T)
    smooth = field_alone(points)
    assert smooth.model.net.field.alpha == 6
    monkeypatch.setattr("geofit.fitting.smoothness.SMOOTHER", {})
    rough = field_alone(points)
    assert rms(smooth.elevation(*at.T) - truth) < 0.9 * rms(rough.elevation(*at.T) - truth)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_rugged_surface_does_not_pass_for_noise_about_a_smooth_one(seed, monkeypatch):
    points, _ = noisy_points(seed, rugged(seed))
    field = field_alone(points).model.net.field
    assert field.alpha <= 3
    monkeypatch.setattr("geofit.fitting.smoothness.SMOOTHER", {})
    assert field.noise < 1.25 * field_alone(points).model.net.field.noise


@pytest.mark.parametrize("azimuth", [0.0, 0.6, 2.0])
def test_the_direction_of_long_ridges_is_found(azimuth):
    c, s = np.cos(azimuth), np.sin(azimuth)

    def ridges(x, y):
        x, y = x - EASTING, y - NORTHING
        return 20 * np.sin(2 * np.pi * (c * x + s * y) / 700) + 4 * np.sin(2 * np.pi * (c * y - s * x) / 1500)

    plane, z, _ = cloud(300, 0, 0.3, ridges)
    p, q = chosen(space_over(300), plane, z).stretch
    # H is largest along the ridges, where the field changes least.
    assert np.hypot(p, q) > 0.3
    along = 0.5 * np.arctan2(q, p)
    assert abs(np.sin(along - (azimuth + np.pi / 2))) < 0.25


def test_turning_the_axes_turns_the_field():
    plane, z, _ = cloud(200, 1, 0.3, rugged(1))
    knots_u = bspline.clamped_knots(np.linspace(0, 14.2, 30), 3)
    knots_v = bspline.clamped_knots(np.linspace(0, 14.2, 26), 3)
    one, value = choose_covariance(TensorSpace(knots_u, knots_v), WeightedPoints(plane, z, np.ones(200)))[0]
    other, same = choose_covariance(TensorSpace(knots_v, knots_u), WeightedPoints(plane[:, ::-1], z, np.ones(200)))[0]
    assert same == pytest.approx(value, abs=1e-6)
    assert other.turned.stretch == pytest.approx(one.stretch, abs=1e-9)


def test_the_wide_space_is_cut_at_the_edge_without_a_change():
    space = space_over(40)
    wide = widened_space(space)
    assert wide.knots_u[0] < space.knots_u[0] - 1.5
    net = np.random.default_rng(0).normal(size=(wide.size, 2))
    at = np.random.default_rng(1).uniform(0, np.sqrt(40), (300, 2))
    np.testing.assert_allclose(space.matrix(at) @ restricted(space, net), wide.matrix(at) @ net, atol=1e-12)


def test_smooth_solves_the_penalised_problem_with_a_free_plane():
    plane, z, _ = cloud(80, 2, 0.5, hills(2))
    space = space_over(80)
    field = chosen(space, plane, z)
    wide = widened_space(space)
    a = wide.matrix(plane).toarray()
    band = precision_band(wide, field)
    penalty = np.zeros((wide.size, wide.size))
    for k in range(len(band)):
        index = np.arange(wide.size - k)
        penalty[index + k, index] = penalty[index, index + k] = band[k, : wide.size - k]
    f = np.column_stack([np.ones(80), plane])
    # One least squares over field and plane, the plane free.
    system = np.block([[a.T @ a + penalty, a.T @ f], [f.T @ a, f.T @ f]])
    solution = np.linalg.solve(system, np.concatenate([a.T @ z, f.T @ z]))
    at = np.random.default_rng(3).uniform(0, np.sqrt(80), (50, 2))
    expected = wide.matrix(at) @ solution[:-3] + np.column_stack([np.ones(50), at]) @ solution[-3:]
    found = smooth(space, field, WeightedPoints(plane, z, np.ones(80)))
    np.testing.assert_allclose(space.matrix(at) @ found.coefficients, expected, atol=1e-5)
    np.testing.assert_allclose(found.plane, solution[-3:], atol=1e-4)


@pytest.mark.parametrize(("seed", "height"), [(0, hills(0)), (1, rugged(1))])
def test_lambda_does_not_depend_on_the_unit_of_length(seed, height):
    settings = FitSettings(core="none")
    one, ten = (fit_horizon(points_of(300, seed, 0.5, height, scale), settings).diagnostics for scale in (1.0, 10.0))
    assert ten["energy"] == one["energy"]
    assert ten["smoothing"] == pytest.approx(one["smoothing"], rel=1e-6)
    assert ten["noise"] == pytest.approx(one["noise"], rel=1e-6)
    assert ten["spacing"] == pytest.approx(10 * one["spacing"], rel=1e-6)


def test_pure_noise_is_found_to_be_noise():
    plane, _, _ = cloud(400, 0, 1.0, hills(0))
    z = np.random.default_rng(3).normal(0, 2.0, 400)
    field = chosen(space_over(400), plane, z)
    assert field.noise == pytest.approx(2.0, rel=0.25)


def test_a_given_smoothing_is_taken():
    plane, z, _ = cloud(200, 0, 0.5, hills(0))
    assert chosen(space_over(200), plane, z, 0.37).smoothing == pytest.approx(0.37)


def test_more_smoothing_bends_less_and_misses_more():
    plane, z, _ = cloud(200, 0, 0.5, hills(0))
    space = space_over(200)
    misfits = []
    for smoothing in (1e-6, 1e-2, 1e2):
        field = chosen(space, plane, z, smoothing)
        coefficients = smoothed(space, field, plane, z)
        misfits.append(rms(space.matrix(plane) @ coefficients - z))
    assert misfits == sorted(misfits)
    assert misfits[0] < 0.1 * misfits[2]


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_plane_is_met_whatever_the_degree(degree):
    plane, _, _ = cloud(60, 1, 1.0, hills(0))
    z = 3 + 2 * plane[:, 0] - plane[:, 1]
    trend = plane_trend(plane, z, np.ones(60))
    np.testing.assert_allclose(trend, [3, 2, -1], atol=1e-9)
    space = space_over(60, degree)
    rest = z - np.column_stack([np.ones(60), plane]) @ trend
    field = chosen(space, plane, rest)
    coefficients = smoothed(space, field, plane, rest)
    assert np.abs(coefficients).max() < 1e-6


def test_the_trend_of_collinear_points_is_level_across_them():
    t = np.linspace(0, 10, 20)
    trend = plane_trend(np.column_stack([t, 0.5 * t]), 4 + 3 * t, np.ones(20))
    assert np.isfinite(trend).all()
    assert abs(trend[1:] @ np.array([-0.5, 1.0])) < 1e-9
    np.testing.assert_allclose(np.column_stack([np.ones(20), t, 0.5 * t]) @ trend, 4 + 3 * t, atol=1e-9)


def test_the_trend_of_very_many_points_is_that_of_least_squares():
    rng, n = np.random.default_rng(5), BLOCK + 1_000
    plane, weight = rng.uniform(0, (800, 300), (n, 2)), rng.uniform(0.1, 2, n)
    z = 1500 + plane @ [0.2, -0.3] + rng.normal(0, 5, n)
    design = np.column_stack([np.ones(n), plane])
    expected = np.linalg.lstsq(design * np.sqrt(weight)[:, None], z * np.sqrt(weight), rcond=None)[0]
    np.testing.assert_allclose(plane_trend(plane, z, weight), expected, rtol=1e-9)
    both = plane_trend(plane, np.column_stack([z, -2 * z]), weight)
    np.testing.assert_allclose(both, np.outer(expected, [1, -2]), rtol=1e-9)
    line = np.outer(plane[:, 0], [1, 0.5])
    trend = plane_trend(line, 4 + 3 * plane[:, 0], weight)
    np.testing.assert_allclose(trend, [4, 2.4, 1.2], atol=1e-9)


def test_the_trend_follows_the_weights():
    plane = np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]])
    z = np.array([0.0, 0, 0, 100])
    trend = plane_trend(plane, z, np.array([1, 1, 1, 1e-9]))
    np.testing.assert_allclose(trend, 0, atol=1e-6)


def test_relative_noise_follows_stated_accuracies_within_bounds():
    np.testing.assert_allclose(relative_noise(np.array([0.1, 0.2, np.nan, 0.2])), [0.5, 1, 1, 1])
    np.testing.assert_allclose(relative_noise(np.array([1e-6, 0.2, 0.2, 1e6])), [0.1, 1, 1, 10])
    np.testing.assert_allclose(relative_noise(np.full(3, np.nan)), 1)


def test_points_in_a_line_determine_no_slope_across_it():
    t = np.linspace(0, 10, 20)
    assert drift_of(np.column_stack([t, 0.5 * t])).shape == (3, 2)
    assert drift_of(np.random.default_rng(0).uniform(0, 5, (20, 2))).shape == (3, 3)


def test_points_all_at_one_place_are_noise():
    field = chosen(space_over(60), np.full((20, 2), 3.0), np.arange(20.0))
    assert field.noise == pytest.approx(np.arange(20.0).std(), rel=0.05)


@pytest.mark.parametrize("seed", [1, 2])
def test_each_smoothness_finds_its_own_noise_whatever_the_others_find(seed):
    """Relief that a coarse space counts as noise is resolved by a finer one, so each noise is far from its start."""
    plane, z, trend = cloud(1000, seed, 0.05, hills(seed, shortest=120.0))
    side = np.sqrt(1000)
    coarse, fine = (even_space((0, side, 0, side), EVEN, 3, size) for size in (484, 1444))
    given = WeightedPoints(plane, z, np.ones(1000))
    known = [field for field, _ in choose_covariance(coarse, given, trend=trend)]
    assert {field.alpha for field in known} >= {2, 3}
    found = choose_covariance(fine, given, known=known, trend=trend)
    together = {field.alpha: value for field, value in found}
    for guess in known:
        ((alone, value),) = choose_covariance(fine, given, known=[guess], trend=trend)
        assert together[alone.alpha] == pytest.approx(value, abs=1e-6)


@pytest.mark.parametrize("seed", [0, 1])
def test_shorter_spans_that_cannot_win_are_not_tried_and_the_field_is_the_same(seed, monkeypatch):
    tried = []

    def counted(space, *given, **words):
        tried.append(space.size)
        return choose_covariance(space, *given, **words)

    monkeypatch.setattr(resolution, "choose_covariance", counted)
    plane, z, trend = cloud(10_000, seed, 0.05, hills(seed))
    side = float(np.sqrt(len(plane)))
    data = Data(plane, z, np.full(len(z), np.nan), np.ones(len(z)), (0.0, side, 0.0, side), 20.0, trend)
    found = []
    # Spans no longer than the spacing rule nothing out.
    for span in (longest_span, lambda space: 0.0):
        monkeypatch.setattr(resolution, "longest_span", span)
        tried.clear()
        field, space = choose_field(data, FitSettings(), 20_000)
        found.append((field, space.size, len(tried)))
    (field, size, count), (expected, wanted, more) = found
    assert (field, size) == (expected, wanted)
    assert count <= more
    assert seed != 0 or count < more


@pytest.mark.parametrize(("grid", "seed"), [(False, 1), (False, 8), (True, 11), (True, 13)])
def test_rounding_is_not_taken_for_a_good_fit(grid, seed):
    """The smoothest fields of long range cancel in sums; a misfit that is lost in rounding must not attract the search.

    The order of the points decides on the rounding alone.
    """
    rng, side = np.random.default_rng(seed), 1000.0
    if grid:
        lines = np.linspace(80, 920, 6)
        xy = np.stack(np.meshgrid(lines, lines, indexing="ij"), axis=-1).reshape(-1, 2) + rng.uniform(-1, 1, (36, 2))
    else:
        xy = rng.uniform(0, side, (50, 2))
    z = 600 * np.exp(-xy[:, 0] / 400) + rng.normal(0, 0.5, len(xy))
    corners = np.array([(0, 0), (side, 0), (side, side), (0, side)])
    for order in (slice(None), slice(None, None, -1)):
        noise = fit_horizon(PointSet(np.column_stack([xy, z])[order]), None, corners).diagnostics["noise"]
        assert 0.3 < noise < 0.7

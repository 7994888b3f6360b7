from __future__ import annotations

import numpy as np
import pytest
from threadpoolctl import threadpool_limits
from truth import EASTING, NORTHING, hills, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.fitting.field import cell_weights, choose, plane_trend, smooth
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


def points_of(n, seed, noise, height, scale=1.0):
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, SIZE, (n, 2))
    z = height(xy[:, 0] + EASTING, xy[:, 1] + NORTHING) + rng.normal(0, noise, n)
    return PointSet(np.column_stack([xy * scale + (EASTING, NORTHING), z]))


@pytest.mark.parametrize("noise", [0.5, 2.0])
@pytest.mark.parametrize("seed", range(2))
def test_the_noise_of_a_smooth_surface_is_found(noise, seed):
    plane, z, _ = cloud(N, seed, noise, hills(seed))
    field = choose(space_over(N), plane, z, np.ones(N))
    assert field.energy == "smooth"
    assert field.noise == pytest.approx(noise, rel=0.25)
    assert not field.contradictory


def test_the_reported_noise_is_that_of_the_points_but_for_the_weights_shared_by_cells():
    # Crowded cells weigh less, and the noise comes out up to a third low on even data.
    noise = [
        fit_horizon(points_of(800, seed, 0.5, hills(seed)), FitSettings(core="none")).diagnostics["noise"]
        for seed in range(3)
    ]
    assert 0.65 * 0.5 < np.median(noise) < 1.1 * 0.5


@pytest.mark.parametrize("seed", range(2))
def test_the_field_is_nearer_to_the_truth_than_its_data(seed):
    plane, z, trend = cloud(N, seed, 2.0, hills(seed))
    space, weight = space_over(N), np.ones(N)
    coefficients = smooth(space, choose(space, plane, z, weight), plane, z, weight)
    at = np.random.default_rng(9).uniform(0.05, 0.95, (2000, 2)) * np.sqrt(N)
    metres = at * (SIZE / np.sqrt(N)) + (EASTING, NORTHING)
    found = space.matrix(at) @ coefficients + np.column_stack([np.ones(2000), at]) @ trend
    assert rms(found - hills(seed)(*metres.T)) < 0.85 * 2.0


@pytest.mark.parametrize("seed", range(2))
def test_a_rugged_surface_takes_the_thin_plate_s_energy(seed):
    plane, z, _ = cloud(N, seed, 0.05, rugged(seed))
    assert choose(space_over(N), plane, z, np.ones(N)).energy == "plate"


@pytest.mark.parametrize(("seed", "height"), [(0, hills(0)), (1, rugged(1))])
def test_lambda_does_not_depend_on_the_unit_of_length(seed, height):
    settings = FitSettings(core="none")
    one, ten = (fit_horizon(points_of(300, seed, 0.5, height, scale), settings).diagnostics for scale in (1.0, 10.0))
    assert ten["energy"] == one["energy"]
    assert ten["smoothing"] == pytest.approx(one["smoothing"], rel=1e-6)
    assert ten["noise"] == pytest.approx(one["noise"], rel=1e-6)
    assert ten["spacing"] == pytest.approx(10 * one["spacing"], rel=1e-6)


def test_pure_noise_is_called_contradictory():
    plane, _, _ = cloud(400, 0, 1.0, hills(0))
    z = np.random.default_rng(3).normal(0, 2.0, 400)
    field = choose(space_over(400), plane, z, np.ones(400))
    assert field.contradictory
    assert field.noise == pytest.approx(2.0, rel=0.25)


def test_a_given_smoothing_is_taken():
    plane, z, _ = cloud(200, 0, 0.5, hills(0))
    assert choose(space_over(200), plane, z, np.ones(200), 0.37).smoothing == pytest.approx(0.37)


def test_more_smoothing_bends_less_and_misses_more():
    plane, z, _ = cloud(200, 0, 0.5, hills(0))
    space, weight = space_over(200), np.ones(200)
    misfits = []
    for smoothing in (1e-6, 1e-2, 1e2):
        field = choose(space, plane, z, weight, smoothing)
        coefficients = smooth(space, field, plane, z, weight)
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
    field = choose(space, plane, rest, np.ones(60))
    coefficients = smooth(space, field, plane, rest, np.ones(60))
    assert np.abs(coefficients).max() < 1e-6


def test_the_trend_of_collinear_points_is_level_across_them():
    t = np.linspace(0, 10, 20)
    trend = plane_trend(np.column_stack([t, 0.5 * t]), 4 + 3 * t, np.ones(20))
    assert np.isfinite(trend).all()
    assert abs(trend[1:] @ np.array([-0.5, 1.0])) < 1e-9
    np.testing.assert_allclose(np.column_stack([np.ones(20), t, 0.5 * t]) @ trend, 4 + 3 * t, atol=1e-9)


def test_the_trend_follows_the_weights():
    plane = np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]])
    z = np.array([0.0, 0, 0, 100])
    trend = plane_trend(plane, z, np.array([1, 1, 1, 1e-9]))
    np.testing.assert_allclose(trend, 0, atol=1e-6)


def test_points_of_a_crowded_cell_share_their_weight():
    space = TensorSpace(*[bspline.clamped_knots(np.arange(5.0), 3)] * 2)
    plane = np.array([[0.1, 0.1], [0.2, 0.3], [0.4, 0.6], [2.5, 2.5]])
    weight = cell_weights(space, plane, np.full(4, np.nan))
    # Cells hold two points in the median.
    np.testing.assert_allclose(weight, [2 / 3, 2 / 3, 2 / 3, 1])


def test_weights_follow_stated_accuracies_within_bounds():
    space = TensorSpace(*[bspline.clamped_knots(np.arange(5.0), 3)] * 2)
    plane = np.array([[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5]])
    weight = cell_weights(space, plane, np.array([0.1, 0.2, np.nan, 0.2]))
    np.testing.assert_allclose(weight, [4, 1, 1, 1])
    extreme = cell_weights(space, plane, np.array([1e-6, 0.2, 0.2, 1e6]))
    np.testing.assert_allclose(extreme, [100, 1, 1, 0.01])


def test_points_all_at_one_place_are_called_contradictory():
    field = choose(space_over(60), np.full((20, 2), 3.0), np.arange(20.0), np.ones(20))
    assert field.contradictory
    assert np.isfinite(field.noise)

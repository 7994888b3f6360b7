from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from threadpoolctl import threadpool_limits
from truth import EASTING, NORTHING, paper_arrangement, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.checks.check import sigma
from geofit.fitting.active_points import gather_points
from geofit.fitting.adjust import pull_to_worst
from geofit.fitting.core import fit_with_core
from geofit.fitting.density import split_auto
from geofit.fitting.parametrize import parametrize


def silent(stage, fraction):
    """Hear nothing."""


@pytest.fixture(scope="module")
def fitted():
    """A fit whose given smoothing is far too stiff for its periphery."""
    truth = paper_arrangement(4)
    settings = FitSettings(smoothing=10.0)
    parametrization = parametrize(truth.points, settings, truth.boundary)
    split = split_auto(parametrization.plane, parametrization.area)
    kept = np.ones(len(truth.points), bool)
    # As fit_horizon does: on small banded systems threads wait for each other.
    with threadpool_limits(limits=1):
        data = gather_points(truth.points.accuracy, parametrization, settings, kept, split)
        net = fit_with_core(truth.points, data, parametrization, split, kept, settings, silent)
    return net, parametrization, split


def residuals(net, parametrization):
    return parametrization.values - net.space.matrix(parametrization.plane / net.unit) @ net.coefficients


def test_sigma_falls_and_the_core_stays_bit_for_bit(fitted):
    net, parametrization, split = fitted
    before = residuals(net, parametrization)
    better = pull_to_worst(net, parametrization, ~split.inside, before)
    assert sigma(residuals(better, parametrization)) < 0.6 * sigma(before)
    assert net.frozen.any()
    np.testing.assert_array_equal(better.coefficients[net.frozen], net.coefficients[net.frozen])
    np.testing.assert_allclose(residuals(better, parametrization)[split.inside], 0, atol=1e-7)


def test_nothing_moves_outside_the_supports_near_the_worst_points(fitted):
    net, parametrization, split = fitted
    movable = np.flatnonzero(~split.inside)
    # Two bad points and all others good: only these are pulled.
    d = np.full(len(parametrization.values), 1e-6)
    bad = movable[[0, 40]]
    d[bad] = 5.0
    better = pull_to_worst(net, parametrization, ~split.inside, d)
    moved = better.coefficients != net.coefficients
    acting = np.zeros(net.space.size, bool)
    acting[net.space.matrix(parametrization.plane[bad] / net.unit).indices] = True
    assert moved.any()
    assert not (moved & ~acting).any()
    assert not (moved & net.frozen).any()


def test_points_that_may_not_be_pulled_are_not(fitted):
    net, parametrization, split = fitted
    nobody = np.zeros(len(parametrization.values), bool)
    assert pull_to_worst(net, parametrization, nobody, residuals(net, parametrization)) is None
    assert pull_to_worst(net, parametrization, ~split.inside, np.zeros(len(parametrization.values))) is None


def stiff_cloud(n=120, spikes=4, seed=0):
    rng = np.random.default_rng(seed)
    plan = rng.uniform(0, 1000, (n, 2))
    z = 500 + 0.1 * plan[:, 0]
    z[:spikes] += 8.0
    return PointSet(np.column_stack([plan + np.array((EASTING, NORTHING)), z]))


def test_a_fit_above_epsilon_is_adjusted_until_it_passes_and_says_so():
    surface = fit_horizon(stiff_cloud(), FitSettings(core="none", smoothing=100.0, epsilon=0.5))
    assert surface.accuracy.passed
    assert with_code(surface.accuracy.notes, "fitting.sigma-brought-below-epsilon").params["step"] > 0


def test_without_iterations_it_stays_above_epsilon_and_says_so():
    settings = FitSettings(core="none", smoothing=100.0, epsilon=0.5, max_iterations=0)
    surface = fit_horizon(stiff_cloud(), settings)
    assert not surface.accuracy.passed
    assert with_code(surface.accuracy.notes, "fitting.sigma-above-epsilon").severity == "warning"


def test_a_contradiction_cannot_be_adjusted_away():
    points = stiff_cloud(spikes=0)
    twice = PointSet.concatenate([points, points.with_(xyz=points.xyz + np.array([0, 0, 4.0]))])
    surface = fit_horizon(twice, FitSettings(epsilon=0.5))
    assert not surface.accuracy.passed
    assert surface.accuracy.max_abs == pytest.approx(4.0, rel=0.05)
    assert len(surface.accuracy.conflicts) == len(points)
    assert with_code(surface.accuracy.notes, "fitting.sigma-above-epsilon").severity == "warning"


def test_data_that_contradict_each_other_are_not_chased():
    rng = np.random.default_rng(1)
    plan = rng.uniform(0, 200, (60, 2))
    plane = 100 + 0.05 * plan[:, 0]
    points = PointSet(np.column_stack([plan, plane + rng.normal(0, 20, len(plan))]))
    surface = fit_horizon(points)
    assert not surface.accuracy.passed
    assert with_code(surface.accuracy.notes, "fitting.sigma-of-contradiction").severity == "warning"
    assert rms(surface.elevation(*plan.T) - plane) < 6.0
    strict = fit_horizon(points, FitSettings(strict=True))
    assert strict.accuracy.sigma < 0.1 * surface.accuracy.sigma


def in_a_wide_area(relief, **settings):
    """Return the fit of 60 points within 100 m, in an area of 10 km."""
    rng, corner = np.random.default_rng(0), np.array([EASTING, NORTHING])
    xy, unit_square = rng.uniform(0, 100, (60, 2)), np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    z = relief * (5 * np.sin(xy[:, 0] / 20) + 3 * np.cos(xy[:, 1] / 30))
    return fit_horizon(
        PointSet(np.column_stack([xy + corner, z])), FitSettings(**settings), corner - 5_000 + 10_100 * unit_square
    )


def test_points_in_an_area_far_wider_than_they_are_do_not_contradict_each_other():
    surface = in_a_wide_area(relief=1.0)
    assert surface.accuracy.max_abs <= 0.1
    assert surface.accuracy.sigma < surface.accuracy.epsilon


def test_points_that_so_wide_an_area_cannot_follow_are_explained_by_it():
    surface = in_a_wide_area(relief=1.0, max_control_points=400)
    reason = with_code(surface.accuracy.notes, "fitting.tolerance-not-met").params["reason"]
    assert reason.code == "fitting.area-far-wider"
    assert reason.params["extent"] == pytest.approx(90, rel=0.1)

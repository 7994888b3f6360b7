"""A core's own field: where the relief of a core is sharper than the sparse points around it can tell."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator
from truth import paper_arrangement, rms

import geofit
from geofit.fitting import core as fitting_core
from geofit.fitting.active_points import Data
from geofit.fitting.core_relief import CoreRelief, relief_of_core
from geofit.fitting.field import FieldChoice
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

ORIGIN = np.array([500_000.0, 3_100_000.0])


FIELD = FieldChoice(3, 1.0, 1.0, (0.0, 0.0), 0.1)


NOTHING = np.empty(0)
NO_DATA = Data(np.empty((0, 2)), NOTHING, NOTHING, NOTHING, (0.0, 1.0, 0.0, 1.0), 1.0, np.zeros(3))


def relief(space, seed, core, reach):
    """Return a field of random coefficients over a core."""
    coefficients = np.random.default_rng(seed).normal(size=space.size)
    return CoreRelief(space, coefficients, 0.5, core, reach, FIELD, NO_DATA)


def height(plan):
    """Return a gentle slope with a channel, 60 m wide and 8 m deep, where the core is."""
    x, y = (plan - ORIGIN).T
    aside = (x - 900 - 40 * np.sin(y / 70)) / 30
    return 1400 + 0.03 * x + 6 * np.sin(y / 500) - 8 * np.exp(-(aside**2)) * np.exp(-(((y - 1000) / 250) ** 4))


def channel(seed, noise=0.02):
    """Return the points of 9 sections across the channel and 50 holes around, and 4,000 places between the sections."""
    rng = np.random.default_rng(seed)
    across = np.stack(np.meshgrid(np.arange(800, 1001, 12.0), np.arange(840, 1161, 40.0)), -1).reshape(-1, 2)
    around = rng.uniform(0, 2000, (50, 2))
    plan = ORIGIN + np.concatenate([across + rng.uniform(-2, 2, across.shape), around])
    z = height(plan) + rng.normal(0, noise, len(plan))
    return np.column_stack([plan, z]), ORIGIN + rng.uniform((805, 845), (995, 1155), (4000, 2))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_core_sharper_than_its_surroundings_is_predicted_between_its_sections(seed, monkeypatch):
    xyz, places = channel(seed)
    surface = geofit.fit_horizon(geofit.PointSet(xyz), geofit.FitSettings())
    assert surface.core.sum() > 100
    assert np.abs(surface.distance(xyz[surface.core])).max() < 1e-6
    local = xyz - xyz.mean(axis=0)
    plate = RBFInterpolator(local[:, :2], local[:, 2], kernel="thin_plate_spline")
    exact = rms(plate(places - xyz[:, :2].mean(axis=0)) + xyz[:, 2].mean() - height(places))
    own = rms(surface.elevation(*places.T) - height(places))
    monkeypatch.setattr(fitting_core, "relief_of_core", lambda *_: None)
    one = geofit.fit_horizon(geofit.PointSet(xyz), geofit.FitSettings())
    shared = rms(one.elevation(*places.T) - height(places))
    assert own < 0.8 * exact
    assert own < 0.6 * shared


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_band_of_such_a_core_is_that_of_its_own_field(seed):
    xyz, places = channel(seed)
    surface = geofit.fit_horizon(geofit.PointSet(xyz), geofit.FitSettings())
    found = geofit.examine(surface)
    error = surface.elevation(*places.T) - height(places)
    at = np.column_stack([places, surface.elevation(*places.T)])
    sd = geofit.prediction_sd(surface, found.uncertainty, at)
    assert np.mean(np.abs(error) < 1.645 * sd) > 0.8
    assert rms(sd) < 3 * rms(error)
    assert found.suggestions
    assert all(hole.max_after <= found.uncertainty.max * (1 + 1e-9) for hole in found.suggestions)


def test_one_field_serves_a_core_as_gentle_as_its_surroundings(monkeypatch):
    truth, found = paper_arrangement(0), []
    monkeypatch.setattr(fitting_core, "relief_of_core", lambda *given: found.append(relief_of_core(*given)))
    geofit.fit_horizon(truth.points, geofit.FitSettings(), truth.boundary)
    assert found
    assert found == [None] * len(found)


def test_it_holds_in_the_core_and_ends_with_its_reach():
    knots = bspline.clamped_knots(np.linspace(0.0, 20.0, 11), 3)
    space = TensorSpace(knots, knots, 3)
    rng = np.random.default_rng(1)
    field = relief(space, 1, (2.0, 8.0, 2.0, 10.0), (1.0, 9.0, 1.0, 10.0))
    plane = rng.uniform(0, 10, (2000, 2))
    plane[:50, 1] = 10.0
    heights = rng.normal(size=len(plane))
    found = field.instead(plane, heights)
    within = ((plane >= 2) & (plane <= (8, 10))).all(axis=1)
    # Along v it ends with the core itself above, as at the edge of the study area.
    beyond = (plane <= 1).any(axis=1) | (plane[:, 0] >= 9)
    within |= (plane[:, 0] >= 2) & (plane[:, 0] <= 8) & (plane[:, 1] == 10)
    assert within.any()
    assert beyond.any()
    np.testing.assert_allclose(found[within], space.matrix(plane[within] / 0.5) @ field.coefficients)
    np.testing.assert_array_equal(found[beyond], heights[beyond])
    own = space.matrix(plane / 0.5) @ field.coefficients
    low, high = np.minimum(own, heights), np.maximum(own, heights)
    assert ((found >= low - 1e-12) & (found <= high + 1e-12)).all()


def test_a_surface_that_takes_it_follows_it():
    own_knots = bspline.clamped_knots(np.linspace(0.0, 12.0, 7), 3)
    own = TensorSpace(own_knots, own_knots, 3)
    rng = np.random.default_rng(2)
    field = relief(own, 2, (2.0, 4.0, 2.0, 4.0), (0.0, 6.0, 0.0, 6.0))
    knots = bspline.clamped_knots(np.linspace(-2.0, 8.0, 61), 3)
    space = TensorSpace(knots, knots, 3)
    surface = field.blended(space, np.zeros(space.size))
    plane = rng.uniform(-2, 8, (2000, 2))
    np.testing.assert_allclose(space.matrix(plane) @ surface, field.instead(plane, np.zeros(len(plane))), atol=2e-3)


def waves_seen_in_the_core_alone(seed, length):
    """Return nine sections of 45 points over waves that 20 holes around, some 350 m apart, cannot show; the truth."""
    rng = np.random.default_rng(seed)
    lines = [np.column_stack([np.full(45, x), rng.uniform(900, 1400, 45)]) for x in np.linspace(600, 1100, 9)]
    at = np.concatenate([*lines, rng.uniform((0, 0), (1600, 2200), (20, 2))])

    def height(x, y):
        return 1400 + 0.02 * x + 10 * np.sin(2 * np.pi * (x + 0.4 * y) / length)

    z = height(*at.T) + rng.normal(0, 0.2, len(at))
    return geofit.PointSet(np.column_stack([np.array([500_000.0, 3_100_000.0]) + at, z])), height


@pytest.mark.parametrize("seed", [1, 2, 5])
def test_a_field_that_swings_far_beyond_its_data_gets_shorter_spans(seed):
    # Before it did, the surface left the 26 m of the data by 150 m (seed 5) to 850 m (seed 2).
    points, _ = waves_seen_in_the_core_alone(seed, length=220)
    surface = geofit.fit_horizon(points)
    low, high = points.xyz[:, 2].min(), points.xyz[:, 2].max()
    x, y = np.meshgrid(np.linspace(0, 1600, 60), np.linspace(0, 2200, 60))
    z = surface.elevation(500_000 + x.ravel(), 3_100_000 + y.ravel())
    assert np.nanmax(z) < high + 0.5 * (high - low)
    assert np.nanmin(z) > low - 0.5 * (high - low)
    assert surface.diagnostics["noise"] == pytest.approx(0.2, rel=0.3)


@pytest.mark.parametrize("seed", [1, 5])
def test_a_core_keeps_relief_that_the_field_of_all_points_takes_for_noise(seed):
    points, height = waves_seen_in_the_core_alone(seed, length=160)
    surface = geofit.fit_horizon(points)
    assert surface.diagnostics["noise"] > 5, "that field takes the waves of 10 m for noise"
    x, y = np.meshgrid(np.linspace(620, 1080, 40), np.linspace(950, 1350, 40))
    off = surface.elevation(500_000 + x.ravel(), 3_100_000 + y.ravel()) - height(x.ravel(), y.ravel())
    assert np.sqrt(np.mean(off**2)) < 0.5
    # Nor do the holes around contradict each other: the surface meets them.
    assert surface.accuracy.passed
    assert np.median(np.abs(surface.accuracy.residuals[~surface.core])) < 0.1


@pytest.mark.parametrize("seed", range(4))
def test_steep_relief_around_a_core_does_not_make_its_noise_small(seed):
    rng = np.random.default_rng(seed)
    core, around = rng.uniform((600, 900), (1100, 1400), (400, 2)), rng.uniform((0, 0), (1600, 2200), (60, 2))
    around = around[np.abs(around - (850, 1150)).max(axis=1) > 350][:30]
    waves = 10 * np.sin(2 * np.pi * core @ (1, 0.4) / 220)
    z = 1400 + np.append(waves + rng.normal(0, 1.0, 400), rng.normal(0, 200.0, len(around)))
    surface = geofit.fit_horizon(geofit.PointSet(np.column_stack([np.concatenate([core, around]), z])))
    # A surface through these points would be off by 1 m between them, not by 0.6 m.
    assert surface.partition.lost
    assert "agree only to about 1" in str(surface.partition.reason)
    assert re.search(r"varies by about [67]\.?\d* m", str(surface.partition.reason)), (
        "the relief of the core, not of all"
    )

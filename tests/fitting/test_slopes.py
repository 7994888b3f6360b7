"""Measured dips as data of the fit: known truths, other generators, and what must not change."""

from dataclasses import replace

import numpy as np
import pytest

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.site import Orientations
from geofit.fitting.posterior import posterior
from geofit.geometry.attitudes import plane_normals
from geofit.site.dips import check_dips

ORIGIN = np.array([500_000.0, 3_000_000.0, 0.0])
AREA = np.array([[0, 0], [1000, 0], [1000, 1000], [0, 1000.0]])


def dips(plan, gradient, name="h", height=0.0):
    """Return measurements at (k, 2) places, of planes with (k, 2) gradients."""
    steep = np.hypot(*gradient.T)
    azimuth = np.degrees(np.arctan2(-gradient[:, 0], -gradient[:, 1])) % 360
    xyz = np.column_stack([plan, np.broadcast_to(height, len(plan))]) + ORIGIN
    count = len(plan)
    return Orientations(
        xyz, azimuth, np.degrees(np.arctan(steep)), np.array([name] * count), np.array(["f"] * count), np.arange(count)
    )


def waves(rng, lengths):
    """Return heights and gradients of a sum of random waves about a tilted plane."""
    k, phase = rng.normal(size=(200, 2)) / lengths, rng.uniform(0, 2 * np.pi, 200)
    size, tilt = rng.uniform(40, 100) / 10, rng.uniform(-0.3, 0.3, 2)
    return (
        lambda p: size * np.cos(p @ k.T + phase).sum(axis=1) + p @ tilt,
        lambda p: -size * np.sin(p @ k.T + phase) @ k + tilt,
    )


def domes(rng, lengths):
    """Return the same of domes and basins about a level plane."""
    centre, size = rng.uniform(0, 1000, (6, 2)), rng.uniform(-80, 80, 6)

    def each(p):
        off = (p[:, None] - centre) / lengths
        return size * np.exp(-(off**2).sum(axis=2) / 2), off / lengths

    return lambda p: each(p)[0].sum(axis=1), lambda p: -(each(p)[0][:, :, None] * each(p)[1]).sum(axis=1)


def ratios(generator, seed, accuracies):
    """Return the errors away from the data with dips of each accuracy in degrees, as shares of that without."""
    rng = np.random.default_rng(seed)
    height, gradient = generator(rng, rng.uniform(180, 400))
    p, q, t = (rng.uniform(0, 1000, (n, 2)) for n in (24, 15, 1500))
    exact, noise = dips(q, gradient(q), height=height(q)), rng.normal(size=(15, 3))
    points = PointSet(np.column_stack([p, height(p) + rng.normal(0, 0.1, 24)]) + ORIGIN)

    def error(use, accuracy):
        turned = plane_normals(exact.azimuth, exact.dip) + np.radians(accuracy) * noise
        measured = dips(q, -turned[:, :2] / turned[:, 2:], height=height(q))
        settings = FitSettings(dips=use, dip_accuracy=accuracy)
        surface = fit_horizon(points, settings, AREA + ORIGIN[:2], name="h", orientations=measured)
        return float(np.sqrt(np.nanmean((surface.elevation(*(t + ORIGIN[:2]).T) - height(t)) ** 2)))

    # Dips that are only checked change no surface: one fit without them is enough.
    without = error("check", 1.0)
    return [error("fit", accuracy) / without for accuracy in accuracies]


@pytest.mark.parametrize("generator", [waves, domes])
def test_dips_lower_the_error_away_from_the_data(generator):
    exact, rough = np.transpose([ratios(generator, seed, (1.0, 4.0)) for seed in range(12)])
    assert np.median(exact) < 0.8
    assert np.median(rough) < 0.95
    assert np.median(exact) < np.median(rough)


@pytest.fixture(scope="module")
def waved():
    rng = np.random.default_rng(4)
    plan = rng.uniform(0, 1000, (20, 2))
    return PointSet(np.column_stack([plan, waves(rng, 250.0)[0](plan)]) + ORIGIN)


def fitted(points, measured, **changes):
    settings = FitSettings(**{"dips": "fit", "core": "none", **changes})
    return fit_horizon(points, settings, AREA + ORIGIN[:2], name="h", orientations=measured)


def test_a_line_of_holes_takes_its_slope_across_from_dips():
    along = np.linspace(50, 950, 12)
    plan = np.column_stack([along, np.full(12, 500.0)])
    points = PointSet(np.column_stack([plan, 100 + 0.1 * along]) + ORIGIN)
    measured = dips(np.array([[200, 150], [800, 900.0]]), np.array([[0.1, 0.4], [0.1, 0.4]]))
    surface = fitted(points, measured, dip_accuracy=0.5)
    corners = np.array([[100, 100], [900, 900], [100, 900.0]])
    truth = 100 + 0.1 * corners[:, 0] + 0.4 * (corners[:, 1] - 500)
    assert np.abs(surface.elevation(*(corners + ORIGIN[:2]).T) - truth).max() < 1.0


def test_the_stated_accuracy_decides_how_far_a_dip_turns_the_surface(waved):
    measured = dips(np.array([[430, 610.0]]), np.array([[0.2, 0.1]]), height=100.0)
    angles = [check_dips(fitted(waved, measured, dip_accuracy=a), measured)[0][0].angle for a in (0.05, 1.0, 5.0, 40.0)]
    assert angles == sorted(angles)
    assert angles[0] < 0.5 * angles[-1]
    without = check_dips(fitted(waved, measured, dips="check"), measured)[0][0].angle
    assert angles[-1] <= without + 1e-9


def test_dips_leave_less_doubt_around_them(waved):
    measured = dips(np.array([[500, 500.0]]), np.zeros((1, 2)), height=100.0)
    surface = fitted(waved, measured, dip_accuracy=0.5)
    given = posterior(surface.model)
    blind = posterior(replace(surface.model, problem=replace(surface.model.problem, slopes=None)))
    unit = surface.model.net.unit
    place = surface.model.problem.parametrization.frame.to_local(measured.xyz)[:, :2] / unit
    around = place + np.array([[0.5, 0], [-0.5, 0], [0, 0.5], [0, -0.5]])
    assert (given.variance(around) < 0.95 * blind.variance(around)).all()


def test_what_is_not_asked_for_or_not_of_the_horizon_changes_nothing(waved):
    measured = dips(np.array([[430, 610.0]]), np.array([[0.2, 0.1]]))
    plain = fitted(waved, None)
    for surface in (
        fitted(waved, measured, dips="check"),
        fitted(waved, replace(measured, horizon=np.array(["other"]))),
    ):
        assert all(np.array_equal(a.control, b.control) for a, b in zip(plain.patches, surface.patches, strict=True))
        assert not {"fitting.dips-fitted", "fitting.dips-not-fitted"} & {note.code for note in surface.accuracy.notes}


def test_dips_that_cannot_be_fitted_are_counted(waved):
    plan = np.array([[500, 500], [5000, 500], [500, 400.0]])
    measured = dips(plan, np.array([[0.1, 0.0], [0.1, 0.0], [0.0, 20.0]]))
    notes = {note.code: note for note in fitted(waved, measured).accuracy.notes}
    assert notes["fitting.dips-fitted"].params["count"] == 1
    assert notes["fitting.dips-not-fitted"].params["count"] == 2


def test_a_surface_through_sections_says_that_its_dips_are_only_checked():
    y = np.linspace(0, 300, 30)
    rows = [np.column_stack([np.full(30, x), y, 50 + 20 * np.sin(y / 60)]) for x in (0.0, 100.0, 200.0)]
    points = PointSet(np.concatenate(rows) + ORIGIN, section=np.repeat(["A", "B", "C"], 30))
    measured = dips(np.array([[100, 100.0]]), np.array([[0.0, 0.2]]))
    settings = FitSettings(dips="fit", frame="sections")
    surface = fit_horizon(points, settings, name="h", orientations=measured)
    assert "fitting.dips-not-fitted-parametric" in {note.code for note in surface.accuracy.notes}

"""Bands of folded surfaces: three coordinates of one covariance, held to sections that were left out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from refusals import refused, with_code
from truth import folded

from geofit import PointSet, examine, fit_horizon
from geofit.data.errors import FitError
from geofit.fitting.calibration import BAND
from geofit.fitting.posterior import posterior
from geofit.prediction.bands import band, band_directions, grid_over, prediction_sd


def fold_of(seed):
    """Return the points of an overturned fold on unequal sections, places all over it, and the sections' y."""
    rng = np.random.default_rng(seed)
    amplitude, length, height = rng.uniform(60, 160), rng.uniform(150, 300), rng.uniform(150, 300)
    waves, phases, rise = rng.uniform(270, 700, 3), rng.uniform(0, 2 * np.pi, 3), rng.uniform(0, 15)
    plunge, tilt = rng.normal(0, 0.1), rng.normal(0, 0.15)

    def at(t, y):
        wide, late, up = np.sin(2 * np.pi * y / waves[:, None] + phases[:, None])
        x = length * t + amplitude * (1 + 0.15 * wide) * np.sin(2 * np.pi * t + 0.2 * late) + tilt * y
        return np.column_stack([x, y, height * t + rise * up + plunge * y])

    count, n = int(rng.integers(6, 9)), int(rng.integers(28, 40))
    ys = np.concatenate([[0], np.cumsum(rng.uniform(0.6, 1.4, count - 1) * rng.choice([40, 60, 90]))])
    noise = rng.choice([0.0, 0.05, 0.3])
    lines = []
    for y in ys:
        line = at(np.sort(np.concatenate([[0, 1], rng.uniform(0, 1, n - 2)])), np.full(n, y))
        lines.append(line + noise * rng.normal(size=line.shape) * (1, 0, 1))
    origin = np.array([500_000.0, 3_100_000.0, 500.0])
    t, y = (axis.ravel() for axis in np.meshgrid(np.linspace(0.02, 0.98, 80), np.linspace(ys[0], ys[-1], 90)))
    names = np.repeat([f"S{k}" for k in range(count)], n)
    return PointSet(np.concatenate(lines) + origin, section=names, kind="section"), at(t, y) + origin


@cache
def examined(seed):
    points, places = fold_of(seed)
    surface = fit_horizon(points, name="fold")
    assert surface.frame == "sections"
    return surface, examine(surface), places


def inner(surface, places):
    """Tell which places have their foot within the surface, not on its rim."""
    foot, (u0, u1, v0, v1) = surface.project(places), surface.model.problem.parametrization.area
    return (foot.u > u0) & (foot.u < u1) & (foot.v > v0) & (foot.v < v1)


@pytest.mark.parametrize(("seed", "least"), [(100, 0.88), (113, 0.83), (114, 0.88)])
def test_the_band_of_a_fold_holds_its_truth(seed, least):
    surface, found, places = examined(seed)
    places = places[inner(surface, places)]
    inside = np.abs(surface.distance(places)) <= BAND * prediction_sd(surface, found.uncertainty, places)
    # Never narrower than the posterior: folds that run on evenly lie well within.
    assert inside.mean() >= least
    (sections,) = found.left_out
    known = np.isfinite(sections.error)
    assert sections.inside >= 0.9
    assert sections.inside == np.mean(np.abs(sections.error[known]) <= BAND * sections.sd[known])
    # No surface reaches the outermost sections without their points.
    ends = {surface.points.section[0], surface.points.section[-1]}
    assert set(surface.points.section[~known]) == ends


def test_a_coordinate_of_a_fold_varies_as_a_height_of_the_same_covariance_does():
    surface, _, _ = examined(100)
    model = surface.model
    whole = posterior(model)
    flat = replace(
        model,
        problem=replace(
            model.problem,
            parametrization=replace(model.problem.parametrization, values=model.problem.parametrization.values[:, 2]),
        ),
    )
    field = replace(model.net.field, hold=0.0)
    height = posterior(flat.with_net(replace(model.net, field=field)))
    plane = grid_over(surface).plane[::7]
    assert whole.height(plane).shape == (len(plane), 3)
    assert np.allclose(whole.height(plane)[:, 2], height.height(plane), rtol=0, atol=1e-6)
    assert np.allclose(whole.variance(plane), height.variance(plane), rtol=1e-9, atol=0)


def test_the_upper_bound_lies_above_and_the_lower_one_below():
    surface, found, _ = examined(113)
    places = grid_over(surface).places(surface.model)
    places = places[inner(surface, places)]
    width = BAND * prediction_sd(surface, found.uncertainty, places, "contact")
    bounds = band(surface, found)
    for bound, side in zip(bounds, (-1, 1), strict=True):
        off = side * bound.distance(places)
        # In a hinge that is tighter than the band the bound crosses itself.
        assert (off > 0).mean() > 0.99
        assert np.median(off / width) == pytest.approx(1, abs=0.05)
    # The same step along the vectors that the band is measured along.
    step = places + width[:, None] * band_directions(surface, places)
    assert np.median(surface.distance(step) / width) == pytest.approx(1, abs=0.02)


def test_the_next_holes_of_a_fold_lie_on_it_where_it_is_least_known():
    surface, found, _ = examined(114)
    assert len(found.suggestions) == 10
    holes = np.array([(one.x, one.y, one.z) for one in found.suggestions])
    assert np.abs(surface.distance(holes)).max() < 1e-6
    assert prediction_sd(surface, found.uncertainty, holes) == pytest.approx(
        [one.sd for one in found.suggestions], rel=1e-6
    )
    assert (np.diff([found.uncertainty.mean, *(one.mean_after for one in found.suggestions)]) < 0).all()


def test_a_fold_of_two_sections_has_the_standard_deviation_that_the_fit_expects():
    surface = fit_horizon(folded(2, 20))
    found = examine(surface)
    assert found.left_out == ()
    assert with_code(found.notes, "prediction.fold-not-calibrated")
    assert found.uncertainty.factor == 1.0
    assert 0 < found.uncertainty.mean < found.uncertainty.max


def test_a_fold_has_no_standard_deviation_at_a_place_of_the_map():
    surface, found, places = examined(100)
    with refused(FitError, "prediction.plane-needs-elevations"):
        prediction_sd(surface, found.uncertainty, places[:3, :2])

"""Noise of sources that state none: found by the likelihood, against the points nearer to the rock."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from truth import EASTING, NORTHING, hills, paper_arrangement, rms

from geofit import FitSettings, PointSet, fit_horizon

SOME = FitSettings(core="none")


def two_sources(seed, coarse, kinds=("borehole", "geophysics"), counts=(150, 300)):
    """Return places and heights of points known to 0.05 m and of others known to ``coarse``, and their kinds."""
    rng, height = np.random.default_rng(seed), hills(seed)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + 2000, NORTHING + 2000), (sum(counts), 2))
    sd = np.repeat([0.05, coarse], counts)
    xyz = np.column_stack([xy, height(*xy.T) + rng.normal(size=len(xy)) * sd])
    return xyz, np.repeat(kinds, counts), sd, height


def error(surface, height):
    inner = np.random.default_rng(1).uniform(
        (EASTING + 50, NORTHING + 50), (EASTING + 1950, NORTHING + 1950), (3000, 2)
    )
    return rms(surface.elevation(*inner.T) - height(*inner.T))


@pytest.mark.parametrize(
    ("seed", "coarse", "share"), [(1, 4.0, 0.8), (2, 4.0, 0.8), (3, 1.0, 0.85), (4, 1.0, 0.96), (8, 1.0, 0.8)]
)
def test_noise_of_picks_is_found_and_as_good_as_told(seed, coarse, share):
    xyz, kind, sd, height = two_sources(seed, coarse)
    found = fit_horizon(PointSet(xyz, kind=kind), SOME)
    told = fit_horizon(PointSet(xyz, kind=kind, accuracy=sd), SOME)
    alike = fit_horizon(PointSet(xyz), SOME)
    assert found.diagnostics["sources"] == {"geophysics": pytest.approx(coarse, rel=0.15)}
    assert error(found, height) < min(share * error(alike, height), 1.05 * error(told, height))
    off = np.abs(found.distance(xyz))
    assert off[kind == "borehole"].max() <= 0.1
    note = with_code(found.accuracy.notes, "fitting.source-scatters")
    assert note.params["kind"] == "geophysics"
    (check,) = (one for one in found.accuracy.checks if one.name == "interior tolerance")
    assert check.passed
    assert check.text.code == "checks.beyond-tolerance-as-stated"


@pytest.mark.parametrize("seed", range(4))
def test_sources_of_one_noise_are_not_told_apart(seed):
    for noise in (0.05, 1.0):
        xyz, kind, _, _ = two_sources(10 + seed, 0.05)
        xyz[:, 2] += np.random.default_rng(seed).normal(size=len(xyz)) * noise
        assert fit_horizon(PointSet(xyz, kind=kind), SOME).diagnostics["sources"] == {}


def test_relief_that_a_sketch_cuts_in_a_dense_core_is_no_noise_of_its_sections():
    # On the sketch alone its sections would scatter by 0.14 m.
    truth = paper_arrangement(21)
    assert {"borehole", "section"} == set(truth.points.kind)
    assert fit_horizon(truth.points, boundary=truth.boundary).diagnostics["sources"] == {}


def test_boreholes_are_never_taken_for_less_accurate_than_picks():
    xyz, kind, _, _ = two_sources(5, 4.0, kinds=("geophysics", "borehole"))
    surface = fit_horizon(PointSet(xyz, kind=kind), SOME)
    assert surface.diagnostics["sources"] == {}


def test_a_stated_accuracy_goes_before_what_is_found():
    xyz, kind, sd, _ = two_sources(6, 4.0)
    stated = fit_horizon(PointSet(xyz, kind=kind, accuracy=sd), SOME)
    assert stated.diagnostics["sources"] == {}
    # Boreholes that state theirs are what picks that do not are judged by.
    some = np.where(kind == "borehole", 0.05, np.nan)
    assert fit_horizon(PointSet(xyz, kind=kind, accuracy=some), SOME).diagnostics["sources"] == {
        "geophysics": pytest.approx(4.0, rel=0.15)
    }


@pytest.mark.parametrize("seed", [20, 21, 24])
def test_each_of_three_sources_has_its_own(seed):
    rng, height = np.random.default_rng(seed), hills(seed)
    counts = (150, 200, 300)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + 2000, NORTHING + 2000), (sum(counts), 2))
    xyz = np.column_stack([xy, height(*xy.T) + rng.normal(size=len(xy)) * np.repeat([0.05, 1.0, 5.0], counts)])
    surface = fit_horizon(PointSet(xyz, kind=np.repeat(["borehole", "section", "geophysics"], counts)), SOME)
    assert surface.diagnostics["sources"] == {
        "section": pytest.approx(1.0, rel=0.25),
        "geophysics": pytest.approx(5.0, rel=0.15),
    }


def test_strict_meets_every_point_all_the_same():
    xyz, kind, _, _ = two_sources(9, 4.0, counts=(60, 120))
    surface = fit_horizon(PointSet(xyz, kind=kind), FitSettings(core="none", strict=True))
    assert np.abs(surface.distance(xyz)).max() <= 0.1

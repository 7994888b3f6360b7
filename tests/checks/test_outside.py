"""Points that a surface does not reach count in sigma, are counted and named, and sigma without them is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import with_code
from surfaces import ORIGIN, height_field, horizon

from geofit.checks.check import check
from geofit.checks.outside import outside
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.judge import judge
from geofit.fitting.pipeline import fit_horizon
from geofit.io.export.write import write_surface
from geofit.io.surface_files import read_surfaces

#: A study area of 1,000 x 700 m without its north-eastern corner.
NOTCHED = np.array([(0, 0), (1000, 0), (1000, 350), (500, 350), (500, 700), (0, 700)], float)


def flat_with(inside, out, **settings):
    """A level surface that ends at the notched area, with points so far above it within the area and in the notch."""
    places = [(100.0 + 10 * k, 200.0, z) for k, z in enumerate(inside)]
    places += [(700.0 + 10 * k, 500.0, z) for k, z in enumerate(out)]
    flat = height_field(8, 8, size=(1000.0, 700.0), z=lambda x, y: 0 * x)
    surface = horizon([flat], np.array(places) + ORIGIN, outline=NOTCHED)
    return surface.with_(settings=FitSettings(**settings))


def beyond(accuracy):
    return next((one for one in accuracy.checks if one.name == "beyond the surface"), None)


def test_points_in_a_notch_are_counted_and_sigma_without_them_is_stated():
    found = check(flat_with([0.3, -0.4, 0.0], [0.1, 0.1]))
    assert found.sigma == pytest.approx(np.sqrt((0.09 + 0.16 + 0.02) / 4), abs=1e-9)
    assert (beyond(found).value, beyond(found).passed) == (2.0, None)
    assert beyond(found).text.params["others"] == 3
    assert beyond(found).text.params["within"] == pytest.approx(np.sqrt(0.25 / 2), abs=1e-9)


def test_a_surface_that_reaches_all_points_has_no_such_check():
    assert beyond(check(flat_with([0.3, -0.4, 0.0], []))) is None


def test_points_outside_bring_no_sigma_below_epsilon_unnoticed():
    surface = flat_with([0.9, -0.9], [0.0] * 20)
    found = check(surface)
    assert found.passed
    assert beyond(found).passed is False
    judged = surface.with_(accuracy=found).judged_by(5.0).accuracy
    assert beyond(judged).passed is None
    assert beyond(surface.with_(accuracy=judged).judged_by(0.5).accuracy).passed is False


def test_all_points_outside_leave_nothing_to_compare():
    found = beyond(check(flat_with([], [0.1, 0.2])))
    assert (found.value, found.passed) == (2.0, None)
    assert "within" not in found.text.params


def test_a_place_on_the_rim_is_within():
    ring = NOTCHED + ORIGIN[:2]
    rim = (ring + np.roll(ring, -1, axis=0)) / 2
    assert not outside(ring, rim).any()
    assert not outside(ring, ring).any()
    assert outside(ring, ring[3:4] + 0.01).all()


@pytest.fixture(scope="module")
def fitted():
    rng = np.random.default_rng(3)
    x, y = rng.uniform(0, [[1000], [700]], (2, 120))
    z = 10 * np.sin(x / 200) + 8 * np.cos(y / 150) + rng.normal(0, 0.01, 120)
    points = PointSet(np.column_stack([x, y, z]) + ORIGIN, file="p.csv", row=np.arange(120))
    return fit_horizon(points, None, NOTCHED + ORIGIN[:2])


def test_a_fit_names_the_number_of_points_in_a_notch(fitted):
    count = int(outside(NOTCHED + ORIGIN[:2], fitted.points.xyz).sum())
    assert 20 < count < 40
    note = with_code(fitted.accuracy.notes, "fitting.points-beyond-study-area")
    assert (note.severity, note.params["count"], note.params["total"]) == ("warning", count, 120)
    assert beyond(fitted.accuracy).value == count


def test_a_judged_surface_counts_them_as_the_fit_does(fitted):
    judged = judge(replace(fitted.surface), fitted.points).accuracy
    assert judged.sigma == pytest.approx(fitted.accuracy.sigma, rel=1e-9)
    ours, theirs = beyond(judged).text.params, beyond(fitted.accuracy).text.params
    assert (ours["others"], ours["within"]) == (theirs["others"], pytest.approx(theirs["within"], rel=1e-9))
    assert sum("p.csv" in str(note) for note in judged.notes) == 20


@pytest.mark.parametrize(("form", "within"), [("brep", 1e-6), ("iges", 1e-5)])
def test_sigma_of_the_points_within_is_that_of_the_files(fitted, form, within, tmp_path):
    (file,) = write_surface({"T1": fitted}, tmp_path / f"a.{form}", format=form)
    (surface,) = read_surfaces(file).values()
    ours = beyond(judge(surface, fitted.points).accuracy)
    theirs = beyond(fitted.accuracy)
    assert ours.value == theirs.value
    assert ours.text.params["within"] == pytest.approx(theirs.text.params["within"], abs=within)

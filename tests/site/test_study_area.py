"""A fold or a surface over its best plane does not end at the study area: a warning states how much lies outside."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from truth import EASTING, NORTHING, folded

from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.data.verdict import verdict_of
from geofit.fitting.pipeline import fit_horizon
from geofit.site.fit_site import fit_site

CODE = "fitting.study-area-not-applied"


def steep(n=150):
    """An upright fault along the easting, wavy across it."""
    rng = np.random.default_rng(2)
    along, z = rng.uniform(0, [[400], [200]], (2, n))
    return PointSet(np.column_stack([along, 0.2 * z + 5 * np.sin(along / 60), z]) + np.array((EASTING, NORTHING, 500)))


def rectangle(points, share):
    """A study area that contains all points, or those of a share of their northing (folds) or easting."""
    low, high = points.xyz[:, :2].min(axis=0) - 20, points.xyz[:, :2].max(axis=0) + 20
    along = int(np.argmax(high - low))
    high[along] = low[along] + 20 + share * (high - low - 40)[along] + 20 * (share == 1)
    return np.array([low, [high[0], low[1]], high, [low[0], high[1]]])


@pytest.mark.parametrize(("points", "frame"), [(folded(), "sections"), (steep(), "best-plane")])
def test_what_the_area_does_not_end_is_a_warning(points, frame):
    site = Site("S", {"F": points}, boundary=rectangle(points, 0.5))
    surface = fit_site(site).surfaces["F"]
    assert surface.frame == frame
    (check,) = [one for one in surface.accuracy.checks if one.name == "area"]
    assert check.passed is False
    assert check.value == pytest.approx(50, abs=3)
    assert check.text.code == "site.study-area-not-applied"
    assert surface.accuracy.passed
    assert verdict_of(surface.accuracy).word == "WARNING"
    note = with_code(surface.accuracy.notes, CODE)
    assert note.severity == "warning"
    outside = points.xyz[:, :2] > site.boundary.max(axis=0)
    assert note.params["count"] == outside.any(axis=1).sum() > 0


@pytest.mark.parametrize(("points", "frame"), [(folded(), "sections"), (steep(), "best-plane")])
def test_a_surface_within_the_area_passes(points, frame):
    surface = fit_site(Site("S", {"F": points}, boundary=rectangle(points, 1.0))).surfaces["F"]
    assert surface.frame == frame
    (check,) = [one for one in surface.accuracy.checks if one.name == "area"]
    assert check.passed
    assert with_code(surface.accuracy.notes, CODE).severity == "info"


def test_no_area_no_word():
    assert CODE not in {note.code for note in fit_horizon(folded()).accuracy.notes}


def test_a_fault_that_reaches_beyond_the_area_is_stated_and_no_failure():
    points = steep()
    site = Site(
        "S", {"F": points, "T": PointSet(np.empty((0, 3)))}, boundary=rectangle(points, 0.5), faults={"F": ("T",)}
    )
    accuracy = fit_site(site, ["F"]).surfaces["F"].accuracy
    (check,) = [one for one in accuracy.checks if one.name == "area"]
    assert check.passed is None
    assert check.value == pytest.approx(50, abs=3)

"""Systematic offsets between kinds of points."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from truth import EASTING, NORTHING, hills

from geofit import PointSet, fit_horizon
from geofit.data.verdict import verdict_of
from geofit.prediction.examine import examine

HOLES, PICKS = 40, 200


def examined(offset, kind="geophysics", wrong=0.0, row=7):
    """A horizon seen by 40 boreholes (0.05 m) and by 200 picks (1.5 m) that lie ``offset`` above it, one ``wrong``."""
    rng, height = np.random.default_rng(2), hills(1)
    plan = rng.uniform(0, 2000, (HOLES + PICKS, 2)) + np.array((EASTING, NORTHING))
    z = height(*plan.T) + rng.normal(0, 1, len(plan)) * np.repeat([0.05, 1.5], [HOLES, PICKS])
    z[HOLES:] += offset
    z[row] += wrong
    kinds = ["borehole"] * HOLES + [kind] * PICKS
    surface = fit_horizon(PointSet(np.column_stack([plan, z]), kind=kinds))
    return surface, examine(surface)


@pytest.mark.parametrize("offset", [6.0, -2.5])
def test_picks_that_lie_off_as_a_whole_are_named(offset):
    surface, found = examined(offset)
    (one,) = found.offsets
    assert (one.kind, one.reference, one.count) == ("geophysics", "borehole", PICKS)
    assert one.offset == pytest.approx(offset, abs=3 * one.sd)
    assert one.sd < 1.0
    assert one.vertical
    assert one.text.code == ("data.source-above" if offset > 0 else "data.source-below")
    assert with_code(found.notes, "prediction.source-off").severity == "warning"
    verdict = verdict_of(surface.accuracy, found)
    assert verdict.away.level in ("warning", "fail")
    assert verdict.away.text.params["offset"] == one.text


def test_picks_that_only_scatter_more_are_not():
    _, found = examined(0.0)
    assert found.offsets == ()


def test_the_offset_of_a_steep_surface_is_across_it():
    rng = np.random.default_rng(2)
    plane = rng.uniform(0, 400, (HOLES + PICKS, 2))
    across = 5 * np.sin(plane[:, 0] / 60) * np.cos(plane[:, 1] / 70) + rng.normal(0, 0.3, HOLES + PICKS)
    across[HOLES:] += 6.0
    dip = np.radians(75)
    up, aside = np.array([0.0, np.cos(dip), np.sin(dip)]), np.array([0.0, -np.sin(dip), np.cos(dip)])
    xyz = np.outer(plane[:, 0], [1.0, 0.0, 0.0]) + np.outer(plane[:, 1], up) + np.outer(across, aside)
    surface = fit_horizon(PointSet(xyz, kind=["borehole"] * HOLES + ["geophysics"] * PICKS))
    assert surface.frame == "best-plane"
    (one,) = examine(surface).offsets
    assert not one.vertical
    assert one.text.code == "data.source-aside"
    assert abs(one.offset) == pytest.approx(6.0, abs=3 * one.sd)


def test_points_of_one_kind_have_nothing_to_be_compared_with():
    _, found = examined(6.0, kind="borehole")
    assert found.offsets == ()


@pytest.mark.parametrize(("wrong", "kind"), [(-60.0, "borehole"), (60.0, "borehole"), (-60.0, "adit")])
@pytest.mark.parametrize("name", ["T3-T2", "T2-T1"])
def test_one_wrong_collar_does_not_make_the_sections_look_offset(sample_site, name, wrong, kind):
    """Nor does the only point of a kind, which is compared with no other."""
    points = sample_site.horizons[name]
    (row,) = np.flatnonzero(points.hole == "ZK502")
    xyz = points.xyz.copy()
    xyz[row, 2] += wrong
    kinds = points.kind.astype(object)
    kinds[kinds == "adit"] = "borehole"
    kinds[row] = kind
    found = examine(fit_horizon(points.with_(xyz=xyz, kind=kinds.astype(str)), boundary=sample_site.boundary))
    assert [one.index for one in found.outliers] == [row]
    assert found.offsets == ()


@pytest.mark.parametrize("row", [7, HOLES + 7])
def test_one_wrong_elevation_does_not_make_a_kind_look_offset(row):
    _, found = examined(0.0, wrong=200.0, row=row)
    assert row in [one.index for one in found.outliers]
    assert found.offsets == ()


def test_an_offset_is_found_beside_a_wrong_elevation():
    _, found = examined(6.0, wrong=-60.0)
    (one,) = found.offsets
    assert one.offset == pytest.approx(6.0, abs=3 * one.sd)


def test_a_kind_whose_points_all_count_as_outliers_is_offset():
    rng, height = np.random.default_rng(4), hills(1)
    plan = rng.uniform(0, 2000, (210, 2)) + np.array((EASTING, NORTHING))
    z = height(*plan.T) + rng.normal(0, 0.1, len(plan))
    z[:10] += 25.0
    found = examine(fit_horizon(PointSet(np.column_stack([plan, z]), kind=["geophysics"] * 10 + ["borehole"] * 200)))
    assert len(found.outliers) > 1
    (one,) = found.offsets
    assert one.offset == pytest.approx(25.0, abs=4 * one.sd)

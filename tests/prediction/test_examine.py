"""Examinations of the smallest and of degenerate horizons end in figures and notes."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code

from geofit import PointSet, fit_horizon
from geofit.data.verdict import verdict_of
from geofit.prediction.examine import examine

TRIANGLE = np.array([[0, 0, 10], [100, 0, 12], [50, 80, 11.0]])
SQUARE = np.array([[0, 0, 1], [100, 0, 2], [0, 100, 3], [100, 100, 1.0]])
TWO_PLACES = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0.0]])
VERTICAL = np.column_stack([np.full(6, 500000.0), np.full(6, 3100000.0), np.arange(901.0, 907.0)])


@pytest.mark.parametrize("xyz", [TRIANGLE, SQUARE, TWO_PLACES, VERTICAL, VERTICAL[:3]])
def test_no_unforeseen_error(xyz):
    found = examine(fit_horizon(PointSet(xyz)))
    assert not [note for note in found.notes if "unforeseen" in str(note)]
    assert found.left_out


def test_three_points_show_no_error_between_them():
    """The plane through them meets them whatever they are: a band as narrow as rounding would hold nothing."""
    surface = fit_horizon(PointSet(TRIANGLE, hole=["A", "B", "C"]))
    found = examine(surface)
    assert found.uncertainty is None
    assert with_code(found.notes, "prediction.no-error-known").severity == "warning"
    verdict = verdict_of(surface.accuracy, found)
    assert (verdict.data.level, verdict.away.level, verdict.word) == ("pass", "warning", "WARNING")
    assert verdict.away.text.code == "data.verdict-cannot-examine"


def test_one_vertical_hole_has_no_area_and_says_so():
    found = examine(fit_horizon(PointSet(VERTICAL)))
    assert found.uncertainty is None
    assert found.suggestions == ()
    assert "prediction.points-without-area" in {note.code for note in found.notes}


def test_holes_of_a_small_set_are_left_out_by_true_refits():
    rng = np.random.default_rng(8)
    plan = rng.uniform(0, 900, (20, 2))
    z = 30 * np.sin(plan[:, 0] / 150) * np.cos(plan[:, 1] / 200) + rng.normal(0, 2, 20)
    boundary = np.array([[0, 0], [900, 0], [900, 900], [0, 900.0]])
    points = PointSet(np.column_stack([plan, z]), hole=[f"B{k}" for k in range(20)])
    holes = next(one for one in examine(fit_horizon(points, None, boundary)).left_out if one.scheme == "hole")
    for k in (0, 7, 13):
        rest = fit_horizon(points[np.arange(20) != k], None, boundary)
        assert holes.error[k] == pytest.approx(z[k] - float(rest.elevation(*plan[k])), abs=1e-6)

"""Points along one line: the surface aside from them is a guess, and the verdict says so."""

from __future__ import annotations

import numpy as np
import pytest

from geofit import PointSet, fit_horizon
from geofit.data.verdict import verdict_of


def strip(width: float, *, turn: float = 0.0, dip: float = 0.0) -> PointSet:
    """Return points 300 m along a line that runs towards an azimuth and dips, metres."""
    rng = np.random.default_rng(2)
    t, off = np.linspace(0, 300, 60), rng.uniform(-width / 2, width / 2, 60)
    x, y = np.cos(turn) * t - np.sin(turn) * off, np.sin(turn) * t + np.cos(turn) * off
    return PointSet(np.column_stack([5e5 + x, 3e6 + y, 10 * np.sin(t / 60) + np.tan(dip) * t]))


def named(surface):
    return {check.name: check for check in surface.accuracy.checks}


@pytest.mark.parametrize("width", [0.0, 1.0, 4.0])
@pytest.mark.parametrize(("turn", "dip"), [(0.0, 0.0), (0.7, 0.0), (2.0, 0.5)])
def test_a_surface_along_one_line_of_points_does_not_pass(width, turn, dip):
    surface = fit_horizon(strip(width, turn=turn, dip=dip))
    found = named(surface)["strip"]
    assert found.passed is False
    assert found.value == pytest.approx(width, abs=0.15 * width + 1e-6)
    # Where it runs away aside from them, too, it fails.
    assert verdict_of(surface.accuracy).level in ("warning", "fail")


def test_holes_along_one_vertical_are_told():
    z = np.linspace(0, 50, 20)
    surface = fit_horizon(PointSet(np.column_stack([np.full(20, 5e5), np.full(20, 3e6), z])))
    assert named(surface)["strip"].passed is False


@pytest.mark.parametrize("width", [20.0, 60.0, 300.0])
def test_a_strip_that_is_as_wide_as_its_surface_is_none(width):
    assert "strip" not in named(fit_horizon(strip(width)))


def test_a_study_area_along_the_line_is_none():
    points = strip(4.0)
    west, south = points.xyz[:, :2].min(axis=0)
    east, north = points.xyz[:, :2].max(axis=0)
    boundary = [(west, south), (east, south), (east, north), (west, north)]
    assert "strip" not in named(fit_horizon(points, boundary=boundary))

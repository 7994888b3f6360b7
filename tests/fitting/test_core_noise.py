"""What counts as noise in a core: what its nearest points do not share."""

from __future__ import annotations

import numpy as np
import pytest

import geofit
from geofit.fitting import core as fitting_core

ORIGIN = np.array([500_000.0, 3_100_000.0])


def section_points(seed, relief, noise):
    """Return nine sections of 24 points over peaks 18 m wide, too narrow for the spacing, and 60 holes around."""
    rng = np.random.default_rng(seed)
    lines = [np.column_stack([np.full(24, x), rng.uniform(700, 1300, 24)]) for x in np.linspace(700, 1300, 9)]
    at = np.concatenate([*lines, rng.uniform(0, 2000, (60, 2))])
    peaks, height = rng.uniform(500, 1500, (250, 2)), relief * rng.normal(size=250)
    z = 1400 + 0.02 * at[:, 0] + 5 * np.sin(at[:, 1] / 400) + rng.normal(0, noise, len(at))
    z += (height * np.exp(-((at[:, None] - peaks) ** 2).sum(axis=2) / 18**2)).sum(axis=1)
    return np.column_stack([ORIGIN + at, z])


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_relief_narrower_than_the_spacing_is_met(seed, monkeypatch):
    points = geofit.PointSet(section_points(seed, relief=1.5, noise=0.01))
    surface = geofit.fit_horizon(points)
    assert surface.core.sum() > 200
    assert np.abs(surface.distance(points.xyz[surface.core])).max() < 1e-6
    monkeypatch.setattr(fitting_core, "near_noise", lambda *_: np.inf)
    assert geofit.fit_horizon(points).partition.lost, "the field takes it for noise"


@pytest.mark.parametrize("seed", range(4))
def test_noise_is_not(seed):
    surface = geofit.fit_horizon(geofit.PointSet(section_points(seed, relief=0.0, noise=0.6)))
    assert surface.partition.lost
    assert surface.diagnostics["noise"] == pytest.approx(0.6, rel=0.15)


def scattered_points(seed, noise):
    """Return 220 points scattered in a core over waves of 0.5 m, and 60 holes around."""
    rng = np.random.default_rng(seed)
    at = np.concatenate([rng.uniform(700, 1300, (220, 2)), rng.uniform(0, 2000, (60, 2))])
    z = 1400 + 0.02 * at[:, 0] + 0.5 * np.sin(at[:, 1] / 400) + rng.normal(0, noise, len(at))
    return geofit.PointSet(np.column_stack([ORIGIN + at, z]))


@pytest.mark.parametrize("seed", range(3))
def test_noise_far_below_the_interior_tolerance_is_met_on_gentle_relief(seed):
    points = scattered_points(seed, noise=0.02)
    surface = geofit.fit_horizon(points)
    assert surface.core.sum() > 200
    assert np.abs(surface.distance(points.xyz[surface.core])).max() < 1e-6


def test_a_raised_tolerance_makes_noise_no_relief():
    raised = geofit.FitSettings(interior_tolerance=10.0, epsilon=20.0)
    assert geofit.fit_horizon(scattered_points(0, noise=0.1), raised).partition.lost

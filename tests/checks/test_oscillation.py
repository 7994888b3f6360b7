"""The oscillation check in the wide gaps around a dense core."""

from __future__ import annotations

import numpy as np
import pytest

import geofit


def bowl(plan):
    """Return a gentle dome."""
    return 1000 + 60 * np.exp(-np.square(plan - (700, 800)).sum(axis=-1) / 500**2)


def core_with_holes(seed, holes):
    rng = np.random.default_rng(seed)
    core = np.concatenate(
        [np.column_stack([np.full(25, x), rng.uniform(700, 1300, 25)]) for x in np.linspace(800, 1200, 8)]
    )
    plan = np.concatenate([core, rng.uniform((0, 0), (2000, 2000), (holes, 2))])
    return np.column_stack([plan, bowl(plan) + rng.normal(0, 0.02, len(plan))])


@pytest.mark.parametrize(("seed", "holes"), [(8, 14), (134, 14), (84, 8), (110, 8), (121, 8)])
def test_a_surface_that_is_right_does_not_oscillate_in_the_gaps_around_a_core(seed, holes):
    # The limit in gaps of 200 m came from errors of dense points that were predicted from 20 m away.
    surface = geofit.fit_horizon(geofit.PointSet(core_with_holes(seed, holes)))
    (check,) = (one for one in surface.accuracy.checks if one.name == "oscillation")
    assert check.passed, check.text

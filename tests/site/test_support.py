"""Where a surface is supported: within the hull of its points, below the ground."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.site import Ground
from geofit.site.support import support_of


@pytest.mark.parametrize("seed", range(4))
def test_places_between_points_are_supported_and_those_far_beyond_are_not(seed):
    rng = np.random.default_rng(seed)
    points = np.column_stack([rng.uniform(0, 500, (40, 2)), rng.uniform(90, 110, 40)]) + np.array([4e5, 3e6, 0])
    support = support_of(points)
    mixed = rng.dirichlet(np.ones(40), 50) @ points
    assert (support.depth(mixed) > -1e-9).all()
    assert not support.within(mixed + np.array([2000.0, 0.0, 0.0])).any()


@pytest.mark.parametrize("azimuth", [0.0, 35.0, 120.0])
def test_a_steep_fault_is_looked_at_across_its_plane(azimuth):
    rng = np.random.default_rng(3)
    along, down = rng.uniform(-200, 200, 60), rng.uniform(-150, 150, 60)
    way = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth)), 0.0])
    points = along[:, None] * way + down[:, None] * np.array([0.0, 0.0, 1.0]) + rng.normal(0, 2, (60, 3))
    support = support_of(points)
    assert support.within(np.array([[0.0, 0.0, 0.0], 50 * way])).all()
    assert not support.within(np.array([[0.0, 0.0, 400.0], 600 * way])).any()


def test_above_the_ground_nothing_is_supported():
    x = y = np.linspace(0, 100, 11)
    ground = Ground(x, y, np.full((11, 11), 50.0))
    points = np.array([[0.0, 0, 40], [100, 0, 40], [100, 100, 60], [0, 100, 60]])
    support = support_of(points, ground)
    assert support.within(np.array([[50.0, 20.0, 44.0], [50.0, 80.0, 56.0]])).tolist() == [True, False]
    assert support.depth(np.array([[50.0, 20.0, 49.0]]))[0] == pytest.approx(1.5)


def test_points_without_an_area_support_what_is_below_the_ground():
    line = np.column_stack([np.arange(5.0), np.arange(5.0), np.zeros(5)])
    assert support_of(line).within(np.array([[99.0, 0.0, 0.0]])).tolist() == [True]

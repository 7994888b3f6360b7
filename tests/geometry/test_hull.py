"""Places within the hull of points, against half planes."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.geometry.hull import within_hull


@pytest.mark.parametrize("seed", range(5))
def test_places_within_a_triangle(seed):
    rng = np.random.default_rng(seed)
    a, b, c = corners = rng.uniform(-50, 50, (3, 2))
    places = rng.uniform(-60, 60, (500, 2))

    def side(p, q):
        return np.sign((q - p)[0] * (places - p)[:, 1] - (q - p)[1] * (places - p)[:, 0])

    sides = np.stack([side(a, b), side(b, c), side(c, a)])
    np.testing.assert_array_equal(within_hull(corners, places), np.abs(sides.sum(axis=0)) == 3)


@pytest.mark.parametrize(
    "points", [np.zeros((5, 2)), np.zeros((1, 2)), np.column_stack([np.zeros(6), np.arange(6.0)]), np.zeros((0, 2))]
)
def test_points_without_an_area_contain_no_place(points):
    assert not within_hull(points, np.array([[0.0, 0.0], [0.0, 1.0]])).any()

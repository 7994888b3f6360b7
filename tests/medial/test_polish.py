"""Polishing: planted balls are found again, and surface points lie on the surface on average."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.medial.balls import MetaballBody
from geofit.medial.polish import polish, surface_points


def test_face_centres_lie_on_the_surface_on_average():
    grid = np.argwhere(np.ones((30, 30, 30), bool)) + 0.5
    body = (np.linalg.norm(grid - 15.2, axis=1) < 11).reshape(30, 30, 30)
    points = surface_points(body, np.ones(3))
    away = np.linalg.norm(points - 15.2, axis=1) - 11
    assert np.abs(away).max() <= 0.75
    assert abs(away.mean()) < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_planted_balls_are_found_again(seed):
    rng = np.random.default_rng(seed)
    centre = np.column_stack([6 * np.arange(5), rng.normal(0, 1, 5), rng.normal(0, 1, 5)])
    radius = rng.uniform(4, 6, 5)
    points = MetaballBody(centre, radius).triangulate(1.0).vertices
    found, grown = polish(centre + rng.normal(0, 0.5, (5, 3)), radius + rng.normal(0, 0.5, 5), 4.0, points)
    assert np.abs(MetaballBody(found, grown).value(points)).max() < 0.02

"""Kriging of few and of oddly placed points: estimates, not errors."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.prediction.kriging import Variogram, fit_variogram, krige_left_out

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]])


@pytest.mark.parametrize(
    "plane",
    [
        np.array([[0.0, 0.0], [100.0, 0.0], [50.0, 80.0]]),
        np.array([[0.0, 0.0], [1.0, 0.0]]),
        SQUARE,
        np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]),
    ],
    ids=["triangle", "two places", "square", "one place twice"],
)
def test_places_no_nearer_than_half_the_extent_have_a_variogram(plane):
    z = np.arange(len(plane), dtype=float)
    model = fit_variogram(plane, z)
    assert np.isfinite(model(np.array([1.0, 50.0]))).all()
    assert (model(np.array([1.0, 50.0])) > 0).all()


def test_one_place_has_the_straight_variogram():
    straight = Variogram(0.0, 0.0, np.inf, 1.0)
    assert fit_variogram(np.zeros((5, 2)), np.arange(5.0)) == straight
    assert fit_variogram(np.zeros((1, 2)), np.zeros(1)) == straight


def test_a_corner_left_out_of_a_square_is_estimated_alike_on_both_sides():
    z = np.array([1.0, 2.0, 2.0, 3.0])
    found = krige_left_out(SQUARE, z, [np.array([k]) for k in range(4)])
    assert found[1] == pytest.approx(found[2])
    # The far corner counts least.
    assert abs(found[0] - 2.0) < 1 / 3
    assert found[0] + found[3] == pytest.approx(4.0)

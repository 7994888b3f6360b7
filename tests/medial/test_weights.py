"""Chamfer weights against the table of their optima, found independently."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import SettingsError
from geofit.medial.weights import chamfer_error, optimal_weights, world_factor


@pytest.mark.parametrize(
    ("weights", "absolute", "relative"),
    [
        ([1, 2**0.5, 3**0.5], (0.0, 0.1471), (0.0, 0.1281)),
        ([1, 4 / 3, 5 / 3], (-0.0809, 0.1181), (-0.0572, 0.1055)),
        ([1, 1.31402, 1.62803], (-0.1040, 0.1040), (-0.0710, 0.0942)),
        ([0.92644, 1.34066, 1.65849], (-0.0736, 0.0736), None),
        ([0.93981, 1.32909, 1.62780], None, (-0.0602, 0.0602)),
        ([1, 4 / 3], (-0.0809, 0.0572), None),
    ],
)
def test_errors_of_known_weights(weights, absolute, relative):
    found = chamfer_error(weights)
    if absolute:
        assert found.absolute == pytest.approx(absolute, abs=1e-3)
    if relative:
        assert found.relative == pytest.approx(relative, abs=1e-3)


def test_the_program_finds_the_optima_to_five_digits():
    assert optimal_weights() == pytest.approx((0.92644, 1.34066, 1.65849), abs=1e-5)
    assert optimal_weights(relative=True) == pytest.approx((0.93981, 1.32909, 1.62780), abs=1e-5)
    assert optimal_weights(2) == pytest.approx((0.95509, 1.36930), abs=1e-5)
    assert optimal_weights(2, first=1) == pytest.approx((1, 1.35070), abs=1e-5)
    best = optimal_weights(first=1)
    assert best[2] == pytest.approx(1.62803, abs=1e-5)
    assert max(map(abs, chamfer_error(best).absolute)) == pytest.approx(0.1040, abs=1e-4)


def test_no_random_weights_are_better():
    rng = np.random.default_rng(5)
    least = max(map(abs, chamfer_error(optimal_weights()).absolute))
    for _ in range(200):
        w = np.sort(np.array([0.92644, 1.34066, 1.65849]) + rng.normal(0, 0.02, 3))
        assert max(map(abs, chamfer_error(w).absolute)) >= least - 1e-6


def test_scaled_345_has_eight_percent():
    factor = world_factor([3, 4, 5])
    assert 3 * factor == pytest.approx(0.97640, abs=1e-5)
    assert chamfer_error(np.array([3, 4, 5]) * factor).relative == pytest.approx((-0.0794, 0.0794), abs=1e-4)


@pytest.mark.parametrize("weights", [[1], [2, 1, 3], [0, 1, 2], [1, np.nan, 2]])
def test_bad_weights_are_refused(weights):
    with pytest.raises(SettingsError, match="give 2 or 3 numbers"):
        chamfer_error(weights)


def test_a_fourth_dimension_is_refused():
    with pytest.raises(SettingsError, match="give 2 or 3"):
        optimal_weights(4)

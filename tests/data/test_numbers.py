"""Numbers of any length, from callers and from files, end in a geofit error."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

from geofit import BodySettings, FitSettings, PointSet
from geofit.data.columns import LARGEST, measurable_places
from geofit.data.errors import PointsError, SettingsError
from geofit.data.numbers import is_finite, shown

LONG = 10**400


@pytest.mark.parametrize(
    ("value", "finite"),
    [(1, True), (np.float64(2.5), True), (np.int64(3), True), (LONG, False), (-LONG, False), (float("nan"), False),
     (float("inf"), False), (True, False), (np.True_, False), ("1", False), (None, False), ([1.0], False), (1j, False)],
)  # fmt: skip
def test_finite_numbers(value, finite):
    assert is_finite(value) is finite


def test_a_value_of_any_length_can_be_shown():
    assert len(shown(LONG)) < 300
    assert shown(16**5000) == "a whole number of more than 4,300 digits"  # Python does not write it


@pytest.mark.parametrize("value", [LONG, pytest.param(16**5000, id="longest"), "1", None, True, float("nan")])
@pytest.mark.parametrize("name", ["epsilon", "smoothing", "coincidence_distance", "max_iterations"])
def test_settings_refuse_what_no_double_holds(name, value):
    with pytest.raises(SettingsError):
        FitSettings(**{name: value})


@pytest.mark.parametrize(
    "settings",
    [{"epsilon": LONG}, {"dense": LONG}, {"azimuth": LONG}, {"ranges": (LONG, 1, 1)}, {"ranges": "abc"},
     {"box": ((0, 0, 0), (LONG, 1, 1))}],
)  # fmt: skip
def test_settings_of_bodies_too(settings):
    with pytest.raises(SettingsError):
        BodySettings(**settings)


def test_a_polygon_with_a_corner_beyond_all_numbers():
    with pytest.raises(SettingsError):
        FitSettings(core=((0, 0), (LONG, 0), (1, 1)))
    with pytest.raises(SettingsError):
        FitSettings(max_control_points=LONG)


def test_points_beyond_all_numbers():
    with refused(PointsError, "data.coordinates-not-numbers"):
        PointSet([[LONG, 0, 0]] * 4)


def test_places_that_can_be_measured():
    assert measurable_places([1, 2, 3]).shape == (1, 3)
    assert measurable_places([]).shape == (0, 3)
    assert measurable_places([[LARGEST, -LARGEST, 0]]).shape == (1, 3)
    with refused(PointsError, "data.coordinate-too-large"):
        measurable_places([[1.001 * LARGEST, 0, 0]])
    with refused(PointsError, "data.points-not-finite", count=1, index=1):
        measurable_places([[0, 0, 0], [np.nan, 0, 0]])

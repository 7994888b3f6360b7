from __future__ import annotations

import dataclasses
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from refusals import refused

from geofit import FitSettings
from geofit.data.errors import GeofitError, InputError, SettingsError
from geofit.data.languages import ZH, translate
from geofit.data.messages import message
from geofit.data.setting_texts import SETTINGS
from geofit.data.settings import named

LENGTHS = ("epsilon", "interior_tolerance", "boundary_tolerance", "coincidence_distance")


def test_the_defaults_are_the_papers():
    settings = FitSettings()
    assert (settings.epsilon, settings.interior_tolerance, settings.boundary_tolerance) == (0.5, 0.1, 0.01)
    assert (settings.core, settings.frame, settings.smoothing) == ("auto", "auto", "auto")


@pytest.mark.parametrize("name", LENGTHS)
@pytest.mark.parametrize("value", [0, -0.1, np.nan, np.inf, "0.5", None, True, [1.0]])
def test_a_length_must_be_a_finite_number_above_zero(name, value):
    code = "data.setting-not-positive"
    with refused(SettingsError, code, setting=named(name), value=repr(value)) as caught:
        FitSettings(**{name: value})
    assert caught.value.message.params["unit"].code == "data.setting-unit-metres"


@pytest.mark.parametrize(
    ("name", "value", "choices"),
    [
        ("across", "quadratic", ("'cubic'", "'linear'")),
        ("seam", "smooth", ("'tangent'", "'position'")),
        ("frame", "plane", ("'auto'", "'map'", "'best-plane'", "'sections'")),
        ("core", "everything", ("'auto'", "'all'", "'none'")),
        ("across", 3, ("'cubic'",)),
    ],
)
def test_an_unknown_word_is_quoted_beside_the_known_ones(name, value, choices):
    code = "data.setting-unknown-choice-or-polygon" if name == "core" else "data.setting-unknown-choice"
    with refused(SettingsError, code, setting=named(name), value=repr(value)) as caught:
        FitSettings(**{name: value})
    for choice in choices:
        assert choice in caught.value.message.params["words"]


@pytest.mark.parametrize("value", [0, -1.0, np.nan, "much", None, False])
def test_smoothing_is_auto_or_a_positive_number(value):
    with refused(SettingsError, "data.setting-not-positive", setting=named("smoothing"), value=repr(value)):
        FitSettings(smoothing=value)
    assert FitSettings(smoothing=0.25).smoothing == 0.25


@pytest.mark.parametrize("value", [-1, 2.5, "20", None])
def test_iterations_are_a_whole_number(value):
    with refused(
        SettingsError, "data.setting-not-whole-number", setting=named("max_iterations"), value=repr(value), least=0
    ):
        FitSettings(max_iterations=value)
    assert FitSettings(max_iterations=0).max_iterations == 0


@pytest.mark.parametrize("value", [15, 0, -4, 100.0, True, "many"])
def test_the_cap_of_control_points_is_a_whole_number_of_at_least_16(value):
    with refused(
        SettingsError, "data.setting-not-whole-number", setting=named("max_control_points"), value=repr(value), least=16
    ):
        FitSettings(max_control_points=value)
    assert FitSettings(max_control_points=16).max_control_points == 16


@pytest.mark.parametrize(
    "core", [[[0, 0], [1, 1]], [0, 0, 1], [[0, 0, 0]] * 4, [[0, 0], [1, np.nan], [1, 1]], [["a", "b"]] * 3, 7]
)
def test_a_core_polygon_needs_three_finite_corners(core):
    with refused(SettingsError, "data.setting-polygon-wrong-shape", setting=named("core")):
        FitSettings(core=core)


@hypothesis_settings(deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7)), min_size=3, max_size=8))
def test_a_core_polygon_becomes_plain_numbers(corners):
    settings = FitSettings(core=np.array(corners))
    assert settings.core == tuple(corners)
    assert hash(settings) == hash(FitSettings(core=corners))


def test_settings_are_frozen_and_keyword_only():
    settings = FitSettings()
    with pytest.raises(dataclasses.FrozenInstanceError):
        settings.epsilon = 1.0
    with pytest.raises(TypeError):
        FitSettings(0.5)
    with refused(SettingsError, "data.setting-not-positive", setting=named("epsilon"), value="-1"):
        dataclasses.replace(settings, epsilon=-1)


def test_errors_are_geofit_errors_and_value_errors():
    assert issubclass(SettingsError, GeofitError)
    assert issubclass(SettingsError, ValueError)


def test_a_bad_setting_is_told_in_chinese_by_its_name():
    with pytest.raises(SettingsError) as caught:
        FitSettings(epsilon=-1)
    assert str(caught.value) == "Control error ε (epsilon) is -1; a finite number above 0 is needed (metres)."
    assert translate(caught.value, ZH) == "控制误差 ε（epsilon）为 -1；应为大于 0 的有限数（米）。"


def test_an_input_error_is_told_in_chinese_and_crosses_to_another_process():
    error = InputError(
        message("data.reason-sentence", "{reason}.", reason="a"),
        message("test.text", "b."),
        file="f.csv",
        row=3,
        column="x",
        value="7",
    )
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error)
    assert (copy.file, copy.row, copy.column, copy.value) == ("f.csv", 3, "x", "7")
    assert str(InputError(message("test.text", "no such file"), file="f.csv")) == "f.csv: no such file."
    missing = InputError(message("test.text", "no such file"), message("test.text", "try again"), file="f.csv", row=2)
    assert translate(missing, ZH) == "f.csv，第 2 行：no such file。try again"


def test_every_setting_is_described_once_and_all_rooms_read_it():
    assert set(SETTINGS) == {field.name for field in dataclasses.fields(FitSettings)}
    shown = subprocess.run(
        [sys.executable, "-m", "geofit", "fit", "--help"], capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    for name, text in SETTINGS.items():
        assert str(text.about) in " ".join(shown.split()), name
        for choice in text.choices:
            FitSettings(**{name: choice})


def test_the_page_of_the_settings_is_that_of_the_table():
    script = Path(__file__).resolve().parents[2] / "tools" / "settings_page.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr

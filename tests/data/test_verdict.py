"""One verdict from three lamps: at the data, checks, away from the data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from geofit.data.accuracy import Accuracy, Check
from geofit.data.messages import message
from geofit.data.prediction import LeftOut, LeftOutBody, Outlier, PredictionResult
from geofit.data.verdict import verdict_of

EPSILON = 0.5
TEXT = message("test.text", "as asked")
GOOD, BAD = Check("trend", True, 1.0, 2.0, "m", TEXT), Check("trend", False, 3.0, 2.0, "m", TEXT)
SILENT = Check("order", None, 0.0, 0.0, "m", TEXT)


def accuracy(sigma=0.03, checks=(GOOD, SILENT)):
    return Accuracy(
        n=9, sigma=sigma, epsilon=EPSILON, passed=sigma < EPSILON, max_abs=0.1, mean=0.0, residuals=np.zeros(9),
        patch=np.full(9, "core"), by_patch={}, by_kind={}, by_hole={}, by_section={}, over={}, worst=(),
        checks=tuple(checks),
    )  # fmt: skip


def prediction(rms=0.2, inside=0.9, others=()):
    def one(scheme, rms, inside):
        return LeftOut(scheme, 5, np.full(9, ""), np.zeros(9), np.ones(9), rms, rms, 0.0, 2 * rms, inside, inside, {})

    return PredictionResult((one("hole", rms, inside), *(one(*other) for other in others)), None, (), ())


def test_all_green():
    found = verdict_of(accuracy(), prediction())
    assert [lamp.level for lamp in found.lamps] == ["pass", "pass", "pass"]
    assert found.word == "PASS"
    assert found.checks.text.params["total"] == 1, "a check that does not apply is not counted"


@pytest.mark.parametrize(
    ("given", "level", "lamp"),
    [
        ((accuracy(sigma=0.6), prediction()), "fail", "data"),
        ((accuracy(checks=(GOOD, BAD)), prediction()), "warning", "checks"),
        ((accuracy(), prediction(rms=0.8)), "warning", "away"),
        ((accuracy(), prediction(inside=0.7)), "warning", "away"),
        ((accuracy(), prediction(others=[("block", 0.3, 0.6)])), "warning", "away"),
    ],
)
def test_the_word_follows_from_the_worst_lamp(given, level, lamp):
    found = verdict_of(*given)
    assert found.level == level
    assert [name for name in ("data", "checks", "away") if getattr(found, name).level != "pass"] == [lamp]


@pytest.mark.parametrize(
    ("errors", "level", "words"),
    [
        ((-0.4,), "pass", "; outlier: borehole B1, 0.400 m off its neighbours"),
        ((-98.5,), "warning", "; outlier: borehole B1, 98.500 m off its neighbours"),
        ((0.3, -0.6), "warning", "; 2 outliers, the farthest off its neighbours: borehole B2, 0.600 m"),
    ],
)
def test_the_worst_outlier_is_named_and_beyond_epsilon_no_surface_passes(errors, level, words):
    outliers = tuple(Outlier(k, error, 0.1, 10 * abs(error), f"borehole B{k + 1}") for k, error in enumerate(errors))
    found = verdict_of(accuracy(), replace(prediction(), outliers=outliers))
    assert found.level == level
    assert str(found.away.text).endswith(words)
    assert verdict_of(accuracy(), replace(prediction(rms=10 * EPSILON), outliers=outliers)).away.level == "fail"


def test_a_left_out_error_of_ten_epsilons_is_red_and_said():
    found = verdict_of(accuracy(), prediction(others=[("section", 10 * EPSILON, 0.9)]))
    assert found.away.level == "fail"
    assert found.word == "WARNING"
    error = found.away.text.params["error"]
    assert error.params["ratio"] == pytest.approx(10)
    assert error.params["scheme"].code == "data.verdict-sections"
    assert "10 ε" in str(found.text)


def test_rounding_is_no_figure_whatever_else_is_wrong():
    passed = verdict_of(accuracy(2e-14)).lamps[0].text
    failed = verdict_of(replace(accuracy(2e-14), passed=False)).lamps[0].text
    assert "σ < 1e-9 m" in str(passed)
    assert "σ < 1e-9 m" in str(failed)
    assert failed.code == "data.verdict-exact-and-runs-away"


def test_the_file_and_the_order_count_among_the_checks():
    assert verdict_of(accuracy(), orders=[replace(BAD, name="order")]).checks.text.params["names"] == ("order",)


def test_what_was_not_examined_is_no_fault():
    found = verdict_of(accuracy())
    assert found.away.level == "none"
    assert found.word == "PASS"
    assert found.away.text.code == "data.verdict-not-examined"


def body_left_out(**changed):
    given = {
        "scheme": "hole",
        "groups": 9,
        "error": 0.4,
        "missed": 0,
        "misclassified": 1.5,
        "logged": 300.0,
        "inside": 0.9,
    }
    return LeftOutBody(**{**given, **changed})


@pytest.mark.parametrize(
    ("changed", "level", "words"),
    [
        ({}, "pass", "left-out error 0.400 m = 0.8 ε (holes left out)"),
        ({}, "pass", "1.5 m of 300.0 m on the wrong side"),
        ({"error": 0.017}, "pass", "= 0.034 ε"),
        ({"error": 4e-6}, "pass", "left-out error 4.00e-6 m < 0.01 ε"),
        ({"error": 2.0}, "warning", "4 ε"),
        ({"error": 5.0}, "fail", "10 ε"),
        ({"inside": 0.8}, "warning", "the 90 % band contains 80 %"),
        ({"missed": 2}, "warning", "contacts not predicted: 2"),
        ({"beyond": 3}, "warning", "the 90 % band contains 90 %, contacts beyond the reach of other data: 3"),
        ({"beyond": 3, "inside": np.nan}, "warning", "on the wrong side, contacts beyond the reach of other data: 3"),
        ({"error": np.nan, "missed": 4}, "fail", "none of 4 left-out contacts"),
        ({"error": np.nan}, "none", "cannot be estimated"),
        ({"scheme": "section", "logged": 0.0}, "pass", "sections left out"),
    ],
)
def test_the_lamp_of_a_body_away_from_its_data(changed, level, words):
    judged = verdict_of(accuracy(), body_left_out(**changed))
    assert judged.away.level == level
    assert words in str(judged.away.text)
    assert judged.word == {"pass": "PASS", "none": "PASS"}.get(level, "WARNING")
    if changed.get("scheme") == "section":
        assert "wrong side" not in str(judged.away.text)

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused
from truth import paper_arrangement

from geofit import FitSettings, fit_horizon
from geofit.data.errors import Cancelled, GeofitError
from geofit.data.progress import tell

STAGES = ["conflicts", "partition", "fit", "field", "core", "periphery", "check", "adjust", "done"]


@pytest.fixture(scope="module")
def truth():
    return paper_arrangement(0)


def heard(points, settings=None):
    calls = []
    fit_horizon(points, settings, progress=lambda stage, fraction: calls.append((stage, fraction)))
    return calls


@pytest.mark.parametrize("settings", [FitSettings(), FitSettings(core="none"), FitSettings(core="all")])
def test_stages_come_in_order_with_rising_fractions(truth, settings):
    calls = heard(truth.points, settings)
    fractions = [fraction for _, fraction in calls]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert all(0 <= fraction <= 1 for fraction in fractions)
    stages = [stage for stage, _ in calls]
    assert stages[0] == "conflicts"
    assert stages[-1] == "done"
    assert {"partition", "field", "check", "adjust"} <= set(stages)
    assert [stage for stage in STAGES if stage in stages] == list(dict.fromkeys(stages))


def test_the_core_has_a_stage_of_its_own(truth):
    assert "core" in dict(heard(truth.points))


@pytest.mark.parametrize("stage", STAGES)
def test_false_stops_the_fit_at_any_stage(truth, stage):
    calls = []

    def listen(now, fraction):
        calls.append(now)
        return now != stage

    with refused(Cancelled, "data.cancelled-in-stage", stage=stage):
        fit_horizon(truth.points, progress=listen)
    assert calls[-1] == stage


@pytest.mark.parametrize("answer", [None, True, 0, "", np.False_])
def test_only_false_itself_stops(answer):
    tell(lambda stage, fraction: answer, "core", 0.5)


def test_no_listener_and_fractions_out_of_range():
    tell(None, "core", 0.5)
    calls = []
    for fraction in (-1.0, 0.3, 7.0):
        tell(lambda stage, at: calls.append(at), "core", fraction)
    assert calls == [0.0, 0.3, 1.0]


def test_a_listeners_own_error_comes_through(truth):
    def listen(stage, fraction):
        raise ZeroDivisionError(stage)

    with pytest.raises(ZeroDivisionError, match="conflicts"):
        fit_horizon(truth.points, progress=listen)


def test_cancelled_is_a_geofit_error():
    assert issubclass(Cancelled, GeofitError)


def test_seconds_a_stage_are_told(truth):
    seconds = fit_horizon(truth.points).diagnostics["seconds"]
    assert {"conflicts", "partition", "field", "core", "periphery", "check"} <= set(seconds)
    assert all(value >= 0 for value in seconds.values())

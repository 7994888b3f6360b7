"""One unforeseen error costs one examination, and is reported; stopping is not a failure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import geofit
from geofit import PointSet, fit_horizon
from geofit.data.errors import Cancelled, FitError
from geofit.data.guard import guarded
from geofit.data.languages import ZH, translate
from geofit.data.messages import message
from geofit.prediction import crossval
from geofit.prediction.examine import examine
from geofit.project.run import run_horizons
from geofit.site import fit_site as sitefit
from geofit.splines import bspline


def cloud(n=30, seed=0):
    xy = np.random.default_rng(seed).uniform(0, 300, (n, 2))
    return PointSet(
        np.column_stack([xy + np.array([500000.0, 3100000.0]), 20 * np.sin(xy[:, 0] / 90) + 0.1 * xy[:, 1]])
    )


def broken(*args, **kwargs):
    raise ZeroDivisionError("planted")


def test_the_result_is_returned_and_nothing_reported():
    notes = []
    assert guarded(lambda: 7, None, notes.append) == 7
    assert notes == []


def test_a_geofit_error_is_reported_in_its_own_words():
    notes = []

    def refuse():
        raise FitError(message("test.text", "too few points"))

    assert guarded(refuse, "instead", notes.append) == "instead"
    assert [str(note) for note in notes] == ["too few points"]


def test_an_unforeseen_error_is_reported_with_its_kind_and_line():
    notes = []
    assert guarded(broken, None, notes.append) is None
    assert notes[0].code == "data.unforeseen-error"
    assert str(notes[0]).startswith("unforeseen error ZeroDivisionError (planted; test_guard.py:")
    assert translate(notes[0], ZH).startswith("未预见的错误 ZeroDivisionError（planted")


def test_an_error_inside_a_library_names_the_line_of_geofit_that_called_it():
    notes = []
    guarded(lambda: bspline.basis(np.array(["a"]), 3, np.zeros(1)), None, notes.append)
    assert "; bspline.py:" in str(notes[0])


@pytest.mark.parametrize("stop", [Cancelled(message("test.text", "stopped")), KeyboardInterrupt()])
def test_a_stop_passes_through(stop):
    def stopped():
        raise stop

    with pytest.raises(type(stop)):
        guarded(stopped, None, print)


def test_a_method_that_fails_costs_its_own_figure_only(monkeypatch):
    surface = fit_horizon(cloud())
    whole = examine(surface)
    monkeypatch.setattr(crossval, "krige_left_out", broken)
    without = examine(surface)
    assert [set(one.references) for one in without.left_out] == [{"thin plate"}] * len(whole.left_out)
    assert [one.rms for one in without.left_out] == [one.rms for one in whole.left_out]
    np.testing.assert_array_equal(without.uncertainty.sd, whole.uncertainty.sd)
    (note, *_) = [note for note in without.notes if note.code == "prediction.method-not-compared"]
    assert note.params["method"] == "kriging"
    assert note.params["reason"].code == "data.unforeseen-error"


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("linear_fit", "prediction.band-not-calibrated"),
        ("suggest_holes", "prediction.no-holes-suggested"),
        ("uncertainty_on", "prediction.standard-deviation-unknown"),
        ("thin_plate_inverse", "prediction.no-method-compared"),
        ("posterior", "prediction.error-not-found"),
    ],
)
def test_each_part_of_an_examination_may_fail_alone(monkeypatch, name, code):
    surface = fit_horizon(cloud())
    monkeypatch.setattr("geofit.prediction.examine." + name, broken)
    (note,) = [note for note in examine(surface).notes if note.code == code]
    assert note.params["reason"].code == "data.unforeseen-error"


def test_a_check_that_fails_is_reported_among_the_notes(monkeypatch):
    monkeypatch.setattr("geofit.checks.check.oscillation", broken)
    accuracy = fit_horizon(cloud()).accuracy
    assert accuracy.passed
    assert "between points" not in {check.name for check in accuracy.checks}
    (note,) = [note for note in accuracy.notes if note.code == "checks.check-not-made"]
    assert note.params["reason"].code == "data.unforeseen-error"


def test_a_horizon_that_fails_leaves_the_others_of_the_run(tmp_path, monkeypatch):
    sound = sitefit.fit_horizon

    def sometimes(points, *args, name, **kwargs):
        return broken() if name == "bad" else sound(points, *args, name=name, **kwargs)

    monkeypatch.setattr(sitefit, "fit_horizon", sometimes)
    monkeypatch.setattr("geofit.checks.storage.equal_accuracy", broken)
    site = geofit.Site("two", {"bad": cloud(), "good": cloud(seed=1)})
    done = run_horizons(site, tmp_path)
    assert [result.name for result in done.results] == ["good"]
    assert done.failures["bad"].code == "data.unforeseen-error"
    assert done.failures["bad"].params["kind"] == "ZeroDivisionError"
    assert "project.storage-not-compared" in {note.code for note in done.warnings}
    assert "ZeroDivisionError" in (tmp_path / "report.html").read_text("utf-8")


def test_an_order_that_fails_is_reported(tmp_path, monkeypatch):
    site = geofit.Site("two", {"top": cloud(), "base": cloud(seed=1)})
    site = replace(site, order=("top", "base"))
    monkeypatch.setattr("geofit.site.fit_site.compare_pairs", broken)
    done = run_horizons(site, tmp_path)
    assert len(done.results) == 2
    (note,) = [note for note in done.warnings if note.code == "project.order-not-examined"]
    assert note.params["reason"].code == "data.unforeseen-error"

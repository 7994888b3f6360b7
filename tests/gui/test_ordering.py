"""The order of the horizons in the window: changed, checked without faults, and mended as one step."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from panel_samples import prediction
from PySide6.QtWidgets import QDialog

from geofit.data.errors import FitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.gui.dialogs.order import OrderDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.project.building import make
from geofit.project.commands import SetOrder
from geofit.project.ordering import over_map
from geofit.project.provenance import Row
from geofit.site.order import compare_horizons


def scattered(seed, lift):
    """A plane seen at scattered places with errors of decimetres."""
    rng = np.random.default_rng(seed)
    plan = rng.uniform(0, 400, (60, 2))
    z = 0.05 * plan[:, 0] + lift + rng.normal(0, 0.4, 60)
    return PointSet(np.column_stack([plan, z]), file=f"{seed}.csv", row=np.arange(60) + 2)


@pytest.fixture
def crossing(app):
    """Two horizons a decimetre apart, whose fits cross."""
    settings = FitSettings(core="none")
    site = Site("Dam", {"up": scattered(1, 0.1), "low": scattered(2, 0.0)}, {"up": settings, "low": settings})
    app.desktop.session.begin(site, None)
    app.window.fitting.fit_all()
    app.idle()
    return app


def crossed(app):
    return compare_horizons(app.document.surface("up"), app.document.surface("low")).crossed_volume


def test_horizons_are_pushed_apart_and_back_as_one_step_that_can_be_made_again(crossing):
    document, stack = crossing.document, crossing.window.session.stack
    before, steps = dict(document.surfaces()), stack.count()
    assert crossed(crossing) > 0
    crossing.window.ordering.separate(0.05)
    crossing.idle()
    assert crossed(crossing) == 0
    assert stack.count() == steps + 1
    assert stack.undoText().startswith("Separate")
    name = next(name for name in before if document.surface(name) is not before[name])
    provenance, moved = document.state.provenances[name], document.surface(name)
    again = make(provenance, document.given_for(provenance))
    np.testing.assert_allclose(again.patches[0].control, moved.patches[0].control, atol=1e-12)
    assert not document.stale(name)
    stack.undo()
    crossing.idle()
    assert all(document.surface(name) is surface for name, surface in before.items())


def test_horizons_that_cross_stay_a_warning_until_one_of_them_changes(crossing):
    document, showing = crossing.document, crossing.window.showing
    crossing.trigger("check_order")
    crossing.idle()
    failed = showing.verdict("up").checks.text
    assert str(failed).endswith("order")
    document.put_prediction(document.state.provenances["low"], replace(prediction(3), uncertainty=None))
    crossing.idle()
    assert showing.verdict("up").checks.text == failed
    document.select("up")
    crossing.window.fitting.exclude("up", (Row.of(document.site.horizons["up"], 3),))
    crossing.window.fitting.fit("up")
    crossing.idle()
    assert showing.verdict("up").checks.text != failed
    assert not showing.orders


def test_an_order_that_was_checked_is_known_in_another_language(crossing):
    crossing.trigger("check_order")
    crossing.idle()
    before = crossing.window.showing.verdict("up")
    assert str(before.checks.text).endswith("order")
    crossing.document.select("up")
    for code in ("zh_CN", "en"):
        crossing.desktop.change_language(code)
        crossing.idle()
        assert crossing.window.showing.verdict("up") == before
        tree = crossing.window.panels.checks.tree
        groups = [tree.topLevelItem(k).text(0) for k in range(tree.topLevelItemCount())]
        assert ("Order of horizons" in groups) is (code == "en")
        assert len(groups) >= 2
    crossing.window.fitting.push(SetOrder(("low", "up")))
    crossing.idle()
    assert not crossing.window.showing.orders


def test_an_order_that_was_checked_is_forgotten_with_another_order(crossing):
    crossing.trigger("check_order")
    crossing.idle()
    crossing.window.fitting.push(SetOrder(("low", "up")))
    crossing.idle()
    assert not crossing.window.showing.orders


def test_the_stated_order_counts_in_the_verdict_as_soon_as_both_horizons_are_fitted(app):
    """As in a run of the whole site: PASS in the window and WARNING in the report would be two verdicts."""
    settings = FitSettings(core="none")
    points = {"up": scattered(1, 0.1), "low": scattered(2, 0.0)}
    app.desktop.session.begin(Site("Dam", points, dict.fromkeys(points, settings), order=("up", "low")), None)
    showing = app.window.showing

    def failed():
        return str(showing.verdict("up").checks.text).endswith("order")

    app.window.fitting.fit("up")
    app.idle()
    assert not failed()
    app.window.fitting.fit("low")
    app.qtbot.waitUntil(lambda: bool(showing.orders), timeout=60_000)
    assert failed()
    assert showing.verdict("up").word == "WARNING"
    app.window.fitting.exclude("up", (Row.of(app.document.site.horizons["up"], 3),))
    app.window.fitting.fit("up")
    app.idle()
    app.qtbot.waitUntil(lambda: bool(showing.orders) and app.window.ordering.idle, timeout=60_000)
    made = app.document.state.provenances
    assert failed()
    app.window.session.stack.undo()
    app.qtbot.waitUntil(lambda: app.document.state.provenances != made and bool(showing.orders), timeout=60_000)


def test_the_order_that_a_site_states_counts_wherever_its_files_list_the_horizons(app):
    settings = FitSettings(core="none")
    points = {"low": scattered(2, 0.0), "cut": scattered(3, 9.0), "up": scattered(1, 5.0)}
    app.desktop.session.begin(Site("Dam", points, dict.fromkeys(points, settings), order=("up", "low")), None)
    app.window.fitting.fit_all()
    app.idle()
    assert app.document.horizons == ("up", "cut", "low")
    app.trigger("check_order")
    app.idle()
    (order,) = app.window.showing.orders
    assert (order.upper, order.lower) == ("up", "low")
    assert not order.crossings
    before = dict(app.document.surfaces())
    app.window.ordering.separate()
    app.idle()
    assert all(app.document.surface(name) is surface for name, surface in before.items())


def test_a_report_compares_the_horizons_in_the_order_of_the_window_which_takes_over_what_it_finds(
    crossing, write_report, tmp_path, monkeypatch
):
    document, showing = crossing.document, crossing.window.showing
    monkeypatch.setattr(ReportDialog, "exec", lambda dialog: write_report(dialog, tmp_path, "json"))
    crossing.desktop.session.begin(replace(document.site, order=("up", "low")), None)
    crossing.window.fitting.fit_all()
    crossing.idle()
    assert showing.verdict("up").word == "PASS"
    crossing.trigger("report")
    crossing.idle()
    written = json.loads((tmp_path / "report.json").read_text("utf-8"))["horizons"]
    assert [one["verdict"] for one in written] == ["WARNING"] * 2
    assert [showing.verdict(one["horizon"]).word for one in written] == ["WARNING"] * 2
    assert str(showing.verdict("up").checks.text).endswith("order")
    crossing.window.fitting.push(SetOrder(("low", "up")))
    crossing.idle()
    assert document.site_in_use().order == ("low", "up")
    crossing.window.session.stack.undo()
    assert document.site_in_use().order == ("up", "low")


def test_the_order_is_changed_by_a_dialog_and_undone(crossing, monkeypatch):
    def drive(dialog):
        dialog.list.setCurrentRow(1)
        dialog.move_chosen(-1)
        return QDialog.DialogCode.Accepted

    monkeypatch.setattr(OrderDialog, "exec", drive)
    crossing.trigger("order")
    assert crossing.document.horizons == ("low", "up")
    crossing.window.session.stack.undo()
    assert crossing.document.horizons == ("up", "low")


def test_a_weight_is_set_by_hand_or_refused_with_a_reason(crossing, qtbot):
    document, adjust = crossing.document, crossing.window.panels.adjust
    document.select("low")
    crossing.idle()
    before = document.surface("low")
    patch = before.patches[0]
    i, j = (n // 2 for n in patch.control.shape[:2])
    adjust.choose_control(patch.name, i, j)
    adjust.control.weight.value.setValue(3.0)
    assert adjust.control.weight.button.isEnabled()
    adjust.control.weight.button.click()
    crossing.idle()
    after = document.surface("low").patches[0]
    assert after.weights[i, j] == 3.0
    assert adjust.control.weight.value.value() == 3.0
    assert "Weight 3" in crossing.window.session.stack.undoText()
    crossing.window.fitting.weigh("low", patch.name, 10_000, 0, 2.0)
    qtbot.waitUntil(lambda: not crossing.window.activity.busy, timeout=60_000)
    assert isinstance(crossing.failures.pop(), FitError)
    assert document.surface("low").patches[0] is after


def test_a_new_fit_reports_the_edits_that_it_drops(crossing, caplog):
    window, document = crossing.window, crossing.document
    patch = document.surface("low").patches[0]
    window.fitting.weigh("low", patch.name, *(n // 2 for n in patch.control.shape[:2]), 3.0)
    crossing.idle()
    edited = document.surface("low")
    window.fitting.fit_all()
    crossing.idle()
    words = "The new fit of low drops the edit made after the former fit. Undo brings it back."
    assert document.surface("low") is not edited
    assert window.statusBar().currentMessage() == words
    assert words in caplog.text
    window.session.stack.undo()
    crossing.idle()
    assert document.surface("low") is edited
    assert not document.state.provenances["up"].edits


def test_faults_are_left_out_of_the_order():
    from panel_samples import FAULT, WITH_PERIPHERY, fitted

    assert list(over_map({WITH_PERIPHERY: fitted(), FAULT: fitted(FAULT)})) == [WITH_PERIPHERY]


def test_a_surface_that_cuts_the_strata_is_left_out_where_the_site_states_an_order(app):
    settings = FitSettings(core="none")
    points = {"up": scattered(1, 5.0), "cut": scattered(3, 2.5), "low": scattered(2, 0.0)}
    site = Site("Dam", points, dict.fromkeys(points, settings), order=("up", "low"))
    app.desktop.session.begin(site, None)
    app.window.fitting.fit_all()
    app.idle()
    assert list(app.window.ordering.strata()) == ["up", "low"]

"""The verdict is the same in badge, tree, STEP dialog, console and report; points are chosen and excluded by rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from panel_samples import SITE, fitted, item_of, prediction, sample_site
from PySide6.QtCore import Qt

from geofit.data.accuracy import Check
from geofit.data.languages import EN
from geofit.data.messages import message
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.io.site_file import read_site
from geofit.project.commands import SetSurface
from geofit.project.provenance import Row

NAME = "T3-T2"
FAILED = Check("trend", False, 9.0, 1.0, "m", message("test.text", "it runs away"), ())


@pytest.fixture
def shown(app):
    """The sample site with one surface of which a check fails, examined away from its data."""
    document = app.document
    # The holes of the samples of panels have other names than their interval tables.
    app.desktop.session.begin(replace(sample_site(), holes=read_site(SITE).holes), SITE)
    document.select(NAME)
    provenance, surface = document.provenance(NAME), fitted()
    accuracy = replace(surface.accuracy, checks=(*surface.accuracy.checks, FAILED))
    document.put(provenance, surface.with_(accuracy=accuracy))
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.panels, app.view = app.window.panels, app.window.panels.view
    return app


def tree_row(app):
    return next(row for row in app.panels.tree.items.all() if row.text.startswith(NAME))


def test_a_failed_check_is_amber_everywhere_and_in_the_same_words(shown, qtbot, capsys):
    from geofit.cli.console import print_results
    from geofit.report.chapters import document as chapters
    from geofit.report.gather import accuracy_report

    verdict = shown.window.showing.verdict(NAME)
    said = str(verdict.checks.text)
    assert "failed: trend" in said
    badge = shown.panels.verdict
    assert badge.text.splitlines()[0] == "WARNING"
    assert badge.mark.name == "warning"
    assert said in badge.text.splitlines()
    row = tree_row(shown)
    assert "WARNING" in row.aloud
    assert said in row.words
    dialog = ExportDialog(shown.document.surfaces(), None, {NAME: verdict})
    qtbot.addWidget(dialog)
    assert dialog.horizons.item(0).text() == f"{NAME}   {verdict.text}"
    result = shown.window.delivering.result(NAME, shown.document.surface(NAME))
    assert result.verdict == verdict
    print_results([result])
    printed = capsys.readouterr()
    assert "WARNING" in printed.out
    assert said in printed.err + printed.out
    report = accuracy_report([result], date="2026-11-22")
    assert report.horizons[0].verdict == "WARNING"
    assert report.horizons[0].lamps == verdict.lamps
    pages = chapters(report, EN).chapters
    (summary,) = (page for page in pages if page.title == "Summary")
    (own,) = (page for page in pages if page.verdict is not None)
    assert "WARNING" in repr(summary)
    assert own.verdict.word == "WARNING"
    assert said in repr(summary)
    assert said in repr(own)


def test_what_is_known_away_from_the_data_reaches_badge_and_tree(shown):
    document = shown.document
    found = prediction(3)
    worst = replace(found.left_out[0], rms=10 * 0.5)
    document.put_prediction(document.state.provenances[NAME], replace(found, left_out=(worst, *found.left_out[1:])))
    shown.idle()
    assert "10 ε" in str(shown.panels.verdict.text)
    assert shown.panels.verdict.lamps[2][0].name == "failed"
    assert "10 ε" in tree_row(shown).words


def test_another_control_error_is_another_verdict_without_a_fit(shown):
    document, surface = shown.document, shown.document.surface(NAME)
    strict = replace(document.settings(NAME), epsilon=0.001)
    shown.window.fitting.set_settings(NAME, strict)
    shown.idle()
    assert not document.stale(NAME)
    assert document.surface(NAME).surface is surface.surface
    assert shown.panels.verdict.text.splitlines()[0] == "FAIL"
    assert "FAIL" in tree_row(shown).aloud
    shown.window.session.stack.undo()
    shown.idle()
    assert shown.panels.verdict.text.splitlines()[0] == "WARNING"


def test_all_selected_rows_are_excluded_and_the_ring_stays(shown):
    table, view, document = shown.panels.residuals.table, shown.view, shown.document
    points = document.site.horizons[NAME]
    chosen = Row.of(points, 40)
    document.select(NAME, chosen)
    shown.idle()
    place = points.xyz[40]
    np.testing.assert_array_equal(view.pointer.ring.xyz, place)
    table.select([3, 40, 71])
    shown.trigger("exclude")
    shown.idle()
    excluded = document.state.excluded[NAME]
    assert {row.find(points) for row in excluded} == {3, 40, 71}
    np.testing.assert_array_equal(view.pointer.ring.xyz, place)
    assert shown.window.selecting.index() == 40
    assert set(table.selected) == {3, 40, 71}
    assert view.contents.listed[NAME].excluded.sum() == 3
    item = item_of(view, f"points:{NAME}")
    assert min(part.opacity for part in item.parts) < 0.5, "ghosts"
    shown.trigger("exclude")
    shown.idle()
    assert not document.state.excluded[NAME], "all of them were excluded: they take part again"
    shown.window.session.stack.undo()
    assert len(document.state.excluded[NAME]) == 3
    shown.window.session.stack.undo()
    assert not document.state.excluded.get(NAME)


def test_a_project_that_is_still_reading_says_so_and_locks_fit(shown, qtbot, tmp_path):
    window, panels = shown.window, shown.panels
    window.files.save_to(tmp_path / "dam.geofit")
    shown.idle()
    window.files.close()
    shown.idle()
    window.files.open(tmp_path / "dam.geofit")
    qtbot.waitUntil(lambda: shown.document.waiting(NAME) and "Reading" in str(panels.verdict.text), timeout=60_000)
    assert not window.actions_["fit"].isEnabled()
    assert not window.actions_["fit_all"].isEnabled()
    assert not panels.fit.fit_button.isEnabled()
    assert not panels.fit.all_button.isEnabled()
    assert "being read" in str(panels.fit.banner.text)
    assert "being read" in str(panels.residuals.pages.text)
    shown.idle()
    assert panels.verdict.text.splitlines()[0] == "PASS", "the file has the surface as it was fitted"
    assert window.actions_["fit"].isEnabled()
    assert panels.fit.fit_button.isEnabled()
    assert str(panels.residuals.pages.text) == ""


def test_stopping_the_reading_unlocks_fit(shown, qtbot, tmp_path):
    shown.window.files.save_to(tmp_path / "dam.geofit")
    shown.idle()
    shown.window.files.close()
    shown.idle()
    shown.window.files.open(tmp_path / "dam.geofit")
    qtbot.waitUntil(lambda: shown.document.waiting(NAME), timeout=60_000)
    shown.trigger("stop")
    shown.idle()
    assert shown.panels.fit.fit_button.isEnabled()
    assert "No surface yet" in str(shown.panels.verdict.text)


def test_files_go_beside_the_project_and_messages_name_the_whole_path(shown, qtbot, tmp_path, monkeypatch):
    from geofit.gui.dialogs.report import ReportDialog
    from geofit.gui.preferences import Preferences

    folder = tmp_path / "job"
    folder.mkdir()
    shown.window.files.save_to(folder / "dam.geofit")
    shown.idle()
    assert str(folder / "dam.geofit") in shown.window.statusBar().currentMessage()
    assert Preferences().folder == str(folder)
    seen = []

    def drive(dialog):
        seen.append((dialog.target if isinstance(dialog, ExportDialog) else dialog.folder).text())
        if isinstance(dialog, ExportDialog):
            qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
            qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
            seen.append(dialog.message.text())

    monkeypatch.setattr(ExportDialog, "exec", drive)
    monkeypatch.setattr(ReportDialog, "exec", drive)
    shown.trigger("export_step")
    shown.idle()
    shown.trigger("report")
    step = str(folder / f"{NAME}.step")
    assert seen[0] == step
    assert step in seen[1]
    assert step in shown.window.statusBar().currentMessage()
    assert seen[2] == str(folder / "report")
    assert step in shown.panels.log.text.toPlainText()


def test_status_bar_and_log_record_every_step(shown):
    log, bar, fitting = shown.panels.log.text, shown.window.statusBar(), shown.window.fitting
    assert f"Fit {NAME}: σ" in log.toPlainText()
    row = Row.of(shown.document.site.horizons[NAME], 3)
    fitting.exclude(NAME, [row])
    assert bar.currentMessage() == f"Exclude {row.file} row {row.row} from {NAME}"
    assert bar.currentMessage() in log.toPlainText()
    shown.window.session.stack.undo()
    assert bar.currentMessage().startswith("Undone: Exclude")
    shown.window.session.stack.redo()
    assert bar.currentMessage().startswith("Redone: Exclude")
    assert bar.currentMessage() in log.toPlainText()
    shown.window.session.stack.undo()
    shown.idle()
    fitting.move_to(NAME, row, 0.5)
    shown.idle()
    assert f"Move {NAME} to point" in log.toPlainText()


def test_one_switch_fades_what_no_data_support_in_view_and_section(shown, qtbot):
    panels, view, switch = shown.panels, shown.view, shown.window.actions_["faded"]
    panels.reveal("section")
    points = shown.document.site.horizons[NAME].xyz
    middle = points.mean(axis=0)
    panels.section.line_changed.emit(np.array([[middle[0] - 2000, middle[1]], [middle[0] + 2000, middle[1]]]))
    shown.window.showing.show_section()

    def styles():
        axes = panels.section.canvas.figure.axes
        colour = panels.section.data.colour(NAME)
        return {line.get_linestyle() for line in (axes[0].lines if axes else ()) if line.get_color() == colour}

    def opacities():
        item = item_of(view, f"surface:{NAME}")
        return [part.opacity for part in item.parts]

    qtbot.waitUntil(lambda: "--" in styles() and "-" in styles(), timeout=60_000)
    assert switch.isChecked()
    assert min(opacities()) < 0.5 < max(opacities())
    held = view.contents.drawn[NAME].supported[0]
    assert 0 < held.sum() < len(held)
    switch.trigger()
    qtbot.waitUntil(lambda: "--" not in styles(), timeout=60_000)
    assert min(opacities()) == 1.0
    switch.trigger()
    assert min(opacities()) < 0.5


def test_holes_show_their_lithology_in_view_and_section_in_the_same_colours(shown, qtbot):
    from geofit.report.section_pages import lithology_style
    from geofit.report.style import rgb
    from geofit.site.hole_logs import hole_intervals, log_files

    site, layers = shown.document.site, shown.view.layers
    table = log_files(site)[0]
    assert layers["holes"].choices == ("plain", *log_files(site))
    assert layers["holes"].colour_by == table
    boreholes = [hole for hole in site.holes if hole.kind == "borehole"]
    codes = sorted({one.code for hole in boreholes for one in hole_intervals(site, hole, table)})
    legend = layers["holes"].legend
    assert codes
    assert [swatch.text for swatch in legend.swatches] == codes
    every = sorted({str(code) for one in site.boreholes for log in one.logs for code in np.unique(log.code)})
    styles = lithology_style(every)
    assert [swatch.colour for swatch in legend.swatches] == [styles[code][0] for code in codes]
    item = item_of(shown.view, "holes")
    drawn = [tuple(round(255 * c) for c in part.actor.GetProperty().GetColor()) for part in item.parts[2:]]
    assert drawn == [rgb(styles[code][0]) for code in codes]
    layers.change("holes", colour_by="plain")
    assert layers["holes"].legend is None
    hole = max(boreholes, key=lambda one: len(list(hole_intervals(site, one, table))))
    x, y = hole.xyz[0, :2]
    shown.panels.reveal("section")
    shown.window.showing.line = np.array([[x - 200, y], [x + 200, y]])
    shown.window.showing.show_section()
    qtbot.waitUntil(lambda: bool(shown.panels.section.canvas.figure.axes), timeout=30_000)
    patches = shown.panels.section.canvas.figure.axes[0].patches
    assert len(patches) >= len(list(hole_intervals(site, hole, table)))
    hatches = {patch.get_hatch() or "" for patch in patches}
    assert hatches <= {pattern for _, pattern in styles.values()}

"""The way of a first user through the real windows, on the sample site, with no manual."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QDesktopServices

from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.report import ReportDialog


def drag(qtbot, view, start, end):
    """Drag from one place of the plan to another, both in map coordinates."""
    places = [QPoint(*(round(value) for value in view.to_widget(place).tolist())) for place in (start, end)]
    qtbot.mousePress(view, Qt.MouseButton.LeftButton, pos=places[0])
    qtbot.mouseMove(view, places[1])
    qtbot.mouseRelease(view, Qt.MouseButton.LeftButton, pos=places[1])


def export(qtbot, dialog, path):
    dialog.target.setText(str(path))
    qtbot.mouseClick(dialog.write, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: dialog._task is None, timeout=120_000)
    assert "Every check of the file holds" in dialog.message.text()


def report(qtbot, dialog, folder):
    dialog.language.setCurrentIndex(dialog.language.findData("zh"))
    for key, box in dialog.forms.items():
        box.setChecked(key == "html")
    dialog.examine.setChecked(False)
    dialog.folder.setText(str(folder))
    qtbot.mouseClick(dialog.write, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: dialog._task is None, timeout=180_000)


def test_the_way_of_a_first_user(app, qtbot, tmp_path, monkeypatch):
    window, document, panels = app.window, app.document, app.window.panels

    # Start: one button, and nothing that is of no use yet.
    assert panels.centre.currentWidget() is panels.start
    assert not window.actions_["fit"].isEnabled()
    from geofit.gui import files

    monkeypatch.setattr(files, "_documents", lambda: str(tmp_path))
    qtbot.mouseClick(panels.start.sample, Qt.MouseButton.LeftButton)
    app.idle()
    assert panels.centre.currentWidget() is panels.view
    assert document.horizons == ("T3-T2", "T2-T1", "W", "F1", "M1")
    assert not window.isWindowModified()

    # Choose a horizon in the tree, fit it.
    panels.tree.horizon_chosen.emit("T2-T1")
    app.idle()
    app.trigger("fit")
    app.idle()
    surface = document.surface("T2-T1")
    assert surface.accuracy.verdict == "PASS"
    assert "PASS" in panels.verdict.text
    assert window.isWindowModified()
    assert window.session.stack.undoText() == "Fit T2-T1"

    # The worst point: chosen in all windows, its file and row said.
    app.trigger("worst")
    app.idle()
    worst = surface.accuracy.worst[0]
    assert window.selecting.index() == worst
    assert surface.points.describe(worst) in window.statusBar().currentMessage()

    # Pull the surface there by hand; only the neighbourhood moves; undo.
    panels.adjust.pull_requested.emit(worst, 1.0)
    app.idle()
    pulled = document.surface("T2-T1")
    assert abs(pulled.accuracy.residuals[worst]) < 1e-9
    window.session.stack.undo()
    app.idle()
    assert document.surface("T2-T1") is surface
    window.session.stack.redo()
    app.idle()
    assert document.surface("T2-T1") is pulled

    # Another core, its corner dragged in plan, and taken back.
    panels.reveal("plan")
    qtbot.waitUntil(lambda: not panels.plan.view.visibleRegion().isEmpty())
    before = panels.plan.view.box.corners.copy()
    drag(qtbot, panels.plan.view, before[0], before[0] + (before[2] - before[0]) / 8)
    qtbot.mouseClick(panels.plan.buttons["use"], Qt.MouseButton.LeftButton)
    app.idle()
    assert document.stale("T2-T1")
    assert len(document.settings("T2-T1").core) == 4
    window.session.stack.undo()
    app.idle()
    assert not document.stale("T2-T1")

    # Exclude a row: the result is stale until it is fitted again.
    app.trigger("exclude")
    app.idle()
    assert document.stale("T2-T1")
    assert len(document.points("T2-T1")) == len(surface.points) - 1
    window.session.stack.undo()
    app.idle()
    assert not document.stale("T2-T1")

    # How far the rock may lie off the data; the seams, one of them gone to; a section across.
    app.trigger("examine")
    app.idle()
    assert "upper:T2-T1" in panels.view.layers
    panels.seams.seam_chosen.emit(0)
    assert "seams:T2-T1" in panels.view.layers
    window.actions_["section"].setChecked(True)
    qtbot.waitUntil(lambda: "T2-T1" in panels.section._data.traces and panels.section._task is None, timeout=60_000)

    # STEP, read back; a report in Chinese.
    monkeypatch.setattr(ExportDialog, "exec", lambda dialog: export(qtbot, dialog, tmp_path / "dam.step"))
    app.trigger("export_step")
    app.idle()
    tree = panels.checks.tree
    assert "STEP file read back" in [tree.topLevelItem(k).text(0) for k in range(tree.topLevelItemCount())]
    monkeypatch.setattr(ReportDialog, "exec", lambda dialog: report(qtbot, dialog, tmp_path / "out"))
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: True)
    app.trigger("report")
    assert "精度检验报告" in (tmp_path / "out" / "report.html").read_text("utf-8")

    # Save, close, open again: the surface is there, and can be adjusted further.
    project = tmp_path / "dam.geofit"
    window.files.save_to(project)
    app.idle()
    assert not window.isWindowModified()
    assert project.is_file()
    window.files.close()
    app.idle()
    assert panels.centre.currentWidget() is panels.start
    window.files.open(project)
    app.idle()
    again = document.surface("T2-T1")
    assert again.accuracy.sigma == pytest.approx(pulled.accuracy.sigma, abs=1e-9)
    assert again.model is not None
    assert document.selection.horizon == "T2-T1"
    assert not document.stale("T2-T1")
    assert not window.isWindowModified()
    assert window.preferences.recent[0] == project

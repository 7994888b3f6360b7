"""The way of a first user through the real windows, from tables as they come to STEP and report, with no manual."""

from __future__ import annotations

import csv

import pytest
from panel_samples import sample_site
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDesktopServices, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication

from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.wizard.import_wizard import ImportWizard
from geofit.gui.wizard.table_page import BAD
from geofit.project.provenance import Row

HOLES = 12


def write_tables(folder):
    """Write the tables of a site as they come: GB18030, a column that nobody can guess, a cell that is not a number."""
    points = sample_site().horizons["T2-T1"]
    folder.mkdir()
    with (folder / "contacts.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["x", "y", "z", "horizon", "kind", "hole", "section", "accuracy"])
        for k, (x, y, z) in enumerate(points.xyz):
            names = (points.kind[k], points.hole[k], points.section[k], points.accuracy[k])
            table.writerow([f"{x:.3f}", f"{y:.3f}", f"{z:.4f}", "T2-T1", *names])
    collars = [f"ZK{k},{500700 + 40 * k},{3100600 + 90 * (k % 4)},{1600 - k},120" for k in range(HOLES)]
    collars[2] = collars[2].replace("1598", "15g8")
    (folder / "钻孔.csv").write_text("\n".join(["孔号,甲,坐标Y,孔口高程,孔深", *collars]) + "\n", encoding="gb18030")
    log = [f"ZK{k},0,{4 + k % 3},Q\nZK{k},{4 + k % 3},120,T3" for k in range(HOLES)]
    (folder / "地层.csv").write_text("\n".join(["孔号,起始深度,终止深度,地层", *log]) + "\n", encoding="gb18030")
    (folder / "boundary.csv").write_text(
        "x,y\n" + "".join(f"{x:.2f},{y:.2f}\n" for x, y in sample_site().boundary), encoding="utf-8"
    )
    return sorted(folder.iterdir())


def drop(widget, files):
    """Let files fall on a widget, as from a file manager."""
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(file)) for file in files])
    how = (Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, QDragEnterEvent(QPoint(20, 20), *how))
    QApplication.sendEvent(widget, QDropEvent(QPointF(20, 20), *how))


def go_through(qtbot, wizard):
    """Settle what the wizard asks for, read, look at what was listed, and open the site."""

    def choose(box, value):
        box.setCurrentIndex(box.findData(value))
        box.activated.emit(box.currentIndex())
        qtbot.waitUntil(lambda: not wizard.running)

    wizard.show()
    qtbot.waitUntil(lambda: not wizard.running)
    page = wizard.page
    assert wizard.drafts()[wizard.list.currentRow()].title == "钻孔.csv", "the table to be settled is shown"
    assert "钻孔.csv" in wizard.message.text()
    assert not wizard.go.isEnabled()
    choose(page.kind, "collar")
    assert "Easting" in page.message.text()
    assert not wizard.go.isEnabled()
    choose(page.table.cellWidget(0, 1), "x")
    assert page.table.item(3, 3).text() == "15g8"
    assert page.table.item(3, 3).background().color().name() in BAD.values()
    assert wizard.go.isEnabled()
    qtbot.mouseClick(wizard.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: wizard.pages.currentIndex() == 1 and not wizard.running, timeout=30_000)
    listed = wizard.results.issues.rows.columns
    assert "15g8" in [listed[4].text(k) for k in range(wizard.results.issues.rows.total)]
    qtbot.mouseClick(wizard.go, Qt.MouseButton.LeftButton)
    return wizard.result()


def drag(qtbot, view, start, end):
    """Drag from one place of the plan to another, both in map coordinates."""
    places = [QPoint(*(round(value) for value in view.to_widget(place).tolist())) for place in (start, end)]
    qtbot.mousePress(view, Qt.MouseButton.LeftButton, pos=places[0])
    qtbot.mouseMove(view, places[1])
    qtbot.mouseRelease(view, Qt.MouseButton.LeftButton, pos=places[1])


def export(qtbot, dialog, path):
    dialog.target.setText(str(path))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert "The file passes every check" in dialog.message.text()


def report(qtbot, dialog, folder):
    dialog.language.setCurrentIndex(dialog.language.findData("zh"))
    for key, box in dialog.forms.items():
        box.setChecked(key == "html")
    dialog.examine.setChecked(False)
    dialog.folder.setText(str(folder))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=180_000)


def test_the_sample_site_is_one_button_away(app, qtbot, tmp_path, monkeypatch):
    from geofit.gui import files

    monkeypatch.setattr(files, "documents", lambda: str(tmp_path))
    qtbot.mouseClick(app.window.panels.start.sample, Qt.MouseButton.LeftButton)
    app.idle()
    assert app.document.horizons == ("T3-T2", "T2-T1", "W", "F1", "M1")


def test_the_way_of_a_first_user(app, qtbot, tmp_path, monkeypatch):
    window, document, panels = app.window, app.document, app.window.panels

    # Start: nothing that is of no use yet. Tables are dropped there, what is unclear is asked for, the site opens.
    assert panels.centre.currentWidget() is panels.start
    assert not window.actions_["fit"].isEnabled()
    monkeypatch.setattr(ImportWizard, "exec", lambda wizard: go_through(qtbot, wizard))
    drop(panels.start, write_tables(tmp_path / "tables"))
    app.idle()
    assert panels.centre.currentWidget() is panels.view
    assert document.horizons == ("base of Q", "T2-T1")
    assert len(document.site.holes) == HOLES - 1, "a collar was no number"
    assert len(document.points("T2-T1")) == 597
    assert not window.isWindowModified()

    # Choose a horizon in the tree, fit it.
    panels.tree.horizon_chosen.emit("T2-T1")
    app.idle()
    app.trigger("fit")
    app.idle()
    surface = document.surface("T2-T1")
    assert surface.accuracy.verdict == "PASS"
    assert panels.verdict.text.splitlines()[0] == "PASS", "not examined away from the data yet"
    assert window.isWindowModified()
    assert window.session.stack.undoText() == "Fit T2-T1"

    # The worst point: chosen in all windows, its file and row said.
    app.trigger("worst")
    app.idle()
    worst = surface.accuracy.worst[0]
    assert window.selecting.index() == worst
    assert str(surface.points.describe(worst)) in window.statusBar().currentMessage()

    # Pull the surface there by hand; only the neighbourhood moves; undo.
    panels.adjust.move_requested.emit(Row.of(surface.points, worst), 1.0)
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

    # How far the rock may lie away from the data; the seams, one of them gone to; a section across.
    app.trigger("examine")
    app.idle()
    assert "upper:T2-T1" in panels.view.layers
    panels.seams.seam_chosen.emit(0)
    assert "seams:T2-T1" in panels.view.layers
    window.actions_["section"].setChecked(True)
    qtbot.waitUntil(lambda: "T2-T1" in panels.section.data.traces and panels.section.idle, timeout=60_000)

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

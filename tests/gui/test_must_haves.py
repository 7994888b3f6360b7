"""The must-haves of the desktop application, each driven in its real window; details are in the other tests.

1 library without Qt; 2 import wizard; 3 import error table; 4 project tree; 5 scene list; 6 fit panel; 7 worker;
8 residual table linked with the view; 9 deviation map and badge; 10 undo; 11 project file; 12 recovery;
13 exaggeration; 14 section slicer; 15 local origin; 16 stitching view; 17 STEP export; 18 report; 19 languages;
20 error dialog, log, system report, OpenGL, scales and dark theme.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from panel_samples import SITE, fitted, prediction, sample_site
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.gui.panels.tree_model import SHOWN
from geofit.project.commands import SetSurface

NAME = "T3-T2"


@pytest.fixture
def shown(app):
    """The window with the sample site and one surface, as after a fit."""
    app.desktop.session.begin(sample_site(), SITE)
    document = app.document
    document.select(NAME)
    provenance = document.provenance(NAME)
    document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.panels, app.view = app.window.panels, app.window.panels.view
    app.view.canvas.land()
    return app


def only(view, *keys):
    for layer in view.layers:
        view.layers.change(layer.key, visible=layer.key in keys)


def settle(app):
    app.view.canvas.land()
    app.idle()
    app.qtbot.waitUntil(lambda: app.view.idle, timeout=10_000)


def pixel(view, xyz):
    return view.canvas.projector().screen(np.asarray(xyz, float)[None])[0, :2]


def seen_point(app):
    """A point whose middle is not covered by another, and its pixel, from above."""
    app.view.view("top")
    settle(app)
    places = app.view.canvas.projector().screen(fitted().points.xyz)
    apart = np.linalg.norm(places[:, None, :2] - places[None, :, :2], axis=2) + 1e9 * np.eye(len(places))
    index = int(apart.min(axis=1).argmax())
    return index, places[index, :2]


def click(view, place):
    QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(*(round(float(p)) for p in place)))


def test_01_the_library_needs_no_qt():
    code = (
        "import sys; sys.modules['PySide6'] = None\n"
        "import geofit, geofit.cli.main, geofit.fitting.pipeline, geofit.prediction.examine, geofit.site.separate\n"
        "import geofit.report.accuracy_report\n"
        "assert not [name for name in sys.modules if name.startswith('PySide6.')]"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_02_the_wizard_asks_for_roles_and_shows_bad_cells(app, qtbot, tmp_path):
    from geofit.gui.wizard.import_wizard import ImportWizard

    rows = "".join(f"ZK{i},{500 + 40 * i},{100 + i},{900 - i}.5,60\n" for i in range(6))
    (tmp_path / "孔.csv").write_bytes(
        ("孔号,坐标X,坐标Y,孔口高程,孔深\n" + rows + "ZK9,1,2,none,60\n").encode("gb18030")
    )
    wizard = ImportWizard([tmp_path / "孔.csv"], tmp_path, parent=app.window)
    qtbot.addWidget(wizard)
    wizard.show()
    qtbot.waitUntil(lambda: not wizard.running, timeout=30_000)
    (draft,) = wizard.drafts()
    assert draft.kind == "collar"
    table = wizard.page.table
    assert [table.cellWidget(0, k).currentData() for k in range(5)] == ["hole", "x", "y", "z", "depth"]
    box = table.cellWidget(0, 1)
    box.setCurrentIndex(box.findData(""))
    box.activated.emit(box.currentIndex())
    assert not wizard.go.isEnabled(), "easting is missing"
    wizard.reject()


def test_03_rows_read_are_rows_used_and_rows_listed(app, qtbot, tmp_path):
    from geofit.gui.dialogs.issues import IssuesDialog

    rows = [f"{x},{y},{0.1 * x:.2f},low" for x in range(0, 90, 20) for y in range(0, 90, 20)]
    (tmp_path / "p.csv").write_text("\n".join(["x,y,z,horizon", *rows, "5,5,none,low"]), encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "p.csv"\n', encoding="utf-8")
    app.window.files.open(tmp_path / "site.toml")
    app.idle()
    dialog = IssuesDialog(app.document.site)
    qtbot.addWidget(dialog)
    assert dialog.balance.text() == "Rows read: 26 = 25 used + 1 listed here."


def test_04_the_tree_has_holes_adits_sections_horizons_patches_and_reports(shown):
    tree = shown.panels.tree
    tree.show_reports(["report.html"])
    heads = tree.items.rows
    for word in ("Horizons", "Boreholes", "Adits", "Sections", "Reports"):
        assert any(head.text.startswith(word) for head in heads), word
    horizons = next(head for head in heads if head.text.startswith("Horizons"))
    below = next(row.rows for row in horizons.rows if row.text == NAME)
    assert sum(row.target[0] == "patch" for row in below) == len(fitted().patches)


def test_05_the_tree_hides_fades_colours_and_zooms(shown):
    tree, layers, key = shown.panels.tree, shown.view.layers, f"surface:{NAME}"
    tree.choose_layer(key)
    tree.form.opacity.setValue(40)
    assert layers[key].opacity == tree.row(key).opacity == 0.4
    tree.form.colour_by.setCurrentIndex(tree.form.colour_by.findData("dip"))
    tree.form.colour_by.activated.emit(tree.form.colour_by.currentIndex())
    assert layers[key].legend.unit == "°"
    eye = tree.items.index_of(tree.row(key)).siblingAtColumn(SHOWN)
    tree.items.setData(eye, Qt.CheckState.Unchecked, Qt.ItemDataRole.CheckStateRole)
    assert not layers[key].visible
    before = shown.view.canvas.target
    tree.zoom_requested.emit("points:F1")
    assert shown.view.canvas.target != before


def test_06_settings_that_were_applied_make_the_result_stale(shown):
    shown.window.fitting.set_settings(NAME, replace(shown.document.settings(NAME), interior_tolerance=0.3))
    shown.idle()
    assert shown.document.stale(NAME)
    assert "settings" in str(shown.panels.verdict.text).lower()
    shown.window.session.stack.undo()
    shown.idle()
    assert not shown.document.stale(NAME)


def test_07_work_tells_its_stages_and_can_be_stopped(shown, qtbot):
    document, bar = shown.document, shown.window.bar
    shown.window.fitting.set_settings(NAME, replace(document.settings(NAME), interior_tolerance=0.3))
    shown.window.fitting.fit(NAME)
    assert bar.progress.isVisible()
    assert shown.window.actions_["stop"].isEnabled()
    shown.trigger("stop")
    shown.idle()
    assert not bar.progress.isVisible()
    assert document.stale(NAME), "nothing was fitted"


def test_08_table_and_view_choose_the_same_point(shown, qtbot):
    only(shown.view, f"points:{NAME}")
    index, place = seen_point(shown)
    click(shown.view, place)
    assert shown.window.selecting.index() == index
    worst = fitted().accuracy.worst[0]
    shown.panels.residuals.point_chosen.emit(_row(shown, worst))
    assert shown.window.selecting.index() == worst
    assert f"{fitted().points.xyz[worst, 2]:.2f} m" in str(shown.view.pointer.ring.text)


def test_09_the_badge_and_the_bands_say_what_the_check_says(shown):
    accuracy, text = fitted().accuracy, shown.panels.verdict.text
    assert str(text).startswith("PASS")
    for figure in (f"{accuracy.sigma:.3g}", f"{accuracy.epsilon:g}"):
        assert figure in str(text)
    key = f"points:{NAME}"
    shown.view.layers.change(key, colour_by="deviation")
    words = [swatch.text for swatch in shown.view.layers[key].legend.swatches]
    assert any("0.1" in word for word in words)
    assert any("0.5" in word for word in words)


def test_10_every_change_has_a_name_and_can_be_undone(shown):
    stack, first = shown.window.session.stack, shown.document.state
    shown.window.fitting.set_core(NAME, "none")
    shown.window.fitting.exclude(NAME, [_row(shown, 3)])
    assert stack.undoText() == f"Exclude {fitted().points.file[3]} row {fitted().points.row[3]} from {NAME}"
    stack.undo()
    assert stack.undoText() == f"Core of {NAME}"
    stack.undo()
    assert shown.document.state == first
    stack.redo()
    assert shown.document.settings(NAME).core == "none"


def _row(app, index):
    from geofit.project.provenance import Row

    return Row.of(fitted().points, index)


def test_11_the_project_is_versioned_text_and_the_title_says_what_is_unsaved(shown, tmp_path):
    assert shown.window.isWindowModified()
    project = tmp_path / "dam.geofit"
    shown.window.files.save_to(project)
    shown.idle()
    assert not shown.window.isWindowModified()
    text = project.read_text("utf-8")
    assert "version" in str(text)
    assert len(text.splitlines()) > 20, "lines that can be compared"
    assert not list(tmp_path.glob("*.tmp*"))


def test_12_what_was_done_is_in_the_journal_before_the_next_thing(shown):
    (journal,) = shown.window.session.folder.glob("*.journal")
    shown.window.fitting.set_core(NAME, "all")
    last = journal.read_bytes().splitlines()[-1].partition(b" ")[2]
    assert json.loads(last)["do"] == {"kind": "core", "horizon": NAME, "core": "all"}


def test_13_exaggeration_is_in_the_corner_and_in_no_number(shown, qtbot):
    only(shown.view, f"points:{NAME}", f"surface:{NAME}")
    index = seen_point(shown)[0]
    xyz, told = fitted().points.xyz[index], []
    for factor in (1.0, 5.0):
        shown.view.set_exaggeration(factor)
        index, place = seen_point(shown)
        click(shown.view, place)
        shown.view.canvas.hovered.emit(_float(place))
        qtbot.wait(80)
        told.append((shown.view.pointer.ring.text, shown.window.selecting.index(), shown.view.pointer.place_at(*place)))
        assert f"{factor:g}×" in shown.view.content(shown.view.canvas.projector()).note
    assert told[0][:2] == told[1][:2]
    assert f"{xyz[2]:.2f} m" in told[0][0]
    np.testing.assert_allclose(told[0][2], told[1][2], atol=0.5)


def _float(place):
    from PySide6.QtCore import QPointF

    return QPointF(*(float(p) for p in place))


def test_14_the_slicer_cuts_at_any_azimuth(shown, qtbot):
    shown.panels.reveal("section")
    shown.actions = shown.window.actions_
    shown.actions["section"].setChecked(True)
    panel = shown.panels.section
    panel.azimuth.setValue(37.0)
    panel.thickness.setValue(80.0)
    qtbot.waitUntil(lambda: panel.data.traces.get(NAME) is not None and panel.idle, timeout=60_000)
    line = np.asarray(panel.line)
    east, north = line[-1] - line[0]
    assert np.degrees(np.arctan2(east, north)) % 180 == pytest.approx(37.0, abs=0.1)
    assert shown.window.showing.thickness == 80.0
    assert shown.view.handles()


def test_15_coordinates_of_millions_of_metres_are_exact(shown):
    only(shown.view, f"points:{NAME}")
    index, place = seen_point(shown)
    assert fitted().points.xyz[index, 1] > 3e6
    hit = shown.view.pointer.pick(*place)
    assert hit is not None
    np.testing.assert_array_equal(hit.xyz, fitted().points.xyz[index])
    shown.window.bar.show_place(*fitted().points.xyz[index])
    assert f"N {fitted().points.xyz[index, 1]:.2f}" in shown.window.bar.place.text()
    assert np.abs(shown.view.canvas.origin - fitted().points.xyz[index]).max() < 1e4


def test_16_seams_are_listed_coloured_and_gone_to(shown):
    seams = shown.panels.seams
    assert seams.table.rows.total == len(fitted().accuracy.seams) > 0
    before = shown.view.canvas.target.centre.copy()
    seams.seam_chosen.emit(0)
    assert f"seams:{NAME}" in shown.view.layers
    assert shown.view.layers[f"seams:{NAME}"].legend is not None
    assert not np.allclose(shown.view.canvas.target.centre, before)


def test_17_what_the_export_read_back_stands_in_the_checks(shown, qtbot, tmp_path, monkeypatch):
    from geofit.gui.dialogs.export_step import ExportDialog

    def drive(dialog):
        dialog.target.setText(str(tmp_path / "dam.step"))
        dialog.unit.setCurrentIndex(dialog.unit.findData("mm"))
        qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)

    monkeypatch.setattr(ExportDialog, "exec", drive)
    shown.trigger("export_step")
    shown.idle()
    assert (tmp_path / "dam.step").is_file()
    tree = shown.panels.checks.tree
    assert "STEP file read back" in [tree.topLevelItem(k).text(0) for k in range(tree.topLevelItemCount())]
    rows = tree.topLevelItemCount()
    result = shown.window.delivering.result(NAME, shown.document.surface(NAME))
    shown.desktop.change_language("zh_CN")
    shown.idle()
    assert shown.window.panels.checks.tree.topLevelItemCount() == rows
    again = shown.window.delivering.result(NAME, shown.document.surface(NAME))
    assert again.read_back is result.read_back is not None


def test_18_the_report_has_figures_and_hashes_and_is_listed(shown, qtbot, tmp_path, monkeypatch):
    from PySide6.QtGui import QDesktopServices

    from geofit.gui.dialogs.report import ReportDialog

    def drive(dialog):
        for key, box in dialog.forms.items():
            box.setChecked(key == "html")
        dialog.examine.setChecked(False)
        dialog.folder.setText(str(tmp_path / "out"))
        qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: not dialog.running, timeout=180_000)

    monkeypatch.setattr(ReportDialog, "exec", drive)
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: True)
    shown.trigger("report")
    html = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert NAME in html
    assert any(digest[:12] in html for digest in sample_site().inputs.values())
    heads = [head.text for head in shown.panels.tree.items.rows]
    assert any(head.startswith("Reports") for head in heads)


def test_19_another_language_is_spoken_at_run_time(shown):
    work = shown.document.state
    shown.desktop.change_language("zh_CN")
    shown.idle()
    assert shown.window.menuBar().actions()[0].text() != "&File"
    assert shown.document.state is work
    shown.desktop.change_language("en")
    shown.idle()
    assert shown.window.menuBar().actions()[0].text() == "&File"


def test_20_errors_say_what_to_do_and_the_dark_theme_reaches_the_view(shown, qtbot, qapp):
    from geofit.gui.dialogs.error import ErrorDialog
    from geofit.gui.dialogs.system_report import system_report
    from geofit.gui.theme import apply_theme

    dialog = ErrorDialog(
        "Open a.csv",
        InputError(
            message("io.file-empty", "The file is empty"), message("test.text", "Choose another."), file="a.csv"
        ),
    )
    qtbot.addWidget(dialog)
    assert dialog.message.text().endswith("Choose another.")
    assert "OpenGL: " in system_report()
    try:
        apply_theme(qapp, "dark")
        shown.idle()
        assert sum(shown.view.canvas.renderer.GetBackground()) < 1.0
    finally:
        apply_theme(qapp, "light")


def test_standard_deviation_and_bounds_come_with_the_examination(shown):
    document = shown.document
    found = replace(prediction(3), left_out=())
    document.put_prediction(document.state.provenances[NAME], found)
    shown.idle()
    layers = shown.view.layers
    assert "standard deviation" in layers[f"surface:{NAME}"].choices
    assert f"upper:{NAME}" in layers
    assert f"lower:{NAME}" in layers
    if found.suggestions:
        assert not layers[f"suggestions:{NAME}"].visible
        hole = found.suggestions[0]
        shown.panels.prediction.suggestion_chosen.emit(hole.x, hole.y, hole.z)
        assert layers[f"suggestions:{NAME}"].visible

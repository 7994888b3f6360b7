"""Bodies in the window: source, fit, stop, verdict, figures, section, tree, undo, export, project file, recovery."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from chinese import english_left
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QColorDialog, QFileDialog, QInputDialog

from geofit.bodies.settings import BodySettings
from geofit.bodies.violations import Violation
from geofit.data.messages import message
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.dialogs.step_fields import BodyStepDialog
from geofit.gui.panels.tree_model import SHOWN
from geofit.project.body_record import BodyStyle, Intervals, SurfacePicks
from geofit.project.journal import unfinished

ORE = Intervals(("ORE",), "bodies.toml")


@pytest.fixture
def opened(app, sample):
    app.window.files.open(sample / "site.toml")
    app.idle()
    app.panels, app.bodies = app.window.panels, app.window.bodies
    app.panels.reveal("bodies")
    return app


@pytest.fixture
def with_ore(opened, once):
    with once("fit ORE"):
        opened.bodies.fit("", ORE, BodySettings(realizations=20))
        opened.idle()
    return opened


def tree_bodies(app):
    """Return the texts of the bodies in the tree."""
    return [row.text for row in app.panels.tree.items.all() if row.target[0] == "body"]


def tree_item(app, name):
    (row,) = (row for row in app.panels.tree.items.all() if row.text == name)
    return row


def set_checked(app, name, on):
    items = app.panels.tree.items
    state = Qt.CheckState.Checked if on else Qt.CheckState.Unchecked
    eye = items.index_of(tree_item(app, name)).siblingAtColumn(SHOWN)
    assert items.setData(eye, state, Qt.ItemDataRole.CheckStateRole)


def check(app, code):
    codes = app.panels.bodies.source.codes
    found = [codes.item(i) for i in range(codes.count()) if codes.item(i).data(Qt.ItemDataRole.UserRole) == code]
    found[0].setCheckState(Qt.CheckState.Checked)


def choose_kind(app, kind):
    box = app.panels.bodies.source.kind
    box.setCurrentIndex(box.findData(kind))
    box.activated.emit(box.currentIndex())


def click(app, button):
    app.qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def test_a_first_body_from_another_site_file_through_the_panel(opened, sample, monkeypatch):
    panel = opened.panels.bodies
    assert panel.list.currentText() == "New body"
    assert not panel.fit_button.isEnabled()
    assert "Choose the codes" in panel.banner.text
    assert not any(label.text() for label in panel.form.errors.values())
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(sample / "bodies.toml"), ""))
    choose_kind(opened, "other")
    opened.idle()
    assert panel.source.codes.count() >= 3
    check(opened, "ORE")
    assert panel.fit_button.isEnabled()
    panel.form.fields["epsilon"].edit.setText("0.25")
    panel.form.changed.emit()
    click(opened, panel.fit_button)
    opened.idle()
    record = opened.document.state.bodies["ORE"]
    assert record.provenance.source == ORE
    assert record.provenance.settings.epsilon == 0.25
    result = opened.document.body("ORE")
    assert result.accuracy.verdict == "PASS"
    assert result.verdict.away.level == "warning"
    for said in ("WARNING", "left-out error"):
        assert said in panel.badge.text
    assert str(result.verdict.away.text) in panel.badge.text
    (row,) = (row for row in opened.panels.tree.items.all() if row.target == ("body", "ORE"))
    assert str(result.verdict.away.text) in row.words
    assert "0.25" in panel.badge.text
    assert panel.list.currentText() == "ORE"
    assert tree_bodies(opened) == ["ORE"]
    layers = opened.panels.view.layers
    assert layers["body:ORE"].colour == record.style.colour
    assert layers["body data:ORE"].visible
    assert "ORE: WARNING" in opened.window.statusBar().currentMessage()
    volumes = opened.panels.body_figures.volumes.rows
    cells = [volumes.index(0, k).data() for k in range(volumes.columnCount())]
    assert cells[0] == "whole body"
    fitted, low, _, high = (float(cell.replace("\N{NO-BREAK SPACE}", "")) for cell in cells[2:6])
    assert low < fitted < high
    assert "No violations: 60 contacts" in opened.panels.body_figures.count.text()


def test_a_body_of_the_sites_own_codes_goes_stale_with_its_form(opened):
    panel = opened.panels.bodies
    check(opened, "强风化")
    panel.title.setText("风化带")
    click(opened, panel.fit_button)
    opened.idle()
    assert list(opened.document.state.bodies) == ["风化带"]
    assert opened.document.body("风化带").fitted.name == "风化带"
    assert not opened.bodies.showing.stale("风化带")
    assert panel.banner.text == ""
    check(opened, "弱风化")
    assert "Not fitted with these settings yet" in panel.banner.text
    panel.form.fields["epsilon"].edit.setText("-1")
    panel.form.changed.emit()
    assert "Control error ε" in panel.form.errors["epsilon"].text()
    assert not panel.fit_button.isEnabled()


def test_a_new_body_may_not_take_a_name_that_is_taken(with_ore):
    panel = with_ore.panels.bodies
    panel.chosen.emit("")
    with_ore.idle()
    check(with_ore, "T1")
    panel.title.setText("ORE")
    panel.title.textEdited.emit("ORE")
    assert "already" in panel.banner.text
    assert not panel.fit_button.isEnabled()
    with_ore.bodies.fit("", ORE, BodySettings(realizations=20))
    with_ore.idle()
    assert list(with_ore.document.state.bodies) == ["ORE", "ORE 2"]


def test_stop_leaves_the_document_as_it_was(opened):
    panel = opened.panels.bodies
    opened.bodies.fit("", ORE, BodySettings(realizations=5000))
    opened.qtbot.waitUntil(panel.stop.isVisible, timeout=20_000)
    assert not panel.fit_button.isVisible()
    click(opened, panel.stop)
    opened.idle()
    assert opened.document.state.bodies == {}
    assert not panel.stop.isVisible()
    assert panel.fit_button.isVisible()
    assert not opened.document.dirty


def test_fit_rename_style_and_delete_are_undone_and_done_again(with_ore, monkeypatch):
    document, stack = with_ore.document, with_ore.desktop.session.stack
    fitted = document.state
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("矿体", True))
    with_ore.panels.bodies.rename_requested.emit("ORE")
    with_ore.idle()
    assert tree_bodies(with_ore) == ["矿体"]
    assert "body:矿体" in with_ore.panels.view.layers
    assert "body:ORE" not in with_ore.panels.view.layers
    monkeypatch.setattr(QColorDialog, "getColor", lambda *_: QColor("#123456"))
    menu = with_ore.bodies.styles.menu_for("矿体")
    next(action for action in menu.actions() if action.text() == "Colour…").trigger()
    next(action for action in menu.actions() if action.text() == "Show").setChecked(False)
    with_ore.idle()
    assert document.state.bodies["矿体"].style == BodyStyle("#123456", 1.0, False)
    assert not with_ore.panels.view.layers["body:矿体"].visible
    next(action for action in menu.actions() if action.text() == "Delete").trigger()
    with_ore.idle()
    assert document.state.bodies == {}
    assert tree_bodies(with_ore) == []
    assert with_ore.panels.view.bodies.names == ()
    names = [stack.text(k) for k in range(stack.count())]
    assert names[0] == "Fit body ORE"
    assert names[-1] == "Delete body 矿体"
    while stack.canUndo() and document.state != fitted:
        stack.undo()
    with_ore.idle()
    assert tree_bodies(with_ore) == ["ORE"]
    # What was fitted is on the shelf: nothing is fitted again.
    assert document.body("ORE").origin == "fitted"
    stack.undo()
    with_ore.idle()
    assert document.state.bodies == {}
    assert not document.dirty
    while stack.canRedo():
        stack.redo()
    with_ore.idle()
    assert document.state.bodies == {}


def test_eye_and_opacity_in_the_tree_change_the_style(with_ore):
    document, layers = with_ore.document, with_ore.panels.view.layers
    set_checked(with_ore, "ORE", False)
    with_ore.idle()
    assert not layers["body:ORE"].visible
    assert not document.state.bodies["ORE"].style.visible
    with_ore.panels.tree.choose_layer("body:ORE")
    for value in (80, 60, 40):
        with_ore.panels.tree.form.opacity.setValue(value)
    layers.change("body:ORE", visible=True)
    with_ore.qtbot.waitUntil(lambda: document.state.bodies["ORE"].style.opacity == 0.4, timeout=5_000)
    with_ore.idle()
    assert tree_item(with_ore, "ORE").checked
    # One step for a slider that was dragged.
    assert with_ore.desktop.session.stack.count() == 3
    tree = with_ore.panels.tree
    with_ore.qtbot.waitUntil(lambda: tree.view.visualRect(_index(with_ore, "ORE")).isValid())
    assert tree.body_at(tree.view.visualRect(_index(with_ore, "ORE")).center()) == "ORE"
    assert tree.body_at(QPoint(-5, -5)) is None


def _index(app, name):
    tree = app.panels.tree
    return tree.shown.mapFromSource(tree.items.index_of(tree_item(app, name)))


def test_choosing_a_body_in_the_tree_shows_it_in_the_panel(with_ore):
    with_ore.bodies.fit("", Intervals(("VOID",), "bodies.toml"), BodySettings(realizations=20))
    with_ore.idle()
    assert with_ore.panels.bodies.name == "VOID"
    with_ore.panels.tree.view.setCurrentIndex(_index(with_ore, "ORE"))
    with_ore.idle()
    assert with_ore.panels.bodies.name == "ORE"
    colours = {record.style.colour for record in with_ore.document.state.bodies.values()}
    assert len(colours) == 2


def test_the_section_cuts_bodies_with_contacts_and_intervals(with_ore):
    result = with_ore.document.body("ORE")
    middle = result.fitted.data.contacts.mean(axis=0)
    with_ore.window.showing.line = middle[:2] + np.array([[-300.0, 0.0], [300.0, 0.0]])
    with_ore.trigger("section")
    with_ore.window.showing.show_section()
    with_ore.qtbot.waitUntil(lambda: with_ore.panels.section.idle)
    panel = with_ore.panels.section
    panel.canvas.draw()
    axes = panel.canvas.figure.axes[0]
    names = axes.get_legend_handles_labels()[1]
    assert "ORE" in names
    outlines = [one for one in axes.patches if one.get_label() == "ORE"]
    assert len(outlines) == 1
    path = outlines[0].get_path().vertices
    # The outline lies on the surface of the body.
    line = panel.line
    way = (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    xyz = np.column_stack([line[0] + path[:, :1] * way, path[:, 1]])
    assert np.abs(result.fitted.distance(xyz)).max() < 0.6
    near = with_ore.window.showing.thickness / 2
    contacts = result.fitted.data.contacts
    seen = np.abs((contacts[:, :2] - line[0]) @ [way[1], -way[0]]) <= near
    drawn = [one for one in axes.lines if one.get_marker() == "o" and len(one.get_xdata()) == seen.sum()]
    assert drawn
    set_checked(with_ore, "ORE", False)
    with_ore.idle()
    panel.canvas.draw()
    assert "ORE" not in panel.canvas.figure.axes[0].get_legend_handles_labels()[1]


def previewed(app):
    """Wait for the preview, and return it."""
    section = app.panels.section
    app.qtbot.waitUntil(lambda: section.preview is not None and app.bodies.preview.idle, timeout=60_000)
    return section.preview


def test_the_section_follows_settings_that_are_not_fitted_yet(with_ore):
    panel, section = with_ore.panels.bodies, with_ore.panels.section
    result = with_ore.document.body("ORE")
    middle = result.fitted.data.contacts.mean(axis=0)
    with_ore.window.showing.line = middle[:2] + np.array([[-300.0, 0.0], [300.0, 0.0]])

    def edit(name, value):
        panel.form.fields[name].put(value)
        panel.form.changed.emit()

    edit("ranges", (4.0, 1.0, 1.0))
    # Nothing is fitted for a section that nobody sees.
    with_ore.qtbot.wait(600)
    assert section.preview is None
    with_ore.trigger("section")
    with_ore.window.showing.show_section()
    first = previewed(with_ore)
    assert first.dashed
    assert first.mesh.is_closed
    section.canvas.draw()
    axes = section.canvas.figure.axes[0]
    assert {"ORE", first.name} <= set(axes.get_legend_handles_labels()[1])
    # A further change stops the fit under way: only the last one is shown.
    edit("ranges", (1.0, 1.0, 4.0))
    with_ore.qtbot.waitUntil(lambda: not with_ore.bodies.preview.idle)
    edit("ranges", (1.0, 4.0, 1.0))
    with_ore.qtbot.waitUntil(lambda: section.preview is not first, timeout=60_000)
    second = previewed(with_ore)
    assert abs(second.mesh.volume / first.mesh.volume - 1) > 1e-3
    assert with_ore.document.body("ORE") is result
    assert not with_ore.window.activity.busy
    # Back at the settings of the fit there is nothing to preview.
    edit("ranges", (1.0, 1.0, 1.0))
    assert section.preview is None
    section.canvas.draw()
    assert second.name not in section.canvas.figure.axes[0].get_legend_handles_labels()[1]
    # Settings that cannot be fitted say why where the preview would be.
    edit("box", ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    with_ore.qtbot.waitUntil(lambda: "box" in section.state.text(), timeout=60_000)
    assert section.preview is None


def test_violations_and_holes_find_each_other(with_ore):
    document, figures, view = with_ore.document, with_ore.panels.body_figures, with_ore.panels.view
    result, provenance = document.body("ORE"), document.state.bodies["ORE"].provenance
    data = result.fitted.data
    words = message("bodies.logged-inside-lies-outside", "logged inside, lies outside")
    found = tuple(
        Violation("sample", str(data.inside_hole[i]), tuple(data.inside[i].tolist()), 0.5, 2.0, words) for i in (0, 40)
    )
    document.put_body(provenance, replace(result, violations=found))
    with_ore.idle()
    assert figures.violations.isVisibleTo(figures)
    assert "Violations: 2" in figures.count.text()
    figures.violations.chosen.emit(1)
    with_ore.idle()
    assert found[1].hole in view.pointer.ring.text
    np.testing.assert_allclose(view.pointer.ring.xyz, found[1].place)
    view.hole_picked.emit(found[0].hole)
    assert figures.violations.current == 0
    view.hole_picked.emit("no such hole")
    assert figures.violations.current == 0


def test_volumes_are_divided_by_the_horizons_that_reach_over_the_body(with_ore):
    figures = with_ore.panels.body_figures
    assert not figures.strata.isVisibleTo(figures)
    with_ore.window.fitting.fit("T2-T1")
    with_ore.idle()
    assert figures.strata.isVisibleTo(figures)
    with_ore.panels.reveal("body_figures")
    click(with_ore, figures.strata)
    with_ore.idle()
    result = with_ore.document.body("ORE")
    assert result.divided_by == ("T2-T1",)
    assert sum(part.volumes.best for part in result.strata) == pytest.approx(result.volume, rel=1e-6)
    assert figures.volumes.rows.rowCount() == 3
    assert not figures.strata.isVisibleTo(figures)


@pytest.mark.parametrize("ending", [".stl", ".ply", ".vtp", ".csv", ".vti", ".step"])
def test_export_writes_what_the_ending_says(with_ore, tmp_path, ending):
    with_ore.bodies.export("ORE", tmp_path / f"ore{ending}")
    with_ore.idle()
    assert (tmp_path / f"ore{ending}").stat().st_size > 1000
    assert f"ore{ending}" in with_ore.window.statusBar().currentMessage()
    if ending == ".step":
        assert "Read back" in with_ore.window.statusBar().currentMessage()
    if ending == ".ply":
        from geofit.io import read_body

        assert read_body(tmp_path / "ore.ply").volume == pytest.approx(with_ore.document.body("ORE").mesh.volume)


def test_a_closed_mesh_is_a_body_without_a_verdict(with_ore, tmp_path):
    with_ore.bodies.export("ORE", tmp_path / "lens.ply")
    with_ore.idle()
    with_ore.bodies.take_mesh(tmp_path / "lens.ply")
    with_ore.idle()
    panel = with_ore.panels.bodies
    assert panel.name == "lens"
    assert not panel.badge.isVisibleTo(panel)
    assert not panel.form.isVisibleTo(panel)
    assert panel.fit_button.text() == "Read"
    assert "Nothing was fitted" in with_ore.panels.body_figures.count.text()
    with_ore.bodies.export("lens", tmp_path / "lens.step")
    with_ore.idle()
    assert (tmp_path / "lens.step").is_file()
    with_ore.bodies.export("lens", tmp_path / "lens.csv")
    with_ore.qtbot.waitUntil(lambda: bool(with_ore.failures), timeout=30_000)
    assert "block model" in str(with_ore.failures.pop())


def test_a_saved_project_opens_with_its_bodies_and_tells_read_from_made_again(with_ore, tmp_path, sample):
    for name in ("bodies", "bodies.toml"):
        source = sample / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, tmp_path / name)
    set_checked(with_ore, "ORE", False)
    with_ore.idle()
    before = with_ore.document.state
    path = tmp_path / "dam.geofit"
    with_ore.window.files.save_to(path)
    with_ore.idle()
    assert json.loads(path.read_text("utf-8"))["version"] == 4
    seen = []
    with_ore.window.files.open(path)
    with_ore.document.bodies_changed.connect(lambda: seen.append(with_ore.document.body("ORE").origin))
    with_ore.idle()
    assert seen[0] == "read back"
    assert with_ore.document.state.bodies == before.bodies
    result = with_ore.document.body("ORE")
    assert result.origin == "again"
    assert result.difference == 0
    assert "the same as the project's file" in with_ore.panels.bodies.origin.text()
    assert not with_ore.panels.view.layers["body:ORE"].visible
    assert not with_ore.document.dirty


def test_bodies_whose_data_changed_stay_as_they_were_saved_and_say_so(app, tmp_path, sample, once):
    folder = tmp_path / "site"
    shutil.copytree(sample, folder)
    app.window.files.open(folder / "site.toml")
    app.idle()
    app.panels, app.bodies = app.window.panels, app.window.bodies
    with once("fit ORE"):
        app.bodies.fit("", ORE, BodySettings(realizations=20))
        app.idle()
    app.window.files.save_to(folder / "dam.geofit")
    app.idle()
    log = folder / "bodies" / "lithology.csv"
    text = log.read_text("utf-8-sig")
    log.write_text(re.sub(r"ORE", "GANGUE", text, count=1), encoding="utf-8")
    app.window.files.open(folder / "dam.geofit")
    app.idle()
    assert app.document.body("ORE").origin == "read back"
    assert app.bodies.showing.stale("ORE")
    assert "data have changed" in app.panels.bodies.banner.text
    assert "body:ORE" in app.panels.view.layers
    click(app, app.panels.bodies.fit_button) if app.panels.bodies.fit_button.isVisible() else app.bodies.fit(
        "ORE", ORE, BodySettings(realizations=20)
    )
    app.idle()
    assert app.document.body("ORE").origin == "fitted"
    assert app.document.dirty


def test_a_body_of_few_contacts_warns_of_its_band_in_the_panel(opened, tmp_path):
    rows = ["x,y,z,nx,ny,nz"]
    for axis, half in enumerate((60, 45, 30)):
        for sign in (-1, 1):
            way = [0, 0, 0]
            way[axis] = sign
            place = [half * one for one in way]
            rows.append(",".join(map(str, (*place, *way))))
    (tmp_path / "few.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    panel = opened.panels.bodies
    opened.bodies.fit("few", SurfacePicks(str(tmp_path / "few.csv")), BodySettings(realizations=20))
    opened.idle()
    result = opened.document.body("few")
    assert [note.code for note in result.accuracy.warnings] == ["bodies.too-few-contacts-for-band"]
    assert "P10 to P90 is too narrow" in panel.warning.text
    assert not panel.warning.isHidden()
    panel.chosen.emit("")
    opened.idle()
    assert panel.warning.isHidden()


@pytest.fixture
def lens(app, tmp_path, once):
    """A site whose body is fitted to a file of points, which changes then; returns the file's path."""
    rng = np.random.default_rng(3)
    normal = rng.normal(size=(80, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    xyz = normal * (60, 45, 30) + (100, 100, 50)
    file = tmp_path / "lens.csv"
    rows = [",".join(f"{value:.3f}" for value in (*place, *way)) for place, way in zip(xyz, normal, strict=True)]
    file.write_text("x,y,z,nx,ny,nz\n" + "\n".join(rows) + "\n", encoding="utf-8")
    picks = [f"{10 * i},{10 * j},{100 + i - 0.5 * j},T2" for i in range(6) for j in range(6)]
    (tmp_path / "picks.csv").write_text("x,y,z,horizon\n" + "\n".join(picks) + "\n", encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "picks.csv"\n', encoding="utf-8")
    app.window.files.open(tmp_path / "site.toml")
    app.idle()
    app.panels, app.bodies = app.window.panels, app.window.bodies
    with once("fit lens"):
        app.bodies.fit("lens", SurfacePicks("lens.csv"), BodySettings(realizations=20))
        app.idle()
    app.bodies.watch.look()
    app.idle()
    assert not app.bodies.showing.stale("lens")
    file.write_text("x,y,z,nx,ny,nz\n" + "\n".join(rows[1:]) + "\n", encoding="utf-8")
    app.bodies.watch.look()
    app.idle()
    return file


def test_a_body_whose_file_changed_is_marked_in_the_tree_and_the_panel(app, lens):
    assert tree_bodies(app) == ["lens"]
    row = tree_item(app, "lens")
    assert row.italic
    assert "Changed: Data in lens.csv" in row.aloud
    assert "Changed: Data in lens.csv" in row.words
    assert "Changed: Data in lens.csv" in app.panels.bodies.banner.text
    assert "Older than its data" in app.panels.bodies.badge.text
    # The site is read again: that is about its own files, not about the body's.
    app.window.living.reload()
    app.idle()
    assert app.bodies.showing.stale("lens")
    app.bodies.fit("lens", SurfacePicks("lens.csv"), BodySettings(realizations=20))
    app.idle()
    assert tree_bodies(app) == ["lens"]
    assert app.panels.bodies.banner.text == ""


def test_what_is_written_of_a_stale_body_says_so(app, lens, tmp_path, monkeypatch):
    said, dialogs = [], []
    app.bodies.reported.connect(said.append)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / "lens.step"), ""))
    monkeypatch.setattr(BodyStepDialog, "exec", lambda dialog: bool(dialogs.append(dialog) or True))
    app.bodies.ask_export("lens")
    app.idle()
    (dialog,) = dialogs
    app.qtbot.addWidget(dialog)
    assert not dialog.warning.isHidden()
    assert "earlier data or settings): lens." in dialog.warning.text()
    assert "earlier data or settings): lens." in said[-1]
    pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
    certificate = pdfium.PdfDocument(tmp_path / "lens_certificate.pdf")
    text = " ".join(certificate[0].get_textpage().get_text_range().split())
    certificate.close()
    assert "(stale)" in text
    assert "earlier data or settings): lens." in text


def test_the_report_marks_a_stale_body_and_lists_what_changed(app, lens, tmp_path, monkeypatch, write_report):
    app.window.fitting.fit("T2")
    app.idle()
    dialogs = []
    monkeypatch.setattr(ReportDialog, "exec", lambda dialog: dialogs.append(dialog))
    app.window.delivering.report()
    (dialog,) = dialogs
    app.qtbot.addWidget(dialog)
    assert "Bodies: lens (stale)" in dialog.message.text()
    assert "earlier data or settings): lens." in dialog.message.text()
    write_report(dialog, tmp_path / "out", "html")
    assert "earlier data or settings): lens." in dialog.message.text()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    # On the cover, among the limits of use, and in the chapter of the body.
    assert text.count("earlier data or settings): lens.") == 3
    assert "Data in lens.csv at the fit" in text


def test_a_session_that_was_cut_off_brings_its_bodies_back(with_ore, tmp_path):
    state = with_ore.document.state
    (cut,) = unfinished(with_ore.killed(tmp_path / "killed"))
    assert cut.final == state
    with_ore.window.files.recover(cut)
    with_ore.idle()
    assert with_ore.document.state.bodies == state.bodies
    assert with_ore.document.body("ORE").origin == "again"
    assert with_ore.document.dirty


def test_the_report_has_a_chapter_of_the_body(with_ore, tmp_path):
    from geofit.project.fault_blocks import Blocks
    from geofit.project.reporting import write_report_files
    from geofit.report.result import HorizonResult

    with_ore.window.fitting.fit("T2-T1")
    with_ore.idle()
    document = with_ore.document
    results = [HorizonResult(s, document.site_in_use()) for s in document.surfaces().values()]
    made = write_report_files(
        results, document.blocks(), tmp_path, "en", ["html"], False, "2026-01-01", document.made_bodies(),
        progress=lambda *_: None,
    )  # fmt: skip
    assert isinstance(document.blocks(), Blocks)
    text = made.files["html"].read_text("utf-8")
    assert "Body ORE" in text
    assert "Violations" in text


def test_another_language_keeps_the_bodies_and_leaves_no_english(with_ore):
    with_ore.desktop.change_language("zh_CN")
    with_ore.idle()
    panels = with_ore.window.panels
    assert panels.bodies.name in ("", "ORE")
    panels.bodies.chosen.emit("ORE")
    with_ore.idle()
    words = [panels.bodies.badge.text, panels.body_figures.count.text(), panels.bodies.fit_button.text()]
    words += [panels.bodies.source.kind.itemText(k) for k in range(3)]
    assert not [left for text in words for left in english_left(text)]
    assert "body:ORE" in panels.view.layers
    with_ore.desktop.change_language("en")
    with_ore.idle()

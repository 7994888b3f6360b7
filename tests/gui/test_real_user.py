"""A first user's work on real drilling, through the windows alone: Copper Creek from three tables to section sheet,
STEP and report."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QDesktopServices

from geofit.cad.step import read_step
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.dialogs.section_sheet import SectionSheetDialog
from geofit.gui.wizard.import_wizard import ImportWizard

FOLDER = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[3] / "shared" / "data")) / "copper_creek"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the data of Copper Creek are not here")

COVER, BASEMENT, BODY = "base of the cover", "top of the granodiorite", "gdb"
#: Codes that are one bed each: overburden, unconsolidated and unlogged rock; the granodiorite with its porphyries.
GROUPS = {COVER: ("OvB", "NC", "NR"), BASEMENT: ("gd", "gdp", "gdp1", "gdp2", "gdp3", "gdb")}


def imported(qtbot, wizard):
    """Take what the wizard guesses, look at what it lists, group codes to two horizons, and open the site."""
    wizard.show()
    qtbot.waitUntil(lambda: not wizard.running, timeout=60_000)
    assert wizard.go.isEnabled(), wizard.message.text()
    qtbot.mouseClick(wizard.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: wizard.pages.currentIndex() == 1 and not wizard.running, timeout=60_000)
    assert wizard.results.issues.rows.total > 0, "39 collars are repeated: nothing is dropped silently"
    qtbot.mouseClick(wizard.build, Qt.MouseButton.LeftButton)
    build(wizard.horizons.form)
    assert [one.name for one in wizard.built] == [COVER, BASEMENT]
    qtbot.mouseClick(wizard.go, Qt.MouseButton.LeftButton)
    return wizard.result()


def build(form):
    """Group codes to two horizons; the second is the first contact from above, thin beds ignored."""
    form.check(*GROUPS[COVER])
    form.name.setText(COVER)
    form.name.textEdited.emit(COVER)
    assert len(form.picks.points) > 50
    form.add.click()
    form.check(*GROUPS[BASEMENT])
    form.limit.setCurrentIndex(form.limit.findData("top"))
    form.occurrence.setCurrentIndex(form.occurrence.findData("first"))
    form.thinner.setValue(3.0)
    form.name.setText(BASEMENT)
    form.name.textEdited.emit(BASEMENT)
    assert len(form.picks.points) > 50
    form.add.click()


def written(qtbot, dialog, path, words):
    """Name the file, write, and return what the dialog says."""
    dialog.show()
    dialog.target.setText(str(path))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=180_000)
    words.append(dialog.message.text())
    dialog.close()


def reported(qtbot, dialog, folder):
    """Write HTML, PDF and the plain data, without the examination away from the data, which takes minutes."""
    dialog.show()
    dialog.language.setCurrentIndex(dialog.language.findData("en"))
    for box in dialog.forms.values():
        box.setChecked(True)
    dialog.examine.setChecked(False)
    dialog.folder.setText(str(folder))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=600_000)
    dialog.close()


def test_copper_creek_from_tables_to_section_sheet_step_and_report(app, qtbot, tmp_path, monkeypatch):
    window, document, panels = app.window, app.document, app.window.panels
    tables = tmp_path / "tables"
    shutil.copytree(FOLDER, tables, ignore=lambda _, names: [name for name in names if not name.endswith(".csv")])

    # Import: every column is guessed; every hole that can be used is there; codes are grouped to two horizons.
    monkeypatch.setattr(ImportWizard, "exec", lambda wizard: imported(qtbot, wizard))
    window.files.import_files(sorted(tables.glob("*.csv")))
    app.idle()
    assert panels.centre.currentWidget() is panels.view
    assert len(document.site.holes) == 545
    assert {COVER, BASEMENT} <= set(document.horizons)

    # Fit, leave the worst point out, fit again.
    sigma = {}
    for name in (COVER, BASEMENT):
        panels.tree.horizon_chosen.emit(name)
        app.idle()
        qtbot.mouseClick(panels.fit.fit_button, Qt.MouseButton.LeftButton)
        app.idle()
        sigma[name] = document.surface(name).accuracy.sigma
    app.trigger("worst")
    app.trigger("exclude")
    app.idle()
    assert document.stale(BASEMENT)
    qtbot.mouseClick(panels.fit.fit_button, Qt.MouseButton.LeftButton)
    app.idle()
    assert not document.stale(BASEMENT)
    assert len(document.surface(BASEMENT).points) == len(document.listing(BASEMENT).points) - 1
    assert document.surface(BASEMENT).accuracy.sigma != sigma[BASEMENT]

    # A body from the site's own codes: coarse samples and few simulations, as for a first look.
    panels.reveal("bodies")
    codes = panels.bodies.source.codes
    (item,) = (codes.item(k) for k in range(codes.count()) if codes.item(k).data(Qt.ItemDataRole.UserRole) == BODY)
    item.setCheckState(Qt.CheckState.Checked)
    fields = panels.bodies.form.fields
    fields["step"].put(60.0)
    fields["reach"].put(150.0)
    fields["realizations"].put(10)
    panels.bodies.form.changed.emit()
    assert panels.bodies.fit_button.isEnabled(), panels.bodies.banner.text
    qtbot.mouseClick(panels.bodies.fit_button, Qt.MouseButton.LeftButton)
    app.idle(300)
    assert document.body(BODY) is not None
    assert panels.bodies.badge.text

    # A section sheet along the panel's line, STEP with its certificate.
    words = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: True)
    window.actions_["section"].setChecked(True)
    app.idle()
    monkeypatch.setattr(
        SectionSheetDialog, "exec", lambda dialog: written(qtbot, dialog, tmp_path / "sections.pdf", words)
    )
    app.trigger("section_sheet")
    assert (tmp_path / "sections.pdf").read_bytes().startswith(b"%PDF"), words
    monkeypatch.setattr(ExportDialog, "exec", lambda dialog: written(qtbot, dialog, tmp_path / "creek.step", words))
    app.trigger("export_step")
    app.idle()
    assert {COVER, BASEMENT} <= {*read_step(tmp_path / "creek.step")}
    assert (tmp_path / "creek_certificate.pdf").is_file()

    # The report: pages, and plain data that say what the windows say.
    monkeypatch.setattr(ReportDialog, "exec", lambda dialog: reported(qtbot, dialog, tmp_path / "report"))
    app.trigger("report")
    app.idle()
    folder = tmp_path / "report"
    page = (folder / "report.html").read_text("utf-8")
    assert all(name in page for name in (COVER, BASEMENT, BODY))
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF")
    data = json.loads((folder / "report.json").read_text("utf-8"))
    horizons = {one["horizon"]: one for one in data["horizons"]}
    assert set(horizons) == {COVER, BASEMENT}
    for name, one in horizons.items():
        accuracy = document.surface(name).accuracy
        assert one["n_points"] == accuracy.n
        assert one["sigma"] == pytest.approx(accuracy.sigma)
        assert one["max_abs"] == pytest.approx(accuracy.max_abs)
        assert one["read_back"] is not None, "the STEP file was written of this very surface"
    excluded = {name: len(one["excluded"]) for name, one in horizons.items()}
    assert excluded == {COVER: 0, BASEMENT: 1}, "the point that was left out is listed"
    assert {one["file"].split(" ")[0] for one in data["inputs"]} >= {path.name for path in FOLDER.glob("*.csv")}

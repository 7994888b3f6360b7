"""The report dialog: the forms and the language that were chosen, from the surfaces as they are."""

from __future__ import annotations

import json
import time

import pytest
from panel_samples import FAULT, fitted, sample_site
from PySide6.QtCore import QDate, Qt
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QLabel, QMessageBox

from geofit.data.progress import tell
from geofit.gui.dialogs import report
from geofit.gui.dialogs.report import ReportDialog
from geofit.report.result import HorizonResult


@pytest.fixture
def opened_files(monkeypatch):
    files = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: files.append(url.toLocalFile()))
    return files


def opened(qtbot, surface=None):
    site = sample_site()
    dialog = ReportDialog(site, [HorizonResult(surface or fitted(FAULT), site)])
    qtbot.addWidget(dialog)
    dialog.show()
    return dialog


def press(qtbot, dialog, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=180_000)


def test_the_report_in_chinese_with_its_date_and_what_was_examined(qtbot, tmp_path, opened_files):
    dialog = opened(qtbot)
    written, examined = [], {}
    dialog.written.connect(written.append)
    dialog.examined.connect(examined.__setitem__)
    dialog.language.setCurrentIndex(dialog.language.findData("zh"))
    dialog.forms["pdf"].setChecked(False)
    dialog.forms["json"].setChecked(True)
    dialog.date.setDate(QDate(2025, 3, 9))
    dialog.folder.setText(str(tmp_path / "out"))
    assert dialog.examine.isChecked(), "it came without a check off the data"
    press(qtbot, dialog, dialog.go)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["report.html", "report.json"]
    assert written == [tmp_path / "out" / "report.html"]
    assert opened_files == [str(written[0])]
    html = written[0].read_text("utf-8")
    assert "精度检验报告" in html
    assert "2025-03-09" in html
    data = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    assert data["horizons"][0]["sigma"] == pytest.approx(fitted(FAULT).accuracy.sigma)
    assert data["horizons"][0]["prediction"] is not None
    assert dialog.view.isVisible()
    assert [one.scheme for one in examined[FAULT].left_out] == [
        one["scheme"] for one in data["horizons"][0]["prediction"]["left_out"]
    ]
    assert not dialog.examine.isVisible(), "it is known now"


def test_of_a_surface_with_nothing_behind_it_nothing_is_handed_back(qtbot, tmp_path, opened_files):
    dialog = opened(qtbot, fitted(FAULT).with_(model=None))
    examined = []
    dialog.examined.connect(lambda *found: examined.append(found))
    dialog.folder.setText(str(tmp_path))
    for form, box in dialog.forms.items():
        box.setChecked(form == "json")
    press(qtbot, dialog, dialog.go)
    assert opened_files == [str(tmp_path / "report.json")]
    assert examined == []
    assert dialog.examine.isVisible()


def test_the_names_of_many_horizons_neither_widen_the_dialog_nor_cut_its_labels(qtbot, app):
    site, surface = sample_site(), fitted(FAULT)
    names = [f"Base of the weathered granodiorite & cover {k}" for k in range(25)]
    dialog = ReportDialog(site, [HorizonResult(surface.with_(name=name), site) for name in names])
    qtbot.addWidget(dialog)
    dialog.show()
    qtbot.waitExposed(dialog)
    assert dialog.width() <= 700
    labels = [label for label in dialog.findChildren(QLabel) if not label.wordWrap() and label.isVisible()]
    assert all(label.width() >= label.sizeHint().width() for label in labels)
    assert dialog.examine.width() >= dialog.examine.sizeHint().width()
    assert names[-1] in dialog.examine.toolTip()


def test_without_a_form_or_a_folder_nothing_can_be_written(qtbot):
    dialog = opened(qtbot)
    for box in dialog.forms.values():
        box.setChecked(False)
    assert not dialog.go.isEnabled()
    dialog.forms["html"].setChecked(True)
    assert dialog.go.isEnabled()
    dialog.folder.setText(" ")
    assert not dialog.go.isEnabled()


def test_a_folder_that_cannot_be_made_is_told(qtbot, tmp_path, opened_files):
    (tmp_path / "file").write_text("")
    dialog = opened(qtbot)
    dialog.examine.setChecked(False)
    dialog.folder.setText(str(tmp_path / "file" / "out"))
    press(qtbot, dialog, dialog.go)
    assert "folder cannot be made" in dialog.message.text()
    assert not opened_files
    assert not dialog.view.isVisible()


def test_a_report_that_is_there_is_replaced_only_by_consent(qtbot, tmp_path, opened_files, monkeypatch):
    asked, answer = [], QMessageBox.StandardButton.No
    monkeypatch.setattr(QMessageBox, "exec", lambda box: asked.append(box.text()) or answer)
    (tmp_path / "report.json").write_text("mine")
    dialog = opened(qtbot, fitted(FAULT).with_(model=None))
    dialog.examine.setChecked(False)
    dialog.folder.setText(str(tmp_path))
    for form, box in dialog.forms.items():
        box.setChecked(form == "json")
    press(qtbot, dialog, dialog.go)
    assert asked == ["report.json already exists. Replace it?"]
    assert (tmp_path / "report.json").read_text() == "mine"
    answer = QMessageBox.StandardButton.Yes
    press(qtbot, dialog, dialog.go)
    first = (tmp_path / "report.json").read_text()
    assert first != "mine"
    press(qtbot, dialog, dialog.go)
    assert len(asked) == 2, "this dialog wrote it itself"
    assert (tmp_path / "report.json").read_text() == first


def test_stop_writes_nothing(qtbot, tmp_path, opened_files):
    dialog = opened(qtbot)
    dialog.folder.setText(str(tmp_path / "out"))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(dialog.stop.isVisible)
    press(qtbot, dialog, dialog.stop)
    assert "Stopped" in dialog.message.text()
    assert not list(tmp_path.glob("out/report*"))
    assert not opened_files


def test_stop_names_the_files_that_are_written_already(qtbot, tmp_path, opened_files, monkeypatch, here):
    def write(*_, progress):
        """Write the pages, as the report does before its PDF is laid out."""
        (tmp_path / "report.html").write_text("pages")
        while True:
            tell(progress, "report", 0.95)
            time.sleep(0.02)

    monkeypatch.setattr(report, "write_report_files", write)
    dialog = opened(qtbot)
    dialog.folder.setText(str(tmp_path))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil((tmp_path / "report.html").exists)
    qtbot.waitUntil(dialog.stop.isVisible)
    press(qtbot, dialog, dialog.stop)
    assert dialog.message.text() == "Stopped. Already written: report.html."
    assert not dialog.view.isVisible()

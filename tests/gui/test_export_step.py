"""The STEP dialog: what is chosen is written, read back and judged; a stop leaves nothing half done."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from panel_samples import FAULT, WITH_PERIPHERY, fitted, sample_site
from PySide6.QtCore import QSettings, Qt

from geofit.cad.step import read_shapes, read_step
from geofit.cad.step_origin import offset_at
from geofit.data.accuracy import Check
from geofit.gui.dialogs import task_dialog
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.step_fields import BodyStepDialog
from geofit.project.step_files import Signed, step_paths


def opened(qtbot, *names):
    dialog = ExportDialog({name: fitted(name) for name in names})
    qtbot.addWidget(dialog)
    dialog.show()
    return dialog


def rested(qtbot, dialog):
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)


def press(qtbot, dialog, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    rested(qtbot, dialog)


def column(dialog, title):
    found = next(one for one in dialog.table.rows.columns if one.title == title)
    return [found.text(row) for row in range(dialog.table.rows.total)]


@pytest.mark.usefixtures("own_settings")
def test_two_horizons_in_one_file_of_millimetres_are_read_back_and_judged(qtbot, tmp_path):
    dialog = opened(qtbot, WITH_PERIPHERY, FAULT)
    assert not dialog.table.isVisible()
    dialog.target.setText(str(tmp_path / "dam"))
    dialog.unit.setCurrentIndex(dialog.unit.findData("mm"))
    press(qtbot, dialog, dialog.go)
    (file,) = dialog.files
    assert file.path == tmp_path / "dam.step"
    assert "SI_UNIT(.MILLI.,.METRE.)" in file.path.read_text("ascii").replace("\n", "")
    assert "The file passes every check" in dialog.message.text()
    assert dialog.table.isVisible()
    assert set(column(dialog, "Horizon")) == {WITH_PERIPHERY, FAULT}
    assert "failed" not in column(dialog, "Result")
    names = column(dialog, "Check of the file")
    for wanted in ("σ", "core", "seam gap", "seam angle", "validity", "free edges", "tolerance", "self-intersection"):
        assert any(wanted in name for name in names), wanted
    assert {*read_step(file.path)} == {WITH_PERIPHERY, FAULT}
    assert QSettings().value("folder") == str(tmp_path)


def test_each_horizon_in_a_file_of_its_own_and_only_the_chosen_ones(qtbot, tmp_path):
    dialog = opened(qtbot, WITH_PERIPHERY, FAULT)
    dialog.target.setText(str(tmp_path / "dam.step"))
    dialog.apart.setChecked(True)
    assert "dam_T3-T2.step" in dialog.target.toolTip()
    dialog.horizons.item(0).setCheckState(Qt.CheckState.Unchecked)
    assert not dialog.apart.isEnabled(), "one horizon is one file"
    press(qtbot, dialog, dialog.go)
    assert [file.path.name for file in dialog.files] == ["dam.step"]
    assert list(dialog.files[0].read_back) == [FAULT]
    dialog.horizons.item(1).setCheckState(Qt.CheckState.Unchecked)
    assert not dialog.go.isEnabled()


def test_a_folder_that_is_not_there_is_told_with_what_to_do(qtbot, tmp_path):
    dialog = opened(qtbot, FAULT)
    dialog.target.setText(str(tmp_path / "no" / "dam.step"))
    press(qtbot, dialog, dialog.go)
    assert "Make the folder, or name another" in dialog.message.text()
    assert dialog.go.isEnabled()
    assert not dialog.files
    assert not dialog.table.isVisible()


def test_stop_ends_the_process_and_leaves_no_file(qtbot, tmp_path, monkeypatch):
    monkeypatch.setattr(task_dialog, "PATIENCE", 0)  # else the file might be ready before Stop is there
    dialog = opened(qtbot, WITH_PERIPHERY, FAULT)
    dialog.target.setText(str(tmp_path / "dam.step"))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    assert not dialog.target.isEnabled()
    qtbot.waitUntil(dialog.stop.isVisible)
    for name in (".geofit-uh9ar_wx.step", ".0f3a77c1.part.step"):
        (tmp_path / name).write_text("what a process that is ended leaves behind")
    press(qtbot, dialog, dialog.stop)
    assert "Stopped" in dialog.message.text()
    assert not list(tmp_path.iterdir())


def test_a_check_that_fails_is_named_above_the_table(qtbot, tmp_path):
    dialog = opened(qtbot, FAULT)
    dialog.target.setText(str(tmp_path / "dam.step"))
    press(qtbot, dialog, dialog.go)
    (file,) = dialog.files
    bad = Check("read-back seam gap", False, 0.02, 1e-6, "m", "a gap")
    back = replace(file.read_back[FAULT], checks=(bad,))
    dialog.show_files([replace(file, read_back={FAULT: back})])
    assert f"fails its checks for: {FAULT}" in dialog.message.text()
    assert column(dialog, "Result").count("failed") == 1


def test_names_of_files_of_their_own_are_sound_and_different():
    plan = step_paths(["T1/T2", "t1_t2"], Path("dam.stp"), separate=True)
    assert [path.name for path in plan] == ["dam_T1_T2.stp", "dam_t1_t2-2.stp"]


@pytest.mark.usefixtures("own_settings")
def test_author_organisation_and_certificate(qtbot, tmp_path):
    pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
    dialog = opened(qtbot, WITH_PERIPHERY)
    dialog.target.setText(str(tmp_path / "dam.step"))
    dialog.author.setText("M. Weber")
    dialog.organisation.setText("Dam Office")
    press(qtbot, dialog, dialog.go)
    (file,) = dialog.files
    head = file.path.read_text("ascii").split("ENDSEC;")[0]
    assert "('M. Weber'),('Dam Office')" in head.replace("\n", "")
    assert file.certificate == tmp_path / "dam_certificate.pdf"
    assert str(file.certificate) in dialog.message.text()
    assert any("attributes" in name for name in column(dialog, "Check of the file"))
    pdf = pdfium.PdfDocument(file.certificate)
    assert len(pdf) == 1
    assert "Dam Office" in pdf[0].get_textpage().get_text_range()
    pdf.close()
    # Who answered for the last file answers for the next one; the page is left out where it is not wanted.
    again = opened(qtbot, WITH_PERIPHERY)
    assert (again.author.text(), again.organisation.text()) == ("M. Weber", "Dam Office")
    again.target.setText(str(tmp_path / "other.step"))
    again.certificate.setChecked(False)
    press(qtbot, again, again.go)
    assert again.files[0].certificate is None
    assert not (tmp_path / "other_certificate.pdf").exists()


@pytest.mark.usefixtures("own_settings")
def test_the_origin_is_chosen_stated_and_remembered(qtbot, tmp_path):
    dialog = ExportDialog({FAULT: fitted(FAULT)}, datum=(500_000.0, 3_100_000.0, 1000.0))
    qtbot.addWidget(dialog)
    dialog.show()
    dialog.target.setText(str(tmp_path / "dam.step"))
    dialog.origin.choice.setCurrentIndex(dialog.origin.choice.findData("datum"))
    assert dialog.origin.datum.isVisible()
    dialog.origin.datum.setText("500000, 3100000")
    assert not dialog.go.isEnabled(), "a datum has three coordinates"
    dialog.origin.datum.setText("500000, 3100000, 900")
    assert dialog.go.isEnabled()
    dialog.certificate.setChecked(False)
    press(qtbot, dialog, dialog.go)
    (shape,) = read_shapes(tmp_path / "dam.step")
    assert offset_at(shape.attributes).tolist() == [500_000.0, 3_100_000.0, 900.0]
    assert "The file passes every check" in dialog.message.text()
    again = opened(qtbot, FAULT)
    assert again.origin.origin == (500_000.0, 3_100_000.0, 900.0)
    again.origin.choice.setCurrentIndex(again.origin.choice.findData("local"))
    assert again.origin.origin == "local"
    assert not again.origin.datum.isVisible()


@pytest.mark.usefixtures("own_settings")
def test_a_body_is_asked_for_the_same(qtbot):
    dialog = BodyStepDialog("ORE", replace(sample_site(), datum=(1.0, 2.0, 3.0)))
    qtbot.addWidget(dialog)
    dialog.show()
    fields = dialog.fields
    fields.origin.choice.setCurrentIndex(fields.origin.choice.findData("datum"))
    fields.origin.datum.setText("here")
    assert not dialog.go.isEnabled()
    fields.origin.datum.setText("1, 2, 3.5")
    fields.author.setText("M. Weber")
    fields.certificate.setChecked(False)
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    assert dialog.result() == 1
    assert fields.signed() == Signed("M. Weber", fields.organisation.text(), "", (1.0, 2.0, 3.5))

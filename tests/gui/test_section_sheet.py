"""The section sheet through its dialog: sections along an axis, files beside the project, and what was written said."""

from __future__ import annotations

import re

import numpy as np
import pypdfium2
import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import Qt

from geofit.gui.dialogs.section_sheet import SectionSheetDialog
from geofit.gui.lengths import show_lengths_in
from geofit.project.commands import SetSurface

NAME = "T3-T2"


@pytest.fixture
def shown(app):
    app.desktop.session.begin(sample_site(), SITE)
    provenance = app.document.provenance(NAME)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    return app


def opened(shown, qtbot, folder):
    showing = shown.window.showing
    showing.begin_section()
    site, surfaces = shown.document.site_in_use(), shown.document.surfaces()
    dialog = SectionSheetDialog(site, surfaces, showing.line, 50.0, {}, {}, folder)
    qtbot.addWidget(dialog)
    dialog.show()
    return dialog


def test_sections_every_so_many_metres_as_pdf_and_dxf(shown, qtbot, tmp_path, monkeypatch):
    said = []

    def drive(dialog):
        dialog.show()
        assert not dialog.spacing.isEnabled()
        dialog.which.setCurrentIndex(dialog.which.findData("across"))
        assert dialog.spacing.isEnabled()
        dialog.spacing.setValue(700.0)
        dialog.half.setValue(150.0)
        dialog.project.setText("上坝址")
        dialog.forms["dxf"].setChecked(True)
        dialog.target.setText(str(tmp_path / "sheet.pdf"))
        qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
        said.append(dialog.message.text())
        dialog.close()

    monkeypatch.setattr(SectionSheetDialog, "exec", drive)
    shown.trigger("section_sheet")
    assert (tmp_path / "sheet.dxf").is_file()
    pdf = pypdfium2.PdfDocument(tmp_path / "sheet.pdf")
    words = [page.get_textpage().get_text_range() for page in pdf]
    pdf.close()
    assert len(words) >= 2
    assert "0+700" in words[1]
    assert "上坝址" in words[0]
    assert str(tmp_path / "sheet.pdf") in said[0]
    assert "1:" in said[0]
    assert str(tmp_path / "sheet.dxf") in shown.window.statusBar().currentMessage()


def test_files_are_proposed_beside_the_project_and_nothing_is_written_without_a_form(shown, qtbot):
    dialog = opened(shown, qtbot, shown.document.folder)
    assert dialog.target.text() == str(SITE.resolve().parent / "sections")
    assert dialog.go.isEnabled()
    dialog.forms["pdf"].setChecked(False)
    assert not dialog.go.isEnabled()
    dialog.which.setCurrentIndex(dialog.which.findData("sections"))
    assert list(dialog.lines()) == [section.name for section in shown.document.site.sections]


def test_a_scale_that_does_not_fit_is_said_and_leaves_nothing(shown, qtbot, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    dialog = opened(shown, qtbot, folder)
    dialog.scale.setCurrentIndex(dialog.scale.findData(100))
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert "At 1:100 the sections are larger than A3" in dialog.message.text()
    assert not list(folder.iterdir())


def test_a_contour_plan_with_an_interval_of_ones_own(shown, qtbot, tmp_path, monkeypatch):
    from geofit.gui.dialogs.plan_sheet import PlanSheetDialog

    said = []

    def drive(dialog):
        dialog.show()
        assert dialog.which.currentText() == NAME
        assert dialog.order().interval is None
        dialog.interval.setValue(4.0)
        dialog.forms["dxf"].setChecked(True)
        dialog.target.setText(str(tmp_path / "plan.pdf"))
        qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
        said.append(dialog.message.text())
        dialog.close()

    monkeypatch.setattr(PlanSheetDialog, "exec", drive)
    shown.trigger("plan_sheet")
    pdf = pypdfium2.PdfDocument(tmp_path / "plan.pdf")
    words = pdf[0].get_textpage().get_text_range()
    pdf.close()
    assert "contours every 4 m" in words
    assert (tmp_path / "plan.dxf").is_file()
    assert str(tmp_path / "plan.pdf") in said[0]


@pytest.fixture
def in_feet():
    show_lengths_in("ft")
    yield
    show_lengths_in("m")


def test_sheets_and_plans_are_in_feet_where_the_window_is(shown, qtbot, tmp_path, in_feet):
    import ezdxf

    from geofit.gui.dialogs.plan_sheet import PlanSheetDialog

    site, surfaces = shown.document.site, shown.document.surfaces()
    dialog = opened(shown, qtbot, tmp_path)
    assert dialog.thickness.value() == pytest.approx(50 / 0.3048, abs=0.05)
    assert "1 in = 100 ft" in dialog.scale.itemText(dialog.scale.findData(1200))
    plan = PlanSheetDialog(site, surfaces, NAME, tmp_path)
    qtbot.addWidget(plan)
    plan.show()
    plan.interval.setValue(20.0)
    words, drawings = {}, {}
    for one, name in ((dialog, "sections"), (plan, "plan")):
        one.forms["dxf"].setChecked(True)
        one.forms["svg"].setChecked(True)
        one.target.setText(str(tmp_path / name))
        qtbot.mouseClick(one.go, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda one=one: not one.running, timeout=120_000)
        assert (tmp_path / f"{name}.svg").is_file(), one.message.text()
        pdf = pypdfium2.PdfDocument(tmp_path / f"{name}.pdf")
        words[name] = pdf[0].get_textpage().get_text_range()
        pdf.close()
        drawings[name] = ezdxf.readfile(tmp_path / f"{name}.dxf")
        assert drawings[name].units == 2, "feet"
        assert "1 in = " in words[name]
    assert "Elevation, ft" in words["sections"]
    assert "Distance along the section, ft" in words["sections"]
    assert "contours every 20 ft" in words["plan"]
    assert "Easting, ft" in words["plan"]
    for text in words.values():
        assert not re.search(r"\d\s?m\b|, m\b", text), "no metres are left"
    levels = {
        round(one.dxf.elevation, 3) for one in drawings["plan"].modelspace().query("LWPOLYLINE")
        if one.dxf.layer.startswith(NAME) and one.dxf.elevation
    }  # fmt: skip
    assert levels
    assert all(level % 20 == 0 for level in levels)
    length = np.linalg.norm(np.diff(shown.window.showing.line, axis=0), axis=1).sum() / 0.3048
    frame = next(one for one in drawings["sections"].modelspace().query("LWPOLYLINE") if one.dxf.layer == "FRAME")
    assert np.ptp([point[0] for point in frame.get_points()]) == pytest.approx(length, rel=1e-6)

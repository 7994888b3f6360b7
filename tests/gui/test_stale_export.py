"""What leaves the window of a stale surface says so: the dialogs, and the report with the hashes of the fit."""

from __future__ import annotations

import hashlib
import json
from types import SimpleNamespace

import pytest

from geofit.data.accuracy import Check
from geofit.data.messages import message
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.plan_sheet import PlanSheetDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.dialogs.section_sheet import SectionSheetDialog
from geofit.gui.worker import run
from geofit.project.body_export import BodyExport

pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")


def sha256(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


@pytest.fixture
def stale(app, tmp_path):
    """Two fitted horizons; then a point of the first changes, and the data are read again, without another fit."""
    rows = [
        f"{10 * i},{10 * j},{top + i - 0.5 * j + 0.1 * (i * j % 3)},{name}"
        for name, top in (("T2", 100), ("T3", 50))
        for i in range(6)
        for j in range(6)
    ]
    file = tmp_path / "picks.csv"
    file.write_text("x,y,z,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "picks.csv"\n', encoding="utf-8")
    app.window.files.open(tmp_path / "site.toml")
    app.idle()
    for name in ("T2", "T3"):
        app.window.fitting.fit(name)
        app.idle()
    then = sha256(file)
    file.write_text(file.read_text(encoding="utf-8").replace("0,0,100.0", "0,0,199.0"), encoding="utf-8")
    app.window.living.reload()
    app.idle()
    assert app.document.stale("T2")
    assert not app.document.stale("T3")
    return file, then


def opened(app, monkeypatch, name):
    """Return the dialog that an action opens, without waiting for its end."""
    found = []
    kind = {
        "report": ReportDialog,
        "export_step": ExportDialog,
        "plan_sheet": PlanSheetDialog,
        "section_sheet": SectionSheetDialog,
    }[name]
    monkeypatch.setattr(kind, "exec", lambda dialog: found.append(dialog))
    getattr(app.window.delivering, name)()
    (dialog,) = found
    app.qtbot.addWidget(dialog)
    return dialog


def test_the_report_states_the_hash_of_the_fit(app, stale, tmp_path, monkeypatch, write_report):
    file, then = stale
    dialog = opened(app, monkeypatch, "report")
    assert "T2 (stale), T3" in dialog.message.text()
    assert "Fit again" in dialog.message.text()
    write_report(dialog, tmp_path / "out", "json")
    assert "Wrote" in dialog.message.text()
    assert "Fit again" in dialog.message.text()
    first, second = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))["horizons"]
    assert {"kind": "file", "name": "picks.csv", "fitted": then, "now": sha256(file)} in first["stale"]
    assert second["stale"] == []


def test_the_step_dialog_marks_the_stale_horizon_and_says_what_to_do(app, stale, tmp_path, monkeypatch):
    dialog = opened(app, monkeypatch, "export_step")
    first, second = (dialog.horizons.item(row) for row in range(2))
    assert first.text().startswith("T2 (stale)")
    assert first.font().italic()
    assert "press Fit" in first.toolTip()
    assert "stale" not in second.text()
    assert not second.font().italic()
    assert "earlier data or settings): T2." in dialog.message.text()
    dialog.target.setText(str(tmp_path / "dam.step"))
    dialog.stated.certificate.setChecked(True)
    dialog.go.click()
    app.qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert "Wrote" in dialog.message.text()
    assert "earlier data or settings): T2." in dialog.message.text()
    certificate = pdfium.PdfDocument(dialog.files[0].certificate)
    try:
        text = " ".join(certificate[0].get_textpage().get_text_range().split())
        assert len(certificate) == 1
    finally:
        certificate.close()
    assert "T2 ! PASS (stale)" in text
    assert "T3 ✓ PASS" in text
    assert "earlier data or settings): T2." in text


@pytest.mark.parametrize("name", ["plan_sheet", "section_sheet"])
def test_a_sheet_warns_of_the_stale_horizon_before_it_is_written_and_on_its_pages(
    app, stale, tmp_path, monkeypatch, name
):
    dialog = opened(app, monkeypatch, name)
    if name == "plan_sheet":
        dialog.which.setCurrentText("T3")
        assert "earlier data" not in dialog.message.text()
        dialog.which.setCurrentIndex(dialog.which.count() - 1)
    assert "earlier data or settings): T2." in dialog.message.text()
    dialog.target.setText(str(tmp_path / "sheet"))
    dialog.go.click()
    app.qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert "Wrote" in dialog.message.text()
    assert "earlier data or settings): T2." in dialog.message.text()
    sheet = pdfium.PdfDocument(tmp_path / "sheet.pdf")
    pages = [page.get_textpage().get_text_range() for page in sheet]
    sheet.close()
    assert ["earlier data or settings): T2." in text for text in pages] == [True, False][: len(pages)]


def test_a_body_whose_file_fails_its_checks_stays_in_the_log(app, stale, tmp_path, monkeypatch, caplog):
    failed = Check("closed", False, 2.0, 0.0, "", message("test.open", "2 edges are open"))
    found = BodyExport(tmp_path / "ore.step", SimpleNamespace(checks=(failed,), faces=7))
    body = SimpleNamespace(stale=("data",))
    monkeypatch.setattr("geofit.gui.bodies.dated_body", lambda *_: body)
    monkeypatch.setattr("geofit.gui.bodies.export_body", lambda *_, progress: found)
    monkeypatch.setattr("geofit.gui.activity.run_in_process", run)
    app.window.bodies.export("ORE", tmp_path / "ore.step")
    app.idle()
    warned = [one.getMessage() for one in caplog.records if one.levelname == "WARNING"]
    assert any("2 edges are open" in text for text in warned)
    assert any("ORE" in text and "Fit again" in text for text in warned)
    app.qtbot.waitUntil(app.window.panels.log.isVisible)


def test_the_report_names_a_horizon_that_was_not_fitted(app, stale, tmp_path, monkeypatch, write_report):
    while app.document.surface("T3") is not None:
        app.window.session.stack.undo()
        app.idle()
    assert app.document.surface("T2") is not None
    dialog = opened(app, monkeypatch, "report")
    assert "Not fitted, so not in the report: T3." in dialog.message.text()
    write_report(dialog, tmp_path / "out", "html")
    assert "Not fitted, so not in the report: T3." in dialog.message.text()
    assert "Not fitted, so not in the report: T3." in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")

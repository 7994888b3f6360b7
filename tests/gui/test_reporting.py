"""The window's report beside the command line's: the same chapters and figures, and nothing examined twice."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QDesktopServices

from geofit.cli.main import main
from geofit.gui.dialogs.export_step import ExportDialog
from geofit.gui.dialogs.report import ReportDialog
from geofit.project import side_by_side
from geofit.report import pictures

NAMES = ("upper", "lower")


@pytest.fixture
def site_file(tmp_path):
    """A site of two horizons, one below the other, in 25 holes."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(0.0, 300.0, 60.0), np.arange(0.0, 300.0, 60.0)))
    lines = ["hole,x,y,z,horizon"]
    for name, height in zip(NAMES, (900.0, 860.0), strict=True):
        z = height + 6 * np.sin(x / 130) * np.cos(y / 110)
        lines += [f"ZK{k},{x[k]:.1f},{y[k]:.1f},{z[k]:.3f},{name}" for k in range(len(x))]
    (tmp_path / "contacts.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    text = '[site]\nname = "Small"\norder = ["upper", "lower"]\n[[picks]]\nfile = "contacts.csv"\n'
    (tmp_path / "site.toml").write_text(text, encoding="utf-8")
    return tmp_path / "site.toml"


def press(qtbot, dialog):
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)


def export(qtbot, dialog, target):
    dialog.target.setText(str(target))
    dialog.apart.setChecked(True)
    press(qtbot, dialog)


def report(qtbot, dialog, folder):
    for form, box in dialog.forms.items():
        box.setChecked(form == "json")
    dialog.folder.setText(str(folder))
    asked = dialog.examine.isVisibleTo(dialog)
    press(qtbot, dialog)
    assert asked, "nothing was known off the data before"
    assert not dialog.examine.isVisibleTo(dialog), "a second report need not examine again"


def test_the_window_s_report_says_what_the_command_line_s_says(app, qtbot, site_file, tmp_path, monkeypatch, capsys):
    # Pictures are not compared; drawing them would take most of the time.
    monkeypatch.setattr(pictures, "draw_pictures", lambda *_: pictures.Pictures({}, None, ""))
    monkeypatch.setattr(pictures, "draw_site", lambda *_: pictures.Pictures({}, None, ""))
    monkeypatch.setattr(pictures, "write_picture", lambda *_: None)
    # Functions that are replaced here stay what they are in another process.
    monkeypatch.setattr(side_by_side, "available", lambda: 1)
    monkeypatch.setattr(sys, "argv", ["geofit", "fit", str(site_file), "--out", str(tmp_path / "cli")])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0, capsys.readouterr()

    app.window.files.open(site_file)
    app.idle()
    app.trigger("fit_all")
    app.idle()
    # The command line names its files after the horizons, the window after the one that it was given.
    monkeypatch.setattr(ExportDialog, "exec", lambda dialog: export(qtbot, dialog, tmp_path / "dam.step"))
    app.trigger("export_step")
    app.idle()
    monkeypatch.setattr(ReportDialog, "exec", lambda dialog: report(qtbot, dialog, tmp_path / "gui"))
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: True)
    app.trigger("report")
    app.idle()

    ours, theirs = (json.loads((tmp_path / side / "report.json").read_text("utf-8")) for side in ("gui", "cli"))
    for data, prefix in ((ours, "dam_"), (theirs, "")):
        assert [one["horizon"] for one in data["horizons"]] == list(NAMES)
        for one in data["horizons"]:
            assert one["storage"]["tin_points"] > 0
            assert one["prediction"] is not None
            assert one["read_back"]["file"] == f"{prefix}{one['horizon']}.step"
            # The header of a STEP file has the file's name.
            for key in ("file", "sha256", "bytes"):
                del one["read_back"][key]
    assert ours == theirs

    # What the report found out belongs to the document, and its panel shows it.
    for name in NAMES:
        assert app.document.prediction(name) is not None
    app.document.select("lower")
    app.idle()
    panel = app.window.panels.prediction
    assert panel.left_out.rows.total == len(app.document.prediction("lower").left_out)
    assert panel.left_out.rows.total > 0

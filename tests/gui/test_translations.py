"""The Chinese of the windows is complete, and reaches them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QDialogButtonBox, QLabel

from geofit.gui.language import apply_language

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def chinese(qapp):
    apply_language("zh_CN")
    yield
    apply_language("en")


def test_every_text_of_the_windows_is_translated_and_compiled():
    script = ROOT / "tools" / "update_translations.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_check_finds_what_is_missing_unfinished_and_wrong(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import update_translations as update

    ts = tmp_path / "geofit_zh_CN.ts"
    text = update.TS.read_text("utf-8")
    text = text.replace("<translation>", '<translation type="unfinished">', 1)
    text = text.replace("<source>&amp;Save</source>", "<source>&amp;Keep</source>")
    text = text.replace("拟合 {name}", "拟合 {nom}")
    ts.write_text(text, "utf-8")
    faults = "\n".join(update.check(ts))
    for fault in ("missing: Actions: &Save", "not used any more: Actions: &Keep", "unfinished: Actions: ",
                  "the values differ: Fitting: Fit {name}", "geofit_zh_CN.qm is not that of"):  # fmt: skip
        assert fault in faults, fault


def test_the_windows_own_words_and_those_of_qt_are_chinese(qtbot, chinese):
    from geofit.gui.dialogs.preferences import PreferencesDialog
    from geofit.gui.preferences import Preferences

    dialog = PreferencesDialog(Preferences())
    qtbot.addWidget(dialog)
    assert dialog.windowTitle() == "首选项"
    cancel = dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Cancel)
    assert cancel.text().startswith("取消")
    assert all(label.text() != "&Theme" for label in dialog.findChildren(QLabel))
    assert QCoreApplication.translate("Said", "Fit {name}") == "拟合 {name}"

"""The Chinese of the windows is complete, and reaches them."""

from __future__ import annotations

import errno
import logging
import os
from pathlib import Path

import pytest
from PySide6.QtWidgets import QDialogButtonBox, QLabel, QWidget

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.gui.language import apply_language
from geofit.gui.panels.log import LogPanel
from geofit.gui.translate import shown_error, translated
from geofit.gui.worker import run
from geofit.project.provenance import DocumentError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def chinese(qapp):
    apply_language("zh_CN")
    yield
    apply_language("en")


def test_the_windows_own_words_and_those_of_qt_are_chinese(qtbot, chinese):
    from geofit.gui.dialogs.preferences import PreferencesDialog
    from geofit.gui.preferences import Preferences

    dialog = PreferencesDialog(Preferences())
    qtbot.addWidget(dialog)
    assert dialog.windowTitle() == "首选项"
    cancel = dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Cancel)
    assert cancel.text().startswith("取消")
    assert all(label.text() != "&Theme" for label in dialog.findChildren(QLabel))


def test_errors_are_told_in_chinese_with_the_file(qtbot, chinese):
    from geofit.gui.dialogs.error import ErrorDialog

    dialogs = [
        ErrorDialog("保存", PermissionError(errno.EACCES, "Permission denied", "/data/site.geofit")),
        ErrorDialog(
            "打开",
            InputError(
                message("data.file-missing", "There is no such file"),
                message("data.check-path", "Check the path."),
                file="site.toml",
            ),
        ),
        ErrorDialog(
            "",
            DocumentError(
                message("data.no-surface-to-adjust", "'{name}' has no surface to adjust. Fit it first.", name="T1")
            ),
        ),
    ]
    for dialog in dialogs:
        qtbot.addWidget(dialog)
    assert [dialog.message.text() for dialog in dialogs] == [
        "/data/site.geofit：没有访问权限\n\n请确认文件夹存在、可写且有足够空间。",
        "site.toml：没有该文件。\n\n请检查路径。",
        "“T1”没有可调整的曲面。请先拟合。",
    ]


def test_the_log_speaks_chinese_and_leaves_other_libraries_alone(qtbot, chinese):
    panel = LogPanel()
    qtbot.addWidget(panel)
    try:
        log = logging.getLogger("geofit.gui.files")
        full = OSError(28, os.strerror(28))
        empty = InputError(
            message("io.file-empty", "The file is empty"),
            message("io.export-again", "Export it again."),
            file="p.csv",
        )
        log.info(message("gui.log-saved", "Saved {path}", path="dam.geofit"))
        log.warning(
            message(
                "gui.log-journal-not-written",
                "No journal can be written, so a crash would lose unsaved work: {error}",
                error=shown_error(full),
            )
        )
        log.error(message("gui.log-task-error", "{task}: {error}", task="拟合", error=shown_error(empty)))
        logging.getLogger("vtk").error("bad %d", 3)
        lines = [line.split("  ", 1)[1] for line in panel.text.toPlainText().splitlines()]
    finally:
        panel.detach()
    assert lines == [
        "已保存 dam.geofit",
        "警告: 没有操作日志，程序崩溃时未保存的工作将丢失：磁盘已满",
        "错误: 拟合：p.csv：文件为空。请重新导出。",
        "错误: bad 3",
    ]


def test_a_stage_with_a_name_in_it_comes_through_a_task_as_a_sentence(qtbot, chinese):
    heard = []
    parent = QWidget()
    qtbot.addWidget(parent)
    task = run(parent, _with_a_stage, on_progress=lambda stage, fraction: heard.append(translated(stage)))
    with qtbot.waitSignal(task.ended):
        pass
    assert heard == ["T1：拟合"]


def _with_a_stage(progress):
    progress(message("data.stage-of-name", "{name}: {stage}", name="T1", stage="fit"), 1.0)

"""The base of dialogs with a long task: fields rest, progress comes with patience, every end is said in words."""

from __future__ import annotations

import threading
import time

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QLineEdit, QVBoxLayout

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.gui.dialogs.task_dialog import TaskDialog


class Asking(TaskDialog):
    """A dialog with one field, whose task is told by the test."""

    def __init__(self, task):
        super().__init__()
        self.field = QLineEdit()
        self.fields = (self.field,)
        layout = QVBoxLayout(self)
        layout.addWidget(self.field)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot())
        self.go.clicked.connect(
            lambda: self.begin(
                task,
                3,
                in_process=False,
                on_done=lambda value: self.say(f"made {value}", "passed"),
                on_stopped=self.stopped,
            )
        )

    def stopped(self):
        self.say("Stopped.")


def opened(qtbot, task):
    dialog = Asking(task)
    qtbot.addWidget(dialog)
    dialog.show()
    qtbot.waitExposed(dialog)
    return dialog


def press(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def rested(qtbot, dialog):
    qtbot.waitUntil(lambda: not dialog.running)


def test_what_is_done_is_said_and_the_focus_comes_back(qtbot):
    dialog = opened(qtbot, lambda value, progress: 2 * value)
    dialog.activateWindow()
    dialog.field.setFocus()
    qtbot.keyClick(dialog.field, Qt.Key.Key_Return)
    assert dialog.running
    assert not dialog.field.isEnabled()
    assert not dialog.go.isEnabled()
    rested(qtbot, dialog)
    assert dialog.message.text() == "made 6"
    assert dialog.field.isEnabled()
    assert dialog.focusWidget() is dialog.field


def test_progress_comes_with_patience_and_goes(qtbot):
    on, told = threading.Event(), threading.Event()

    def slow(_, progress):
        progress("start", 0.0)
        on.wait(20)
        while not told.is_set():
            progress("halfway", 0.5)
            time.sleep(0.02)

    dialog = opened(qtbot, slow)
    press(qtbot, dialog.go)
    assert not dialog.progress.isVisible(), "what is quick shows none"
    qtbot.waitUntil(dialog.progress.isVisible)
    assert dialog.progress.maximum() == 0, "nobody knows yet how long it takes"
    on.set()
    qtbot.waitUntil(lambda: dialog.progress.value() == 500)
    assert dialog.progress.text() == "halfway"
    told.set()
    rested(qtbot, dialog)
    assert not dialog.progress.isVisible()
    assert not dialog.stop.isVisible()


def endless(_, progress):
    while progress("on and on", 0.1) is not False:
        time.sleep(0.02)
    from geofit.data.errors import Cancelled

    raise Cancelled(message("test.text", "stopped"))


def test_stop_ends_the_task_and_closing_too(qtbot):
    dialog = opened(qtbot, endless)
    press(qtbot, dialog.go)
    qtbot.waitUntil(dialog.stop.isVisible)
    press(qtbot, dialog.stop)
    rested(qtbot, dialog)
    assert dialog.message.text() == "Stopped."
    press(qtbot, dialog.go)
    dialog.close()
    rested(qtbot, dialog)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            InputError(
                message("io.file-empty", "The file is empty"), message("test.text", "Choose another."), file="a.csv"
            ),
            "a.csv: The file is empty. Choose another.",
        ),
        (PermissionError(13, "Permission denied"), "that no other program has the file open"),
        (ValueError("seven"), "a mistake in geofit, not in your data; please report it: ValueError: seven"),
    ],
)
def test_what_went_wrong_is_said_with_what_to_do(qtbot, error, words, caplog):
    def fail(_, progress):
        raise error

    dialog = opened(qtbot, fail)
    press(qtbot, dialog.go)
    rested(qtbot, dialog)
    assert words in dialog.message.text()
    assert dialog.go.isEnabled(), "it can be tried again"


def test_a_long_message_makes_room_for_itself(qtbot):
    dialog = Asking(lambda number, progress: number)
    qtbot.addWidget(dialog)
    boxes = [QCheckBox(f"a form to choose, {k}") for k in range(5)]
    for k, box in enumerate(boxes):
        dialog.layout().insertWidget(k, box)
    dialog.show()
    qtbot.waitExposed(dialog)
    dialog.resize(dialog.minimumSizeHint())
    dialog.say("a sentence that goes on for a while. " * 30)
    qtbot.wait(50)
    assert all(box.height() >= box.sizeHint().height() for box in boxes)
    assert dialog.message.height() >= dialog.message.heightForWidth(dialog.message.width())

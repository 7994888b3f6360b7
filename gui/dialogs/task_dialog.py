"""The base of dialogs with a long task: how far it is, Stop, and what was done or what went wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent, QPixmap
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QHBoxLayout, QLabel, QProgressBar, QPushButton, QWidget
from shiboken6 import isValid

from geofit.data.errors import GeofitError
from geofit.gui.file_stamps import Stamp, changed_since, stamps_of
from geofit.gui.panels.marks import icon
from geofit.gui.translate import failure, translated
from geofit.gui.worker import Task, run, run_in_process

__all__ = ["TaskDialog"]

#: Milliseconds before the progress of a task is shown: what is quick needs none.
PATIENCE = 300


class TaskDialog(QDialog):
    """A dialog that does one long task at a time, and says in one place how it ended; closing it stops the task.

    A subclass lays out ``message_row`` (a mark and a sentence) and :meth:`foot`, connects ``go`` to what calls
    :meth:`begin`, names the ``fields`` that rest meanwhile, and extends :meth:`refresh`.
    """

    def __init__(
        self,
        parent: QWidget | None = None,
        leave: QDialogButtonBox.StandardButton = QDialogButtonBox.StandardButton.Close,
    ) -> None:
        super().__init__(parent)
        self._task: Task | None = None
        self._turn = 0
        #: The files that the task writes, as they were before.
        self._stamps: dict[Path, Stamp] = {}
        self._focused: QWidget | None = None
        self._foot: tuple[QWidget, ...] = ()
        self.fields: tuple[QWidget, ...] = ()
        self.message, self.sign = QLabel(), QLabel()
        self.message.setWordWrap(True)
        self.message.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.message_row = QHBoxLayout()
        self.message_row.addWidget(self.sign, 0, Qt.AlignmentFlag.AlignTop)
        self.message_row.addWidget(self.message, 1)
        self.progress = QProgressBar()
        self.progress.setAccessibleName(self.tr("Progress"))
        self.go, self.stop = QPushButton(), QPushButton(self.tr("&Stop"))
        self.go.setDefault(True)
        self.stop.clicked.connect(self._cancel)
        self._leave = QDialogButtonBox(leave)
        self._leave.rejected.connect(self.reject)
        self._patience = QTimer(self)
        self._patience.setSingleShot(True)
        self._patience.timeout.connect(self._show_progress)
        for widget in (self.progress, self.stop):
            widget.hide()

    @property
    def running(self) -> bool:
        """Whether a task runs."""
        return self._task is not None

    def foot(self, *buttons: QPushButton) -> QHBoxLayout:
        """Return the lowest row: progress, ``buttons``, then those of every such dialog."""
        row = QHBoxLayout()
        row.addWidget(self.progress, 1)
        row.addStretch(1)
        for button in (*buttons, self.stop, self.go, self._leave):
            row.addWidget(button)
        self._foot = (*buttons, self.stop, self.go, *self._leave.buttons())
        return row

    def put_foot_last(self) -> None:
        """Let Tab come to the lowest row last again, after fields that were made later."""
        before: QWidget = self.previousInFocusChain() or self
        for button in self._foot:
            QWidget.setTabOrder(before, button)
            before = button

    def say(self, text: str, mark: str = "none") -> None:
        """Say something next to a mark of :func:`geofit.gui.panels.marks.icon`; no text, no mark."""
        self.message.setText(text)
        self.sign.setPixmap(icon(mark).pixmap(16) if text else QPixmap())
        layout = self.layout()
        if layout is not None:
            # Else a long text would squeeze what is above it; the buttons below stay on the screen.
            layout.activate()
            wide, most = self.width(), self.screen().availableSize()
            while layout.totalHeightForWidth(wide) > most.height() and wide < most.width():
                wide = min(wide * 5 // 4 + 1, most.width())
            self.resize(wide, max(self.height(), min(layout.totalHeightForWidth(wide), most.height())))

    def begin(
        self,
        function: Callable[..., Any],
        *args: Any,
        on_done: Callable[[Any], object],
        on_stopped: Callable[[], object],
        in_process: bool = True,
        files: Iterable[Path] = (),
    ) -> None:
        """Call ``function(*args, progress=...)``, ``in_process`` in its own process; failures are shown.

        ``files`` are those that it writes, for :meth:`stopped_words`.
        """
        self._stamps = stamps_of(files)
        start = run_in_process if in_process else run
        self._focused = self.focusWidget()
        self.progress.setRange(0, 0)
        self._task = start(
            self,
            function,
            *args,
            title=self.windowTitle(),
            on_done=on_done,
            on_failed=self.tell_failure,
            on_progress=self._progress,
            on_cancelled=on_stopped,
        )
        self._turn += 1
        self._task.ended.connect(lambda turn=self._turn: self._rested(turn))
        self._patience.start(PATIENCE)
        self.refresh()

    def stopped_words(self, otherwise: str) -> str:
        """Return which files of a task that was stopped are whole already; ``otherwise`` where none is."""
        names = ", ".join(file.name for file in changed_since(self._stamps))
        return self.tr("Stopped. Already written: {names}.").format(names=names) if names else otherwise

    def refresh(self) -> None:
        """Enable what can be done."""
        for field in self.fields:
            field.setEnabled(not self.running)
        self.go.setEnabled(not self.running)

    def tell_failure(self, error: Exception) -> None:
        """Say what went wrong, and what to do about it."""
        if isinstance(error, GeofitError):
            text = failure(error)
        elif isinstance(error, OSError):
            text = self.tr(
                "{reason}. Check that the folder is there, can be written and has room, and that no other program has "
                "the file open."
            ).format(reason=failure(error))
        else:
            text = self.tr("This is a mistake in geofit, not in your data; please report it: {error}").format(
                error=failure(error)
            )
        self.say(text, "failed")

    def reject(self) -> None:
        """Stop what runs, and close."""
        self._cancel()
        super().reject()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop what runs."""
        self._cancel()
        super().closeEvent(event)

    def _progress(self, stage: str, fraction: float) -> None:
        # Until something is done nobody knows how long it takes: the bar only moves.
        if fraction > 0:
            self.progress.setRange(0, 1000)
            self.progress.setValue(round(1000 * fraction))
            self.progress.setFormat(translated(stage))

    def _show_progress(self) -> None:
        self.progress.setVisible(self.running)
        self.stop.setVisible(self.running)

    def _rested(self, turn: int) -> None:
        if turn != self._turn:
            return  # what was done has begun the next task
        self._task = None
        self._patience.stop()
        self._show_progress()
        self.refresh()
        if self._focused is not None and isValid(self._focused) and self._focused.isEnabled():
            self._focused.setFocus()
        self._focused = None

    def _cancel(self) -> None:
        if self._task is not None:
            self._task.cancel()

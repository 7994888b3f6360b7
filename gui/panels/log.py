"""The log: what geofit, its libraries and Qt had to say since the start."""

from __future__ import annotations

import logging
import time
from collections import deque
from dataclasses import dataclass

from PySide6.QtCore import QMessageLogContext, QObject, QtMsgType, Signal, qInstallMessageHandler
from PySide6.QtGui import QColor, QGuiApplication, QPalette, QTextCharFormat, QTextCursor
from PySide6.QtWidgets import QHBoxLayout, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from geofit.data.messages import Message
from geofit.gui.translate import translated
from geofit.report.style import FAIL

__all__ = ["LogPanel", "qt_to_logging"]

#: Lines kept.
LINES = 5000
_QT_LEVELS = {
    QtMsgType.QtDebugMsg: logging.DEBUG,
    QtMsgType.QtInfoMsg: logging.INFO,
    QtMsgType.QtWarningMsg: logging.WARNING,
    QtMsgType.QtCriticalMsg: logging.ERROR,
    QtMsgType.QtFatalMsg: logging.CRITICAL,
}


def qt_to_logging() -> None:
    """Let Qt's messages go where Python's go."""
    qInstallMessageHandler(_hear_qt)


def _hear_qt(kind: QtMsgType, context: QMessageLogContext, text: str | None) -> None:
    logging.getLogger("qt").log(_QT_LEVELS.get(kind, logging.INFO), "%s", text or "")


@dataclass(frozen=True)
class _Entry:
    """What a record says, not yet translated; ``trace`` is the traceback of an unforeseen error."""

    created: float
    level: int
    text: Message | str
    trace: str


class _Bridge(QObject):
    heard = Signal(object)


class _Handler(logging.Handler):
    """Hands records over to the window's thread, whichever thread they come from."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.bridge = _Bridge()
        self._plain = logging.Formatter()

    def filter(self, record: logging.LogRecord) -> bool:
        """Let what geofit and Qt say pass, and failures of the libraries."""
        return record.name.split(".")[0] in ("geofit", "qt") or record.levelno >= logging.ERROR

    def emit(self, record: logging.LogRecord) -> None:
        try:
            # What other libraries log stays as it is.
            text = record.msg if isinstance(record.msg, Message) else record.getMessage()
        except (TypeError, ValueError):
            self.handleError(record)
            return
        # The letters: a traceback itself would hold the arrays of all its frames.
        trace = self._plain.formatException(record.exc_info) if record.exc_info else ""
        self.bridge.heard.emit(_Entry(record.created, record.levelno, text, trace))


class LogPanel(QWidget):
    """Shows the records of Python's logging from INFO on, warnings coloured, errors in geofit with their traceback."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._entries: deque[_Entry] = deque(maxlen=LINES)
        self.text = QPlainTextEdit()
        self.text.setReadOnly(True)
        self.text.setMaximumBlockCount(LINES)
        self.text.setAccessibleName(self.tr("Log"))
        self.text.setPlaceholderText(self.tr("No messages yet: what geofit does is listed here."))
        copy, clear = QPushButton(self.tr("Copy all")), QPushButton(self.tr("Clear"))
        copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(self.text.toPlainText()))
        clear.clicked.connect(self.clear)
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        buttons.addWidget(copy)
        buttons.addWidget(clear)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.setSpacing(6)
        layout.addWidget(self.text)
        layout.addLayout(buttons)
        self._words = {
            logging.WARNING: self.tr("warning"), logging.ERROR: self.tr("error"), logging.CRITICAL: self.tr("error"),
        }  # fmt: skip
        self._handler = _Handler()
        self._handler.bridge.heard.connect(self._hear)
        self._root = logging.getLogger()
        self._geofit = logging.getLogger("geofit")
        self._geofit.setLevel(logging.INFO)
        self._root.addHandler(self._handler)

    def detach(self) -> None:
        """Hear no more; to be called before the window goes."""
        self._root.removeHandler(self._handler)

    def take_over(self, other: LogPanel) -> None:
        """Begin with what another panel has heard, in the present language."""
        for entry in other._entries:
            self._hear(entry)

    def _hear(self, entry: _Entry) -> None:
        self._entries.append(entry)
        look = QTextCharFormat()
        look.setForeground(QColor(FAIL) if entry.level >= logging.ERROR else self._colour(entry.level))
        cursor = QTextCursor(self.text.document())
        cursor.movePosition(QTextCursor.MoveOperation.End)
        if not self.text.document().isEmpty():
            cursor.insertBlock()
        cursor.insertText(self._line(entry), look)
        bar = self.text.verticalScrollBar()
        bar.setValue(bar.maximum())

    def _line(self, entry: _Entry) -> str:
        """Return the time, a word for what is graver than news, and the message in the user's language."""
        at = time.strftime("%H:%M:%S", time.localtime(entry.created))
        word = f"{self._words[entry.level]}: " if entry.level in self._words else ""
        line = f"{at}  {word}{translated(entry.text) if isinstance(entry.text, Message) else entry.text}"
        return f"{line}\n{entry.trace}" if entry.trace else line

    def clear(self) -> None:
        """Forget all entries."""
        self._entries.clear()
        self.text.clear()

    def _colour(self, level: int) -> QColor:
        role = QPalette.ColorRole.Text if level < logging.WARNING else QPalette.ColorRole.Link
        return self.palette().color(role)

"""All steps of the session: a click on one goes back or forward to it."""

from __future__ import annotations

from PySide6.QtCore import QSize
from PySide6.QtGui import QIcon, QUndoStack
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QUndoView, QVBoxLayout, QWidget

from geofit.gui.panels.marks import icon

__all__ = ["StepsDialog"]


class StepsDialog(QDialog):
    """The undo stack as a list, beside the window: it stays open while work goes on.

    While ``busy`` nothing can be gone to: a task that runs belongs to the present step.
    """

    def __init__(self, stack: QUndoStack, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Steps"))
        self.list = QUndoView(stack)
        self.list.setAccessibleName(self.tr("Steps of this session"))
        self.list.setEmptyLabel(self.tr("As opened"))
        self.list.setCleanIcon(QIcon())
        self.words = QLabel(self.tr("Click a step to undo or redo everything up to it."))
        self.words.setWordWrap(True)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.close)
        column = QVBoxLayout(self)
        column.addWidget(self.words)
        column.addWidget(self.list, 1)
        column.addWidget(buttons)
        self.setWindowIcon(icon("report"))
        self.resize(QSize(420, 460))

    def set_busy(self, busy: bool, *_: object) -> None:
        """Rest while a task runs."""
        self.list.setEnabled(not busy)

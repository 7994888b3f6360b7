"""A strip above the view that offers something, without stopping the work: one button takes it, one puts it off."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QWidget

__all__ = ["OfferBar"]


class OfferBar(QFrame):
    """Hidden until :meth:`offer`; ``accepted`` when its button is pressed."""

    accepted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("offer")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self.words, self.take, self.later = QLabel(), QPushButton(), QPushButton(self.tr("Not now"))
        self.words.setTextFormat(Qt.TextFormat.PlainText)
        self.words.setWordWrap(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(10, 4, 6, 4)
        row.addWidget(self.words, 1)
        for button in (self.take, self.later):
            button.setAutoDefault(False)
            row.addWidget(button)
        self.take.clicked.connect(self.accepted)
        self.later.clicked.connect(self.hide)
        self.hide()

    def offer(self, words: str, take: str) -> None:
        """Show an offer."""
        self.words.setText(words)
        self.take.setText(take)
        self.show()

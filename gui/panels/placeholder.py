"""What is shown in a panel that has nothing to show yet: a sentence that states what to do."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QPushButton, QStackedLayout, QVBoxLayout, QWidget

__all__ = ["Placeholder"]


class Placeholder(QStackedLayout):
    """The layout of a panel, of two pages: the panel's content, or a sentence with an optional button."""

    def __init__(self, content: QWidget, panel: QWidget) -> None:
        # Qt shows the first page at once: without a panel around it, as a window of its own that flashes up.
        super().__init__(panel)
        page = QWidget()
        inner = QVBoxLayout(page)
        inner.setContentsMargins(16, 16, 16, 16)
        self._label = QLabel(alignment=Qt.AlignmentFlag.AlignCenter)
        self._label.setWordWrap(True)
        self._label.setForegroundRole(page.foregroundRole())
        self.button = QPushButton()
        self.button.hide()
        inner.addStretch(1)
        inner.addWidget(self._label)
        inner.addWidget(self.button, 0, Qt.AlignmentFlag.AlignHCenter)
        self._offers = QVBoxLayout()
        inner.addLayout(self._offers)
        inner.addStretch(2)
        self.addWidget(content)
        self.addWidget(page)
        self._content, self._page = content, page

    @property
    def text(self) -> str:
        """The sentence that is shown; empty while the content is."""
        return self._label.text() if self.currentWidget() is self._page else ""

    def say(self, text: str, button: str = "") -> None:
        """Show a sentence in place of the content."""
        self._label.setText(text)
        self.button.setText(button)
        self.button.setVisible(bool(button))
        self.setCurrentWidget(self._page)

    def offer(self, button: QPushButton) -> QPushButton:
        """Put a button below every sentence that does what a button of the content does, which is hidden then."""
        offered = QPushButton(button.text())
        offered.setToolTip(button.toolTip())
        offered.clicked.connect(button.click)
        self._offers.addWidget(offered, 0, Qt.AlignmentFlag.AlignHCenter)
        return offered

    def reveal(self) -> None:
        """Show the content."""
        self.setCurrentWidget(self._content)

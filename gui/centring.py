"""A panel in the centre: a double click on its title puts it next to the 3D view, another one puts it back."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QDockWidget, QHBoxLayout, QLabel, QSplitter, QToolButton, QVBoxLayout, QWidget

from geofit.gui.layout import BOTTOM, Layout

__all__ = ["Centring"]

#: Share of the middle that the panel gets; the view keeps the rest until somebody drags the line between them.
SHARE = 0.62


class Centring(QObject):
    """Moves the contents of docks into the middle and back; one at a time. ``name`` is the one that is there."""

    changed = Signal()

    def __init__(self, middle: QSplitter, docks: Mapping[str, QDockWidget], layout: Layout) -> None:
        super().__init__(middle)
        self._middle, self._docks, self._layout = middle, docks, layout
        self.name: str | None = None
        self.frame: _Frame | None = None
        for dock in docks.values():
            dock.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Take a double click on a title before Qt makes the panel float."""
        if event.type() == QEvent.Type.MouseButtonDblClick and isinstance(watched, QDockWidget):
            inner = watched.widget()
            assert isinstance(event, QMouseEvent)
            if inner is not None and event.position().y() < inner.geometry().top() and not watched.isFloating():
                self.bring(watched.objectName())
                return True
        return super().eventFilter(watched, event)

    def holds(self, widget: QWidget | None) -> str | None:
        """Return the name of the panel in the middle if a widget is in it."""
        inside = widget is not None and self.frame is not None and self.frame.isAncestorOf(widget)
        return self.name if inside else None

    def close(self) -> None:
        """Put a panel back, and listen no more: docks that are being destroyed still send events."""
        self.back()
        for dock in self._docks.values():
            dock.removeEventFilter(self)

    def bring(self, name: str) -> None:
        """Bring a panel into the middle."""
        self.back()
        dock = self._docks[name]
        inner = dock.widget()
        frame = _Frame(dock.windowTitle(), inner)
        frame.left.connect(self.back)
        self.name, self.frame = name, frame
        if name in BOTTOM:
            # The others below give their room, too; a click on their strip unfolds them.
            self._layout.fold()
        self._layout.away.add(name)
        dock.hide()
        self._middle.addWidget(frame)
        frame.show()
        width = self._middle.width()
        self._middle.setSizes([round((1 - SHARE) * width), round(SHARE * width)])
        inner.show()
        self.changed.emit()

    def back(self) -> None:
        """Put the panel back into its dock."""
        if self.name is None or self.frame is None:
            return
        name, frame = self.name, self.frame
        self.name = self.frame = None
        self._layout.away.discard(name)
        dock = self._docks[name]
        dock.setWidget(frame.inner)
        frame.inner.show()
        frame.setParent(None)
        frame.deleteLater()
        self._layout.reveal(name)
        self.changed.emit()


class _Frame(QWidget):
    """A panel with a title of its own; ``left`` when it is to go back."""

    left = Signal()

    def __init__(self, title: str, inner: QWidget) -> None:
        super().__init__()
        self.inner = inner
        self.head = _Head(title)
        self.head.left.connect(self.left)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.head)
        column.addWidget(inner, 1)


class _Head(QWidget):
    """The title bar of a panel in the middle."""

    left = Signal()

    def __init__(self, title: str) -> None:
        super().__init__()
        self.words, self.button = QLabel(title), QToolButton()
        words = QCoreApplication.translate("Centring", "Back to its place")
        self.button.setText(words)
        self.button.setAutoRaise(True)
        self.button.clicked.connect(self.left)
        self.setToolTip(QCoreApplication.translate("Centring", "A double click puts the panel back"))
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 2, 4, 2)
        row.addWidget(self.words, 1, Qt.AlignmentFlag.AlignVCenter)
        row.addWidget(self.button)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Ask to go back."""
        event.accept()
        self.left.emit()

"""The strip at the window's foot while the panels below the view are folded away: a button unfolds its panel."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMainWindow, QToolBar

from geofit.gui.layout import BOTTOM, Layout
from geofit.gui.text_size import sized_by_text

__all__ = ["PanelBar"]


class PanelBar(QToolBar):
    """One button a panel; it is there only while they are folded away: else their tabs are."""

    folded = Signal(bool)

    def __init__(self, window: QMainWindow, docks: Mapping[str, QDockWidget], layout: Layout) -> None:
        super().__init__(window)
        self.setWindowTitle(self.tr("Panels below the view"))
        self.setObjectName("panel bar")
        self.setMovable(False)
        self.setContentsMargins(0, 0, 0, 0)
        sized_by_text(self, lambda: self.setMaximumHeight(self.fontMetrics().height() + 10))
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self._layout = layout
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self.renew)
        self.buttons: dict[str, QAction] = {}
        for name in BOTTOM:
            action = self.addAction(docks[name].windowTitle())
            action.triggered.connect(lambda _, name=name: layout.reveal(name))
            docks[name].visibilityChanged.connect(lambda _: self._later.start())
            self.buttons[name] = action
        window.addToolBar(Qt.ToolBarArea.BottomToolBarArea, self)

    def renew(self) -> None:
        """Show the strip where the panels are folded away; not on the start page."""
        self.setVisible(self._layout.folded and not self._layout.hidden)
        self.folded.emit(self._layout.folded)

    def toggle(self, *_: object) -> None:
        """Fold all panels away, or bring the last ones back."""
        if self._layout.folded:
            self._layout.reveal(self._layout.last)
        else:
            self._layout.fold()

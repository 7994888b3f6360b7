"""The strip at the window's foot: a button for each panel below the view, which unfolds it or folds it away."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMainWindow, QToolBar

from geofit.gui.layout import BOTTOM, Layout

__all__ = ["PanelBar"]


class PanelBar(QToolBar):
    """One button a panel; the one in front is pressed."""

    def __init__(self, window: QMainWindow, docks: Mapping[str, QDockWidget], layout: Layout) -> None:
        super().__init__(window)
        self.setWindowTitle(self.tr("Panels below the view"))
        self.setObjectName("panel bar")
        self.setMovable(False)
        self.setContentsMargins(0, 0, 0, 0)
        self.setMaximumHeight(self.fontMetrics().height() + 10)
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self._docks, self._layout = docks, layout
        self.buttons: dict[str, QAction] = {}
        for name in BOTTOM:
            action = self.addAction(docks[name].windowTitle())
            action.setCheckable(True)
            action.triggered.connect(lambda wanted, name=name: self._toggle(name, wanted))
            docks[name].visibilityChanged.connect(action.setChecked)
            self.buttons[name] = action
        window.addToolBar(Qt.ToolBarArea.BottomToolBarArea, self)

    def _toggle(self, name: str, wanted: bool) -> None:
        """Unfold a panel, or fold them all where it was in front."""
        if wanted:
            self._layout.reveal(name)
        else:
            self._layout.fold()

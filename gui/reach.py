"""Going to any panel: from the menu, which brings to the front what is behind, and with the keyboard."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QDockWidget, QTabBar, QWidget

__all__ = ["Reach"]


class Reach(QObject):
    """Knows the docks of a window and what is in its middle."""

    def __init__(self, docks: Mapping[str, QDockWidget], middle: QWidget, reveal: Callable[[str], None]) -> None:
        super().__init__(middle)
        self._docks, self._middle, self._reveal = docks, middle, reveal
        self.switches = [self._switch(name, dock) for name, dock in docks.items()]

    def reveal(self, name: str) -> None:
        """Bring a dock to the front."""
        self._reveal(name)

    def step(self, by: int) -> None:
        """Give the keyboard to the next panel (1) or the one before (-1), the middle of the window among them."""
        places = [*(dock for dock in self._docks.values() if not dock.isHidden()), self._middle]
        focused = QApplication.focusWidget()
        now = next((k for k, place in enumerate(places) if _holds(place, focused)), len(places) - 1)
        self._enter(places[(now + by) % len(places)])

    def place(self) -> str:
        """Return the name of the dock that has the keyboard, by one of its fields or by its tab; else ``view``."""
        focused = QApplication.focusWidget()
        title = focused.tabText(focused.currentIndex()) if isinstance(focused, QTabBar) else None
        for name, dock in self._docks.items():
            if _holds(dock, focused) or (title == dock.windowTitle() and _in_front(dock)):
                return name
        return "view"

    def behind(self, widget: QWidget | None) -> bool:
        """Whether a widget is in a dock that another one covers in their tabs."""
        dock = next((dock for dock in self._docks.values() if _holds(dock, widget)), None)
        return dock is not None and not _in_front(dock)

    def _enter(self, place: QWidget) -> None:
        if isinstance(place, QDockWidget):
            place.raise_()
        (_left(place) or _first(place) or place).setFocus(Qt.FocusReason.TabFocusReason)

    def _switch(self, name: str, dock: QDockWidget) -> QAction:
        """Return an action that shows a dock and gives it the keyboard, or closes it if it is in front already."""
        own, shown = QAction(dock.windowTitle(), self), dock.toggleViewAction()
        own.setCheckable(True)

        def go(_: bool) -> None:
            if _in_front(dock):
                dock.close()
            else:
                self._reveal(name)
                self._enter(dock)
            own.setChecked(shown.isChecked())

        own.triggered.connect(go)
        shown.toggled.connect(own.setChecked)
        return own


def _in_front(dock: QDockWidget) -> bool:
    # Qt does not hide docks behind others: it puts them outside the window.
    return not dock.isHidden() and not dock.visibleRegion().isEmpty()


def _holds(place: QWidget, widget: QWidget | None) -> bool:
    return widget is not None and (place is widget or place.isAncestorOf(widget))


def _takes_focus(place: QWidget, widget: QWidget) -> bool:
    return (
        place.isAncestorOf(widget)
        and widget.isVisibleTo(place)
        and widget.isEnabled()
        and bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
    )


def _left(place: QWidget) -> QWidget | None:
    """Return what had the keyboard in a place when it was left."""
    widget = place.focusWidget()
    return widget if widget is not None and _takes_focus(place, widget) else None


def _first(place: QWidget) -> QWidget | None:
    """Return what Tab would come to first in a place."""
    widget = place.nextInFocusChain()
    while widget is not None and widget is not place:
        if _takes_focus(place, widget):
            return widget
        widget = widget.nextInFocusChain()
    return None

"""Where the docks and the tool bar stand: out of the way until a site is open, then as they were left."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QByteArray, QObject, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QTabBar, QToolBar

__all__ = ["BOTTOM", "Layout"]

#: Of the layout that is remembered; one more when docks come or go.
VERSION = 5
_Area = Qt.DockWidgetArea
#: What folds away below the view.
BOTTOM = (
    "residuals", "section", "histogram", "plan", "seams", "checks", "prediction", "changes", "stereonet",
    "body_figures", "morph", "log",
)  # fmt: skip
_PLACES = (
    (_Area.LeftDockWidgetArea, ("tree",), False),
    (_Area.RightDockWidgetArea, ("fit", "adjust", "bodies"), True),
    (_Area.BottomDockWidgetArea, BOTTOM, True),
)
#: Width of the docks at the left and at the right at first, and height of those below, as shares of the window's.
_LEFT, _RIGHT, _BELOW = 0.156, 0.184, 0.36
#: Pixels at the left that tell names of horizons apart, where so many are left for the rest of the window.
_NAMES, _REST = 240, 1080


class Layout(QObject):
    """Arranges the docks of a window, hides them with its tool bars, and brings them back."""

    def __init__(self, window: QMainWindow, docks: Mapping[str, QDockWidget]) -> None:
        super().__init__(window)
        self._window, self._docks = window, docks
        self._kept, self.hidden = QByteArray(), False
        self._unfolded = set(BOTTOM)
        #: Panels that are in the middle of the window: their docks are empty.
        self.away: set[str] = set()
        #: The panel below the view that was in front last.
        self.last = BOTTOM[0]
        window.setDockOptions(
            QMainWindow.DockOption.AnimatedDocks
            | QMainWindow.DockOption.AllowTabbedDocks
            | QMainWindow.DockOption.AllowNestedDocks
        )
        window.setCorner(Qt.Corner.BottomLeftCorner, _Area.LeftDockWidgetArea)
        window.setCorner(Qt.Corner.BottomRightCorner, _Area.RightDockWidgetArea)
        for area, names, _ in _PLACES:
            for name in names:
                window.addDockWidget(area, docks[name])
        self.hide()
        self._kept = QByteArray()

    @property
    def state(self) -> QByteArray:
        """What is remembered from one start to the next; also while everything is hidden."""
        return self._kept if self.hidden else self._window.saveState(VERSION)

    @state.setter
    def state(self, state: QByteArray) -> None:
        self._kept = state

    def hide(self) -> None:
        """Hide the docks and the tool bars; where they stand is kept."""
        if self.hidden:
            return
        self._kept, self.hidden = self._window.saveState(VERSION), True
        for part in self._parts():
            part.hide()
            part.toggleViewAction().setEnabled(False)

    def show(self) -> None:
        """Bring everything back as it was; where nothing is known, as at first."""
        if not self.hidden:
            return
        self.hidden = False
        for part in self._parts():
            part.toggleViewAction().setEnabled(True)
        if not self._window.restoreState(self._kept, VERSION):
            self.arrange()

    @property
    def folded(self) -> bool:
        """Whether nothing is shown below the view."""
        return all(self._docks[name].isHidden() for name in BOTTOM)

    def fold(self) -> None:
        """Give the view the room of the docks below it."""
        front = next((n for n in BOTTOM if not self._docks[n].visibleRegion().isEmpty()), self.last)
        self.last = front
        self._unfolded = {name for name in BOTTOM if not self._docks[name].isHidden()} or set(BOTTOM)
        for name in BOTTOM:
            self._docks[name].hide()

    def reveal(self, name: str) -> None:
        """Bring a dock to the front; one below the view comes with those that were folded away with it."""
        if name in self.away:
            return
        if name in BOTTOM and self.folded:
            for other in self._unfolded - self.away:
                self._docks[other].show()
            height = round(_BELOW * self._window.height())
            self._window.resizeDocks([self._docks[name]], [height], Qt.Orientation.Vertical)
        self._docks[name].show()
        self._docks[name].raise_()
        self._hide_lost_tabs()

    def arrange(self) -> None:
        """Put everything where it is at first: below the view nothing, until somebody asks for it."""
        window, docks = self._window, self._docks
        for part in self._parts():
            part.show()
        for area, names, tabbed in _PLACES:
            for name in names:
                if tabbed and name != names[0]:
                    window.tabifyDockWidget(docks[names[0]], docks[name])
                else:
                    window.addDockWidget(area, docks[name])
            docks[names[0]].raise_()
        width = window.width()
        left = max(_LEFT * width, min(_NAMES, width - _REST))
        sides = [round(left), round(_RIGHT * width)]
        window.resizeDocks([docks["tree"], docks["fit"]], sides, Qt.Orientation.Horizontal)
        self._hide_lost_tabs()
        self._unfolded = set(BOTTOM)
        for name in BOTTOM:
            docks[name].hide()

    def _hide_lost_tabs(self) -> None:
        """Hide tab bars that Qt makes while it puts docks into tabs, and forgets: another one has all their tabs."""
        bars = self._window.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        held = [{bar.tabText(k) for k in range(bar.count())} for bar in bars]
        for bar, tabs in zip(bars, held, strict=True):
            if any(tabs < other for other in held):
                bar.hide()

    def _parts(self) -> list[QDockWidget | QToolBar]:
        return [
            *self._docks.values(),
            *self._window.findChildren(QToolBar, options=Qt.FindChildOption.FindDirectChildrenOnly),
        ]

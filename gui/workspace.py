"""The widgets of the main window and the docks that hold them."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMainWindow, QStackedWidget, QTabBar, QVBoxLayout, QWidget

from geofit.gui.panels.adjust import AdjustPanel
from geofit.gui.panels.checks import ChecksPanel
from geofit.gui.panels.fit_panel import FitPanel
from geofit.gui.panels.histogram import HistogramPanel
from geofit.gui.panels.log import LogPanel
from geofit.gui.panels.offdata import OffDataPanel
from geofit.gui.panels.plan import PlanPanel
from geofit.gui.panels.project_tree import ProjectTree
from geofit.gui.panels.residuals import ResidualTable
from geofit.gui.panels.scene_list import SceneList
from geofit.gui.panels.seams import SeamTable
from geofit.gui.panels.section import SectionPanel
from geofit.gui.panels.verdict import VerdictBadge
from geofit.gui.start_page import StartPage
from geofit.gui.view3d.view import SceneView

__all__ = ["Workspace"]

#: Of the layout of docks that is remembered; one more when docks come or go.
LAYOUT_VERSION = 1
_Area = Qt.DockWidgetArea


class Workspace(QObject):
    """Makes every panel of a window and puts it in its place."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self._window = window
        self.start, self.view = StartPage(), SceneView()
        self.centre = QStackedWidget()
        self.centre.addWidget(self.start)
        self.centre.addWidget(self.view)
        window.setCentralWidget(self.centre)
        self.tree, self.scene = ProjectTree(), SceneList(self.view.layers)
        self.fit, self.verdict, self.adjust = FitPanel(), VerdictBadge(), AdjustPanel()
        self.residuals, self.section, self.histogram = ResidualTable(), SectionPanel(), HistogramPanel()
        self.log, self.seams, self.checks = LogPanel(), SeamTable(), ChecksPanel()
        self.offdata, self.plan = OffDataPanel(), PlanPanel()
        self.docks = {
            "tree": self._dock("tree", self.tr("Project"), self.tree),
            "scene": self._dock("scene", self.tr("Scene"), self.scene),
            "fit": self._dock("fit", self.tr("Fit"), _stacked(_inset(self.verdict), self.fit)),
            "adjust": self._dock("adjust", self.tr("Adjust by hand"), self.adjust),
            "residuals": self._dock("residuals", self.tr("Residuals"), self.residuals),
            "section": self._dock("section", self.tr("Section"), self.section),
            "histogram": self._dock("histogram", self.tr("Histogram"), self.histogram),
            "plan": self._dock("plan", self.tr("Plan"), self.plan),
            "seams": self._dock("seams", self.tr("Seams"), self.seams),
            "checks": self._dock("checks", self.tr("Checks"), self.checks),
            "offdata": self._dock("offdata", self.tr("Off the data"), self.offdata),
            "log": self._dock("log", self.tr("Log"), self.log),
        }
        window.setDockOptions(
            QMainWindow.DockOption.AnimatedDocks
            | QMainWindow.DockOption.AllowTabbedDocks
            | QMainWindow.DockOption.AllowNestedDocks
        )
        window.setCorner(Qt.Corner.BottomLeftCorner, _Area.LeftDockWidgetArea)
        window.setCorner(Qt.Corner.BottomRightCorner, _Area.RightDockWidgetArea)

    def give_docks(self) -> None:
        """Hand the docks to the window, for a layout that is remembered."""
        for dock in self.docks.values():
            self._window.addDockWidget(_Area.LeftDockWidgetArea, dock)

    def arrange(self) -> None:
        """Put every dock where it is at first."""
        window, docks = self._window, self.docks
        for area, names, tabbed in (
            (_Area.LeftDockWidgetArea, ("tree", "scene"), False),
            (_Area.RightDockWidgetArea, ("fit", "adjust"), True),
            (
                _Area.BottomDockWidgetArea,
                ("residuals", "section", "histogram", "plan", "seams", "checks", "offdata", "log"),
                True,
            ),
        ):
            for name in names:
                if tabbed and name != names[0]:
                    window.tabifyDockWidget(docks[names[0]], docks[name])
                else:
                    window.addDockWidget(area, docks[name])
                docks[name].show()
            docks[names[0]].raise_()
        width, height = window.width(), window.height()
        window.resizeDocks([docks["tree"], docks["fit"]], [width // 6, width // 5], Qt.Orientation.Horizontal)
        window.resizeDocks([docks["residuals"]], [height // 3], Qt.Orientation.Vertical)
        window.resizeDocks([docks["tree"], docks["scene"]], [height // 2, height // 2], Qt.Orientation.Vertical)
        self._hide_lost_tabs()

    def _hide_lost_tabs(self) -> None:
        """Hide tab bars that Qt makes while it puts docks into tabs, and forgets: another one has all their tabs."""
        bars = self._window.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        held = [{bar.tabText(k) for k in range(bar.count())} for bar in bars]
        for bar, tabs in zip(bars, held, strict=True):
            if any(tabs < other for other in held):
                bar.hide()

    def switches(self) -> list[QAction]:
        """Return an action for each dock that shows and hides it."""
        return [dock.toggleViewAction() for dock in self.docks.values()]

    def reveal(self, name: str) -> None:
        """Bring a dock to the front."""
        self.docks[name].show()
        self.docks[name].raise_()

    def show_scene(self, shown: bool) -> None:
        """Show the 3D view, or the start page."""
        self.centre.setCurrentWidget(self.view if shown else self.start)

    def close(self) -> None:
        """Let go of what outlives a widget: the 3D view's context, the log's handler."""
        self.log.detach()
        self.view.close()

    def _dock(self, name: str, title: str, widget: QWidget) -> QDockWidget:
        dock = QDockWidget(title, self._window)
        dock.setObjectName(name)
        dock.setWidget(widget)
        return dock


def _inset(widget: QWidget) -> QWidget:
    """Keep a widget off the dock's edges."""
    box = QWidget()
    layout = QVBoxLayout(box)
    layout.setContentsMargins(8, 8, 8, 0)
    layout.addWidget(widget)
    return box


def _stacked(*widgets: QWidget) -> QWidget:
    box = QWidget()
    layout = QVBoxLayout(box)
    layout.setContentsMargins(0, 0, 0, 0)
    layout.setSpacing(0)
    for widget in widgets:
        layout.addWidget(widget)
    return box

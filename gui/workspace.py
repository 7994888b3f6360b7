"""The widgets of the main window and the docks that hold them."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QSplitter, QStackedWidget, QVBoxLayout, QWidget

from geofit.gui.centring import Centring
from geofit.gui.layout import Layout
from geofit.gui.offer_bar import OfferBar
from geofit.gui.panel_bar import PanelBar
from geofit.gui.panels.adjust import AdjustPanel
from geofit.gui.panels.bodies import BodiesPanel
from geofit.gui.panels.body_figures import BodyFigures
from geofit.gui.panels.changes import ChangesPanel
from geofit.gui.panels.checks import ChecksPanel
from geofit.gui.panels.fit_panel import FitPanel
from geofit.gui.panels.histogram import HistogramPanel
from geofit.gui.panels.log import LogPanel
from geofit.gui.panels.morph import MorphPanel
from geofit.gui.panels.plan import PlanPanel
from geofit.gui.panels.prediction import PredictionPanel
from geofit.gui.panels.project_tree import ProjectTree
from geofit.gui.panels.residuals import ResidualTable
from geofit.gui.panels.seams import SeamTable
from geofit.gui.panels.section import SectionPanel
from geofit.gui.panels.stereonet import StereonetPanel
from geofit.gui.panels.verdict import VerdictBadge
from geofit.gui.reach import Reach
from geofit.gui.start_page import StartPage
from geofit.gui.view3d.view import SceneView

__all__ = ["Workspace"]


class Workspace(QObject):
    """Makes every panel of a window and puts it in its place."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self._window = window
        self.start, self.view = StartPage(), SceneView()
        self.centre = QStackedWidget()
        self.centre.addWidget(self.start)
        self.centre.addWidget(self.view)
        self.offer = OfferBar()
        self.middle = QSplitter(Qt.Orientation.Horizontal)
        beside = _stacked(self.offer, self.centre)
        # The start page is wide; next to a panel in the centre the view may be narrower.
        beside.setMinimumWidth(240)
        self.middle.addWidget(beside)
        self.middle.setChildrenCollapsible(False)
        window.setCentralWidget(self.middle)
        self.tree = ProjectTree(self.view.layers)
        self.fit, self.verdict, self.adjust = FitPanel(), VerdictBadge(), AdjustPanel()
        self.residuals, self.section, self.histogram = ResidualTable(), SectionPanel(), HistogramPanel()
        self.log, self.seams, self.checks = LogPanel(), SeamTable(), ChecksPanel()
        self.prediction, self.plan = PredictionPanel(), PlanPanel()
        self.changes, self.stereonet = ChangesPanel(), StereonetPanel()
        self.bodies, self.body_figures, self.morph = BodiesPanel(), BodyFigures(), MorphPanel()
        self.docks = {
            "tree": self._dock("tree", self.tr("Project"), self.tree),
            "fit": self._dock("fit", self.tr("Fit"), _stacked(_inset(self.verdict), self.fit)),
            "adjust": self._dock("adjust", self.tr("Manual edit"), self.adjust),
            "bodies": self._dock("bodies", self.tr("Bodies"), self.bodies),
            "residuals": self._dock("residuals", self.tr("Residuals"), self.residuals),
            "section": self._dock("section", self.tr("Section"), self.section),
            "histogram": self._dock("histogram", self.tr("Histogram"), self.histogram),
            "plan": self._dock("plan", self.tr("Plan"), self.plan),
            "seams": self._dock("seams", self.tr("Seams"), self.seams),
            "checks": self._dock("checks", self.tr("Checks", "Workspace"), self.checks),
            "prediction": self._dock("prediction", self.tr("Away from the data"), self.prediction),
            "changes": self._dock("changes", self.tr("What moved"), self.changes),
            "stereonet": self._dock("stereonet", self.tr("Dips"), self.stereonet),
            "body_figures": self._dock("body_figures", self.tr("Body figures"), self.body_figures),
            "morph": self._dock("morph", self.tr("Metamorphosis"), self.morph),
            "log": self._dock("log", self.tr("Log"), self.log),
        }
        self.layout = Layout(window, self.docks)
        self.bar = PanelBar(window, self.docks, self.layout)
        self.reach = Reach(self.docks, self.view, self.layout.reveal)
        self.centring = Centring(self.middle, self.docks, self.layout)
        self.bar.hide()

    def reveal(self, name: str) -> None:
        """Bring a dock to the front."""
        self.reach.reveal(name)

    def arrange(self) -> None:
        """Put every panel where it is at first."""
        self.centring.back()
        self.layout.arrange()

    def show_scene(self, shown: bool) -> None:
        """Show the 3D view among its docks, or the start page alone."""
        if not shown:
            self.centring.back()
        self.centre.setCurrentWidget(self.view if shown else self.start)
        if shown:
            self.layout.show()
        else:
            self.layout.hide()
        self.bar.renew()

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
    layout.setStretch(len(widgets) - 1, 1)
    return box

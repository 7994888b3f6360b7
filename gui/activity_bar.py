"""The status bar's right end: where the pointer is, the coordinate system, and what runs, with Cancel."""

from __future__ import annotations

import math

from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QLabel, QMainWindow, QProgressBar, QToolButton

from geofit.gui.activity import Activity
from geofit.gui.icons import palette_icon
from geofit.gui.lengths import coordinate_mark, length_mark, shown_coordinate, shown_length
from geofit.gui.panel_bar import PanelBar
from geofit.gui.translate import translated

__all__ = ["ActivityBar"]


class ActivityBar:
    """Fills a window's status bar."""

    def __init__(self, window: QMainWindow, activity: Activity) -> None:
        self.place, self.crs, self.stage = QLabel(), QLabel(), QLabel()
        self.progress, self.stop = QProgressBar(), QToolButton()
        self.progress.setRange(0, 1000)
        self.progress.setTextVisible(False)
        self.progress.setFixedWidth(140)
        self.progress.setAccessibleName(QCoreApplication.translate("ActivityBar", "Progress"))
        self.stop.setIcon(palette_icon("cancel"))
        self.stop.setAutoRaise(True)
        self.stop.setToolTip(QCoreApplication.translate("ActivityBar", "Stop the task (Esc)"))
        self.stop.setAccessibleName(QCoreApplication.translate("ActivityBar", "Stop the task"))
        self.stop.clicked.connect(activity.cancel)
        self.place.setToolTip(
            QCoreApplication.translate(
                "ActivityBar", "Easting, northing and elevation under the pointer, without exaggeration"
            )
        )
        self._title = ""
        self._task = (self.stage, self.progress, self.stop)
        self._bar = bar = window.statusBar()
        bar.setSizeGripEnabled(False)
        bar.setContentsMargins(0, 0, 8, 0)
        for widget in (*self._task, self.place, self.crs):
            bar.addPermanentWidget(widget)
        self._show_task(False)
        activity.began.connect(self._begin)
        activity.progressed.connect(self._progress)
        activity.ended.connect(lambda: self._show_task(False))

    def add_fold(self, action: QAction, panels: PanelBar) -> None:
        """Put a button at the end that folds the panels below the view away."""
        fold = QToolButton()
        fold.setAutoRaise(True)
        fold.setText(QCoreApplication.translate("ActivityBar", "Fold panels ▾"))
        fold.setToolTip(action.toolTip())
        fold.clicked.connect(action.trigger)
        panels.folded.connect(lambda folded: fold.setVisible(not folded))
        fold.hide()
        self._bar.addPermanentWidget(fold)

    def show_place(self, x: float, y: float, z: float) -> None:
        """Show map coordinates, given in metres; nothing where they are nan."""
        if math.isnan(x) or math.isnan(y):
            self.place.clear()
            return
        x, y, z = shown_coordinate(x), shown_coordinate(y), shown_length(z)
        height = "" if math.isnan(z) else f"   Z {z:.2f} {length_mark()}"
        # One mark at the end is enough where all three have the same unit.
        mark = "" if height and coordinate_mark() == length_mark() else f" {coordinate_mark()}"
        self.place.setText(f"E {x:.2f}   N {y:.2f}{mark}{height}")

    def _begin(self, title: str) -> None:
        self._title = title
        self.stage.setText(title)
        self.progress.setValue(0)
        self._show_task(True)

    def _progress(self, stage: str, fraction: float) -> None:
        self.stage.setText(f"{self._title}: {translated(stage)}")
        self.progress.setValue(round(1000 * fraction))

    def _show_task(self, shown: bool) -> None:
        for widget in self._task:
            widget.setVisible(shown)

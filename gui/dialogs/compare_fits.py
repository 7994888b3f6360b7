"""Two fits of a horizon side by side: two views with one camera, the settings that differ, and the figures of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from geofit.data.prediction import PredictionResult
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.theme import is_dark
from geofit.gui.translate import translated
from geofit.gui.view3d.view import SceneView
from geofit.project.fit_comparison import apart, fit_figures, title_of
from geofit.project.provenance import Provenance

__all__ = ["CompareDialog", "ShownFit"]


@dataclass(frozen=True, eq=False)
class ShownFit:
    """A fit that can be chosen: how it was made, its surface, and what is known of it away from the data."""

    provenance: Provenance
    surface: HorizonFit
    prediction: PredictionResult | None = None


class CompareDialog(QDialog):
    """Shows any two of the fits of a horizon; ``taken(provenance)`` carries the one that is to be the surface.

    Parameters
    ----------
    site : Site
        What both views show in addition to the surfaces.
    fits : sequence of ShownFit
        The fits of one horizon, the oldest first; at least two.
    present : Provenance
        The one that is the horizon's surface now.
    """

    taken = Signal(object)

    def __init__(
        self, site: Site, fits: Sequence[ShownFit], present: Provenance, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.fits, self._present = tuple(fits), present
        self._linking = self._ended = False
        self.setWindowTitle(self.tr("Compare fits of {name}").format(name=present.horizon))
        self.resize(QSize(1180, 740).boundedTo(self.screen().availableSize()))
        self.views = (SceneView(self), SceneView(self))
        self.chosen = (QComboBox(), QComboBox())
        self.use = (QPushButton(self.tr("Take A")), QPushButton(self.tr("Take B")))
        self.words = QLabel()
        self.words.setWordWrap(True)
        self.words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.table = QTableWidget(0, 3)
        self.table.setTabKeyNavigation(False)
        self.table.setAccessibleName(self.tr("Settings that differ, and figures of both fits"))
        self.table.setHorizontalHeaderLabels([self.tr("Setting or figure"), "A", "B"])
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setAlternatingRowColors(True)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self._lay_out()
        now = next(k for k, one in enumerate(self.fits) if one.provenance == present)
        other = now - 1 if now else len(self.fits) - 1
        for side, box in enumerate(self.chosen):
            box.setAccessibleName(self.tr("Fit {side}").format(side="AB"[side]))
            for number, one in enumerate(self.fits, 1):
                words = translated(title_of(one.provenance, number))
                box.addItem(self.tr("{fit} (current)").format(fit=words) if number == now + 1 else words)
            box.setCurrentIndex((other, now)[side])
        for side, view in enumerate(self.views):
            view.set_dark(is_dark(self.palette()))
            name = present.horizon
            # Both scenes have the same zero and the same points, so that one camera fits both.
            view.show_site(replace(site, horizons={name: self.fits[now].surface.points}))
            view.canvas.viewpoint_changed.connect((self._follow_a, self._follow_b)[side])
            self.chosen[side].currentIndexChanged.connect((self._choose_a, self._choose_b)[side])
            self.use[side].clicked.connect((self._take_a, self._take_b)[side])
            self._show(side)
        self._compare()

    def _lay_out(self) -> None:
        grid = QGridLayout()
        grid.setSpacing(6)
        for side, view in enumerate(self.views):
            row = QHBoxLayout()
            label = QLabel("AB"[side])
            font = label.font()
            font.setBold(True)
            label.setFont(font)
            label.setBuddy(self.chosen[side])
            self.chosen[side].setMinimumContentsLength(12)
            row.addWidget(label)
            row.addWidget(self.chosen[side], 1)
            row.addWidget(self.use[side])
            grid.addLayout(row, 0, side)
            view.setMinimumSize(300, 240)
            grid.addWidget(view, 1, side)
            grid.setColumnStretch(side, 1)
            self.use[side].setAutoDefault(False)
        grid.setRowStretch(1, 1)
        close = QPushButton(self.tr("Close"))
        close.setDefault(True)
        close.clicked.connect(self.accept)
        foot = QHBoxLayout()
        foot.addWidget(self.words, 1)
        foot.addWidget(close, 0, Qt.AlignmentFlag.AlignBottom)
        column = QVBoxLayout(self)
        column.addLayout(grid, 1)
        column.addWidget(self.table)
        column.addLayout(foot)

    def shown(self, side: int) -> ShownFit:
        """Return the fit of side A (0) or B (1)."""
        return self.fits[self.chosen[side].currentIndex()]

    def done(self, result: int) -> None:
        """Let go of both views' OpenGL, however the dialog ends."""
        if not self._ended:
            self._ended = True
            for view, follow in zip(self.views, (self._follow_a, self._follow_b), strict=True):
                view.canvas.viewpoint_changed.disconnect(follow)
                view.close()
        super().done(result)

    def _show(self, side: int) -> None:
        one, present = self.shown(side), self.shown(side).provenance == self._present
        self.views[side].show_surface(one.surface, None if one.prediction is None else one.prediction.uncertainty)
        self.use[side].setEnabled(not present)

    def _compare(self) -> None:
        a, b = self.shown(0), self.shown(1)
        lines = fit_figures(a.surface, b.surface, (a.prediction, b.prediction))
        self.table.setRowCount(len(lines))
        for row, line in enumerate(lines):
            for column, text in enumerate((line.name, line.first, line.second)):
                item = QTableWidgetItem(translated(text))
                font = item.font()
                font.setBold(bool(column) and line.differs)
                item.setFont(font)
                self.table.setItem(row, column, item)
        height = sum(self.table.rowHeight(row) for row in range(len(lines)))
        self.table.setFixedHeight(min(height + self.table.horizontalHeader().sizeHint().height() + 4, 230))
        self.words.setText(translated(apart(a.surface, b.surface)[1]))

    def _link(self, source: int) -> None:
        """Let the other view look from the same side, once."""
        if self._linking:
            return
        self._linking = True
        one, other = self.views[source].canvas, self.views[1 - source].canvas
        viewpoint = one.viewpoint
        centre = np.asarray(viewpoint.centre) + one.origin - other.origin
        other.look(replace(viewpoint, centre=centre), moving=not one.full)
        self._linking = False

    def _follow_a(self) -> None:
        self._link(0)

    def _follow_b(self) -> None:
        self._link(1)

    def _choose_a(self) -> None:
        self._show(0)
        self._compare()

    def _choose_b(self) -> None:
        self._show(1)
        self._compare()

    def _take_a(self) -> None:
        self._take(0)

    def _take_b(self) -> None:
        self._take(1)

    def _take(self, side: int) -> None:
        self.taken.emit(self.shown(side).provenance)
        self.accept()

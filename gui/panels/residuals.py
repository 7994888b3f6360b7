"""The residual of every point: worst first, sorted and filtered, linked with the point that is picked in 3D."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QCheckBox, QLabel, QLineEdit, QMenu, QVBoxLayout, QWidget

from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.marks import icon, is_dark
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import Column, DataTable, spoken_words
from geofit.report.style import bands

__all__ = ["ResidualTable"]

#: Wait for the next letter of the filter, milliseconds.
PAUSE = 150
_DISTANCE = 1


class _Table(DataTable):
    """The table with what can be done to a point."""

    exclude_requested = Signal(int)
    pull_requested = Signal(int)

    def menu(self) -> QMenu:
        """Return the menu of the current point."""
        menu = QMenu(self)
        index = self.current
        exclude = menu.addAction(self.tr("Exclude this row from the fit"))
        pull = menu.addAction(self.tr("Pull the surface to this point"))
        exclude.setEnabled(index is not None)
        pull.setEnabled(index is not None)
        if index is not None:
            exclude.triggered.connect(lambda: self.exclude_requested.emit(index))
            pull.triggered.connect(lambda: self.pull_requested.emit(index))
        menu.addSeparator()
        menu.addAction(self.copy_action)
        menu.addAction(self.export_action)
        return menu


@dataclass(frozen=True, eq=False)
class _Shown:
    """What the filters ask: text of each row, |d|, the tolerance, and which points are exact."""

    words: NDArray[np.str_]
    distance: NDArray[np.float64]
    tolerance: float
    core: NDArray[np.bool_]


class ResidualTable(QWidget):
    """All points of a horizon with their residuals."""

    point_chosen = Signal(int)
    exclude_requested = Signal(int)
    pull_requested = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.search = QLineEdit(clearButtonEnabled=True)
        self.search.setPlaceholderText(self.tr("Filter by hole, section, kind, patch or file"))
        self.search.setAccessibleName(self.tr("Filter of the residual table"))
        self.only_over = QCheckBox(self.tr("Over tolerance"))
        self.only_loose = QCheckBox(self.tr("Not exact"))
        self.only_loose.setToolTip(self.tr("Leave out the core's points, which the surface meets exactly."))
        self.count = QLabel()
        self.table = _Table()
        self.table.setAccessibleName(self.tr("Residuals of all points"))
        head = FlowLayout()
        for widget in (self.search, self.only_over, self.only_loose, self.count):
            head.addWidget(widget)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addLayout(head)
        column.addWidget(self.table, 1)
        self.pages = Placeholder(content)
        self.setLayout(self.pages)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._filter)
        self.search.textChanged.connect(self._pause.start)
        self.only_over.toggled.connect(self._filter)
        self.only_loose.toggled.connect(self._filter)
        self.table.chosen.connect(self.point_chosen)
        self.table.exclude_requested.connect(self.exclude_requested)
        self.table.pull_requested.connect(self.pull_requested)
        self._shown: _Shown | None = None
        self._surface: HorizonFit | None = None
        self.show_surface(None)

    def show_surface(self, surface: HorizonFit | None) -> None:
        """Show the residuals of a checked surface; None while there is none."""
        if surface is not None and surface is self._surface:
            return
        self._surface = surface
        if surface is None or surface.accuracy is None or not len(surface.points):
            self._shown = None
            self.table.show_columns(())
            empty = surface is not None and not len(surface.points)
            self.pages.say(
                self.tr("This surface came without points: there are no residuals.")
                if empty
                else self.tr("No surface yet: press Fit to see how far each point lies from it.")
            )
            return
        first = self._shown is None
        points, d = surface.points, surface.accuracy.residuals
        core = surface.core if len(surface.core) == len(d) else np.zeros(len(d), bool)
        kinds, patches = spoken_words(points.kind), spoken_words(surface.accuracy.patch)
        parts = (points.hole, points.section, kinds, patches, points.file)
        self._shown = _Shown(_joined(parts), np.abs(d), surface.settings.interior_tolerance, core)
        self.table.show_columns(self._columns(surface, core))
        if first:
            self.table.sortByColumn(_DISTANCE, Qt.SortOrder.DescendingOrder)
        self.only_over.setToolTip(
            self.tr("Only points further from the surface than the interior tolerance, {limit:g} m.").format(
                limit=self._shown.tolerance
            )
        )
        self._filter()
        self.pages.reveal()

    def choose(self, index: int | None) -> None:
        """Go to a point's row, as picked elsewhere; nothing is emitted."""
        if not self.table.choose(index) and index is not None and self._shown is not None:
            self.count.setText(self.tr("The picked point is hidden by the filter"))
        elif self._shown is not None:
            self._tell_count()

    def _columns(self, surface: HorizonFit, core: NDArray[np.bool_]) -> list[Column]:
        points, a = surface.points, surface.accuracy
        assert a is not None
        marks = _marks(surface, self)
        notes = np.full(len(points), "", dtype=object)
        for conflict in a.conflicts:
            notes[conflict.dropped] = str(conflict.text)
        exact = np.where(core, self.tr("exact"), "")
        return [
            Column(
                self.tr("Residual, m"),
                a.residuals,
                4,
                self.tr("Signed orthogonal distance: positive above the surface."),
                marks,
            ),
            Column(self.tr("|d|, m"), np.abs(a.residuals), 4, self.tr("Distance without its sign.")),
            Column(self.tr("Kind"), spoken_words(points.kind)),
            Column(self.tr("Hole"), points.hole),
            Column(self.tr("Section"), points.section),
            Column(self.tr("Patch"), spoken_words(a.patch)),
            Column(self.tr("Core"), exact, tooltip=self.tr("Whether the surface meets the point exactly.")),
            Column(self.tr("Easting, m"), points.xyz[:, 0], 3),
            Column(self.tr("Northing, m"), points.xyz[:, 1], 3),
            Column(self.tr("Elevation, m"), points.xyz[:, 2], 3),
            Column(self.tr("File"), points.file),
            Column(self.tr("Row"), points.row, 0, self.tr("Line of the file, counted from 1.")),
            Column(self.tr("Note"), notes.astype(str)),
        ]

    def _filter(self) -> None:
        if self._shown is None:
            return
        keep = np.ones(len(self._shown.distance), bool)
        if words := self.search.text().strip().casefold():
            keep &= np.char.find(self._shown.words, words) >= 0
        if self.only_over.isChecked():
            keep &= self._shown.distance > self._shown.tolerance
        if self.only_loose.isChecked():
            keep &= ~self._shown.core
        self.table.keep(None if keep.all() else keep)
        self._tell_count()

    def _tell_count(self) -> None:
        shown, total = self.table.rows.rowCount(), self.table.rows.total
        self.count.setText(
            self.tr("Points: {n}").format(n=total)
            if shown == total
            else self.tr("Points: {shown} of {n}").format(shown=shown, n=total)
        )


def _joined(parts: tuple[NDArray[np.str_], ...]) -> NDArray[np.str_]:
    joined = np.asarray(parts[0])
    for part in parts[1:]:
        joined = np.char.add(np.char.add(joined, "\n"), part)
    return np.char.lower(joined)


def _marks(surface: HorizonFit, panel: QWidget) -> Callable[[int], QIcon]:
    """Return the mark of each residual's band, as the deviation map draws it in the panel's theme."""
    assert surface.accuracy is not None
    d = surface.accuracy.residuals
    themes = bands(surface.settings), bands(surface.settings, dark=True)
    band = np.searchsorted([limit.low for limit in themes[0]], np.abs(d), side="right") - 1

    def mark(i: int) -> QIcon:
        limit = themes[is_dark(panel.palette())][band[i]]
        if band[i] == 0:
            return icon(f"dot:{limit.below}")
        return icon(f"down:{limit.below}" if d[i] < 0 else f"up:{limit.above}")

    return mark

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
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn, translated_column
from geofit.gui.theme import is_dark
from geofit.project.listing import Listing
from geofit.project.listing import listing as list_points
from geofit.project.provenance import Row
from geofit.report.style import bands

__all__ = ["ResidualTable"]

#: Wait for the next letter of the filter, milliseconds.
PAUSE = 150
_DISTANCE = 1
Bools = NDArray[np.bool_]


class _Table(DataTable):
    """The table with what can be done to its points."""

    exclude_requested = Signal()
    move_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.excluded: Bools = np.zeros(0, bool)

    def menu(self) -> QMenu:
        """Return the menu of the selected points."""
        menu = QMenu(self)
        chosen = self.selected
        again = bool(chosen) and bool(self.excluded[chosen].all())
        words = self.tr("Include in the fit again: {n}") if again else self.tr("Exclude from the fit: {n}")
        exclude = menu.addAction(words.format(n=len(chosen)))
        move_to = menu.addAction(self.tr("Move the surface to this point"))
        exclude.setEnabled(bool(chosen))
        move_to.setEnabled(self.current is not None)
        exclude.triggered.connect(self.exclude_requested)
        move_to.triggered.connect(self.move_requested)
        menu.addSeparator()
        menu.addAction(self.copy_action)
        menu.addAction(self.export_action)
        return menu


@dataclass(frozen=True, eq=False)
class _Shown:
    """What the filters ask: the points, text of each row, |d|, and the tolerance."""

    listing: Listing
    words: NDArray[np.str_]
    distance: NDArray[np.float64]
    tolerance: float


class ResidualTable(QWidget):
    """All points of a horizon with their residuals; excluded rows are greyed and struck through.

    Points are known by their rows: ``point_chosen`` and ``move_requested`` carry a Row, ``exclude_requested`` a tuple.
    """

    point_chosen = Signal(object)
    exclude_requested = Signal(object)
    move_requested = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.search = QLineEdit(clearButtonEnabled=True)
        self.search.setPlaceholderText(self.tr("Filter by hole, section, kind, patch or file"))
        self.search.setAccessibleName(self.tr("Filter of the residual table"))
        self.only_over = QCheckBox(self.tr("Over tolerance"))
        self.only_approximated = QCheckBox(self.tr("Not exact"))
        self.only_approximated.setToolTip(self.tr("Leave out the core's points, which the surface meets exactly."))
        self.only_excluded = QCheckBox(self.tr("Excluded"))
        self.only_excluded.setToolTip(self.tr("Only rows that take no part in the fit."))
        self.count = QLabel()
        self.table = _Table()
        self.table.setAccessibleName(self.tr("Residuals of all points"))
        head = FlowLayout()
        for widget in (self.search, self.only_over, self.only_approximated, self.only_excluded, self.count):
            head.addWidget(widget)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addLayout(head)
        column.addWidget(self.table, 1)
        self.pages = Placeholder(content, self)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._filter)
        self.search.textChanged.connect(self._pause.start)
        for box in (self.only_over, self.only_approximated, self.only_excluded):
            box.toggled.connect(self._filter)
        self.table.chosen.connect(lambda index: self.point_chosen.emit(self._row(index)))
        self.table.exclude_requested.connect(lambda: self.exclude_requested.emit(self.chosen_rows()))
        self.table.move_requested.connect(self._pull)
        self._shown: _Shown | None = None
        self.show_surface(None)

    def show_surface(self, surface: HorizonFit | None, listing: Listing | None = None) -> None:
        """Show the residuals of a checked surface; None while there is none.

        ``listing`` has all points of the horizon, excluded ones too; without it the surface's own points are shown.
        """
        if listing is not None and self._shown is not None and listing is self._shown.listing:
            return
        if surface is None or surface.accuracy is None or not len(surface.points):
            self._shown = None
            self.table.show_columns(())
            empty = surface is not None and not len(surface.points)
            self.pages.say(
                self.tr("This surface was read without points: there are no residuals.")
                if empty
                else self.tr("No surface yet: press Fit to see how far each point lies from it.")
            )
            return
        first, chosen = self._shown is None, self.chosen_rows() if self._shown is not None else ()
        listed = listing or list_points(surface.points, (), surface)
        points = listed.points
        kinds, patches = translated_column(points.kind), translated_column(listed.patch)
        parts = (points.hole, points.section, kinds, patches, points.file)
        distance = np.abs(listed.residual)
        self._shown = _Shown(listed, _joined(parts), distance, surface.settings.interior_tolerance)
        self.table.excluded = listed.excluded
        self.table.show_columns(self._columns(surface, listed), listed.excluded)
        if first:
            self.table.sortByColumn(_DISTANCE, Qt.SortOrder.DescendingOrder)
        self.only_over.setToolTip(
            self.tr("Only points further from the surface than the interior tolerance, {limit:g} m.").format(
                limit=self._shown.tolerance
            )
        )
        self._filter()
        self.table.select([i for row in chosen if (i := listed.index(row)) is not None])
        self.pages.reveal()

    def chosen_rows(self) -> tuple[Row, ...]:
        """Return the rows of all selected points."""
        return () if self._shown is None else self._shown.listing.rows(self.table.selected)

    def choose(self, row: Row | None) -> None:
        """Go to a point, as picked elsewhere; nothing is emitted. One of several selected rows leaves them selected."""
        index = None if self._shown is None else self._shown.listing.index(row)
        if index is not None and index in self.table.selected:
            return
        if not self.table.choose(index) and index is not None and self._shown is not None:
            self.count.setText(self.tr("The picked point is hidden by the filter"))
        elif self._shown is not None:
            self._tell_count()

    def _row(self, index: int) -> Row:
        assert self._shown is not None
        return self._shown.listing.rows([index])[0]

    def _pull(self) -> None:
        if self.table.current is not None:
            self.move_requested.emit(self._row(self.table.current))

    def _columns(self, surface: HorizonFit, listed: Listing) -> list[TableColumn]:
        points, a = listed.points, surface.accuracy
        assert a is not None
        notes = np.full(len(points), "", dtype=object)
        back = {int(place): index for index, place in enumerate(listed.place) if place >= 0}
        for conflict in a.conflicts:
            notes[back[conflict.dropped]] = str(conflict.text)
        notes[listed.excluded] = self.tr("excluded")
        exact = np.where(listed.core, self.tr("exact"), "")
        return [
            TableColumn(
                self.tr("Residual, m"),
                listed.residual,
                4,
                self.tr("Signed orthogonal distance: positive above the surface."),
                _marks(surface, listed.residual, self),
            ),
            TableColumn(self.tr("|d|, m"), np.abs(listed.residual), 4, self.tr("Distance without its sign.")),
            TableColumn(self.tr("Kind"), translated_column(points.kind)),
            TableColumn(self.tr("Hole"), points.hole),
            TableColumn(self.tr("Section"), points.section),
            TableColumn(self.tr("Patch"), translated_column(listed.patch)),
            TableColumn(self.tr("Core"), exact, tooltip=self.tr("Whether the surface meets the point exactly.")),
            TableColumn(self.tr("Easting, m"), points.xyz[:, 0], 3, coordinate=True),
            TableColumn(self.tr("Northing, m"), points.xyz[:, 1], 3, coordinate=True),
            TableColumn(self.tr("Elevation, m"), points.xyz[:, 2], 3),
            TableColumn(self.tr("File"), points.file),
            TableColumn(self.tr("Row"), points.row, 0, self.tr("Line of the file, counted from 1.")),
            TableColumn(self.tr("Note"), notes.astype(str)),
        ]

    def _filter(self) -> None:
        if self._shown is None:
            return
        listed = self._shown.listing
        keep = np.ones(len(self._shown.distance), bool)
        if words := self.search.text().strip().casefold():
            keep &= np.char.find(self._shown.words, words) >= 0
        if self.only_over.isChecked():
            keep &= self._shown.distance > self._shown.tolerance
        if self.only_approximated.isChecked():
            keep &= ~listed.core
        if self.only_excluded.isChecked():
            keep &= listed.excluded
        self.table.keep(None if keep.all() else keep)
        self._tell_count()

    def _tell_count(self) -> None:
        assert self._shown is not None
        shown, total = self.table.rows.rowCount(), self.table.rows.total
        text = (
            self.tr("Points: {n}").format(n=total)
            if shown == total
            else self.tr("Points: {shown} of {n}").format(shown=shown, n=total)
        )
        if out := int(self._shown.listing.excluded.sum()):
            text += " · " + self.tr("excluded: {n}").format(n=out)
        self.count.setText(text)


def _joined(parts: tuple[NDArray[np.str_], ...]) -> NDArray[np.str_]:
    joined = np.asarray(parts[0])
    for part in parts[1:]:
        joined = np.char.add(np.char.add(joined, "\n"), part)
    return np.char.lower(joined)


def _marks(surface: HorizonFit, d: NDArray[np.float64], panel: QWidget) -> Callable[[int], QIcon | None]:
    """Return the mark of each residual's band, as the deviation map draws it in the panel's theme."""
    themes = bands(surface.settings), bands(surface.settings, dark=True)
    band = np.searchsorted([limit.low for limit in themes[0]], np.nan_to_num(np.abs(d)), side="right") - 1

    def mark(i: int) -> QIcon | None:
        if np.isnan(d[i]):
            return None
        limit = themes[is_dark(panel.palette())][band[i]]
        if band[i] == 0:
            return icon(f"dot:{limit.below}")
        return icon(f"down:{limit.below}" if d[i] < 0 else f"up:{limit.above}")

    return mark

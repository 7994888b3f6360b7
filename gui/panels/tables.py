"""Tables of plain columns: sorted and filtered as whole arrays, copied as TSV, exported as CSV.

A QSortFilterProxyModel asks Python for two cells a comparison; 100,000 rows would take seconds a click. The model
here keeps the order of its rows as an index array and lets numpy sort it.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import (
    QAbstractTableModel,
    QEvent,
    QItemSelection,
    QItemSelectionModel,
    QModelIndex,
    QPersistentModelIndex,
    QPoint,
    Qt,
    Signal,
)
from PySide6.QtGui import QAction, QIcon, QKeySequence, QPalette, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QHeaderView, QMenu, QTableView, QWidget

from geofit.data.files import replacing, spreadsheet_cell
from geofit.gui.lengths import in_title, shown_coordinate, shown_length
from geofit.gui.preferences import Preferences
from geofit.gui.save_file import ask_save_file
from geofit.gui.translate import translated
from geofit.report.digits import typeset

__all__ = ["ArrayModel", "DataTable", "TableColumn", "natural", "translated_column"]

#: Pixels that are put between columns where there is room.
GAP = 12
Ints = NDArray[np.int64]
Index = QModelIndex | QPersistentModelIndex
_NOWHERE = QModelIndex()
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


def natural(text: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts ZK2 before ZK10.

    Examples
    --------
    >>> sorted(["ZK10", "ZK2"], key=natural)
    ['ZK2', 'ZK10']
    """
    parts = re.split(r"(\d+)", text.casefold())
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts if part)


def translated_column(values: ArrayLike) -> NDArray[np.str_]:
    """Return words of the core (kinds, patches) in the language of the windows, each asked for once."""
    words, place = np.unique(np.asarray(values, dtype=np.str_), return_inverse=True)
    return np.array([translated(str(word)) for word in words], dtype=np.str_)[place]


@dataclass(frozen=True, eq=False)
class TableColumn:
    """A column: its title, its values (n,), and with how many digits numbers are written (nan stays empty).

    ``icons`` returns the mark before a cell; ``order`` is what the column sorts by, where that is not the values.
    ``coordinate``: they are eastings or northings. ``measured``: texts that are numbers with their units.
    """

    title: str
    values: NDArray[Any]
    digits: int | None = None
    tooltip: str = ""
    icons: Callable[[int], QIcon | None] | None = None
    order: ArrayLike | None = None
    coordinate: bool = False
    measured: bool = False

    def text(self, row: int) -> str:
        """Return the cell as it is written into files: spreadsheets read its numbers."""
        value = self.values[row]
        if self.digits is None:
            return str(value)
        # Adding 0 turns -0.000 into 0.000.
        return "" if np.isnan(value) else f"{round(float(value), self.digits) + 0.0:.{self.digits}f}"

    def cell(self, row: int) -> str:
        """Return the cell as it is shown: numbers with a minus sign, in groups of three unless they are coordinates."""
        text = self.text(row)
        if self.digits is None or not text:
            return text
        return text.replace("-", "−") if self.coordinate else typeset(text)

    def shown(self) -> TableColumn:
        """Return the column as it is shown: one of lengths, whose title ends in ", m", in the chosen unit."""
        title = in_title(self.title, coordinate=self.coordinate)
        if title == self.title or not self.number:
            return self
        shown = shown_coordinate if self.coordinate else shown_length
        return replace(self, title=title, values=shown(np.asarray(self.values, float)))

    @property
    def number(self) -> bool:
        """Whether the cells are numbers."""
        return self.values.dtype.kind in "fiu"

    @property
    def side(self) -> Qt.AlignmentFlag:
        """At which side the cells stand."""
        return _RIGHT if self.number or self.measured else _LEFT

    @cached_property
    def rank(self) -> NDArray[Any]:
        """What sorts the rows: numbers as they are, texts in natural order."""
        if self.order is not None:
            return np.asarray(self.order)
        if self.number:
            return self.values
        words, place = np.unique(self.values.astype(str), return_inverse=True)
        rank = np.empty(len(words), np.int64)
        rank[sorted(range(len(words)), key=lambda i: natural(str(words[i])))] = np.arange(len(words))
        return rank[place]


class ArrayModel(QAbstractTableModel):
    """Columns in the order that numpy sorted them in; ``source`` and ``row_of`` turn rows into the data's indices."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.columns: Sequence[TableColumn] = ()
        self._order: Ints = np.zeros(0, np.int64)
        self._kept: NDArray[np.bool_] | None = None
        self._struck: NDArray[np.bool_] | None = None
        self._sorted: tuple[int, Qt.SortOrder] | None = None

    def set_columns(self, columns: Sequence[TableColumn], struck: NDArray[np.bool_] | None = None) -> None:
        """Take other data; what was filtered is shown again, and the sorting stays.

        Rows where ``struck`` is true are greyed and struck through.
        """
        self.beginResetModel()
        self.columns, self._kept, self._struck = tuple(columns), None, struck
        self._arrange()
        self.endResetModel()

    def keep(self, mask: NDArray[np.bool_] | None) -> None:
        """Show only some rows of the data; None shows all."""
        self.beginResetModel()
        self._kept = mask
        self._arrange()
        self.endResetModel()

    @property
    def total(self) -> int:
        """Rows of the data, hidden ones included."""
        return len(self.columns[0].values) if self.columns else 0

    def source(self, row: int) -> int:
        """Return the data's index of a row."""
        return int(self._order[row])

    def row_of(self, source: int) -> int:
        """Return the row of a data's index; -1 if it is hidden."""
        found = np.flatnonzero(self._order == source)
        return int(found[0]) if len(found) else -1

    def rowCount(self, parent: Index = _NOWHERE) -> int:  # noqa: N802
        """Return how many rows are shown."""
        return 0 if parent.isValid() else len(self._order)

    def columnCount(self, parent: Index = _NOWHERE) -> int:  # noqa: N802
        """Return how many columns there are."""
        return 0 if parent.isValid() else len(self.columns)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return what a cell shows."""
        column = self.columns[index.column()]
        if role == Qt.ItemDataRole.DisplayRole:
            return column.cell(self._order[index.row()])
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return column.side
        if role == Qt.ItemDataRole.DecorationRole and column.icons is not None:
            return column.icons(int(self._order[index.row()]))
        if role == Qt.ItemDataRole.ToolTipRole and not column.number:
            return column.text(self._order[index.row()])
        if self._struck is not None and self._struck[self._order[index.row()]]:
            if role == Qt.ItemDataRole.FontRole:
                font = QApplication.font()
                font.setStrikeOut(True)
                return font
            if role == Qt.ItemDataRole.ForegroundRole:
                return QApplication.palette().brush(QPalette.ColorGroup.Disabled, QPalette.ColorRole.Text)
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: N802
        """Return a column's title and what it means."""
        if orientation != Qt.Orientation.Horizontal or not 0 <= section < len(self.columns):
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return self.columns[section].title
        if role == Qt.ItemDataRole.ToolTipRole:
            return self.columns[section].tooltip or None
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return self.columns[section].side
        return None

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort by a column; equal cells keep the data's order, empty numbers come last."""
        self.layoutAboutToBeChanged.emit()
        before = self.persistentIndexList()
        sources = [self.source(index.row()) for index in before]
        self._sorted = (column, order)
        self._arrange()
        place = np.full(self.total, -1)
        place[self._order] = np.arange(len(self._order))
        after = [self.index(int(place[s]), i.column()) for i, s in zip(before, sources, strict=True)]
        self.changePersistentIndexList(before, after)
        self.layoutChanged.emit()

    def _arrange(self) -> None:
        rows = np.arange(self.total) if self._kept is None else np.flatnonzero(self._kept)
        if self._sorted is not None and 0 <= self._sorted[0] < len(self.columns):
            rank = np.asarray(self.columns[self._sorted[0]].rank)[rows]
            if self._sorted[1] == Qt.SortOrder.DescendingOrder:
                rank = -rank.astype(float)
            rows = rows[np.argsort(rank, kind="stable")]
        self._order = rows


class DataTable(QTableView):
    """A table whose rows are chosen, copied (Ctrl+C, with a head line) and exported.

    ``chosen`` carries the data's index of the row that the user went to, never one that :meth:`choose` set.
    """

    chosen = Signal(int)

    #: Whether the columns are as wide as their cells, and put apart; also before the table is made.
    _sized = _spaced = False

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.rows = ArrayModel(self)
        self.setModel(self.rows)
        # Made here: PySide, asked for the one that Qt makes, once returned an object without its signals.
        self._selection = QItemSelectionModel(self.rows, self)
        self.setSelectionModel(self._selection)
        self.setSortingEnabled(True)
        self.horizontalHeader().setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        self.horizontalHeader().setSortIndicatorClearable(True)
        self.horizontalHeader().setResizeContentsPrecision(40)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        self.horizontalHeader().setMinimumSectionSize(36)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setTabKeyNavigation(False)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.customContextMenuRequested.connect(self._open_menu)
        self.copy_action = QAction(self.tr("Copy"), self)
        self.copy_action.setShortcut(QKeySequence.StandardKey.Copy)
        self.copy_action.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        self.copy_action.triggered.connect(self.copy)
        self.export_action = QAction(self.tr("Export as CSV…"), self)
        self.export_action.triggered.connect(self._ask_where)
        self.addAction(self.copy_action)
        self._silent = False
        self._selection.currentRowChanged.connect(self._tell)

    def show_columns(self, columns: Sequence[TableColumn], struck: NDArray[np.bool_] | None = None) -> None:
        """Take other data, keep the sorting, and fit the columns to their cells the first time."""
        self._silent = True
        self.rows.set_columns([column.shown() for column in columns], struck)
        self._silent = False
        if columns and not self._sized:
            self.resizeColumnsToContents()
            self._sized = self.rows.total > 0
            self._spaced = False
            self._space()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the size of text: neither a row nor a column cuts it off."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.FontChange:
            self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
            if self._sized:
                self.resizeColumnsToContents()
                self._spaced = False
                self._space()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the columns apart once there is room."""
        super().resizeEvent(event)
        self._space()

    def _space(self) -> None:
        count = self.rows.columnCount()
        if not self._spaced and count and self.horizontalHeader().length() + GAP * count <= self.viewport().width():
            self._spaced = True
            for column in range(count):
                self.setColumnWidth(column, self.columnWidth(column) + GAP)

    def keep(self, mask: NDArray[np.bool_] | None) -> None:
        """Show only some rows; the current one stays current if it is among them."""
        current = self.current
        self._silent = True
        self.rows.keep(mask)
        self._silent = False
        if current is not None:
            self.choose(current)

    @property
    def selected(self) -> list[int]:
        """The data's indices of all selected rows, as they are sorted."""
        return [self.rows.source(row) for row in sorted(i.row() for i in self._selection.selectedRows())]

    @property
    def current(self) -> int | None:
        """The data's index of the current row."""
        index = self.currentIndex()
        return self.rows.source(index.row()) if index.isValid() else None

    def choose(self, source: int | None) -> bool:
        """Go to a row without telling anybody; return whether it is shown."""
        row = -1 if source is None else self.rows.row_of(source)
        self._silent = True
        if row < 0:
            self.clearSelection()
            self.setCurrentIndex(QModelIndex())
        else:
            index = self.rows.index(row, 0)
            self.selectRow(row)
            self.scrollTo(index, QAbstractItemView.ScrollHint.PositionAtCenter)
        self._silent = False
        return row >= 0

    def select(self, sources: Sequence[int]) -> None:
        """Select rows, those that are shown, without telling anybody."""
        rows = [row for row in (self.rows.row_of(source) for source in sources) if row >= 0]
        if not rows:
            return
        self._silent = True
        chosen = QItemSelection()
        for row in rows:
            chosen.select(self.rows.index(row, 0), self.rows.index(row, self.rows.columnCount() - 1))
        self.setCurrentIndex(self.rows.index(rows[0], 0))
        self._selection.select(chosen, QItemSelectionModel.SelectionFlag.ClearAndSelect)
        self._silent = False

    def menu(self) -> QMenu:
        """Return the menu of the current row; others put their actions before these."""
        menu = QMenu(self)
        menu.addAction(self.copy_action)
        menu.addAction(self.export_action)
        return menu

    def copy(self) -> None:
        """Put the selected rows on the clipboard as tab-separated text; all of them if none is selected."""
        rows = sorted(index.row() for index in self._selection.selectedRows())
        QApplication.clipboard().setText(self._written(rows or range(self.rows.rowCount()), "\t"))

    def export(self, path: str | PathLike[str]) -> None:
        """Write the rows that are shown, as they are sorted, as CSV."""
        with replacing(path) as part:
            # The byte-order mark tells spreadsheets that the text is UTF-8.
            part.write_text(self._written(range(self.rows.rowCount()), ","), encoding="utf-8-sig", newline="")

    def _written(self, rows: Sequence[int], separator: str) -> str:
        stream = io.StringIO()
        writer = csv.writer(stream, delimiter=separator, lineterminator="\n")
        writer.writerow([column.title for column in self.rows.columns])
        sources = [self.rows.source(row) for row in rows]
        writer.writerows([spreadsheet_cell(column.text(source)) for column in self.rows.columns] for source in sources)
        return stream.getvalue()

    def _ask_where(self) -> None:
        chosen = ask_save_file(
            self, self.tr("Export as CSV"), Preferences().folder, self.tr("Comma-separated values (*.csv)")
        )
        if chosen is not None:
            self.export(str(chosen[0]))

    def _open_menu(self, place: QPoint) -> None:
        if self.rows.rowCount():
            menu = self.menu()
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(self.viewport().mapToGlobal(place))

    def _tell(self, current: QModelIndex) -> None:
        if not self._silent and current.isValid():
            self.chosen.emit(self.rows.source(current.row()))

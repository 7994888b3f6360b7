"""The rows of a tree as plain objects, and the model that a view reads them through.

Qt's standard items belong to Python and to C++ at once; PySide has been seen to free them twice when a tree is emptied.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from PySide6.QtCore import QAbstractItemModel, QModelIndex, QObject, QPersistentModelIndex, Qt
from PySide6.QtGui import QFont, QIcon

__all__ = ["OPACITY", "SHOWN", "TreeModel", "TreeRow"]

_Index = QModelIndex | QPersistentModelIndex
_Role = Qt.ItemDataRole
#: The columns after the text.
SHOWN, OPACITY = 1, 2


@dataclass(eq=False)
class TreeRow:
    """A row: its text, what is counted, its target (kind and name), and the rows below it.

    ``layer`` is the key of what the scene shows of it: with it, a row has an eye that is open where it is ``checked``,
    and an ``opacity``; None: it has none. ``aloud`` is what a screen reader says in place of the text. A head is bold,
    and can be chosen where it has a layer.
    """

    text: str
    target: tuple[str, str]
    count: int | None = None
    mark: QIcon | None = None
    words: str = ""
    aloud: str = ""
    layer: str = ""
    checked: bool | None = None
    opacity: float | None = None
    italic: bool = False
    head: bool = False
    rows: list[TreeRow] = field(default_factory=list)


class TreeModel(QAbstractItemModel):
    """Rows in three columns: text, eye and opacity. ``check`` hears of an eye that a person opens or closes."""

    def __init__(self, check: Callable[[TreeRow, bool], object], parent: QObject) -> None:
        super().__init__(parent)
        self._check = check
        self.rows: list[TreeRow] = []
        self._flat: list[TreeRow] = []
        self._place: dict[TreeRow, tuple[TreeRow | None, int, int]] = {}

    def show(self, rows: Sequence[TreeRow]) -> None:
        """Show other rows."""
        self.beginResetModel()
        self.rows, self._flat, self._place = list(rows), [], {}
        self._number(None, self.rows)
        self.endResetModel()

    def all(self) -> Iterator[TreeRow]:
        """Yield every row, those below a row after it."""
        yield from self._flat

    def index_of(self, row: TreeRow) -> QModelIndex:
        """Return the index of a row's text."""
        _, number, key = self._place[row]
        return self.createIndex(number, 0, key)

    def renew(self, row: TreeRow) -> None:
        """Show a row anew: its eye or its opacity has changed."""
        if row in self._place:
            first = self.index_of(row)
            self.dataChanged.emit(first, first.siblingAtColumn(OPACITY))

    def row_of(self, index: _Index) -> TreeRow | None:
        """Return the row of an index; None for one that is not valid."""
        return self._flat[index.internalId()] if index.isValid() else None

    def _number(self, parent: TreeRow | None, rows: Sequence[TreeRow]) -> None:
        for number, row in enumerate(rows):
            self._place[row] = (parent, number, len(self._flat))
            self._flat.append(row)
            self._number(row, row.rows)

    def index(self, row: int, column: int, parent: _Index = QModelIndex()) -> QModelIndex:  # noqa: B008
        """Return the index of a row below another one."""
        above = self.row_of(parent)
        rows = self.rows if above is None else above.rows
        if not (0 <= row < len(rows) and 0 <= column <= OPACITY) or (above is not None and parent.column()):
            return QModelIndex()
        return self.createIndex(row, column, self._place[rows[row]][2])

    def parent(self, child: _Index) -> QModelIndex:  # type: ignore[override]
        """Return the index of the row above."""
        row = self.row_of(child)
        above = None if row is None else self._place[row][0]
        return QModelIndex() if above is None else self.index_of(above)

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008, N802
        """Return the number of rows below one."""
        above = self.row_of(parent)
        return len(self.rows) if above is None else 0 if parent.column() else len(above.rows)

    def columnCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008, N802
        """Return 3: text, eye and opacity."""
        return 3

    def flags(self, index: _Index) -> Qt.ItemFlag:
        """Return what a person can do with a row."""
        row = self.row_of(index)
        if row is None:
            return Qt.ItemFlag.NoItemFlags
        if row.head and not row.layer:
            return Qt.ItemFlag.ItemIsEnabled
        able = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return able | Qt.ItemFlag.ItemIsUserCheckable if row.checked is not None and index.column() == SHOWN else able

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = _Role.DisplayRole) -> Any:  # noqa: N802
        """Return the titles of the columns, which screen readers say."""
        titles = self.tr("Project"), self.tr("Shown"), self.tr("Opacity")
        return titles[section] if orientation == Qt.Orientation.Horizontal and role == _Role.DisplayRole else None

    def data(self, index: _Index, role: int = _Role.DisplayRole) -> Any:
        """Return what a view shows of a cell."""
        row = self.row_of(index)
        if row is None:
            return None
        if index.column() == SHOWN:
            return self._visibility(row, role)
        if index.column() == OPACITY:
            return self._opacity(row, role)
        if role == _Role.ToolTipRole:
            return None if row.head else self._words(row)
        if role == _Role.FontRole and (row.head or row.italic):
            font = QFont()
            font.setBold(row.head)
            font.setItalic(row.italic)
            return font
        if role == _Role.AccessibleTextRole:
            return row.aloud or row.text
        return row.text if role == _Role.DisplayRole else row.mark if role == _Role.DecorationRole else None

    def _words(self, row: TreeRow) -> str:
        counted = "" if row.count is None else "\n" + self.tr("Points: {n}").format(n=row.count)
        return (row.words or row.text) + counted

    def _visibility(self, row: TreeRow, role: int) -> Any:
        if row.checked is None:
            return None
        if role == _Role.CheckStateRole:
            return Qt.CheckState.Checked if row.checked else Qt.CheckState.Unchecked
        if role in (_Role.AccessibleTextRole, _Role.ToolTipRole):
            return self.tr("Shown in the scene") if row.checked else self.tr("Hidden in the scene")
        return None

    def _opacity(self, row: TreeRow, role: int) -> Any:
        if row.opacity is None:
            return None
        if role == _Role.EditRole:
            return row.opacity
        if role in (_Role.AccessibleTextRole, _Role.ToolTipRole):
            return self.tr("Opacity {percent} %").format(percent=round(100 * row.opacity))
        return None

    def setData(self, index: _Index, value: Any, role: int = _Role.EditRole) -> bool:  # noqa: N802
        """Open or close an eye, and tell of it."""
        row = self.row_of(index)
        if row is None or row.checked is None or role != _Role.CheckStateRole or index.column() != SHOWN:
            return False
        row.checked = Qt.CheckState(value) == Qt.CheckState.Checked
        self.renew(row)
        self._check(row, row.checked)
        return True

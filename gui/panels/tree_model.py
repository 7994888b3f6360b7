"""The rows of a tree as plain objects, and the model that a view reads them through.

Qt's standard items belong to Python and to C++ at once; PySide has been seen to free them twice when a tree is emptied.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from PySide6.QtCore import QAbstractItemModel, QModelIndex, QObject, QPersistentModelIndex, Qt
from PySide6.QtGui import QFont, QIcon

__all__ = ["TreeModel", "TreeRow"]

_Index = QModelIndex | QPersistentModelIndex
_Role = Qt.ItemDataRole


@dataclass(eq=False)
class TreeRow:
    """A row: its text, what is counted, its target (kind and name), and the rows below it.

    ``checked`` is None for a row without a check box; ``aloud`` is what a screen reader says in place of the text.
    A head is bold and cannot be chosen.
    """

    text: str
    target: tuple[str, str]
    count: int | None = None
    mark: QIcon | None = None
    words: str = ""
    aloud: str = ""
    checked: bool | None = None
    italic: bool = False
    head: bool = False
    rows: list[TreeRow] = field(default_factory=list)


class TreeModel(QAbstractItemModel):
    """Rows in two columns: text, and count. ``check`` hears of a check box that a person changes."""

    def __init__(self, titles: Sequence[str], check: Callable[[TreeRow, bool], object], parent: QObject) -> None:
        super().__init__(parent)
        self._titles, self._check = tuple(titles), check
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
        if not (0 <= row < len(rows) and 0 <= column < 2) or (above is not None and parent.column()):
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
        """Return 2: text and count."""
        return 2

    def flags(self, index: _Index) -> Qt.ItemFlag:
        """Return what a person can do with a row."""
        row = self.row_of(index)
        if row is None:
            return Qt.ItemFlag.NoItemFlags
        if row.head:
            return Qt.ItemFlag.ItemIsEnabled
        able = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return able | Qt.ItemFlag.ItemIsUserCheckable if row.checked is not None and not index.column() else able

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = _Role.DisplayRole) -> Any:  # noqa: N802
        """Return the titles of the columns."""
        if orientation == Qt.Orientation.Horizontal and role == _Role.DisplayRole:
            return self._titles[section]
        if role == _Role.TextAlignmentRole and section == 1:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return None

    def data(self, index: _Index, role: int = _Role.DisplayRole) -> Any:
        """Return what a view shows of a cell."""
        row = self.row_of(index)
        if row is None:
            return None
        if role == _Role.ToolTipRole:
            return None if row.head else row.words or row.text
        if index.column():
            if role == _Role.DisplayRole:
                return "" if row.count is None or row.head else f"{row.count}"
            right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            return right if role == _Role.TextAlignmentRole else None
        if role == _Role.FontRole and (row.head or row.italic):
            font = QFont()
            font.setBold(row.head)
            font.setItalic(row.italic)
            return font
        if role == _Role.CheckStateRole and row.checked is not None:
            return Qt.CheckState.Checked if row.checked else Qt.CheckState.Unchecked
        if role == _Role.AccessibleTextRole:
            return row.aloud or row.text
        return row.text if role == _Role.DisplayRole else row.mark if role == _Role.DecorationRole else None

    def setData(self, index: _Index, value: Any, role: int = _Role.EditRole) -> bool:  # noqa: N802
        """Change a check box, and tell of it."""
        row = self.row_of(index)
        if row is None or row.checked is None or role != _Role.CheckStateRole:
            return False
        row.checked = Qt.CheckState(value) == Qt.CheckState.Checked
        self.dataChanged.emit(index, index, [role])
        self._check(row, row.checked)
        return True

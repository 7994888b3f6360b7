"""Rows that the readers did not use, or have a word to say about: file, row, column, value, reason."""

from __future__ import annotations

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QSortFilterProxyModel, Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from geofit.data.site import ImportIssue, Site
from geofit.gui.save_file import ask_save_file
from geofit.gui.translate import translated, user_language

__all__ = ["IssuesDialog"]

_Index = QModelIndex | QPersistentModelIndex
_NO_PARENT = QModelIndex()
_NUMBER = Qt.ItemDataRole.UserRole


class IssuesDialog(QDialog):
    """A table of the issues of a site, sortable, exported as CSV."""

    def __init__(self, site: Site, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Import problems"))
        self._site = site
        read, used, listed = (sum(getattr(c, key) for c in site.counts) for key in ("read", "used", "listed"))
        text = self.tr("Rows read: {read} = {used} used + {listed} listed here.")
        self.balance = QLabel(text.format(read=read, used=used, listed=listed))
        self.table = QTableView()
        self.table.setAccessibleName(self.windowTitle())
        self.table.setTabKeyNavigation(False)
        rows = QSortFilterProxyModel(self)
        rows.setSourceModel(_Issues(site.issues, self))
        rows.setSortRole(_NUMBER)
        self.table.setModel(rows)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(0, Qt.SortOrder.AscendingOrder)
        self.table.setAlternatingRowColors(True)
        self.table.setWordWrap(True)
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.verticalHeader().hide()
        header = self.table.horizontalHeader()
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        for column in (5, 6):
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Stretch)
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        export = QPushButton(self.tr("&Export CSV…"))
        export.clicked.connect(self._export)
        buttons = QDialogButtonBox()
        buttons.addButton(export, QDialogButtonBox.ButtonRole.ActionRole)
        close = buttons.addButton(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(self.balance)
        layout.addWidget(self.table)
        layout.addWidget(buttons)
        # Now that it is in the dialog; else Enter would press the first button.
        close.setDefault(True)
        self.resize(900, 480)

    def _export(self) -> None:
        from geofit.report.tables import write_issues

        chosen = ask_save_file(self, self.windowTitle(), "import_issues.csv", "CSV (*.csv)")
        if chosen is not None:
            write_issues(self._site.issues, chosen[0], user_language())


class _Issues(QAbstractTableModel):
    def __init__(self, issues: tuple[ImportIssue, ...], parent: QWidget) -> None:
        super().__init__(parent)
        rank = {"error": 0, "warning": 1, "note": 2}
        words = {"error": self.tr("not used"), "warning": self.tr("to check"), "note": self.tr("note")}
        self._rows = [
            (
                words[i.severity],
                i.file,
                i.row or "",
                i.column,
                i.value,
                translated(i.reason),
                translated(i.remedy),
            )
            for i in issues
        ]
        # What concerns a whole file comes first: rows that were not used may be many, and would hide it.
        first = [rank[i.severity] - (0 if i.row or i.severity == "note" else len(rank)) for i in issues]
        self._keys = [
            (place, i.file, i.row, i.column, i.value, i.reason, i.remedy)
            for place, i in zip(first, issues, strict=True)
        ]
        self._heads = (
            self.tr("State"), self.tr("File"), self.tr("Row"), self.tr("Column"), self.tr("Value"), self.tr("Reason"),
            self.tr("What to do"),
        )  # fmt: skip

    def rowCount(self, parent: _Index = _NO_PARENT) -> int:  # noqa: N802
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: _Index = _NO_PARENT) -> int:  # noqa: N802
        return 0 if parent.isValid() else len(self._heads)

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return str(self._rows[index.row()][index.column()])
        if role == _NUMBER:
            return self._keys[index.row()][index.column()]
        return None

    def headerData(  # noqa: N802
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> object:
        if orientation == Qt.Orientation.Horizontal and role == Qt.ItemDataRole.DisplayRole:
            return self._heads[section]
        return None

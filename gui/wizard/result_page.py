"""What an import made: horizons with their points, rows used and listed, and every problem with its remedy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.panels.marks import icon
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import translated
from geofit.project.importing import Import
from geofit.report import digits

__all__ = ["ResultPage"]

_ORDER = {"error": 0, "warning": 1, "note": 2}
_MARK = {"error": "failed", "warning": "warning", "note": "none"}
#: Widest column of reasons: what to do about them must be seen beside it.
_REASON = 330


class ResultPage(QWidget):
    """Shows an :class:`geofit.project.importing.Import`."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.balance = QLabel()
        self.balance.setWordWrap(True)
        self.horizons, self.files, self.issues = DataTable(), DataTable(), DataTable()
        self.notes = QCheckBox(self.tr("Show &notes (guesses that were made)"))
        self.notes.toggled.connect(self._filter)
        self._severity = np.zeros(0, np.int64)
        export = QPushButton(self.tr("&Export problems…"))
        export.clicked.connect(self.issues.export_action.trigger)
        above = QSplitter(Qt.Orientation.Horizontal)
        above.addWidget(_titled(QLabel(self.tr("Horizons")), self.horizons))
        above.addWidget(_titled(QLabel(self.tr("Files", "ResultPage")), self.files))
        below = QHBoxLayout()
        below.addWidget(self.notes)
        below.addStretch()
        below.addWidget(export)
        parts = QSplitter(Qt.Orientation.Vertical)
        parts.addWidget(above)
        self.problems = QLabel(self.tr("Problems"))
        problems = _titled(self.problems, self.issues)
        problems.layout().addLayout(below)  # type: ignore[union-attr]
        parts.addWidget(problems)
        parts.setStretchFactor(0, 2)
        parts.setStretchFactor(1, 3)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.balance)
        layout.addWidget(parts, 1)

    def show_import(self, found: Import) -> None:
        """Show what an import made."""
        read, used, listed = (sum(getattr(count, key) for count in found.counts) for key in ("read", "used", "listed"))
        text = self.tr("{read} rows read = {used} used + {listed} listed below.").format(
            read=digits.count(read), used=digits.count(used), listed=digits.count(listed)
        )
        if not found.site.horizons:
            text += " " + self.tr("No horizon was found: go back, and add intervals, sections, traces or points.")
        self.balance.setText(text)
        names = list(found.site.horizons)
        sizes = np.array([len(found.site.horizons[name]) for name in names], float)
        self.horizons.show_columns(
            (TableColumn(self.tr("Horizon"), np.array(names, str)), TableColumn(self.tr("Points"), sizes, 0))
        )
        counts = found.counts
        files = _short({count.file for count in counts} | {one.file for one in found.issues})
        self.files.show_columns(
            (
                TableColumn(self.tr("File"), np.array([files[count.file] for count in counts], str)),
                *(
                    TableColumn(title, np.array([getattr(count, key) for count in counts], float), 0)
                    for title, key in (
                        (self.tr("Rows"), "read"),
                        (self.tr("Used"), "used"),
                        (self.tr("Listed"), "listed"),
                    )
                ),
            )
        )
        for table in (self.horizons, self.files):
            table.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        issues = sorted(found.issues, key=lambda one: _ORDER[one.severity])
        words = {"error": self.tr("not used"), "warning": self.tr("to check"), "note": self.tr("note")}
        self._severity = np.array([_ORDER[one.severity] for one in issues], np.int64)
        loud = int((self._severity < _ORDER["note"]).sum())
        self.problems.setText(self.tr("Problems: {count}").format(count=loud) if loud else self.tr("Problems: none"))
        self.issues.show_columns(
            (
                TableColumn(
                    self.tr("Kind", "ResultPage"),
                    np.array([words[one.severity] for one in issues], str),
                    icons=lambda row: icon(_MARK[issues[row].severity]),
                    order=self._severity,
                ),
                TableColumn(self.tr("File"), np.array([files[one.file] for one in issues], str)),
                TableColumn(self.tr("Row"), np.array([one.row or np.nan for one in issues], float), 0),
                TableColumn(self.tr("Column"), np.array([one.column for one in issues], str)),
                TableColumn(self.tr("Value"), np.array([one.value for one in issues], str)),
                TableColumn(self.tr("Reason"), np.array([translated(one.reason) for one in issues], str)),
                TableColumn(self.tr("What to do"), np.array([translated(one.remedy) for one in issues], str)),
            )
        )
        header = self.issues.horizontalHeader()
        reason, remedy = header.count() - 2, header.count() - 1
        header.resizeSection(reason, min(header.sectionSize(reason), _REASON))
        header.setSectionResizeMode(remedy, QHeaderView.ResizeMode.Stretch)
        quiet = int((self._severity == _ORDER["note"]).sum())
        self.notes.setText(self.tr("Show &notes ({count} guesses that were made)").format(count=quiet))
        self._filter()

    def _filter(self) -> None:
        self.issues.keep(None if self.notes.isChecked() else self._severity < _ORDER["note"])


def _short(paths: set[str]) -> dict[str, str]:
    """Return what files are called: without their folders, where that leaves no two alike."""
    names = {path: Path(path).name for path in paths}
    return names if len(set(names.values())) == len(names) else {path: path for path in paths}


def _titled(label: QLabel, table: DataTable) -> QWidget:
    box = QWidget()
    layout = QVBoxLayout(box)
    layout.setContentsMargins(0, 0, 0, 0)
    label.setBuddy(table)
    table.setAccessibleName(label.text())
    layout.addWidget(label)
    layout.addWidget(table)
    return box

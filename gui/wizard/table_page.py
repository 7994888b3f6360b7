"""One table of the wizard: what its rows are, how it is read, and which column holds what, above its first rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QFormLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.theme import is_dark
from geofit.gui.translate import failure, translated
from geofit.gui.wizard.draft import Draft
from geofit.gui.wizard.words import kind_name, role_name
from geofit.io.columns import plain_name
from geofit.io.mapping import KINDS
from geofit.io.preview import TablePreview
from geofit.io.source import Source
from geofit.io.units import unit_marked
from geofit.report import digits

__all__ = ["TablePage"]

ENCODINGS = ("utf-8", "gb18030", "cp1252", "utf-16")
#: What editors call them.
ENCODING_NAMES = {
    "utf-8": "UTF-8", "gb18030": "GB 18030", "cp1252": "Windows-1252", "utf-16": "UTF-16", "utf-8-sig": "UTF-8 (BOM)",
}  # fmt: skip
UNITS = ("", "m", "ft", "ft-us", "km", "cm", "mm")
#: Ground of a cell that should hold a number and does not, on light and dark.
BAD = {False: "#f6c5be", True: "#7c2f27"}


class TablePage(QWidget):
    """Shows a draft and lets the user overrule it.

    ``role_changed(column, role)`` when a column is named; ``reading_changed(source, kind)`` when the table must be
    read again; ``exchange_requested()`` when easting and northing are to change places.
    """

    exchange_requested = Signal()
    role_changed = Signal(int, str)
    reading_changed = Signal(object, str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._draft: Draft | None = None
        self.kind, self.encoding, self.separator, self.decimal, self.unit = (QComboBox() for _ in range(5))
        for box, name in (
            (self.kind, self.tr("What the rows are")),
            (self.encoding, self.tr("Encoding")),
            (self.separator, self.tr("Separator")),
            (self.decimal, self.tr("Decimal mark")),
            (self.unit, self.tr("Unit of lengths")),
        ):
            box.setAccessibleName(name)
            box.activated.connect(self._read_again)
        self.kind.setMinimumContentsLength(24)
        left, right = QFormLayout(), QFormLayout()
        left.addRow(self.tr("R&ows are"), self.kind)
        left.addRow(self.tr("&Encoding"), self.encoding)
        right.addRow(self.tr("&Separator"), self.separator)
        right.addRow(self.tr("&Decimal mark"), self.decimal)
        left.addRow(self.tr("&Unit of lengths"), self.unit)
        form = QHBoxLayout()
        form.addLayout(left, 2)
        form.addLayout(right, 1)
        self.message = QLabel()
        self.message.setWordWrap(True)
        self.exchange = QPushButton(self.tr("E&xchange easting and northing"))
        self.exchange.clicked.connect(self.exchange_requested)
        self.table = QTableWidget()
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.table.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.table.setTabKeyNavigation(False)
        self.table.setAccessibleName(self.tr("First rows of the table"))
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.table.verticalHeader().hide()
        self.table.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(form)
        message_row = QHBoxLayout()
        message_row.addWidget(self.message, 1)
        message_row.addWidget(self.exchange, 0, Qt.AlignmentFlag.AlignBottom)
        layout.addLayout(message_row)
        layout.addWidget(self.table, 1)

    def show_draft(self, draft: Draft, *, ground: bool) -> None:
        """Show a table; ``ground`` signals that collars without an elevation can stand on one."""
        last = self._draft
        same = last is not None and last.preview is draft.preview and last.kind == draft.kind
        self._draft = draft
        self._show_reading(draft)
        if not same:
            self._show_rows(draft)
        self._mark(draft)
        self.exchange.setVisible(draft.exchanged)
        self.message.setText(" ".join(self._sentences(draft, ground)))

    def _show_reading(self, draft: Draft) -> None:
        preview, source = draft.preview, draft.source
        kinds = [*preview.kinds, *(kind for kind in KINDS if kind not in preview.kinds)]
        self.kind.clear()
        if not draft.kind:
            self.kind.addItem(kind_name(""), "")
        for kind in kinds:
            share = preview.kinds.get(kind, 0.0)
            sure = self.tr("{kind} ({share:.0%} likely)").format(kind=kind_name(kind), share=share)
            guessed = 0 < share < 1 and not draft.changed
            self.kind.addItem(sure if guessed else kind_name(kind), kind)
        self.kind.setCurrentIndex(self.kind.findData(draft.kind))
        text = bool(preview.sep)
        encoding = source.encoding or preview.encoding
        _fill(self.encoding, ENCODINGS, encoding, draft.named_kind and text, ENCODING_NAMES)
        names = {
            ",": self.tr("comma"),
            ";": self.tr("semicolon"),
            "\t": self.tr("tab"),
            " ": self.tr("spaces"),
            "|": "|",
        }
        _fill(self.separator, tuple(names), source.sep or preview.sep, draft.named_kind and text, names)
        _fill(self.decimal, (".", ","), source.decimal or preview.decimal, draft.named_kind and text)
        _fill(self.unit, UNITS, source.unit or "", draft.named_kind, self._unit_names(preview))

    def _unit_names(self, preview: TablePreview) -> dict[str, str]:
        """Return what the units are called; left alone, a table has those that its headers mark."""
        marks = [plain_name(name)[1] or unit for name, unit in zip_longest(preview.header, preview.units, fillvalue="")]
        found = sorted({unit for mark in marks if (unit := unit_marked(mark)) is not None})
        return {
            "": self.tr("as in the headers: {units}").format(units=", ".join(found))
            if found
            else self.tr("metres (not stated)"),
            "m": self.tr("metres"),
            "ft": self.tr("feet (0.3048 m)"),
            "ft-us": self.tr("US survey feet (1200/3937 m)"),
        }

    def _show_rows(self, draft: Draft) -> None:
        preview = draft.preview
        self.table.clear()
        self.table.setRowCount(0)
        self.table.setColumnCount(len(preview.header))
        units = preview.units or ("",) * len(preview.header)
        titles = [f"{name} [{unit}]" if unit else name for name, unit in zip(preview.header, units, strict=True)]
        self.table.setHorizontalHeaderLabels(titles)
        if not preview.header:
            return
        self.table.setRowCount(len(preview.rows) + 1)
        self.table.setRowHeight(0, self.kind.sizeHint().height() + 2)
        before: QWidget = self.table
        for column, title in enumerate(titles):
            box = QComboBox()
            box.setAccessibleName(self.tr("Role of column {name}").format(name=title))
            box.addItem("—", "")
            for role in draft.possible():
                box.addItem(role_name(role), role)
            box.setEnabled(draft.named_kind)
            box.activated.connect(partial(self._name, column))
            self.table.setCellWidget(0, column, box)
            # After the table; what is made last would come after the buttons.
            QWidget.setTabOrder(before, box)
            before = box
        for row, cells in enumerate(preview.rows, 1):
            for column, cell in enumerate(cells):
                self.table.setItem(row, column, QTableWidgetItem(cell))
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)

    def _name(self, column: int, _: int) -> None:
        box = self.table.cellWidget(0, column)
        if isinstance(box, QComboBox):
            self.role_changed.emit(column, box.currentData())

    def _mark(self, draft: Draft) -> None:
        """Set the roles above the columns, and colour cells that cannot be read."""
        bad, red = draft.bad_cells(), QColor(BAD[is_dark(self.palette())])
        for column in range(len(draft.preview.header)):
            box = self.table.cellWidget(0, column)
            if isinstance(box, QComboBox):
                role = draft.role_of(column)
                box.setCurrentIndex(max(box.findData(role), 0))
                share = draft.confidence(role) if role else None
                guessed = self.tr("Guessed, {share:.0%} confidence").format(share=share) if share is not None else ""
                box.setToolTip(guessed)
            for row in range(len(draft.preview.rows)):
                item = self.table.item(row + 1, column)
                if item is None:
                    continue
                wrong = (row, column) in bad
                item.setData(Qt.ItemDataRole.BackgroundRole, red if wrong else None)
                notes = self.tr("No number: the row will be listed, not used.")
                if column in draft.horizons:
                    notes = self.tr("Not a number: it gives no pick.")
                item.setToolTip(notes if wrong else "")

    def _sentences(self, draft: Draft, ground: bool) -> list[str]:
        """Say what is known of a table, what is still needed, and what looks wrong."""
        if draft.fault:
            return [failure(draft.fault), self.tr("This file is left out.")]
        if draft.kind == "":
            return [self.tr("These rows were not recognised. State what they are, or leave the table out.")]
        if draft.kind == "skip":
            return [self.tr("This table is left out; its rows are listed as such.")]
        if not draft.named_kind:
            return [self.tr("{kind}: nothing to name.").format(kind=kind_name(draft.kind))]
        missing = draft.missing(ground=ground)
        if missing:
            names = ", ".join(role_name(role) for role in missing)
            notes = [self.tr("Still needed: {roles}. Name the column above the rows.").format(roles=names)]
            if draft.kind == "collar" and missing == ("z",):
                notes.append(self.tr("Or add the ground, a grid of elevations: collars are placed on it."))
            return notes
        notes = [
            self.tr("{count} rows, the first {shown} shown.").format(
                count=digits.count(draft.preview.read), shown=len(draft.preview.rows)
            )
        ]
        if draft.remembered and not draft.changed:
            notes.append(self.tr("Columns are named as in the last table with this header."))
        if draft.kind == "intervals" and "from" not in draft.roles:
            notes.append(self.tr("No column contains upper limits: they are taken from the row above, 0 at the first."))
        if draft.kind == "picks" and "horizon" not in draft.roles:
            name = draft.source.path.stem
            notes.append(self.tr("No column names a horizon: all points are of '{name}'.").format(name=name))
        if bad := sum(column not in draft.horizons for _, column in draft.bad_cells()):
            notes.append(
                self.tr("Red cells are not numbers ({count} shown): such rows are listed, not used.").format(count=bad)
            )
        notes += [f"{translated(doubt)}." for doubt in draft.doubts()]
        if draft.exchanged:
            notes.append(
                self.tr(
                    "Easting and northing appear to be exchanged: in many Chinese tables X is the "
                    "northing, Y the easting."
                )
            )
        return notes

    def _read_again(self) -> None:
        draft = self._draft
        if draft is None:
            return
        source, preview = draft.source, draft.preview
        if preview.sep:
            for key, box in (("encoding", self.encoding), ("sep", self.separator), ("decimal", self.decimal)):
                # What was found stays unstated: another file of this layout may be found to differ.
                if box.currentData() != getattr(preview, key):
                    source = replace(source, **{key: box.currentData()})
        source = replace(source, unit=self.unit.currentData() or None)
        if source != draft.source or self.kind.currentData() != draft.kind:
            self.reading_changed.emit(_plain(source), self.kind.currentData())


def _plain(source: Source) -> Source:
    """Return the source with the file's own name: its table is added to the name once more."""
    return replace(source, name="")


def _fill(
    box: QComboBox, values: Sequence[str], current: str, enabled: bool, names: dict[str, str] | None = None
) -> None:
    box.clear()
    for value in (*values, *((current,) if current and current not in values else ())):
        box.addItem((names or {}).get(value, value), value)
    box.setCurrentIndex(box.findData(current))
    box.setEnabled(enabled)

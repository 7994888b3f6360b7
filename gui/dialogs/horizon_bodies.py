"""Which horizons are closed to bodies, and above which base."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QVBoxLayout,
    QWidget,
)

__all__ = ["HorizonBodies"]

#: The proposed base lies this far below the lowest horizon, metres.
BELOW = 10.0


class HorizonBodies(QDialog):
    """Asks for horizons and their common base: one elevation, or another horizon."""

    def __init__(self, horizons: Sequence[str], lowest: float, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Close horizons to bodies"))
        words = QLabel(self.tr("Each checked horizon becomes a body above the common base, within the area of both."))
        words.setWordWrap(True)
        self.list = QListWidget()
        self.list.setAccessibleName(self.tr("Horizons"))
        for name in horizons:
            item = QListWidgetItem(name)
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(Qt.CheckState.Unchecked)
            self.list.addItem(item)
        self.under = QComboBox()
        self.under.addItem(self.tr("One elevation"), None)
        for name in horizons:
            self.under.addItem(name, name)
        self.elevation = QDoubleSpinBox(decimals=2, minimum=-1e5, maximum=1e5, suffix=" m")
        self.elevation.setValue(round(lowest - BELOW))
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        form = QFormLayout()
        form.addRow(self.tr("Base"), self.under)
        form.addRow(self.tr("Elevation"), self.elevation)
        column = QVBoxLayout(self)
        for part in (words, self.list):
            column.addWidget(part)
        column.addLayout(form)
        column.addWidget(self.buttons)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.list.itemChanged.connect(lambda _: self._check())
        self.under.currentIndexChanged.connect(lambda _: self._check())
        self._check()

    def chosen(self) -> tuple[str, ...]:
        """Return the horizons that are closed to bodies; the base itself is none."""
        items = [self.list.item(k) for k in range(self.list.count())]
        checked = tuple(item.text() for item in items if item.checkState() == Qt.CheckState.Checked)
        return tuple(name for name in checked if name != self.under.currentData())

    def base(self) -> str | float:
        """Return the horizon or the elevation in metres that all bodies end at."""
        lower = self.under.currentData()
        return float(self.elevation.value()) if lower is None else str(lower)

    def _check(self) -> None:
        self.elevation.setEnabled(self.under.currentData() is None)
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(bool(self.chosen()))

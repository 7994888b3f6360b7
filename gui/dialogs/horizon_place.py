"""Where a new horizon stands among the others, the highest first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractItemView, QHBoxLayout, QListWidget, QPushButton, QVBoxLayout, QWidget

__all__ = ["HorizonPlace"]


class HorizonPlace(QWidget):
    """A list of the horizons with the new one in bold, which buttons move up and down; the others stay.

    ``levels`` has the mean elevation of each horizon that is there already: until somebody moves it, the new one stands
    above the first that lies lower than it.
    """

    def __init__(self, order: Sequence[str], levels: Mapping[str, float]) -> None:
        super().__init__()
        self._others, self._levels = list(order), dict(levels)
        self._name, self._at, self._moved = "", 0, False
        self._level: float | None = None
        self.list = QListWidget()
        self.list.setAccessibleName(self.tr("Order of the horizons"))
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        line = self.fontMetrics().height() + 4
        self.list.setMinimumHeight(5 * line)
        self.list.setMaximumHeight(7 * line)
        self.up, self.down = QPushButton(self.tr("&Up")), QPushButton(self.tr("&Down"))
        self.up.clicked.connect(lambda: self._move(-1))
        self.down.clicked.connect(lambda: self._move(1))
        moves = QVBoxLayout()
        moves.addWidget(self.up)
        moves.addWidget(self.down)
        moves.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.list, 1)
        row.addLayout(moves)
        self._show()

    @property
    def order(self) -> tuple[str, ...]:
        """All names as they stand, the highest first; the others alone while there is no new horizon."""
        if self._level is None:
            return tuple(self._others)
        return (*self._others[: self._at], self._name, *self._others[self._at :])

    def show_horizon(self, name: str, level: float | None) -> None:
        """Show the new horizon under its name, at its mean elevation in metres; None: there is none yet."""
        self._name, self._level = name, level
        if level is None:
            self._moved = False
        elif not self._moved:
            lower = (k for k, other in enumerate(self._others) if self._levels.get(other, -float("inf")) < level)
            self._at = next(lower, len(self._others))
        self._show()

    def keep(self) -> None:
        """Take the new horizon among the others."""
        if self._level is not None:
            self._levels[self._name] = self._level
            self._others = list(self.order)
        self._level, self._moved = None, False
        self._show()

    def withdraw(self, name: str) -> None:
        """Take a horizon out from among the others."""
        self._others = [other for other in self._others if other != name]
        self._levels.pop(name, None)
        self._at = min(self._at, len(self._others))
        self._show()

    def _move(self, by: int) -> None:
        self._at, self._moved = self._at + by, True
        self._show()

    def _show(self) -> None:
        self.list.clear()
        self.list.addItems(list(self.order))
        there = self._level is not None
        if there:
            item = self.list.item(self._at)
            font = item.font()
            font.setBold(True)
            item.setFont(font)
            self.list.scrollToItem(item)
        self.up.setEnabled(there and self._at > 0)
        self.down.setEnabled(there and self._at < len(self._others))

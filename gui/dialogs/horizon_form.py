"""A horizon from logged codes: which count as one, which limit, which bed; the fields, and what they pick."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import GeofitError
from geofit.data.site import Site
from geofit.gui.dialogs.horizon_place import HorizonPlace
from geofit.gui.translate import failure
from geofit.io.contact_rules import ContactRule
from geofit.project.horizon_builder import RulePicks, codes_of, picks_of

__all__ = ["HorizonForm"]

_NUMBER = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class HorizonForm(QWidget):
    """Builds rules; ``previewed(picks)`` after each change (None: nothing to show).

    ``built(name, rule, order)`` comes from Add, with all horizons in the order that they shall have, the highest first.
    ``upright`` puts the codes above the other fields instead of to their left.
    """

    previewed = Signal(object)
    built = Signal(str, object, object)

    def __init__(self, site: Site, order: Sequence[str], *, upright: bool = False) -> None:
        super().__init__()
        self._site, self._taken = site, {name.casefold() for name in order}
        levels = {name: float(points.xyz[:, 2].mean()) for name, points in site.horizons.items() if len(points)}
        self.place = HorizonPlace(order, levels)
        self._named = False
        self.picks: RulePicks | None = None
        self._items: list[QTableWidgetItem] = []
        self.codes = QTableWidget(0, 5)
        self.codes.setHorizontalHeaderLabels(
            [self.tr("Code"), self.tr("Holes"), self.tr("Beds"), self.tr("Metres"), self.tr("Mean Z, m")]
        )
        self.codes.verticalHeader().hide()
        self.codes.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 8)
        self.codes.horizontalHeader().setDefaultAlignment(_NUMBER)
        code = self.codes.horizontalHeaderItem(0)
        assert code is not None
        code.setTextAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self.codes.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.codes.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.codes.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.codes.setTabKeyNavigation(False)
        self.codes.setAccessibleName(self.tr("Codes of the interval logs, the highest first"))
        self._fill()
        self.limit, self.occurrence = QComboBox(), QComboBox()
        self.limit.addItem(self.tr("Base"), "base")
        self.limit.addItem(self.tr("Top"), "top")
        self.occurrence.addItem(self.tr("As usual: first top, last base"), None)
        self.occurrence.addItem(self.tr("First from the collar"), "first")
        self.occurrence.addItem(self.tr("Last from the collar"), "last")
        self.thinner = QDoubleSpinBox()
        self.thinner.setRange(0.0, 1000.0)
        self.thinner.setSingleStep(0.1)
        self.thinner.setSuffix(" m")
        self.thinner.setToolTip(self.tr("Thinner beds are ignored, whether they are partings or stand alone"))
        self.name, self.words = QLineEdit(), QLabel()
        self.words.setWordWrap(True)
        self.words.setMinimumHeight(3 * self.fontMetrics().height())
        self.words.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.add = QPushButton(self.tr("&Add horizon"))
        form = QFormLayout()
        for words, field in (
            (self.tr("&Limit"), self.limit),
            (self.tr("&Which bed"), self.occurrence),
            (self.tr("&Ignore beds below"), self.thinner),
            (self.tr("&Name"), self.name),
        ):
            form.addRow(words, field)
        form.addRow(self.tr("Order"), self.place)
        side = QVBoxLayout()
        side.addLayout(form)
        side.addWidget(self.words)
        side.addStretch(1)
        side.addWidget(self.add, 0, Qt.AlignmentFlag.AlignRight)
        parts = QVBoxLayout(self) if upright else QHBoxLayout(self)
        parts.setContentsMargins(0, 0, 0, 0)
        parts.addWidget(self.codes, 3)
        parts.addLayout(side, 0 if upright else 2)
        self.codes.itemChanged.connect(self.renew)
        self.limit.currentIndexChanged.connect(self.renew)
        self.occurrence.currentIndexChanged.connect(self.renew)
        self.thinner.valueChanged.connect(self.renew)
        self.name.textEdited.connect(self._name_edited)
        self.add.clicked.connect(self._build)
        self.renew()

    def rule(self) -> ContactRule | None:
        """Return what is chosen; None without a code."""
        chosen = tuple(item.text() for item in self._items if item.checkState() == Qt.CheckState.Checked)
        if not chosen:
            return None
        return ContactRule(chosen, self.limit.currentData(), self.occurrence.currentData(), self.thinner.value())

    def check(self, *codes: str) -> None:
        """Choose these codes and no others."""
        for item in self._items:
            item.setCheckState(Qt.CheckState.Checked if item.text() in codes else Qt.CheckState.Unchecked)

    def renew(self, *_: object) -> None:
        """Pick anew, and say what was picked."""
        rule = self.rule()
        if rule is not None and not self._named:
            base = rule.limit == "base"
            self.name.setText((self.tr("base of {code}") if base else self.tr("top of {code}")).format(code=rule.label))
        self.picks = None
        if rule is None:
            self.words.setText(self.tr("Choose one or more codes: several count as one bed."))
        else:
            try:
                self.picks = picks_of(self._site, rule)
            except GeofitError as error:
                self.words.setText(failure(error))
            else:
                words = self.tr("{count} contacts in {holes} holes that have these codes; {unseen} holes without one.")
                self.words.setText(
                    words.format(count=len(self.picks.points), holes=self.picks.carrying, unseen=self.picks.unseen)
                )
        self._enable()
        self._place()
        self.previewed.emit(self.picks)

    def withdraw(self, name: str) -> None:
        """Take back a horizon that was added; its name is free again."""
        self._taken.discard(name.casefold())
        self.place.withdraw(name)
        self.renew()

    def _fill(self) -> None:
        codes = codes_of(self._site)
        self.codes.setRowCount(len(codes))
        for row, one in enumerate(codes):
            item = QTableWidgetItem(one.code)
            item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(Qt.CheckState.Unchecked)
            self.codes.setItem(row, 0, item)
            self._items.append(item)
            cells = (f"{one.holes}", f"{one.intervals}", f"{one.metres:.1f}", f"{one.elevation:.1f}")
            for column, text in enumerate(cells, 1):
                cell = QTableWidgetItem(text)
                cell.setTextAlignment(_NUMBER)
                cell.setFlags(Qt.ItemFlag.ItemIsEnabled)
                self.codes.setItem(row, column, cell)
        self.codes.resizeColumnsToContents()

    def _name_edited(self) -> None:
        self._named = True
        self._enable()
        self._place()

    def _enable(self) -> None:
        name = self.name.text().strip()
        able = self.picks is not None and len(self.picks.points) > 0
        self.add.setEnabled(able and bool(name) and name.casefold() not in self._taken)

    def _place(self) -> None:
        """Show where the horizon stands among the others."""
        picked = self.picks is not None and len(self.picks.points) > 0
        level = float(self.picks.points.xyz[:, 2].mean()) if self.picks is not None and picked else None
        self.place.show_horizon(self.name.text().strip(), level)

    def _build(self) -> None:
        rule, name = self.rule(), self.name.text().strip()
        if rule is not None:
            self._taken.add(name.casefold())
            self._named = False
            self.built.emit(name, rule, self.place.order)
            self.place.keep()
            self.check()

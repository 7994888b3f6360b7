"""Every question put to a surface, with its answer: the checks, conflicts, notes, order, and the file read back."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QAction, QKeySequence, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from geofit.data.accuracy import Accuracy, Check, ReadBack
from geofit.data.messages import Message, gravest_first
from geofit.data.prediction import PredictionResult
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.marks import icon, verdict_mark
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.translate import translated
from geofit.project.provenance import Row
from geofit.report.digits import measured
from geofit.site.order import Order
from geofit.site.throw import FaultCut

__all__ = ["ChecksPanel"]

_POINT = Qt.ItemDataRole.UserRole
_PLACE = Qt.ItemDataRole.UserRole + 1
_WORDS = 4


class ChecksPanel(QWidget):
    """Checks in groups; each says passed, failed or not applicable by a mark and by a word.

    ``point_chosen`` carries the Row of the point that were dropped, when its conflict is chosen;
    ``place_chosen`` map coordinates, when a check that has a worst place is.
    """

    point_chosen = Signal(object)
    place_chosen = Signal(float, float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.tree = _Tree()
        self.tree.setAccessibleName(self.tr("Checks of the surface"))
        self.tree.setHeaderLabels([self.tr("Check"), self.tr("Result"), self.tr("Value"), self.tr("Limit"), ""])
        self.tree.headerItem().setText(4, self.tr("In words"))
        self.tree.setWordWrap(True)
        self.tree.setItemDelegate(_Wrapping(self.tree))
        self.tree.setIndentation(8)
        self.tree.setAlternatingRowColors(True)
        self.tree.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.tree.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        header = self.tree.header()
        for figure in (2, 3):
            self.tree.headerItem().setTextAlignment(figure, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        header.setStretchLastSection(True)
        header.sectionResized.connect(lambda *_: self.tree.scheduleDelayedItemsLayout())
        copy = QAction(self.tr("Copy"), self.tree)
        copy.setShortcut(QKeySequence.StandardKey.Copy)
        copy.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        copy.triggered.connect(self.copy)
        self.tree.addAction(copy)
        self.tree.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        self.tree.currentItemChanged.connect(self._tell)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.addWidget(self.tree)
        self.pages = Placeholder(content, self)
        self._rows: list[QTreeWidgetItem] = []
        # A panel that is hidden is filled before the tree has its width.
        self.tree.resized.connect(self._fit_columns)
        self.show_surface(None)

    def show_surface(
        self,
        surface: HorizonFit | None,
        prediction: PredictionResult | None = None,
        orders: Sequence[Order] = (),
        read_back: ReadBack | None = None,
        cuts: Sequence[FaultCut] = (),
    ) -> None:
        """Show what was asked of a surface.

        Parameters
        ----------
        surface : HorizonFit or None
            With its accuracy; None while there is none.
        prediction : PredictionResult or None
            What is known away from the data.
        orders : sequence of Order
            How the horizon lies to its neighbours.
        read_back : ReadBack or None
            What the reader found in the STEP file.
        cuts : sequence of FaultCut
            How far faults displace the block beside others.
        """
        self._rows.clear()
        self.tree.clear()
        if surface is None or surface.accuracy is None:
            self.pages.say(self.tr("No surface yet: press Fit, and every check of it is listed here."))
            return
        accuracy = surface.accuracy
        self._group(self.tr("Surface"), [self._sigma(accuracy), *map(self._check, accuracy.checks)])
        self._group(self.tr("Order of horizons"), [self._order(order) for order in orders])
        self._group(self.tr("Throw at faults"), [self._cut(cut) for cut in cuts])
        self._group(self.tr("Away from the data"), self._away(prediction))
        self._group(self.tr("Conflicts"), self._conflicts(surface, accuracy))
        self._group(self.tr("Notes"), [self._note(note) for note in gravest_first(accuracy.notes)])
        self._group(self.tr("STEP file read back"), self._file(read_back))
        self.tree.expandAll()
        self._fit_columns()
        self.pages.reveal()

    def copy(self) -> None:
        """Put the selected rows on the clipboard as tab-separated text; all of them if none is selected."""
        chosen = self.tree.selectedItems()
        rows = chosen or self._rows
        heads = [self.tree.headerItem().text(k) for k in range(5)]
        lines = [heads, *([row.text(k).replace("\n", " ") for k in range(5)] for row in rows)]
        QApplication.clipboard().setText("\n".join("\t".join(line) for line in lines) + "\n")

    def _group(self, title: str, rows: Sequence[QTreeWidgetItem]) -> None:
        if not rows:
            return
        group = QTreeWidgetItem([title])
        font = group.font(0)
        font.setBold(True)
        group.setFont(0, font)
        self.tree.addTopLevelItem(group)
        self._rows.extend(rows)
        group.setFirstColumnSpanned(True)
        group.addChildren(list(rows))

    def _row(
        self, name: str, passed: bool | None, value: str = "", limit: str = "", words: str = "", *, word: str = ""
    ) -> QTreeWidgetItem:
        result = word or (
            self.tr("not applicable") if passed is None else self.tr("passed") if passed else self.tr("failed")
        )
        value, limit, words = map(in_lengths, (value, limit, words))
        item = QTreeWidgetItem([name, result, value, limit, words])
        item.setIcon(0, verdict_mark(passed))
        for column in (2, 3):
            item.setTextAlignment(column, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        for column in range(5):
            item.setToolTip(column, "\n".join((name, words)) if words else name)
        return item

    def _sigma(self, a: Accuracy) -> QTreeWidgetItem:
        words = self.tr("standard deviation of all {n} points from the surface").format(n=a.n)
        return self._row("σ", a.passed, measured(a.sigma, "m"), measured(a.epsilon, "m"), words)

    def _check(self, check: Check) -> QTreeWidgetItem:
        value, limit = (measured(number, translated(check.unit)) for number in (check.value, check.limit))
        item = self._row(translated(check.name), check.passed, value, limit, translated(check.text))
        item.setData(0, _PLACE, _places(check))
        return item

    def _order(self, order: Order) -> QTreeWidgetItem:
        name = self.tr("{upper} above {lower}").format(upper=order.upper, lower=order.lower)
        check = order.check()
        item = self._row(name, check.passed, measured(order.min, "m"), measured(0.0, "m"), translated(check.text))
        if not order.area:
            item.setText(2, "")
        item.setData(0, _PLACE, _places(check))
        return item

    def _cut(self, cut: FaultCut) -> QTreeWidgetItem:
        name = self.tr("{up} above {down}, at {fault}").format(up=cut.up, down=cut.down, fault=cut.fault)
        mean = measured(float(cut.throw.mean()), "m")
        return self._row(name, None, mean, words=translated(cut.text), word=self.tr("for information"))

    def _away(self, prediction: PredictionResult | None) -> list[QTreeWidgetItem]:
        if prediction is None:
            return []
        rows = []
        schemes = {
            "hole": self.tr("holes left out"),
            "section": self.tr("sections left out"),
            "block": self.tr("blocks left out"),
        }
        for left in prediction.left_out:
            words = self.tr(
                "{share:.0f} % of the left-out points lie in the 90 % band; mean error {bias:+.2f} m"
            ).format(share=100 * left.inside, bias=left.bias)
            name = schemes.get(left.scheme, left.scheme)
            rows.append(self._row(name, None, measured(left.rms, "m"), words=words, word=self.tr("for information")))
        return rows + [self._note(note) for note in gravest_first(prediction.notes)]

    def _conflicts(self, surface: HorizonFit, a: Accuracy) -> list[QTreeWidgetItem]:
        rows = []
        for conflict in a.conflicts:
            name = translated(surface.points.describe(conflict.dropped))
            value = measured(conflict.difference, "m")
            item = self._row(name, None, value, words=translated(conflict.text), word=self.tr("dropped"))
            item.setIcon(0, icon("warning"))
            item.setData(0, _POINT, Row.of(surface.points, conflict.dropped))
            rows.append(item)
        return rows

    def _note(self, note: Message) -> QTreeWidgetItem:
        item = QTreeWidgetItem([translated(note)])
        item.setFirstColumnSpanned(True)
        item.setToolTip(0, translated(note))
        if note.severity != "info":
            item.setIcon(0, icon("warning"))
        return item

    def _file(self, back: ReadBack | None) -> list[QTreeWidgetItem]:
        if back is None:
            return []
        words = self.tr("Faces: {faces}, free edges: {edges}, edge tolerance {tolerance:.1e} m").format(
            faces=back.faces, edges=back.free_edges, tolerance=back.edge_tolerance
        )
        return [self._row(back.file, back.passed, words=words), *map(self._check, back.checks)]

    def _fit_columns(self) -> None:
        for row in self._rows:
            # A note has no figures; it takes the whole line.
            row.setFirstColumnSpanned(not row.text(1))
        for column in range(4):
            self.tree.resizeColumnToContents(column)
            # A long name leaves room for what is said.
            most = 2 * self.tree.width() // 5 if column == 0 else self.tree.width() - 110
            self.tree.setColumnWidth(column, min(self.tree.columnWidth(column), max(most, 130)))
        self.tree.scheduleDelayedItemsLayout()

    def _tell(self, current: QTreeWidgetItem | None) -> None:
        index = None if current is None else current.data(0, _POINT)
        place = None if current is None else current.data(0, _PLACE)
        if index is not None:
            self.point_chosen.emit(index)
        elif place is not None:
            self.place_chosen.emit(*place)


class _Tree(QTreeWidget):
    """Tells ``resized()`` when it has another width."""

    resized = Signal()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.resized.emit()


class _Wrapping(QStyledItemDelegate):
    """Makes rows as high as their words need: Qt's tree asks for heights without saying how wide a column is."""

    def __init__(self, tree: QTreeWidget) -> None:
        super().__init__(tree)
        self._tree = tree

    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:  # noqa: N802
        """Return the size of a cell whose words are broken into lines."""
        tree = self._tree
        spanned = tree.isFirstColumnSpanned(index.row(), QModelIndex(index.parent()))
        if not spanned and index.column() != _WORDS:
            return super().sizeHint(option, index)
        narrow = QStyleOptionViewItem(option)
        width = tree.viewport().width() - 2 * tree.indentation() if spanned else tree.columnWidth(_WORDS)
        narrow.rect = QRect(0, 0, width, 1)
        # What takes the whole line makes its first column no wider.
        return QSize(0, super().sizeHint(narrow, index).height())


def _places(check: Check) -> tuple[float, float, float] | None:
    """Return the worst place of a check that has places."""
    return check.places[0] if check.places else None

"""A tree with an eye and an opacity in its rows: a click changes them, and chooses nothing else."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPainterPath, QPalette, QPen
from PySide6.QtWidgets import QHeaderView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QTreeView, QWidget

from geofit.gui.panels.tree_model import OPACITY, SHOWN

__all__ = ["RowView"]

_Index = QModelIndex | QPersistentModelIndex
#: Width of a cell, and how strongly a closed eye is drawn.
SIDE, CLOSED = 24, 0.45


class _Cell(QStyledItemDelegate):
    """A cell that is a small picture and a button; ``draw(painter, place, colour, index)`` draws the picture."""

    def __init__(self, parent: QWidget, draw: Callable[[QPainter, QPointF, QColor, _Index], None]) -> None:
        super().__init__(parent)
        self._draw = draw

    def sizeHint(self, option: QStyleOptionViewItem, index: _Index) -> QSize:  # noqa: N802
        """Return a square."""
        return QSize(SIDE, super().sizeHint(option, index).height())

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        """Draw the ground of the row, and the picture on it."""
        ground = QStyleOptionViewItem(option)
        self.initStyleOption(ground, index)
        ground.features &= ~QStyleOptionViewItem.ViewItemFeature.HasCheckIndicator
        ground.text = ""
        style = ground.widget.style()
        style.drawControl(QStyle.ControlElement.CE_ItemViewItem, ground, painter, ground.widget)
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        role = QPalette.ColorRole.HighlightedText if chosen else QPalette.ColorRole.Text
        active = bool(option.state & QStyle.StateFlag.State_Active)
        group = QPalette.ColorGroup.Active if active else QPalette.ColorGroup.Inactive
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._draw(painter, QRectF(option.rect).center(), option.palette.color(group, role), index)
        painter.restore()


def _draw_visibility(painter: QPainter, at: QPointF, colour: QColor, index: _Index) -> None:
    """Draw an open or a closed eye for the check state of a cell."""
    state = index.data(Qt.ItemDataRole.CheckStateRole)
    if state is None:
        return
    opened = Qt.CheckState(state) == Qt.CheckState.Checked
    painter.setOpacity(1.0 if opened else CLOSED)
    painter.setPen(QPen(colour, 1.3))
    lid = QPainterPath(at + QPointF(-6.5, 0))
    lid.quadTo(at + QPointF(0, 8 if not opened else -8), at + QPointF(6.5, 0))
    if opened:
        lid.quadTo(at + QPointF(0, 8), at + QPointF(-6.5, 0))
    painter.drawPath(lid)
    if opened:
        painter.setBrush(colour)
        painter.drawEllipse(at, 1.7, 1.7)
    else:
        for x, y in ((-3.6, 2.6), (0.0, 4.0), (3.6, 2.6)):
            painter.drawLine(at + QPointF(x, y), at + QPointF(1.35 * x, y + 2.4))


def _draw_opacity(painter: QPainter, at: QPointF, colour: QColor, index: _Index) -> None:
    """Draw a disc that is as full as a layer is opaque, EditRole 0 to 1."""
    share = index.data(Qt.ItemDataRole.EditRole)
    if share is None:
        return
    box = QRectF(at.x() - 5, at.y() - 5, 10, 10)
    painter.setPen(QPen(colour, 1.2))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawEllipse(box)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colour)
    painter.drawPie(box, 90 * 16, -round(360 * 16 * share))


class RowView(QTreeView):
    """Shows a model whose rows have an eye and an opacity; the space bar opens and closes the eye of the current row.

    ``opacity_asked(index)`` hears of a click on an opacity.
    """

    opacity_asked = Signal(QModelIndex)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._pressed = QModelIndex()
        self._cells = _Cell(self, _draw_visibility), _Cell(self, _draw_opacity)
        for column, cell in zip((SHOWN, OPACITY), self._cells, strict=True):
            self.setItemDelegateForColumn(column, cell)

    def lay_out(self) -> None:
        """Give the text all the room that the small cells leave."""
        header = self.header()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(SIDE)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        for column in (SHOWN, OPACITY):
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Fixed)
            header.resizeSection(column, SIDE)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Open or close the eye."""
        if event.key() != Qt.Key.Key_Space or not self._blink(self.currentIndex().siblingAtColumn(SHOWN)):
            super().keyPressEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Press a cell, or choose a row."""
        at = self.indexAt(event.position().toPoint())
        self._pressed = at if event.button() == Qt.MouseButton.LeftButton and _is_button(at) else QModelIndex()
        if not self._pressed.isValid():
            super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Take the second press on a cell as another one."""
        if _is_button(self.indexAt(event.position().toPoint())):
            self.mousePressEvent(event)
        else:
            super().mouseDoubleClickEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Change what was pressed."""
        pressed, self._pressed = self._pressed, QModelIndex()
        if not pressed.isValid():
            super().mouseReleaseEvent(event)
        elif pressed == self.indexAt(event.position().toPoint()):
            if pressed.column() == OPACITY:
                self.opacity_asked.emit(pressed)
            else:
                self._blink(pressed)

    def _blink(self, eye: QModelIndex) -> bool:
        """Open a closed eye, or close an open one; False where there is none."""
        state = eye.data(Qt.ItemDataRole.CheckStateRole) if eye.isValid() else None
        if state is None:
            return False
        opened = Qt.CheckState(state) == Qt.CheckState.Checked
        new = Qt.CheckState.Unchecked if opened else Qt.CheckState.Checked
        return bool(self.model().setData(eye, new, Qt.ItemDataRole.CheckStateRole))


def _is_button(index: QModelIndex) -> bool:
    role = {SHOWN: Qt.ItemDataRole.CheckStateRole, OPACITY: Qt.ItemDataRole.EditRole}.get(index.column())
    return index.isValid() and role is not None and index.data(role) is not None

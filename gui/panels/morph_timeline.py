"""The slider of a metamorphosis: ticks where the topology changes, the curves of volume and Euler number below it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from geofit.gui.panels.marks import readable
from geofit.report.style import CORE, FAIL, WARNING

__all__ = ["MorphTimeline"]

Floats = NDArray[np.float64]

#: Least room for numbers at both sides, for the slider above and the words below, logical pixels.
LEFT, RIGHT, ABOVE, BELOW = 74.0, 96.0, 26.0, 20.0
#: Between a number and the plot.
APART = 6.0
#: Keys move the slider by these shares.
STEP, PAGE = 0.01, 0.1


class MorphTimeline(QWidget):
    """Shows and takes tau, 0 to 1. ``moved(tau)`` while it is dragged, ``rested(tau)`` when it is let go."""

    moved = Signal(float)
    rested = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.tau = 0.0
        self.events: tuple[float, ...] = ()
        self._taus: Floats = np.zeros(0)
        self._volume: Floats = np.zeros(0)
        self._euler: Floats = np.zeros(0)
        #: The largest and the least number of each curve.
        self._volumes: tuple[str, ...] = ()
        self._numbers: tuple[str, ...] = ()
        self._knots: tuple[float, ...] = ()
        self._names: tuple[str, ...] = ()
        self.setMinimumSize(QSize(260, 96))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Progress"))
        self.setCursor(Qt.CursorShape.PointingHandCursor)

    def show_ends(self, knots: Sequence[float], names: Sequence[str], events: Sequence[float]) -> None:
        """Show where the surveys lie, and where the topology changes; curves come later."""
        self._knots, self._names, self.events = tuple(knots), tuple(names), tuple(events)
        self.show_curves((), (), ())

    def show_curves(self, taus: Sequence[float], volume: Sequence[float], euler: Sequence[float]) -> None:
        """Show volume (m3) and Euler number over tau."""
        self._taus, self._volume, self._euler = (np.asarray(v, float) for v in (taus, volume, euler))
        self._volumes = _numbers("{:,.0f} m³", self._volume)
        self._numbers = _numbers("{:g}", self._euler)
        self.update()

    def put(self, tau: float) -> None:
        """Move the slider without a signal."""
        self.tau = min(max(tau, 0.0), 1.0)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint slider, ticks and curves."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette = self.palette()
        painter.setFont(self._small())
        text, dim = palette.color(QPalette.ColorRole.WindowText), palette.color(QPalette.ColorRole.Mid)
        plot = self.plot()
        rail = plot.top() / 2
        blue, red, amber = (readable(colour, palette) for colour in (CORE, FAIL, WARNING))
        painter.setPen(QPen(dim, 1))
        painter.drawRect(plot)
        painter.setPen(QPen(dim, 4, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(QPointF(plot.left(), rail), QPointF(plot.right(), rail))
        for knot, name in zip(self._knots, self._names, strict=False):
            x = self._x(knot)
            painter.setPen(QPen(text, 1))
            painter.drawLine(QPointF(x, rail - 6), QPointF(x, rail + 6))
            width = plot.width() / max(len(self._knots), 1)
            left = min(max(x - width / 2, plot.left()), plot.right() - width)
            align = Qt.AlignmentFlag.AlignLeft if knot == 0 else Qt.AlignmentFlag.AlignRight
            align = align if knot in (0.0, 1.0) else Qt.AlignmentFlag.AlignHCenter
            name = QFontMetricsF(painter.font()).elidedText(name, Qt.TextElideMode.ElideMiddle, width)
            painter.drawText(QRectF(left, plot.bottom() + 2, width, self.height() - plot.bottom() - 2), align, name)
        for tau in self.events:
            x = self._x(tau)
            painter.setPen(QPen(amber, 1.5, Qt.PenStyle.DashLine))
            painter.drawLine(QPointF(x, rail), QPointF(x, plot.bottom()))
            painter.setBrush(amber)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.drawPolygon(QPolygonF([QPointF(x - 4, 1), QPointF(x + 4, 1), QPointF(x, 8)]))
        self._curve(painter, self._volume, blue, self._volumes, left=True, stepped=False)
        self._curve(painter, self._euler, red, self._numbers, left=False, stepped=True)
        if len(self._euler):
            painter.drawText(
                QRectF(plot.right() + APART, 0.0, self.width() - plot.right() - APART, plot.top()),
                Qt.AlignmentFlag.AlignVCenter,
                self.tr("Euler number"),
            )
        x = self._x(self.tau)
        painter.setPen(QPen(text, 1.2))
        painter.drawLine(QPointF(x, rail), QPointF(x, plot.bottom()))
        painter.setBrush(palette.color(QPalette.ColorRole.Highlight))
        painter.setPen(QPen(palette.color(QPalette.ColorRole.Base), 1.5))
        painter.drawEllipse(QPointF(x, rail), 7.0, 7.0)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(palette.color(QPalette.ColorRole.Link), 1.6))
            painter.drawEllipse(QPointF(x, rail), 10.0, 10.0)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of the slider."""
        self._drag(event.position().x())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag it."""
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._drag(event.position().x())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let it go."""
        self.rested.emit(self.tau)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Move it with the keyboard."""
        by = {
            Qt.Key.Key_Left: -STEP, Qt.Key.Key_Right: STEP, Qt.Key.Key_PageUp: PAGE, Qt.Key.Key_PageDown: -PAGE,
            Qt.Key.Key_Home: -1.0, Qt.Key.Key_End: 1.0,
        }.get(Qt.Key(event.key()))  # fmt: skip
        if by is None:
            super().keyPressEvent(event)
            return
        self.put(round(self.tau + by, 6))
        self.moved.emit(self.tau)
        self.rested.emit(self.tau)

    def plot(self) -> QRectF:
        """Return where tau 0 to 1 runs from the left to the right edge, and the curves are drawn, logical pixels."""
        metrics = QFontMetricsF(self._small())
        # No digit of a number is cut off, whatever its length and the size of text.
        left = max(LEFT, APART + max(map(metrics.horizontalAdvance, self._volumes), default=0.0))
        right = max(RIGHT, APART + max(map(metrics.horizontalAdvance, (*self._numbers, self.tr("Euler number")))))
        above, below = max(ABOVE, metrics.height() + 8), max(BELOW, metrics.height() + 4)
        return QRectF(left, above, max(self.width() - left - right, 10.0), max(self.height() - above - below, 10.0))

    def _small(self) -> QFont:
        font = QFont(self.font())
        font.setPointSizeF(font.pointSizeF() * 0.88)
        return font

    def _x(self, tau: float) -> float:
        plot = self.plot()
        return plot.left() + tau * plot.width()

    def _drag(self, x: float) -> None:
        plot = self.plot()
        self.put((x - plot.left()) / plot.width())
        self.moved.emit(self.tau)

    def _curve(
        self, painter: QPainter, values: Floats, colour: QColor, words: tuple[str, ...], *, left: bool, stepped: bool
    ) -> None:
        """Draw a curve with its least and largest number at its side of the plot."""
        if not len(values):
            return
        plot = self.plot().adjusted(0, 6, 0, -6)
        low, high = float(values.min()), float(values.max())
        room = (high - low) or 1.0
        y = plot.bottom() - (values - low) / room * plot.height()
        points = [QPointF(self._x(t), v) for t, v in zip(self._taus.tolist(), y.tolist(), strict=True)]
        if stepped:
            middle = [QPointF(b.x(), a.y()) for a, b in pairwise(points)]
            points = [p for pair in zip(points, [*middle, points[-1]], strict=True) for p in pair]
        painter.setPen(QPen(colour, 1.8, Qt.PenStyle.DotLine if stepped else Qt.PenStyle.SolidLine))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF(points))
        painter.setPen(colour)
        side = Qt.AlignmentFlag.AlignRight if left else Qt.AlignmentFlag.AlignLeft
        x = 0.0 if left else plot.right() + APART
        width, height = (plot.left() - APART if left else self.width() - x), QFontMetricsF(painter.font()).height()
        for number, at in zip(words, (plot.top(), plot.bottom()) if high > low else (plot.bottom(),), strict=False):
            box = QRectF(x, at - height / 2, width, height)
            painter.drawText(box, side | Qt.AlignmentFlag.AlignVCenter, number)


def _numbers(words: str, values: Floats) -> tuple[str, ...]:
    """Write the largest and the least of some values, one number where they are the same."""
    extremes = dict.fromkeys((float(values.max()), float(values.min()))) if len(values) else {}
    return tuple(words.format(value).replace(",", "\N{NO-BREAK SPACE}") for value in extremes)

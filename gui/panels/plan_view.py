"""The plan that can be dragged: points, holes, sections, the study area, and the core's rectangle on top."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPixmap,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from geofit.gui.panels.core_box import CoreBox
from geofit.gui.panels.marks import readable
from geofit.gui.panels.plan_painter import draw_cloud, draw_labels, draw_north, draw_scale_bar, draw_title
from geofit.report.style import CORE, QUIET

__all__ = ["PERIPHERY", "PlanData", "PlanView"]

Floats = NDArray[np.float64]

#: Colour of the points that are approximated; they are rings, the core's are discs.
PERIPHERY = "#b2611b"
#: More points than this are painted as dots of an image, exact or not.
MANY = 5_000
#: Side of a handle, and how near to it the pointer must be, pixels.
HANDLE, NEAR = 9, 10


@dataclass(frozen=True, eq=False)
class PlanData:
    """What the plan shows, in map coordinates: points (n, 2), which are exact, and lines with their names.

    ``name`` and ``colour`` are the horizon's.
    """

    points: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    exact: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    boundary: Floats | None = None
    patches: tuple[Floats, ...] = ()
    sections: tuple[tuple[str, Floats], ...] = ()
    holes: tuple[tuple[str, Floats], ...] = ()
    name: str = ""
    colour: str = QUIET


class PlanView(QWidget):
    """Equal scales, north up; the wheel zooms, dragging moves, corners of the rectangle are dragged.

    ``box_dragged`` after each drag of a corner, of the rectangle, or a new one; ``box_dragging`` meanwhile.
    """

    box_dragging = Signal(object)
    box_dragged = Signal(object)
    pointer_moved = Signal(float, float)
    resized = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumSize(QSize(200, 160))
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.data = PlanData()
        self.box: CoreBox | None = None
        self.locked = False
        self.drawing = False
        self.blank: CoreBox | None = None
        self._centre, self._scale = np.zeros(2), 1.0
        self._fitted = self._moved = False
        self._layer: QPixmap | None = None
        self._grasped: int | str | None = None
        self._from = np.zeros(2)
        self._start: CoreBox | None = None

    def show_data(self, data: PlanData, *, keep_view: bool = False) -> None:
        """Show other data; the view is fitted to it unless it is kept."""
        self.data, self._layer = data, None
        if not keep_view or not self._fitted:
            self.fit()
        self.update()

    def show_box(self, box: CoreBox | None) -> None:
        """Show another rectangle."""
        self.box = box
        self.update()

    def fit(self) -> None:
        """Show everything."""
        parts = [self.data.points, *self.data.patches]
        if self.data.boundary is not None:
            parts.append(self.data.boundary)
        xy = np.concatenate(parts) if parts else np.zeros((0, 2))
        self._fitted = bool(len(xy)) and self.width() > 80
        if len(xy):
            low, high = xy.min(axis=0), xy.max(axis=0)
            room = np.array([max(self.width() - 48, 40), max(self.height() - (24 if self._wide else 76), 40)])
            self._centre = (low + high) / 2
            self._scale = float((room / np.maximum(high - low, 1.0)).min())
        self._layer, self._moved = None, False
        self.update()

    def zoom(self, factor: float, about: QPointF | None = None) -> None:
        """Magnify about a place of the widget, or its middle."""
        about = about or QPointF(self.width() / 2, self.height() / 2)
        place = self.to_map(about)
        self._scale = float(np.clip(self._scale * factor, 1e-4, 1e4))
        moved = self.to_map(about)
        self._centre = self._centre + place - moved
        self._layer, self._moved = None, True
        self.update()

    def to_map(self, place: QPointF) -> Floats:
        """Return map coordinates (2,) of a place of the widget."""
        x = self._centre[0] + (place.x() - self.width() / 2) / self._scale
        y = self._centre[1] - (place.y() - self._middle) / self._scale
        return np.array([x, y])

    def to_widget(self, xy: Floats) -> Floats:
        """Return places of the widget (..., 2) of map coordinates."""
        flat = (np.asarray(xy) - self._centre) * self._scale
        return np.stack([self.width() / 2 + flat[..., 0], self._middle - flat[..., 1]], axis=-1)

    @property
    def _middle(self) -> float:
        # The scale bar and the legend stand below, or beside where there is room.
        return self.height() / 2 - (0 if self._wide else 14)

    @property
    def _wide(self) -> bool:
        return self.width() > 2.5 * self.height()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the kept picture of the data, and the rectangle over it."""
        if self._layer is None:
            self._layer = self._drawn()
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._layer)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.box is not None:
            self._paint_box(painter, self.box)
        if self.hasFocus():
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Highlight), 1))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _paint_box(self, painter: QPainter, box: CoreBox) -> None:
        colour = readable(CORE, self.palette())
        ground = QColor(colour)
        ground.setAlpha(34)
        corners = [QPointF(*corner) for corner in self.to_widget(box.corners)]
        painter.setPen(QPen(colour, 2))
        painter.setBrush(ground)
        painter.drawPolygon(QPolygonF(corners))
        if self.locked:
            return
        painter.setPen(QPen(colour, 1.5))
        painter.setBrush(self.palette().color(QPalette.ColorRole.Base))
        for corner in corners:
            painter.drawRect(QRectF(corner.x() - HANDLE / 2, corner.y() - HANDLE / 2, HANDLE, HANDLE))

    def _drawn(self) -> QPixmap:
        ratio = self.devicePixelRatioF()
        pixmap = QPixmap(self.size() * ratio)
        pixmap.setDevicePixelRatio(ratio)
        palette = self.palette()
        pixmap.fill(palette.color(QPalette.ColorRole.Base))
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self.font())
        quiet = QColor(palette.color(QPalette.ColorRole.Text))
        quiet.setAlpha(60)
        painter.setPen(QPen(QColor(self.data.colour), 1))
        for rim in self.data.patches:
            painter.drawPolyline(self._line(rim))
        painter.setPen(QPen(quiet, 1, Qt.PenStyle.DotLine))
        for _, line in self.data.sections:
            painter.drawPolyline(self._line(line))
        if self.data.boundary is not None:
            painter.setPen(QPen(readable(QUIET, palette), 1.4, Qt.PenStyle.DashLine))
            painter.drawPolygon(self._line(self.data.boundary))
        self._paint_points(painter)
        quiet.setAlpha(190)
        painter.setPen(QPen(quiet, 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for _, track in self.data.holes:
            painter.drawPolyline(self._line(track))
            painter.drawEllipse(QPointF(*self.to_widget(track[0]).tolist()), 4.5, 4.5)
        named = [(name, track[0]) for name, track in self.data.holes] + [
            (name, line[-1]) for name, line in self.data.sections
        ]
        labels = [(name, self.to_widget(place)) for name, place in named]
        few = self.data.points[: MANY if len(self.data.points) <= MANY else 0]
        paper = palette.color(QPalette.ColorRole.Base)
        painter.setPen(palette.color(QPalette.ColorRole.Text))
        small = self.font()
        small.setPointSizeF(max(small.pointSizeF() - 1.5, 7.0))
        painter.setFont(small)
        draw_labels(painter, labels, self.to_widget(few), self.rect(), paper, self.data.name)
        painter.setFont(self.font())
        draw_title(painter, self.rect(), self.data.name, QColor(self.data.colour), paper)
        painter.setPen(QPen(quiet, 1))
        draw_scale_bar(painter, self.rect(), self._scale)
        draw_north(painter, self.rect())
        self._paint_legend(painter)
        painter.end()
        return pixmap

    def _paint_points(self, painter: QPainter) -> None:
        for exact in (False, True):
            of = self.data.points[self.data.exact == exact]
            places = self.to_widget(of)
            seen = ((places > -9) & (places < [self.width() + 9, self.height() + 9])).all(axis=1)
            if len(of) > MANY:
                colour = readable(CORE if exact else PERIPHERY, self.palette())
                draw_cloud(painter, places[seen], colour, self.size(), self.devicePixelRatioF())
                continue
            # Points that fall on one another are painted once: a cloud costs no more than its pixels.
            cells = np.unique((places[seen] / 1.5).round().astype(np.int64), axis=0) * 1.5
            self._dots(painter, [QPointF(x, y) for x, y in cells.tolist()], exact)

    def _dots(self, painter: QPainter, places: list[QPointF], exact: bool) -> None:
        colour = readable(CORE if exact else PERIPHERY, self.palette())
        if exact:
            pen = QPen(colour, 4.5)
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawPoints(places)
            return
        painter.setPen(QPen(colour, 1.5))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for place in places:
            painter.drawEllipse(place, 2.6, 2.6)

    def _paint_legend(self, painter: QPainter) -> None:
        exact = int(self.data.exact.sum())
        entries = [(True, self.tr("exact ({n})").format(n=exact))] if exact else []
        entries.append((False, self.tr("approximated ({n})").format(n=len(self.data.points) - exact)))
        top, left = self.height() - 9.0, 12.0
        for kind, words in entries:
            self._dots(painter, [QPointF(left, top - 4)], kind)
            painter.setPen(self.palette().color(QPalette.ColorRole.Text))
            painter.drawText(QPointF(left + 8, top), words)
            left += 20 + painter.fontMetrics().horizontalAdvance(words)

    def _line(self, xy: Floats) -> QPolygonF:
        return QPolygonF([QPointF(x, y) for x, y in self.to_widget(xy).tolist()])

    def _handle_at(self, place: QPointF) -> int | str | None:
        if self.box is None or self.locked:
            return None
        away = np.abs(self.to_widget(self.box.corners) - [place.x(), place.y()]).max(axis=1)
        if away.min() <= NEAR:
            return int(away.argmin())
        return "box" if self.box.holds(self.to_map(place)[None])[0] else None

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of a corner, the rectangle, or the plan; begin a rectangle while drawing."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._from = self.to_map(event.position())
        if self.drawing and self.blank is not None:
            place = self.blank.frame.plan(self._from[None])[0]
            self.box = CoreBox(self.blank.frame, place, place + 1e-3)
            self._grasped = "new"
        else:
            self._grasped = self._handle_at(event.position())
            self._grasped = "plan" if self._grasped is None else self._grasped
        self._start = self.box

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag what is held; show what could be held."""
        place = self.to_map(event.position())
        self.pointer_moved.emit(float(place[0]), float(place[1]))
        if self._grasped is None:
            self._show_cursor(self._handle_at(event.position()))
        elif self._grasped == "plan":
            self._centre = self._centre + self._from - place
            self._layer, self._moved = None, True
            self.update()
        elif self._start is not None:
            self.box = self._dragged(self._start, place)
            self.box_dragging.emit(self.box)
            self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        held, self._grasped = self._grasped, None
        changed = self.box is not self._start
        if held not in {None, "plan"} and changed:
            self.box_dragged.emit(self.box)
        elif held == "new":
            self.show_box(None)

    def _dragged(self, start: CoreBox, place: Floats) -> CoreBox:
        if self._grasped == "new":
            return CoreBox.around(start.frame, np.stack([self._from, place]))
        if self._grasped == "box":
            return start.moved(place - self._from)
        assert isinstance(self._grasped, int)
        return start.with_corner(self._grasped, place)

    def _show_cursor(self, handle: int | str | None) -> None:
        if self.drawing:
            self.setCursor(Qt.CursorShape.CrossCursor)
        elif isinstance(handle, int):
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        elif handle == "box":
            self.setCursor(Qt.CursorShape.SizeAllCursor)
        else:
            self.unsetCursor()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zoom about the pointer."""
        self.zoom(1.0015 ** event.angleDelta().y(), event.position())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Show everything again."""
        self.fit()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Zoom with + and -, show everything with Home, move the rectangle with the arrows."""
        steps = {
            Qt.Key.Key_Left: (-1, 0), Qt.Key.Key_Right: (1, 0), Qt.Key.Key_Up: (0, 1), Qt.Key.Key_Down: (0, -1)
        }  # fmt: skip
        key = Qt.Key(event.key())
        if key in {Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus}:
            self.zoom(0.8 if key == Qt.Key.Key_Minus else 1.25)
        elif key == Qt.Key.Key_Home:
            self.fit()
        elif key in steps and self.box is not None and not self.locked:
            self.box = self.box.moved(np.array(steps[key]) * 4 / self._scale)
            self.update()
            self.box_dragged.emit(self.box)
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Fit until somebody has moved or magnified the plan; then keep the scale."""
        self._layer = None
        if not self._fitted or not self._moved or not event.oldSize().isValid():
            self.fit()
        self.resized.emit()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme and the language."""
        self._layer = None
        self.update()
        super().changeEvent(event)

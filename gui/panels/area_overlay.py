"""Corners of the study area over a plan: dragged, added on a side, removed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF, QWheelEvent
from PySide6.QtWidgets import QWidget

from geofit.gui.panels.marks import readable
from geofit.gui.panels.plan_view import PlanView
from geofit.report.style import FAIL

__all__ = ["AreaOverlay"]

Floats = NDArray[np.float64]

#: Side of a corner's handle, and how near the pointer must come, logical pixels; fewest corners.
HANDLE, NEAR, FEWEST = 9.0, 9.0, 3


class AreaOverlay(QWidget):
    """Covers a plan while the study area is edited; ``changed(corners)`` after each drag, addition and removal.

    A corner is dragged; a double click on a side adds one; Delete, or a click with the right button, removes one.
    Elsewhere the plan below gets the mouse.
    """

    changed = Signal(object)

    def __init__(self, view: PlanView) -> None:
        super().__init__(view)
        self._view = view
        self.corners: Floats = np.empty((0, 2))
        self.current: int | None = None
        self._grasped: int | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Corners of the study area"))
        self.setToolTip(self.tr("Drag a corner; double-click a side to add one; Delete removes the chosen one."))
        view.resized.connect(self._cover)
        self.hide()

    def edit(self, corners: Floats) -> None:
        """Show corners to be edited, (k, 2) map coordinates."""
        self.corners, self._grasped = np.array(corners, float), None
        if self.current is not None and self.current >= len(corners):
            self.current = None
        self.setGeometry(self._view.rect())
        self.show()
        self.raise_()
        self.update()

    def _cover(self) -> None:
        """Stay as large as the plan."""
        self.setGeometry(self._view.rect())

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the area with its handles."""
        if not len(self.corners):
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colour = readable(FAIL, self.palette())
        places = [QPointF(x, y) for x, y in self._view.to_widget(self.corners).tolist()]
        painter.setPen(QPen(colour, 2))
        painter.drawPolygon(QPolygonF(places))
        for k, place in enumerate(places):
            painter.setBrush(colour if k == self.current else self.palette().base().color())
            painter.drawRect(QRectF(place.x() - HANDLE / 2, place.y() - HANDLE / 2, HANDLE, HANDLE))
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of a corner; the right button removes it; elsewhere the plan is moved."""
        self._grasped = self._corner_at(event.position())
        if self._grasped is None:
            self._view.mousePressEvent(event)
            return
        self.current = self._grasped
        if event.button() == Qt.MouseButton.RightButton:
            self._remove(self._grasped)
        self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag the corner that is held."""
        if self._grasped is None:
            near = self._corner_at(event.position()) is not None
            self.setCursor(Qt.CursorShape.PointingHandCursor if near else Qt.CursorShape.ArrowCursor)
            self._view.mouseMoveEvent(event)
        else:
            self.corners[self._grasped] = self._view.to_map(event.position())
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go, and tell."""
        held, self._grasped = self._grasped, None
        if held is None:
            self._view.mouseReleaseEvent(event)
        else:
            self._tell()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Add a corner on the side under the pointer."""
        at = np.array([event.position().x(), event.position().y()])
        places = self._view.to_widget(self.corners)
        ends = np.roll(places, -1, axis=0)
        way = ends - places
        share = (((at - places) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-9)).clip(0, 1)
        away = np.linalg.norm(places + share[:, None] * way - at, axis=1)
        side = int(away.argmin())
        if away[side] <= NEAR and self._corner_at(event.position()) is None:
            self.corners = np.insert(self.corners, side + 1, self._view.to_map(event.position()), axis=0)
            self.current = side + 1
            self._tell()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Remove the chosen corner with Delete."""
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and self.current is not None:
            self._remove(self.current)
        else:
            self._view.keyPressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zoom the plan."""
        self._view.wheelEvent(event)
        self.update()

    def _corner_at(self, place: QPointF) -> int | None:
        if not len(self.corners):
            return None
        away = np.abs(self._view.to_widget(self.corners) - [place.x(), place.y()]).max(axis=1)
        return int(away.argmin()) if away.min() <= NEAR else None

    def _remove(self, corner: int) -> None:
        self._grasped = None
        if len(self.corners) > FEWEST:
            self.corners = np.delete(self.corners, corner, axis=0)
            self.current = None
            self._tell()

    def _tell(self) -> None:
        self.update()
        self.changed.emit(tuple((float(x), float(y)) for x, y in self.corners))

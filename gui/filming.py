"""A film of a metamorphosis as the 3D view shows it: one picture a frame by the view's own camera, then a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter

from geofit.data.progress import Progress, tell
from geofit.gui.activity import Activity
from geofit.gui.view3d.view import SceneView
from geofit.report.film import save_film

__all__ = ["Filming"]

Pixels = NDArray[np.uint8]

#: Room around the line of text, and from the lower edge, logical pixels.
ROOM, ABOVE = 8.0, 40.0


class Filming(QObject):
    """Takes pictures while ``show(tau)``, which returns the line under each, moves the scene.

    ``written(path)`` comes when the file is whole, ``ended()`` when the scene may be moved elsewhere.
    """

    written = Signal(object)
    ended = Signal()

    def __init__(self, view: SceneView, activity: Activity, parent: QObject) -> None:
        super().__init__(parent)
        self._view, self._activity = view, activity
        self._show: Callable[[float], str] = lambda _: ""
        self._taus: list[float] = []
        self._pictures: list[Pixels] = []
        self._path, self._title = Path(), ""
        self._next = QTimer(self, interval=0)
        self._next.timeout.connect(self._take)

    @property
    def running(self) -> bool:
        """Whether pictures are being taken."""
        return self._next.isActive()

    def start(self, path: Path, taus: list[float], show: Callable[[float], str], title: str) -> None:
        """Take a picture at each share of the way, then write the film."""
        self._path, self._taus, self._show, self._title = path, list(taus), show, title
        self._pictures = []
        self._next.start()

    def stop(self) -> None:
        """Give the film up."""
        if self._next.isActive():
            self._next.stop()
            self._pictures = []
            self.ended.emit()

    def _take(self) -> None:
        # One picture an event: the window lives meanwhile.
        words = self._show(self._taus[len(self._pictures)])
        image = self._view.picture()
        _write(image, words)
        self._pictures.append(_pixels(image))
        if len(self._pictures) == len(self._taus):
            self._next.stop()
            pictures, self._pictures = self._pictures, []
            self.ended.emit()
            self._activity.do(self._title, _saved, pictures, self._path, on_done=self.written.emit)


def _saved(pictures: list[Pixels], path: Path, *, progress: Progress) -> Path:
    tell(progress, "film", 0.1)
    return save_film(pictures, path)


def _write(image: QImage, words: str) -> None:
    """Write a line in the middle, below: dark on a light strip, readable on every ground."""
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    font = painter.font()
    font.setPixelSize(max(13, image.height() // 40))
    painter.setFont(font)
    width = QFontMetricsF(font, image).horizontalAdvance(words) + 2 * ROOM
    height = QFontMetricsF(font, image).height() + ROOM
    strip = QRectF((image.width() - width) / 2, image.height() - ABOVE - height, width, height)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(255, 255, 255, 220))
    painter.drawRoundedRect(strip, 4, 4)
    painter.setPen(QColor("#222222"))
    painter.drawText(strip, Qt.AlignmentFlag.AlignCenter, words)
    painter.end()


def _pixels(image: QImage) -> Pixels:
    plain = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(plain.constBits(), np.uint8).reshape(plain.height(), plain.bytesPerLine())
    return rows[:, : 3 * plain.width()].reshape(plain.height(), plain.width(), 3).copy()

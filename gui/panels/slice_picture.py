"""One slice of a rock volume as a picture: grey values, and the voxels that count as pore in colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QSize
from PySide6.QtGui import QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

__all__ = ["SlicePicture"]

#: Colour of a pore, and its share over the grey of the voxel.
PORE, OVER = (31, 119, 180), 0.65


class SlicePicture(QWidget):
    """Draws a slice as large as it fits, its voxels square; Qt alone, because a slice follows the slider."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumSize(QSize(200, 100))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.image: QImage | None = None

    def show_slice(
        self, values: NDArray[Any], limits: tuple[float, float], pores: tuple[float, float] | None = None
    ) -> None:
        """Show the values (n, m) of a slice.

        Parameters
        ----------
        values : (n, m) array
            Rows from top to bottom.
        limits : two floats
            The values drawn black and white.
        pores : two floats, optional
            Values between these, both included, are drawn as pores.
        """
        low, high = limits
        # In single precision: a slice has more voxels than the eye has shades.
        grey = (values.astype(np.float32) - np.float32(low)) * np.float32(255 / max(high - low, 1e-300))
        shade = np.clip(np.nan_to_num(grey), 0, 255).astype(np.uint8)
        inside = (-np.inf, -np.inf) if pores is None else pores
        coloured = (values >= inside[0]) & (values <= inside[1])
        pixels = _colours()[coloured.astype(np.intp), shade]
        height, width = pixels.shape
        # The picture keeps a copy: numpy may free what it was made of.
        self.image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGB32).copy()
        self.update()

    def place(self) -> QRect:
        """Return where the slice is drawn: in the middle, as large as it fits."""
        if self.image is None:
            return QRect()
        width, height = self.image.width(), self.image.height()
        scale = min(self.width() / width, self.height() / height)
        wide, high = max(int(width * scale), 1), max(int(height * scale), 1)
        return QRect((self.width() - wide) // 2, (self.height() - high) // 2, wide, high)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw the slice; voxels stay sharp where there are fewer of them than pixels."""
        if self.image is None:
            return
        painter = QPainter(self)
        place = self.place()
        smaller = place.width() * self.devicePixelRatioF() < self.image.width()
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, smaller)
        painter.drawImage(place, self.image)


def _colours() -> NDArray[np.uint32]:
    """Return the pixels of rock (row 0) and pore (row 1) for each of 256 shades of grey."""
    shade = np.arange(256)
    pore = [np.round((1 - OVER) * shade + OVER * part).astype(np.uint32) for part in PORE]
    rock = [shade.astype(np.uint32)] * 3
    return np.array([(np.uint32(0xFF) << 24) | (r << 16) | (g << 8) | b for r, g, b in (rock, pore)], np.uint32)

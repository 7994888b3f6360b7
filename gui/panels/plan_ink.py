"""What every plan carries: names that do not cover each other, a scale bar, and north."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF

__all__ = ["draw_cloud", "draw_labels", "draw_north", "draw_scale_bar", "round_length"]

#: A name may cover so many points.
CROWDED = 2
#: Longest scale bar, pixels.
LONGEST = 110


def round_length(most: float) -> float:
    """Return the longest of 1, 2, 5, 10, ... metres that is not above ``most``.

    Examples
    --------
    >>> round_length(430.0), round_length(0.9)
    (200.0, 0.5)
    """
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(step * power for step in (1, 2, 5) if step * power <= most * (1 + 1e-12)))


def draw_cloud(painter: QPainter, places: NDArray[np.float64], colour: QColor, size: QSize, ratio: float) -> None:
    """Dot so many places (n, 2) of the widget that painting each by itself would take too long."""
    width, height = round(size.width() * ratio), round(size.height() * ratio)
    pixels = np.zeros((height, width), np.uint32)
    reach = round(ratio)
    x, y = np.round(places * ratio).astype(int).T
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            shown = (x + dx >= 0) & (x + dx < width) & (y + dy >= 0) & (y + dy < height)
            pixels[y[shown] + dy, x[shown] + dx] = colour.rgba()
    image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_ARGB32)
    image.setDevicePixelRatio(ratio)
    painter.drawImage(0, 0, image)


def draw_labels(
    painter: QPainter, named: Sequence[tuple[str, NDArray[np.float64]]], busy: NDArray[np.float64], within: QRect
) -> None:
    """Write names beside their places, the first come first.

    A name that would cover another, or more than two of the ``busy`` (n, 2) places, is left out: it is seen when the
    plan is magnified.
    """
    metrics = painter.fontMetrics()
    # The corners are taken by the legend, the scale bar and north.
    taken = [QRectF(0, within.height() - 40, within.width(), 40), QRectF(within.width() - 40, 0, 40, 52)]
    for name, (x, y) in named:
        box = QRectF(x + 7, y - metrics.ascent() / 2 - 1, metrics.horizontalAdvance(name), metrics.height())
        inside = (busy > [box.left(), box.top()]) & (busy < [box.right(), box.bottom()])
        free = inside.all(axis=1).sum() <= CROWDED and not any(box.intersects(other) for other in taken)
        if free and QRectF(within).contains(box):
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name)
            taken.append(box)


def draw_scale_bar(painter: QPainter, within: QRect, scale: float) -> None:
    """Draw a bar of a round length at the lower left, above the legend."""
    length = round_length(LONGEST / scale)
    left, bottom = 12.0, within.height() - 29.0
    right = left + length * scale
    pen = QPen(painter.pen().color(), 2)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    painter.setPen(pen)
    painter.drawPolyline(
        [QPointF(left, bottom - 5), QPointF(left, bottom), QPointF(right, bottom), QPointF(right, bottom - 5)]
    )
    painter.drawText(QPointF(right + 6, bottom + 1), f"{length:g} m")


def draw_north(painter: QPainter, within: QRect) -> None:
    """Draw an arrow to the north at the upper right."""
    x, y = within.width() - 20.0, 10.0
    colour = painter.pen().color()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colour)
    painter.drawPolygon(QPolygonF([QPointF(x, y), QPointF(x + 6, y + 20), QPointF(x, y + 15), QPointF(x - 6, y + 20)]))
    painter.setPen(QPen(colour, 1))
    painter.drawText(QRectF(x - 12, y + 21, 24, 16), Qt.AlignmentFlag.AlignCenter, "N")

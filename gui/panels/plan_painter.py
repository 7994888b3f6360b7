"""What every plan carries: names that do not cover each other, a scale bar, and north."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPainterPath, QPen, QPolygonF

from geofit.gui.lengths import length_mark, metres_shown, shown_length

__all__ = ["draw_cloud", "draw_labels", "draw_north", "draw_scale_bar", "draw_title", "round_length"]

#: Left, top, width and height, logical pixels.
Box = tuple[float, float, float, float]
#: Side of the cells in which room is looked for, and the distance of a name from its place, logical pixels.
CELL, GAP = 4, 8.0
#: How a name costs that covers a point, or the mark of another name; dearer than DEAREST it is left out.
POINT, MARK, DEAREST = 1.0, 4.0, 12.0
#: Where a name may stand about its place, the best first: the share of its width and height to the right and below.
SIDES = ((1, 0), (-1, 0), (0, -1), (0, 1), (1, -1), (1, 1), (-1, -1), (-1, 1))
#: Width of the paper-coloured rim of the letters, logical pixels.
HALO = 3.0
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
    painter: QPainter,
    named: Sequence[tuple[str, NDArray[np.float64]]],
    busy: NDArray[np.float64],
    within: QRect,
    paper: QColor,
    title: str = "",
) -> list[tuple[str, Box]]:
    """Write as many names beside their places as do not cover each other; return them with where they stand.

    Each stands where it covers least of the ``busy`` (n, 2) places; names with much room come first. Where the crowd
    is too dense a name is left out: it is seen when the plan is magnified. ``paper`` rims the letters, ``title`` stands
    in the upper left corner.
    """
    metrics = painter.fontMetrics()
    room = _Room(within, busy, np.array([place for _, place in named]).reshape(-1, 2))
    # The corners are taken by the legend, the scale bar, the horizon's name and north.
    width, height = within.width(), within.height()
    for corner in (
        (0, height - 40, width, 40),
        (width - 40, 0, 40, 52),
        (0, 0, 34 + 1.2 * metrics.horizontalAdvance(title), 22),
    ):
        room.take(corner)
    offers = []
    for k, (name, place) in enumerate(named):
        size = metrics.horizontalAdvance(name), metrics.height() - 2
        boxes = sorted((room.cost(box) + 0.1 * i, i, box) for i, box in enumerate(_about(place, size)))
        offers.append((boxes[0][0], k, boxes))
    written: list[tuple[str, Box]] = []
    for _, k, boxes in sorted(offers, key=lambda offer: offer[:2]):
        free = next((box for cost, _, box in boxes if cost <= DEAREST and not room.taken(box)), None)
        if free is not None:
            room.take(free)
            _write(painter, named[k][0], QPointF(free[0], free[1] + metrics.ascent() - 1), paper)
            written.append((named[k][0], free))
    return written


def _about(place: NDArray[np.float64], size: tuple[float, float]) -> list[Box]:
    """Return left, top, width and height of a name at each side of its place."""
    (x, y), (wide, high) = place.tolist(), size
    return [
        (x + right * GAP - wide * (1 - right) / 2, y + down * GAP * 0.8 - high * (1 - down) / 2, wide, high)
        for right, down in SIDES
    ]


class _Room:
    """What of a plan is taken already, and how crowded the rest is, in cells."""

    def __init__(self, within: QRect, points: NDArray[np.float64], marks: NDArray[np.float64]) -> None:
        self._shape = max(within.height() // CELL, 1), max(within.width() // CELL, 1)
        self._taken = np.zeros(self._shape, bool)
        crowd = np.zeros(self._shape)
        for places, cost in ((points, POINT), (marks, MARK)):
            cells = np.floor(places / CELL).astype(int)
            seen = ((cells >= 0) & (cells < self._shape[::-1])).all(axis=1)
            np.add.at(crowd, (cells[seen, 1], cells[seen, 0]), cost)
        # Sums up to each cell: what a box covers is read from its four corners.
        self._sums = np.pad(crowd, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)

    def cost(self, box: Box) -> float:
        """Return what a box covers; infinite where it is not all inside."""
        cells = self._cells(box)
        if cells is None:
            return np.inf
        top, bottom, left, right = cells
        s = self._sums
        return float(s[bottom, right] - s[top, right] - s[bottom, left] + s[top, left])

    def taken(self, box: Box) -> bool:
        """Whether something was written there."""
        cells = self._cells(box)
        return cells is None or bool(self._taken[cells[0] : cells[1], cells[2] : cells[3]].any())

    def take(self, box: Box) -> None:
        """Keep others from a box."""
        left, top, wide, high = box
        rows = slice(max(int(top // CELL), 0), max(int((top + high) // CELL) + 1, 0))
        self._taken[rows, max(int(left // CELL), 0) : max(int((left + wide) // CELL) + 1, 0)] = True

    def _cells(self, box: Box) -> tuple[int, int, int, int] | None:
        left, top, wide, high = box
        cells = (
            int(top // CELL), int((top + high) // CELL) + 1, int(left // CELL), int((left + wide) // CELL) + 1,
        )  # fmt: skip
        inside = left >= 0 and top >= 0 and cells[1] <= self._shape[0] and cells[3] <= self._shape[1]
        return cells if inside else None


def _write(painter: QPainter, text: str, at: QPointF, paper: QColor) -> None:
    """Write letters with a rim of paper, that they can be read over anything."""
    path = QPainterPath()
    path.addText(at, painter.font(), text)
    rim = QPen(paper, HALO)
    rim.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.strokePath(path, rim)
    painter.fillPath(path, painter.pen().color())


def draw_title(painter: QPainter, within: QRect, name: str, colour: QColor, paper: QColor) -> None:
    """Write what is shown into the upper left corner, after a square in its colour, as far as the north arrow."""
    metrics = painter.fontMetrics()
    name = metrics.elidedText(name, Qt.TextElideMode.ElideMiddle, max(within.width() - 65, 20))
    painter.fillRect(QRectF(10, 8, 10, 10), colour)
    _write(painter, name, QPointF(25, 13 + metrics.capHeight() / 2), paper)


def draw_scale_bar(painter: QPainter, within: QRect, scale: float) -> None:
    """Draw a bar of a round length at the lower left, above the legend."""
    length = round_length(shown_length(LONGEST / scale))
    left, bottom = 12.0, within.height() - 29.0
    right = left + length * metres_shown() * scale
    pen = QPen(painter.pen().color(), 2)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    painter.setPen(pen)
    painter.drawPolyline(
        [QPointF(left, bottom - 5), QPointF(left, bottom), QPointF(right, bottom), QPointF(right, bottom - 5)]
    )
    painter.drawText(QPointF(right + 6, bottom + 1), f"{length:g} {length_mark()}")


def draw_north(painter: QPainter, within: QRect) -> None:
    """Draw an arrow to the north at the upper right."""
    x, y = within.width() - 20.0, 10.0
    colour = painter.pen().color()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colour)
    painter.drawPolygon(QPolygonF([QPointF(x, y), QPointF(x + 6, y + 20), QPointF(x, y + 15), QPointF(x - 6, y + 20)]))
    painter.setPen(QPen(colour, 1))
    painter.drawText(QRectF(x - 12, y + 21, 24, 16), Qt.AlignmentFlag.AlignCenter, "N")

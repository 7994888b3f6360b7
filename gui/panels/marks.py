"""Marks that differ in shape as well as colour, drawn sharply at every scale: passed, failed, stale and the like."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QIcon, QPainter, QPainterPath, QPalette, QPen, QPixmap, QPolygonF

from geofit.data.verdict import Level
from geofit.gui.theme import is_dark
from geofit.report.style import FAIL, PASS, QUIET, WARNING

__all__ = ["icon", "level_mark", "readable", "verdict_mark"]

_SIZE = 16
#: A horizon's colour and its verdict side by side are so wide.
_PAIR = 32
_RATIOS = (1.0, 1.25, 1.5, 2.0)


def readable(colour: str, palette: QPalette) -> QColor:
    """Return one of the fixed colours, lightened where it would sink into a dark window."""
    made = QColor(colour)
    if not is_dark(palette) or made.lightness() > 150:
        return made
    return QColor.fromHsl(made.hslHue(), min(made.hslSaturation(), 170), 165)


def verdict_mark(passed: bool | None, *, stale: bool = False) -> QIcon:
    """Return the mark of a check: a disc with a tick, a square with a cross, a ring with a dash."""
    if stale:
        return icon("stale")
    return icon("none" if passed is None else "passed" if passed else "failed")


def level_mark(level: Level) -> str:
    """Return the name of the mark of a lamp or a verdict."""
    return {"none": "none", "pass": "passed", "warning": "warning", "fail": "failed"}[level]


@lru_cache(maxsize=128)
def icon(name: str) -> QIcon:
    """Return a mark by name: passed, warning, failed, stale; hole, section, ...; up, dot, horizon with a colour.

    Two names with a plus sign between them are two marks side by side.
    """
    made = QIcon()
    for ratio in _RATIOS:
        swatch, _, mark = name.rpartition("+")
        pixmap = QPixmap(round((_PAIR if swatch else _SIZE) * ratio), round(_SIZE * ratio))
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if swatch:
            paint(painter, QRectF(1, 1, 14, 14), swatch)
        paint(painter, QRectF(_PAIR - 15 if swatch else 1, 1, 14, 14), mark)
        painter.end()
        for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected, QIcon.Mode.Active):
            made.addPixmap(pixmap, mode)
    return made


def paint(painter: QPainter, box: QRectF, name: str) -> None:
    """Paint a mark into a box."""
    side = box.width()
    pen = QPen(QColor("white"), side / 7)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)

    def at(x: float, y: float) -> QPointF:
        return QPointF(box.left() + x * side, box.top() + y * side)

    painter.setPen(Qt.PenStyle.NoPen)
    if name == "passed":
        painter.setBrush(QColor(PASS))
        painter.drawEllipse(box)
        painter.setPen(pen)
        painter.drawPolyline(QPolygonF([at(0.27, 0.53), at(0.44, 0.7), at(0.74, 0.34)]))
    elif name == "failed":
        painter.setBrush(QColor(FAIL))
        painter.drawRect(box)
        painter.setPen(pen)
        painter.drawLine(at(0.28, 0.28), at(0.72, 0.72))
        painter.drawLine(at(0.72, 0.28), at(0.28, 0.72))
    elif name == "none":
        painter.setPen(QPen(QColor(QUIET), side / 9))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(box.adjusted(1, 1, -1, -1))
        painter.drawLine(at(0.32, 0.5), at(0.68, 0.5))
    elif name == "stale":
        clock = QPen(QColor(WARNING), side / 9)
        clock.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(clock)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(box.adjusted(1, 1, -1, -1))
        painter.drawPolyline(QPolygonF([at(0.5, 0.26), at(0.5, 0.52), at(0.7, 0.62)]))
    elif name == "warning":
        painter.setBrush(QColor("#c98a12"))
        painter.drawPolygon(QPolygonF([at(0.5, 0.02), at(1.0, 0.95), at(0.0, 0.95)]))
        painter.setPen(pen)
        painter.drawLine(at(0.5, 0.38), at(0.5, 0.62))
        painter.drawPoint(at(0.5, 0.81))
    else:
        _things(painter, box, name, at)


def _things(painter: QPainter, box: QRectF, name: str, at: Callable[[float, float], QPointF]) -> None:
    side = box.width()
    line = QPen(QColor("#3f86b8"), side / 8)
    line.setCapStyle(Qt.PenCapStyle.RoundCap)
    painter.setPen(line)
    if name == "hole":
        painter.drawLine(at(0.5, 0.1), at(0.5, 0.95))
        painter.drawLine(at(0.25, 0.1), at(0.75, 0.1))
    elif name == "adit":
        line.setColor(QColor("#9a6dba"))
        painter.setPen(line)
        path = QPainterPath(at(0.18, 0.92))
        path.lineTo(at(0.18, 0.45))
        path.cubicTo(at(0.18, 0.0), at(0.82, 0.0), at(0.82, 0.45))
        path.lineTo(at(0.82, 0.92))
        painter.drawPath(path)
    elif name.startswith("layer:"):
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(name.partition(":")[2]))
        painter.drawRoundedRect(QRectF(at(0.14, 0.14), at(0.86, 0.86)), 2, 2)
    elif name == "section":
        line.setColor(QColor(QUIET))
        painter.setPen(line)
        painter.drawLine(at(0.05, 0.85), at(0.95, 0.15))
    elif name.startswith(("horizon:", "patch:")):
        kind, _, colour = name.partition(":")
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QBrush(QColor(colour)))
        shift = 0.0 if kind == "horizon" else 0.12
        painter.drawPolygon(QPolygonF([at(0.0, 0.6), at(0.45, 0.2 + shift), at(1.0, 0.4), at(0.55, 0.85 - shift)]))
    elif name.startswith("body:"):
        _body(painter, box, name)
    elif name == "report":
        painter.setPen(QPen(QColor(QUIET), side / 12))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(QRectF(at(0.18, 0.05), at(0.82, 0.95)))
        for y in (0.3, 0.5, 0.7):
            painter.drawLine(at(0.32, y), at(0.68, y))
    elif name.startswith(("up", "down", "dot")):
        _band(painter, name, at)
    else:
        raise ValueError(f"there is no mark named '{name}'")


def _body(painter: QPainter, box: QRectF, name: str) -> None:
    """Paint a lump in a body's colour with the mark of its verdict in a corner: "body:#aabbcc:passed"."""
    _, colour, *mark = name.split(":")
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colour))
    side = box.width()
    lump = QPainterPath(box.topLeft() + QPointF(0.04 * side, 0.5 * side))
    for (x1, y1), (x2, y2), (x, y) in (
        ((0.0, 0.1), (0.4, 0.0), (0.6, 0.1)), ((0.95, 0.2), (1.05, 0.55), (0.85, 0.75)),
        ((0.6, 1.0), (0.1, 0.95), (0.04, 0.5)),
    ):  # fmt: skip
        first, second, end = (box.topLeft() + QPointF(a * side, b * side) for a, b in ((x1, y1), (x2, y2), (x, y)))
        lump.cubicTo(first, second, end)
    painter.drawPath(lump)
    if mark and mark[0]:
        corner = QRectF(box.left() + 0.45 * side, box.top() + 0.45 * side, 0.58 * side, 0.58 * side)
        # The mark of a stale body is an open ring: over the body's own colour it would not be seen.
        painter.setBrush(QColor("white"))
        painter.drawEllipse(corner)
        paint(painter, corner, mark[0])


def _band(painter: QPainter, name: str, at: Callable[[float, float], QPointF]) -> None:
    """Paint a deviation's mark as the map has it: a triangle up or down, or a dot; the colour follows the colon."""
    shape, _, colour = name.partition(":")
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colour or QUIET))
    if shape == "dot":
        painter.drawEllipse(at(0.5, 0.5), 2.6, 2.6)
    elif shape == "up":
        painter.drawPolygon(QPolygonF([at(0.5, 0.12), at(0.92, 0.84), at(0.08, 0.84)]))
    else:
        painter.drawPolygon(QPolygonF([at(0.5, 0.88), at(0.92, 0.16), at(0.08, 0.16)]))

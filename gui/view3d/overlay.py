"""What is written over the scene: names, coordinates, legend, north, scale, exaggeration, rings and measures.

Qt draws it, not VTK: Qt finds a font for Chinese and Greek letters by itself, and letters stay sharp at any scale.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QLinearGradient, QPainter, QPen, QPolygonF

from geofit.gui.lengths import length_mark, metres_shown, shown_length
from geofit.gui.view3d.axes import Mark, grouped, nice
from geofit.gui.view3d.layer_names import word
from geofit.gui.view3d.layers import Legend
from geofit.gui.view3d.projector import Projector
from geofit.report.style import shortened

__all__ = ["Content", "Ring", "Theme", "draw_legend", "draw_overlay", "legend_size", "legend_title", "merged"]

Floats = NDArray[np.float64]

MARGIN = 12.0
#: Cells in which only one name is drawn, logical pixels.
CELL = 14.0
#: Arms of the sign of directions; widest scale bar; width of a legend's ramp.
ARM, BAR, RAMP = 30.0, 160.0, 150.0
#: Length of the arrows along which something is dragged; longest line beside a place.
PULL, LINE = 34.0, 380.0


@dataclass(frozen=True)
class Theme:
    """Colours of what is written: letters, quiet letters, the ground behind them, and what is pointed at."""

    text: QColor
    quiet: QColor
    paper: QColor
    mark: QColor


@dataclass(frozen=True, eq=False)
class Ring:
    """A ring about a place, and a text beside it; ``solid`` for something small that was taken hold of.

    Arrows along ``way`` (3,) show that it can be dragged.
    """

    xyz: Floats
    text: str
    solid: bool = False
    way: Floats | None = None


@dataclass(eq=False)
class Content:
    """Everything that is written, places in map coordinates."""

    names: list[tuple[Floats, Sequence[str]]] = field(default_factory=list)
    rings: list[Ring] = field(default_factory=list)
    path: Floats | None = None
    path_text: str = ""
    handles: list[Floats] = field(default_factory=list)
    legends: list[tuple[str, Legend]] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    note: str = ""
    directions: Floats = field(default_factory=lambda: np.eye(3))
    metres: float | None = None


def draw_overlay(painter: QPainter, view: Projector, content: Content, theme: Theme, font: QFont) -> None:
    """Write everything, what matters most last."""
    painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
    small = QFont(font)
    small.setPointSizeF(max(font.pointSizeF() - 1, 7.0))
    painter.setFont(small)
    legends = _legend_boxes(small, view, content.legends)
    kept = [*(box for _, _, box in legends), _note_box(font, view, content)]
    _marks(painter, content.marks, kept, theme)
    _names(painter, view, content.names, kept, theme)
    if content.path is not None:
        _path(painter, view, content.path, content.path_text, theme)
    for handle in content.handles:
        _handle(painter, view, handle, theme)
    for ring in content.rings:
        _ring(painter, view, ring, theme)
    for title, legend, box in legends:
        _plate(painter, box, theme, 235)
        draw_legend(painter, box, title, legend, theme)
    _directions(painter, view, content.directions, theme)
    painter.setFont(font)
    _note(painter, view, content, theme)


def _plate(painter: QPainter, box: QRectF, theme: Theme, alpha: int = 190, border: QColor | None = None) -> None:
    paper = QColor(theme.paper)
    paper.setAlpha(alpha)
    painter.setPen(QPen(border, 1) if border is not None else Qt.PenStyle.NoPen)
    painter.setBrush(paper)
    painter.drawRoundedRect(box, 3, 3)


def _marks(painter: QPainter, marks: Sequence[Mark], kept: Sequence[QRectF], theme: Theme) -> None:
    metrics = QFontMetricsF(painter.font())
    for mark in marks:
        painter.setPen(QPen(theme.quiet, 1))
        tip = QPointF(mark.x + 5 * mark.out[0], mark.y + 5 * mark.out[1])
        wide, high = metrics.horizontalAdvance(mark.text), metrics.height()
        # The nearest corner or side of the text's box is at the tick.
        x = max(tip.x() + 3 * mark.out[0] - wide * (1 - mark.out[0]) / 2, 2.0)
        y = tip.y() + 3 * mark.out[1] - high * (1 - mark.out[1]) / 2
        box = QRectF(x, y, wide + 1, high)
        if not any(box.intersects(other) for other in kept):
            # At the view's edge the text has moved to where the tick is.
            if not box.contains(tip):
                painter.drawLine(QPointF(mark.x, mark.y), tip)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, mark.text)


def _cells(box: QRectF) -> set[tuple[int, int]]:
    return {
        (i, j)
        for i in range(int(box.left() // CELL), int(box.right() // CELL) + 1)
        for j in range(int(box.top() // CELL), int(box.bottom() // CELL) + 1)
    }


def _names(
    painter: QPainter,
    view: Projector,
    groups: Sequence[tuple[Floats, Sequence[str]]],
    kept: Sequence[QRectF],
    theme: Theme,
) -> None:
    """Draw names from front to back, leaving out what would cover another one or lie in a box that is kept free."""
    metrics = QFontMetricsF(painter.font())
    placed: list[tuple[float, float, float, str]] = []
    for places, texts in groups:
        if len(texts):
            seen = view.screen(places)
            inside = (seen[:, 0] > 0) & (seen[:, 0] < view.width) & (seen[:, 1] > 0) & (seen[:, 1] < view.height)
            placed += [(*seen[k, [2, 0, 1]].tolist(), texts[k]) for k in np.flatnonzero(inside).tolist()]
    taken = set[tuple[int, int]]().union(*map(_cells, kept))
    for _, x, y, text in sorted(placed):
        wide, high = metrics.horizontalAdvance(text) + 6, metrics.height()
        box = QRectF(x - wide / 2, y - high - 7, wide, high)
        cells = _cells(box)
        if taken.isdisjoint(cells):
            taken |= cells
            _plate(painter, box, theme, 150)
            painter.setPen(theme.text)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _path(painter: QPainter, view: Projector, path: Floats, text: str, theme: Theme) -> None:
    seen = view.screen(path)[:, :2]
    if not np.isfinite(seen).all():
        return
    ends = [QPointF(*row) for row in seen.tolist()]
    for pen in (QPen(theme.paper, 4.5), QPen(theme.mark, 2)):
        painter.setPen(pen)
        painter.drawPolyline(ends)
    painter.setBrush(theme.paper)
    for end in ends:
        painter.drawEllipse(end, 4, 4)
    if text:
        _tag(painter, view, (ends[0] + ends[-1]) / 2 + QPointF(0, -16), text, theme)


def _ring(painter: QPainter, view: Projector, ring: Ring, theme: Theme) -> None:
    x, y, _ = view.screen(ring.xyz)[0].tolist()
    if not (math.isfinite(x) and -20 < x < view.width + 20 and -20 < y < view.height + 20):
        return
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for pen in (QPen(theme.paper, 5), QPen(theme.mark, 2.2)):
        painter.setPen(pen)
        painter.drawEllipse(QPointF(x, y), 10, 10)
    if ring.solid:
        painter.setPen(QPen(theme.paper, 1.5))
        painter.setBrush(theme.mark)
        painter.drawEllipse(QPointF(x, y), 4.5, 4.5)
    if ring.way is not None:
        _arrows(painter, view, ring, theme)
    if ring.text:
        _tag(painter, view, QPointF(x, y - (24 if ring.way is None else PULL + 14)), ring.text, theme)


def _arrows(painter: QPainter, view: Projector, ring: Ring, theme: Theme) -> None:
    """Draw an arrow to either side of a ring, along the way that it can be dragged."""
    assert ring.way is not None
    here, there = view.screen(np.stack([ring.xyz, ring.xyz + ring.way]))[:, :2]
    step = there - here
    length = float(np.linalg.norm(step))
    # Seen along its way, it is dragged up and down in the picture.
    step = step / length if np.isfinite(length) and length > 1e-3 else np.array([0.0, -1.0])
    along, across = QPointF(*step.tolist()), QPointF(-float(step[1]), float(step[0]))
    centre = QPointF(*here.tolist())
    for sign in (1.0, -1.0):
        tip, neck = centre + along * (sign * PULL), centre + along * (sign * (PULL - 9))
        head = QPolygonF([tip, neck + across * 5.5, neck - across * 5.5])
        for pen in (QPen(theme.paper, 5), QPen(theme.mark, 2.2)):
            painter.setPen(pen)
            painter.drawLine(centre + along * (sign * 11.0), neck)
        painter.setPen(QPen(theme.paper, 1.2))
        painter.setBrush(theme.mark)
        painter.drawPolygon(head)


def _tag(painter: QPainter, view: Projector, at: QPointF, text: str, theme: Theme) -> None:
    """Write a text on a plate about a place, moved so that it stays inside the picture."""
    flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    least = QFontMetricsF(painter.font()).boundingRect(QRectF(0, 0, LINE, 4000), int(flags), text)
    wide, high = least.width() + 14, least.height() + 6
    x = min(max(at.x() - wide / 2, MARGIN), view.width - wide - MARGIN)
    y = min(max(at.y() - high, MARGIN), view.height - high - MARGIN)
    box = QRectF(x, y, wide, high)
    _plate(painter, box, theme, 235, theme.mark)
    painter.setPen(theme.text)
    painter.drawText(box.adjusted(6, 0, -6, 0), int(flags), text)


def _handle(painter: QPainter, view: Projector, at: Floats, theme: Theme) -> None:
    x, y, _ = view.screen(at)[0].tolist()
    if math.isfinite(x):
        painter.setPen(QPen(theme.mark, 2))
        painter.setBrush(theme.paper)
        painter.drawRoundedRect(QRectF(x - 6, y - 6, 12, 12), 3, 3)


def _legend_boxes(
    font: QFont, view: Projector, legends: Sequence[tuple[str, Legend]]
) -> list[tuple[str, Legend, QRectF]]:
    """Return the legends that there is room for, from the upper right corner downwards, with their boxes."""
    top, found = MARGIN, []
    width = max((legend_size(font, title, legend)[0] for title, legend in legends), default=0.0)
    for title, legend in legends:
        height = legend_size(font, title, legend)[1]
        if top + height > view.height - 110:
            break
        found.append((title, legend, QRectF(view.width - width - MARGIN, top, width, height)))
        top += height + 6
    return found


def legend_size(font: QFont, title: str, legend: Legend) -> tuple[float, float]:
    """Return the width and height that a legend needs, logical pixels."""
    metrics = QFontMetricsF(font)
    line = metrics.height() + 2
    height = line * (1 + len(legend.swatches)) + (14 + line if legend.ramp else 0) + 10
    texts = [s.text if s.plain else word(s.text) for s in legend.swatches]
    widest = max([metrics.horizontalAdvance(t) + 20 for t in texts] + [RAMP if legend.ramp else 0.0])
    return max(widest, metrics.horizontalAdvance(title)) + 16, height


def draw_legend(painter: QPainter, box: QRectF, title: str, legend: Legend, theme: Theme) -> None:
    """Draw a legend into a box: its title, and its colours with what they mean."""
    line = QFontMetricsF(painter.font()).height() + 2
    x, y, wide = box.x() + 8, box.y() + 5, box.width() - 16
    painter.setPen(theme.quiet)
    painter.drawText(QRectF(x, y, wide, line), Qt.AlignmentFlag.AlignVCenter, title)
    y += line
    if legend.ramp:
        shade = QLinearGradient(x, 0, x + wide, 0)
        for k, colour in enumerate(legend.ramp):
            shade.setColorAt(k / (len(legend.ramp) - 1), QColor(colour))
        painter.fillRect(QRectF(x, y + 2, wide, 10), shade)
        y += 14
        painter.setPen(theme.text)
        ends = QRectF(x, y, wide, line)
        digits = 2 if legend.high - legend.low < 10 else 1
        painter.drawText(ends, Qt.AlignmentFlag.AlignLeft, f"{legend.low:.{digits}f}".replace("-", "−"))
        last = ("≥ " if legend.beyond else "") + f"{legend.high:.{digits}f} {legend.unit}".replace("-", "−")
        painter.drawText(ends, Qt.AlignmentFlag.AlignRight, last)
    for swatch in legend.swatches:
        painter.fillRect(QRectF(x, y + line / 2 - 5, 12, 10), QColor(swatch.colour))
        painter.setPen(theme.text)
        text = swatch.text if swatch.plain else word(swatch.text)
        painter.drawText(QRectF(x + 20, y, wide - 20, line), Qt.AlignmentFlag.AlignVCenter, text)
        y += line


def legend_title(horizon: str, legend: Legend) -> str:
    """Return the title of a legend: the horizon, the quantity and its unit."""
    title = word(legend.title) + (f", {legend.unit}" if legend.unit else "")
    return f"{shortened(horizon)} · {title}" if horizon else title


def merged(legends: Sequence[tuple[str, Legend]]) -> list[tuple[str, Legend]]:
    """Return titles and legends; kinds of sources, which mean the same for every horizon, stand in one."""
    kinds = {swatch: None for _, legend in legends if legend.title == "kind" for swatch in legend.swatches}
    every = Legend("kind", "", tuple(sorted(kinds, key=lambda swatch: swatch.text)))
    rest = [(legend_title(horizon, legend), legend) for horizon, legend in legends if legend.title != "kind"]
    return [*([(legend_title("", every), every)] if kinds else []), *rest]


def _directions(painter: QPainter, view: Projector, axes: Floats, theme: Theme) -> None:
    """Draw east, north and up as seen from the viewpoint (rows right, up and towards it; columns E, N, Z)."""
    centre = QPointF(view.width - MARGIN - ARM - 12, view.height - MARGIN - ARM - 12)
    order = sorted(range(3), key=lambda k: axes[2, k])
    for k in order:
        tip = QPointF(centre.x() + ARM * axes[0, k], centre.y() - ARM * axes[1, k])
        painter.setPen(QPen(theme.mark if k == 1 else theme.quiet, 2.4 if k == 1 else 1.6))
        painter.drawLine(centre, tip)
        far = QPointF(centre.x() + (ARM + 9) * axes[0, k], centre.y() - (ARM + 9) * axes[1, k])
        if math.hypot(axes[0, k], axes[1, k]) > 0.25:
            painter.setPen(theme.mark if k == 1 else theme.text)
            painter.drawText(QRectF(far.x() - 10, far.y() - 10, 20, 20), Qt.AlignmentFlag.AlignCenter, "ENZ"[k])


def _note_box(font: QFont, view: Projector, content: Content) -> QRectF:
    metrics = QFontMetricsF(font)
    high = metrics.height() + 8
    return QRectF(MARGIN, view.height - MARGIN - high, metrics.horizontalAdvance(content.note) + 16, high)


def _note(painter: QPainter, view: Projector, content: Content, theme: Theme) -> None:
    """Write the exaggeration into the lower left corner, with the scale bar where the picture has one scale."""
    metrics, box = QFontMetricsF(painter.font()), _note_box(painter.font(), view, content)
    _plate(painter, box, theme, 215, theme.quiet)
    painter.setPen(theme.text)
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, content.note)
    if content.metres is not None:
        length = nice(shown_length(BAR * content.metres))
        x, y = box.right() + 16, box.center().y() + 4
        pixels = length * metres_shown() / content.metres
        painter.setPen(QPen(theme.text, 2))
        painter.drawPolyline([QPointF(x, y - 6), QPointF(x, y), QPointF(x + pixels, y), QPointF(x + pixels, y - 6)])
        text = f"{grouped(length)} {length_mark()}"
        painter.drawText(
            QRectF(x, y - 8 - metrics.height(), pixels, metrics.height()), Qt.AlignmentFlag.AlignCenter, text
        )

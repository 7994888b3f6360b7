"""Tabs that stand close together, the one in front marked on a dark ground.

A style of tab bars only, set once they are made: a style of the application that answered for lengths would be called
thousands of times a window, and for widgets that Qt has only begun to make.
"""

from __future__ import annotations

from PySide6.QtCore import QRect
from PySide6.QtGui import QPainter, QPalette
from PySide6.QtWidgets import QProxyStyle, QStyle, QStyleOption, QTabBar, QWidget

__all__ = ["TabStyle", "mark_tab"]

_SOUTH = {QTabBar.Shape.RoundedSouth, QTabBar.Shape.TriangularSouth}
#: Pixels of a tab beyond its name.
_ROOM = 14
#: Pixels of the line at the tab in front.
_MARK = 2


class TabStyle(QProxyStyle):
    """Fusion for the tab bars of a window's docks."""

    def __init__(self) -> None:
        super().__init__("Fusion")

    def pixelMetric(  # noqa: N802
        self, metric: QStyle.PixelMetric, option: QStyleOption | None = None, widget: QWidget | None = None
    ) -> int:
        """Return a length in pixels: tabs stand close enough for every name of a panel to be read."""
        if metric == QStyle.PixelMetric.PM_TabBarTabHSpace:
            return _ROOM
        return super().pixelMetric(metric, option, widget)

    def drawControl(  # noqa: N802
        self, element: QStyle.ControlElement, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        """Draw a tab; on a dark ground mark the one in front."""
        super().drawControl(element, option, painter, widget)
        if option.palette.color(QPalette.ColorRole.Window).lightness() < 128:
            mark_tab(element, option, painter, widget)


def mark_tab(element: QStyle.ControlElement, option: QStyleOption, painter: QPainter, widget: QWidget | None) -> None:
    """Underline the tab in front at its free edge: its ground hardly differs from that of the others."""
    if element != QStyle.ControlElement.CE_TabBarTabShape or not option.state & QStyle.StateFlag.State_Selected:
        return
    south = isinstance(widget, QTabBar) and widget.shape() in _SOUTH
    box = option.rect
    edge = box.bottom() - _MARK if south else box.top()
    painter.fillRect(QRect(box.left() + 2, edge, box.width() - 4, _MARK), option.palette.highlight())

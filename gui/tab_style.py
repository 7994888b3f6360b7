"""Tabs that stand close together, the one in front marked on a dark ground.

Qt requests lengths from the application's style thousands of times per window, also for widgets whose construction is
incomplete. This style is therefore set on finished tab bars only.
"""

from __future__ import annotations

from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QProxyStyle, QStyle, QStyleOption, QWidget

from geofit.gui.dark_style import mark_tab
from geofit.gui.theme import is_dark

__all__ = ["TabStyle"]

#: Pixels of a tab beyond its name.
_ROOM = 14


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
        if is_dark(option.palette):
            mark_tab(element, option, painter, widget)

"""Gathers what is written over the scene, and the widget that draws it there."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QWidget

from geofit.gui.view3d.overlay import Content, Theme, draw_overlay
from geofit.gui.view3d.projector import Projector

__all__ = ["Annotations", "theme_of"]


class Annotations(QWidget):
    """A clear pane over the canvas that lets the mouse through."""

    def __init__(self, parent: QWidget, view: Callable[[], Projector], content: Callable[[Projector], Content]) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.dark = False
        self._view, self._content = view, content

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw everything."""
        painter = QPainter(self)
        self.write(painter)
        painter.end()

    def write(self, painter: QPainter) -> None:
        """Draw everything by a painter whose unit is a logical pixel of the widget."""
        view = self._view()
        draw_overlay(painter, view, self._content(view), theme_of(self.palette(), self.dark), self.font())


def theme_of(palette: QPalette, dark: bool) -> Theme:
    """Return the palette's colours, turned to the other side where it is not as dark as the scene."""
    paper, text = palette.color(QPalette.ColorRole.Base), palette.color(QPalette.ColorRole.Text)
    if (paper.lightnessF() < 0.5) != dark:
        paper, text = (QColor("#1b232b"), QColor("#e4e9ee")) if dark else (QColor("#ffffff"), QColor("#1c2733"))
    quiet = QColor(*(round(0.42 * p + 0.58 * i) for p, i in zip(_bytes(paper), _bytes(text), strict=True)))
    return Theme(text, quiet, paper, QColor("#f2a541") if dark else QColor("#c2410c"))


def _bytes(colour: QColor) -> tuple[int, int, int]:
    return colour.red(), colour.green(), colour.blue()

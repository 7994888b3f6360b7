"""A matplotlib canvas that follows the theme of the window it stands in."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_qtagg import FigureCanvasQTAgg
from matplotlib.figure import Figure
from PySide6.QtCore import QEvent, QSize
from PySide6.QtGui import QColor, QPalette, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from geofit.gui.panels.marks import readable
from geofit.report.style import INK, LINE, MUTED, PAPER, drawing

__all__ = ["Canvas", "Ink", "recolour"]


@dataclass(frozen=True)
class Ink:
    """Colours of a picture in the theme: ground, text, quieter text, lines; ``of`` lightens a fixed one if needed."""

    paper: str
    text: str
    muted: str
    line: str
    palette: QPalette

    def of(self, colour: str) -> str:
        """Return a fixed colour so that it can be read on the paper."""
        return readable(colour, self.palette).name()


class Canvas(FigureCanvasQTAgg):
    """A figure with constrained layout, drawn anew by ``paint`` when the theme or the size class changes.

    Parameters
    ----------
    paint : callable
        Called as ``paint(figure, ink)`` with an empty figure.
    """

    def __init__(self, paint: Callable[[Figure, Ink], None], parent: QWidget | None = None) -> None:
        # matplotlib types neither its canvas for Qt nor what it inherits.
        super().__init__(Figure(layout="constrained"))  # type: ignore[no-untyped-call]
        self.setParent(parent)
        # matplotlib paints every canvas white.
        self.setPalette(QPalette())
        self.setMinimumSize(QSize(200, 140))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._paint = paint
        self._pending = True
        self._was_narrow: bool | None = None

    @property
    def narrow(self) -> bool:
        """Whether two pictures fit better one above the other."""
        width, height = int(self.width()), int(self.height())
        return width < 1.2 * height or width < 480

    def repaint_figure(self) -> None:
        """Draw the figure anew, when it is next seen."""
        self._pending = True
        self.refresh()

    def refresh(self) -> None:
        """Show the figure as it is now, when the canvas is next seen."""
        self.draw_idle()

    def draw_idle(self) -> None:
        """Draw with the next paint event: a dock behind others has none, though Qt calls it visible."""
        self._draw_pending = True
        self.update()

    def draw(self) -> None:
        """Draw; a glyph that no font has and a canvas too small for its axes are no errors."""
        if self._pending:
            self._pending = False
            self._compose()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
            warnings.filterwarnings("ignore", message=r"constrained_layout not applied")
            super().draw()  # type: ignore[no-untyped-call]

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        if event.type() in {QEvent.Type.PaletteChange, QEvent.Type.LanguageChange}:
            self.repaint_figure()
        super().changeEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Compose anew where the pictures should stand otherwise."""
        super().resizeEvent(event)  # type: ignore[no-untyped-call]
        if self._was_narrow != self.narrow:
            self._was_narrow = self.narrow
            self.repaint_figure()

    def _compose(self) -> None:
        ink = self._ink()
        with (
            drawing(),
            mpl.rc_context(
                {
                    "text.color": ink.text,
                    "axes.edgecolor": ink.line,
                    "axes.labelcolor": ink.muted,
                    "axes.facecolor": ink.paper,
                    "axes.titlesize": 9.0,
                    "xtick.color": ink.muted,
                    "ytick.color": ink.muted,
                    "figure.facecolor": ink.paper,
                }
            ),
        ):
            self.figure.clear()
            self.figure.set_facecolor(ink.paper)
            self._paint(self.figure, ink)

    def _ink(self) -> Ink:
        palette = self.palette()
        paper, text = palette.color(QPalette.ColorRole.Base), palette.color(QPalette.ColorRole.Text)
        return Ink(paper.name(), text.name(), _between(paper, text, 0.7), _between(paper, text, 0.25), palette)


def _between(paper: QColor, text: QColor, share: float) -> str:
    a, b = ((c.redF(), c.greenF(), c.blueF()) for c in (paper, text))
    return QColor.fromRgbF(*(x + share * (y - x) for x, y in zip(a, b, strict=True))).name()


def recolour(axes: Axes, ink: Ink) -> None:
    """Give axes that the report has drawn for white paper the theme's colours."""
    from matplotlib.colors import to_hex

    theme = {INK: ink.text, MUTED: ink.muted, LINE: ink.line, PAPER: ink.paper}

    def turned(colour: Any) -> str:
        plain = to_hex(colour)
        return theme.get(plain) or ink.of(plain)

    for line in axes.lines:
        line.set_color(turned(line.get_color()))
    for bar in axes.patches:
        bar.set_edgecolor(ink.paper)
    for spine in axes.spines.values():
        spine.set_edgecolor(ink.line)
    for grid in (*axes.get_xgridlines(), *axes.get_ygridlines()):
        grid.set_color(ink.line)
    legend = axes.get_legend()
    axes.set_title(axes.get_title("left"), loc="left", color=ink.text)
    for text in (*axes.texts, *(legend.get_texts() if legend is not None else ())):
        text.set_color(turned(text.get_color()))

"""A matplotlib canvas that follows the theme of its window."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_qtagg import FigureCanvasQTAgg
from matplotlib.figure import Figure
from PySide6.QtCore import QEvent, QSize
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QSizePolicy, QWidget

from geofit.gui.panels.marks import readable
from geofit.report.style import LINE, MUTED, PAPER, TEXT, drawing

__all__ = ["PlotCanvas", "PlotColours", "place_axes", "recolour", "wrapped"]

#: Logical pixels of a point: a figure has 100 dots an inch.
DOT = 100 / 72


@dataclass(frozen=True)
class PlotColours:
    """Colours of a picture in the theme: ground, text, quieter text, lines; ``of`` lightens a fixed one if needed."""

    paper: str
    text: str
    muted: str
    line: str
    palette: QPalette

    def of(self, colour: str) -> str:
        """Return a fixed colour so that it can be read on the paper."""
        return readable(colour, self.palette).name()


class PlotCanvas(FigureCanvasQTAgg):
    """A figure that keeps its axes from one picture to the next, and lays them out only when something has changed.

    Matplotlib's own layouts measure every text at every drawing, and new axes make every tick anew: both cost more
    than the picture itself.

    Parameters
    ----------
    paint : callable
        Called as ``paint(colours)`` for a new picture; it draws into what :meth:`axes` gives it.
    arrange : callable
        Called as ``arrange(colours)`` after that, and when the size has changed: gives everything its place.
    """

    def __init__(
        self,
        paint: Callable[[PlotColours], None],
        arrange: Callable[[PlotColours], None],
        parent: QWidget | None = None,
    ) -> None:
        # matplotlib types neither its canvas for Qt nor what it inherits.
        super().__init__(Figure())  # type: ignore[no-untyped-call]
        self.setParent(parent)
        # matplotlib paints every canvas white.
        self.setPalette(QPalette())
        self.setMinimumSize(QSize(200, 140))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._paint, self._arrange = paint, arrange
        self._pending = self._afresh = True
        self._arranged: tuple[int, int] | None = None

    @property
    def narrow(self) -> bool:
        """Whether two pictures fit better one above the other."""
        width, height = int(self.width()), int(self.height())
        return width < 1.2 * height or width < 480

    def axes(self, count: int) -> list[Axes]:
        """Return so many axes with nothing in them: those of the picture before, if it had as many."""
        figure = self.figure
        for legend in tuple(figure.legends):
            legend.remove()
        for text in tuple(figure.texts):
            text.remove()
        if self._afresh or len(figure.axes) != count:
            for old in tuple(figure.axes):
                old.remove()
            self._afresh = False
            made = [figure.add_axes((0.1, 0.1, 0.8, 0.8), label=str(k)) for k in range(count)]
            for axes in made:
                # From now on the title stays where rcParams put it, else every drawing looks for ticks above the axes.
                axes.set_title("")
            return made
        for axes in figure.axes:
            _empty(axes)
        return list(figure.axes)

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
        """Draw; a glyph that no font has is not an error."""
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
            size = int(self.width()), int(self.height())
            if self._pending or self._arranged != size:
                self._compose(anew=self._pending)
                self._pending, self._arranged = False, size
            super().draw()  # type: ignore[no-untyped-call]

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        if event.type() in {QEvent.Type.PaletteChange, QEvent.Type.LanguageChange}:
            self._afresh = True
            self.repaint_figure()
        super().changeEvent(event)

    def _compose(self, *, anew: bool) -> None:
        colours = self._colours()
        with (
            drawing(),
            mpl.rc_context(
                {
                    "text.color": colours.text,
                    "axes.edgecolor": colours.line,
                    "axes.labelcolor": colours.muted,
                    "axes.facecolor": colours.paper,
                    "axes.titlesize": 9.0,
                    "axes.titley": 1.0,
                    "xtick.color": colours.muted,
                    "ytick.color": colours.muted,
                    "figure.facecolor": colours.paper,
                }
            ),
        ):
            if anew:
                self.figure.set_facecolor(colours.paper)
                self._paint(colours)
            if self.figure.axes:
                self._arrange(colours)

    def _colours(self) -> PlotColours:
        palette = self.palette()
        paper, text = palette.color(QPalette.ColorRole.Base), palette.color(QPalette.ColorRole.Text)
        return PlotColours(paper.name(), text.name(), _between(paper, text, 0.7), _between(paper, text, 0.25), palette)


def _between(paper: QColor, text: QColor, share: float) -> str:
    a, b = ((c.redF(), c.greenF(), c.blueF()) for c in (paper, text))
    return QColor.fromRgbF(*(x + share * (y - x) for x, y in zip(a, b, strict=True))).name()


def _empty(axes: Axes) -> None:
    """Take everything out of axes; their ticks, which are dear to make, stay."""
    legend = axes.get_legend()
    for artist in (*axes.lines, *axes.patches, *axes.collections, *axes.texts, *([legend] if legend else [])):
        artist.remove()
    axes.set_axis_on()
    axes.relim()
    axes.autoscale(True)


def place_axes(axes: Axes, left: float, top: float, width: float, height: float) -> tuple[float, float]:
    """Give axes with all their texts a rectangle of the canvas, logical pixels from its upper left corner.

    The texts are not measured but counted: a letter is at most so wide, a line so high.

    Returns
    -------
    tuple of float
        Width and height of what is left for the drawing, logical pixels.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    wide, high = (100 * float(inches) for inches in figure.get_size_inches())
    tick = float(mpl.rcParams["xtick.labelsize"])

    def line(size: float | str) -> float:
        return 1.35 * float(size) * DOT

    def inside(labels: float) -> tuple[float, float, float, float]:
        title, below, beside = axes.get_title("left"), axes.get_xlabel(), axes.get_ylabel()
        before = 8 + labels + (line(axes.yaxis.label.get_fontsize()) + 5 if beside else 0)
        above = line(axes.title.get_fontsize()) * (title.count("\n") + 1) + 7 if title else 6
        under = 9 + line(tick) + (line(axes.xaxis.label.get_fontsize()) * (below.count("\n") + 1) + 3 if below else 0)
        return left + before, top + above, max(width - before - 14, 20.0), max(height - above - under - 3, 20.0)

    labels = 30.0
    for _ in range(2):
        x, y, w, h = inside(labels)
        axes.set_position((x / wide, 1 - (y + h) / high, w / wide, h / high))
        texts = axes.yaxis.get_major_formatter().format_ticks(list(axes.yaxis.get_majorticklocs()))
        labels = max((len(text) for text in texts), default=0) * 0.66 * tick * DOT
    # Placed by themselves they would measure every number beside them.
    axes.xaxis.set_label_coords(0.5, -(10 + line(tick)) / h)
    axes.yaxis.set_label_coords(-(11 + labels) / w, 0.5)
    return w, h


def wrapped(text: str, width: float, size: float) -> str:
    r"""Break a text into lines of so many logical pixels, type in points: between words, or Chinese letters.

    Examples
    --------
    >>> wrapped("control error of the fit", 90.0, 9.0)
    'control\nerror of the\nfit'
    """
    lines, used = [""], 0.0
    for part in re.findall(r"[\u2e80-\uffef]|[^\s\u2e80-\uffef]+\s*|\s+", text):
        long = sum(1.0 if letter >= "\u2e80" else 0.57 for letter in part.rstrip()) * size * DOT
        if used and used + long > width:
            lines[-1] = lines[-1].rstrip()
            lines.append("")
            used = 0.0
        lines[-1] += part
        used += long + (len(part) - len(part.rstrip())) * 0.4 * size * DOT
    return "\n".join(lines)


def recolour(axes: Axes, colours: PlotColours) -> None:
    """Give axes that the report has drawn for white paper the theme's colours."""
    from matplotlib.colors import to_hex

    theme = {TEXT: colours.text, MUTED: colours.muted, LINE: colours.line, PAPER: colours.paper}

    def turned(colour: Any) -> str:
        plain = to_hex(colour)
        return theme.get(plain) or colours.of(plain)

    for line in axes.lines:
        line.set_color(turned(line.get_color()))
    for bars in axes.collections:
        bars.set_edgecolor(colours.paper)
    for spine in axes.spines.values():
        spine.set_edgecolor(colours.line)
    for grid in (*axes.get_xgridlines(), *axes.get_ygridlines()):
        grid.set_color(colours.line)
    legend = axes.get_legend()
    axes.set_title(axes.get_title("left"), loc="left", color=colours.text)
    for text in (*axes.texts, *(legend.get_texts() if legend is not None else ())):
        text.set_color(turned(text.get_color()))

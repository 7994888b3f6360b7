"""How the residuals are spread: their histogram within the tolerances, and beside the normal law."""

from __future__ import annotations

from textwrap import fill
from typing import Any, cast

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PySide6.QtWidgets import QVBoxLayout, QWidget

from geofit.gui.panels.canvas import Canvas, Ink, recolour
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.words import spoken
from geofit.report.histogram import histogram, normal_plot
from geofit.report.language import Language
from geofit.report.result import HorizonResult
from geofit.site import Site
from geofit.surface import HorizonSurface
from geofit.words import said

__all__ = ["HistogramPanel"]

#: Width of a letter of the pictures, pixels.
LETTER = 7
#: Height of a line of the legend, as a share of the bars' height.
LINE_SHARE = 0.14


class HistogramPanel(QWidget):
    """Histogram and normal plot of the points that are not met exactly."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        self.canvas = Canvas(self._paint)
        self.canvas.setAccessibleName(self.tr("Histogram and normal plot of the residuals"))
        column.addWidget(self.canvas)
        self.pages = Placeholder(content)
        self.setLayout(self.pages)
        self._result: HorizonResult | None = None
        self.show_surface(None)

    def show_surface(self, surface: HorizonSurface | None) -> None:
        """Show the residuals of a checked surface; None while there is none."""
        if self._result is not None and self._result.surface is surface:
            return
        self._result = None
        if surface is None or surface.accuracy is None:
            self.pages.say(self.tr("No surface yet: press Fit to see how its residuals are spread."))
            return
        result = HorizonResult(surface, Site(surface.name, {}))
        if result.core.all():
            self.pages.say(self.tr("Every point is met exactly: there is no residual to count."))
            return
        self._result = result
        self.pages.reveal()
        self.canvas.repaint_figure()

    def _paint(self, figure: Figure, ink: Ink) -> None:
        if self._result is None:
            return
        left, right = figure.subplots(2, 1) if self.canvas.narrow else figure.subplots(1, 2)
        told = cast(Language, _told)
        histogram(left, self._result, told)
        normal_plot(right, self._result, told)
        for axes in (left, right):
            recolour(axes, ink)
            _fit_texts(axes, ink, self.canvas.width() // (1 if self.canvas.narrow else 2))


def _told(template: str, /, **values: Any) -> str:
    """Say a label of the report in the language of the windows."""
    return spoken(said(template, **values))


def _fit_texts(axes: Axes, ink: Ink, width: int) -> None:
    """Break texts and thin out ticks so that they fit into so many pixels; the legend stands above the bars."""
    letters = max((width - 70) // LETTER, 12)
    axes.set_title(fill(axes.get_title("left"), letters), loc="left", color=ink.text)
    axes.set_xlabel(fill(axes.get_xlabel(), letters))
    axes.xaxis.set_major_locator(MaxNLocator(max(2, min(9, width // 80))))
    legend = axes.get_legend()
    if legend is None:
        return
    handles, labels = axes.get_legend_handles_labels()
    labels = [fill(label, letters) for label in labels]
    lines = sum(label.count("\n") + 1 for label in labels)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + (LINE_SHARE * lines + 0.04) * (high - low))
    axes.legend(
        handles, labels, loc="upper left", fontsize=7.5, borderaxespad=0.2, labelcolor=ink.text, labelspacing=0.3
    )

"""How the residuals are spread: their histogram within the tolerances, and beside the normal law."""

from __future__ import annotations

from typing import Any, cast

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from PySide6.QtWidgets import QVBoxLayout, QWidget

from geofit.data.languages import Language
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.panels.canvas import PlotCanvas, PlotColours, place_axes, recolour, wrapped
from geofit.gui.panels.length_axes import number_lengths
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.translate import user_language
from geofit.report.histogram import histogram, normal_plot
from geofit.report.result import HorizonResult

__all__ = ["HistogramPanel"]

#: Room beside a picture for its scale, logical pixels.
BESIDE = 76
#: Letters of the legend in points, and the height of its lines, logical pixels.
LETTERS, LINE = 7.5, 14.5


class HistogramPanel(QWidget):
    """Histogram and normal plot of the points that are not met exactly."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        self.canvas = PlotCanvas(self._paint, self._arrange)
        self.canvas.setAccessibleName(self.tr("Histogram and normal plot of the residuals"))
        column.addWidget(self.canvas)
        self.pages = Placeholder(content, self)
        self._result: HorizonResult | None = None
        self._texts: list[tuple[str, str, tuple[float, float]]] = []
        self.show_surface(None)

    def show_surface(self, surface: HorizonFit | None) -> None:
        """Show the residuals of a checked surface; None while there is none."""
        if self._result is not None and self._result.surface is surface:
            return
        self._result = None
        if surface is None or surface.accuracy is None:
            self.pages.say(self.tr("No surface yet: press Fit to see how its residuals are spread."))
            return
        result = HorizonResult(surface, Site(surface.name, {}))
        if result.core.all():
            self.pages.say(self.tr("Every point is interpolated exactly: there is no residual to count."))
            return
        self._result = result
        self.pages.reveal()
        self.canvas.repaint_figure()

    def _paint(self, colours: PlotColours) -> None:
        if self._result is None:
            return
        left, right = self.canvas.axes(2)
        language = cast(Language, _translated)
        histogram(left, self._result, language)
        normal_plot(right, self._result, language)
        self._texts = []
        for axes in (left, right):
            recolour(axes, colours)
            number_lengths(axes)
            self._texts.append((axes.get_title("left"), axes.get_xlabel(), axes.get_ylim()))

    def _arrange(self, colours: PlotColours) -> None:
        """Put the pictures beside each other, or one above the other; break texts that are too long for them."""
        width, height = int(self.canvas.width()), int(self.canvas.height())
        narrow = self.canvas.narrow
        wide, high = (width, height / 2) if narrow else (width / 2, height)
        for k, axes in enumerate(self.canvas.figure.axes):
            title, below, limits = self._texts[k]
            axes.set_title(wrapped(title, wide - BESIDE, 10.0), loc="left", color=colours.text)
            axes.set_xlabel(wrapped(below, wide - BESIDE, 9.0))
            axes.xaxis.set_major_locator(MaxNLocator(max(2, min(9, int(wide) // 80))))
            axes.set_ylim(limits)
            corner: tuple[float, float] = (0.0, k * high) if narrow else (k * wide, 0.0)
            inner = place_axes(axes, *corner, wide, high)
            if axes.get_legend() is not None:
                _explain(axes, colours, limits, inner)
                # The scale may have got longer numbers.
                place_axes(axes, *corner, wide, high)


def _translated(template: str, /, **values: Any) -> str:
    """Say a label of the report in the language of the windows."""
    return user_language()(template, **values)


def _explain(axes: Axes, colours: PlotColours, limits: tuple[float, float], inner: tuple[float, float]) -> None:
    """Write the legend above what is drawn, which makes room for it."""
    handles, labels = axes.get_legend_handles_labels()
    labels = [wrapped(label, inner[0] - 44, LETTERS) for label in labels]
    room = LINE * sum(label.count("\n") + 1 for label in labels) + 8
    low, high = limits
    share = room / max(inner[1], room + 10.0)
    axes.set_ylim(low, high + (high - low) * share / (1 - share))
    for line in axes.lines:
        if line.get_transform() == axes.get_xaxis_transform("grid"):
            line.set_ydata([0.0, 1 - share])
    axes.legend(
        handles,
        labels,
        loc="upper left",
        fontsize=LETTERS,
        borderaxespad=0.2,
        labelcolor=colours.text,
        labelspacing=0.3,
        # No line of the grid runs through the words.
        frameon=True,
        framealpha=1.0,
        facecolor=colours.paper,
        edgecolor="none",
    )

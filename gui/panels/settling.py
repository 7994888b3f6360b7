"""How the porosity of a sample settles with its size: the curve, and the representative volume that it shows."""

from __future__ import annotations

from PySide6.QtWidgets import QLabel, QSizePolicy, QVBoxLayout, QWidget

from geofit.gui.panels.canvas import PlotCanvas, PlotColours, place_axes, recolour
from geofit.gui.text_size import sized_by_text
from geofit.gui.translate import user_language
from geofit.project.pore_view import PoreView
from geofit.report.pores_chapter import settling_sentence
from geofit.report.pores_pictures import settling_curve

__all__ = ["SettlingPanel"]


class SettlingPanel(QWidget):
    """The sentence of the report on the representative volume, over its picture."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._view: PoreView | None = None
        self.words, self.canvas = QLabel(), PlotCanvas(self._paint, self._arrange)
        self.words.setWordWrap(True)
        # What its size hint asks for would leave nothing to the 3D view above.
        self.canvas.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)
        self.canvas.setAccessibleName(self.tr("Porosity of cubes by their edge"))
        # A tab does not ask how high its words are at its width: of two lines it would cut the curve.
        sized_by_text(self.words, lambda: self.words.setMinimumHeight(2 * self.words.fontMetrics().lineSpacing()))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 0)
        layout.addWidget(self.words)
        layout.addWidget(self.canvas, 1)

    def show_view(self, view: PoreView) -> None:
        """Show the curve of a volume that has one."""
        assert view.settling is not None
        self._view = view
        self.words.setText(settling_sentence(view.settling, view.porosity, user_language()))
        self.canvas.repaint_figure()

    def _paint(self, colours: PlotColours) -> None:
        if self._view is None or self._view.settling is None:
            return
        (axes,) = self.canvas.axes(1)
        settling_curve(axes, self._view.settling, self._view.porosity, user_language())
        recolour(axes, colours)
        axes.legend(fontsize=7.5, labelcolor=colours.text, facecolor=colours.paper, edgecolor="none", loc="best")

    def _arrange(self, colours: PlotColours) -> None:
        for axes in self.canvas.figure.axes:
            place_axes(axes, 0.0, 0.0, self.canvas.width(), self.canvas.height())

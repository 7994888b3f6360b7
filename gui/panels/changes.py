"""What moved since the data changed: a map of the difference, and the new holes against the band before them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from matplotlib.ticker import MaxNLocator
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QSplitter, QVBoxLayout, QWidget

from geofit.data.languages import Language
from geofit.data.messages import Message
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.canvas import PlotCanvas, PlotColours, place_axes, recolour
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import translated, user_language
from geofit.project.data_change import Arrivals
from geofit.report.change_map import change_map
from geofit.site.states import Comparison

__all__ = ["ChangesPanel"]

#: Room at the right of the map for its colours and its legend, logical pixels.
BESIDE = 168
#: Losses that are listed one by one.
MOST_LOST = 6


class ChangesPanel(QWidget):
    """How the chosen horizon moved between the earlier data and the present ones.

    ``place_chosen(x, y, z)`` carries the new contact whose row was chosen; ``compare_requested(horizon)`` and
    ``add_requested()`` the buttons.
    """

    place_chosen = Signal(float, float, float)
    compare_requested = Signal(str)
    add_requested = Signal()
    fit_requested = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._name = ""
        self._comparison: Comparison | None = None
        self.figures, self.verdict, self.came = QLabel(), QLabel(), QLabel()
        for label in (self.figures, self.verdict, self.came):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.canvas = PlotCanvas(self._paint, self._arrange)
        self.canvas.setAccessibleName(self.tr("Map of the difference between the two states"))
        self.table = DataTable()
        self.table.setAccessibleName(self.tr("New contacts, and what was predicted before they were known"))
        side = QWidget()
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        for widget in (self.figures, self.verdict, self.came):
            column.addWidget(widget)
        column.addWidget(self.table, 1)
        self.parts = QSplitter(Qt.Orientation.Horizontal)
        self.parts.addWidget(self.canvas)
        self.parts.addWidget(side)
        self.parts.setChildrenCollapsible(False)
        self.parts.setSizes([500, 460])
        content = QWidget()
        inner = QVBoxLayout(content)
        inner.setContentsMargins(8, 8, 8, 8)
        inner.addWidget(self.parts)
        self.pages = Placeholder(content, self)
        self.pages.button.clicked.connect(self._press)
        self.table.chosen.connect(self._tell_place)
        self._button = self.add_requested.emit
        self.show_nothing()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the table below the map where the panel is higher than wide."""
        super().resizeEvent(event)
        high = self.height() > self.width()
        self.parts.setOrientation(Qt.Orientation.Vertical if high else Qt.Orientation.Horizontal)

    def show_nothing(self, lost: Sequence[Message] = ()) -> None:
        """Say that the horizon's data have not changed, or that no earlier surface is known; and what was ``lost``."""
        self._name, self._comparison = "", None
        words = self.tr("The data of this horizon have not changed: there is nothing to compare.")
        if lost:
            words = self.tr("The data have changed; no earlier surface of this horizon is available for comparison.")
        self._say(self._with_lost(words, lost), self.tr("Add data…"), self.add_requested.emit)

    def show_state(
        self, name: str, came: Arrivals, lost: Sequence[Message], comparison: Comparison | None, *, waiting: bool
    ) -> None:
        """Show what moved; before the horizon was fitted again, what came.

        Parameters
        ----------
        name : str
            The horizon.
        came : Arrivals
            Points that came, were corrected, went.
        lost : sequence of Message
            What of the work did not survive.
        comparison : Comparison or None
            None while it is not known.
        waiting : bool
            Whether a fit of the present data is wanted first.
        """
        self._name = name
        words = translated(came.text)
        if comparison is None:
            self._comparison = None
            if waiting:
                said = words + "\n" + self.tr("Fit the horizon to see what moved.")
                self._say(self._with_lost(said, lost), self.tr("Fit"), lambda: self.fit_requested.emit(name))
            else:
                said = words + "\n" + self.tr("The states are being compared.")
                self._say(self._with_lost(said, lost), self.tr("Compare"), lambda: self.compare_requested.emit(name))
            return
        self.figures.setText(in_lengths(translated(comparison.change.text)))
        verdict = translated(comparison.test.text)
        self.verdict.setText(in_lengths(verdict))
        font = self.verdict.font()
        font.setBold(True)
        self.verdict.setFont(font)
        self.came.setText(self._with_lost(words, lost))
        if comparison is not self._comparison:
            self._comparison = comparison
            self.table.show_columns(self._columns(comparison))
            self.canvas.repaint_figure()
        self.pages.reveal()

    def _with_lost(self, words: str, lost: Sequence[Message]) -> str:
        listed = [translated(one) for one in lost[:MOST_LOST]]
        if len(lost) > MOST_LOST:
            listed.append(self.tr("{n} more: see the log.").format(n=len(lost) - MOST_LOST))
        return "\n".join([words, *listed])

    def _say(self, words: str, button: str, press: Any) -> None:
        self._button = press
        self.pages.say(words, button)

    def _press(self) -> None:
        self._button()

    def _columns(self, comparison: Comparison) -> list[TableColumn]:
        contacts = comparison.test.contacts
        words = {True: self.tr("inside"), False: self.tr("OUTSIDE"), None: "–"}

        def numbers(name: str) -> np.ndarray[Any, Any]:
            return np.array([getattr(one, name) for one in contacts], float)

        rank = np.array([{False: 0, True: 1, None: 2}[one.inside] for one in contacts], float)
        return [
            TableColumn(self.tr("Hole"), np.array([one.group for one in contacts], np.str_)),
            TableColumn(self.tr("Observed, m"), numbers("z"), 2),
            TableColumn(
                self.tr("Predicted, m"), numbers("predicted"), 2, self.tr("Elevation of the earlier surface there")
            ),
            TableColumn(
                self.tr("90 % ±, m"),
                (numbers("high") - numbers("low")) / 2,
                2,
                self.tr("Half the width of the earlier 90 % band there"),
            ),
            TableColumn(self.tr("Residual, m"), numbers("residual"), 2, self.tr("Observed minus predicted")),
            TableColumn(self.tr("In the band"), np.array([words[one.inside] for one in contacts], np.str_), order=rank),
        ]

    def _tell_place(self, index: int) -> None:
        if self._comparison is not None:
            one = self._comparison.test.contacts[index]
            self.place_chosen.emit(one.x, one.y, one.z)

    def _paint(self, colours: PlotColours) -> None:
        if self._comparison is None:
            return
        (axes,) = self.canvas.axes(1)
        for image in tuple(axes.images):
            image.remove()
        change_map(axes, self._comparison, cast(Language, _translated), colours.line)
        # The panel has a title, and the status bar coordinates: the map gets the room.
        axes.set_title("", loc="left")
        axes.set_xlabel("")
        axes.set_ylabel("")
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.tick_params(labelsize=7.5)
        recolour(axes, colours)
        legend = axes.get_legend()
        for text in () if legend is None else legend.get_texts():
            text.set_fontsize(7.5)
            text.set_color(colours.text)

    def _arrange(self, colours: PlotColours) -> None:
        width, height = int(self.canvas.width()), int(self.canvas.height())
        for axes in self.canvas.figure.axes:
            # A map keeps its shape, and stands in the upper left corner of its room.
            wide = max(width - BESIDE, 120)
            shape = np.ptp(axes.get_ylim()) / max(np.ptp(axes.get_xlim()), 1e-9)
            place_axes(axes, 0.0, 0.0, min(wide, (height - 30) / shape + 60), min(height, wide * shape + 30))


def _translated(template: str, /, **values: Any) -> str:
    """Say a label of the report in the language of the windows."""
    return user_language()(template, **values)

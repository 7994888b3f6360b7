"""Measured dips: a stereonet, and a table of what the surface does where each was measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np
from matplotlib.backend_bases import MouseEvent
from numpy.typing import NDArray
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QIcon, QResizeEvent
from PySide6.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QSplitter, QVBoxLayout, QWidget

from geofit.geometry.attitudes import poles
from geofit.gui.panels.canvas import PlotCanvas, PlotColours, recolour
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import translated, user_language
from geofit.project.dip_table import DipTable
from geofit.report.stereonet import StereonetContent, stereonet
from geofit.site.dips import LIMIT

__all__ = ["StereonetPanel"]

#: How near to a pole a click must be, logical pixels.
REACH = 12.0
#: Colour of measurements that name no horizon.
PLAIN = "#6b6b6b"


class StereonetPanel(QWidget):
    """The dips that were measured on the chosen horizon, or all of them.

    ``dip_chosen(index)`` carries the number of a measurement among all of the site; ``add_requested()`` is the wish to
    add a file of them.
    """

    dip_chosen = Signal(int)
    add_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._tables: Mapping[bool, DipTable] = {}
        self._colours: Mapping[str, str] = {}
        self._chosen: int | None = None
        self.which = QComboBox()
        self.which.setAccessibleName(self.tr("Which dips"))
        self.traces = QCheckBox(self.tr("Traces"))
        self.traces.setToolTip(self.tr("Draw the trace of each plane as well as its pole"))
        self.words = QLabel()
        self.words.setWordWrap(True)
        self.words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.canvas = PlotCanvas(self._paint, self._arrange)
        self.canvas.setAccessibleName(self.tr("Stereonet of the measured dips"))
        self.table = DataTable()
        self.table.setAccessibleName(self.tr("Measured dips, and the surface at the same places"))
        self.parts = QSplitter(Qt.Orientation.Horizontal)
        self.parts.addWidget(self.canvas)
        self.parts.addWidget(self.table)
        self.parts.setChildrenCollapsible(False)
        self.parts.setSizes([360, 600])
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        head = QHBoxLayout()
        head.addWidget(self.which)
        head.addWidget(self.traces)
        head.addWidget(self.words, 1)
        column.addLayout(head)
        column.addWidget(self.parts, 1)
        self.pages = Placeholder(content, self)
        self.pages.button.clicked.connect(self.add_requested)
        self.which.activated.connect(self._renew)
        self.traces.toggled.connect(self.canvas.repaint_figure)
        self.table.chosen.connect(self._choose_row)
        # matplotlib's types know no events by their names.
        cast(Any, self.canvas).mpl_connect("button_press_event", self._press)
        self.show_dips("", {}, {})

    def show_dips(self, name: str, tables: Mapping[bool, DipTable], colours: Mapping[str, str]) -> None:
        """Show the dips of a horizon and those of the site.

        Parameters
        ----------
        name : str
            The chosen horizon; empty where none is.
        tables : mapping of bool to DipTable
            False: of the horizon; True: all. Empty where the site has none.
        colours : mapping of str to str
            Colour of each horizon.
        """
        every = self.which.currentIndex() == 1
        self._tables, self._colours = tables, colours
        if not tables:
            self._chosen = None
            self.pages.say(
                self.tr("No dips were measured at this site. Add a table with dip, dip direction and a place."),
                self.tr("Add data…"),
            )
            return
        self.which.clear()
        self.which.addItem(self.tr("Dips of {name}").format(name=name) if name else self.tr("Dips of the horizon"))
        self.which.addItem(self.tr("All dips"))
        self.which.setCurrentIndex(1 if every or not name or not len(tables[False]) else 0)
        self._renew()
        self.pages.reveal()

    @property
    def shown(self) -> DipTable | None:
        """The measurements that are shown; None where the site has none."""
        return self._tables.get(self.which.currentIndex() == 1)

    @property
    def chosen(self) -> int | None:
        """The chosen measurement, as a number among all of the site."""
        return self._chosen

    def choose(self, index: int | None) -> None:
        """Choose a measurement; nothing is emitted. All dips are shown where it is not of the horizon."""
        self._chosen = index
        table = self.shown
        if table is None:
            return
        if index is not None and index not in table.index:
            self.which.setCurrentIndex(1)
            self._renew()
            return
        self._mark()

    def place_of(self, index: int) -> tuple[float, float]:
        """Return where a measurement's pole is drawn, logical pixels of the canvas from its upper left corner."""
        table = self.shown
        assert table is not None
        k = int(np.flatnonzero(table.index == index)[0])
        axes = self.canvas.figure.axes[0]
        at = axes.transData.transform(poles(table.azimuth[k : k + 1], table.dip[k : k + 1])[0])
        ratio = float(self.canvas.device_pixel_ratio)
        return float(at[0]) / ratio, float(self.canvas.height()) - float(at[1]) / ratio

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the table below the net where the panel is higher than wide."""
        super().resizeEvent(event)
        high = self.height() > self.width()
        self.parts.setOrientation(Qt.Orientation.Vertical if high else Qt.Orientation.Horizontal)

    def _renew(self) -> None:
        table = self.shown
        if table is None:
            return
        words = translated(table.text)
        self.words.setText(words[:1].upper() + words[1:])
        horizon = table.measured.horizon[table.index]
        xyz = table.measured.xyz[table.index]
        angle = table.angle
        mark, about = _mark_of(angle), self.tr("Angle between the measured plane and the surface")
        self.table.show_columns(
            [
                TableColumn(self.tr("Azimuth, °"), table.azimuth, 0),
                TableColumn(self.tr("Dip, °"), table.dip, 0),
                TableColumn(self.tr("Angle, °"), angle, 1, about, mark),
                TableColumn(self.tr("Surface azimuth, °"), table.surface_azimuth, 0),
                TableColumn(self.tr("Surface dip, °"), table.surface_dip, 0),
                TableColumn(self.tr("Horizon"), horizon),
                TableColumn(self.tr("Easting, m"), xyz[:, 0], 1, coordinate=True),
                TableColumn(self.tr("Northing, m"), xyz[:, 1], 1, coordinate=True),
                TableColumn(self.tr("Elevation, m"), xyz[:, 2], 1),
            ]
        )
        self._mark()

    def _mark(self) -> None:
        table = self.shown
        mine = [] if table is None or self._chosen is None else np.flatnonzero(table.index == self._chosen).tolist()
        self.table.choose(mine[0] if mine else None)
        self.canvas.repaint_figure()

    def _choose_row(self, row: int) -> None:
        table = self.shown
        if table is not None and 0 <= row < len(table):
            self._chosen = int(table.index[row])
            self.canvas.repaint_figure()
            self.dip_chosen.emit(self._chosen)

    def _press(self, event: MouseEvent) -> None:
        table = self.shown
        if table is None or not len(table) or event.x is None or event.y is None:
            return
        places = self.canvas.figure.axes[0].transData.transform(poles(table.azimuth, table.dip))
        away = np.hypot(*(places - (event.x, event.y)).T) / float(self.canvas.device_pixel_ratio)
        nearest = int(away.argmin())
        if away[nearest] <= REACH:
            self._chosen = int(table.index[nearest])
            self._mark()
            self.dip_chosen.emit(self._chosen)

    def _paint(self, colours: PlotColours) -> None:
        table = self.shown
        if table is None:
            return
        (axes,) = self.canvas.axes(1)
        names = table.measured.horizon[table.index].tolist()
        chosen = np.flatnonzero(table.index == (-1 if self._chosen is None else self._chosen))
        net = StereonetContent(
            table.azimuth,
            table.dip,
            [self._colours.get(name, PLAIN) for name in names],
            (table.surface_azimuth, table.surface_dip),
            int(chosen[0]) if len(chosen) else None,
            self.traces.isChecked(),
        )
        stereonet(axes, net, user_language())
        recolour(axes, colours)

    def _arrange(self, colours: PlotColours) -> None:
        self.canvas.figure.axes[0].set_position((0.01, 0.01, 0.98, 0.98))


def _mark_of(angle: NDArray[np.float64]) -> Callable[[int], QIcon | None]:
    """Return the mark of a row: a failed one beyond the limit of the check."""
    return lambda i: icon("failed") if angle[i] > LIMIT else None

"""A rock volume slice by slice, and the histogram of its values with the range that counts as pore."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSlider, QVBoxLayout, QWidget

from geofit.gui.panels.canvas import PlotCanvas, PlotColours, place_axes, recolour
from geofit.gui.panels.slice_picture import SlicePicture
from geofit.project.pore_view import GreyVolume

__all__ = ["VolumeSlices"]

PORE = "#1f77b4"
#: A slice is shown with at most this many voxels a side: a screen has no more.
MOST = 1200


class VolumeSlices(QWidget):
    """A slice across an axis with its pore voxels coloured, over the histogram; ``moved()`` when the slice changes."""

    moved = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.volume: GreyVolume | None = None
        self.range: tuple[float, float] | None = None
        self.axis, self.slider, self.place = QComboBox(), QSlider(Qt.Orientation.Horizontal), QLabel()
        self.axis.addItems([self.tr("across axis {number}").format(number=number) for number in range(3)])
        self.axis.setAccessibleName(self.tr("Axis across the slices"))
        self.slider.setAccessibleName(self.tr("Slice"))
        self.picture, self.canvas = SlicePicture(), PlotCanvas(self._paint, self._arrange)
        self.picture.setAccessibleName(self.tr("Slice of the volume"))
        self.canvas.setAccessibleName(self.tr("Histogram of the values of its voxels"))
        row = QHBoxLayout()
        row.addWidget(self.axis)
        row.addWidget(self.slider, 1)
        row.addWidget(self.place)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.picture, 3)
        layout.addWidget(self.canvas, 1)
        layout.addLayout(row)
        self.axis.currentIndexChanged.connect(self._turn)
        self.slider.valueChanged.connect(self._move)
        self.setEnabled(False)

    def show_volume(self, volume: GreyVolume) -> None:
        """Show another volume, at its middle slice."""
        self.volume = volume
        self.setEnabled(True)
        self._turn()
        self.canvas.repaint_figure()

    def show_range(self, low: float, high: float) -> None:
        """Colour the voxels whose values are between these, both included."""
        self.range = low, high
        self._draw_slice()
        self.canvas.repaint_figure()

    def slice(self) -> NDArray[Any]:
        """Return the values of the slice that is shown."""
        assert self.volume is not None
        return np.asarray(self.volume.values.take(self.slider.value(), axis=self.axis.currentIndex()))

    def _turn(self) -> None:
        if self.volume is None:
            return
        count = self.volume.values.shape[self.axis.currentIndex()]
        with QSignalBlocker(self.slider):  # the slice is drawn once, below
            self.slider.setRange(0, count - 1)
            self.slider.setValue(count // 2)
        self._move()

    def _move(self) -> None:
        self.place.setText(f"{self.slider.value()} / {self.slider.maximum()}")
        self._draw_slice()
        self.moved.emit()

    def _draw_slice(self) -> None:
        if self.volume is None:
            return
        values, edges = self.slice(), self.volume.edges
        step = max(-(-max(values.shape) // MOST), 1)
        self.picture.show_slice(values[::step, ::step], (float(edges[0]), float(edges[-1])), self.range)

    def _paint(self, colours: PlotColours) -> None:
        if self.volume is None:
            return
        (histogram,) = self.canvas.axes(1)
        counts, edges = self.volume.counts, self.volume.edges
        middle = 0.5 * (edges[1:] + edges[:-1])
        inside = np.zeros(len(middle), bool)
        if self.range is not None:
            inside = (middle >= self.range[0]) & (middle <= self.range[1])
        percent = counts / counts.sum() * 100
        # Two outlines, not hundreds of bars: these take longer to make than all else.
        for which, colour in ((~inside, colours.muted), (inside, colours.of(PORE))):
            histogram.stairs(np.where(which, percent, 0.0), edges, fill=True, color=colour, linewidth=0)
        beside = 0.01 * (edges[-1] - edges[0])
        histogram.set_xlim(edges[0] - beside, edges[-1] + beside)
        histogram.set_ylim(0, 1.05 * percent.max())
        histogram.set_ylabel(self.tr("voxels, %"))
        histogram.set_xlabel(self.tr("value of a voxel"))
        recolour(histogram, colours)

    def _arrange(self, colours: PlotColours) -> None:
        for histogram in self.canvas.figure.axes:
            place_axes(histogram, 0.0, 0.0, self.canvas.width(), self.canvas.height())

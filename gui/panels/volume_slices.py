"""A rock volume slice by slice, and the histogram of its values with the range that counts as pore."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSlider, QVBoxLayout, QWidget

from geofit.gui.panels.canvas import PlotCanvas, PlotColours, recolour
from geofit.project.pore_view import GreyVolume

__all__ = ["VolumeSlices"]

PORE = "#1f77b4"
#: A slice is shown with so many voxels a side at most: more than a screen has no use for.
MOST = 600


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
        self.canvas = PlotCanvas(self._paint, self._arrange)
        self.canvas.setAccessibleName(self.tr("Slice of the volume and histogram of its values"))
        row = QHBoxLayout()
        row.addWidget(self.axis)
        row.addWidget(self.slider, 1)
        row.addWidget(self.place)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
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

    def show_range(self, low: float, high: float) -> None:
        """Colour the voxels whose values are between these, both included."""
        self.range = low, high
        self.canvas.repaint_figure()

    def slice(self) -> NDArray[Any]:
        """Return the values of the slice that is shown."""
        assert self.volume is not None
        return np.asarray(self.volume.values.take(self.slider.value(), axis=self.axis.currentIndex()))

    def _turn(self) -> None:
        if self.volume is None:
            return
        count = self.volume.values.shape[self.axis.currentIndex()]
        self.slider.setRange(0, count - 1)
        self.slider.setValue(count // 2)
        self._move()

    def _move(self) -> None:
        self.place.setText(f"{self.slider.value()} / {self.slider.maximum()}")
        self.canvas.repaint_figure()
        self.moved.emit()

    def _paint(self, colours: PlotColours) -> None:
        if self.volume is None:
            return
        picture, histogram = self.canvas.axes(2)
        values = self.slice()
        step = max(-(-max(values.shape) // MOST), 1)
        values = values[::step, ::step]
        edges = self.volume.edges
        picture.imshow(values, cmap="gray", vmin=edges[0], vmax=edges[-1], interpolation="nearest", aspect="equal")
        if self.range is not None:
            pore = (values >= self.range[0]) & (values <= self.range[1])
            over = np.zeros((*pore.shape, 4))
            over[pore] = (0.12, 0.47, 0.71, 0.65)
            picture.imshow(over, interpolation="nearest", aspect="equal")
        picture.set_xticks([])
        picture.set_yticks([])
        counts = self.volume.counts
        middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        inside = np.zeros(len(middle), bool) if self.range is None else self._within(middle)
        shades = np.where(inside, colours.of(PORE), colours.muted)
        histogram.bar(middle, counts / counts.sum() * 100, 0.9 * width, color=shades.tolist())
        histogram.set_ylabel(self.tr("voxels, %"))
        histogram.set_xlabel(self.tr("value of a voxel"))
        for axes in (picture, histogram):
            recolour(axes, colours)

    def _within(self, middle: NDArray[np.float64]) -> NDArray[np.bool_]:
        assert self.range is not None
        return (middle >= self.range[0]) & (middle <= self.range[1])

    def _arrange(self, colours: PlotColours) -> None:
        if len(self.canvas.figure.axes) == 2:
            picture, histogram = self.canvas.figure.axes
            picture.set_position((0.02, 0.36, 0.96, 0.62))
            histogram.set_position((0.14, 0.12, 0.82, 0.2))

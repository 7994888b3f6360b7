"""A rock volume: slices with threshold and histogram, then its pores in space and their figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.panels.volume_slices import VolumeSlices
from geofit.gui.translate import translated
from geofit.gui.view3d.pore_scene import PoreScene
from geofit.project.pore_view import GreyVolume, PoreView, pore_view, read_grey

__all__ = ["RockVolumeDialog"]

#: Micrometres in a metre.
MICRO = 1e6
#: No value of a voxel: which values are pore is never guessed.
UNSTATED = -1e12


class RockVolumeDialog(SceneDialog):
    """Opens a volume, asks which values are pore and how large a voxel is, and shows network and surface.

    ``volume`` and ``view`` hold what was opened and made last.
    """

    scene: PoreScene

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Rock volume"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self.volume: GreyVolume | None = None
        self.view: PoreView | None = None
        self.slices, self.scene, self.table = VolumeSlices(), PoreScene(), DataTable()
        self.table.setAccessibleName(self.tr("Figures of the pore space"))
        self.open_button = QPushButton(self.tr("&Open a volume…"))
        self.low, self.high, self.edge = QDoubleSpinBox(), QDoubleSpinBox(), QDoubleSpinBox()
        for box in (self.low, self.high):
            box.setRange(UNSTATED, 1e12)
            box.setDecimals(1)
            box.setSpecialValueText(self.tr("not stated"))
        self.edge.setRange(0.0, 1e9)
        self.edge.setDecimals(3)
        self.edge.setSuffix(" µm")
        self.edge.setSpecialValueText(self.tr("not stated"))
        self.porosity = QLabel()
        self.colour = QComboBox()
        self.colour.addItem(self.tr("by radius"), "radius")
        self.colour.addItem(self.tr("by connection"), "connection")
        self.colour.setAccessibleName(self.tr("Colours"))
        self.network, self.surface = QCheckBox(self.tr("&Network")), QCheckBox(self.tr("Surfa&ce"))
        self.key = QLabel()
        self.key.setTextFormat(Qt.TextFormat.RichText)
        self.go.setText(self.tr("&Find pores"))
        self.fields = (self.open_button, self.low, self.high, self.edge)
        self._lay_out()
        self.open_button.clicked.connect(self._ask)
        self.go.clicked.connect(self._find)
        for box in (self.low, self.high, self.edge):
            box.valueChanged.connect(self._changed)
        self.colour.currentIndexChanged.connect(self._recolour)
        for box_, part in ((self.network, "network"), (self.surface, "surface")):
            box_.setChecked(True)
            box_.toggled.connect(lambda on, part=part: self.scene.set_visible(part, on))
        self.refresh()

    def read(self, path: Path) -> None:
        """Read a volume and show its middle slice."""
        self.say("")
        self.begin(
            read_grey, path, on_done=self._opened, on_stopped=lambda: self.say(self.tr("Stopped.")), in_process=False
        )

    def refresh(self) -> None:
        """Enable what can be done: pores can be found once a volume is open and its voxel is stated."""
        super().refresh()
        low, high = self.low.value(), self.high.value()
        ready = self.volume is not None and self.edge.value() > 0 and UNSTATED < low <= high
        self.go.setEnabled(ready and not self.running)
        for widget in (self.colour, self.network):
            widget.setEnabled(self.view is not None)
        self.surface.setEnabled(self.view is not None and len(self.view.triangles) > 0)

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.addRow(self.tr("Pore values from"), self.low)
        form.addRow(self.tr("to"), self.high)
        form.addRow(self.tr("Edge of a voxel"), self.edge)
        form.addRow(self.tr("Porosity"), self.porosity)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.open_button, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.slices, 1)
        column.addLayout(form)
        colours = QHBoxLayout()
        for widget in (self.network, self.surface, self.colour, self.key):
            colours.addWidget(widget)
        colours.addStretch(1)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene, 3)
        column.addLayout(colours)
        column.addWidget(self.table, 1)
        parts = QSplitter(Qt.Orientation.Horizontal)
        parts.addWidget(left)
        parts.addWidget(right)
        parts.setStretchFactor(0, 2)
        parts.setStretchFactor(1, 3)
        parts.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.addWidget(parts, 1)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot())
        self.resize(1180, 760)

    def _ask(self) -> None:
        kinds = "*.tif *.tiff *.raw *.bin *.dat *.npy *.npz *.mhd *.mha *.gz *.zip"
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Open a volume"), "", self.tr("Rock volumes ({kinds})").format(kinds=kinds)
        )
        if path:
            self.read(Path(path))

    def _opened(self, volume: GreyVolume) -> None:
        self.volume, self.view = volume, None
        self.setWindowTitle(self.tr("Rock volume {name}").format(name=volume.name))
        # A threshold is a proposal that the picture shows; of labels none is likelier than another.
        grey = volume.threshold is not None
        stated = (
            (self.low, float(np.floor(volume.edges[0])) if grey else UNSTATED),
            (self.high, float(volume.threshold) if volume.threshold is not None else UNSTATED),
            (self.edge, volume.voxel[0] * MICRO if volume.voxel else 0.0),
        )
        for box, value in stated:
            with QSignalBlocker(box):  # they are shown together, below
                box.setValue(value)
        self.slices.show_volume(volume)
        self._changed()
        self.say(
            self.tr("The threshold is Otsu's. Check it, and state the edge of a voxel.")
            if grey
            else self.tr("State which values are pore, and the edge of a voxel.")
        )

    def _changed(self) -> None:
        if self.volume is not None:
            low, high = self.low.value(), self.high.value()
            self.slices.show_range(low, high)
            stated = UNSTATED < low <= high
            self.porosity.setText(f"{100 * self.volume.share(low, high):.2f} %" if stated else "–")
        self.refresh()

    def _find(self) -> None:
        assert self.volume is not None
        stated, edge = self.volume.voxel, self.edge.value() / MICRO
        voxel = tuple(edge * e / stated[0] for e in stated) if stated else (edge,) * 3
        self.say("")
        self.begin(
            pore_view,
            self.volume.values if self.volume.file is None else self.volume.file,
            self.low.value(),
            self.high.value(),
            voxel,
            on_done=self._found,
            on_stopped=lambda: self.say(self.tr("Stopped. Nothing has changed.")),
        )

    def _found(self, view: PoreView) -> None:
        self.view = view
        self.scene.show_view(view)
        self._recolour()
        names, values = zip(*self._figures(view), strict=True)
        self.table.show_columns(
            [TableColumn(self.tr("Figure"), np.array(names)), TableColumn(self.tr("Value"), np.array(values))]
        )
        messages = [translated(text) for text in view.permeability.messages]
        if not len(view.triangles):
            messages.append(self.tr("The volume is too large for a surface; cut out a part of it to see one."))
        self.say(
            "\n".join(messages) or self.tr("The pore space connects all faces."), "stale" if messages else "passed"
        )
        self.refresh()

    def _figures(self, view: PoreView) -> list[tuple[str, str]]:
        network, unit = view.network, view.network.unit * MICRO
        pores, throats = network.pores, network.throats
        mean = [f"{values.mean() * unit:.2f}" if len(values) else "–" for values in (pores.radius, throats.radius)]
        rows = [
            (self.tr("pores, throats"), f"{len(pores)}, {len(throats)}"),
            (self.tr("pores without a path to a face, left out"), str(len(network.dropped))),
            (self.tr("mean coordination"), f"{network.coordination.mean():.2f}" if len(pores) else "–"),
            (self.tr("mean radius of pores, throats, µm"), ", ".join(mean)),
            (self.tr("porosity, connected porosity, %"), f"{100 * view.porosity:.2f}, {100 * view.connected:.2f}"),
        ]
        for axis in range(3):
            title = self.tr("permeability along axis {axis}, mD").format(axis=axis)
            rows.append((title, f"{view.permeability.millidarcy[axis]:.4g}"))
        return rows

    def _recolour(self) -> None:
        self.scene.set_colour(self.colour.currentData())
        if self.view is None:
            return
        if self.scene.colour == "radius":
            unit = self.view.network.unit * MICRO
            low, high = (limit * unit for limit in self.scene.limits)
            text = self.tr("radius {low:.2f} µm (dark) to {high:.2f} µm (bright)").format(low=low, high=high)
        else:
            from geofit.gui.view3d.pore_scene import CONNECTED

            words = [self.tr("no axis"), self.tr("one"), self.tr("two"), self.tr("all three axes")]
            marks = [f'<span style="color:{c}">■</span> {word}' for c, word in zip(CONNECTED, words, strict=True)]
            text = self.tr("percolates along") + " " + " ".join(marks)
        self.key.setText(text)

"""A rock volume: slices with threshold and histogram, then its pores in space and their figures."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDoubleSpinBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message, some_of
from geofit.gui.dialogs.raw_volume import RawVolumeDialog, type_names
from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.panels.fit_panel import Banner
from geofit.gui.panels.settling import SettlingPanel
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.panels.volume_slices import VolumeSlices
from geofit.gui.save_file import may_replace
from geofit.gui.translate import translated, user_language
from geofit.gui.view3d.pore_scene import PoreScene
from geofit.io.volumes import RAW, TIFF
from geofit.project.pore_files import PoreFiles, pore_files, write_pore_files
from geofit.project.pore_view import GreyVolume, PoreView, is_large, pore_view, read_grey

__all__ = ["RockVolumeDialog"]

#: Micrometres in a metre.
MICRO = 1e6
#: No value of a voxel: which values are pore is never guessed.
UNSTATED = -1e12
#: Files that are named of those that were written; of more the number is given.
NAMED = 3
#: Errors of raw files whose remedy is a shape and a type.
SHAPELESS = ("io.raw-without-shape", "io.raw-size-differs", "io.shape-not-volume")


class PoreValue(QDoubleSpinBox):
    """A limit of the pore values, as fine as the values of a volume; its first step leads from none to ``first``."""

    def __init__(self) -> None:
        super().__init__()
        self.first = 0.0
        self.setRange(UNSTATED, -UNSTATED)
        self.setDecimals(0)
        self.setSpecialValueText(self.tr("not stated"))

    def fit(self, volume: GreyVolume) -> None:
        """Take decimals and steps from the range of a volume's values: whole numbers have none between them."""
        whole = volume.values.dtype.kind in "ui"
        power = math.floor(math.log10(volume.edges[-1] - volume.edges[0] or 1.0))
        self.setDecimals(0 if whole else max(4 - power, 0))
        self.setSingleStep(max(10.0 ** (power - 2), 1.0 if whole else 0.0))
        self.first = float(math.ceil(volume.edges[0])) if whole else self.below(volume.edges[0])

    def below(self, value: float) -> float:
        """Return the largest number with the decimals of this field that does not exceed a value."""
        unit = 10.0 ** self.decimals()
        return math.floor(value * unit) / unit

    def stepBy(self, steps: int) -> None:  # noqa: N802
        """Begin at the values of the volume."""
        if self.value() == UNSTATED:
            self.setValue(self.first)
        else:
            super().stepBy(steps)


class RockVolumeDialog(SceneDialog):
    """Opens a volume, asks which values are pore and how large a voxel is, and shows network and surface.

    ``volume`` and ``view`` hold what was opened and made last; ``raw`` asks for the shape of a raw file, if it must.
    """

    scene: PoreScene

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Rock volume"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self.volume: GreyVolume | None = None
        self.view: PoreView | None = None
        self.raw: RawVolumeDialog | None = None
        self._reading: tuple[Path, Sequence[int] | None, str | None] | None = None
        #: The raw file that is open.
        self._raw_file: Path | None = None
        #: Where files go unless somebody chooses otherwise: to the volume.
        self._folder = Path()
        self._made: tuple[float, ...] = ()
        self._verdict = ("", "none")
        self.old = Banner()
        self.slices, self.scene, self.table = VolumeSlices(), PoreScene(), DataTable()
        self.table.setAccessibleName(self.tr("Figures of the pore space"))
        self.settling, self.tabs = SettlingPanel(), QTabWidget()
        self.tabs.addTab(self.table, self.tr("Figures"))
        self.tabs.addTab(self.settling, self.tr("Representative volume"))
        self.open_button = QPushButton(self.tr("&Open a volume…"))
        self.folder_button = QPushButton(self.tr("Open a fo&lder of slices…"))
        self.shape_button, self.assumed = QPushButton(self.tr("S&hape and type…")), QLabel()
        self.assumed.setWordWrap(True)
        for widget in (self.shape_button, self.assumed):
            widget.hide()
        self.low, self.high, self.edge = PoreValue(), PoreValue(), QDoubleSpinBox()
        self.edge.setRange(0.0, 1e9)
        self.edge.setDecimals(3)
        self.edge.setSuffix(" µm")
        self.edge.setSpecialValueText(self.tr("not stated"))
        self.edges, self.porosity = QLabel(), QLabel()
        self.edges.hide()
        self.colour = QComboBox()
        self.colour.addItem(self.tr("by radius"), "radius")
        self.colour.addItem(self.tr("by connection"), "connection")
        self.colour.setAccessibleName(self.tr("Colours"))
        self.network, self.surface = QCheckBox(self.tr("&Network")), QCheckBox(self.tr("Surfa&ce"))
        self.key = QLabel()
        self.key.setTextFormat(Qt.TextFormat.RichText)
        self.go.setText(self.tr("&Find pores"))
        self.export, self.report = QPushButton(self.tr("&Export…")), QPushButton(self.tr("&Report…"))
        self.export.setToolTip(self.tr("Network, surface and figures of the pores, as files"))
        self.fields = (self.open_button, self.folder_button, self.shape_button, self.low, self.high, self.edge)
        self._lay_out()
        self.open_button.clicked.connect(self._ask)
        self.folder_button.clicked.connect(self._ask_folder)
        self.shape_button.clicked.connect(self._change_shape)
        self.go.clicked.connect(self._find)
        self.export.clicked.connect(lambda: self._ask_target(report=False))
        self.report.clicked.connect(lambda: self._ask_target(report=True))
        for box in (self.low, self.high, self.edge):
            box.valueChanged.connect(self._changed)
        self.colour.currentIndexChanged.connect(self._recolour)
        for box_, part in ((self.network, "network"), (self.surface, "surface")):
            box_.setChecked(True)
            box_.toggled.connect(lambda on, part=part: self.scene.set_visible(part, on))
        self._show_settling(None)
        self.refresh()

    def read(self, path: Path, shape: Sequence[int] | None = None, dtype: str | None = None) -> None:
        """Read a volume, if raw of this shape and type, and show its middle slice."""
        self.say("")
        self._reading = path, shape, dtype
        self.begin(
            read_grey,
            path,
            shape,
            dtype,
            on_done=self._opened,
            on_stopped=lambda: self.say(self.tr("Stopped.")),
            in_process=False,
        )

    def tell_failure(self, error: Exception) -> None:
        """Say what went wrong; ask for the shape of a raw file that does not state it."""
        if self._reading is None or not isinstance(error, InputError) or error.code not in SHAPELESS:
            super().tell_failure(error)
            return
        # The reader's remedy is for programs.
        fault = translated(error.fault)
        self.say(fault, "failed")
        path, shape, dtype = self._reading
        differs = error.code == "io.raw-size-differs" and (_is_raw(path) or shape is not None)
        if differs or error.code == "io.raw-without-shape":
            self._ask_shape(fault, path, shape, dtype)

    def refresh(self) -> None:
        """Enable what can be done: pores can be found once a volume is open and its voxel is stated."""
        super().refresh()
        low, high = self.low.value(), self.high.value()
        ready = self.volume is not None and self.edge.value() > 0 and UNSTATED < low <= high
        self.go.setEnabled(ready and not self.running)
        for widget in (self.colour, self.network):
            widget.setEnabled(self.view is not None)
        large = self.volume is not None and is_large(self.volume.values.shape)
        made = self.view is not None and self._stated() == self._made and not self.running
        self.export.setEnabled(made)
        self.report.setEnabled(made and not large)
        self.report.setToolTip(
            self.tr("The volume is too large for a report; cut out a part of it.")
            if large
            else self.tr("Report of the pores as HTML and PDF")
        )
        self.surface.setEnabled(self.view is not None and len(self.view.triangles) > 0)

    def write(self, folder: Path, *, report: bool = False) -> None:
        """Write the files of ``geofit pores`` into a folder, or the report alone, in the windows' language.

        Asks before files are replaced.
        """
        assert self.volume is not None
        name = self.volume.sample
        files = pore_files(folder, name, self.volume.values.shape, report=report)
        if not may_replace(files, self.windowTitle(), self):
            return
        self._reading = None
        self.say("")
        work = (write_pore_files, *self._work(), folder, name, report, user_language())
        self.begin(
            *work,
            on_done=self._wrote,
            on_stopped=lambda: self.say(self.stopped_words(self.tr("Stopped. Nothing was written."))),
            files=files,
        )

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.addRow(self.tr("Pore values from"), self.low)
        form.addRow(self.tr("Pore values to"), self.high)
        edges = QHBoxLayout()
        edges.addWidget(self.edge, 1)
        edges.addWidget(self.edges)
        edge = QLabel(self.tr("Edge of a voxel"))
        edge.setBuddy(self.edge)
        form.addRow(edge, edges)
        form.addRow(self.tr("Porosity"), self.porosity)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        row = QHBoxLayout()
        for button in (self.open_button, self.folder_button, self.shape_button):
            row.addWidget(button)
        row.addStretch(1)
        column.addLayout(row)
        column.addWidget(self.assumed)
        column.addWidget(self.slices, 1)
        column.addLayout(form)
        colours = QHBoxLayout()
        for widget in (self.network, self.surface, self.colour, self.key):
            colours.addWidget(widget)
        colours.addStretch(1)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.old)
        self.scene.setMinimumHeight(160)
        column.addWidget(self.scene, 3)
        column.addLayout(colours)
        column.addWidget(self.tabs, 1)
        parts = QSplitter(Qt.Orientation.Horizontal)
        parts.addWidget(left)
        parts.addWidget(right)
        parts.setStretchFactor(0, 2)
        parts.setStretchFactor(1, 3)
        parts.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.addWidget(parts, 1)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot(self.export, self.report))
        self.resize(QSize(1180, 760).boundedTo(self.screen().availableSize()))

    def _ask(self) -> None:
        kinds = "*.tif *.tiff *.raw *.bin *.dat *.npy *.npz *.mhd *.mha *.gz *.zip"
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Open a volume"), "", self.tr("Rock volumes ({kinds})").format(kinds=kinds)
        )
        if path:
            self.read(Path(path))

    def _ask_folder(self) -> None:
        path = QFileDialog.getExistingDirectory(self, self.tr("Open a folder of slices"))
        if path:
            self.read(Path(path))

    def _ask_target(self, *, report: bool) -> None:
        title = self.tr("Folder of the report") if report else self.tr("Folder of the files")
        folder = QFileDialog.getExistingDirectory(self, title, str(self._folder))
        if folder:
            self.write(Path(folder), report=report)

    def _wrote(self, done: PoreFiles) -> None:
        names = some_of([Untranslated(file.name) for file in done.files], NAMED)
        wrote = message(
            "gui.files-written", "Wrote {names} in {folder}.", names=names,
            folder=Untranslated(str(done.files[0].resolve().parent)),
        )  # fmt: skip
        self.say("\n".join(map(translated, (wrote, *done.messages))), "warning" if done.messages else "passed")

    def _ask_shape(self, words: str, path: Path, shape: Sequence[int] | None, dtype: str | None) -> None:
        self.raw = RawVolumeDialog(words, shape, dtype, self)
        self.raw.finished.connect(lambda result: self._shape_stated(path, result))
        self.raw.open()

    def _change_shape(self) -> None:
        """Ask for the shape of the raw file that is open; what it was read with is proposed."""
        assert self.volume is not None
        assert self._raw_file is not None
        values = self.volume.values
        words = self.tr("{name}: state its shape and type.").format(name=self._raw_file.name)
        self._ask_shape(words, self._raw_file, values.shape, values.dtype.str)

    def _shape_stated(self, path: Path, result: int) -> None:
        form, self.raw = self.raw, None
        assert form is not None
        form.deleteLater()
        if result == QDialog.DialogCode.Accepted:
            self.read(path, *form.stated)

    def _opened(self, volume: GreyVolume) -> None:
        assert self._reading is not None
        path, shape, _ = self._reading
        self.volume, self.view, self._reading = volume, None, None
        self._folder = path.parent
        self._raw_file = path if _is_raw(path) else None
        self.shape_button.setVisible(self._raw_file is not None)
        self.assumed.setVisible(self._raw_file is not None and shape is None)
        self.assumed.setText(
            self.tr("A raw file has no header: read as {shape} voxels, {type}. Check shape and type.").format(
                shape=" × ".join(map(str, volume.values.shape)),
                type=type_names(self.tr).get(volume.values.dtype.str.lstrip("<>|"), str(volume.values.dtype)),
            )
        )
        self.scene.clear()
        self._show_figures([])
        self._show_settling(None)
        self.key.clear()
        self.old.show_text("")
        self.setWindowTitle(self.tr("Rock volume {name}").format(name=volume.name))
        # A threshold is a proposal that the picture shows; of labels none is likelier than another.
        grey = volume.threshold is not None
        known = self._file_edges()
        edge = known[0] * MICRO if known else 0.0
        with QSignalBlocker(self.low), QSignalBlocker(self.high), QSignalBlocker(self.edge):  # shown together, below
            for box in (self.low, self.high):
                box.fit(volume)
            self.edge.setDecimals(max(3, 3 - math.floor(math.log10(edge))) if edge else 3)
            self.low.setValue(self.low.first if grey else UNSTATED)
            self.high.setValue(self.high.below(volume.threshold) if volume.threshold is not None else UNSTATED)
            self.edge.setValue(edge)
        self.slices.show_volume(volume)
        self._changed()
        if grey and known:
            words = self.tr("The threshold is Otsu's. Check it.")
        elif grey:
            words = self.tr("The threshold is Otsu's. Check it, and state the edge of a voxel.")
        elif known:
            words = self.tr("State which values are pore.")
        else:
            words = self.tr("State which values are pore, and the edge of a voxel.")
        single = len(volume.values) == 1 and path.suffix.lower() in TIFF
        if single:
            words = "\n".join([self.tr("The file has one slice. Open its folder to read all slices."), words])
        self.say(words, "warning" if single else "none")

    def _file_edges(self) -> tuple[float, float, float] | None:
        """Return the edges of a voxel in metres that the file states, if they are lengths."""
        edges = self.volume.voxel if self.volume is not None else None
        return edges if edges is not None and min(edges) > 0 else None

    def _voxel(self) -> tuple[float, ...]:
        """Return the edges of a voxel in metres: the first is stated; unequal ones keep the ratio that the file has."""
        known, edge = self._file_edges(), self.edge.value() / MICRO
        return tuple(edge * e / known[0] for e in known) if known else (edge,) * 3

    def _changed(self) -> None:
        if self.volume is not None:
            low, high = self.low.value(), self.high.value()
            self.slices.show_range(low, high)
            # A range that begins at its start is not empty.
            self.high.first = max(self.low.first, low)
            voxel = self._voxel()
            self.edges.setVisible(len(set(voxel)) > 1)
            edges = " × ".join(f"{edge * MICRO:.{self.edge.decimals()}f}" for edge in voxel)
            self.edges.setText(self.tr("axes 0, 1, 2: {edges} µm").format(edges=edges))
            stated = UNSTATED < low <= high
            self.porosity.setText(f"{100 * self.volume.share(low, high):.2f} %" if stated else "–")
        if self.view is not None:
            old = self._stated() != self._made
            self.old.show_text(self.tr("The pores are older than their settings: press Find pores.") if old else "")
            self.say(*("", "none") if old else self._verdict)
        self.refresh()

    def _stated(self) -> tuple[float, ...]:
        return self.low.value(), self.high.value(), self.edge.value()

    def _find(self) -> None:
        assert self.volume is not None
        self._reading = None
        if not self.volume.share(self.low.value(), self.high.value()):
            self._say_none(self.volume)
            return
        self.say("")
        self.begin(
            pore_view,
            *self._work(),
            on_done=self._found,
            on_stopped=lambda: self.say(self.tr("Stopped. Nothing has changed.")),
        )

    def _work(self) -> tuple[np.ndarray | Path, float, float, tuple[float, ...]]:
        """Return the voxels and what is stated of them."""
        assert self.volume is not None
        source = self.volume.values if self.volume.file is None else self.volume.file
        return source, self.low.value(), self.high.value(), self._voxel()

    def _say_none(self, volume: GreyVolume) -> None:
        """Say that no voxel has the pore values, in the numbers of the fields."""
        low, high = self.low.text(), self.high.text()
        text = (
            self.tr("No voxel has the value {low}. The values of the volume are from {first} to {last}.")
            if low == high
            else self.tr(
                "No voxel has a value from {low} to {high}. The values of the volume are from {first} to {last}."
            )
        )
        first, last = (self.low.textFromValue(value) for value in (self.low.first, self.low.below(volume.edges[-1])))
        self.say(text.format(low=low, high=high, first=first, last=last), "failed")

    def _show_figures(self, rows: list[tuple[str, str]]) -> None:
        names, values = np.array(rows, str).reshape(-1, 2).T
        self.table.show_columns([TableColumn(self.tr("Figure"), names), TableColumn(self.tr("Value"), values)])

    def _show_settling(self, view: PoreView | None) -> None:
        """Show the representative volume, on a tab that is there while it is known."""
        known = view is not None and view.settling is not None
        if view is not None and known:
            self.settling.show_view(view)
        self.tabs.setTabVisible(self.tabs.indexOf(self.settling), known)

    def _found(self, view: PoreView) -> None:
        self.view, self._made = view, self._stated()
        self.scene.show_view(view)
        self._recolour()
        self._show_figures(self._figures(view))
        self._show_settling(view)
        messages = [translated(text) for text in view.permeability.messages]
        if not len(view.triangles):
            messages.append(self.tr("The volume is too large for a surface; cut out a part of it to see one."))
        text = "\n".join(messages) or self.tr("The pore space connects all faces.")
        self._verdict = (text, "warning" if messages else "passed")
        self._changed()

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


def _is_raw(path: Path) -> bool:
    """Return whether a file, packed or not, has voxels and no header."""
    names = [path.name]
    if path.suffix.lower() == ".zip":
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    return any(Path(name.lower().removesuffix(".gz")).suffix in RAW for name in names)

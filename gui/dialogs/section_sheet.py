"""The section sheet: which sections, at which scale, what the title block says, and where the files go."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QDate, Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import GeofitError
from geofit.data.prediction import Uncertainty
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.translate import failure, user_language
from geofit.project.section_sheet import SheetForm, SheetOrder, write_section_sheet
from geofit.report.section_pages import PAPERS, SCALES, SheetTitle
from geofit.site.section_view import parallel_lines

__all__ = ["SectionSheetDialog"]

Floats = NDArray[np.float64]
_FACTORS = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)


class SectionSheetDialog(TaskDialog):
    """Asks for a sheet and writes it in a process of its own; ``files`` holds what was written last."""

    def __init__(
        self,
        site: Site,
        surfaces: Mapping[str, HorizonFit],
        line: Floats,
        thickness: float,
        uncertainty: Mapping[str, Uncertainty],
        folder: Path,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Section sheet"))
        self._site, self._line, self._uncertainty = site, line, dict(uncertainty)
        # The patches are all that is cut; what stands behind them need not travel to the other process.
        self._surfaces = {name: surface.with_(model=None) for name, surface in surfaces.items()}
        self.files: tuple[Path, ...] = ()
        self.which = QComboBox()
        self.which.addItem(self.tr("The line of the section panel"), "line")
        self.which.addItem(self.tr("Across that line, every so many metres"), "across")
        if site.sections:
            self.which.addItem(self.tr("Every section of the site ({n})").format(n=len(site.sections)), "sections")
        self.spacing = _metres(1.0, 1e5, 100.0)
        self.half = _metres(1.0, 1e5, 200.0)
        self.thickness = _metres(0.1, 1e5, thickness)
        self.paper, self.scale, self.factor = QComboBox(), QComboBox(), QComboBox()
        self.paper.addItems(list(PAPERS))
        self.paper.setCurrentText("A3")
        self.scale.addItem(self.tr("The largest that fits"), None)
        for scale in SCALES:
            self.scale.addItem(f"1:{scale}", scale)
        for factor in _FACTORS:
            self.factor.addItem(f"× {factor:g}", factor)
        self.title_line, self.project = QLineEdit(self.tr("Geological section")), QLineEdit(site.name)
        self.number, self.author = QLineEdit(), QLineEdit()
        self.date = QLineEdit(QDate.currentDate().toString(Qt.DateFormat.ISODate))
        self.forms: dict[SheetForm, QCheckBox] = {
            "pdf": QCheckBox("PDF"), "svg": QCheckBox("SVG"), "dxf": QCheckBox("DXF")
        }  # fmt: skip
        self.forms["pdf"].setChecked(True)
        self.target = QLineEdit(str(folder / "sections"))
        self.go.setText(self.tr("&Write"))
        self.open_folder = QPushButton(self.tr("Open &folder"))
        self._lay_out()
        for box in self.forms.values():
            box.toggled.connect(self.refresh)
        self.which.currentIndexChanged.connect(self.refresh)
        self.target.textChanged.connect(self.refresh)
        self.go.clicked.connect(self._write)
        self.open_folder.clicked.connect(self._open_folder)
        self.say(self.tr("Each section is drawn to scale: holes with lithology, horizons with their 90 % bands."))
        self.refresh()

    def lines(self) -> Mapping[str, Floats]:
        """Return the lines of the sections by their names; SettingsError where a number does not fit."""
        which = self.which.currentData()
        if which == "across":
            return parallel_lines(self._line, self.spacing.value(), self.half.value())
        if which == "sections":
            return {section.name: section.line for section in self._site.sections}
        return {"": self._line}

    def order(self) -> SheetOrder:
        """Return what is asked for."""
        path = Path(self.target.text().strip()).expanduser()
        return SheetOrder(
            self.lines(),
            self.thickness.value(),
            SheetTitle(
                self.title_line.text().strip(),
                self.project.text().strip(),
                self.number.text().strip(),
                self.author.text().strip(),
                self.date.text().strip(),
            ),
            path.with_suffix("") if path.suffix.lower() in (".pdf", ".svg", ".dxf") else path,
            tuple(form for form, box in self.forms.items() if box.isChecked()),
            self.paper.currentText(),
            self.scale.currentData(),
            self.factor.currentData(),
            user_language().code,
        )

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        idle, across = not self.running, self.which.currentData() == "across"
        for widget in (self.spacing, self.half):
            widget.setEnabled(idle and across)
        wanted = any(box.isChecked() for box in self.forms.values())
        self.go.setEnabled(idle and wanted and bool(self.target.text().strip()))
        self.open_folder.setVisible(bool(self.files) and idle)

    def _lay_out(self) -> None:
        browse = QPushButton(self.tr("&Browse…"))
        browse.clicked.connect(self._browse)
        place, forms = QHBoxLayout(), QHBoxLayout()
        place.addWidget(self.target, 1)
        place.addWidget(browse)
        for box in self.forms.values():
            forms.addWidget(box)
        forms.addStretch(1)
        form = QFormLayout()
        for words, field in (
            (self.tr("&Sections"), self.which),
            (self.tr("&Every"), self.spacing),
            (self.tr("&Length to each side"), self.half),
            (self.tr("&Thickness"), self.thickness),
            (self.tr("&Paper"), self.paper),
            (self.tr("S&cale"), self.scale),
            (self.tr("&Height"), self.factor),
            (self.tr("T&itle"), self.title_line),
            (self.tr("P&roject"), self.project),
            (self.tr("Drawing &number"), self.number),
            (self.tr("Prepared &by"), self.author),
            (self.tr("&Date"), self.date),
        ):
            form.addRow(words, field)
        form.addRow(self.tr("Files", "SectionSheetDialog"), forms)
        form.addRow(self.tr("To"), place)
        self.target.setMinimumWidth(360)
        self.fields = (
            self.which, self.thickness, self.paper, self.scale, self.factor, self.title_line, self.project,
            self.number, self.author, self.date, *self.forms.values(), self.target, browse,
        )  # fmt: skip
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(self.message_row)
        layout.addStretch(1)
        layout.addLayout(self.foot(self.open_folder))

    def _browse(self) -> None:
        path, _ = QFileDialog.getSaveFileName(self, self.windowTitle(), self.target.text())
        if path:
            self.target.setText(path)

    def _open_folder(self) -> None:
        for file in self.files[:1]:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(file.parent)))

    def _write(self) -> None:
        try:
            order = self.order()
        except GeofitError as error:
            self.say(failure(error), "failed")
            return
        self.files = ()
        self.say(self.tr("Cutting and drawing the sections…"))
        self.begin(
            write_section_sheet,
            self._site,
            self._surfaces,
            self._uncertainty,
            order,
            on_done=self._written,
            on_stopped=partial(self.say, self.tr("Stopped. A file that was not finished is not there.")),
        )

    def _written(self, made: tuple[int, tuple[Path, ...]]) -> None:
        scale, self.files = made
        names = ", ".join(str(file.resolve()) for file in self.files)
        self.say(self.tr("Wrote {names} at 1:{scale}.").format(names=names, scale=scale), "passed")


def _metres(low: float, high: float, value: float) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setDecimals(1)
    spin.setSuffix(" m")
    spin.setValue(value)
    return spin

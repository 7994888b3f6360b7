"""Drawings to scale: paper, scale, title block and files; a dialog for each kind of drawing adds its own fields."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QDate, Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import GeofitError
from geofit.data.site import Site
from geofit.data.stale import stale_warning
from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.lengths import coordinate_unit, length_mark, length_unit, metres_shown, shown_length
from geofit.gui.save_file import ask_save_file, may_replace
from geofit.gui.translate import failure, translated
from geofit.project.section_sheet import SheetForm
from geofit.report.paper import PAPERS, SheetTitle, drawing_scale, scales_of, svg_files

__all__ = ["LengthField", "SheetDialog"]

#: A field with its label.
Row = tuple[str, QWidget]


class SheetDialog(TaskDialog):
    """Asks for a drawing and writes it in a process of its own; ``files`` holds what was written last."""

    #: What is said before the drawing is made, and while it is.
    hint = drawing = ""

    def __init__(self, site: Site, title: str, target: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._site = site
        self.files: tuple[Path, ...] = ()
        #: The file that was agreed to be replaced when it was chosen.
        self._agreed: Path | None = None
        self.paper, self.scale = QComboBox(), QComboBox()
        self.paper.addItems(list(PAPERS))
        self.paper.setCurrentText("A3")
        self.scale.addItem(self.tr("The largest that fits"), None)
        for scale in scales_of(length_unit()):
            self.scale.addItem(drawing_scale(scale, length_unit()), scale)
        self.title_line, self.project = QLineEdit(title), QLineEdit(site.name)
        self.number, self.author = QLineEdit(), QLineEdit()
        self.date = QLineEdit(QDate.currentDate().toString(Qt.DateFormat.ISODate))
        self.forms: dict[SheetForm, QCheckBox] = {
            "pdf": QCheckBox("PDF"), "svg": QCheckBox("SVG"), "dxf": QCheckBox("DXF")
        }  # fmt: skip
        self.forms["pdf"].setChecked(True)
        self.target = QLineEdit(str(target))
        self.go.setText(self.tr("&Write"))
        self.open_folder = QPushButton(self.tr("Open &folder"))

    @abstractmethod
    def work(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """Return what writes the drawing, with its arguments; GeofitError where a number does not fit."""

    @abstractmethod
    def sheets(self) -> Sequence[str]:
        """Return the names of the sheets."""

    @abstractmethod
    def stale(self) -> list[str]:
        """Return the names of what is drawn and is older than its data."""

    def show_hint(self) -> None:
        """Say what will be drawn."""
        self._tell(self.hint)

    def title_block(self) -> SheetTitle:
        """Return what the title block says."""
        lines = (self.title_line, self.project, self.number, self.author, self.date)
        title, project, number, author, date = (line.text().strip() for line in lines)
        return SheetTitle(title, project, number, author, date, length_unit(), coordinate_unit())

    def path(self) -> Path:
        """Return the files but for their endings."""
        path = Path(self.target.text().strip()).expanduser()
        return path.with_suffix("") if path.suffix.lower() in (".pdf", ".svg", ".dxf") else path

    def wanted(self) -> tuple[SheetForm, ...]:
        """Return which files are wanted."""
        return tuple(form for form, box in self.forms.items() if box.isChecked())

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        idle = not self.running
        self.go.setEnabled(idle and bool(self.wanted()) and bool(self.target.text().strip()))
        self.open_folder.setVisible(bool(self.files) and idle)

    def lay_out(self, first: Sequence[Row], after_scale: Sequence[Row] = ()) -> None:
        """Put the fields of the drawing before those of the paper, and some after its scale."""
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
            *first,
            (self.tr("&Paper"), self.paper),
            (self.tr("S&cale"), self.scale),
            *after_scale,
            (self.tr("T&itle"), self.title_line),
            (self.tr("P&roject"), self.project),
            (self.tr("Drawing &number"), self.number),
            (self.tr("Prepared b&y"), self.author),
            (self.tr("&Date"), self.date),
        ):
            form.addRow(words, field)
        form.addRow(self.tr("Files", "SectionSheetDialog"), forms)
        to = QLabel(self.tr("To"))
        to.setBuddy(self.target)
        form.addRow(to, place)
        self.target.setMinimumWidth(360)
        self.fields = (
            *(field for _, field in (*first, *after_scale)), self.paper, self.scale, self.title_line, self.project,
            self.number, self.author, self.date, *self.forms.values(), self.target, browse,
        )  # fmt: skip
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(self.message_row)
        layout.addStretch(1)
        layout.addLayout(self.foot(self.open_folder))
        for box in self.forms.values():
            box.toggled.connect(self.refresh)
        self.target.textChanged.connect(self.refresh)
        self.go.clicked.connect(self._write)
        self.open_folder.clicked.connect(self._open_folder)

    def _browse(self) -> None:
        kinds = ";;".join(f"{form.upper()} (*.{form})" for form in self.wanted() or self.forms)
        chosen = ask_save_file(self, self.windowTitle(), self.target.text(), kinds)
        if chosen is not None:
            self._agreed = chosen[0]
            self.target.setText(str(chosen[0]))

    def _open_folder(self) -> None:
        for file in self.files[:1]:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(file.parent)))

    def _write(self) -> None:
        try:
            function, arguments = self.work()
        except GeofitError as error:
            self.say(failure(error), "failed")
            return
        targets = self._targets()
        if not may_replace([file for file in targets if file != self._agreed], self.windowTitle(), self):
            return
        self.files, self._agreed = (), None
        self.say(self.drawing)
        self.begin(function, *arguments, on_done=self._written, on_stopped=self._stopped, files=targets)

    def _stopped(self) -> None:
        self.say(self.stopped_words(self.tr("Stopped. No unfinished file was left.")))

    def _targets(self) -> list[Path]:
        stem = self.path()
        files: list[Path] = []
        for form in self.wanted():
            path = stem.with_name(f"{stem.name}.{form}")
            files += svg_files(self.sheets(), path) if form == "svg" else [path]
        return files

    def _written(self, made: tuple[int, tuple[Path, ...]]) -> None:
        scale, self.files = made
        names = ", ".join(str(file.resolve()) for file in self.files)
        self._tell(self.tr("Wrote {names} at 1:{scale}.").format(names=names, scale=scale), "passed")

    def _tell(self, text: str, mark: str = "none") -> None:
        """Say something, and what is older than its data."""
        old = self.stale()
        self.say(f"{text}\n{translated(stale_warning(old))}" if old else text, "stale" if old else mark)


class LengthField(QDoubleSpinBox):
    """A field for a length in the unit that the windows show."""

    def __init__(self, low: float, high: float, value: float, decimals: int = 1) -> None:
        super().__init__()
        self.setRange(round(shown_length(low), decimals), shown_length(high))
        self.setDecimals(decimals)
        self.setSuffix(f" {length_mark()}")
        self.setValue(value)

    @property
    def metres(self) -> float:
        """The length in metres."""
        return self.value() * metres_shown()

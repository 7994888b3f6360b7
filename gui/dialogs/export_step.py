"""Writes horizons as STEP, and shows what an independent reader found in the file."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSettings, QSize, Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QButtonGroup,
    QComboBox,
    QFormLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QRadioButton,
    QVBoxLayout,
    QWidget,
)

from geofit.data.accuracy import Check
from geofit.data.files import file_stems
from geofit.data.messages import message
from geofit.data.stale import stale_warning
from geofit.data.title_block import TitleBlock
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.dialogs.step_fields import SignedFields
from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.panels.marks import icon, level_mark, verdict_mark
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.save_file import ask_save_file, may_replace
from geofit.gui.translate import translated
from geofit.project.step_files import StepFile, certificate_of, step_paths, write_step_files
from geofit.report import digits

__all__ = ["ExportDialog"]

_FOLDER = "folder"


class ExportDialog(TaskDialog):
    """Asks which horizons go where, writes them in a process of its own, and lists the checks of the read-back.

    ``files`` holds what was written last.
    """

    def __init__(
        self,
        surfaces: Mapping[str, HorizonFit],
        parent: QWidget | None = None,
        verdicts: Mapping[str, Verdict] | None = None,
        folder: Path | None = None,
        title: TitleBlock | None = None,
        datum: tuple[float, float, float] | None = None,
        stale: Collection[str] = (),
    ) -> None:
        super().__init__(parent)
        self._stale = stale
        self._verdicts = verdicts or {}
        self.setWindowTitle(self.tr("Export STEP"))
        # The patches are all that a file holds; what stands behind them need not travel to the other process.
        self._surfaces = {name: surface.with_(model=None) for name, surface in surfaces.items()}
        self.files: list[StepFile] = []
        #: The file that was agreed to be replaced when it was chosen.
        self._agreed: Path | None = None
        self.horizons = self._list()
        self.target = QLineEdit(str((folder or Path(str(QSettings().value(_FOLDER, "")))) / self._proposed()))
        self.unit = QComboBox()
        self.unit.addItem(self.tr("metres"), "m")
        self.unit.addItem(self.tr("millimetres"), "mm")
        self.unit.setToolTip(
            self.tr("The file states its unit, and CAD systems convert it. The surfaces are the same.")
        )
        self.stated = SignedFields(self, title or TitleBlock(), datum)
        self.author, self.organisation = self.stated.author, self.stated.organisation
        self.origin, self.certificate = self.stated.origin, self.stated.certificate
        self.together, self.apart = QRadioButton(self.tr("O&ne file")), QRadioButton(self.tr("One file per &horizon"))
        self.table = DataTable()
        self.table.setAccessibleName(self.tr("What the reader found in the file"))
        # The form stays where it is when the table comes.
        policy = self.table.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.table.setSizePolicy(policy)
        self.go.setText(self.tr("&Write"))
        self.folder = QPushButton(self.tr("Open &folder"))
        self._lay_out()
        self.horizons.itemChanged.connect(self.refresh)
        self.target.textChanged.connect(self.refresh)
        self.apart.toggled.connect(self.refresh)
        self.origin.choice.currentIndexChanged.connect(self.refresh)
        self.origin.datum.textChanged.connect(self.refresh)
        self.go.clicked.connect(self._write)
        self.folder.clicked.connect(self._open_folder)
        self._tell(self.tr("After writing, OpenCASCADE reads the file back; what it finds is listed here."))
        self.refresh()

    def chosen(self) -> list[str]:
        """Return the horizons that will be written."""
        items = (self.horizons.item(row) for row in range(self.horizons.count()))
        return [item.data(Qt.ItemDataRole.UserRole) for item in items if item.checkState() == Qt.CheckState.Checked]

    def _list(self) -> QListWidget:
        made = QListWidget()
        made.setAccessibleName(self.tr("Horizons to write"))
        for name, surface in self._surfaces.items():
            accuracy = surface.accuracy
            judged = None if accuracy is None else self._verdicts.get(name) or verdict_of(accuracy)
            old = name in self._stale
            title = self.tr("{name} (stale)").format(name=name) if old else name
            text = title if judged is None else f"{title}   {translated(judged.text)}"
            mark = "stale" if old else "none" if judged is None else level_mark(judged.level)
            item = QListWidgetItem(icon(mark), text)
            item.setToolTip(f"{text}\n{self.tr('Older than its data or settings: press Fit')}" if old else text)
            font = item.font()
            font.setItalic(old)
            item.setFont(font)
            item.setData(Qt.ItemDataRole.UserRole, name)
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(Qt.CheckState.Checked)
            made.addItem(item)
        made.setFixedHeight(min(max(made.count(), 3), 6) * (made.sizeHintForRow(0) + 2) + 8)
        return made

    def _proposed(self) -> str:
        names = list(self._surfaces)
        return "horizons.step" if len(names) > 1 else f"{file_stems(names)[names[0]]}.step"

    def _lay_out(self) -> None:
        browse = QPushButton(self.tr("&Browse…"))
        browse.clicked.connect(self._browse)
        place = QHBoxLayout()
        place.addWidget(self.target, 1)
        place.addWidget(browse)
        group, choice = QButtonGroup(self), QHBoxLayout()
        for button in (self.together, self.apart):
            group.addButton(button)
            choice.addWidget(button)
        choice.addStretch(1)
        self.together.setChecked(True)
        unit = QHBoxLayout()
        unit.addWidget(self.unit)
        unit.addWidget(QLabel(self.tr("ISO 10303-242 (AP242)")), 1)
        form = QFormLayout()
        form.addRow(self.tr("Hori&zons"), self.horizons)
        # A label before a layout has no buddy of its own.
        for text, field, row in ((self.tr("F&ile"), self.target, place), (self.tr("&Unit"), self.unit, unit)):
            label = QLabel(text)
            label.setBuddy(field)
            form.addRow(label, row)
        form.insertRow(2, "", choice)
        self.stated.add_to(form)
        self.fields = (
            self.horizons, self.target, browse, self.together, self.apart, self.unit, *self.stated.widgets,
        )  # fmt: skip
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(self.message_row)
        layout.addWidget(self.table, 1)
        layout.addLayout(self.foot(self.folder))
        # Tab follows the form; what was made first would come first.
        for before, after in pairwise(self.fields):
            QWidget.setTabOrder(before, after)
        self.resize(QSize(960, 640).boundedTo(self.screen().availableSize()))

    def _browse(self) -> None:
        chosen = ask_save_file(self, self.windowTitle(), self.target.text(), self.tr("STEP files (*.step *.stp)"))
        if chosen is not None:
            self._agreed = chosen[0]
            self.target.setText(str(chosen[0]))

    def _path(self) -> Path:
        path = Path(self.target.text().strip()).expanduser()
        return path if path.suffix.lower() in (".step", ".stp") else path.with_name(path.name + ".step")

    def _write(self) -> None:
        names = self.chosen()
        surfaces = {name: self._surfaces[name] for name in names}
        unit, separate, signed = self.unit.currentData(), self.apart.isChecked(), self.stated.signed()
        work = (surfaces, self._path(), unit, separate, signed, self._stale)
        paths = list(step_paths(names, work[1], separate=separate))
        written = [*paths, *(map(certificate_of, paths) if signed.certificate else ())]
        if not may_replace([file for file in written if file != self._agreed], self.windowTitle(), self):
            return
        self.files, self._agreed = [], None
        self.say(self.tr("Writing, and reading back what was written…"))
        self.begin(
            write_step_files, *work, on_done=self.show_files, on_stopped=partial(self._stopped, paths), files=paths
        )

    def show_files(self, files: list[StepFile]) -> None:
        """Show what was written, and what reading it back gave."""
        self.files = files
        QSettings().setValue(_FOLDER, str(files[0].path.parent))
        self.stated.store()
        found = {name: back for file in files for name, back in file.read_back.items()}
        size = digits.kilobytes(sum(file.size for file in files))
        pages = [file.certificate for file in files if file.certificate is not None]
        names = ", ".join(str(path.resolve()) for path in (*(file.path for file in files), *pages))
        if all(back.passed for back in found.values()):
            self._tell(self.tr("Wrote {names} ({size}). The file passes every check.").format(names=names, size=size),
                       "passed")  # fmt: skip
        else:
            bad = ", ".join(name for name, back in found.items() if not back.passed)
            text = self.tr(
                "Wrote {names} ({size}), but the file fails its checks for: {bad}. See the failed "
                "checks below; fit these horizons with a smaller tolerance or another core before you "
                "pass the file on."
            )
            self._tell(text.format(names=names, size=size, bad=bad), "failed")
        self._show_checks([(name, check) for name, back in found.items() for check in self._checks(name, files)])

    def _tell(self, text: str, mark: str = "none") -> None:
        """Say something, and of chosen horizons that are stale what to do."""
        old = [name for name in self.chosen() if name in self._stale]
        if old:
            text = f"{text}\n{translated(stale_warning(old))}"
            mark = "failed" if mark == "failed" else "stale"
        self.say(text, mark)

    def _checks(self, name: str, files: list[StepFile]) -> list[Check]:
        back = next(file.read_back[name] for file in files if name in file.read_back)
        sigma = self._surfaces[name].accuracy
        first = Check(
            "σ", None if sigma is None else back.sigma < sigma.epsilon, back.sigma, sigma.epsilon if sigma else np.nan,
            "m", message(
                "gui.sigma-in-file", "{faces} faces; σ of all points from the surface in the file", faces=back.faces
            ),
        )  # fmt: skip
        return [first, *back.checks]

    def _show_checks(self, rows: list[tuple[str, Check]]) -> None:
        results = {True: self.tr("passed"), False: self.tr("failed"), None: self.tr("not applicable")}
        passed = [check.passed for _, check in rows]

        def texts(values: list[str]) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
            return np.array(values, dtype=np.str_)

        self.table.show_columns(
            (
                TableColumn(self.tr("Horizon"), texts([name for name, _ in rows])),
                TableColumn(
                    self.tr("Check of the file"),
                    texts([translated(check.name) for _, check in rows]),
                    icons=lambda row: verdict_mark(passed[row]),
                ),
                TableColumn(
                    self.tr("Result"),
                    texts([results[value] for value in passed]),
                    order=[{False: 0, True: 1, None: 2}[value] for value in passed],
                ),
                TableColumn(
                    self.tr("Found"),
                    texts([digits.measured(check.value, translated(check.unit)) for _, check in rows]),
                    measured=True,
                ),
                TableColumn(
                    self.tr("Limit"),
                    texts([digits.measured(check.limit, translated(check.unit)) for _, check in rows]),
                    measured=True,
                ),
                TableColumn(self.tr("In words"), texts([translated(check.text) for _, check in rows])),
            )
        )
        self.table.resizeColumnsToContents()
        header = self.table.horizontalHeader()
        header.setSectionResizeMode(header.count() - 1, QHeaderView.ResizeMode.Stretch)

    def _stopped(self, files: list[Path]) -> None:
        """Remove the unfinished files of the process that was stopped, and of any earlier one that crashed."""
        for folder in {file.parent for file in files}:
            for pattern in (".geofit-????????.step", ".????????.part.step"):
                for rest in folder.glob(pattern):
                    rest.unlink(missing_ok=True)
        self.say(self.stopped_words(self.tr("Stopped. No unfinished file was left.")))

    def _open_folder(self) -> None:
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.files[0].path.parent)))

    def refresh(self) -> None:
        """Enable what can be done, and say which files there will be."""
        super().refresh()
        names, idle = self.chosen(), not self.running
        self.apart.setEnabled(idle and len(names) > 1)
        complete = bool(self.target.text().strip()) and self.origin.origin is not None
        self.go.setEnabled(idle and bool(names) and complete)
        self.certificate.setEnabled(idle and not self.stated.no_page)
        self.folder.setVisible(bool(self.files) and idle)
        self.table.setVisible(bool(self.files) and idle)
        files = [path.name for path in step_paths(names, self._path(), separate=self.apart.isChecked())]
        self.target.setToolTip("\n".join(files))

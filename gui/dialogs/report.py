"""Writes the accuracy report of the surfaces as they are: language, forms, folder, date."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QDate, QSettings, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDateEdit,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from geofit.data.site import Site
from geofit.data.stale import stale_warning
from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.names import literal
from geofit.gui.preferences import Preferences
from geofit.gui.save_file import may_replace
from geofit.gui.translate import translated
from geofit.project.body_building import BodyResult
from geofit.project.building import Given
from geofit.project.fault_blocks import Blocks
from geofit.project.reporting import ReportFiles, not_in_report, write_report_files
from geofit.project.run import Form, report_paths
from geofit.report.gather import today
from geofit.report.result import HorizonResult

__all__ = ["ReportDialog"]

_FOLDER = "folder"
#: Width of the names of the horizons to be examined, letters.
_NAMES = 36


class ReportDialog(TaskDialog):
    """Asks how the report shall be, writes it in a process of its own, and opens it.

    ``written(path)`` is emitted for the form that people read: the PDF if there is one, else the HTML, else the JSON;
    ``examined(name, prediction)`` for each horizon that was examined away from its data on the way, ``ordered(orders)``
    with how the horizons lie to each other.
    """

    written = Signal(object)
    examined = Signal(str, object)
    ordered = Signal(object)

    def __init__(
        self,
        site: Site,
        results: Sequence[HorizonResult],
        parent: QWidget | None = None,
        blocks: Blocks | None = None,
        folder: Path | None = None,
        bodies: Mapping[str, BodyResult] | None = None,
        unfitted: Sequence[str] = (),
    ) -> None:
        super().__init__(parent)
        self._bodies, self._unfitted = dict(bodies or {}), tuple(unfitted)
        self._blocks = blocks or Blocks({}, Given(site))
        self.setWindowTitle(self.tr("Accuracy report"))
        self._results = list(results)
        self._path: Path | None = None
        # Files that this dialog has written are replaced without a question.
        self._own: set[Path] = set()
        self.language = QComboBox()
        for code, name in (("en", "English"), ("zh", "中文")):
            self.language.addItem(name, code)
        self.language.setCurrentIndex(self.language.findData(Preferences().language[:2]))
        self.forms: dict[Form, QCheckBox] = {
            "html": QCheckBox(self.tr("&HTML, one file with its pictures")),
            "pdf": QCheckBox(self.tr("&PDF, A4, with its fonts")),
            "json": QCheckBox(self.tr("&JSON, every figure for machines")),
        }
        for form, box in self.forms.items():
            box.setChecked(form != "json")
            box.toggled.connect(self.refresh)
        self.date = QDateEdit(QDate.fromString(today(), Qt.DateFormat.ISODate))
        self.date.setDisplayFormat("yyyy-MM-dd")
        self.date.setCalendarPopup(True)
        self.folder = QLineEdit(str((folder or Path(str(QSettings().value(_FOLDER, "")) or Path.home())) / "report"))
        self.folder.textChanged.connect(self.refresh)
        self.examine = QCheckBox()
        self.examine.setChecked(True)
        self.go.setText(self.tr("&Write"))
        self.view = QPushButton(self.tr("&Open"))
        self._lay_out(site)
        self.go.clicked.connect(self._write)
        self.view.clicked.connect(self.open_result)
        horizons = {result.name: result for result in self._results}
        bodies = {name: body for name, body in self._bodies.items() if body.fitted is not None}
        words = self.tr("Horizons: {names}").format(names=self._titles(horizons))
        if bodies:
            words += " · " + self.tr("Bodies: {names}").format(names=self._titles(bodies))
        stale = [name for of in (horizons, bodies) for name, result in of.items() if result.stale]
        if self._unfitted:
            words += f"\n{translated(not_in_report(self._unfitted))}"
        if stale:
            words += f"\n{translated(stale_warning(stale))}"
        self.say(words, "stale" if stale else "warning" if self._unfitted else "report")
        self.refresh()

    def _titles(self, results: Mapping[str, HorizonResult] | Mapping[str, BodyResult]) -> str:
        """Return the names of what goes into the report, those that are stale marked."""
        stale = self.tr("{name} (stale)")
        return ", ".join(stale.format(name=name) if result.stale else name for name, result in results.items())

    def open_result(self) -> None:
        """Open what was written, in the program that the system has for it."""
        if self._path is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._path)))

    def _lay_out(self, site: Site) -> None:
        browse = QPushButton(self.tr("&Browse…"))
        browse.clicked.connect(self._browse)
        self.folder.setMinimumWidth(340)
        place = QHBoxLayout()
        place.addWidget(self.folder, 1)
        place.addWidget(browse)
        forms = QVBoxLayout()
        for box in self.forms.values():
            forms.addWidget(box)
        form = self._form = QFormLayout()
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.FieldsStayAtSizeHint)
        form.addRow(self.tr("Site", "ReportDialog"), QLabel(site.name))
        label = QLabel(self.tr("&Folder"))
        label.setBuddy(self.folder)
        form.addRow(self.tr("&Language"), self.language)
        form.addRow(self.tr("Formats"), forms)
        form.addRow(self.tr("&Date"), self.date)
        form.addRow(label, place)
        form.addRow(self.tr("Away from the data"), self.examine)
        self.fields = (self.language, *self.forms.values(), self.date, self.folder, browse, self.examine)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(self.message_row)
        layout.addStretch(1)
        layout.addLayout(self.foot(self.view))
        self._ask_to_examine()
        # A minimum of its own would hide that of the fields, which large text makes wider.
        self.setMinimumWidth(max(560, layout.minimumSize().width()))

    def _ask_to_examine(self) -> None:
        """Offer to examine the horizons of which nothing is known away from their data."""
        unknown = [result.name for result in self._results if result.prediction is None]
        # The names of many horizons would make the dialog wider than the screen; the tip has them all.
        metrics = self.fontMetrics()
        # Not the average of all letters of a font: with Chinese ones behind it that is nearly twice as wide.
        width = metrics.horizontalAdvance("n" * _NAMES)
        names = metrics.elidedText(", ".join(unknown), Qt.TextElideMode.ElideRight, width)
        self.examine.setText(self.tr("&Examine first: {names}").format(names=literal(names)))
        tip = self.tr("The prediction error away from the data, found by leaving out holes.")
        self.examine.setToolTip("\n".join([tip, *unknown]))
        self._form.setRowVisible(self.examine, bool(unknown))

    def _browse(self) -> None:
        path = QFileDialog.getExistingDirectory(self, self.windowTitle(), str(Path(self.folder.text()).parent))
        if path:
            self.folder.setText(path)

    def _chosen(self) -> list[Form]:
        return [form for form, box in self.forms.items() if box.isChecked()]

    def _write(self) -> None:
        folder = Path(self.folder.text().strip()).expanduser()
        files = list(report_paths(folder, self._chosen()).values())
        if not may_replace([file for file in files if file not in self._own], self.windowTitle(), self):
            return
        examined = self.examine.isChecked()
        # The model behind the patches is only needed to leave points out, and for the bands of the sections.
        results = [
            result
            if examined or result.prediction is not None
            else replace(result, surface=result.surface.with_(model=None))
            for result in self._results
        ]
        date = self.date.date().toString(Qt.DateFormat.ISODate)
        work = (
            results,
            self._blocks,
            folder,
            self.language.currentData(),
            self._chosen(),
            examined,
            date,
            self._bodies,
            self._unfitted,
        )
        self._path = None
        self.say(self.tr("Writing the report…"), "report")
        self.begin(
            write_report_files,
            *work,
            on_done=self._done,
            on_stopped=lambda: self.say(self.stopped_words(self.tr("Stopped. No report was written."))),
            files=files,
        )

    def _done(self, made: ReportFiles) -> None:
        for name, prediction in made.prediction.items():
            self.examined.emit(name, prediction)
        self.ordered.emit(made.orders)
        self._results = [
            replace(result, prediction=made.prediction.get(result.name, result.prediction)) for result in self._results
        ]
        self._ask_to_examine()
        best: Form = next(form for form in ("pdf", "html", "json") if form in made.files)
        self._path = made.files[best]
        self._own |= set(made.files.values())
        QSettings().setValue(_FOLDER, str(self._path.parent.parent))
        names = ", ".join(path.name for path in made.files.values())
        text = self.tr("Wrote {names} in {folder}.").format(names=names, folder=self._path.parent.resolve())
        summary = "\n".join([text, *(translated(warning) for warning in made.warnings)])
        stale = any(one.stale for one in self._results) or any(one.stale for one in self._bodies.values())
        self.say(summary, "stale" if stale else "warning" if made.warnings else "passed")
        self.written.emit(self._path)
        self.open_result()

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        self.go.setEnabled(not self.running and bool(self._chosen()) and bool(self.folder.text().strip()))
        self.view.setVisible(self._path is not None and not self.running)

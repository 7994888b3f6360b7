"""Writes the accuracy report of the surfaces as they are: language, forms, folder, date."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QDate, QSettings, Qt, QUrl, Signal
from PySide6.QtGui import QCloseEvent, QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDateEdit,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from geofit.deliver import Form, Reports
from geofit.errors import GeofitError
from geofit.gui.document.reporting import write_report_files
from geofit.gui.panels.marks import icon
from geofit.gui.preferences import Preferences
from geofit.gui.words import spoken
from geofit.gui.worker import Task, run_apart
from geofit.report.gather import today
from geofit.report.result import HorizonResult
from geofit.site import Site

__all__ = ["ReportDialog"]

_FOLDER = "folder"


class ReportDialog(QDialog):
    """Asks how the report shall be, writes it in a process of its own, and opens it.

    ``written(path)`` is emitted for the form that people read: the PDF if there is one, else the HTML, else the JSON.
    """

    written = Signal(object)

    def __init__(self, site: Site, results: Sequence[HorizonResult], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Accuracy report"))
        self._results = list(results)
        self._task: Task | None = None
        self._path: Path | None = None
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
            box.toggled.connect(self._refresh)
        self.date = QDateEdit(QDate.fromString(today(), Qt.DateFormat.ISODate))
        self.date.setDisplayFormat("yyyy-MM-dd")
        self.date.setCalendarPopup(True)
        self.folder = QLineEdit(str(Path(str(QSettings().value(_FOLDER, "")) or Path.home()) / "report"))
        self.folder.textChanged.connect(self._refresh)
        unknown = [result.name for result in self._results if result.offdata is None]
        self.examine = QCheckBox(self.tr("&Examine first: {names}").format(names=", ".join(unknown)))
        self.examine.setToolTip(
            self.tr("How far the rock may lie from the surface where nobody drilled, found by leaving out holes.")
        )
        self.examine.setChecked(bool(unknown))
        self.examine.setVisible(bool(unknown))
        self.message, self.sign = QLabel(), QLabel()
        self.message.setWordWrap(True)
        self.message.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.progress = QProgressBar()
        self.progress.setRange(0, 1000)
        self.progress.setTextVisible(False)
        self.write, self.stop = QPushButton(self.tr("&Write")), QPushButton(self.tr("&Stop"))
        self.view = QPushButton(self.tr("&Open"))
        self.write.setDefault(True)
        self.close_box = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        self._lay_out(site)
        self.write.clicked.connect(self._write)
        self.stop.clicked.connect(self._cancel)
        self.view.clicked.connect(self.open_result)
        self.close_box.rejected.connect(self.reject)
        names = ", ".join(result.name for result in self._results)
        self._say(self.tr("{count} horizons: {names}").format(count=len(self._results), names=names), "report")
        self._refresh()

    def open_result(self) -> None:
        """Open what was written, in the program that the system has for it."""
        if self._path is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._path)))

    def reject(self) -> None:
        """Stop what runs, and close."""
        self._cancel()
        super().reject()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop what runs."""
        self._cancel()
        super().closeEvent(event)

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
        form = QFormLayout()
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.FieldsStayAtSizeHint)
        form.addRow(self.tr("Site"), QLabel(site.name))
        label = QLabel(self.tr("&Folder"))
        label.setBuddy(self.folder)
        form.addRow(self.tr("&Language"), self.language)
        form.addRow(self.tr("Forms"), forms)
        form.addRow(self.tr("&Date"), self.date)
        form.addRow(label, place)
        form.addRow(self.tr("Off the data"), self.examine)
        form.setRowVisible(self.examine, self.examine.isVisibleTo(self))
        said = QHBoxLayout()
        said.addWidget(self.sign, 0, Qt.AlignmentFlag.AlignTop)
        said.addWidget(self.message, 1)
        foot = QHBoxLayout()
        foot.addWidget(self.progress, 1)
        foot.addStretch(1)
        for button in (self.view, self.stop, self.write, self.close_box):
            foot.addWidget(button)
        self._fields = (self.language, *self.forms.values(), self.date, self.folder, browse, self.examine)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addLayout(said)
        layout.addStretch(1)
        layout.addLayout(foot)
        self.setMinimumWidth(560)

    def _browse(self) -> None:
        path = QFileDialog.getExistingDirectory(self, self.windowTitle(), str(Path(self.folder.text()).parent))
        if path:
            self.folder.setText(path)

    def _chosen(self) -> list[Form]:
        return [form for form, box in self.forms.items() if box.isChecked()]

    def _write(self) -> None:
        examined = self.examine.isChecked()
        # What stands behind the patches is only needed to leave points out.
        results = [
            result if examined and result.offdata is None else replace(result, surface=result.surface.with_(model=None))
            for result in self._results
        ]
        date = self.date.date().toString(Qt.DateFormat.ISODate)
        folder = Path(self.folder.text().strip()).expanduser()
        work = (results, folder, self.language.currentData(), self._chosen(), examined, date)
        self._path = None
        self.progress.setValue(0)
        self._say(self.tr("Writing the report…"), "report")
        self._task = run_apart(
            self,
            write_report_files,
            *work,
            title=self.windowTitle(),
            on_done=self._done,
            on_failed=self._failed,
            on_progress=self._progress,
            on_cancelled=partial(self._say, self.tr("Stopped. No report was written."), "none"),
        )
        self._task.ended.connect(self._rested)
        self._refresh()

    def _progress(self, stage: str, fraction: float) -> None:
        self.progress.setValue(round(1000 * fraction))
        self._say(stage, "report")

    def _done(self, made: Reports) -> None:
        best: Form = next(form for form in ("pdf", "html", "json") if form in made.files)
        self._path = made.files[best]
        QSettings().setValue(_FOLDER, str(self._path.parent.parent))
        names = ", ".join(path.name for path in made.files.values())
        text = self.tr("Wrote {names} in {folder}.").format(names=names, folder=self._path.parent)
        said = "\n".join([text, *(spoken(warning) for warning in made.warnings)])
        self._say(said, "stale" if made.warnings else "passed")
        self.written.emit(self._path)
        self.open_result()

    def _failed(self, error: Exception) -> None:
        if isinstance(error, GeofitError):
            text = spoken(str(error))
        elif isinstance(error, OSError):
            text = self.tr("{reason}. Check that the folder can be written, and that no other program has the file "
                           "open.").format(reason=error)  # fmt: skip
        else:
            text = self.tr("This is a mistake in geofit, not in your data; please report it: {error}").format(
                error=f"{type(error).__name__}: {error}"
            )
        self._say(text, "failed")

    def _rested(self) -> None:
        self._task = None
        self._refresh()

    def _cancel(self) -> None:
        if self._task is not None:
            self._task.cancel()

    def _say(self, text: str, mark: str) -> None:
        self.message.setText(text)
        self.sign.setPixmap(icon(mark).pixmap(16))

    def _refresh(self) -> None:
        """Enable what can be done."""
        running = self._task is not None
        for field in self._fields:
            field.setEnabled(not running)
        self.write.setVisible(not running)
        self.write.setEnabled(bool(self._chosen()) and bool(self.folder.text().strip()))
        self.stop.setVisible(running)
        self.progress.setVisible(running)
        self.view.setVisible(self._path is not None and not running)

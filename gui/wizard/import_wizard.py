"""The import wizard: files to a site, with nothing guessed in silence and nothing dropped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QStandardPaths, Qt
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QProgressBar,
    QPushButton,
    QSplitter,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.errors import GeofitError
from geofit.gui.panels.marks import icon
from geofit.gui.wizard.draft import Draft, drafts_of, free_name, read_again
from geofit.gui.wizard.memory import Memory
from geofit.gui.wizard.result_page import ResultPage
from geofit.gui.wizard.table_page import TablePage
from geofit.gui.wizard.words import kind_name
from geofit.gui.words import spoken
from geofit.gui.worker import Task, run
from geofit.importing import Import, import_files
from geofit.io.mapping import ColumnMapping
from geofit.io.source import Source
from geofit.progress import Progress

__all__ = ["ImportWizard", "memory_file"]


class ImportWizard(QDialog):
    """Asks what the tables of some files hold, imports them, and shows what came of it.

    Accepted, ``site_file`` is the site that was written into ``folder``. Files may be dropped on it.
    """

    def __init__(self, files: Sequence[Path], folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Import"))
        self.setAcceptDrops(True)
        self.site_file = free_name(folder)
        self._memory = Memory(memory_file())
        self._drafts: list[Draft] = []
        self._found: Import | None = None
        self._task: Task | None = None
        self.list = QListWidget()
        self.list.setAccessibleName(self.tr("Tables"))
        self.list.currentRowChanged.connect(self._show_table)
        self.page, self.results = TablePage(), ResultPage()
        self.page.role_changed.connect(self._set_role)
        self.page.reading_changed.connect(self._read_again)
        add, remove = QPushButton(self.tr("&Add files…")), QPushButton(self.tr("Re&move"))
        add.clicked.connect(self._ask_files)
        remove.clicked.connect(self._remove)
        self.crs = QLineEdit()
        self.crs.setPlaceholderText("EPSG:4547")
        self.crs.setToolTip(self.tr("Coordinate system of the site. Longitude and latitude are projected to it."))
        self.target = QLineEdit(str(self.site_file))
        self.message = QLabel()
        self.message.setWordWrap(True)
        self.progress = QProgressBar()
        self.progress.setMaximum(100)
        self.progress.hide()
        self.back = QPushButton(self.tr("&Back"))
        self.forward = QPushButton()
        self.forward.setDefault(True)
        self.back.clicked.connect(self._go_back)
        self.forward.clicked.connect(self._go_on)
        cancel = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        cancel.rejected.connect(self.reject)

        left = QWidget()
        tables = QVBoxLayout(left)
        tables.setContentsMargins(0, 0, 0, 0)
        tables.addWidget(self.list, 1)
        row = QHBoxLayout()
        row.addWidget(add)
        row.addWidget(remove)
        tables.addLayout(row)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.addWidget(left)
        split.addWidget(self.page)
        split.setStretchFactor(1, 1)
        split.setSizes([260, 740])
        first = QWidget()
        form = QFormLayout()
        form.addRow(self.tr("Coordinate &system"), self.crs)
        form.addRow(self.tr("Site &file"), self.target)
        box = QVBoxLayout(first)
        box.setContentsMargins(0, 0, 0, 0)
        box.addWidget(split, 1)
        box.addLayout(form)
        self.pages = QStackedWidget()
        self.pages.addWidget(first)
        self.pages.addWidget(self.results)
        foot = QHBoxLayout()
        foot.addWidget(self.message, 1)
        foot.addWidget(self.progress)
        foot.addWidget(self.back)
        foot.addWidget(self.forward)
        foot.addWidget(cancel)
        layout = QVBoxLayout(self)
        layout.addWidget(self.pages, 1)
        layout.addLayout(foot)
        self.resize(1060, 640)
        self._refresh()
        self.add_files(files)

    def add_files(self, files: Sequence[Path]) -> None:
        """Preview more files; those that are there already are not taken twice."""
        known = {draft.source.path for draft in self._drafts}
        new = [file for file in map(Path, files) if file not in known]
        if new:
            self._work(drafts_of, new, self._memory.recall(), on_done=self._added)

    def drafts(self) -> tuple[Draft, ...]:
        """Return the tables as they stand."""
        return tuple(self._drafts)

    def reject(self) -> None:
        """Stop what runs, and close."""
        if self._task is not None:
            self._task.cancel()
        super().reject()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop what runs."""
        if self._task is not None:
            self._task.cancel()
        super().closeEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Take files."""
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Preview the dropped files."""
        self.add_files([Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()])

    def _added(self, drafts: tuple[Draft, ...]) -> None:
        first = not self._drafts
        self._drafts += drafts
        self._list()
        if first and self._drafts:
            wanting = [
                k for k, draft in enumerate(self._drafts) if not draft.kind or draft.missing(ground=self._ground)
            ]
            self.list.setCurrentRow(wanting[0] if wanting else 0)

    @property
    def _ground(self) -> bool:
        return any(draft.kind == "ground" for draft in self._drafts)

    def _unsettled(self, draft: Draft) -> bool:
        return not draft.kind or bool(draft.missing(ground=self._ground))

    def _list(self) -> None:
        """Write the list of tables anew, the current one kept."""
        current = max(self.list.currentRow(), 0)
        self.list.blockSignals(True)
        self.list.clear()
        for draft in self._drafts:
            sound = draft.used and not self._unsettled(draft)
            mark = "passed" if sound else "none" if draft.kind == "skip" else "failed"
            item = QListWidgetItem(icon(mark), f"{draft.title}\n{kind_name(draft.kind)}")
            item.setToolTip(str(draft.source.path))
            self.list.addItem(item)
        self.list.setCurrentRow(min(current, len(self._drafts) - 1))
        self.list.blockSignals(False)
        self._show_table(self.list.currentRow())
        self._refresh()

    def _show_table(self, row: int) -> None:
        if 0 <= row < len(self._drafts):
            self.page.show_draft(self._drafts[row], ground=self._ground)
        self.page.setEnabled(0 <= row < len(self._drafts))

    def _set_role(self, column: int, role: str) -> None:
        row = self.list.currentRow()
        self._drafts[row] = self._drafts[row].with_role(column, role)
        self._list()

    def _read_again(self, source: Source, kind: str) -> None:
        row = self.list.currentRow()

        def put(draft: Draft) -> None:
            self._drafts[row] = draft
            self._list()

        self._work(read_again, self._drafts[row], source, kind, on_done=put, on_failed=self._refused)

    def _refused(self, error: Exception) -> None:
        self._list()  # the boxes show again what the draft holds
        self._failed(error)

    def _remove(self) -> None:
        row = self.list.currentRow()
        if 0 <= row < len(self._drafts):
            del self._drafts[row]
            self._list()

    def _ask_files(self) -> None:
        names, _ = QFileDialog.getOpenFileNames(self, self.tr("Add files"), str(self.site_file.parent))
        self.add_files([Path(name) for name in names])

    def _go_back(self) -> None:
        self.pages.setCurrentIndex(0)
        self._refresh()

    def _go_on(self) -> None:
        if self.pages.currentIndex() == 1:
            self.accept()
            return
        self.site_file = Path(self.target.text()).expanduser()
        if self.site_file.suffix != ".toml":
            self.site_file = self.site_file.with_suffix(".toml")
        files = list(dict.fromkeys(draft.source.path for draft in self._drafts))
        mappings = tuple(draft.mapping for draft in self._drafts)
        self._work(_import, files, self.site_file, mappings, self.crs.text().strip(), on_done=self._imported)

    def _imported(self, found: Import) -> None:
        self._found = found
        self._memory.keep(self._drafts)
        self.results.show_import(found)
        self.pages.setCurrentIndex(1)
        self._refresh()

    def _work(
        self,
        function: Callable[..., Any],
        *args: Any,
        on_done: Callable[[Any], object],
        on_failed: Callable[[Exception], object] | None = None,
    ) -> None:
        if self._task is not None:
            return
        self.progress.setValue(0)
        self.progress.show()
        self._task = run(
            self,
            function,
            *args,
            on_done=on_done,
            on_failed=on_failed or self._failed,
            on_progress=lambda _, share: self.progress.setValue(round(100 * share)),
            title=self.tr("Import"),
        )
        self._task.ended.connect(self._rested)
        self._refresh()

    def _rested(self) -> None:
        self._task = None
        self.progress.hide()
        self._refresh(keep=True)

    def _failed(self, error: Exception) -> None:
        self.message.setText(
            spoken(str(error)) if isinstance(error, GeofitError) else f"{type(error).__name__}: {error}"
        )

    def _refresh(self, *, keep: bool = False) -> None:
        """Enable what can be done, and say what is still needed."""
        second, idle = self.pages.currentIndex() == 1, self._task is None
        self.back.setEnabled(second and idle)
        self.forward.setText(self.tr("&Open site") if second else self.tr("&Read"))
        wanting = [draft for draft in self._drafts if self._unsettled(draft)]
        if second:
            ready = self._found is not None and bool(self._found.site.horizons)
        else:
            ready = any(draft.used for draft in self._drafts) and not wanting
        self.forward.setEnabled(ready and idle)
        if keep and self.message.text():
            return
        if second or ready:
            self.message.setText("")
        elif wanting:
            names = ", ".join(draft.title for draft in wanting)
            self.message.setText(self.tr("To be settled: {names}").format(names=names))
        elif not self._drafts and idle:
            self.message.setText(self.tr("Add files, or drop them here."))


def _import(
    files: list[Path], site_file: Path, mappings: tuple[ColumnMapping, ...], crs: str, *, progress: Progress
) -> Import:
    return import_files(files, site_file, mappings=mappings, crs=crs, progress=progress)


def memory_file() -> Path:
    """Return where the mappings of former imports are kept."""
    folder = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.AppDataLocation)
    return Path(folder) / "mappings.json"

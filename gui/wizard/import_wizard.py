"""The import wizard: files to a site, with nothing guessed in silence and nothing dropped."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import QSize, QStandardPaths, Qt
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSplitter,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.dialogs.task_dialog import TaskDialog
from geofit.gui.panels.marks import icon
from geofit.gui.save_file import ask_save_file
from geofit.gui.translate import user_language
from geofit.gui.wizard.draft import Draft, drafts_of, free_name, preview_again
from geofit.gui.wizard.horizon_page import BuiltHorizon, HorizonPage
from geofit.gui.wizard.memory import Memory
from geofit.gui.wizard.result_page import ResultPage
from geofit.gui.wizard.table_page import TablePage
from geofit.gui.wizard.words import kind_name
from geofit.io.source import Source
from geofit.project.importing import Import, import_files

__all__ = ["ImportWizard", "memory_file"]

#: Tables that are named where many are to be resolved.
NAMED = 4


class ImportWizard(TaskDialog):
    """Asks what the tables of some files hold, imports them, and shows what came of it.

    Accepted, ``site_file`` is the site that was written into ``folder``, and ``built`` are the horizons to add to it;
    left, none of it stays. Files may be dropped on it.
    """

    def __init__(self, files: Sequence[Path], folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent, leave=QDialogButtonBox.StandardButton.Cancel)
        self.setWindowTitle(self.tr("Import"))
        self.setAcceptDrops(True)
        self.site_file = free_name(folder)
        self._memory = Memory(memory_file())
        self._drafts: list[Draft] = []
        self.found: Import | None = None
        #: Files that this wizard wrote where there were none.
        self._made: set[Path] = set()
        self.list = QListWidget()
        self.list.setAccessibleName(self.tr("Tables"))
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.list.currentRowChanged.connect(self._show_table)
        self.page, self.results = TablePage(), ResultPage()
        self.page.role_changed.connect(self._set_role)
        self.page.reading_changed.connect(self._read_again)
        self.page.exchange_requested.connect(self._exchange)
        self.crs = QLineEdit()
        self.crs.setPlaceholderText(self.tr("Optional, for example EPSG:4547"))
        self.crs.setToolTip(self.tr("Coordinate system of the site. Longitude and latitude are projected to it."))
        self.target = QLineEdit(str(self.site_file))
        self.target.textChanged.connect(self._hint)
        self.back = QPushButton(self.tr("&Back"))
        self.back.clicked.connect(self._go_back)
        self.build = QPushButton(self.tr("Build &horizons…"))
        self.build.setToolTip(self.tr("Group codes of the logs to horizons: top or base, which bed, thin beds ignored"))
        self.build.clicked.connect(self._go_build)
        self.horizons: HorizonPage | None = None
        self.go.clicked.connect(self._go_on)
        self.pages = QStackedWidget()
        self.pages.addWidget(self._first_page())
        self.pages.addWidget(self.results)
        self.fields = (self.pages,)
        layout = QVBoxLayout(self)
        layout.addWidget(self.pages, 1)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot(self.back, self.build))
        self.resize(QSize(1060, 700).boundedTo(self.screen().availableSize()))
        self._hint()
        self.refresh()
        self.add_files(files)

    def add_files(self, files: Sequence[Path]) -> None:
        """Preview more files, of a folder all of its own; those that are there already are not taken twice."""
        known = {draft.source.path for draft in self._drafts}
        new = [file for path in files for file in _files_of(Path(path)) if file not in known]
        if new:
            self.begin(
                drafts_of, new, self._memory.recall(), on_done=self._added, on_stopped=self._stopped, in_process=False
            )

    def drafts(self) -> tuple[Draft, ...]:
        """Return the tables as they stand."""
        return tuple(self._drafts)

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        page, idle = self.pages.currentIndex(), not self.running
        self.back.setVisible(page > 0)
        self.back.setEnabled(idle)
        self.build.setVisible(page == 1 and self._logged)
        self.go.setText(self.tr("&Open site") if page else self.tr("&Read"))
        ready = self._sound if page else self._ready
        self.go.setEnabled(ready and idle)

    @property
    def built(self) -> tuple[BuiltHorizon, ...]:
        """The horizons that were built from lithology, in the order in which they were added."""
        return () if self.horizons is None else tuple(self.horizons.built)

    def tell_failure(self, error: Exception) -> None:
        """Say what went wrong; the boxes show again what the table holds."""
        self._list()
        super().tell_failure(error)

    def reject(self) -> None:
        """Stop what runs, take away what was written, and close."""
        super().reject()
        for path in self._made:
            path.unlink(missing_ok=True)
        self._made.clear()

    def done(self, result: int) -> None:
        """Let go of the 3D view."""
        if self.horizons is not None:
            self.horizons.close()
        super().done(result)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Take files, but not while others are looked at."""
        if event.mimeData().hasUrls() and not self.running and self.pages.currentIndex() == 0:
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Preview the dropped files."""
        self.add_files([Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()])

    def _first_page(self) -> QWidget:
        add, self.remove = QPushButton(self.tr("&Add files…")), QPushButton(self.tr("Re&move"))
        add.clicked.connect(self._ask_files)
        self.remove.clicked.connect(self._remove)
        browse = QPushButton(self.tr("Bro&wse…"))
        browse.clicked.connect(self._browse)
        left, first = QWidget(), QWidget()
        tables, row, place = QVBoxLayout(left), QHBoxLayout(), QHBoxLayout()
        tables.setContentsMargins(0, 0, 0, 0)
        tables.addWidget(self.list, 1)
        tables.addLayout(row)
        row.addWidget(add)
        row.addWidget(self.remove)
        place.addWidget(self.target, 1)
        place.addWidget(browse)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.addWidget(left)
        split.addWidget(self.page)
        split.setStretchFactor(1, 1)
        split.setSizes([260, 740])
        form = QFormLayout()
        form.addRow(self.tr("Coordinate s&ystem"), self.crs)
        label = QLabel(self.tr("Site &file"))
        label.setBuddy(self.target)
        form.addRow(label, place)
        box = QVBoxLayout(first)
        box.setContentsMargins(0, 0, 0, 0)
        box.addWidget(split, 1)
        box.addLayout(form)
        return first

    def _added(self, drafts: tuple[Draft, ...]) -> None:
        before = len(self._drafts)
        self._drafts += drafts
        self._list()
        wanting = [k for k, draft in enumerate(self._drafts) if k >= before and (draft.fault or self._unsettled(draft))]
        if wanting or not before:
            self.list.setCurrentRow(wanting[0] if wanting else 0)

    @property
    def _ground(self) -> bool:
        return any(draft.kind == "ground" for draft in self._drafts)

    @property
    def _ready(self) -> bool:
        return any(draft.used for draft in self._drafts) and not any(map(self._unsettled, self._drafts))

    @property
    def _sound(self) -> bool:
        return self.found is not None and bool(self.found.site.horizons or self.built)

    @property
    def _logged(self) -> bool:
        return self.found is not None and any(one.logs for one in self.found.site.boreholes)

    def _unsettled(self, draft: Draft) -> bool:
        return not draft.kind or bool(draft.missing(ground=self._ground))

    def _mark(self, draft: Draft) -> str:
        if self._unsettled(draft):
            return "failed"
        if draft.fault or draft.bad_cells() or draft.exchanged:
            return "warning"
        return "passed" if draft.used else "none"

    def _list(self) -> None:
        """Write the list of tables anew, the current one kept."""
        current = max(self.list.currentRow(), 0)
        self.list.blockSignals(True)
        self.list.clear()
        for draft in self._drafts:
            item = QListWidgetItem(icon(self._mark(draft)), f"{draft.title}\n{kind_name(draft.kind)}")
            item.setToolTip(str(draft.source.path))
            self.list.addItem(item)
        self.list.setCurrentRow(min(current, len(self._drafts) - 1))
        self.list.blockSignals(False)
        self._show_table(self.list.currentRow())
        self._hint()
        self.refresh()

    def _hint(self) -> None:
        """Say what is still needed, or what will be written over."""
        wanting = [draft.title for draft in self._drafts if self._unsettled(draft)]
        target = self._target()
        if self.pages.currentIndex():
            ready = self._made and self._sound
            self.say(self.tr("The site is written. Cancel removes it again.") if ready else "", "passed")
        elif wanting:
            names = ", ".join(wanting[:NAMED]) + (f" … ({len(wanting)})" if len(wanting) > NAMED else "")
            self.say(self.tr("Unresolved: {names}").format(names=names), "failed")
        elif not self._drafts:
            self.say(self.tr("Add files, or drop them here."))
        elif not self._ready:
            self.say(self.tr("Every table is left out: there is nothing to read."))
        elif target.exists() and target not in self._made:
            self.say(self.tr("{name} already exists and will be overwritten.").format(name=target.name), "warning")
        else:
            used = sum(draft.used for draft in self._drafts)
            self.say(self.tr("Ready. Tables that will be read: {count}.").format(count=used), "passed")

    def _show_table(self, row: int) -> None:
        if 0 <= row < len(self._drafts):
            self.page.show_draft(self._drafts[row], ground=self._ground)
        self.page.setEnabled(0 <= row < len(self._drafts))

    def _set_role(self, column: int, role: str) -> None:
        self._put(self._drafts[self.list.currentRow()].with_role(column, role))

    def _exchange(self) -> None:
        self._put(self._drafts[self.list.currentRow()].with_exchanged_axes())

    def _read_again(self, source: Source, kind: str) -> None:
        draft = self._drafts[self.list.currentRow()]
        self.begin(preview_again, draft, source, kind, on_done=self._put, on_stopped=self._stopped, in_process=False)

    def _put(self, draft: Draft) -> None:
        self._drafts[self.list.currentRow()] = draft
        self._list()

    def _remove(self) -> None:
        chosen = {index.row() for index in self.list.selectedIndexes()}
        self._drafts = [draft for row, draft in enumerate(self._drafts) if row not in chosen]
        self._list()

    def _ask_files(self) -> None:
        names, _ = QFileDialog.getOpenFileNames(self, self.tr("Add files"), str(self.site_file.parent))
        self.add_files([Path(name) for name in names])

    def _browse(self) -> None:
        chosen = ask_save_file(self, self.windowTitle(), self.target.text(), self.tr("Site files (*.toml)"))
        if chosen is not None:
            self.target.setText(str(chosen[0]))

    def _target(self) -> Path:
        path = Path(self.target.text().strip()).expanduser()
        return path if path.suffix == ".toml" else path.with_name(f"{path.name}.toml")

    def _go_back(self) -> None:
        self.pages.setCurrentIndex(self.pages.currentIndex() - 1)
        self._hint()
        self.refresh()

    def _go_build(self) -> None:
        """Show the builder; what was built of the same import is still there."""
        assert self.found is not None
        if self.horizons is None:
            self.horizons = HorizonPage(self.found.site, self)
            self.horizons.changed.connect(self._hint)
            self.horizons.changed.connect(self.refresh)
            self.pages.addWidget(self.horizons)
            self.put_foot_last()
        self.pages.setCurrentWidget(self.horizons)
        self._hint()
        self.refresh()

    def _forget_built(self) -> None:
        """Another import has other logs: begin building anew."""
        if self.horizons is not None:
            self.pages.removeWidget(self.horizons)
            self.horizons.close()
            self.horizons.deleteLater()
            self.horizons = None

    def _go_on(self) -> None:
        if self.pages.currentIndex():
            self._made.clear()
            self.accept()
            return
        self.site_file = self._target()
        files = list(dict.fromkeys(draft.source.path for draft in self._drafts if draft.source.path.exists()))
        mappings = tuple(draft.mapping for draft in self._drafts)
        work = partial(import_files, mappings=mappings, crs=self.crs.text().strip(), language=user_language())
        self.say(self.tr("Reading the files…"))
        self.begin(
            work, files, self.site_file, in_process=False,
            on_done=partial(self._imported, self.site_file.exists()), on_stopped=self._stopped,
        )  # fmt: skip

    def _imported(self, was_there: bool, found: Import) -> None:
        self.found = found
        self._forget_built()
        if not was_there:
            self._made |= {found.site_file, found.mapping_file, found.issue_file}
        self._memory.keep(self._drafts)
        self.results.show_import(found)
        self.pages.setCurrentIndex(1)
        self._hint()

    def _stopped(self) -> None:
        self._list()
        self.say(self.tr("Stopped."))


def _files_of(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return sorted(file for file in path.iterdir() if file.is_file() and not file.name.startswith("."))


def memory_file() -> Path:
    """Return where the mappings of former imports are kept."""
    folder = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.AppDataLocation)
    return Path(folder) / "mappings.json"

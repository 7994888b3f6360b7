"""What is in the middle before a site is open: the sample site, recent files, and a place to drop files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDropEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from geofit import __version__
from geofit.data.errors import GeofitError
from geofit.data.messages import message
from geofit.gui.icons import application_icon, palette_icon
from geofit.io.project import is_project
from geofit.io.survey_kinds import is_survey

__all__ = ["StartPage"]


class StartPage(QWidget):
    """The first page.

    Signals: ``sample_requested()``, ``open_requested()``, ``import_requested(list of Path)`` (empty: ask for files),
    ``file_chosen(Path)``, ``refused(exception)`` where what was dropped together does not belong together.
    """

    sample_requested = Signal()
    open_requested = Signal()
    import_requested = Signal(object)
    file_chosen = Signal(object)
    refused = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAcceptDrops(True)
        self.sample = self._button(self.tr("Open &sample site"), "fit", self.tr("A fictional dam site to try"))
        self.open = self._button(self.tr("&Open project or site…"), "open", self.tr("*.geofit or site.toml"))
        self.new = self._button(self.tr("&New site from files…"), "import", self.tr("CSV, XLSX, DXF, AGS, LAS, grids"))
        self.sample.setDefault(True)
        self.sample.clicked.connect(self.sample_requested)
        self.open.clicked.connect(self.open_requested)
        self.new.clicked.connect(lambda: self.import_requested.emit([]))
        self.recent = QListWidget()
        self.recent.setAccessibleName(self.tr("Recent files"))
        self.recent.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.recent.setFrameShape(QFrame.Shape.StyledPanel)
        self.recent.setMinimumHeight(140)
        self.recent.itemActivated.connect(self._choose)
        self.recent.itemClicked.connect(self._choose)
        self._none = QLabel(self.tr("Projects that you open will be listed here."))
        self._none.setEnabled(False)
        self._drop = _DropField(self.tr("Drop tables, drawings, grids, a survey or a project here"))

        left = QVBoxLayout()
        left.setSpacing(8)
        left.addWidget(self._heading(self.tr("Start")))
        for button in (self.sample, self.open, self.new):
            left.addWidget(button)
        left.addStretch(1)
        right = QVBoxLayout()
        right.setSpacing(8)
        right.addWidget(self._heading(self.tr("Recent")))
        right.addWidget(self._none)
        right.addWidget(self.recent)
        right.addStretch(1)
        columns = QHBoxLayout()
        columns.setSpacing(32)
        columns.addLayout(left, 2)
        columns.addLayout(right, 3)
        inner = QWidget()
        inner.setMaximumWidth(880)
        page = QVBoxLayout(inner)
        page.setContentsMargins(24, 24, 24, 24)
        page.setSpacing(20)
        page.addStretch(1)
        page.addLayout(self._title())
        page.addLayout(columns)
        page.addWidget(self._drop)
        page.addStretch(2)
        layout = QHBoxLayout(self)
        layout.addStretch(1)
        layout.addWidget(inner, 20)
        layout.addStretch(1)
        self.show_recent(())

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the icons in the colour of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            for button, drawing in ((self.sample, "fit"), (self.open, "open"), (self.new, "import")):
                button.setIcon(palette_icon(drawing))

    def show_recent(self, files: Sequence[Path]) -> None:
        """List recent projects and site files."""
        self.recent.clear()
        for file in files:
            name = file.stem if is_project(file) else file.parent.name
            item = QListWidgetItem(f"{name}\n{file}", self.recent)
            item.setData(Qt.ItemDataRole.UserRole, str(file))
            item.setToolTip(str(file))
        self.recent.setVisible(bool(files))
        self._none.setVisible(not files)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Take files."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()
            self._drop.light_up(True)

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:  # noqa: N802
        """Look as before."""
        self._drop.light_up(False)

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Open a project, a site file or a survey of passages; import anything else."""
        self._drop.light_up(False)
        files = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        event.acceptProposedAction()
        opened = [file for file in files if is_project(file) or file.suffix.lower() == ".toml" or is_survey(file)]
        if opened and len(files) == 1:
            self.file_chosen.emit(files[0])
        elif opened:
            text = message(
                "gui.dropped-together",
                "{name} is opened and not imported, but it was dropped together with other files. Drop it alone; drop "
                "tables to import without it.",
                name=opened[0].name,
            )
            self.refused.emit(GeofitError(text))
        elif files:
            self.import_requested.emit(files)

    def _choose(self, item: QListWidgetItem) -> None:
        self.file_chosen.emit(Path(item.data(Qt.ItemDataRole.UserRole)))

    def _title(self) -> QHBoxLayout:
        mark, words = QLabel(), QLabel("geofit")
        mark.setPixmap(application_icon().pixmap(QSize(56, 56), self.devicePixelRatioF()))
        font = words.font()
        font.setPointSizeF(font.pointSizeF() * 2.2)
        font.setBold(True)
        words.setFont(font)
        what = QLabel(self.tr("NURBS surfaces of geological horizons, with a stated tolerance"))
        version = QLabel(__version__)
        version.setEnabled(False)
        text = QVBoxLayout()
        text.setSpacing(0)
        first = QHBoxLayout()
        first.setSpacing(8)
        first.addWidget(words)
        first.addWidget(version, 0, Qt.AlignmentFlag.AlignBottom)
        first.addStretch(1)
        text.addLayout(first)
        text.addWidget(what)
        row = QHBoxLayout()
        row.setSpacing(16)
        row.addWidget(mark)
        row.addLayout(text, 1)
        return row

    def _heading(self, text: str) -> QLabel:
        label = QLabel(text)
        font = label.font()
        font.setBold(True)
        label.setFont(font)
        return label

    def _button(self, text: str, drawing: str, tip: str) -> QPushButton:
        button = QPushButton(palette_icon(drawing), text)
        button.setIconSize(QSize(24, 24))
        button.setMinimumHeight(42)
        button.setToolTip(tip)
        button.setStyleSheet("text-align: left; padding-left: 12px; padding-right: 12px;")
        button.setSizePolicy(QSizePolicy.Policy.MinimumExpanding, QSizePolicy.Policy.Fixed)
        return button


class _DropField(QLabel):
    """A dashed frame that shows where files may be dropped."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setMinimumHeight(96)
        self.light_up(False)

    def light_up(self, lit: bool) -> None:
        """Show that a drop would be taken."""
        edge = "palette(highlight)" if lit else "palette(mid)"
        self.setStyleSheet(f"border: 2px dashed {edge}; border-radius: 8px;")

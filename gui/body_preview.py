"""The section follows the settings of a body while they change: a coarse fit in a thread, the last wish only."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QTimer

from geofit.bodies.settings import BodySettings
from geofit.gui.panels.section_bodies import SectionBody
from geofit.gui.translate import failure
from geofit.gui.worker import Task, run
from geofit.gui.workspace import Workspace
from geofit.project.body_preview import BodyPreview, preview_body
from geofit.project.body_record import FITTED, BodySource, next_colour
from geofit.project.document import Document

__all__ = ["LivePreview"]

#: Milliseconds for which settings rest before they are tried.
REST = 300


class LivePreview(QObject):
    """Keeps the preview in the section as the panel of bodies is: what differs from the fit is fitted coarsely.

    A change stops the preview under way. Nothing is fitted while the section is not seen; it is when it appears.
    """

    def __init__(self, document: Document, workspace: Workspace, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._panels = document, workspace
        self._wanted: tuple[BodySource, BodySettings] | None = None
        self._task: Task | None = None
        self._rest = QTimer(self, singleShot=True, interval=REST)
        self._rest.timeout.connect(self._begin)
        workspace.bodies.edited.connect(self._edited)
        workspace.section.installEventFilter(self)

    @property
    def idle(self) -> bool:
        """Whether no preview is under way, and none about to begin."""
        return self._task is None and not self._rest.isActive()

    def close(self) -> None:
        """Stop, and listen no more."""
        self._panels.section.removeEventFilter(self)
        self._stop()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Begin when the section appears, if something waits for it."""
        if event.type() == QEvent.Type.Show and self._wanted is not None and self._task is None:
            self._rest.start()
        return super().eventFilter(watched, event)

    def _edited(self, source: BodySource | None, settings: BodySettings | None) -> None:
        wanted = None if source is None or settings is None else (source, settings)
        if wanted == self._wanted:
            return
        self._stop()
        self._wanted = wanted
        if wanted is None:
            self._panels.section.show_preview(None)
        else:
            self._rest.start()

    def _stop(self) -> None:
        self._rest.stop()
        if self._task is not None:
            self._task.cancel()

    def _begin(self) -> None:
        if self._task is not None:
            # It has been told to stop; what is wanted now follows it.
            return
        section, document = self._panels.section, self._document
        if self._wanted is None or not document.is_open or section.data is None or section.visibleRegion().isEmpty():
            return
        wanted = source, settings = self._wanted
        if not isinstance(source, FITTED):
            return
        file = document.site_file
        folder = Path.cwd() if file is None else file.resolve().parent
        self._task = run(
            self, preview_body, source, settings, tuple(document.site.boreholes), folder,
            on_done=lambda found: self._show(wanted, found), on_failed=self._fail, title=self.tr("Preview of the body"),
        )  # fmt: skip
        self._task.ended.connect(lambda: self._ended(wanted))

    def _show(self, wanted: tuple[BodySource, BodySettings], found: BodyPreview) -> None:
        if wanted != self._wanted:
            return
        name = self._panels.bodies.name
        record = self._document.state.bodies.get(name)
        colour = next_colour(self._document.state.bodies) if record is None else record.style.colour
        label = self.tr("Preview: {part} of {whole} contacts").format(part=found.contacts, whole=found.of)
        self._panels.section.show_preview(SectionBody(label, found.mesh, colour, dashed=True))

    def _fail(self, error: Exception) -> None:
        self._panels.section.show_preview(None, failure(error))

    def _ended(self, wanted: tuple[BodySource, BodySettings]) -> None:
        self._task = None
        if self._wanted is not None and self._wanted != wanted:
            self._begin()

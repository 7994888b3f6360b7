"""The session: a document with its undo stack and its journal. All changes of the document pass here."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import Site
from geofit.data.verdict import verdict_of
from geofit.gui.lengths import count_coordinates_in
from geofit.gui.translate import shown_error, translated
from geofit.io.crs import unit_of_grid
from geofit.project.commands import ChangeData, Command, SetSurface
from geofit.project.document import Document
from geofit.project.journal import SessionJournal, Unfinished
from geofit.project.state import State

__all__ = ["Session"]

_LOG = logging.getLogger(__name__)


class Session(QObject):
    """What is worked on, for as long as the application runs; ``folder`` is where journals stand.

    ``recorded(text)`` says each step that was done, undone or done again; the log has it, too.
    """

    recorded = Signal(str)

    def __init__(self, folder: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.document = Document()
        self.stack = QUndoStack(self)
        self.folder = folder
        self._journal: SessionJournal | None = None

    def begin(
        self,
        site: Site,
        site_file: Path | None,
        state: State | None = None,
        project_file: Path | None = None,
        data: Iterable[Site] = (),
    ) -> None:
        """Begin with a site; what was worked on before is over. ``data`` are earlier data that the state names."""
        self.end()
        self.stack.clear()
        count_coordinates_in(unit_of_grid(site.crs))
        self.document.open(site, site_file, state, project_file, data)
        try:
            self._journal = SessionJournal(self.folder, self.document.state, site_file, project_file)
        except OSError as error:
            _LOG.warning(
                message(
                    "gui.log-journal-not-written",
                    "No journal can be written, so a crash would lose unsaved work: {error}",
                    error=shown_error(error),
                )
            )

    def resume(self, unfinished: Unfinished, site: Site) -> int:
        """Do again what a session did that was cut off; return how many steps came back."""
        self.begin(site, unfinished.site_file, unfinished.base, unfinished.project_file, unfinished.data())
        if unfinished.project_file is not None:
            self.saved(unfinished.project_file, unfinished.saved)
        for command in unfinished.commands:
            self.push(command)
        unfinished.taken_over()
        return len(unfinished.commands)

    def push(self, command: Command) -> None:
        """Do a command; DocumentError, and nothing done, if it does not apply."""
        command.on(self.document.state)
        if isinstance(command, ChangeData):
            self._keep_data()
        self.stack.push(_Step(self, command))

    def _keep_data(self) -> None:
        """Keep the data that a command is about to replace where a recovery finds them."""
        name = self.document.state.data
        site = self.document.data(name)
        if self._journal is not None and site is not None:
            try:
                self._journal.keep(name, site)
            except InputError as error:
                _LOG.warning(
                    message(
                        "gui.log-data-not-kept",
                        "The earlier data cannot be stored, so they could not be restored after a crash: {error}",
                        error=shown_error(error),
                    )
                )

    def saved(self, project_file: Path, state: State) -> None:
        """Hear that ``state`` was written to a project file."""
        self.document.saved(project_file, state)
        if self._journal is not None:
            self._journal.saved(project_file, state)

    def end(self) -> None:
        """End the journal: what was unsaved is given up."""
        if self._journal is not None:
            self._journal.end()
            self._journal = None

    def _record(self, command: Command, action: str) -> None:
        self._tell(command, action)
        if self._journal is None:
            return
        try:
            if action == "do":
                self._journal.done(command)
            elif action == "undo":
                self._journal.undone()
            else:
                self._journal.redone()
        except OSError as error:
            self._journal = None
            _LOG.warning(
                message(
                    "gui.log-journal-lost",
                    "The journal cannot be written any more, so that a crash would lose unsaved work: {error}",
                    error=shown_error(error),
                )
            )

    def _tell(self, command: Command, action: str) -> None:
        """Log a step, a fit with its figures, and say it."""
        text = command.text
        if action == "undo":
            text = message("gui.log-undone", "Undone: {step}", step=text)
        elif action == "redo":
            text = message("gui.log-redone", "Done again: {step}", step=text)
        elif isinstance(command, SetSurface):
            surface = self.document.surface(command.provenance.horizon)
            if surface is not None and surface.accuracy is not None:
                figures = verdict_of(surface.accuracy).data.text
                text = message("gui.log-fitted", "{step}: {figures}", step=text, figures=figures)
        _LOG.info(text)
        self.recorded.emit(translated(text))


class _Step(QUndoCommand):
    """A command on Qt's undo stack."""

    def __init__(self, session: Session, command: Command) -> None:
        super().__init__(translated(command.text))
        self._session, self._command, self._action = session, command, "do"

    def redo(self) -> None:
        """Do it, for the first time or again."""
        try:
            self._command.redo(self._session.document)
        finally:
            # Also where a listener failed: push() has tried the command, so the document has changed.
            self._session._record(self._command, self._action)
            self._action = "redo"

    def undo(self) -> None:
        """Take it back."""
        try:
            self._command.undo(self._session.document)
        finally:
            self._session._record(self._command, "undo")

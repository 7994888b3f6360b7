"""The session: a document with its undo stack and its journal. All changes of the document pass here."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.data.site import Site
from geofit.data.verdict import verdict_of
from geofit.gui.lengths import count_coordinates_in
from geofit.gui.translate import shown_error, translated
from geofit.io.crs import unit_of_grid
from geofit.project.commands import ChangeData, Command, SetSurface
from geofit.project.data_change import on_other_data
from geofit.project.document import Document
from geofit.project.journal import SessionJournal, Unfinished
from geofit.project.named_points import Names, excluded_names
from geofit.project.provenance import data_digest
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
        #: Whether the journal could not be written and lacks steps.
        self._stuck = False
        #: Steps of the journal that can be undone and done again.
        self._steps = self._undone = 0
        #: The state that the journal has come to.
        self._recorded = self.document.state

    def begin(
        self,
        site: Site,
        site_file: Path | None,
        state: State | None = None,
        project_file: Path | None = None,
        data: Iterable[Site] = (),
        saved: State | None = None,
        digest: str = "",
    ) -> None:
        """Begin with a site; what was worked on before is over. ``data`` are earlier data that the state names.

        ``saved`` is the state that the files hold, if not ``state``; ``digest`` is the project file's SHA-256.
        """
        self.end()
        self.stack.clear()
        count_coordinates_in(unit_of_grid(site.crs))
        self.document.open(site, site_file, state, project_file, data, saved, digest)
        self._begin_journal(self.document.state if saved is None else saved)

    def resume(self, unfinished: Unfinished, site: Site) -> tuple[int, tuple[Message, ...]]:
        """Do again what a session did that was cut off; return how many steps came back, and what is lost.

        Where files of the site have changed since, the session goes on with what it had come to: its steps name lines
        of the former files, and none of them can be undone.
        """
        same = unfinished.final.data in ("", data_digest(site))
        state, lost = (unfinished.base, ()) if same else on_other_data(unfinished.final, unfinished.names, site)
        self.begin(
            site, unfinished.site_file, state, unfinished.project_file, unfinished.data(), unfinished.saved,
            unfinished.digest,
        )  # fmt: skip
        if same:
            for command in unfinished.commands:
                self.push(command)
        else:
            _LOG.warning(
                message(
                    "gui.log-steps-not-undoable",
                    "Files of the site have changed since: the work came back, but its steps cannot be undone.",
                )
            )
        unfinished.taken_over()
        return len(unfinished.commands), lost

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
        if self._journal is not None and not self._stuck and site is not None:
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

    def saved(self, project_file: Path, state: State, digest: str) -> None:
        """Hear that ``state`` was written to a project file, which has that SHA-256."""
        self.document.saved(project_file, state, digest)
        self._write(lambda journal: journal.saved(project_file, state, digest))
        if self._stuck:
            # The project has what the journal lacks. Another one, if there is room for it now.
            self.end()
            self._begin_journal(state)

    def name_steps(self) -> None:
        """Name the steps in the language of now; windows that show them ask again."""
        for step in map(self.stack.command, range(self.stack.count())):
            if isinstance(step, _Step):
                step.name()

    def end(self) -> None:
        """End the journal: what was unsaved is given up."""
        if self._journal is not None:
            self._journal.end()
            self._journal = None

    def _begin_journal(self, saved: State) -> None:
        """Begin a journal with the document as it is; ``saved`` is the state that its files hold."""
        document = self.document
        self._stuck, self._recorded = False, document.state
        self._steps = self._undone = 0
        try:
            self._journal = SessionJournal(
                self.folder, document.state, document.site_file, document.project_file, saved,
                document.project_digest, excluded_names(document.state, document.read),
            )  # fmt: skip
        except OSError as error:
            _LOG.warning(
                message(
                    "gui.log-journal-not-written",
                    "No journal can be written, so a crash would lose unsaved work: {error}",
                    error=shown_error(error),
                )
            )

    def _write(self, write: Callable[[SessionJournal], None]) -> None:
        """Write to the journal, as long as that is possible."""
        if self._journal is None or self._stuck:
            return
        try:
            write(self._journal)
        except OSError as error:
            # It is kept, and with it its lock: else its steps would be offered as a session that was cut off.
            self._stuck = True
            _LOG.warning(
                message(
                    "gui.log-journal-lost",
                    "The journal cannot be written any more, so that a crash would lose unsaved work: {error}",
                    error=shown_error(error),
                )
            )

    def _record(self, command: Command, action: str) -> None:
        self._tell(command, action)
        names = self._new_names()
        if action == "do":
            self._steps, self._undone = self._steps + 1, 0
            self._write(lambda journal: journal.done(command, names))
        elif action == "undo" and self._steps:
            self._steps, self._undone = self._steps - 1, self._undone + 1
            self._write(lambda journal: journal.undone(names))
        elif action == "redo" and self._undone:
            self._steps, self._undone = self._steps + 1, self._undone - 1
            self._write(lambda journal: journal.redone(names))
        else:
            # The step is older than the journal, which took the place of one that could not be written.
            state = self.document.state
            self._steps = self._undone = 0
            self._write(lambda journal: journal.restarted(state, excluded_names(state, self.document.read)))

    def _new_names(self) -> Names:
        """Return who the points are that were excluded since the last record, or may be called otherwise since."""
        former, state = self._recorded, self.document.state
        self._recorded = state
        if (former.data, former.parts, former.horizons) != (state.data, state.parts, state.horizons):
            return excluded_names(state, self.document.read)
        new = {name: rows - former.excluded.get(name, frozenset()) for name, rows in state.excluded.items()}
        return excluded_names(replace(state, excluded=new), self.document.read)

    def _tell(self, command: Command, action: str) -> None:
        """Log a step, a fit with its figures, and say it."""
        text = command.text
        if action == "undo":
            text = message("gui.log-undone", "Undone: {step}", step=text)
        elif action == "redo":
            text = message("gui.log-redone", "Redone: {step}", step=text)
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

    def name(self) -> None:
        """Say what it does in the language of now."""
        self.setText(translated(self._command.text))

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

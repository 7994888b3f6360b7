"""Opening and saving: sites, projects, sessions that were cut off."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QStandardPaths, Signal
from PySide6.QtWidgets import QDialog, QFileDialog, QMessageBox, QWidget

from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity
from geofit.gui.dialogs.recovery import RecoveryDialog
from geofit.gui.fitting import Fitting
from geofit.gui.preferences import Preferences
from geofit.gui.save_file import ask_save_file
from geofit.gui.session import Session
from geofit.gui.translate import translated
from geofit.io.project import ENDING, Project, is_project
from geofit.io.project_files import sha256_of
from geofit.io.survey_kinds import SURVEY_ENDINGS, is_survey
from geofit.project.body_saving import saved_body
from geofit.project.horizon_edits import HorizonEdit, present_provenance
from geofit.project.journal import Unfinished, unfinished
from geofit.project.provenance import Provenance
from geofit.project.saving import (
    Opened,
    SiteFileGoneError,
    Written,
    earlier_data,
    read_again,
    read_project,
    read_saved_surfaces,
    save_state,
)

if TYPE_CHECKING:
    from geofit.gui.wizard.horizon_page import BuiltHorizon

__all__ = ["Files"]

_LOG = logging.getLogger(__name__)
SURVEYS = " ".join(f"*{ending}" for ending in SURVEY_ENDINGS)
OPENED = f"*{ENDING} *.toml {SURVEYS}"


class Files(QObject):
    """What the File menu does with sites and projects.

    ``reported(text)`` says in the status bar what was done; ``built(name, rule, order)`` comes for each horizon that
    was built while a site was imported, once it is open; ``survey_chosen(path)``: a survey of passages is to be opened,
    which leaves the site as it is; ``work_lost(messages)``: what of the work that was opened did not survive
    that files changed meanwhile; nothing, as a rule.
    """

    reported = Signal(str)
    work_lost = Signal(object)
    built = Signal(str, object, object)
    survey_chosen = Signal(object)

    def __init__(
        self, session: Session, activity: Activity, fitting: Fitting, preferences: Preferences, window: QWidget
    ) -> None:
        super().__init__(window)
        self._session, self._activity, self._fitting = session, activity, fitting
        self._preferences, self._window = preferences, window
        self._document = session.document

    def ask_open(self) -> None:
        """Ask for a project, a site file or a survey, and open it."""
        name, _ = QFileDialog.getOpenFileName(
            self._window,
            self.tr("Open a project, a site file or a survey"),
            self._preferences.folder,
            ";;".join(
                (
                    self.tr("Projects, site files and surveys ({kinds})").format(kinds=OPENED),
                    self.tr("Projects and site files (*.geofit *.toml)"),
                    self.tr("Surveys of passages ({kinds})").format(kinds=SURVEYS),
                    self.tr("All files (*)"),
                )
            ),
        )
        if name:
            self.open(Path(name))

    def open(self, path: Path) -> None:
        """Open a project or a site file, after asking whether to save what is open; or a survey beside it."""
        if is_survey(path):
            self._preferences.folder = str(path.resolve().parent)
            self.survey_chosen.emit(path)
            return
        self.leave(lambda: self._open(path))

    def open_sample(self, folder: Path | None = None) -> None:
        """Open the sample site; it is written into the user's documents if missing."""
        place = folder or Path(documents()) / "geofit sample site"
        self.leave(lambda: self._open_sample(place))

    def import_files(self, files: Sequence[Path]) -> None:
        """Ask for files if none are given, and go through the import wizard."""
        self.leave(lambda: self._import(files))

    def _import(self, files: Sequence[Path]) -> None:
        from geofit.gui.wizard.import_wizard import ImportWizard

        chosen = list(files) or [
            Path(name)
            for name in QFileDialog.getOpenFileNames(
                self._window, self.tr("Files of the new site"), self._preferences.folder
            )[0]
        ]
        if not chosen:
            return
        wizard = ImportWizard(chosen, chosen[0].parent, parent=self._window)
        if wizard.exec() == QDialog.DialogCode.Accepted:
            self._open(wizard.site_file, wizard.built)

    def close(self) -> None:
        """Close the site, after asking whether to save."""
        self.leave(self._close)

    def save(self, then: Callable[[], object] | None = None) -> None:
        """Save the project; ask where if it was never saved. Do what ends it ``then``, if all is saved."""
        if self._document.project_file is None:
            self.save_as(then)
        else:
            self.save_to(self._document.project_file, then)

    def save_as(self, then: Callable[[], object] | None = None) -> None:
        """Ask for a file, and save the project there; ``then`` as in :meth:`save`."""
        site_file = self._document.site_file
        if site_file is None:
            return
        proposed = self._document.project_file or site_file.with_name(f"{site_file.parent.name}{ENDING}")
        chosen = ask_save_file(
            self._window, self.tr("Save the project"), proposed, self.tr("geofit projects (*.geofit)")
        )
        if chosen is not None:
            self.save_to(chosen[0], then)

    def save_to(self, path: Path, then: Callable[[], object] | None = None) -> None:
        """Save the project into a file; ``then`` as in :meth:`save`."""
        document = self._document
        if document.site_file is None or not self._may_replace(path, then):
            return
        state, surfaces = document.state, {}
        for name, provenance in state.provenances.items():
            surface = document.surface(name)
            if surface is not None:
                # The model behind the patches is made again from the provenance; it need not travel.
                surfaces[provenance] = surface.with_(model=None)
        same = path == document.project_file
        title = self.tr("Save {name}").format(name=path.name)
        # Of the site its label, the hashes of its files and the points of excluded rows are enough.
        read = document.read
        horizons = {whole: read.horizons[whole] for name, rows in state.excluded.items() if rows
                    and (whole := document.whole(name)) in read.horizons}  # fmt: skip
        site = Site(read.name, horizons, crs=read.crs, inputs=read.inputs)
        data = {name: earlier for name in earlier_data(state) if (earlier := document.data(name)) is not None}
        bodies = {name: saved_body(result) for name, result in document.made_bodies().items()}
        work = (state, site, document.site_file, path, surfaces, same, data, bodies)
        self._activity.do(title, save_state, *work, on_done=partial(self._saved, then), in_process=bool(surfaces))

    def _may_replace(self, path: Path, then: Callable[[], object] | None) -> bool:
        """Whether a file may be replaced; where another window has saved the project since, that is asked.

        Another name is asked for, and the project saved under it, if the user wants that.
        """
        document = self._document
        if path != document.project_file or not document.project_digest:
            return True
        try:
            if sha256_of(path) == document.project_digest:
                return True
        except OSError:
            return True  # it is gone, or writing it states why it cannot be used
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Warning)
        box.setWindowTitle("geofit")
        box.setText(self.tr("{name} has been saved by another window since it was opened here.").format(name=path.name))
        box.setInformativeText(self.tr("Overwriting it discards the changes of the other window."))
        box.addButton(QMessageBox.StandardButton.Yes).setText(self.tr("&Overwrite"))
        box.addButton(QMessageBox.StandardButton.No).setText(self.tr("Save under &another name…"))
        box.addButton(QMessageBox.StandardButton.Cancel)
        box.setDefaultButton(QMessageBox.StandardButton.No)
        answer = box.exec()
        if answer == QMessageBox.StandardButton.No:
            self.save_as(then)
        return answer == QMessageBox.StandardButton.Yes

    def leave(self, then: Callable[[], object]) -> None:
        """Do what ends the document, after asking whether to save; not at all if the user wants to stay."""
        if not self._document.dirty:
            then()
            return
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("geofit")
        box.setText(self.tr("Save the changes to {name}?").format(name=self._document.state.name))
        box.setInformativeText(self.tr("Unsaved changes will be lost."))
        box.setStandardButtons(
            QMessageBox.StandardButton.Save | QMessageBox.StandardButton.Discard | QMessageBox.StandardButton.Cancel
        )
        box.setDefaultButton(QMessageBox.StandardButton.Save)
        answer = box.exec()
        if answer == QMessageBox.StandardButton.Save:
            self.save(then)
        elif answer == QMessageBox.StandardButton.Discard:
            then()

    def offer_recovery(self, folder: Path) -> bool:
        """Offer sessions that were cut off; True if one is being brought back."""
        sessions = unfinished(folder)
        if not sessions:
            return False
        dialog = RecoveryDialog(sessions, self._window)
        dialog.exec()
        if dialog.discarded:
            for session in sessions:
                session.discard()
        if dialog.chosen is None:
            return False
        self.recover(dialog.chosen)
        return True

    def recover(self, session: Unfinished) -> None:
        """Bring a session back: read its site, do its commands again, make its surfaces again."""
        if session.site_file is None:
            session.discard()
            return
        if not session.site_file.is_file():
            elsewhere = self._ask_site_file(session.base.name, session.site_file)
            if elsewhere is not None:
                self.recover(session.at(elsewhere))
            return
        title = self.tr("Bring back {name}").format(name=session.base.name)
        work = (session.site_file, session.final.added)
        self._activity.do(title, read_again, *work, on_done=lambda site: self._recovered(session, site))

    def _open(self, path: Path, built: Sequence[BuiltHorizon] = (), site_file: Path | None = None) -> None:
        """Open a site or a project; horizons that were built while it was imported are steps that can be undone.

        ``site_file`` is where the site of a project is now, if not where the project names it.
        """

        def opened(found: Site | Opened) -> None:
            self._opened(path, found)
            for one in built:
                self.built.emit(one.name, one.rule, one.order)

        def failed(error: Exception) -> None:
            if isinstance(error, SiteFileGoneError):
                elsewhere = self._ask_site_file(path.name, Path(error.file or ""), path.parent)
                if elsewhere is not None:
                    self._open(path, site_file=elsewhere)
            else:
                self._activity.fail(title, error)

        self._preferences.folder = str(path.parent)
        # What runs is for the site that is left.
        self._activity.cancel()
        title = self.tr("Open {name}").format(name=path.name)
        read = partial(read_project, site_file=site_file) if is_project(path) else _read_site
        self._activity.do(title, read, path, on_done=opened, on_failed=failed)

    def _ask_site_file(self, name: str, gone: Path, start: Path | None = None) -> Path | None:
        """Ask where the site file of a project or a session is now, first at ``start``; None if it is not known."""
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("geofit")
        box.setText(self.tr("The site file of {name} no longer exists: {file}").format(name=name, file=gone))
        box.setInformativeText(self.tr("If it was moved, show where it is now."))
        box.setStandardButtons(QMessageBox.StandardButton.Open | QMessageBox.StandardButton.Cancel)
        if box.exec() != QMessageBox.StandardButton.Open:
            return None
        chosen, _ = QFileDialog.getOpenFileName(
            self._window,
            self.tr("Site file of {name}").format(name=name),
            str(start or self._preferences.folder),
            ";;".join((self.tr("Site files (*.toml)"), self.tr("All files (*)"))),
        )
        return Path(chosen) if chosen else None

    def _open_sample(self, place: Path) -> None:
        self._activity.cancel()
        title = self.tr("Open sample site")
        self._activity.do(title, _read_sample, place, on_done=lambda found: self._opened(*found))

    def _close(self) -> None:
        self._activity.cancel()
        self._session.begin(Site("", {}), None)

    def _recovered(self, session: Unfinished, site: Site) -> None:
        count, lost = self._session.resume(session, site)
        self._fitting.make_missing()
        back = plural_message(
            "gui.steps-brought-back", "Brought back, {count} step.", "Brought back, {count} steps.", count=count
        )
        self._report(back, lost)
        self._list_lost()

    def _report(self, text: Message, lost: tuple[Message, ...]) -> None:
        """Say in the status bar what was done, with the first of what is lost; all of it is shown and logged."""
        self.reported.emit(" · ".join(translated(one) for one in (text, *lost[:1])))
        self.work_lost.emit(lost)

    def _list_lost(self) -> None:
        """Log the surfaces that are not available and cannot be made again."""
        for name in self._document.lost():
            _LOG.warning(
                message(
                    "gui.log-data-changed",
                    "The data of {name} have changed since: its surface cannot be made again as it was. Fit it.",
                    name=Untranslated(name),
                )
            )

    def _opened(self, path: Path, found: Site | Opened) -> None:
        self._preferences.opened(path)
        self._preferences.folder = str(path.resolve().parent)
        lost: tuple[Message, ...] = ()
        if isinstance(found, Site):
            self._session.begin(found, path)
            site = found
        else:
            site, lost = found.site, found.lost
            self._session.begin(site, found.site_file, found.state, path, found.data, found.saved, found.digest)
            if found.moved:
                _LOG.warning(
                    plural_message(
                        "gui.log-exclusions-moved",
                        "{count} excluded point is on another line of its file now; it stays excluded.",
                        "{count} excluded points are on other lines of their files now; they stay excluded.",
                        count=found.moved,
                    )
                )
            for made_from, body in found.bodies.items():
                self._document.put_body(made_from, body)
            for file, what in found.changed.items():
                _LOG.warning(
                    message(
                        "gui.log-file-changed",
                        "{file}: {change} since the project was saved.",
                        file=Untranslated(file),
                        change=what,
                    )
                )
            if found.state.provenances:
                title = self.tr("Read the surfaces of {name}").format(name=path.name)
                blocks_site = self._document.site
                self._activity.do(
                    title,
                    read_saved_surfaces,
                    found.project,
                    path.parent,
                    blocks_site,
                    on_done=partial(self._surfaces_read, found.project, self._document.state.horizons),
                    in_process=True,
                )
        errors, doubts = (sum(issue.severity == word for issue in site.issues) for word in ("error", "warning"))
        horizons = plural_message("gui.horizons-count", "{count} horizon", "{count} horizons", count=len(site.horizons))
        holes = plural_message("gui.holes-count", "{count} hole", "{count} holes", count=len(site.holes))
        rows = plural_message("gui.rows-count", "{count} row", "{count} rows", count=errors)
        warnings = plural_message("gui.warnings-count", "{count} warning", "{count} warnings", count=doubts)
        opened = message(
            "gui.site-opened",
            "{name}: {horizons}, {rows} not used, {warnings}.",
            name=Untranslated(site.name),
            horizons=horizons if site.horizons else holes,
            rows=rows,
            warnings=warnings,
        )
        self._report(opened, lost)
        _LOG.info(
            message(
                "gui.log-opened",
                "Opened {path}: {horizons}, {holes}, {rows} not used, {warnings}",
                path=str(path),
                horizons=horizons,
                holes=holes,
                rows=rows,
                warnings=warnings,
            )
        )

    def _surfaces_read(
        self, project: Project, edits: tuple[HorizonEdit, ...], surfaces: dict[Provenance, HorizonFit]
    ) -> None:
        for result in project.results:
            if result.provenance and Provenance.from_data(result.provenance) not in surfaces:
                _LOG.warning(
                    message(
                        "gui.log-surface-not-read",
                        "The saved surface of {name} could not be read from {file}; it is made again.",
                        name=Untranslated(result.horizon),
                        file=Untranslated(result.surface),
                    )
                )
        # Horizons may have been renamed meanwhile; one that was removed may come back.
        now = {present_provenance(one, edits, self._document.state.horizons) or one: one for one in surfaces}
        for provenance, saved in now.items():
            self._document.put(provenance, surfaces[saved])
        self._fitting.complete([provenance for provenance in now if provenance.horizon in self._document.horizons])
        self._fitting.make_missing()
        self._list_lost()

    def _saved(self, then: Callable[[], object] | None, written: Written) -> None:
        self._session.saved(written.path, written.state, written.digest)
        self._preferences.opened(written.path)
        self._preferences.folder = str(written.path.resolve().parent)
        self.reported.emit(self.tr("Saved {name}.").format(name=written.path.resolve()))
        _LOG.info(message("gui.log-saved", "Saved {path}", path=str(written.path)))
        site_file = self._document.site_file
        if site_file is not None and not site_file.is_file():
            _LOG.warning(
                message(
                    "gui.log-site-file-gone",
                    "The site file {file} no longer exists; the project cannot be opened without it.",
                    file=Untranslated(str(site_file)),
                )
            )
        if then is not None:
            # What was fitted meanwhile is not in the file: that is asked again.
            self.leave(then)


def _read_site(path: Path, *, progress: Progress) -> Site:
    from geofit.project.saving import site_for_work

    return site_for_work(path, progress=progress)


def _read_sample(folder: Path, *, progress: Progress) -> tuple[Path, Site]:
    from geofit.sample import write_site

    site_file = folder / "site.toml"
    if not site_file.is_file():
        tell(progress, "write the sample site", 0.0)
        write_site(folder)
    return site_file, _read_site(site_file, progress=progress)


def documents() -> str:
    return QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)

"""A site that grows: files that were added or have changed, and what moved when the horizons were fitted again."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from geofit.data.messages import Message, message, plural_message
from geofit.data.site import Site
from geofit.gui.activity import Activity, Work
from geofit.gui.file_stamps import Stamp, stamp
from geofit.gui.fitting import Fitting
from geofit.gui.offer_bar import OfferBar
from geofit.gui.session import Session
from geofit.gui.translate import translated
from geofit.gui.view3d.picks import show_picks
from geofit.gui.workspace import Workspace
from geofit.io.contact_rules import ContactRule
from geofit.project.adding import Added, add_files
from geofit.project.comparing import made_comparison
from geofit.project.data_change import arrivals, change_of_data, changed_files
from geofit.project.horizon_builder import RulePicks, horizon_table
from geofit.project.provenance import Provenance
from geofit.project.saving import read_again
from geofit.site.states import Comparison

__all__ = ["Living"]

_LOG = logging.getLogger(__name__)


class Living(QObject):
    """Adds files, offers to reload those that have changed, and compares the fits before and after.

    ``reported(text)`` says in the status bar what was done.
    """

    reported = Signal(str)

    def __init__(
        self, session: Session, activity: Activity, fitting: Fitting, panels: Workspace, bar: OfferBar, window: QWidget
    ) -> None:
        super().__init__(window)
        self._session, self._activity, self._fitting = session, activity, fitting
        self._panels, self._bar, self._window = panels, bar, window
        self._document = session.document
        self._stamps: dict[str, Stamp] = {}
        #: What of the work did not survive the last change of the data, and the data since.
        self._lost: tuple[Message, ...] = ()
        self._lost_since = ""
        #: Whether the panel comes to the front when it is shown next.
        self._revealing = False
        bar.accepted.connect(self.reload)
        panels.changes.compare_requested.connect(self._compare)
        self._document.site_changed.connect(self._on_site)
        self._document.result_changed.connect(self._compare)
        self._on_site()

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._document.site_changed.disconnect(self._on_site)
        self._document.result_changed.disconnect(self._compare)

    def take_over(self, other: Living) -> None:
        """Go on with what another window knows of the last change of the data."""
        self._lost, self._lost_since = other._lost, other._lost_since

    def hear_lost(self, lost: tuple[Message, ...]) -> None:
        """Keep, log and show what of the work did not survive that files changed while it was not open, if anything."""
        self._lost, self._lost_since = lost, self._document.state.data
        for text in lost:
            _LOG.warning(text)
        # The panels of a site that was just opened are not there yet.
        self._revealing = bool(lost)

    def ask_files(self) -> None:
        """Ask for files, and add them to the site."""
        folder = self._document.folder
        names, _ = QFileDialog.getOpenFileNames(
            self._window, self.tr("Files to add to the site"), "" if folder is None else str(folder)
        )
        if names:
            self.add([Path(name) for name in names])

    def add(self, files: Sequence[Path]) -> None:
        """Add files to the site."""

        def work() -> Work:
            document = self._document
            if document.site_file is None:
                return None
            return add_files, (list(files), document.site_file, document.read, document.state.added)

        self._activity.prepare(self.tr("Add data"), work, on_done=self._added)

    def reload(self) -> None:
        """Read the files of the site again."""
        document = self._document
        self._bar.hide()
        if document.site_file is not None:
            work = (document.site_file, document.state.added)
            self._activity.do(self.tr("Read the site again"), read_again, *work, on_done=self._read_again)

    def build_horizon(self) -> None:
        """Ask which codes make a horizon, show the picks, and add it."""
        from geofit.gui.dialogs.horizon_builder import HorizonBuilder

        document = self._document
        dialog = HorizonBuilder(document.read, document.horizons, self._window)
        dialog.form.previewed.connect(self._preview)
        dialog.form.built.connect(self.build)
        dialog.exec()

    def _preview(self, picks: RulePicks | None) -> None:
        """Show picks in the scene, or take them away."""
        show_picks(self._panels.view, self.tr("Preview"), picks)

    def build(self, name: str, rule: ContactRule, order: tuple[str, ...]) -> None:
        """Add a horizon that a rule picks, when its turn comes; the horizons stand in ``order``, the highest first."""
        tables: tuple[str, ...] = ()

        def work() -> Work:
            # Only now: what was built just before is among the tables.
            nonlocal tables
            document = self._document
            if document.site_file is None:
                return None
            added = document.state.added
            tables = (*added, horizon_table(name, rule, document.site_file, document.read, added))
            return read_again, (document.site_file, tables)

        title = self.tr("Build {name}").format(name=name)
        self._activity.prepare(title, work, on_done=lambda site: self._take(site, tables, order))

    def look(self) -> None:
        """Look whether files of the site have changed on the disk, and offer to reload them."""
        document = self._document
        if document.site_file is None or self._activity.busy:
            return
        folder, stamps = document.site_file.parent, self._stamped()
        if stamps == self._stamps:
            return
        self._stamps = stamps
        found = changed_files(document.read, folder)
        changed = [name for name, what in found.items() if what == "changed"]
        if changed:
            offer = plural_message(
                "gui.files-changed",
                "{file} has changed since it was read.",
                "{count} files have changed since they were read, the first {file}.",
                count=len(changed),
                file=changed[0],
            )
            self._bar.offer(translated(offer), self.tr("Reload"))
        else:
            self._bar.hide()
        for name, what in found.items():
            if what == "missing":
                _LOG.warning(message("gui.log-file-missing", "{file} no longer exists.", file=name))

    def _stamped(self) -> dict[str, Stamp]:
        document = self._document
        if document.site_file is None:
            return {}
        folder = document.site_file.parent
        return {name: stamp(folder / name) for name in document.read.inputs}

    def _on_site(self) -> None:
        self._bar.hide()
        self._stamps = self._stamped()
        if self._document.state.data != self._lost_since:
            self._lost = ()

    def _added(self, added: Added) -> None:
        for issue in added.issues:
            _LOG.warning(issue.reason)
        self._take(added.site, added.tables)

    def _read_again(self, site: Site) -> None:
        self._take(site, self._document.state.added)

    def _take(self, site: Site, tables: tuple[str, ...], order: tuple[str, ...] = ()) -> None:
        """Work on with other data; new horizons stand where ``order`` has them, the highest first."""
        document = self._document
        before = set(document.read.horizons)
        change = change_of_data(document.state, document.read, site, tables)
        if order:
            settings = change.command.settings
            names = [*(name for name in order if name in settings), *(name for name in settings if name not in order)]
            ordered = replace(change.command, settings={name: settings[name] for name in names})
            change = replace(change, command=ordered)
        if change.command.data == document.state.data:
            self.reported.emit(self.tr("The data are the same: nothing has changed."))
            return
        document.know(site)
        self._lost, self._lost_since = change.lost, change.command.data
        self._fitting.push(change.command)
        for one in change.arrivals:
            if one.any:
                _LOG.info(one.text)
        for text in change.lost:
            _LOG.warning(text)
        carried = plural_message(
            "gui.exclusions-carried", "{count} exclusion kept.", "{count} exclusions kept.", count=change.carried
        )
        words = [translated(one.text) for one in change.arrivals if one.any]
        if change.carried:
            words.append(translated(carried))
        self.reported.emit(" · ".join(words) or self.tr("The files have changed, but their points have not."))
        # A horizon that is new has nothing to be compared with.
        if change.lost or not words or any(one.any and one.horizon in before for one in change.arrivals):
            self._panels.reveal("changes")

    def show(self) -> None:
        """Show how the chosen horizon moved, or what there is to say before that is known."""
        if self._revealing:
            self._revealing = False
            self._panels.reveal("changes")
        document, panel, name = self._document, self._panels.changes, self._document.selection.horizon
        earlier = None if name is None else document.state.earlier.get(name)
        before = None if earlier is None else document.data(earlier.data)
        if name is None or before is None or earlier is None:
            panel.show_nothing(self._lost)
            return
        # The data have the names of their files.
        whole, before = document.whole(name), document.state.shaped(before)
        came = arrivals(whole, before.horizons[whole], document.read.horizons[whole])
        panel.show_state(
            name, came, self._lost, document.comparison(name), waiting=document.compared_pair(name) is None
        )

    def _compare(self, name: str) -> None:
        if self._document.compared_pair(name) is not None and self._document.comparison(name) is None:
            title = self.tr("Compare {name} with its earlier state").format(name=name)
            self._activity.prepare(title, lambda: self._work(name), on_done=self._compared, in_process=True)

    def _work(self, name: str) -> Work:
        document = self._document
        pair, earlier, after = document.compared_pair(name), document.earlier(name), document.surface(name)
        if pair is None or earlier is None or after is None or document.comparison(name) is not None:
            return None
        _, given, surface = earlier
        found = document.site.horizons[name]
        return made_comparison, (pair, given, surface, after.with_(model=None), found)

    def _compared(self, found: tuple[tuple[Provenance, Provenance], Comparison]) -> None:
        pair, comparison = found
        self._document.put_comparison(pair, comparison)
        for text in (comparison.change.text, comparison.test.text):
            _LOG.info(text)
        self.reported.emit(translated(comparison.test.text))

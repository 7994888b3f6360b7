"""Bodies: fitted, made again, exported. What is long runs in a process of its own; results go to the document."""

from __future__ import annotations

import logging
import os
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from geofit.bodies.settings import BodySettings
from geofit.data.files import file_stems
from geofit.data.messages import Untranslated, message
from geofit.data.stale import stale_warning
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity, Work
from geofit.gui.body_preview import LivePreview
from geofit.gui.body_showing import BodyShowing
from geofit.gui.body_styles import BodyStyles
from geofit.gui.dialogs.step_fields import BodyStepDialog
from geofit.gui.fitting import Fitting
from geofit.gui.panels.body_source import MESH, OTHER, OUTLINES, POINTS
from geofit.gui.preferences import Preferences
from geofit.gui.save_file import ask_save_file, may_replace
from geofit.gui.session import Session
from geofit.gui.showing import Showing
from geofit.gui.source_watch import SourceWatch
from geofit.gui.translate import shown_error, translated
from geofit.gui.workspace import Workspace
from geofit.io.bodies import BODY_ENDINGS
from geofit.project.body_building import BodyResult, made_body, measured_strata
from geofit.project.body_commands import SetBody
from geofit.project.body_export import BLOCK_ENDINGS, TRIANGLE_ENDINGS, BodyExport, export_body
from geofit.project.body_record import (
    BodyProvenance,
    BodyRecord,
    BodySource,
    BodyStyle,
    ClosedMesh,
    Intervals,
    next_colour,
)
from geofit.project.body_saving import largest_difference
from geofit.project.body_sources import outline_layers, site_codes
from geofit.project.horizon_body import needed_horizons
from geofit.project.horizon_edits import HorizonEdit, present_body, present_provenance
from geofit.project.provenance import Provenance
from geofit.project.staleness import dated_body
from geofit.project.step_files import Signed, certificate_of
from geofit.report.digits import volume

__all__ = ["Bodies"]

_LOG = logging.getLogger(__name__)


class Bodies(QObject):
    """What makes bodies. ``reported(text)`` says in the status bar what was done, ``refused(exception)`` why not."""

    reported = Signal(str)
    refused = Signal(object)

    def __init__(
        self, session: Session, activity: Activity, fitting: Fitting, showing: Showing, workspace: Workspace,
        preferences: Preferences, window: QWidget,
    ) -> None:  # fmt: skip
        super().__init__(window)
        self._session, self._activity, self._fitting = session, activity, fitting
        self._document, self._panels, self._preferences, self._window = session.document, workspace, preferences, window
        self.showing = BodyShowing(session.document, workspace, showing, self)
        self.styles = BodyStyles(session.document, fitting, workspace, window)
        self.preview = LivePreview(session.document, workspace, self)
        self.watch = SourceWatch(session.document, activity, self)
        #: Provenances that are being made again, and those that were given up until another site is opened.
        self._pending: set[BodyProvenance] = set()
        self._given_up: set[BodyProvenance] = set()
        self._running = False
        #: From what the horizons are made that the task under way divides a body by.
        self._using: dict[str, Provenance] = {}
        #: How horizons had been renamed, merged and removed when it began.
        self._edits: tuple[HorizonEdit, ...] = ()
        panel = workspace.bodies
        panel.fit_requested.connect(self.fit)
        panel.stop_requested.connect(activity.cancel)
        panel.export_requested.connect(self.ask_export)
        panel.file_wanted.connect(self._ask_file)
        self.styles.export_requested.connect(self.ask_export)
        workspace.body_figures.strata_requested.connect(self._divide)
        activity.progressed.connect(self._progress)
        activity.ended.connect(self._rest)
        self.showing.shown.connect(self._make_missing)
        self._document.site_changed.connect(self._on_site)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self.showing.close()
        self.styles.close()
        self.preview.close()
        self._document.site_changed.disconnect(self._on_site)

    def fit(self, name: str, source: BodySource, settings: BodySettings) -> None:
        """Fit a body, or read it from its file; without a name it is called after its codes or its file."""
        if not name:
            name = " + ".join(source.codes) if isinstance(source, Intervals) else Path(getattr(source, "file", "")).stem
            name = self.free_name(name)
        self.showing.chosen = name
        state = self._document.state
        existed, edits = name in state.bodies, state.horizons
        title = self.tr("Fit body {name}").format(name=name)
        self._activity.prepare(
            title,
            lambda: self._work(name, BodyProvenance(source, settings), existed, edits),
            on_done=lambda done: self._fitted(name, existed, *done),
            in_process=True,
        )

    def free_name(self, name: str) -> str:
        """Return the name, with a number behind it where a body has it already."""
        free, turn = name or "body", 2
        while free in self._document.state.bodies:
            free, turn = f"{name} {turn}", turn + 1
        return free

    def ask_export(self, name: str) -> None:
        """Ask for a file; its ending is the format."""
        result = dated_body(self._document, name)
        if result is None:
            return
        blocks = BLOCK_ENDINGS if result.fitted is not None else ()
        words = {".csv": self.tr("Block model"), ".omf": self.tr("Block model"),
                 ".geoh5": self.tr("Block model"), ".vti": self.tr("Field, VTK")}  # fmt: skip
        others = [f"{words.get(end, self.tr('Triangles'))} (*{end})" for end in (*TRIANGLE_ENDINGS, *blocks)]
        folder = self._document.folder or Path(self._preferences.folder)
        start = folder / file_stems([name])[name]
        title, kinds = self.tr("Export body {name}").format(name=name), ";;".join(["STEP (*.step *.stp)", *others])
        chosen = ask_save_file(self._window, title, start, kinds)
        if chosen is not None:
            target = chosen[0]
            if target.suffix not in (".step", ".stp"):
                self.export(name, target)
                return
            dialog = BodyStepDialog(name, self._document.site, self._window, stale=bool(result.stale))
            if dialog.exec():
                signed = dialog.fields.signed()
                pages = [certificate_of(target)] if signed.certificate else []
                if may_replace(pages, title, self._window):
                    self.export(name, target, signed)

    def export(self, name: str, target: Path, signed: Signed | None = None) -> None:
        """Write a body in the format of a file's ending; ``signed`` is what a STEP file states."""
        result = dated_body(self._document, name)
        if result is not None:
            title = self.tr("Export {name}").format(name=target.name)
            record = self._document.state.bodies.get(name)
            colour = "" if record is None else record.style.colour
            work = (result, name, target, signed, colour)
            done = partial(self._exported, [name] if result.stale else [])
            self._activity.do(title, export_body, *work, on_done=done, in_process=True)

    def read_file(self, kind: str, file: Path) -> None:
        """Take the file of a source into the panel, with the codes or layers that it offers."""
        source, relative = self._panels.bodies.source, self._relative(file)
        if kind not in (OTHER, OUTLINES):
            source.show_file(kind, relative)
            return
        title = self.tr("Read {name}").format(name=file.name)
        offers = site_codes if kind == OTHER else outline_layers
        self._activity.do(title, offers, file, on_done=lambda names: source.show_file(kind, relative, names))

    def _work(self, name: str, wanted: BodyProvenance, existed: bool, edits: tuple[HorizonEdit, ...]) -> Work:
        if self._is_gone(name, existed):
            return None
        self._running = True
        self._panels.bodies.set_running(True)
        now = present_body(wanted, edits, self._document.state.horizons)
        return made_body, self._inputs(name, now.source, now.settings)

    def _is_gone(self, name: str, existed: bool) -> bool:
        """Whether a body that was there is not any more; then what is made for it is discarded, which is said."""
        gone = existed and name not in self._document.state.bodies
        if gone:
            text = message(
                "gui.body-gone-meanwhile",
                "Body {name} was renamed or deleted while it was to be fitted: the result was discarded.",
                name=name,
            )
            _LOG.warning(text)
            self.reported.emit(translated(text))
            self.showing.renew()
        return gone

    def _inputs(self, name: str, source: BodySource, settings: BodySettings) -> tuple[object, ...]:
        document, horizons = self._document, self._horizons()
        folder = document.site_folder or Path.cwd()
        return source, settings, name, document.site.boreholes, folder, horizons, document.site.ground

    def _horizons(self) -> dict[str, HorizonFit]:
        self._using, self._edits = self.showing.horizons(), self._document.state.horizons
        return {name: surface.with_(model=None) for name, surface in self._document.surfaces().items()}

    def _put(self, provenance: BodyProvenance, result: BodyResult) -> None:
        self.showing.divided[provenance] = self._using
        self._document.put_body(provenance, result)

    def _fitted(self, name: str, existed: bool, made: BodyProvenance, result: BodyResult) -> None:
        if self._is_gone(name, existed):
            return
        document, provenance = self._document, self._renamed(made)
        known = document.state.bodies.get(name)
        document.sources.made(provenance, self._using)
        self._put(provenance, result)
        style = BodyStyle(next_colour(document.state.bodies)) if known is None else known.style
        record = BodyRecord(provenance, style)
        if record != known:
            self._fitting.push(SetBody(name, record))
        self.showing.chosen = name
        self.showing.renew()
        verdict = result.verdict
        text = message("gui.log-body-volume", "{name}: {volume}", name=name, volume=volume(result.volume))
        if verdict is not None:
            text = message(
                "gui.log-body-fitted",
                "{name}: {verdict}, {data}, {volume}, violations: {count}",
                name=name,
                verdict=verdict.word,
                data=verdict.data.text,
                volume=volume(result.volume),
                count=len(result.violations),
            )
        _LOG.info(text)
        self.reported.emit(translated(text))

    def _renamed(self, made: BodyProvenance) -> BodyProvenance:
        """Return what the task made as it is called now, and call the horizons that it used so."""
        edits, now = self._edits, self._document.state.horizons
        present = [present_provenance(one, edits, now) for one in self._using.values()]
        self._using = {one.horizon: one for one in present if one is not None}
        self._edits = now
        return present_body(made, edits, now)

    def _make_missing(self) -> None:
        """Make the bodies again that the document wants and has not, or only as its file holds them."""
        for name, record in self._document.state.bodies.items():
            provenance, result = record.provenance, self._document.body(name)
            wanted = result is None or result.origin == "read back"
            if wanted and provenance not in self._pending | self._given_up:
                self._pending.add(provenance)
                self._make_again(name, provenance)

    def _make_again(self, name: str, provenance: BodyProvenance) -> None:
        title = self.tr("Make body {name} again").format(name=name)

        def work() -> Work:
            held = {record.provenance for record in self._document.state.bodies.values()}
            result = self._document.bodies.get(provenance)
            if not self._document.surfaces().keys() >= needed_horizons(provenance.source):
                # They are still being fitted; the next change of the document tries again.
                self._pending.discard(provenance)
                return None
            if provenance not in held or (result is not None and result.origin != "read back"):
                self._pending.discard(provenance)
                return None
            return made_body, self._inputs(name, provenance.source, provenance.settings)

        self._activity.prepare(
            title,
            work,
            on_done=lambda done: self._made_again(name, provenance, *done),
            on_failed=lambda error: self._lost(name, provenance, error),
            in_process=True,
        )

    def _made_again(self, name: str, asked: BodyProvenance, again: BodyProvenance, result: BodyResult) -> None:
        self._pending.discard(asked)
        wanted = present_body(asked, self._edits, self._document.state.horizons)
        made = self._renamed(again)
        self._document.sources.made(made, self._using)
        if made != wanted:
            self._lost(name, wanted, None)
            return
        former = self._document.bodies.get(wanted)
        apart = float("nan") if former is None else largest_difference(former, result)
        self._put(wanted, replace(result, origin="again", difference=apart))

    def _lost(self, name: str, provenance: BodyProvenance, error: Exception | None) -> None:
        """Keep what the project holds of a body whose data have changed, or cannot be read."""
        self._pending.discard(provenance)
        self._given_up.add(provenance)
        if error is None:
            text = message(
                "gui.log-body-data-changed",
                "The data of body {name} have changed since: it cannot be made again as it was. Fit it.",
                name=name,
            )
        else:
            self.showing.lost.add(provenance)
            self.watch.look()
            text = message(
                "gui.log-body-not-made-again",
                "Body {name} cannot be made again: {error}",
                name=name,
                error=shown_error(error),
            )
        _LOG.warning(text)
        self.showing.renew()

    def _divide(self) -> None:
        """Work out the volumes of the shown body between the horizons as they are now."""
        name = self.showing.chosen
        record, result = self._document.state.bodies.get(name), self._document.body(name)
        if record is None or result is None:
            return
        title = self.tr("Divide body {name} by the horizons").format(name=name)
        provenance = record.provenance

        def done(found: BodyResult) -> None:
            left = [one for one in self._using if one not in found.divided_by]
            if left:
                text = message(
                    "gui.log-body-not-covered",
                    "These do not cover all of body {name}: {names}",
                    name=name,
                    names=", ".join(left),
                )
                self.reported.emit(translated(text))
                _LOG.info(text)
            self._put(provenance, found)

        self._activity.prepare(
            title, lambda: (measured_strata, (result, self._horizons())), on_done=done, in_process=True
        )

    def _exported(self, stale: list[str], written: BodyExport) -> None:
        path = str(written.path.resolve())
        _LOG.info(message("gui.log-file-written", "Wrote {file}", file=path))
        pages = [] if written.certificate is None else [str(written.certificate.resolve())]
        text = self.tr("Wrote {names}.").format(names=", ".join([path, *pages]))
        back = written.read_back
        if back is not None:
            failed = [check.text for check in back.checks if check.passed is False]
            checks = "; ".join(map(translated, failed))
            text += " " + (checks or self.tr("Read back: {n} faces, all checks pass.").format(n=back.faces))
            for one in failed:
                place = Untranslated(path)
                _LOG.warning(message("data.sentence-at-place", "{place}: {sentence}", place=place, sentence=one))
            if failed:
                # What the status bar says is gone in seconds.
                self._panels.reveal("log")
        if stale:
            text += " " + translated(stale_warning(stale))
            _LOG.warning(stale_warning(stale))
        self.reported.emit(text)

    def _ask_file(self, kind: str) -> None:
        if kind == MESH:
            file = self.ask_mesh()
            if file is not None:
                self.read_file(kind, file)
            return
        words, kinds = {
            OTHER: (self.tr("Open another site file"), self.tr("Site files (*.toml)")),
            OUTLINES: (
                self.tr("Open outlines on sections"),
                self.tr("Outlines, or a site file with flat drawings (*.dxf *.geojson *.json *.toml)"),
            ),
            POINTS: (self.tr("Open points of a body"), self.tr("Tables of points (*.csv *.txt *.xyz *.xlsx)")),
        }[kind]
        path, _ = QFileDialog.getOpenFileName(
            self._window, words, self._start(), f"{kinds};;{self.tr('All files (*)')}" if kind == POINTS else kinds
        )
        if path:
            self.read_file(kind, Path(path))

    def ask_mesh(self) -> Path | None:
        """Ask for a file with a closed body; None if none is chosen."""
        kinds = self.tr("Bodies ({endings})").format(endings=" ".join(f"*{ending}" for ending in BODY_ENDINGS))
        path, _ = QFileDialog.getOpenFileName(self._window, self.tr("Open a closed body"), self._start(), kinds)
        return Path(path) if path else None

    def _start(self) -> str:
        return str(self._document.folder or self._preferences.folder)

    def take_mesh(self, file: Path, name: str = "") -> None:
        """Take a closed body from a file."""
        self.fit(name, ClosedMesh(self._relative(file)), BodySettings())

    def _relative(self, file: Path) -> str:
        """Return the path from the site's folder, with forward slashes; absolute on another drive of Windows."""
        site = self._document.site_file
        try:
            return Path(os.path.relpath(file, site.resolve().parent)).as_posix() if site else file.as_posix()
        except ValueError:
            return file.as_posix()

    def _progress(self, stage: object, fraction: float) -> None:
        if self._running:
            self._panels.bodies.set_running(True, translated(stage), fraction)  # type: ignore[arg-type]

    def _rest(self) -> None:
        """Everything that ran has ended or was stopped."""
        self._given_up |= self._pending
        self._pending.clear()
        self._running = False
        self._panels.bodies.set_running(False)
        self.showing.renew()

    def _on_site(self) -> None:
        self.watch.forget()
        self._pending.clear()
        self._given_up.clear()

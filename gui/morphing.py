"""Metamorphosis in the window: preview, full grid and table in a process; the slider draws; frames become bodies."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QFileDialog, QInputDialog, QWidget

from geofit.bodies.settings import BodySettings
from geofit.data.errors import GeofitError, MissingDependencyError
from geofit.data.files import file_stems
from geofit.data.messages import gravest_first, message
from geofit.gui.activity import Activity
from geofit.gui.bodies import Bodies
from geofit.gui.dialogs.horizon_bodies import HorizonBodies
from geofit.gui.filming import Filming
from geofit.gui.fitting import Fitting
from geofit.gui.lengths import in_lengths
from geofit.gui.save_file import ask_save_file, may_replace
from geofit.gui.translate import translated
from geofit.gui.worker import Task, run
from geofit.gui.workspace import Workspace
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.body import MorphBody
from geofit.project.body_building import end_shape
from geofit.project.body_commands import SetBody
from geofit.project.body_record import BetweenHorizons, BodyRecord, BodyStyle, next_colour
from geofit.project.document import Document
from geofit.project.morph_run import FRAME_FORMATS, MorphRun, morph_files
from geofit.project.morph_view import (
    MorphView,
    MorphWay,
    export_frames,
    finished,
    frame_as_body,
    frame_body,
    previewed,
)
from geofit.report.film import require_encoder

__all__ = ["Morphing"]

_LOG = logging.getLogger(__name__)
#: Frames that are exported, the kind of film, and pictures of a film of the view.
FRAMES, FILM, PICTURES = 25, "gif", 49


class Morphing(QObject):
    """What the panel of metamorphosis does. ``view`` is the way that is shown, None while there is none.

    ``reported(text)`` says in the status bar what was done, ``refused(exception)`` why something was not.
    """

    reported = Signal(str)
    refused = Signal(object)

    def __init__(
        self, document: Document, activity: Activity, fitting: Fitting, bodies: Bodies, workspace: Workspace,
        window: QWidget,
    ) -> None:  # fmt: skip
        super().__init__(window)
        self._document, self._activity, self._fitting, self._bodies = document, activity, fitting, bodies
        self._panels, self._window = workspace, window
        self.view: MorphView | None = None
        #: The way whose preview or frames are being made.
        self._making: MorphWay | None = None
        self._frame: Task | None = None
        self._wanted: float | None = None
        panel = self._panel = workspace.morph
        panel.run_requested.connect(self.run)
        panel.stop_requested.connect(activity.cancel)
        panel.moved.connect(self.drag)
        panel.rested.connect(self.rest)
        panel.skin_toggled.connect(lambda _: self._show_ends())
        panel.take_requested.connect(self.ask_name)
        panel.export_requested.connect(self.ask_export)
        panel.film_requested.connect(self.ask_film)
        panel.add_requested.connect(self.ask_file)
        panel.horizons_requested.connect(self.ask_horizons)
        for choice in (panel.mode, panel.pace):
            choice.activated.connect(lambda _: self._forget())
        panel.seeds.toggled.connect(lambda _: self._forget())
        activity.ended.connect(self._ended)
        bodies.showing.shown.connect(self._show_bodies)
        document.site_changed.connect(self._on_site)
        self.filming = Filming(workspace.view, activity, self)
        self.filming.written.connect(self._filmed)
        self.filming.ended.connect(self._settle)
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self._draw)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._panel.rest()
        self.filming.ended.disconnect(self._settle)
        self.filming.stop()
        self._later.stop()
        self._document.site_changed.disconnect(self._on_site)

    def take_over(self, other: Morphing) -> None:
        """Go on with the way of another window on the document, where its slider rests."""
        view = self.view = other.view
        self._panel.take_over(other._panel)
        self._show_bodies()
        if view is None:
            return
        tau = other._panel.timeline.tau
        self._show_preview(view, tau)
        if view.full is None:
            self.drag(tau)
        else:
            self._show_full(view)

    @property
    def idle(self) -> bool:
        """Whether the frame that was asked for last is shown."""
        return self._frame is None and not self._later.isActive()

    def run(self) -> None:
        """Join the bodies that are checked: first the preview, which tells what is never reached."""
        panel, state = self._panel, self._document.state
        names = panel.chosen()
        made = self._document.made_bodies()
        known = [name for name in names if name in made]
        if len(known) < 2:
            panel.say(self.tr("Check two bodies that have been made."))
            return
        way = MorphWay(
            tuple(state.bodies[name].provenance for name in known), tuple(known), panel.mode.currentData(),
            panel.pace.currentData(), panel.given_dates(), panel.seeds.isChecked(),
        )  # fmt: skip
        shapes = [end_shape(made[name].body) for name in known]
        if self.view is not None and self.view.way == way and self.view.full is None:
            self._finish(self.view, shapes)
            return
        self._forget()
        self._making = way
        panel.set_running(True)
        title = self.tr("Join {names}").format(names=", ".join(known))
        self._activity.do(
            title, previewed, way, shapes, on_done=lambda view: self._previewed(view, shapes), in_process=True
        )

    def drag(self, tau: float) -> None:
        """Show the preview at a share of the way, once the event is over."""
        self._wanted = tau
        if not self._later.isActive():
            self._later.start()

    def rest(self, tau: float) -> None:
        """Show the frame on the full grid."""
        view = self.view
        if view is None or view.full is None:
            return
        if self._frame is not None:
            self._frame.cancel()
        task = self._frame = run(self, frame_body, view.full, tau, on_done=self._framed, title="")
        task.ended.connect(lambda: self._frame_ended(task))

    def ask_name(self) -> None:
        """Ask what a frame is called as a body."""
        name, given = QInputDialog.getText(
            self._window, self.tr("Take a frame as a body"), self.tr("Name of the body"), text=self._proposed()
        )
        if given and name.strip():
            self.take(name.strip())

    def take(self, name: str) -> None:
        """Take the present frame as a body of the document."""
        view = self.view
        if view is None or view.full is None:
            return
        if name in self._document.state.bodies:
            text = message("gui.body-name-taken", "There is a body '{name}' already: choose another name.", name=name)
            self.refused.emit(GeofitError(text))
            return
        given = [end.given for end in view.way.ends]
        provenance, result = frame_as_body(view, self._panel.timeline.tau, name, given)
        self._document.put_body(provenance, result)
        style = BodyStyle(next_colour(self._document.state.bodies))
        self._fitting.push(SetBody(name, BodyRecord(provenance, style)))
        self._bodies.showing.choose(name)

    def ask_export(self) -> None:
        """Ask for a folder, and write frames, table and film there."""
        start, title, view = str(self._document.folder or ""), self.tr("Export frames"), self.view
        folder = QFileDialog.getExistingDirectory(self._window, title, start)
        if folder and view is not None:
            written = morph_files(Path(folder), _title(view), film=FILM)
            if may_replace(written, title, self._window):
                self.export(Path(folder))

    def export(self, folder: Path, frames: int = FRAMES, film: str | None = FILM) -> None:
        """Write frames, table and film into a folder."""
        view = self.view
        if view is not None and view.full is not None:
            work = (view.full, folder, _title(view), frames, FRAME_FORMATS, film)
            self._activity.do(self.tr("Export frames"), export_frames, *work, on_done=self._exported, in_process=True)

    def ask_film(self) -> None:
        """Ask for a file, and film the way as the view shows it."""
        chosen = ask_save_file(
            self._window, self.tr("Film of the view"),
            (self._document.folder or Path()) / f"{file_stems([self._proposed()])[self._proposed()]}.gif",
            self.tr("GIF (*.gif);;MP4, by the program ffmpeg (*.mp4)"),
        )  # fmt: skip
        if chosen is not None:
            self.film(chosen[0])

    def film(self, path: Path, pictures: int = PICTURES) -> None:
        """Write a film of the way by the view's camera; the slider stays where it is."""
        view = self.view
        if view is None or view.full is None or self.filming.running:
            return
        if path.suffix.casefold() == ".mp4":
            try:
                require_encoder()
            except MissingDependencyError as error:
                self.refused.emit(error)
                return
        self._panel.rest()
        full = view.full

        def show(tau: float) -> str:
            if self.view is not view:
                return ""
            self._show_frame(full.surface(tau), tau)
            kind = self.tr("survey") if tau in full.knots else self.tr("interpolated")
            return f"{self._panel.where.text()} ({kind})"

        title = self.tr("Write {name}").format(name=path.name)
        self.filming.start(path, full.steps(pictures).tolist(), show, title)

    def ask_file(self) -> None:
        """Ask for a closed body, and take it into the document."""
        file = self._bodies.ask_mesh()
        if file is not None:
            self._bodies.take_mesh(file)

    def ask_horizons(self) -> None:
        """Ask which horizons are closed to bodies above a common base, and make those."""
        surfaces = self._document.surfaces()
        if not surfaces:
            self._panel.say(self.tr("No horizon has been fitted yet."))
            return
        lowest = min(float(surface.bounds[0][2]) for surface in surfaces.values())
        dialog = HorizonBodies(tuple(surfaces), lowest, self._window)
        if dialog.exec():
            self.close_horizons(dialog.chosen(), dialog.base())

    def close_horizons(self, names: tuple[str, ...], base: str | float) -> None:
        """Make a body of the document between each of some horizons and a common base."""
        bodies = self._document.state.bodies
        for name in names:
            again = name in bodies and isinstance(bodies[name].provenance.source, BetweenHorizons)
            title = name if again else self._bodies.free_name(name)
            self._bodies.fit(title, BetweenHorizons(name, base), BodySettings())

    def _previewed(self, view: MorphView, shapes: list[Any]) -> None:
        if view.way != self._making:
            return  # one of its bodies has changed since
        self.view, self._making = view, None
        self._show_preview(view, 0.0)
        self.drag(0.0)
        if view.preview.unreached and not view.way.seeds:
            # What is never reached is said before the run: Join again goes on, with or without seeds.
            self._panel.set_running(False)
            return
        self._finish(view, shapes)

    def _show_preview(self, view: MorphView, tau: float) -> None:
        timeline = self._panel.timeline
        timeline.show_ends(view.preview.knots.tolist(), view.way.names, [event.tau for event in view.events])
        timeline.put(tau)
        self._panel.set_ready(True, False)
        self._show_ends()
        self._say(view)

    def _finish(self, view: MorphView, shapes: list[Any]) -> None:
        self._making = view.way
        self._panel.set_running(True)
        title = self.tr("Frames of {names}").format(names=", ".join(view.way.names))
        self._activity.do(title, finished, view, shapes, on_done=self._finished, in_process=True)

    def _finished(self, view: MorphView) -> None:
        if view.way != self._making:
            return
        self.view, self._making = view, None
        self._show_full(view)

    def _ended(self) -> None:
        """Offer Join again; where frames were stopped or failed, state that they are missing."""
        self._panel.set_running(False)
        making, self._making = self._making, None
        if making is not None and self.view is not None:
            self._say(self.view, self.tr("The slider shows the coarse preview: the frames were not made. Press Join."))

    def _show_full(self, view: MorphView) -> None:
        """Show the curves, and the frame on the full grid."""
        rows = view.rows
        self._panel.timeline.show_curves(
            [row.tau for row in rows], [row.volume for row in rows], [float(row.euler) for row in rows]
        )
        self._panel.set_ready(True, True)
        self._say(view)
        self.rest(self._panel.timeline.tau)

    def _say(self, view: MorphView, first: str = "") -> None:
        """Say which parts are never reached and which vanish, and the notes on the full grid; nothing without any."""
        morph, words = view.preview, [first] if first else []
        for parts, text in (
            (morph.unreached, self.tr("Not reached by any front: {n} parts, {volume:.4g} m³.")),
            (morph.vanishing, self.tr("Vanishing without touching the next body: {n} parts, {volume:.4g} m³.")),
        ):
            if parts:
                words.append(text.format(n=len(parts), volume=sum(part.volume for part in parts)))
        if morph.unreached and not view.way.seeds and view.full is None:
            words.append(self.tr("Seed them and press Join, or press Join to go on without."))
        notes = [in_lengths(translated(note)) for note in gravest_first(view.notes)]
        self._panel.say("\n".join(filter(None, (" ".join(words), *notes))))

    def _draw(self) -> None:
        view, tau = self.view, self._wanted
        if view is None or tau is None:
            return
        self._wanted = None
        self._show_frame(view.preview.surface(tau), tau)

    def _framed(self, body: MorphBody) -> None:
        if self.view is not None and abs(body.tau - self._panel.timeline.tau) < 1e-9:
            # A preview of the same place that is still to be drawn would hide it.
            self._wanted = None
            self._show_frame(TriangleMesh(body.overview.vertices + body.origin, body.overview.triangles), body.tau)

    def _frame_ended(self, task: Task) -> None:
        # One that was cancelled may end after the next has begun.
        if self._frame is task:
            self._frame = None

    def _show_frame(self, mesh: TriangleMesh, tau: float) -> None:
        view = self.view
        assert view is not None
        scene = self._panels.view.morph
        if len(mesh.triangles):
            scene.show_frame(self.tr("Between bodies"), mesh, self._colour(view.way.names[0]))
        day = view.preview.date_of(tau)
        when = f"{100 * tau:.0f} %" if day is None else day.isoformat()
        words = self.tr("{when}: {volume} m³, Euler number {euler}, parts: {parts}")
        volume = f"{mesh.volume:,.0f}".replace(",", "\N{NO-BREAK SPACE}")
        self._panel.show_place(words.format(when=when, volume=volume, euler=mesh.euler, parts=mesh.components))

    def _show_ends(self) -> None:
        view, made = self.view, self._document.made_bodies()
        skins = []
        if view is not None and self._panel.skin.isChecked():
            for name in view.way.names:
                if name in made:
                    skins.append((name, self._bodies.showing.mesh(made[name]), self._colour(name)))
        self._panels.view.morph.show_ends(skins)

    def _colour(self, name: str) -> str:
        record = self._document.state.bodies.get(name)
        return "#5d6b7a" if record is None else record.style.colour

    def _proposed(self) -> str:
        assert self.view is not None
        tau = self._panel.timeline.tau
        day = self.view.preview.date_of(tau)
        return f"{'-'.join(self.view.way.names)} {100 * tau:.0f} %" if day is None else day.isoformat()

    def _filmed(self, path: Path) -> None:
        _LOG.info(message("gui.log-file-written", "Wrote {file}", file=str(path.resolve())))
        self.reported.emit(self.tr("Wrote {names}.").format(names=path.resolve()))

    def _settle(self) -> None:
        """Show again the frame where the slider is, after a film."""
        self.rest(self._panel.timeline.tau)

    def _exported(self, done: MorphRun) -> None:
        folder = done.files[0].resolve().parent
        _LOG.info(message("gui.log-file-written", "Wrote {file}", file=str(folder)))
        self.reported.emit(
            self.tr("Wrote {n} files to {folder}. {note}").format(
                n=len(done.files), folder=folder, note=self._panel.note.text()
            )
        )

    def _show_bodies(self) -> None:
        showing = self._bodies.showing
        self._panel.show_bodies([(name, showing.mark(name)) for name in self._document.state.bodies])
        way = self._making if self.view is None else self.view.way
        if way is not None:
            now = self._document.state.bodies
            if any(n not in now or now[n].provenance != p for n, p in zip(way.names, way.ends, strict=True)):
                self._forget()

    def _forget(self) -> None:
        """Let go of the way: something that it was made from is another."""
        self.view, self._making, self._wanted = None, None, None
        self.filming.stop()
        self._panel.rest()
        self._panel.set_ready(False, False)
        self._panel.say("")
        self._panel.show_place("")
        self._panel.timeline.show_ends((), (), ())
        self._panels.view.morph.clear()

    def _on_site(self) -> None:
        self._forget()
        self._panel.show_bodies(())


def _title(view: MorphView) -> str:
    """Return the name of what is exported of a way."""
    return " - ".join(view.way.names)

"""From the document to the panels: bodies in the tree, their panel, the scene, the section and the table of figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from geofit.bodies.violations import Violation
from geofit.data.messages import Message, message
from geofit.gui.panels.bodies import BodyShown
from geofit.gui.panels.marks import level_mark
from geofit.gui.panels.project_tree import TreeBody
from geofit.gui.panels.section_bodies import SectionBody
from geofit.gui.showing import Showing
from geofit.gui.translate import translated
from geofit.gui.workspace import Workspace
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_building import BodyResult, origin_text
from geofit.project.body_record import FITTED, BodyProvenance, BodyRecord
from geofit.project.body_sources import interval_codes
from geofit.project.document import Document
from geofit.project.provenance import Provenance
from geofit.project.staleness import stale_body_causes
from geofit.report.digits import volume

__all__ = ["BodyShowing"]

#: A body farther away than this many times the extent of the site's data is not drawn with them.
FAR = 100.0


class BodyShowing(QObject):
    """Keeps the panels as the bodies of the document are; several changes in one event are shown once.

    ``chosen`` is the body of the panel, "" for a new one. ``shown()`` reports that everything is shown.
    """

    shown = Signal()

    def __init__(self, document: Document, workspace: Workspace, showing: Showing, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._panels, self._showing = document, workspace, showing
        self.chosen = ""
        #: Provenances whose bodies could not be made again.
        self.lost: set[BodyProvenance] = set()
        #: From what the horizons were made between which each body was divided.
        self.divided: dict[BodyProvenance, Mapping[str, Provenance]] = {}
        self._meshes: dict[int, tuple[TriangleMesh, TriangleMesh]] = {}
        self._site = True
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self.now)
        self._ends: list[Callable[[], None]] = []
        for signal, listener in (
            (document.site_changed, self._on_site),
            (document.bodies_changed, self.renew),
            (document.result_changed, self._on_result),
        ):
            signal.connect(listener)  # type: ignore[arg-type]
            self._ends.append(lambda signal=signal, listener=listener: signal.disconnect(listener))  # type: ignore[misc]
        panels = workspace
        panels.bodies.chosen.connect(self.choose)
        panels.tree.body_chosen.connect(self._chosen_in_tree)
        panels.body_figures.violation_chosen.connect(self._go_to)
        panels.view.hole_picked.connect(self._hole_picked)
        self.renew()

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._later.stop()
        for end in self._ends:
            end()
        self._ends.clear()

    def renew(self, *_: object) -> None:
        """Show everything anew, once the event is over."""
        self._later.start()

    def choose(self, name: str) -> None:
        """Show a body in the panel; "" for the form of a new one."""
        self.chosen = name
        self.renew()

    def now(self) -> None:
        """Show what has changed."""
        self._later.stop()
        document, panel = self._document, self._panels.bodies
        if not document.is_open:
            panel.close_site()
            self._panels.body_figures.show_body("", None)
            self._panels.section.show_bodies(())
            return
        if self._site:
            self._site = False
            panel.source.show_own(interval_codes(document.site.boreholes))
            if not document.site.horizons:
                self._panels.reveal("bodies")
        if self.chosen not in document.state.bodies:
            self.chosen = next(iter(document.state.bodies), "") if self.chosen else ""
        self._show_tree()
        self._show_scene()
        record = document.state.bodies.get(self.chosen)
        panel.show_bodies([(name, self._mark(name, one)) for name, one in document.state.bodies.items()])
        panel.show_body(self.chosen, None if record is None else self._shown(self.chosen, record))
        divide = record is not None and self.divided.get(record.provenance, {}) != self.horizons()
        self._panels.body_figures.show_body(self.chosen, document.body(self.chosen), divide)
        self.shown.emit()

    def horizons(self) -> dict[str, Provenance]:
        """Return from what the surfaces are made that are available."""
        known = self._document.state.provenances
        return {name: known[name] for name in self._document.surfaces() if name in known}

    def mesh(self, result: BodyResult) -> TriangleMesh:
        """Return the triangles of a body in map coordinates, made once."""
        known = self._meshes.get(id(result.mesh))
        if known is None or known[0] is not result.mesh:
            made = TriangleMesh(result.mesh.vertices + result.body.origin, result.mesh.triangles)
            known = self._meshes[id(result.mesh)] = (result.mesh, made)
        return known[1]

    def stale(self, name: str) -> bool:
        """Whether a body is known to be older than its data, or could not be made again."""
        return bool(stale_body_causes(self._document, name)) or self._is_lost(name)

    def _is_lost(self, name: str) -> bool:
        return self._document.state.bodies[name].provenance in self.lost

    def _shown(self, name: str, record: BodyRecord) -> BodyShown:
        result = self._document.body(name)
        accuracy, verdict = (None, None) if result is None else (result.accuracy, result.verdict)
        waiting = result is None or (result.origin == "read back" and isinstance(record.provenance.source, FITTED))
        old = self._old(name)
        origin = "" if result is None or result.origin == "fitted" else translated(origin_text(result))
        waiting = waiting and not old
        warnings = () if result is None else (*result.warnings, *self._far(result))
        return BodyShown(
            record.provenance, accuracy, verdict, waiting=waiting, old=old, origin=origin, warnings=warnings
        )

    def _far(self, result: BodyResult) -> tuple[Message, ...]:
        """Return a warning of a body too far from the site to be drawn with it, as one in other units is; else none."""
        known, mesh = self._panels.view.contents.everything(), self.mesh(result).vertices
        if not len(known) or not len(mesh):
            return ()
        low, high = known.min(axis=0), known.max(axis=0)
        reach = float(np.linalg.norm(high - low))
        away = float(np.linalg.norm(np.maximum(0, np.maximum(mesh.min(axis=0) - high, low - mesh.max(axis=0)))))
        if away <= FAR * max(reach, 1.0):
            return ()
        text = message(
            "gui.body-far-from-site",
            "The body lies {away} m from the data of the site, which extend over {reach} m: it is not drawn. "
            "Check the unit and the coordinate system of its file; coordinates are read as metres.",
            away=round(away),
            reach=round(reach),
        )
        return (text.with_severity("warning"),)

    def _old(self, name: str) -> str:
        """Return why a body is to be fitted again, with what has changed; empty: it is not."""
        causes = stale_body_causes(self._document, name)
        if causes:
            text = message(
                "gui.body-data-changed",
                "The data have changed since this body was made: press Fit. Changed: {names}",
                names=tuple(cause.text for cause in causes),
            )
            return translated(text)
        return self.tr("This body could not be made again from its data: press Fit.") if self._is_lost(name) else ""

    def mark(self, name: str) -> str:
        """Return the mark of a body: its colour with its verdict."""
        return self._mark(name, self._document.state.bodies[name])

    def _mark(self, name: str, record: BodyRecord) -> str:
        result = self._document.body(name)
        verdict = None if result is None else result.verdict
        sign = "stale" if self.stale(name) else "" if verdict is None else level_mark(verdict.level)
        return f"body:{record.style.colour}:{sign}"

    def _show_tree(self) -> None:
        rows = []
        for name, record in self._document.state.bodies.items():
            result = self._document.body(name)
            accuracy, verdict = (None, None) if result is None else (result.accuracy, result.verdict)
            words = name
            if result is not None:
                words = f"{name}: {volume(result.volume)}"
            if verdict is not None:
                words += "\n" + translated(verdict.text)
            old = self._old(name)
            if old:
                words += f"\n{old}"
            count = None if accuracy is None else accuracy.n
            rows.append(TreeBody(name, self._mark(name, record), record.style.visible, count, words, bool(old)))
        self._panels.tree.show_bodies(rows)

    def _show_scene(self) -> None:
        scene, bodies = self._panels.view.bodies, []
        for gone in set(scene.names) - set(self._document.state.bodies):
            scene.remove(gone)
        for name, record in self._document.state.bodies.items():
            result, style = self._document.body(name), record.style
            if result is None or self._far(result):
                scene.remove(name)
                continue
            data = None if result.fitted is None else result.fitted.data
            scene.show(name, self.mesh(result), style.colour, style.opacity, style.visible)
            scene.show_data(name, data, style.colour, style.visible)
            if style.visible:
                bodies.append(SectionBody(name, self.mesh(result), style.colour, style.opacity, data))
        used = {id(result.mesh) for result in self._document.made_bodies().values()}
        self._meshes = {key: made for key, made in self._meshes.items() if key in used}
        self._panels.section.show_bodies(bodies)

    def _chosen_in_tree(self, name: str) -> None:
        self.choose(name)
        self._panels.reveal("bodies")

    def _go_to(self, found: Violation) -> None:
        """Look at a place of disagreement, with a ring about it, and find its hole in the tree."""
        if not np.isfinite(found.place).all():
            return
        view = self._panels.view
        view.pointer.surround(np.array(found.place), f"{found.hole} · {translated(found.text)}".lstrip(" ·"))
        view.focus_place(*found.place)
        if found.hole:
            self._panels.tree.choose_hole(found.hole)

    def _hole_picked(self, name: str) -> None:
        if self._panels.body_figures.choose_hole(name):
            self._panels.reveal("body_figures")

    def _on_site(self) -> None:
        self._site, self.chosen = True, ""
        self.lost.clear()
        self.divided.clear()
        self._meshes.clear()
        # A project opens with its first body in the panel.
        self.chosen = next(iter(self._document.state.bodies), "")
        self.renew()

    def _on_result(self, _: str) -> None:
        if self._document.state.bodies:
            self.renew()

"""From the document to the panels: whatever changes there is shown, once an event is over."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import cast

from numpy.typing import ArrayLike
from PySide6.QtCore import QObject, QTimer, Signal

from geofit.data.accuracy import ReadBack
from geofit.data.prediction import Uncertainty
from geofit.data.settings import FitSettings
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.drawing import SurfaceDrawing
from geofit.gui.view3d.drawn import Drawn
from geofit.gui.view3d.sight import Sight
from geofit.gui.workspace import Workspace
from geofit.project.document import Document
from geofit.project.horizon_edits import present_name
from geofit.project.provenance import Provenance
from geofit.project.step_files import StepFile
from geofit.site.order import Order
from geofit.site.throw import FaultCut

__all__ = ["Showing"]

#: Metres on both sides of a section that is shown.
THICKNESS = 50.0


class Showing(QObject):
    """Keeps the panels as the document is. Several changes in one event are shown once.

    ``drawn(horizon)`` signals that the 3D view has a surface. ``busy()`` returns whether something runs, so that
    surfaces may still come.
    """

    drawn = Signal(str)

    def __init__(
        self, document: Document, workspace: Workspace, parent: QObject, busy: Callable[[], bool] = lambda: False
    ) -> None:
        super().__init__(parent)
        self._document, self._panels, self._busy = document, workspace, busy
        self.drawing = SurfaceDrawing(self)
        #: Whether everything is to be shown anew, and whether it is another site; how its horizons were edited before.
        self._site, self._opened, self._edits = False, True, document.state.horizons
        self._points: set[str] = set()
        self._results: set[str] = set()
        self._chosen = self._settings = False
        self.line: ArrayLike | None = None
        self.thickness = THICKNESS
        self.faded = True
        #: What else shows the chosen horizon.
        self.also: list[Callable[[], object]] = []
        self.orders: tuple[Order, ...] = ()
        self.cuts: tuple[FaultCut, ...] = ()
        #: From what the horizons were made that orders and cuts are about.
        self._compared: dict[str, Provenance] = {}
        #: By horizon: the surface that was exported last, and the file that holds it.
        self._exported: dict[str, tuple[HorizonFit, StepFile]] = {}
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self.now)
        workspace.view.sharper_wanted.connect(self._sharpen)
        self._ends: list[Callable[[], None]] = []
        for signal, listener in (
            (document.site_opened, self._on_opened),
            (document.site_changed, self._on_site),
            (document.settings_changed, self._on_settings),
            (document.points_changed, self._on_points),
            (document.result_changed, self._on_result),
            (document.order_changed, self._on_order),
            (document.name_changed, self._on_site_again),
            (document.selection_changed, self._on_selection),
        ):
            signal.connect(listener)  # type: ignore[arg-type]
            self._ends.append(lambda signal=signal, listener=listener: signal.disconnect(listener))  # type: ignore[misc]

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._later.stop()
        self._panels.view.sharper_wanted.disconnect(self._sharpen)
        for end in self._ends:
            end()
        self._ends.clear()

    @property
    def waiting(self) -> bool:
        """Whether surfaces of the project are still being read or made again."""
        return self._busy() and any(self._document.waiting(name) for name in self._document.horizons)

    def renew(self) -> None:
        """Show the chosen horizon anew, once the event is over: what ran has ended."""
        self._chosen = True
        self._later.start()

    def everything(self) -> None:
        """Show the whole document anew."""
        self._on_site()
        self.now()

    def now(self) -> None:
        """Show what has changed since the last time."""
        self._later.stop()
        document, panels = self._document, self._panels
        is_open = document.is_open
        whole = self._site
        if whole:
            panels.show_scene(is_open)
            self.drawing.clear()
            panels.view.clear(keep=not self._opened)
            edits, self._edits, self._opened = self._edits, document.state.horizons, False
            panels.view.layers.rename(lambda name: present_name(name, edits, self._edits))
            if is_open:
                every = {name: document.site.horizons[name] for name in document.horizons}
                panels.view.show_site(replace(document.site_in_use(), horizons=every))
            self._results = set(document.horizons)
        elif self._points:
            self._results |= self._points
        for name in self._results:
            self._show_in_view(name)
        if self._results or whole or self._settings:
            self._show_tree()
        if self._chosen or self._settings or whole or document.selection.horizon in self._results:
            self._show_horizon()
        if self._results or whole or self._points:
            self.show_section()
        self._site = self._chosen = self._settings = False
        self._points, self._results = set(), set()

    def begin_section(self) -> None:
        """Take the line that the section panel shows, if none was drawn yet."""
        if self.line is None:
            self.line = cast("ArrayLike | None", self._panels.section.line)

    def show_section(self) -> None:
        """Show the section along the present line."""
        document = self._document
        site = document.site_in_use() if document.is_open else None
        uncertain = self.uncertainties()
        panel = self._panels.section
        panel.show_section(site, document.surfaces(), self.line, self.thickness, uncertain, faded=self.faded)

    def uncertainties(self) -> dict[str, Uncertainty]:
        """Return the standard deviations of the horizons that were examined."""
        return {
            name: found.uncertainty
            for name in self._document.horizons
            if (found := self._document.prediction(name)) is not None and found.uncertainty is not None
        }

    def set_faded(self, on: bool) -> None:
        """Fade surfaces above the ground and beyond their data, in view and section, or draw them in full."""
        self.faded = on
        self._panels.view.set_faded(on)
        self.show_section()

    def show_orders(self, orders: tuple[Order, ...], compared: Mapping[str, Provenance]) -> None:
        """Show how horizons lie to each other, in the checks; ``compared`` states from what they were made."""
        present = self._document.state.provenances
        same = {name for name, made in compared.items() if present.get(name) == made}
        pairs = [{order.upper, order.lower} for order in orders]
        # A report compares what the site states, Check the order every two.
        kept = [order for order in self.orders if {order.upper, order.lower} not in pairs]
        self.orders = (*kept, *(order for order in orders if {order.upper, order.lower} <= same))
        self._compared = {**self._compared, **compared}
        self._show_tree()
        self._show_horizon()

    def show_cuts(self, cuts: tuple[FaultCut, ...]) -> None:
        """Show how far faults displace horizons, in the checks of their blocks."""
        horizons = {cut.horizon for cut in cuts}
        self.cuts = (*(cut for cut in self.cuts if cut.horizon not in horizons), *cuts)
        self._compared = {**self._compared, **self._document.state.provenances}
        self._show_horizon()

    def take_over(self, other: Showing) -> None:
        """Show what another window on the same document has compared and exported, and its section."""
        self.orders, self.cuts, self._compared = other.orders, other.cuts, other._compared
        self._exported, self.line, self.thickness = other._exported, other.line, other.thickness
        self._on_site_again()
        self.renew()

    def show_exported(self, surfaces: Mapping[str, HorizonFit], files: Sequence[StepFile]) -> None:
        """Show what the reader found in the files of surfaces, for as long as these are the ones."""
        self._exported |= {name: (surfaces[name], file) for file in files for name in file.read_back}
        self._show_tree()
        self._show_horizon()

    def _show_in_view(self, name: str) -> None:
        surface, prediction, view = self._document.surface(name), self._document.prediction(name), self._panels.view
        if name in self._document.site.horizons:
            view.show_listing(name, self._document.listing(name))
        if surface is None:
            self.drawing.forget(name)
            view.remove_surface(name)
            return
        uncertainty = None if prediction is None else prediction.uncertainty

        def show(drawn: Drawn) -> None:
            view.show_surface(surface, uncertainty, drawn)
            view.show_suggestions(name, () if prediction is None else prediction.suggestions)
            self.drawn.emit(name)

        self.drawing.draw(surface, uncertainty, self._document.site.ground, show)

    def _sharpen(self, name: str, sight: Sight) -> None:
        surface, prediction = self._document.surface(name), self._document.prediction(name)
        if surface is not None:
            uncertainty = None if prediction is None else prediction.uncertainty
            show = partial(self._panels.view.sharpen, surface)
            self.drawing.sharpen(surface, uncertainty, self._document.site.ground, sight, show)

    def _show_tree(self) -> None:
        document = self._document
        site = document.site_in_use() if document.is_open else None
        stale = {name for name in document.horizons if document.stale(name)}
        surfaces = document.surfaces()
        verdicts = {name: found for name in surfaces if (found := self.verdict(name)) is not None}
        self._panels.tree.show_site(site, surfaces, stale, verdicts)
        if document.selection.horizon:
            self._panels.tree.choose_horizon(document.selection.horizon)

    def _show_horizon(self) -> None:
        """Show the chosen horizon in every panel that shows one."""
        document, panels, name = self._document, self._panels, self._document.selection.horizon
        known = name is not None and name in document.site.horizons
        surface = document.surface(name) if known and name else None
        prediction = document.prediction(name) if known and name else None
        settings = document.settings(name) if known and name else FitSettings()
        stale = bool(known and name and document.stale(name))
        waiting = bool(known and name and self._busy() and document.waiting(name))
        panels.fit.show_settings(name if known and name else "", settings, stale, self.waiting)
        verdict = self.verdict(name) if known and name else None
        stopped = not waiting and not stale and name in {one.horizon for one in document.missing()}
        panels.verdict.show_accuracy(
            None if surface is None else surface.accuracy, stale, verdict, waiting, stopped=stopped
        )
        panels.residuals.show_surface(surface, document.listing(name) if known and name else None)
        panels.histogram.show_surface(surface)
        panels.seams.show_surface(surface)
        panels.checks.show_surface(
            surface,
            prediction,
            self._orders_of(name),
            None if surface is None or name is None else self._read_back(name, surface),
            tuple(cut for cut in self.cuts if name in (cut.up, cut.down)),
        )
        panels.prediction.show_prediction(
            prediction, None if surface is None else surface.points, fitted=surface is not None
        )
        panels.adjust.show_surface(surface)
        panels.plan.show_surface(document.site_in_use() if known else None, name or "", surface, settings)
        for show in self.also:
            show()
        if waiting:
            self._say_waiting()

    def _say_waiting(self) -> None:
        """Say in every panel of the surface that it is still being read."""
        panels = self._panels
        words = self.tr("The surface of the project is being read.")
        for panel in (
            panels.residuals,
            panels.histogram,
            panels.seams,
            panels.checks,
            panels.prediction,
            panels.adjust,
        ):
            panel.pages.say(words)

    def verdict(self, name: str) -> Verdict | None:
        """Return the verdict on a horizon's surface from all that is known of it; None while it has none."""
        surface = self._document.surface(name)
        if surface is None or surface.accuracy is None:
            return None
        orders = (order.check() for order in self._orders_of(name))
        return verdict_of(surface.accuracy, self._document.prediction(name), self._read_back(name, surface), orders)

    def file_of(self, name: str, surface: HorizonFit) -> StepFile | None:
        """Return the file that was written of this very surface."""
        written, file = self._exported.get(name, (None, None))
        return file if written is surface else None

    def _read_back(self, name: str, surface: HorizonFit) -> ReadBack | None:
        file = self.file_of(name, surface)
        return None if file is None else file.read_back[name]

    def _orders_of(self, name: str | None) -> tuple[Order, ...]:
        return tuple(order for order in self.orders if name in (order.upper, order.lower))

    def _on_opened(self) -> None:
        self._opened, self.line = True, None

    def _on_site(self) -> None:
        self._site = True
        self.orders, self.cuts = (), ()
        self._exported.clear()
        self._later.start()

    def _on_order(self) -> None:
        self.orders = ()
        self._on_site_again()

    def _on_site_again(self) -> None:
        self._results.update(self._document.horizons)
        self._later.start()

    def _on_settings(self, name: str) -> None:
        self._settings = True
        if self._document.surface(name) is not None:
            # Another control error judges the same surface anew.
            self._results.add(name)
        self._later.start()

    def _on_points(self, name: str) -> None:
        self._points.add(name)
        self._later.start()

    def _on_result(self, name: str) -> None:
        self._results.add(name)
        # An examination, or a surface made again, is news of the same surface: what was compared is still so.
        if self._document.state.provenances.get(name) != self._compared.get(name):
            self.orders = tuple(order for order in self.orders if name not in (order.upper, order.lower))
            self.cuts = tuple(cut for cut in self.cuts if name not in (cut.up, cut.down))
        self._later.start()

    def _on_selection(self, _: object) -> None:
        self._chosen = True
        self._later.start()

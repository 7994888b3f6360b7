"""Whether the horizons stand above each other as they should, and what is done where they do not."""

from __future__ import annotations

import logging
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QDialog, QInputDialog, QWidget

from geofit.data.messages import Untranslated, message, plural_message
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity
from geofit.gui.dialogs.order import OrderDialog
from geofit.gui.fitting import Fitting
from geofit.gui.showing import Showing
from geofit.gui.translate import shown_error, translated
from geofit.gui.worker import Task, run_in_process
from geofit.gui.workspace import Workspace
from geofit.project.commands import SeparateHorizons, SetOrder
from geofit.project.document import Document
from geofit.project.ordering import all_orders, comparable, order_not_examined, over_map, separated
from geofit.project.provenance import DocumentError, Provenance
from geofit.site.separate import Separation

__all__ = ["Ordering"]

_LOG = logging.getLogger(__name__)


class Ordering(QObject):
    """Compares every two horizons, and separates them; what is found is in the checks.

    ``reported(text)`` sums it up, ``refused(exception)`` states why nothing was done.
    """

    reported = Signal(str)
    refused = Signal(object)

    def __init__(
        self,
        document: Document,
        activity: Activity,
        fitting: Fitting,
        showing: Showing,
        workspace: Workspace,
        window: QWidget,
    ) -> None:
        super().__init__(window)
        self._document, self._activity, self._fitting = document, activity, fitting
        self._showing, self._panels, self._window = showing, workspace, window
        self._task: Task | None = None
        #: What could not be compared: it is not tried again.
        self._failed: dict[str, Provenance] = {}
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self._compare_stated)
        document.result_changed.connect(self._wake)
        document.order_changed.connect(self._wake)
        activity.ended.connect(self._wake)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._later.stop()
        self._later.timeout.disconnect(self._compare_stated)
        self._document.result_changed.disconnect(self._wake)
        self._document.order_changed.disconnect(self._wake)

    @property
    def idle(self) -> bool:
        """Whether nothing is compared on the side."""
        return self._task is None and not self._later.isActive()

    def edit(self) -> None:
        """Ask for another order of the horizons."""
        dialog = OrderDialog(self._document.horizons, self._window)
        if dialog.exec() == QDialog.DialogCode.Accepted and dialog.order() != self._document.horizons:
            self._fitting.push(SetOrder(dialog.order()))

    def check(self) -> None:
        """Compare the strata available, in the document's order."""
        surfaces, pairs, made = self._comparable()
        if not pairs:
            self.reported.emit(self.tr("Two fitted horizons are needed to check their order."))
            return
        title, ground = self.tr("Check the order"), self._document.site.ground
        done = partial(self._found, made)
        self._activity.do(title, all_orders, surfaces, pairs, ground, on_done=done, in_process=True)

    def _wake(self, *_: object) -> None:
        self._later.start()

    def _compare_stated(self) -> None:
        """Compare the strata of an order that the site states, as a run of the whole site does, where that is missing.

        It counts in the verdict, and runs in the background.
        """
        if self._task is not None or self._activity.busy or not self._document.site.order:
            return
        surfaces, pairs, made = self._comparable()
        if made == self._failed or {(one.upper, one.lower) for one in self._showing.orders} >= set(pairs):
            return
        self._task = run_in_process(
            self,
            all_orders,
            surfaces,
            pairs,
            self._document.site.ground,
            title=self.tr("Check the order"),
            on_done=lambda found: self._showing.show_orders(found, made),
            on_failed=partial(self._give_up, made),
        )
        self._task.ended.connect(self._rest)

    def _give_up(self, made: dict[str, Provenance], error: Exception) -> None:
        self._failed = made
        _LOG.warning(order_not_examined(shown_error(error)))

    def _rest(self) -> None:
        self._task = None
        # A surface may have come meanwhile.
        self._wake()

    def _comparable(self) -> tuple[dict[str, HorizonFit], tuple[tuple[str, str], ...], dict[str, Provenance]]:
        """Return the strata available, which two of them can be compared, and from what they are made."""
        # The model behind the patches is not needed there, and is much to send to another process.
        surfaces = {name: one.with_(model=None) for name, one in self.strata().items()}
        pairs = comparable(tuple(surfaces), self._document.state.parts)
        return surfaces, pairs, {name: self._document.state.provenances[name] for name in surfaces}

    def strata(self) -> dict[str, HorizonFit]:
        """Return the surfaces over the map that are not faults; where the site states an order, those that it names."""
        document, site = self._document, self._document.site
        # Weathering cuts strata. Of a fault nothing lies above or below, also where it is gentle enough for a map.
        known = set(site.order) or {document.whole(name) for name in document.horizons} - set(site.faults)
        over = over_map(document.surfaces())
        return {name: one for name, one in over.items() if document.whole(name) in known}

    def ask_separation(self) -> None:
        """Ask how thick the rock between two horizons is at least, and separate them."""
        minimum, given = QInputDialog.getDouble(
            self._window,
            self.tr("Separate horizons"),
            self.tr("Least thickness between a horizon and the next, metres"),
            0.0, 0.0, 1000.0, 2,
        )  # fmt: skip
        if given:
            self.separate(minimum)

    def separate(self, minimum: float = 0.0) -> None:
        """Push the horizons apart where they cross; exact points stay."""
        parts = self._document.state.parts
        strata = self.strata()
        blocks = [name for name in strata if name in parts]
        if blocks:
            names = ", ".join(blocks)
            _LOG.warning("%s", self.tr("Cut by a fault, so not separated from others: {names}").format(names=names))
        surfaces = {name: one for name, one in strata.items() if name not in parts}
        unready = [name for name, surface in surfaces.items() if surface.model is None]
        if len(surfaces) < 2 or unready:
            text = (
                message(
                    "gui.horizon-not-fitted-here",
                    "'{name}' was read from a file and not fitted here. Fit it again, then separate the horizons.",
                    name=Untranslated(unready[0]),
                )
                if unready
                else message(
                    "gui.two-horizons-needed",
                    "Two fitted horizons are needed to separate them. Press Fit all first.",
                )
            )
            self.refused.emit(DocumentError(text))
            return
        self._activity.do(
            self.tr("Separate horizons"),
            separated,
            surfaces,
            minimum,
            Site("", {}, ground=self._document.site.ground, orientations=self._document.site.orientations),
            on_done=lambda found: self._repaired(surfaces, minimum, found),
            in_process=True,
        )

    def _found(self, made: dict[str, Provenance], orders: tuple[Any, ...]) -> None:
        self._showing.show_orders(orders, made)
        self._panels.reveal("checks")
        crossing = [order for order in orders if order.crossings]
        for order in crossing:
            _LOG.warning(
                plural_message(
                    "gui.log-horizons-cross",
                    "{upper} and {lower} cross at {count} place",
                    "{upper} and {lower} cross at {count} places",
                    count=len(order.crossings),
                    upper=Untranslated(order.upper),
                    lower=Untranslated(order.lower),
                )
            )
        if crossing:
            text = plural_message(
                "gui.pairs-cross",
                "{count} of {total} pairs of horizons crosses; see Checks.",
                "{count} of {total} pairs of horizons cross; see Checks.",
                count=len(crossing),
                total=len(orders),
            )
            self.reported.emit(translated(text))
        else:
            self.reported.emit(self.tr("No two horizons cross."))

    def _repaired(self, former: dict[str, HorizonFit], minimum: float, found: Separation) -> None:
        document = self._document
        if any(document.surface(name) is not surface for name, surface in former.items()):
            self.refused.emit(
                DocumentError(
                    message(
                        "gui.surface-changed-meanwhile",
                        "A surface has changed since the horizons were separated. Separate them again.",
                    )
                )
            )
            return
        for one in found.contradictions:
            _LOG.warning(one.text)
        if found.contradictions:
            self._panels.reveal("log")
        if not found.moved:
            self.reported.emit(self.tr("No horizon had to move."))
            return
        command = SeparateHorizons(tuple(found.moved), tuple(former), minimum)
        for name, provenance in command.provenances(document.state).items():
            document.put(provenance, found.surfaces[name])
        self._fitting.push(command)
        moved = ", ".join(f"{name} {by:.2f} m" for name, by in found.moved.items())
        self.reported.emit(
            self.tr("Largest moves: {moved}. Contradictions that remain: {count}.").format(
                moved=moved, count=len(found.contradictions)
            )
        )

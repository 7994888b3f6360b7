"""Whether the horizons stand above each other as they should."""

from __future__ import annotations

import logging
from typing import Any

from PySide6.QtCore import QObject, Signal

from geofit.gui.activity import Activity
from geofit.gui.document.document import Document
from geofit.gui.document.ordering import all_orders
from geofit.gui.showing import Showing
from geofit.gui.workspace import Workspace

__all__ = ["Ordering"]

_LOG = logging.getLogger(__name__)


class Ordering(QObject):
    """Compares every two horizons; what it finds stands in the checks. ``told(text)`` sums it up."""

    told = Signal(str)

    def __init__(
        self, document: Document, activity: Activity, showing: Showing, workspace: Workspace, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._document, self._activity = document, activity
        self._showing, self._panels = showing, workspace

    def check(self) -> None:
        """Compare the surfaces at hand, in the document's order."""
        # What stands behind the patches is not needed there, and is much to send to another process.
        surfaces = {name: surface.with_(model=None) for name, surface in self._document.surfaces().items()}
        if len(surfaces) < 2:
            self.told.emit(self.tr("Two fitted horizons are needed to check their order."))
            return
        title = self.tr("Check the order")
        self._activity.do(title, all_orders, surfaces, self._document.site.ground, on_done=self._found, apart=True)

    def _found(self, orders: tuple[Any, ...]) -> None:
        self._showing.show_orders(orders)
        self._panels.reveal("checks")
        crossing = [order for order in orders if order.crossings]
        for order in crossing:
            _LOG.warning("%s and %s cross at %d places", order.upper, order.lower, len(order.crossings))
        if crossing:
            text = self.tr("{count} of {all} pairs of horizons cross; see Checks.")
            self.told.emit(text.format(count=len(crossing), all=len(orders)))
        else:
            self.told.emit(self.tr("No two horizons cross."))

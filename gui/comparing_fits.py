"""Comparing two fits of the chosen horizon: which are available, the dialog, and the one that is taken."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QWidget

from geofit.gui.dialogs.compare_fits import CompareDialog, ShownFit
from geofit.gui.fitting import Fitting
from geofit.project.document import Document
from geofit.project.fit_command import TakeFit
from geofit.project.provenance import Provenance

__all__ = ["ComparingFits"]


class ComparingFits(QObject):
    """Opens the dialog for a horizon that was fitted twice; ``reported(text)`` says where there is nothing to compare.

    ``dialog`` is the one that is open, None where none is.
    """

    reported = Signal(str)

    def __init__(self, document: Document, fitting: Fitting, window: QWidget) -> None:
        super().__init__(window)
        self._document, self._fitting, self._window = document, fitting, window
        self.dialog: CompareDialog | None = None

    def open(self, name: str) -> None:
        """Compare the present fit of a horizon with one before."""
        self.close()
        document = self._document
        present = document.state.provenances.get(name)
        fits = [
            ShownFit(one, surface, document.shelf.prediction(one))
            for one in document.shelf.fits_of(name)
            if one.given == document.given(name) and (surface := document.shelf.surface(one)) is not None
        ]
        if present is None or all(one.provenance != present for one in fits) or len(fits) < 2:
            self.reported.emit(
                self.tr("{name} has one fit so far: change its settings, fit again, then compare.").format(name=name)
            )
            return
        dialog = CompareDialog(document.site_in_use(), fits, present, self._window)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.taken.connect(self._take)
        dialog.finished.connect(self._gone)
        self.dialog = dialog
        dialog.open()

    def close(self) -> None:
        """Close the dialog that is open."""
        if self.dialog is not None:
            self.dialog.reject()

    def _take(self, provenance: Provenance) -> None:
        self._fitting.push(TakeFit(provenance))

    def _gone(self, _: int) -> None:
        self.dialog = None

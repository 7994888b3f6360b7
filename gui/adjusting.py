"""The adjust panel and the fitting behind it: effects before a change is made, and the change itself."""

from __future__ import annotations

from PySide6.QtCore import QObject

from geofit.data.accuracy import Accuracy
from geofit.data.progress import Progress
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.fitting import Fitting
from geofit.gui.panels.adjust import AdjustPanel
from geofit.gui.translate import translated
from geofit.gui.worker import Task, run
from geofit.project.building import edited
from geofit.project.document import Document
from geofit.project.provenance import ManualEdit, Move, MoveToPointEdit, Row, Weigh

__all__ = ["Adjusting"]


class Adjusting(QObject):
    """Tries a change beside the document, shows its effect, and hands it to the fitting when it is applied."""

    def __init__(self, document: Document, fitting: Fitting, panel: AdjustPanel, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._fitting, self._panel = document, fitting, panel
        self._trial: Task | None = None
        panel.adjust_wanted.connect(lambda patch, i, j, dz: self._try(Move(patch, i, j, dz)))
        panel.move_wanted.connect(lambda index, share: self._try(MoveToPointEdit(index, share)))
        panel.weigh_wanted.connect(lambda patch, i, j, weight: self._try(Weigh(patch, i, j, weight)))
        panel.adjust_requested.connect(self._adjust)
        panel.weigh_requested.connect(self._weigh)
        panel.move_requested.connect(self.move_to)
        fitting.adjusted.connect(panel.show_effect)

    def move_to(self, row: Row, share: float = 1.0) -> None:
        """MoveToPointEdit the chosen horizon's surface to one of its points."""
        self._stop()
        if self._document.selection.horizon is not None:
            self._fitting.move_to(self._document.selection.horizon, row, share)

    def _adjust(self, patch: str, i: int, j: int, dz: float) -> None:
        self._stop()
        if self._document.selection.horizon is not None:
            self._fitting.adjust(self._document.selection.horizon, patch, i, j, dz)

    def _weigh(self, patch: str, i: int, j: int, weight: float) -> None:
        self._stop()
        if self._document.selection.horizon is not None:
            self._fitting.weigh(self._document.selection.horizon, patch, i, j, weight)

    def _try(self, edit: ManualEdit) -> None:
        self._stop()
        name = self._document.selection.horizon
        surface = None if name is None else self._document.surface(name)
        if surface is None or surface.accuracy is None:
            return
        self._trial = run(
            self,
            _effect,
            surface,
            edit,
            on_done=self._show,
            on_failed=lambda error: self._panel.say(translated(str(error))),
        )
        self._trial.ended.connect(self._forget)

    def _show(self, found: tuple[Accuracy, Accuracy]) -> None:
        self._panel.show_effect(*found)

    def _stop(self) -> None:
        if self._trial is not None:
            self._trial.cancel()

    def _forget(self) -> None:
        if self.sender() is self._trial:
            self._trial = None


def _effect(surface: HorizonFit, edit: ManualEdit, *, progress: Progress) -> tuple[Accuracy | None, Accuracy | None]:
    return surface.accuracy, edited(surface, edit, progress).accuracy

"""The adjust panel, the control point in the scene, and the fitting behind both: a change, and its effect before it."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from geofit.data.accuracy import Accuracy
from geofit.data.errors import GeofitError
from geofit.data.progress import Progress
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.preview import MovePreview, preview_move
from geofit.gui.activity import Activity
from geofit.gui.fitting import Fitting
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.adjust import AdjustPanel
from geofit.gui.translate import translated
from geofit.gui.view3d.view import SceneView
from geofit.gui.worker import Task, run
from geofit.project.building import edited
from geofit.project.document import Document
from geofit.project.provenance import ManualEdit, Move, MoveToPointEdit, Row, Weigh
from geofit.report.digits import metres

__all__ = ["Adjusting"]


class Adjusting(QObject):
    """Tries a change beside the document, shows its effect, and hands it to the fitting when it is applied.

    ``reported(text)`` reports why a control point cannot be dragged.
    """

    reported = Signal(str)

    def __init__(
        self,
        document: Document,
        fitting: Fitting,
        activity: Activity,
        panel: AdjustPanel,
        view: SceneView,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._document, self._fitting, self._panel, self._view = document, fitting, panel, view
        self._trial: Task | None = None
        self._preview: MovePreview | None = None
        panel.adjust_wanted.connect(lambda *move: self._try(Move(*move)))
        panel.move_wanted.connect(lambda index, share: self._try(MoveToPointEdit(index, share)))
        panel.weigh_wanted.connect(lambda patch, i, j, weight: self._try(Weigh(patch, i, j, weight)))
        panel.control_chosen.connect(lambda *_: self._choose())
        panel.control_moved.connect(self._follow)
        view.control_picked.connect(lambda *_: self._hint())
        view.control_picked.connect(lambda *_: self._choose())
        view.control_dragged.connect(panel.control.put)
        view.control_dropped.connect(panel.apply)
        view.control_refused.connect(self.reported)
        activity.ended.connect(self._give_up)
        panel.adjust_requested.connect(self._adjust)
        panel.weigh_requested.connect(self._weigh)
        panel.move_requested.connect(self.move_to)
        fitting.adjusted.connect(self._applied)

    def renew(self, name: str) -> None:
        """Take hold of the chosen control point again: the scene has another surface of its horizon."""
        if name == self._document.selection.horizon and self._view.control_marked:
            self._choose()

    def move_to(self, row: Row, share: float = 1.0) -> None:
        """MoveToPointEdit the chosen horizon's surface to one of its points."""
        self._stop()
        if self._document.selection.horizon is not None:
            self._fitting.move_to(self._document.selection.horizon, row, share)

    def _choose(self) -> None:
        """Show what the chosen control point moves, or why it cannot be moved."""
        name, self._preview, reason = self._document.selection.horizon, None, ""
        surface = None if name is None else self._document.surface(name)
        if name is None or surface is None or surface.model is None:
            return
        try:
            self._preview = preview_move(surface, *self._panel.control.target)
        except GeofitError as error:
            reason = translated(str(error))
        self._view.control_move.show(name, self._preview, reason)
        if self._panel.control.ready:
            self._follow()

    def _hint(self) -> None:
        """Say how the control point is dragged."""
        if self._preview is not None:
            self.reported.emit(
                self.tr("Drag: in the plane of the view. Shift: along the normal. X, Y, Z: one axis. Digits: metres.")
            )

    def _follow(self) -> None:
        """Show the surface and its figures while the control point moves."""
        preview, control = self._preview, self._panel.control
        if preview is None or preview.surface.accuracy is None or self._view.control_move.waits:
            return
        dz, aside = control.dz.value(), control.aside
        before, after = preview.surface.accuracy, preview.effect(dz, aside)
        if control.ready:
            self._panel.show_move(before, after)
        figures = self.tr("Δz {dz} m\nσ {sigma} → {new_sigma} m · max |d| {worst} → {new_worst} m").format(
            dz=f"{dz:+.2f}".replace("-", "−"),
            sigma=metres(before.sigma),
            new_sigma=metres(after.sigma),
            worst=metres(before.max_abs),
            new_worst=metres(after.max_abs),
        )
        if any(aside):
            east, north, up = (f"{value:+.2f} m".replace("-", "−") for value in aside)
            words = self.tr("sideways E {east}, N {north}, Z {up}").format(east=east, north=north, up=up)
            figures = f"{words}\n{figures}"
        self._view.control_move.move(preview.vector(dz, aside), in_lengths(figures) if control.ready else "")

    def _give_up(self) -> None:
        """Put the control point back where its move was refused, stopped or failed."""
        if self._view.control_move.waits and self._preview is not None:
            name = self._document.selection.horizon
            if name is not None and self._document.surface(name) is self._preview.surface:
                self._view.control_move.waits = False
                self._panel.control.put_back()

    def _adjust(self, *move: Any) -> None:
        self._stop()
        self._view.control_move.waits = self._preview is not None
        if self._document.selection.horizon is not None:
            self._fitting.adjust(self._document.selection.horizon, Move(*move))

    def _weigh(self, patch: str, i: int, j: int, weight: float) -> None:
        self._stop()
        if self._document.selection.horizon is not None:
            self._fitting.weigh(self._document.selection.horizon, patch, i, j, weight)

    def _applied(self, horizon: str, before: Accuracy) -> None:
        """Show what an edit did, where its horizon is the one that is shown."""
        surface = self._document.surface(horizon)
        if horizon == self._document.selection.horizon and surface is not None and surface.accuracy is not None:
            self._panel.show_applied(before, surface.accuracy)

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

"""Fitting, making again, examining: long tasks whose results go to the document."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QObject, Signal

from geofit.data.accuracy import Accuracy
from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.prediction import PredictionResult
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity, Work
from geofit.gui.session import Session
from geofit.gui.translate import translated
from geofit.project.building import changed, examined, made
from geofit.project.commands import (
    AdjustControlPoint,
    ChangeWeight,
    Command,
    ExcludeRows,
    IncludeRows,
    MoveToPoint,
    SetArea,
    SetCore,
    SetSettings,
    SetSurface,
    SplitAtFaults,
)
from geofit.project.fault_blocks import SplitHorizon, cuts_measured, split_at_faults
from geofit.project.horizon_edits import HorizonEdit, present_name, present_provenance
from geofit.project.provenance import Corners, DocumentError, Move, Provenance, Row
from geofit.site.throw import FaultCut

__all__ = ["Fitting", "point_not_fitted"]

_LOG = logging.getLogger(__name__)


def point_not_fitted(name: str, row: Row) -> Message:
    """Return why a surface cannot be moved to a point: it was made without it."""
    return message(
        "gui.point-not-fitted",
        "{file} row {row} is not among the points of the surface of '{name}'. Include it and fit, or choose "
        "another point.",
        file=row.file,
        row=row.row,
        name=name,
    )


class Fitting(QObject):
    """What makes and changes surfaces.

    Signals: ``refused(exception)`` for a step that does not apply; ``adjusted(horizon, before)`` after a manual
    edit, with the check before it; ``displaced(cuts)`` with what faults displace; ``reported(text)`` states it in
    words.
    """

    refused = Signal(object)
    adjusted = Signal(str, object)
    displaced = Signal(object)
    reported = Signal(str)

    def __init__(self, session: Session, activity: Activity, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._activity = session, activity
        self._document = session.document
        #: How horizons were renamed, merged and removed when the task under way began: its result has these names.
        self._edits: tuple[HorizonEdit, ...] = ()
        for listener in (self._make_missing, self._measure_throw):
            self._document.result_changed.connect(listener)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        for listener in (self._make_missing, self._measure_throw):
            self._document.result_changed.disconnect(listener)

    def fit(self, name: str) -> None:
        """Fit a horizon with its present settings and rows; make it again as it was, where that was stopped.

        One that faults cut is split at them first, and all its blocks are fitted.
        """
        document = self._document
        stopped = [one for one in document.missing() if one.horizon == name and not document.stale(name)]
        if document.needs_split(name):
            self._part(document.whole(name))
        elif stopped:
            self._make_again(stopped[0])
        else:
            self._fit(name)

    def fit_all(self) -> None:
        """Fit every horizon whose surface is missing or stale; all of them if none is."""
        document = self._document
        wanted = [name for name in document.horizons if self._needs_fit(name)] or document.horizons
        # A horizon is parted once, whichever of its blocks is wanted.
        for name in dict.fromkeys(document.whole(name) if document.needs_split(name) else name for name in wanted):
            if name in document.horizons:
                self.fit(name)
            else:
                self._part(name)

    def _fit(self, name: str) -> None:
        title, edits = self.tr("Fit {name}").format(name=name), self._document.state.horizons
        self._activity.prepare(
            title, lambda: self._fit_work(name, edits), on_done=lambda done: self._fitted(*done), in_process=True
        )

    def _part(self, whole: str) -> None:
        """Part a horizon at its faults, then fit its blocks."""
        title, edits = self.tr("Split {name} at its faults").format(name=whole), self._document.state.horizons
        self._activity.prepare(title, lambda: self._part_work(whole, edits), on_done=self._split_done, in_process=True)

    def _part_work(self, name: str, edits: tuple[HorizonEdit, ...]) -> Work:
        document, whole = self._document, self._begin(name, edits)
        if whole is None:
            return None
        given, left_out = document.inputs_for_blocks(whole)
        return split_at_faults, (whole, document.faults(whole), left_out, given, document.given(whole))

    def _split_done(self, found: SplitHorizon) -> None:
        document = self._document
        name = self._present(found.horizon)
        if name is None:
            return
        if self._edits != document.state.horizons:
            # Blocks are called after their horizon and know their faults by name.
            self._part(name)
            return
        for note in found.notes:
            _LOG.log(logging.INFO if note.severity == "info" else logging.WARNING, note)
        for provenance, surface in found.faults.items():
            self._fitted(provenance, surface)
        if not found.blocks:
            self._fit(found.horizon)
            return
        self.push(SplitAtFaults(found.horizon, dict(found.blocks)))
        for name in found.blocks:
            if name in document.horizons:
                self._fit(name)

    def _measure_throw(self, name: str) -> None:
        """Measure how far faults displace the horizon of a block, as soon as all its blocks are available."""
        if name not in self._document.state.parts:
            return
        whole = self._document.whole(name)
        title = self.tr("Measure the throw of {name}").format(name=whole)
        self._activity.prepare(title, lambda: self._throw_work(whole), on_done=self._thrown, in_process=True)

    def _throw_work(self, whole: str) -> Work:
        document = self._document
        names = [name for name, part in document.state.parts.items() if part.horizon == whole]
        blocks = document.blocks(whole)
        if not names or len(blocks.surfaces) < len(names):
            return None
        return cuts_measured, (blocks,)

    def _thrown(self, cuts: tuple[FaultCut, ...]) -> None:
        for cut in cuts:
            _LOG.info(cut.text)
        if cuts:
            self.displaced.emit(cuts)
            self.reported.emit(" · ".join(translated(cut.text) for cut in cuts))

    def examine(self, name: str) -> None:
        """Find the prediction error of a surface away from its data."""
        title, edits = self.tr("Examine {name} away from its data").format(name=name), self._document.state.horizons
        self._activity.prepare(title, lambda: self._examine_work(name, edits), on_done=self._examined, in_process=True)

    def adjust(self, name: str, move: Move) -> None:
        """Move a control point."""
        self._edit(AdjustControlPoint(name, move.patch, move.i, move.j, move.dz, move.aside))

    def weigh(self, name: str, patch: str, i: int, j: int, weight: float) -> None:
        """Give a control point another weight."""
        self._edit(ChangeWeight(name, patch, i, j, weight))

    def move_to(self, name: str, row: Row, share: float = 1.0) -> None:
        """Pull a surface to one of its points."""
        surface = self._document.surface(name)
        index = None if surface is None else row.find(surface.points)
        if index is None:
            self.refused.emit(DocumentError(point_not_fitted(name, row)))
            return
        self._edit(MoveToPoint(name, index, share))

    def set_settings(self, name: str, settings: FitSettings) -> None:
        """Give a horizon other settings."""
        if settings != self._document.settings(name):
            self.push(SetSettings(name, settings))

    def set_core(self, name: str, core: Any) -> None:
        """Give a horizon another core: a word, or corners in map coordinates."""
        corners = core if isinstance(core, str) else tuple((float(x), float(y)) for x, y in core)
        if corners != self._document.settings(name).core:
            self.push(SetCore(name, corners))

    def set_area(self, corners: Corners | None) -> None:
        """End the surfaces at another study area; None: that of the site's files."""
        if corners != self._document.state.area:
            self.push(SetArea(corners))

    def exclude(self, name: str, rows: Sequence[Row]) -> None:
        """Leave rows out of the next fit; where all of them are left out already, take them in again."""
        out = self._document.state.excluded.get(name, frozenset())
        used = tuple(row for row in rows if row not in out)
        if used:
            self.push(ExcludeRows(name, used))
        elif rows:
            self.push(IncludeRows(name, tuple(rows)))

    def push(self, command: Command) -> None:
        """Do a command, or show why not."""
        try:
            self._session.push(command)
        except DocumentError as error:
            self.refused.emit(error)

    def make_missing(self) -> None:
        """Make the surfaces that the document wants and does not have."""
        for provenance in self._document.missing():
            self._make_again(provenance)

    def _needs_fit(self, name: str) -> bool:
        return self._document.surface(name) is None or self._document.stale(name)

    def _begin(self, name: str, edits: tuple[HorizonEdit, ...]) -> str | None:
        """Begin a task for a horizon that was called so after ``edits``; return its present name, None if gone."""
        self._edits = edits
        now = self._present(name)
        self._edits = self._document.state.horizons
        return now

    def _present(self, name: str) -> str | None:
        """Return how a horizon of the task is called now; None, and say so, if it is gone."""
        now = present_name(name, self._edits, self._document.state.horizons)
        if now is None:
            self._drop(name)
        return now

    def _drop(self, name: str) -> None:
        text = message(
            "gui.horizon-gone-meanwhile",
            "The site has no horizon '{name}' any more; the result of its task was discarded.",
            name=Untranslated(name),
        )
        _LOG.warning(text)
        self.reported.emit(translated(text))

    def _renamed(self, provenance: Provenance) -> Provenance | None:
        """Return a provenance of the task with present names; None, and say so, if its horizon is gone."""
        now = present_provenance(provenance, self._edits, self._document.state.horizons)
        if now is None:
            self._drop(provenance.horizon)
        return now

    def _fit_work(self, name: str, edits: tuple[HorizonEdit, ...]) -> Work:
        now = self._begin(name, edits)
        if now is None:
            return None
        provenance = self._document.provenance(now)
        surface = self._document.shelf.surface(provenance)
        if surface is not None and surface.model is not None:
            if self._document.state.provenances.get(now) == provenance:
                text = self.tr("{name} is up to date: data and settings are those of its fit.")
                self.reported.emit(text.format(name=now))
            self._fitted(provenance, surface)
            return None
        return made, (provenance, self._document.given_for(provenance))

    def _fitted(self, made_from: Provenance, surface: HorizonFit) -> None:
        provenance = self._renamed(made_from)
        if provenance is None:
            return
        self._document.put(provenance, surface)
        former = self._document.state.provenances.get(provenance.horizon)
        if former == provenance:
            return
        self.push(SetSurface(provenance))
        if former is not None and former.edits:
            text = plural_message(
                "gui.edits-replaced",
                "The new fit of {name} drops the edit made after the former fit. Undo brings it back.",
                "The new fit of {name} drops the {count} edits made after the former fit. Undo brings them back.",
                count=len(former.edits),
                name=Untranslated(provenance.horizon),
            )
            _LOG.warning(text)
            self.reported.emit(translated(text))

    def _put(self, made_from: Provenance, surface: HorizonFit) -> None:
        provenance = self._renamed(made_from)
        if provenance is not None:
            self._document.put(provenance, surface)

    def _make_missing(self, name: str) -> None:
        for provenance in self._document.missing():
            if provenance.horizon == name:
                self._make_again(provenance)

    def _make_again(self, provenance: Provenance) -> None:
        title = self.tr("Make {name} again").format(name=provenance.horizon)
        self._activity.prepare(
            title, lambda: self._again_work(provenance), on_done=lambda done: self._put(*done), in_process=True
        )

    def _again_work(self, provenance: Provenance) -> Work:
        """Undone or closed in the meantime, or put on the shelf by somebody else: then there is nothing to do."""
        self._edits = self._document.state.horizons
        wanted = self._document.state.provenances.get(provenance.horizon) == provenance
        surface = self._document.shelf.surface(provenance)
        if not wanted or (surface is not None and surface.model is not None):
            return None
        return made, (provenance, self._document.given_for(provenance))

    def complete(self, provenances: Sequence[Provenance]) -> None:
        """Make again what was read from files, so that it can be edited manually."""
        for provenance in provenances:
            if self._document.holds(provenance):
                self._make_again(provenance)

    def _edit(self, command: AdjustControlPoint | MoveToPoint | ChangeWeight) -> None:
        edits = self._document.state.horizons
        self._activity.prepare(
            translated(command.text),
            lambda: self._edit_work(command, edits),
            on_done=lambda done: self._edited(command, *done),
            in_process=True,
        )

    def _edit_work(
        self, command: AdjustControlPoint | MoveToPoint | ChangeWeight, edits: tuple[HorizonEdit, ...]
    ) -> Work:
        name = self._begin(command.horizon, edits)
        if name is None:
            return None
        provenance = self._document.state.provenances.get(name)
        surface = self._document.shelf.surface(provenance)
        if provenance is None or surface is None:
            text = message(
                "data.no-surface-to-adjust",
                "'{name}' has no surface to adjust. Fit it first.",
                name=name,
            )
            self.refused.emit(DocumentError(text))
            return None
        if surface.model is None and not self._document.holds(provenance):
            text = message(
                "gui.surface-data-changed",
                "'{name}' was read from a file, and its data have changed since. Fit it again, then adjust.",
                name=name,
            )
            self.refused.emit(DocumentError(text))
            return None
        return changed, (provenance, surface, command.edit, self._document.given_for(provenance))

    def _edited(
        self,
        command: AdjustControlPoint | MoveToPoint | ChangeWeight,
        made_from: Provenance,
        _: Provenance,
        before: Accuracy,
        surface: HorizonFit,
    ) -> None:
        former = self._renamed(made_from)
        if former is None:
            return
        provenance = replace(former, edits=(*former.edits, command.edit))
        if self._document.state.provenances.get(former.horizon) != former:
            self.refused.emit(
                DocumentError(
                    message(
                        "gui.surface-changed-while-adjusting",
                        "The surface changed while it was adjusted. Adjust it once more.",
                    )
                )
            )
            return
        self._document.put(provenance, surface)
        self.push(replace(command, horizon=former.horizon))
        self.adjusted.emit(former.horizon, before)

    def _examine_work(self, horizon: str, edits: tuple[HorizonEdit, ...]) -> Work:
        name = self._begin(horizon, edits)
        if name is None:
            return None
        provenance = self._document.state.provenances.get(name)
        surface = self._document.shelf.surface(provenance)
        if provenance is None or surface is None:
            text = message("gui.no-surface-to-examine", "'{name}' has no surface to examine. Fit it first.", name=name)
            self.refused.emit(DocumentError(text))
            return None
        return examined, (provenance, surface)

    def _examined(self, found: tuple[Provenance, PredictionResult]) -> None:
        provenance = self._renamed(found[0])
        if provenance is not None:
            self._document.put_prediction(provenance, found[1])

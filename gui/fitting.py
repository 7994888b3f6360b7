"""Fitting, making again, examining: long tasks whose results go to the document."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QObject, Signal

from geofit.data.accuracy import Accuracy
from geofit.data.messages import message
from geofit.data.prediction import OffData
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity, Work
from geofit.gui.session import Session
from geofit.gui.words import spoken
from geofit.project.building import changed, examined, made
from geofit.project.commands import (
    AdjustControlPoint,
    ChangeWeight,
    Command,
    ExcludeRows,
    IncludeRows,
    PartAtFaults,
    PullToPoint,
    SetCore,
    SetSettings,
    SetSurface,
)
from geofit.project.fault_blocks import Parted, measured, part_at_faults
from geofit.project.provenance import DocumentError, Recipe, Row
from geofit.site.throw import FaultCut

__all__ = ["Fitting"]

_LOG = logging.getLogger(__name__)


class Fitting(QObject):
    """What makes and changes surfaces.

    Signals: ``refused(exception)`` for a step that does not apply; ``adjusted(before, after)`` with the two checks
    after a change by hand; ``displaced(cuts)`` with what faults displace, ``told(text)`` says it in words.
    """

    refused = Signal(object)
    adjusted = Signal(object, object)
    displaced = Signal(object)
    told = Signal(str)

    def __init__(self, session: Session, activity: Activity, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._activity = session, activity
        self._document = session.document
        for listener in (self._make_missing, self._measure_throw):
            self._document.result_changed.connect(listener)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        for listener in (self._make_missing, self._measure_throw):
            self._document.result_changed.disconnect(listener)

    def fit(self, name: str) -> None:
        """Fit a horizon with its present settings and rows.

        One that faults cut is parted at them first, and all its blocks are fitted.
        """
        if self._document.unparted(name):
            self._part(self._document.whole(name))
        else:
            self._fit(name)

    def fit_all(self) -> None:
        """Fit every horizon whose surface is missing or stale; all of them if none is."""
        document = self._document
        wanted = [name for name in document.horizons if self._needs_fit(name)] or document.horizons
        # A horizon is parted once, whichever of its blocks is wanted.
        for name in dict.fromkeys(document.whole(name) if document.unparted(name) else name for name in wanted):
            if name in document.horizons:
                self.fit(name)
            else:
                self._part(name)

    def _fit(self, name: str) -> None:
        title = self.tr("Fit {name}").format(name=name)
        self._activity.prepare(
            title, lambda: self._fit_work(name), on_done=lambda done: self._fitted(*done), apart=True
        )

    def _part(self, whole: str) -> None:
        """Part a horizon at its faults, then fit its blocks."""
        title = self.tr("Part {name} at its faults").format(name=whole)
        self._activity.prepare(title, lambda: self._part_work(whole), on_done=self._parted, apart=True)

    def _part_work(self, whole: str) -> Work:
        document = self._document
        given, left_out = document.given_for_parting(whole)
        return part_at_faults, (whole, document.faults(whole), left_out, given, document.given(whole))

    def _parted(self, found: Parted) -> None:
        document = self._document
        for note in found.notes:
            _LOG.log(logging.INFO if note.severity == "info" else logging.WARNING, note)
        for recipe, surface in found.faults.items():
            self._fitted(recipe, surface)
        if not found.blocks:
            self._fit(found.horizon)
            return
        self.push(PartAtFaults(found.horizon, dict(found.blocks)))
        for name in found.blocks:
            if name in document.horizons:
                self._fit(name)

    def _measure_throw(self, name: str) -> None:
        """Measure how far faults displace the horizon of a block, as soon as all its blocks are at hand."""
        if name not in self._document.state.parts:
            return
        whole = self._document.whole(name)
        title = self.tr("Measure the throw of {name}").format(name=whole)
        self._activity.prepare(title, lambda: self._throw_work(whole), on_done=self._thrown, apart=True)

    def _throw_work(self, whole: str) -> Work:
        document = self._document
        names = [name for name, part in document.state.parts.items() if part.horizon == whole]
        blocks = document.blocks(whole)
        if not names or len(blocks.surfaces) < len(names):
            return None
        return measured, (blocks,)

    def _thrown(self, cuts: tuple[FaultCut, ...]) -> None:
        for cut in cuts:
            _LOG.info(cut.text)
        if cuts:
            self.displaced.emit(cuts)
            self.told.emit(" · ".join(spoken(cut.text) for cut in cuts))

    def examine(self, name: str) -> None:
        """Find out how far a surface may lie from the rock where nobody drilled."""
        title = self.tr("Examine {name} off its data").format(name=name)
        self._activity.prepare(title, lambda: self._examine_work(name), on_done=self._examined, apart=True)

    def adjust(self, name: str, patch: str, i: int, j: int, dz: float) -> None:
        """Raise a control point by ``dz`` metres."""
        self._edit(AdjustControlPoint(name, patch, i, j, dz))

    def weigh(self, name: str, patch: str, i: int, j: int, weight: float) -> None:
        """Give a control point another weight."""
        self._edit(ChangeWeight(name, patch, i, j, weight))

    def pull(self, name: str, row: Row, share: float = 1.0) -> None:
        """Pull a surface to one of its points."""
        surface = self._document.surface(name)
        index = None if surface is None else row.find(surface.points)
        if index is None:
            text = message(
                "window.point-not-fitted",
                "{file} row {row} is not among the points of the surface of '{name}'. Include it and fit, or choose "
                "another point.",
                file=row.file,
                row=row.row,
                name=name,
            )
            self.refused.emit(DocumentError(text))
            return
        self._edit(PullToPoint(name, index, share))

    def set_settings(self, name: str, settings: FitSettings) -> None:
        """Give a horizon other settings."""
        if settings != self._document.settings(name):
            self.push(SetSettings(name, settings))

    def set_core(self, name: str, core: Any) -> None:
        """Give a horizon another core: a word, or corners in map coordinates."""
        corners = core if isinstance(core, str) else tuple((float(x), float(y)) for x, y in core)
        if corners != self._document.settings(name).core:
            self.push(SetCore(name, corners))

    def exclude(self, name: str, rows: Sequence[Row]) -> None:
        """Leave rows out of the next fit; where all of them are left out already, take them in again."""
        out = self._document.state.excluded.get(name, frozenset())
        used = tuple(row for row in rows if row not in out)
        if used:
            self.push(ExcludeRows(name, used))
        elif rows:
            self.push(IncludeRows(name, tuple(rows)))

    def push(self, command: Command) -> None:
        """Do a command, or tell why not."""
        try:
            self._session.push(command)
        except DocumentError as error:
            self.refused.emit(error)

    def make_missing(self) -> None:
        """Make the surfaces that the document wants and does not have."""
        for recipe in self._document.missing():
            self._make_again(recipe)

    def _needs_fit(self, name: str) -> bool:
        return self._document.surface(name) is None or self._document.stale(name)

    def _fit_work(self, name: str) -> Work:
        recipe = self._document.recipe(name)
        surface = self._document.shelf.surface(recipe)
        if surface is not None and surface.model is not None:
            self._fitted(recipe, surface)
            return None
        return made, (recipe, self._document.given_for(recipe))

    def _fitted(self, recipe: Recipe, surface: HorizonFit) -> None:
        self._document.put(recipe, surface)
        if self._document.state.recipes.get(recipe.horizon) != recipe:
            self.push(SetSurface(recipe))

    def _make_missing(self, name: str) -> None:
        for recipe in self._document.missing():
            if recipe.horizon == name:
                self._make_again(recipe)

    def _make_again(self, recipe: Recipe) -> None:
        title = self.tr("Make {name} again").format(name=recipe.horizon)
        self._activity.prepare(
            title, lambda: self._again_work(recipe), on_done=lambda done: self._document.put(*done), apart=True
        )

    def _again_work(self, recipe: Recipe) -> Work:
        """Undone or closed in the meantime, or put on the shelf by somebody else: then there is nothing to do."""
        wanted = self._document.state.recipes.get(recipe.horizon) == recipe
        surface = self._document.shelf.surface(recipe)
        if not wanted or (surface is not None and surface.model is not None):
            return None
        return made, (recipe, self._document.given_for(recipe))

    def complete(self, recipes: Sequence[Recipe]) -> None:
        """Make again what was read from files, so that it can be changed by hand."""
        for recipe in recipes:
            if self._document.holds(recipe):
                self._make_again(recipe)

    def _edit(self, command: AdjustControlPoint | PullToPoint | ChangeWeight) -> None:
        self._activity.prepare(
            spoken(command.text),
            lambda: self._edit_work(command),
            on_done=lambda done: self._edited(command, *done),
            apart=True,
        )

    def _edit_work(self, command: AdjustControlPoint | PullToPoint | ChangeWeight) -> Work:
        recipe = self._document.state.recipes.get(command.horizon)
        surface = self._document.shelf.surface(recipe)
        if recipe is None or surface is None:
            text = message(
                "project.no-surface-adjust-fit",
                "'{name}' has no surface to adjust. Fit it first.",
                name=command.horizon,
            )
            self.refused.emit(DocumentError(text))
            return None
        if surface.model is None and not self._document.holds(recipe):
            text = message(
                "window.read-file-data-changed",
                "'{name}' was read from a file, and its data have changed since. Fit it again, then adjust.",
                name=command.horizon,
            )
            self.refused.emit(DocumentError(text))
            return None
        return changed, (recipe, surface, command.edit, self._document.given_for(recipe))

    def _edited(self, command: Command, former: Recipe, recipe: Recipe, before: Accuracy, surface: HorizonFit) -> None:
        if self._document.state.recipes.get(former.horizon) != former:
            self.refused.emit(
                DocumentError(
                    message(
                        "window.surface-changed-adjusted-adjust",
                        "The surface changed while it was adjusted. Adjust it once more.",
                    )
                )
            )
            return
        self._document.put(recipe, surface)
        self.push(command)
        self.adjusted.emit(before, surface.accuracy)

    def _examine_work(self, name: str) -> Work:
        recipe = self._document.state.recipes.get(name)
        surface = self._document.shelf.surface(recipe)
        if recipe is None or surface is None:
            text = message(
                "window.no-surface-examine-fit", "'{name}' has no surface to examine. Fit it first.", name=name
            )
            self.refused.emit(DocumentError(text))
            return None
        return examined, (recipe, surface)

    def _examined(self, found: tuple[Recipe, OffData]) -> None:
        self._document.put_offdata(*found)

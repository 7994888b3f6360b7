"""The changes of a document: one class a command. Each makes a new state from the former one, and plain data.

A command is checked by :meth:`Command.on` before anything changes; the document changes in :meth:`Command.redo` only.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

from geofit.data.messages import Message, message
from geofit.data.settings import FitSettings
from geofit.project.area_command import SetArea
from geofit.project.body_commands import DeleteBody, RenameBody, SetBody, StyleBody
from geofit.project.command import Command, known
from geofit.project.data_commands import ChangeData
from geofit.project.fit_command import TakeFit
from geofit.project.horizon_commands import MergeHorizons, RemoveHorizons, RenameHorizon
from geofit.project.provenance import (
    NOWHERE,
    DocumentError,
    ManualEdit,
    Move,
    MoveToPointEdit,
    Part,
    Provenance,
    Row,
    SeparationEdit,
    Weigh,
    settings_from,
)
from geofit.project.row_commands import ExcludeRows, IncludeRows
from geofit.project.state import State

__all__ = [
    "COMMANDS",
    "AdjustControlPoint",
    "ChangeData",
    "ChangeWeight",
    "Command",
    "ExcludeRows",
    "IncludeRows",
    "MergeHorizons",
    "MoveToPoint",
    "RemoveHorizons",
    "RenameHorizon",
    "RenameSite",
    "SeparateHorizons",
    "SetArea",
    "SetCore",
    "SetOrder",
    "SetSettings",
    "SetSurface",
    "SplitAtFaults",
    "command_from",
]

#: As FitSettings has it, which looks at the words.
Core = Any


@dataclass
class SetSettings(Command):
    """Other settings for a horizon; its surface becomes stale."""

    kind = "settings"
    horizon: str
    settings: FitSettings

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-settings", "Settings of {name}", name=self.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        known(state, self.horizon)
        return replace(state, settings={**state.settings, self.horizon: self.settings})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["horizon"], settings_from(data["settings"]))


@dataclass
class SetCore(Command):
    """Another core for a horizon: a word, or corners in map coordinates as drawn in plan."""

    kind = "core"
    horizon: str
    core: Core

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-core", "Core of {name}", name=self.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        known(state, self.horizon)
        settings = replace(state.settings[self.horizon], core=self.core)
        return replace(state, settings={**state.settings, self.horizon: settings})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        core = data["core"]
        return cls(data["horizon"], core if isinstance(core, str) else tuple((x, y) for x, y in core))


@dataclass
class SetSurface(Command):
    """A surface that a fit has made; the document's shelf holds it."""

    kind = "surface"
    provenance: Provenance

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-fit", "Fit {name}", name=self.provenance.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        known(state, self.provenance.horizon)
        return replace(state, provenances={**state.provenances, self.provenance.horizon: self.provenance})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(Provenance.from_data(data["provenance"]))


@dataclass
class SplitAtFaults(Command):
    """Blocks take the place of a horizon that faults cut, or of its former blocks."""

    kind = "part"
    horizon: str
    blocks: dict[str, Part]

    @property
    def text(self) -> Message:  # noqa: D102
        faults = dict.fromkeys(fault.horizon for part in self.blocks.values() for fault in part.faults)
        return message("project.step-part", "Split {name} at {faults}", name=self.horizon, faults=", ".join(faults))

    def on(self, state: State) -> State:  # noqa: D102
        former = [name for name, part in state.parts.items() if part.horizon == self.horizon] or [self.horizon]
        known(state, former[0])
        taken = [name for name in self.blocks if name in state.order and name not in former]
        if taken:
            raise DocumentError(
                message(
                    "data.block-name-taken",
                    "A block of '{name}' is called '{block}', and so is a horizon. Rename the horizon.",
                    name=self.horizon,
                    block=taken[0],
                )
            )
        at = min(state.order.index(name) for name in former)
        order = [name for name in state.order if name not in former]
        order[at:at] = self.blocks
        # A row that was excluded from a block may lie in another one now; a block passes over those it does not have.
        rows = frozenset[Row]().union(*(state.excluded.get(name, ()) for name in former))
        model = state.settings[former[0]]
        return replace(
            state,
            order=tuple(order),
            settings={**state.settings, **{name: state.settings.get(name, model) for name in self.blocks}},
            excluded=_without(state.excluded, former) | {name: rows for name in self.blocks if rows},
            provenances=_without(state.provenances, former),
            parts=_without(state.parts, former) | self.blocks,
        )

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["horizon"], {name: Part.from_data(part) for name, part in data["blocks"].items()})


@dataclass
class _ManualCommand(Command):
    horizon: str

    @property
    @abstractmethod
    def edit(self) -> ManualEdit:
        """The change as the provenance has it."""

    def on(self, state: State) -> State:
        provenance = state.provenances.get(self.horizon)
        if provenance is None:
            raise DocumentError(
                message(
                    "data.no-surface-to-adjust",
                    "'{name}' has no surface to adjust. Fit it first.",
                    name=self.horizon,
                )
            )
        changed = replace(provenance, edits=(*provenance.edits, self.edit))
        return replace(state, provenances={**state.provenances, self.horizon: changed})


@dataclass
class AdjustControlPoint(_ManualCommand):
    """A control point raised or lowered manually, and moved aside in map coordinates, metres."""

    kind = "adjust"
    patch: str
    i: int
    j: int
    dz: float
    aside: tuple[float, float, float] = NOWHERE

    def __post_init__(self) -> None:
        # Of a journal it is a list.
        x, y, z = self.aside
        self.aside = (x, y, z)

    @property
    def text(self) -> Message:  # noqa: D102
        if any(self.aside):
            x, y, z = self.aside
            return message(
                "project.step-move-control-point-aside",
                "Move control point {i}, {j} of {patch} by {dz:+.3f} m and sideways by ({x:+.2f}, {y:+.2f}, {z:+.2f}) "
                "m ({name})",
                i=self.i, j=self.j, patch=self.patch, dz=self.dz, x=x, y=y, z=z, name=self.horizon,
            )  # fmt: skip
        return message(
            "project.step-move-control-point", "Move control point {i}, {j} of {patch} by {dz:+.3f} m ({name})",
            i=self.i, j=self.j, patch=self.patch, dz=self.dz, name=self.horizon,
        )  # fmt: skip

    @property
    def edit(self) -> ManualEdit:  # noqa: D102
        return Move(self.patch, self.i, self.j, self.dz, self.aside)


@dataclass
class ChangeWeight(_ManualCommand):
    """Another weight for a control point of the periphery."""

    kind = "weigh"
    patch: str
    i: int
    j: int
    weight: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "project.step-weight", "Weight {weight:g} for control point {i}, {j} of {patch} ({name})",
            weight=self.weight, i=self.i, j=self.j, patch=self.patch, name=self.horizon,
        )  # fmt: skip

    @property
    def edit(self) -> ManualEdit:  # noqa: D102
        return Weigh(self.patch, self.i, self.j, self.weight)


@dataclass
class MoveToPoint(_ManualCommand):
    """The surface moved to one of its data points."""

    kind = "pull"
    index: int
    share: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-pull", "Move {name} to point {number}", name=self.horizon, number=self.index + 1)

    @property
    def edit(self) -> ManualEdit:  # noqa: D102
        return MoveToPointEdit(self.index, self.share)


@dataclass
class SeparateHorizons(Command):
    """Horizons of a sequence separated where they crossed; ``moved`` names those that had to move."""

    kind = "separate"
    moved: tuple[str, ...]
    sequence: tuple[str, ...]
    minimum: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-separate", "Separate {names}", names=", ".join(self.moved))

    def provenances(self, state: State) -> dict[str, Provenance]:
        """Return the new provenances of the horizons that move."""
        missing = [name for name in self.sequence if name not in state.provenances]
        if missing:
            raise DocumentError(
                message(
                    "project.no-surface-to-move",
                    "'{name}' has no surface that could be moved. Fit it first.",
                    name=missing[0],
                )
            )
        return {
            name: replace(former, edits=(*former.edits, SeparationEdit(self.sequence, self.minimum, others)))
            for name in self.moved
            for former in (state.provenances[name],)
            for others in (tuple(state.provenances[other] for other in self.sequence if other != name),)
        }

    def on(self, state: State) -> State:  # noqa: D102
        return replace(state, provenances={**state.provenances, **self.provenances(state)})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(tuple(data["moved"]), tuple(data["sequence"]), data["minimum"])


@dataclass
class SetOrder(Command):
    """Another order of the horizons, the highest first."""

    kind = "order"
    order: tuple[str, ...]

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-order", "Order of the horizons")

    def on(self, state: State) -> State:  # noqa: D102
        if sorted(self.order) != sorted(state.order):
            raise DocumentError(
                message(
                    "project.order-incomplete",
                    "The order must name each horizon once: {names}.",
                    names=", ".join(state.order),
                )
            )
        return replace(state, order=self.order)

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(tuple(data["order"]))


@dataclass
class RenameSite(Command):
    """Another title for the site."""

    kind = "rename"
    name: str

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-rename", "Rename the site to {name}", name=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        if not self.name.strip():
            raise DocumentError(message("project.site-name-empty", "The site's name is empty. Give it a word."))
        return replace(state, name=self.name)


#: Commands by the word that names them in the journal.
COMMANDS: dict[str, type[Command]] = {
    command.kind: command
    for command in (
        SetSettings, SetCore, ExcludeRows, IncludeRows, SetSurface, SplitAtFaults, AdjustControlPoint, ChangeWeight,
        MoveToPoint, SeparateHorizons, SetOrder, RenameSite, ChangeData, SetArea,
        RenameHorizon, RemoveHorizons, MergeHorizons, SetBody, RenameBody, DeleteBody, StyleBody, TakeFit,
    )
}  # fmt: skip


def command_from(data: Mapping[str, Any]) -> Command:
    """Return a command from what its ``to_data`` gave; KeyError, TypeError or ValueError if it is none."""
    return COMMANDS[data["kind"]].from_data(data)


def _without(values: Mapping[str, Any], names: Collection[str]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if name not in names}

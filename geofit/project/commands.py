"""The changes of a document: one class a command. Each makes a new state from the former one, and can be told as data.

A command is checked by :meth:`Command.on` before anything changes; the document changes in :meth:`Command.redo` only.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

from geofit.data.messages import Message, message
from geofit.data.settings import FitSettings
from geofit.project.provenance import (
    Apart,
    DocumentError,
    HandEdit,
    Move,
    Part,
    Pull,
    Recipe,
    Row,
    Weigh,
    settings_from,
)
from geofit.project.state import State

if TYPE_CHECKING:
    from geofit.project.document import Document

__all__ = [
    "COMMANDS",
    "AdjustControlPoint",
    "ChangeWeight",
    "Command",
    "ExcludeRow",
    "IncludeRow",
    "PartAtFaults",
    "PullToPoint",
    "PushApart",
    "RenameSite",
    "SetCore",
    "SetOrder",
    "SetSettings",
    "SetSurface",
    "command_from",
]

#: As FitSettings has it, which looks at the words.
Core = Any


@dataclass
class Command(ABC):
    """A named step; ``kind`` names its class in the journal."""

    kind: ClassVar[str]
    _before: State | None = field(default=None, init=False, repr=False, compare=False)

    @property
    @abstractmethod
    def text(self) -> Message:
        """What the step does, as the Edit menu names it."""

    @abstractmethod
    def on(self, state: State) -> State:
        """Return the state after the command; DocumentError if it does not apply to ``state``."""

    def redo(self, document: Document) -> None:
        """Do it, for the first time or again."""
        after = self.on(document.state)
        self._before = document.state
        document.become(after)

    def undo(self, document: Document) -> None:
        """Take it back."""
        if self._before is None:
            raise DocumentError(
                message(
                    "project.not-done-yet-cannot", "'{step}' was not done yet and cannot be undone.", step=self.text
                )
            )
        document.become(self._before)

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.init}
        return {"kind": self.kind, **{name: _plain(value) for name, value in values.items()}}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:
        """Return what :meth:`to_data` was called on."""
        return cls(**{name: value for name, value in data.items() if name != "kind"})


@dataclass
class SetSettings(Command):
    """Other settings for a horizon; its surface becomes stale."""

    kind = "settings"
    horizon: str
    settings: FitSettings

    @property
    def text(self) -> Message:  # noqa: D102
        return message("step.settings", "Settings of {name}", name=self.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        _known(state, self.horizon)
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
        return message("step.core", "Core of {name}", name=self.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        _known(state, self.horizon)
        settings = replace(state.settings[self.horizon], core=self.core)
        return replace(state, settings={**state.settings, self.horizon: settings})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        core = data["core"]
        return cls(data["horizon"], core if isinstance(core, str) else tuple((x, y) for x, y in core))


@dataclass
class _RowCommand(Command):
    horizon: str
    row: Row

    def _excluded(self, state: State) -> frozenset[Row]:
        _known(state, self.horizon)
        return state.excluded.get(self.horizon, frozenset())

    def _with(self, state: State, rows: frozenset[Row]) -> State:
        return replace(state, excluded={**state.excluded, self.horizon: rows})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:
        return cls(data["horizon"], Row(**data["row"]))


@dataclass
class ExcludeRow(_RowCommand):
    """A row of a file that takes no part in the fit of a horizon."""

    kind = "exclude"

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "step.exclude",
            "Exclude {file} row {row} from {name}",
            file=self.row.file,
            row=self.row.row,
            name=self.horizon,
        )

    def on(self, state: State) -> State:  # noqa: D102
        rows = self._excluded(state)
        if self.row in rows:
            raise DocumentError(
                message(
                    "project.row-excluded-already",
                    "{file} row {row} is excluded from '{name}' already.",
                    file=self.row.file,
                    row=self.row.row,
                    name=self.horizon,
                )
            )
        return self._with(state, rows | {self.row})


@dataclass
class IncludeRow(_RowCommand):
    """A row that was excluded takes part again."""

    kind = "include"

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "step.include",
            "Include {file} row {row} in {name}",
            file=self.row.file,
            row=self.row.row,
            name=self.horizon,
        )

    def on(self, state: State) -> State:  # noqa: D102
        rows = self._excluded(state)
        if self.row not in rows:
            raise DocumentError(
                message(
                    "project.row-not-excluded",
                    "{file} row {row} is not excluded from '{name}'.",
                    file=self.row.file,
                    row=self.row.row,
                    name=self.horizon,
                )
            )
        return self._with(state, rows - {self.row})


@dataclass
class SetSurface(Command):
    """A surface that a fit has made; the document's shelf holds it."""

    kind = "surface"
    recipe: Recipe

    @property
    def text(self) -> Message:  # noqa: D102
        return message("step.fit", "Fit {name}", name=self.recipe.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        _known(state, self.recipe.horizon)
        return replace(state, recipes={**state.recipes, self.recipe.horizon: self.recipe})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(Recipe.from_data(data["recipe"]))


@dataclass
class PartAtFaults(Command):
    """Blocks take the place of a horizon that faults cut, or of its former blocks."""

    kind = "part"
    horizon: str
    blocks: dict[str, Part]

    @property
    def text(self) -> Message:  # noqa: D102
        faults = dict.fromkeys(fault.horizon for part in self.blocks.values() for fault in part.faults)
        return message("step.part", "Part {name} at {faults}", name=self.horizon, faults=", ".join(faults))

    def on(self, state: State) -> State:  # noqa: D102
        former = [name for name, part in state.parts.items() if part.horizon == self.horizon] or [self.horizon]
        _known(state, former[0])
        taken = [name for name in self.blocks if name in state.order and name not in former]
        if taken:
            raise DocumentError(
                message(
                    "site.block-called-horizon-rename",
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
            recipes=_without(state.recipes, former),
            parts=_without(state.parts, former) | self.blocks,
        )

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["horizon"], {name: Part.from_data(part) for name, part in data["blocks"].items()})


@dataclass
class _HandCommand(Command):
    horizon: str

    @property
    @abstractmethod
    def edit(self) -> HandEdit:
        """The change as the recipe has it."""

    def on(self, state: State) -> State:
        recipe = state.recipes.get(self.horizon)
        if recipe is None:
            raise DocumentError(
                message(
                    "project.no-surface-adjust-fit",
                    "'{name}' has no surface to adjust. Fit it first.",
                    name=self.horizon,
                )
            )
        changed = replace(recipe, edits=(*recipe.edits, self.edit))
        return replace(state, recipes={**state.recipes, self.horizon: changed})


@dataclass
class AdjustControlPoint(_HandCommand):
    """A control point raised or lowered by hand, metres."""

    kind = "adjust"
    patch: str
    i: int
    j: int
    dz: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "step.move-control-point", "Move control point {i}, {j} of {patch} by {dz:+.3f} m ({name})",
            i=self.i, j=self.j, patch=self.patch, dz=self.dz, name=self.horizon,
        )  # fmt: skip

    @property
    def edit(self) -> HandEdit:  # noqa: D102
        return Move(self.patch, self.i, self.j, self.dz)


@dataclass
class ChangeWeight(_HandCommand):
    """Another weight for a control point of the periphery."""

    kind = "weigh"
    patch: str
    i: int
    j: int
    weight: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "step.weight", "Weight {weight:g} for control point {i}, {j} of {patch} ({name})",
            weight=self.weight, i=self.i, j=self.j, patch=self.patch, name=self.horizon,
        )  # fmt: skip

    @property
    def edit(self) -> HandEdit:  # noqa: D102
        return Weigh(self.patch, self.i, self.j, self.weight)


@dataclass
class PullToPoint(_HandCommand):
    """The surface pulled to one of its data points."""

    kind = "pull"
    index: int
    share: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message("step.pull", "Pull {name} to point {number}", name=self.horizon, number=self.index + 1)

    @property
    def edit(self) -> HandEdit:  # noqa: D102
        return Pull(self.index, self.share)


@dataclass
class PushApart(Command):
    """Horizons of a sequence pushed apart where they crossed; ``moved`` names those that had to move."""

    kind = "apart"
    moved: tuple[str, ...]
    sequence: tuple[str, ...]
    minimum: float

    @property
    def text(self) -> Message:  # noqa: D102
        return message("step.separate", "Push apart {names}", names=", ".join(self.moved))

    def recipes(self, state: State) -> dict[str, Recipe]:
        """Return the new recipes of the horizons that move."""
        missing = [name for name in self.sequence if name not in state.recipes]
        if missing:
            raise DocumentError(
                message(
                    "project.no-surface-moved-fit",
                    "'{name}' has no surface that could be moved. Fit it first.",
                    name=missing[0],
                )
            )
        return {
            name: replace(former, edits=(*former.edits, Apart(self.sequence, self.minimum, others)))
            for name in self.moved
            for former in (state.recipes[name],)
            for others in (tuple(state.recipes[other] for other in self.sequence if other != name),)
        }

    def on(self, state: State) -> State:  # noqa: D102
        return replace(state, recipes={**state.recipes, **self.recipes(state)})

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
        return message("step.order", "Order of the horizons")

    def on(self, state: State) -> State:  # noqa: D102
        if sorted(self.order) != sorted(state.order):
            raise DocumentError(
                message(
                    "project.order-name-horizon-once",
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
        return message("step.rename", "Rename the site to {name}", name=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        if not self.name.strip():
            raise DocumentError(message("project.site-name-empty-give", "The site's name is empty. Give it a word."))
        return replace(state, name=self.name)


#: Commands by the word that names them in the journal.
COMMANDS: dict[str, type[Command]] = {
    command.kind: command
    for command in (
        SetSettings, SetCore, ExcludeRow, IncludeRow, SetSurface, PartAtFaults, AdjustControlPoint, ChangeWeight,
        PullToPoint, PushApart, SetOrder, RenameSite,
    )
}  # fmt: skip


def command_from(data: Mapping[str, Any]) -> Command:
    """Return a command from what its ``to_data`` gave; KeyError, TypeError or ValueError if it is none."""
    return COMMANDS[data["kind"]].from_data(data)


def _known(state: State, horizon: str) -> None:
    if horizon not in state.order:
        names = ", ".join(state.order) or message("site.none", "none")
        raise DocumentError(
            message(
                "project.site-no-horizon",
                "The site has no horizon '{name}'. It has {names}.",
                name=horizon,
                names=names,
            )
        )


def _without(values: Mapping[str, Any], names: Collection[str]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if name not in names}


def _plain(value: Any) -> Any:
    if isinstance(value, (Recipe, Part)):
        return value.to_data()
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, (FitSettings, Row)):
        return asdict(value)
    return value

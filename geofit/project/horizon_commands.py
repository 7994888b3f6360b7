"""Renaming, removing and merging horizons as steps that can be undone."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

from geofit.data.messages import Message, message
from geofit.project.command import Command, known
from geofit.project.horizon_edits import HorizonEdit, renamed_body, renamed_provenance
from geofit.project.provenance import DocumentError, Row
from geofit.project.state import State

if TYPE_CHECKING:
    from geofit.project.document import Document

__all__ = ["MergeHorizons", "RemoveHorizons", "RenameHorizon"]

T = TypeVar("T")


@dataclass
class RenameHorizon(Command):
    """Another name for a horizon; its surface stays, and so do bodies that lie between it and others."""

    kind = "rename horizon"
    horizon: str
    name: str

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-rename-horizon", "Rename {old} to {new}", old=self.horizon, new=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        old, new = self.horizon, self.name
        _free(state, (old,))
        _new_name(state, new, ())

        def keys(values: Mapping[str, T]) -> dict[str, T]:
            return {new if name == old else name: value for name, value in values.items()}

        provenances = {name: renamed_provenance(one, old, new) for name, one in keys(state.provenances).items()}
        return replace(
            state,
            order=tuple(new if name == old else name for name in state.order),
            settings=keys(state.settings),
            excluded=keys(state.excluded),
            provenances=provenances,
            earlier={
                name: replace(one, provenance=renamed_provenance(one.provenance, old, new))
                for name, one in keys(state.earlier).items()
            },
            horizons=(*state.horizons, HorizonEdit("renamed", (old,), new)),
            bodies={
                name: replace(record, provenance=renamed_body(record.provenance, old, new))
                for name, record in state.bodies.items()
            },
        )

    def redo(self, document: Document) -> None:
        """Do it; what was made is not made again."""
        self.on(document.state)
        document.rename_results(self.horizon, self.name)
        super().redo(document)

    def undo(self, document: Document) -> None:
        """Take it back; what was made meanwhile is kept, too."""
        document.rename_results(self.name, self.horizon)
        super().undo(document)

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["horizon"], data["name"])


@dataclass
class RemoveHorizons(Command):
    """Horizons that are not worked on; their rows stay in the files."""

    kind = "remove horizons"
    horizons: tuple[str, ...]

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-remove-horizons", "Remove {names}", names=", ".join(self.horizons))

    def on(self, state: State) -> State:  # noqa: D102
        _free(state, self.horizons)
        if set(state.order) <= set(self.horizons):
            raise DocumentError(
                message("project.last-horizon", "A site needs a horizon: the last one cannot be removed.")
            )
        return _without(state, self.horizons, HorizonEdit("removed", self.horizons))

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(tuple(data["horizons"]))


@dataclass
class MergeHorizons(Command):
    """Several horizons as one, with the settings of the first; ``excluded`` are its rows that are left out."""

    kind = "merge horizons"
    horizons: tuple[str, ...]
    name: str
    excluded: tuple[Row, ...] = ()

    @property
    def text(self) -> Message:  # noqa: D102
        return message(
            "project.step-merge-horizons", "Merge {names} to {new}", names=", ".join(self.horizons), new=self.name
        )

    def on(self, state: State) -> State:  # noqa: D102
        _free(state, self.horizons)
        if len(set(self.horizons)) < 2:
            raise DocumentError(message("project.merge-two", "Choose at least two horizons to merge."))
        _new_name(state, self.name, self.horizons)
        at = min(state.order.index(name) for name in self.horizons)
        first = state.settings[self.horizons[0]]
        rest = _without(state, self.horizons, HorizonEdit("merged", self.horizons, self.name))
        order = list(rest.order)
        order.insert(at, self.name)
        excluded = {self.name: frozenset(self.excluded)} if self.excluded else {}
        return replace(
            rest,
            order=tuple(order),
            settings={**rest.settings, self.name: first},
            excluded={**rest.excluded, **excluded},
        )

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        rows = tuple(Row(**row) for row in data["excluded"])
        return cls(tuple(data["horizons"]), data["name"], rows)


def _free(state: State, names: Collection[str]) -> None:
    """Raise DocumentError where a horizon is absent, or blocks hang on it."""
    for name in names:
        known(state, name)
        for part in state.parts.values():
            if name in state.parts or name in (part.horizon, *(fault.horizon for fault in part.faults)):
                raise DocumentError(
                    message(
                        "project.horizon-in-blocks",
                        "'{name}' is a block, or a fault that bounds blocks. Undo the split at faults first.",
                        name=name,
                    )
                )


def _new_name(state: State, name: str, instead: Collection[str]) -> None:
    taken = {other.casefold() for other in state.order if other not in instead}
    if not name.strip() or name != name.strip() or name.casefold() in taken:
        raise DocumentError(
            message(
                "project.horizon-name",
                "'{name}' cannot be the name of a horizon: it is empty, has blanks at an end, or is taken.",
                name=name,
            )
        )


def _without(state: State, names: Collection[str], edit: HorizonEdit) -> State:
    def kept(values: Mapping[str, T]) -> dict[str, T]:
        return {name: value for name, value in values.items() if name not in names}

    return replace(
        state,
        order=tuple(name for name in state.order if name not in names),
        settings=kept(state.settings),
        excluded=kept(state.excluded),
        provenances=kept(state.provenances),
        earlier=kept(state.earlier),
        horizons=(*state.horizons, edit),
    )

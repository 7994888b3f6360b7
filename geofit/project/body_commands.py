"""Changes of the bodies of a document: fitted, renamed, deleted, drawn another way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from geofit.data.messages import Message, message
from geofit.project.body_record import BodyRecord, BodyStyle, ClosedMesh, MorphFrame
from geofit.project.command import Command
from geofit.project.provenance import DocumentError
from geofit.project.state import State

__all__ = ["DeleteBody", "RenameBody", "SetBody", "StyleBody", "body_of"]


def body_of(state: State, name: str) -> BodyRecord:
    """Return a body of a state; DocumentError if it has none of that name."""
    if name not in state.bodies:
        names = ", ".join(state.bodies) or message("data.none", "none")
        raise DocumentError(
            message("project.no-body", "There is no body '{name}'. The bodies are: {names}.", name=name, names=names)
        )
    return state.bodies[name]


@dataclass
class SetBody(Command):
    """A body that was fitted, read or taken from a metamorphosis: a new one, or another one of that name."""

    kind = "body"
    name: str
    record: BodyRecord

    @property
    def text(self) -> Message:  # noqa: D102
        if isinstance(self.record.provenance.source, MorphFrame):
            return message("project.step-body-frame", "Take a frame as body {name}", name=self.name)
        if isinstance(self.record.provenance.source, ClosedMesh):
            return message("project.step-body-read", "Read body {name}", name=self.name)
        return message("project.step-body", "Fit body {name}", name=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        if not self.name.strip():
            raise DocumentError(message("project.body-nameless", "The body has no name. Give it one."))
        return replace(state, bodies={**state.bodies, self.name: self.record})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["name"], BodyRecord.from_data(data["record"]))


@dataclass
class RenameBody(Command):
    """Another name for a body; its place among the others stays."""

    kind = "body-rename"
    name: str
    new: str

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-body-rename", "Rename body {name} to {new}", name=self.name, new=self.new)

    def on(self, state: State) -> State:  # noqa: D102
        body_of(state, self.name)
        if not self.new.strip():
            raise DocumentError(message("project.body-nameless", "The body has no name. Give it one."))
        if self.new in state.bodies:
            raise DocumentError(
                message("project.body-exists", "There is a body '{name}' already. Choose another name.", name=self.new)
            )
        bodies = {self.new if name == self.name else name: record for name, record in state.bodies.items()}
        return replace(state, bodies=bodies)


@dataclass
class DeleteBody(Command):
    """A body taken out of the document."""

    kind = "body-delete"
    name: str

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-body-delete", "Delete body {name}", name=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        body_of(state, self.name)
        return replace(state, bodies={name: record for name, record in state.bodies.items() if name != self.name})


@dataclass
class StyleBody(Command):
    """Another colour, opacity or visibility of a body."""

    kind = "body-style"
    name: str
    style: BodyStyle

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-body-style", "Style of body {name}", name=self.name)

    def on(self, state: State) -> State:  # noqa: D102
        record = replace(body_of(state, self.name), style=self.style)
        return replace(state, bodies={**state.bodies, self.name: record})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(data["name"], BodyStyle(**data["style"]))

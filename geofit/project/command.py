"""What a change of a document is: checked before anything changes, undone, and told as data."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar

from geofit.data.messages import Message, message
from geofit.data.settings import FitSettings
from geofit.project.body_record import BodyRecord, BodyStyle
from geofit.project.provenance import DocumentError, Part, Provenance, Row
from geofit.project.state import State

if TYPE_CHECKING:
    from geofit.project.document import Document

__all__ = ["Command", "known"]


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
                message("project.step-not-done", "'{step}' was not done yet and cannot be undone.", step=self.text)
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


def known(state: State, horizon: str) -> None:
    """Raise DocumentError if the state has no such horizon."""
    if horizon not in state.order:
        names = ", ".join(state.order) or message("data.none", "none")
        raise DocumentError(
            message(
                "project.site-no-horizon",
                "The site has no horizon '{name}'. It has {names}.",
                name=horizon,
                names=names,
            )
        )


def _plain(value: Any) -> Any:
    if isinstance(value, (Provenance, Part, BodyRecord)):
        return value.to_data()
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, tuple) and value and isinstance(value[0], Row):
        return [asdict(row) for row in value]
    if isinstance(value, (FitSettings, Row, BodyStyle)):
        return asdict(value)
    return value

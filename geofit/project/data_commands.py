"""Other data for an open site: files that were added, or read again because they changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from geofit.data.messages import Message, message, plural_message
from geofit.data.settings import FitSettings
from geofit.project.command import Command
from geofit.project.provenance import DocumentError, Earlier, Part, Provenance, Row, settings_from
from geofit.project.state import State

if TYPE_CHECKING:
    from geofit.project.document import Document

__all__ = ["ChangeData"]


@dataclass
class ChangeData(Command):
    """Other data for the site.

    ``data`` names them, ``files`` are those that are new or changed, ``added`` all tables that the site file does not
    have. ``settings`` has every horizon that the site has now, in the order of its files, ``parts`` the blocks that
    stay, ``excluded`` the rows as they are called now, ``earlier`` the surfaces that can be compared, and ``carried``
    what surfaces stay whose points are on other lines of their files now.
    """

    kind = "data"
    data: str
    files: tuple[str, ...]
    added: tuple[str, ...]
    settings: dict[str, FitSettings]
    parts: dict[str, Part]
    excluded: dict[str, tuple[Row, ...]]
    earlier: dict[str, Earlier]
    carried: dict[str, Provenance] = field(default_factory=dict)

    @property
    def text(self) -> Message:  # noqa: D102
        return plural_message(
            "project.step-data", "New data: {file}", "New data: {count} files, the first {file}",
            count=len(self.files), file=self.files[0] if self.files else "",
        )  # fmt: skip

    def on(self, state: State) -> State:  # noqa: D102
        # A site may have bodies alone; one that loses all its horizons is an error.
        if state.order and not self.settings:
            raise DocumentError(message("project.data-no-horizon", "The new data have no horizon."))
        order = [name for name in state.order if name in self.settings]
        for at, name in enumerate(self.settings):
            if name not in order:
                order.insert(min(at, len(order)), name)
        return replace(
            state,
            order=tuple(order),
            settings={name: state.settings.get(name, new) for name, new in self.settings.items()},
            excluded={name: frozenset(rows) for name, rows in self.excluded.items() if rows},
            provenances={
                name: self.carried.get(name, one) for name, one in state.provenances.items() if name in self.settings
            },
            parts=self.parts,
            data=self.data,
            added=self.added,
            earlier={name: one for name, one in {**state.earlier, **self.earlier}.items() if name in self.settings},
        )

    def redo(self, document: Document) -> None:
        """Do it; surfaces whose points have only moved to other lines are not made again."""
        after, former = self.on(document.state), document.state.provenances
        document.carry_results(after, {former[name]: now for name, now in self.carried.items() if name in former})
        super().redo(document)

    def undo(self, document: Document) -> None:
        """Take it back; what was found out meanwhile about surfaces that stay is kept."""
        if self._before is not None:
            former = self._before.provenances
            names = [name for name in self.carried if name in former]
            document.carry_results(self._before, {self.carried[name]: former[name] for name in names})
        super().undo(document)

    def to_data(self) -> dict[str, Any]:  # noqa: D102
        return {
            "kind": self.kind,
            "data": self.data,
            "files": list(self.files),
            "added": list(self.added),
            "settings": {name: asdict(settings) for name, settings in self.settings.items()},
            "parts": {name: part.to_data() for name, part in self.parts.items()},
            "excluded": {name: [asdict(row) for row in rows] for name, rows in self.excluded.items()},
            "earlier": {name: one.to_data() for name, one in self.earlier.items()},
            "carried": {name: one.to_data() for name, one in self.carried.items()},
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(
            data["data"],
            tuple(data["files"]),
            tuple(data["added"]),
            {name: settings_from(settings) for name, settings in data["settings"].items()},
            {name: Part.from_data(part) for name, part in data["parts"].items()},
            {name: tuple(Row(**row) for row in rows) for name, rows in data["excluded"].items()},
            {name: Earlier.from_data(one) for name, one in data["earlier"].items()},
            {name: Provenance.from_data(one) for name, one in data.get("carried", {}).items()},
        )

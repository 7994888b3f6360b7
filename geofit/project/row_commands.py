"""Rows of files that take part in the fit of a horizon, or do not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from geofit.data.messages import Message, message, plural_message
from geofit.project.command import Command, known
from geofit.project.provenance import DocumentError, Row
from geofit.project.state import State

__all__ = ["ExcludeRows", "IncludeRows"]


@dataclass
class _RowCommand(Command):
    horizon: str
    rows: tuple[Row, ...]

    def _excluded(self, state: State) -> frozenset[Row]:
        known(state, self.horizon)
        return state.excluded.get(self.horizon, frozenset())

    def _with(self, state: State, rows: frozenset[Row]) -> State:
        return replace(state, excluded={**state.excluded, self.horizon: rows})

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:
        # One row a command, as journals of earlier versions have it.
        rows = data["rows"] if "rows" in data else [data["row"]]
        return cls(data["horizon"], tuple(Row(**row) for row in rows))


@dataclass
class ExcludeRows(_RowCommand):
    """Rows of files that take no part in the fit of a horizon."""

    kind = "exclude"

    @property
    def text(self) -> Message:  # noqa: D102
        first = self.rows[0]
        return plural_message(
            "project.step-exclude",
            "Exclude {file} row {row} from {name}",
            "Exclude {count} rows from {name}, the first {file} row {row}",
            count=len(self.rows),
            file=first.file,
            row=first.row,
            name=self.horizon,
        )

    def on(self, state: State) -> State:  # noqa: D102
        rows = self._excluded(state)
        for row in self.rows:
            if row in rows:
                raise DocumentError(
                    message(
                        "project.row-excluded-already",
                        "{file} row {row} is excluded from '{name}' already.",
                        file=row.file,
                        row=row.row,
                        name=self.horizon,
                    )
                )
        return self._with(state, rows.union(self.rows))


@dataclass
class IncludeRows(_RowCommand):
    """Rows that were excluded take part again."""

    kind = "include"

    @property
    def text(self) -> Message:  # noqa: D102
        first = self.rows[0]
        return plural_message(
            "project.step-include",
            "Include {file} row {row} in {name}",
            "Include {count} rows in {name}, the first {file} row {row}",
            count=len(self.rows),
            file=first.file,
            row=first.row,
            name=self.horizon,
        )

    def on(self, state: State) -> State:  # noqa: D102
        rows = self._excluded(state)
        for row in self.rows:
            if row not in rows:
                raise DocumentError(
                    message(
                        "project.row-not-excluded",
                        "{file} row {row} is not excluded from '{name}'.",
                        file=row.file,
                        row=row.row,
                        name=self.horizon,
                    )
                )
        return self._with(state, rows.difference(self.rows))

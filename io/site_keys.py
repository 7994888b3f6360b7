"""The keys of a site file: what may stand where, and clear words for what may not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from geofit.data.errors import InputError
from geofit.data.messages import Message, Untranslated, message
from geofit.data.numbers import is_finite, shown
from geofit.data.settings import FitSettings
from geofit.io.hints import nearest_name
from geofit.io.mapping import ColumnMapping
from geofit.io.source import Source

__all__ = ["HORIZON", "SETTINGS", "TABLE", "TOP", "Reader"]

SETTINGS = tuple(f.name for f in fields(FitSettings))

#: Keys of a table that names a text file.
TABLE = ("file", "table", "encoding", "sep", "decimal", "columns", "unit", "measure", "crs")
HORIZON = ("name", "top", "base", "occurrence", "thinner", "accuracy", *SETTINGS)
TOP = (
    "site",
    "report",
    "boundary",
    "ground",
    "boreholes",
    "adits",
    "section_lines",
    "section",
    "sections",
    "level",
    "traces",
    "picks",
    "horizon_columns",
    "grids",
    "orientations",
    "horizon",
    "faults",
)

_KINDS = {
    str: message("io.a-text", "a text"),
    dict: message("io.a-table", "a table"),
    list: message("io.a-list", "a list"),
    float: message("io.a-number", "a number"),
}


class Reader:
    """Takes typed values out of one site file; every complaint names the file and the key.

    ``mappings`` fill in what the site file does not state of a table, ``target`` is the site's coordinate system,
    ``unit`` that of lengths in tables which do not mark theirs.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.file = path, path.name
        self.mappings: tuple[ColumnMapping, ...] = ()
        self.target: str | None = None
        self.unit: str | None = None

    def fail(self, reason: Message, remedy: Message, key: str | None = None, value: Any = None) -> InputError:
        """Return the error for a key."""
        return InputError(
            reason,
            remedy,
            file=self.file,
            column=key,
            value=None if value is None else value if isinstance(value, str) else shown(value),
        )

    def keys(self, table: Mapping[str, Any], allowed: Iterable[str], where: Message | str) -> None:
        """Refuse keys that are not allowed, naming the nearest that is."""
        allowed = list(allowed)
        for key in table:
            if key not in allowed:
                raise self.fail(
                    message("io.no-key", "{where} has no key '{key}'", where=where, key=Untranslated(key)),
                    nearest_name(
                        key,
                        allowed,
                        message("io.known-keys", "The keys are {names}.", names=", ".join(allowed)),
                        cutoff=0.5,
                    ),
                    key,
                )

    def get(self, table: Mapping[str, Any], key: str, kind: type, where: Message | str) -> Any:
        """Return the value of a key of the right kind, None if it is absent."""
        value = table.get(key)
        if value is None:
            return None
        numeric = is_finite(value)
        if not (numeric if kind is float else isinstance(value, kind)):
            raise self.fail(
                message(
                    "io.mapping-value-wrong-kind",
                    "{key} in {where} must be {kind}",
                    key=Untranslated(key),
                    where=where,
                    kind=_KINDS[kind],
                ),
                message("io.correct-value", "Correct its value."),
                key,
                value,
            )
        return float(value) if kind is float else value

    def need(self, table: Mapping[str, Any], key: str, kind: type, where: Message | str, remedy: Message) -> Any:
        """Return the value of a key that must be there."""
        value = self.get(table, key, kind, where)
        if value is None:
            raise self.fail(
                message("io.missing-key", "{where} has no '{key}'", where=where, key=Untranslated(key)), remedy, key
            )
        return value

    def tables(self, top: Mapping[str, Any], key: str) -> list[dict[str, Any]]:
        """Return what stands under ``[key]`` or repeatedly under ``[[key]]``."""
        value = top.get(key, [])
        value = [value] if isinstance(value, dict) else value
        if not isinstance(value, list) or not all(isinstance(table, dict) for table in value):
            raise self.fail(
                message("io.no-table", "'{key}' is not a table", key=Untranslated(key)),
                message("io.write-above-keys", "Write [{key}] or [[{key}]] above its keys.", key=Untranslated(key)),
                key,
            )
        return value

    def source(self, value: Any, where: Message | str, more: Iterable[str] = (), kind: str = "") -> Source:
        """Return the file that a text or a table with ``file`` names; ``more`` keys are someone else's.

        ``kind`` is the mapping's name for its rows.
        """
        if isinstance(value, str):
            value = {"file": value}
        if not isinstance(value, dict):
            raise self.fail(
                message("io.name-file", "{where} must name a file", where=where),
                message("io.write-name-csv", 'Write "name.csv" or { file = "name.csv" }.'),
                value=value,
            )
        self.keys(value, (*TABLE, *more), where)
        file = self.need(value, "file", str, where, message("io.write-file", 'Write file = "name.csv".'))
        columns = self.get(value, "columns", dict, where) or {}
        for role, column in columns.items():
            if not isinstance(column, (str, int)) or isinstance(column, bool):
                raise self.fail(
                    message(
                        "io.column-header-number",
                        "Column '{role}' in {where} must be a header or a number",
                        role=Untranslated(role),
                        where=where,
                    ),
                    message("io.correct-value", "Correct its value."),
                    role,
                    column,
                )
        source = Source(
            path=self.path.parent / file,
            name=file,
            encoding=self.get(value, "encoding", str, where),
            sep=self.get(value, "sep", str, where),
            decimal=self.get(value, "decimal", str, where),
            columns=columns,
            table=self.get(value, "table", str, where) or "",
            unit=self.get(value, "unit", str, where),
            measure=self.get(value, "measure", str, where),
            crs=self.get(value, "crs", str, where),
            target=self.target,
            usual_unit=self.unit,
        )
        for mapping in self.mappings:
            if mapping.suits(file, source.table, kind):
                return mapping.fill(source)
        return source

"""Column mappings: how the tables of a site are read, saved as TOML, edited by hand, used again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message
from geofit.data.numbers import shown
from geofit.io.columns import SCHEMAS
from geofit.io.hints import nearest_name
from geofit.io.source import Source
from geofit.io.toml_file import parse_toml
from geofit.io.toml_text import toml_key, toml_value

__all__ = ["KINDS", "ColumnMapping", "load_mappings", "require_known", "save_mappings"]

VERSION = 1
#: What a table or drawing can hold; "skip" leaves it out.
KINDS = (*SCHEMAS, "ground", "grid", "drawing", "skip")


def require_known(kind: str, file: str) -> None:
    """Raise InputError unless a kind of table is one of :data:`KINDS`."""
    if kind not in KINDS:
        raise InputError(
            message("io.mapping-kind-unknown", "A mapping has no kind '{kind}'", kind=Untranslated(kind)),
            nearest_name(kind, KINDS, message("io.known-kinds", "The kinds are {names}.", names=", ".join(KINDS))),
            file=file,
        )


@arguments_checked
@dataclass(frozen=True, kw_only=True)
class ColumnMapping:
    """How one table, or every table of a layout, is read.

    Parameters
    ----------
    file : str
        Name of the file, or a pattern such as ``"*_collar.csv"``.
    kind : str
        One of :data:`KINDS`: what its rows are.
    columns : mapping of str to str or int
        Column of each role: its header, or its number from 1.
    table : str
        Sheet, group or layer.
    horizons : sequence of str or int
        Columns of which each holds one horizon, for the kind "horizon columns".
    encoding, sep, decimal, unit, measure, crs : str, optional
        As in :class:`geofit.io.Source`; what is ``None`` is guessed at reading.
    """

    file: str
    kind: str
    columns: Mapping[str, str | int] = field(default_factory=dict)
    table: str = ""
    horizons: tuple[str | int, ...] = ()
    encoding: str | None = None
    sep: str | None = None
    decimal: str | None = None
    unit: str | None = None
    measure: str | None = None
    crs: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "horizons", tuple(self.horizons))
        require_known(self.kind, self.file)

    def suits(self, file: str, table: str = "", kind: str | None = None) -> bool:
        """Whether the mapping is for a table of a file; case does not count, nor the folder if it names none."""
        name, pattern = (text.replace("\\", "/").casefold() for text in (file, self.file))
        name = name if "/" in pattern else Path(name).name
        return (
            (name == pattern or fnmatchcase(name, pattern))
            and (not self.table or not table or self.table == table)
            and kind in (None, self.kind)
        )

    def fill(self, source: Source) -> Source:
        """Return a source with what it does not state itself."""
        own = {
            name: getattr(self, name)
            for name in ("encoding", "sep", "decimal", "unit", "measure", "crs")
            if getattr(source, name) is None
        }
        return replace(
            source,
            table=source.table or self.table,
            columns={**self.columns, **source.columns},
            horizons=source.horizons or self.horizons,
            **own,
        )

    def source(self, path: str | Path) -> Source:
        """Return a file as this mapping reads it."""
        return self.fill(Source(path=Path(path)))


@arguments_checked
def save_mappings(
    mappings: Sequence[ColumnMapping], path: str | Path, remarks: Mapping[tuple[int, str], str] | None = None
) -> None:
    """Write column mappings as TOML.

    Parameters
    ----------
    mappings : sequence of ColumnMapping
        The mappings.
    path : path
        The file, usually ``*.toml``.
    remarks : mapping of (int, str) to str, optional
        Comments, by the index of the mapping and the role of the column.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    Keys: ``docs/site_file.md``.
    """
    lines = [f"version = {VERSION}", ""]
    for i, mapping in enumerate(mappings):
        lines += ["[[table]]", f"file = {toml_value(mapping.file)}", f"kind = {toml_value(mapping.kind)}"]
        for name in ("table", "encoding", "sep", "decimal", "unit", "measure", "crs"):
            if value := getattr(mapping, name):
                lines.append(f"{name} = {toml_value(value)}")
        if mapping.horizons:
            lines.append(f"horizons = {toml_value(mapping.horizons)}")
        if mapping.columns:
            lines.append("[table.columns]")
        for role, column in mapping.columns.items():
            remark = (remarks or {}).get((i, role), "")
            lines.append(f"{toml_key(role)} = {toml_value(column)}" + (f"  # {_printable(remark)}" if remark else ""))
        lines.append("")
    with replacing(path) as part:
        part.write_text("\n".join(lines), encoding="utf-8")


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


@arguments_checked
def load_mappings(path: str | Path) -> tuple[ColumnMapping, ...]:
    """Read column mappings: which column of which table has which role.

    Parameters
    ----------
    path : path
        A TOML file that :func:`save_mappings` wrote.

    Returns
    -------
    tuple of ColumnMapping
        In the order of the file.

    Raises
    ------
    InputError
        If the file is not valid TOML, is of a later version, or has an unknown key or kind.

    Notes
    -----
    Keys: ``docs/site_file.md``.
    """
    source = Source(path=Path(path))
    top = parse_toml(source.read(), source.name, message("io.see-formats-page", "See docs/formats_in.md."))
    version, tables = top.pop("version", VERSION), top.pop("table", [])
    if not isinstance(version, int) or version > VERSION:
        raise InputError(
            message(
                "io.mapping-too-new",
                "The mapping is of version {version}; this geofit reads up to {known}",
                version=version,
                known=VERSION,
            ),
            message("io.use-newer-geofit", "Use a newer geofit."),
            file=source.name,
        )
    if top or not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(
            message(
                "io.mapping-key-unknown",
                "A mapping contains only version and [[table]], not '{key}'",
                key=Untranslated(next(iter(top))),
            )
            if top
            else message("io.mapping-not-tables", "A mapping contains only version and [[table]]"),
            message("io.see-formats-page", "See docs/formats_in.md."),
            file=source.name,
        )
    return tuple(_mapping(table, source.name) for table in tables)


def _mapping(table: dict[str, Any], file: str) -> ColumnMapping:
    known = [f.name for f in fields(ColumnMapping)]
    for key, value in table.items():
        if key not in known:
            raise InputError(
                message(
                    "io.mapping-table-key-unknown", "[[table]] of a mapping has no key '{key}'", key=Untranslated(key)
                ),
                nearest_name(key, known, message("io.known-keys", "The keys are {names}.", names=", ".join(known))),
                file=file,
                column=key,
            )
        kind = {
            "columns": message("io.table-headers-numbers", "a table of headers or numbers"),
            "horizons": message("io.list-headers-numbers", "a list of headers or numbers"),
        }
        match key:
            case "columns":
                sound = isinstance(value, dict) and all(type(column) in (str, int) for column in value.values())
            case "horizons":
                sound = isinstance(value, list) and all(type(column) in (str, int) for column in value)
            case _:
                sound = isinstance(value, str)
        if not sound:
            raise InputError(
                message(
                    "io.mapping-value-wrong-kind",
                    "{key} in {where} must be {kind}",
                    key=Untranslated(key),
                    where=message("io.a-mapping", "a mapping"),
                    kind=kind.get(key, message("io.a-text", "a text")),
                ),
                message("io.correct-value", "Correct its value."),
                file=file,
                column=key,
                value=shown(value),
            )
    for key in ("file", "kind"):
        if key not in table:
            raise InputError(
                message(
                    "io.mapping-table-key-missing", "A [[table]] of the mapping has no '{key}'", key=Untranslated(key)
                ),
                message("io.write-key", 'Write {key} = "...".', key=Untranslated(key)),
                file=file,
            )
    return ColumnMapping(**table)

"""One way to read a table, whatever file holds it: text, workbook, AGS, LAS, GOCAD, map formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table, read_table

__all__ = ["TABLE_FORMATS", "USUAL_TABLES", "hidden_tables", "read_any_table", "table_names"]

#: File endings by the module that reads them; every other file is a text table.
TABLE_FORMATS = {
    ".xlsx": "workbook",
    ".xlsm": "workbook",
    ".ags": "ags",
    ".las": "las",
    ".ts": "gocad",
    ".vs": "gocad",
    ".pl": "gocad",
    ".shp": "vector",
    ".gpkg": "vector",
    ".geojson": "vector",
    ".json": "vector",
}

#: The table of a file of several that holds a kind of rows, in order of preference.
USUAL_TABLES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "ags": {"collar": ("LOCA", "HOLE"), "survey": ("HORN",), "intervals": ("GEOL",)},
    "las": {"collar": ("WELL",), "intervals": ("CURVES",)},
}


def table_names(source: Source) -> tuple[str, ...]:
    """Return the sheets, groups or layers of a file; one empty name where it holds a single table.

    Raises
    ------
    InputError
        If the file is missing or damaged.
    MissingDependencyError
        If the package for its format is not installed.
    """
    names: Callable[[Source], tuple[str, ...]]
    match TABLE_FORMATS.get(source.path.suffix.casefold()):
        case "workbook":
            from geofit.io.workbook import sheet_names as names
        case "ags":
            from geofit.io.ags import group_names as names
        case "las":
            from geofit.io.las import log_tables as names
        case "vector":
            from geofit.io.vector import layer_names as names
        case _:
            return ("",)
    return names(source)


def hidden_tables(source: Source) -> tuple[str, ...]:
    """Return the sheets of a workbook that it does not show; other formats hide none."""
    if TABLE_FORMATS.get(source.path.suffix.casefold()) != "workbook":
        return ()
    from geofit.io.workbook import hidden_sheets

    return hidden_sheets(source)


def read_any_table(source: Source, journal: Journal, kind: str = "") -> Table:
    """Read a table; ``kind`` ("collar", "intervals" ...) chooses among the tables of a file of several.

    What is chosen is listed as a note.

    Raises
    ------
    InputError
        If the file cannot be used at all, or it holds several tables and none is named.
    MissingDependencyError
        If the package for its format is not installed.
    """
    form = TABLE_FORMATS.get(source.path.suffix.casefold())
    if form is None:
        return read_table(source, journal)
    if form != "gocad" and not source.table:
        source = _choose(source, form, kind, journal)
    read: Callable[[Source, Journal], Table]
    match form:
        case "workbook":
            from geofit.io.workbook import read_sheet as read
        case "ags":
            from geofit.io.ags import read_group as read
        case "las":
            from geofit.io.las import read_log as read
        case "gocad":
            from geofit.io.gocad import read_vertices as read
        case _:
            from geofit.io.vector import read_features as read
    return read(source, journal)


def _choose(source: Source, form: str, kind: str, journal: Journal) -> Source:
    names = table_names(source)
    if len(names) == 1:
        return source if not names[0] else replace(source, table=names[0], name=source.name)
    for usual in USUAL_TABLES.get(form, {}).get(kind, ()):
        if usual in names:
            journal.add(
                "note",
                source.name,
                message("io.kind-taken", "The {kind} is taken from {table}", kind=kind, table=usual),
                message("io.state-table", "If this is wrong, state table."),
            )
            return replace(source, table=usual)
    raise InputError(
        message(
            "io.several-tables",
            "The file contains {count} tables: {names}",
            count=len(names),
            names=", ".join(names[:40]) or message("data.none", "none"),
        ),
        message("io.name-table", "Name one of them with table = ..."),
        file=source.name,
    )

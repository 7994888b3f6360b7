"""What a file seems to hold before it is read: its tables, their kinds and columns, each with a confidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geofit.data.errors import GeofitError, InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.site import ImportIssue
from geofit.io.columns import HORIZON_COLUMNS, SCHEMAS, SECTIONS, Schema
from geofit.io.formats import TABLE_FORMATS, USUAL_TABLES, hidden_tables, read_any_table, table_names
from geofit.io.guess import USABLE, RoleGuess, guess_roles, sample_of
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping, require_known
from geofit.io.source import Source, as_source
from geofit.io.tables import Table, parse_numbers

__all__ = ["GROUNDS", "TablePreview", "preview_file", "preview_table"]

#: Endings of grids, and rows that a preview shows.
GROUNDS = (".asc", ".grd", ".tif", ".tiff")
SHOWN = 20
#: A kind below it is not used unless the user reports it.
LIKELY = 0.4

_WORDS = {
    "collar": ("collar", "location", "hole", "孔口"),
    "survey": ("survey", "deviation", "测斜"),
    "intervals": ("lith", "geol", "interval", "weather", "strat", "地层", "岩性", "风化"),
    "adit path": ("adit", "tunnel", "平硐", "平洞"),
    "adit contacts": ("adit",),
    "section": ("section", "剖面"),
    "sections": ("sections", "profiles", "剖面"),
    "section lines": ("line", "section", "剖面线"),
    "traces": ("trace", "outcrop", "map", "露头"),
    "picks": ("pick", "point", "contact"),
    "orientations": ("dip", "orientation", "attitude", "产状"),
    "boundary": ("boundary", "outline", "area", "limit", "边界"),
}


@dataclass(frozen=True, eq=False)
class TablePreview:
    """One table of a file with what is guessed of it; plain data, for a window as for the command line.

    Parameters
    ----------
    file : str
        Name of the file.
    table : str
        Sheet, group or layer; empty where the file has one table.
    kind, confidence
        What the rows seem to be, one of :data:`geofit.io.mapping.KINDS` ("" if nothing fits), from 0 to 1.
    kinds : mapping of str to float
        Every kind whose required columns are there, the likeliest first.
    roles : tuple of RoleGuess
        Column of each role of the kind.
    missing : tuple of str
        Required roles without a column.
    header, units, rows : tuple
        As written in the file; the first rows only.
    read : int
        Rows of the whole table.
    encoding, sep, decimal, crs : str
        As found.
    issues : tuple of ImportIssue
        What was found on the way.
    """

    file: str
    table: str
    kind: str
    confidence: float
    kinds: Mapping[str, float]
    roles: tuple[RoleGuess, ...]
    missing: tuple[str, ...]
    header: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    read: int = 0
    encoding: str = ""
    sep: str = ""
    decimal: str = "."
    crs: str = ""
    issues: tuple[ImportIssue, ...] = ()

    @property
    def mapping(self) -> ColumnMapping:
        """The guesses as a mapping, to be changed and saved."""
        return ColumnMapping(
            file=Path(self.file).name,
            kind=self.kind or "skip",
            columns={
                guess.role: guess.column if self.header.count(guess.column) == 1 else guess.index + 1
                for guess in self.roles
            },
            table=self.table,
            encoding=self.encoding or None,
            sep=self.sep or None,
            decimal=self.decimal if self.sep else None,
        )


@arguments_checked
def preview_file(path: str | Path | Source, mappings: Sequence[ColumnMapping] = ()) -> tuple[TablePreview, ...]:
    """Return a preview of each table of a file.

    Parameters
    ----------
    path : path or Source
        Any format that :mod:`geofit.io` reads.
    mappings : sequence of ColumnMapping
        What the user has stated already: it is taken instead of a guess.

    Returns
    -------
    tuple of TablePreview
        Header, first rows, guessed role of each column and what is missing.

    Raises
    ------
    InputError
        If the file is missing, empty or damaged.
    MissingDependencyError
        If the package for its format is not installed.

    Notes
    -----
    Formats: ``docs/formats_in.md``.
    """
    source = as_source(path)
    applicable = [mapping for mapping in mappings if mapping.suits(source.name)]
    if any(mapping.kind == "skip" and not mapping.table for mapping in applicable):
        return (_fixed(source, "skip"),)
    ending = source.path.suffix.casefold()
    stated = [mapping for mapping in applicable if mapping.kind in ("ground", "grid")]
    if ending in GROUNDS or stated:
        source.read()
        return (_fixed(source, stated[0].kind if stated else "ground"),)
    if ending == ".dxf":
        from geofit.io.dxf import count_points

        points = count_points(source)
        parts = [(mapping.kind, mapping.table) for mapping in applicable] or [("drawing", "")]
        return tuple(_fixed(replace(source, table=table, name=source.name), kind, points) for kind, table in parts)
    previews: list[TablePreview] = []
    usual = {name: kind for kind, names in _usual(ending).items() for name in names}
    names, hidden = table_names(source), hidden_tables(source)
    for name in names:
        if usual and name not in usual:
            continue
        own = [mapping for mapping in applicable if not mapping.table or mapping.table == name]
        part = Source(path=source.path, name=source.name, table=name, target=source.target)
        try:
            if own:
                previews += [preview_table(mapping.fill(part), mapping.kind) for mapping in own]
            elif name in hidden:
                previews.append(_left_out(preview_table(part), part))
            else:
                previews.append(preview_table(part, usual.get(name)))
        except InputError as error:
            if len(names) == 1:
                raise
            previews.append(_unreadable(part, error))
    return tuple(previews)


@arguments_checked
def preview_table(source: Source, kind: str | None = None) -> TablePreview:
    """Preview one table.

    Parameters
    ----------
    source : Source
        The table.
    kind : str, optional
        What it is read as, for instance "collar" or "picks"; the likeliest kind if not given.

    Returns
    -------
    TablePreview
        Header, first rows, guessed role of each column and what is missing.

    Raises
    ------
    InputError
        If the file is missing, empty or damaged.

    Notes
    -----
    Headers that are recognized: ``docs/formats_in.md``.
    """
    if kind and kind not in SCHEMAS:
        require_known(kind, source.name)
        return _fixed(source, kind)
    journal = Journal()
    table = read_any_table(source, journal, kind or "")
    if kind is None:
        ranked = _rank(table, source)
        kind, confidence = next(iter(ranked.items()), ("", 0.0))
        if confidence < LIKELY:
            kind = ""
    else:
        ranked, confidence = {kind: 1.0}, 1.0
    guesses = guess_roles(table, SCHEMAS[kind], source) if kind else {}
    sample = range(min(SHOWN, len(table)))
    return TablePreview(
        file=source.path.name,
        table=source.table,
        kind=kind,
        confidence=confidence,
        kinds=ranked,
        roles=tuple(
            guess
            for role, guess in guesses.items()
            if guess.confidence >= USABLE or guess.stated or role in SCHEMAS[kind].required
        ),
        missing=tuple(role for role in (SCHEMAS[kind].needed if kind else ()) if role not in guesses),
        header=table.header,
        units=table.units,
        rows=tuple(tuple(column[i] for column in table.columns) for i in sample),
        read=table.read,
        encoding=table.encoding,
        sep=table.sep,
        decimal=table.decimal,
        crs=table.crs,
        issues=tuple(journal.issues),
    )


def _usual(ending: str) -> Mapping[str, tuple[str, ...]]:
    """Return the tables of an exchange format that hold holes, by kind: their names say what they are."""
    return USUAL_TABLES.get(TABLE_FORMATS.get(ending, ""), {})


def _unreadable(source: Source, error: InputError) -> TablePreview:
    """Return a preview of a table that cannot be read, such as a sheet of notes: its only issue states why."""
    issue = ImportIssue(
        source.name, error.row or 0, error.column or "", error.value or "", "error", error.reason, error.remedy
    )
    return replace(_fixed(source, ""), kinds={}, confidence=0.0, issues=(issue,))


def _left_out(preview: TablePreview, source: Source) -> TablePreview:
    """Return the preview of a hidden table, which is not used: it is often an earlier state of another one."""
    issue = ImportIssue(
        source.name,
        0,
        "",
        "",
        "warning",
        message("io.sheet-hidden", "The sheet is hidden and is not used"),
        message("io.show-sheet", "If it is needed, show it, or state its kind in a mapping file (--mapping)."),
    )
    return replace(preview, kind="skip", confidence=1.0, roles=(), missing=(), issues=(issue,))


def _fixed(source: Source, kind: str, read: int = 0) -> TablePreview:
    return TablePreview(source.path.name, source.table, kind, 1.0, {kind: 1.0}, (), (), read=read)


def _rank(table: Table, source: Source) -> dict[str, float]:
    """Return the kinds whose required columns are there, the likeliest first."""
    ranked: dict[str, float] = {}
    for name, schema in SCHEMAS.items():
        if schema is HORIZON_COLUMNS:
            continue  # any table with a place and a number could be one
        try:
            guesses = guess_roles(table, schema, source)
        except GeofitError:
            continue  # the user named columns of another kind
        if all(role in guesses for role in _needed(schema, source)):
            merit = _merit(table, schema, guesses)
            stem = source.path.stem.casefold() + source.table.casefold()
            if any(word in stem for word in _WORDS[name]):
                merit = merit + 0.2 * (1.0 - merit)
            elif schema is SCHEMAS["collar"] and any(word in stem for word in _WORDS["picks"]):
                # Holes with a place are collars, unless the file states that the places are points of horizons.
                merit *= 0.6
            if merit > 0:
                ranked[name] = round(merit, 2)
    return dict(sorted(ranked.items(), key=lambda item: -item[1]))


def _needed(schema: Schema, source: Source) -> list[str]:
    """Return the roles that must be found: not degrees where a target is named, nor a collar's height on the ground."""
    spared = {"x", "y"} if source.target else set[str]()
    return [role for role in schema.needed if role not in spared | ({"z"} if schema.name == "collar" else set())]


def _merit(table: Table, schema: Schema, guesses: Mapping[str, RoleGuess]) -> float:
    """Return how likely a table is of a kind: its columns' confidence, and what is telling about each kind."""
    found = [guesses[role].confidence for role in schema.required if role in guesses]
    merit = min(found, default=0.0) * 0.5 + sum(found) / max(len(schema.required), 1) * 0.5
    if any(guess.basis == "values" for guess in guesses.values()):
        return merit
    if not table.named:
        return merit if schema.name == "picks" else 0.5 * merit
    extra = sum(role in guesses for role in schema.optional)
    match schema.name:
        case "collar":
            merit *= _once(table, guesses, "hole") * (1.0 if "z" in guesses else 0.8)
            # Collars name no horizon: such a table holds picks, one a hole.
            merit *= 0.8 if "horizon" in guess_roles(table, SCHEMAS["picks"], Source(path=Path(table.name))) else 1.0
        case "intervals" if "from" not in guesses:
            # Layer upon layer repeats the hole; a table of one row a hole shows how deep the holes are.
            merit *= 0.85 if _once(table, guesses, "hole") < 0.95 else 0.4
        case "picks":
            merit *= 0.9 if "horizon" in guesses else 0.75
            # Lines of a map that has no elevations are exported at 0.
            merit *= 0.4 if "horizon" in guesses and _flat(table, guesses["z"]) else 1.0
        case "orientations":
            attitude = "dip" in guesses and {"azimuth", "strike"} & set(guesses)
            merit *= 1.05 if attitude or "nx" in guesses else 0.0
            merit *= 0.5 if "hole" in guess_roles(table, SCHEMAS["collar"], Source(path=Path(table.name))) else 1.0
        case "traces" | "section lines" | "boundary":
            others = guess_roles(table, SCHEMAS["picks"], Source(path=Path(table.name)))
            merit *= 0.5 if "z" in others and not _flat(table, others["z"]) else 0.95
            if schema.name == "boundary":
                merit *= 0.9 if len(table.header) <= 3 and "horizon" not in others else 0.4
                merit *= 0.5 if {"hole", "section"} & set(others) else 1.0
            if schema.name == "section lines" and "horizon" in others:
                merit *= 0.5
        case "section" | "sections":
            # "x" may be a distance, but not beside "y".
            y = guess_roles(table, SCHEMAS["boundary"], Source(path=Path(table.name)))
            merit *= 0.3 if "y" in y else 0.95
            if schema.name == "section" and "section" in guess_roles(table, SECTIONS, Source(path=Path(table.name))):
                merit *= 0.5
    return min(merit + 0.02 * extra * (merit > 0), 1.0)


def _flat(table: Table, guess: RoleGuess) -> bool:
    """Whether a column is 0 in all rows that are looked at."""
    cells = [table.columns[guess.index][i] for i in sample_of(table)]
    return len(cells) > 1 and bool((parse_numbers(cells, table.decimal)[0] == 0).all())


def _once(table: Table, guesses: Mapping[str, RoleGuess], role: str) -> float:
    """Return 1 where no cell of a role repeats, down to 0.3 where all do."""
    cells = [table.columns[guesses[role].index][i] for i in sample_of(table)]
    share = len(set(cells)) / max(len(cells), 1)
    return 0.3 + 0.7 * share

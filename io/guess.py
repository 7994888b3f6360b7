"""Which column holds what: a guess for each role from names and values, with a confidence, open to overruling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_uppercase
from typing import Literal

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import Message, Untranslated, message
from geofit.io.columns import GEOGRAPHIC, SCHEMAS, Schema, plain_name
from geofit.io.guess_values import by_values
from geofit.io.hints import nearest_name
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table, first_names, parse_numbers
from geofit.io.units import with_unit

__all__ = ["RoleGuess", "find_columns", "guess_roles", "locate", "sample_of", "taken_as", "warn_of_depths"]

#: Roles whose cells are words; all others hold numbers.
WORDS = frozenset({"hole", "code", "horizon", "section", "adit", "kind", "side"})
#: Rows that are looked at, evenly spread over the table.
SAMPLE = 400
#: A guess below it is shown but not used.
USABLE = 0.25

#: Words in the headers of depths.
DEPTHS = ("depth", "深", "teufe")

#: What a guess rests on.
Basis = Literal["stated", "name", "place", "values"]

_LIMITS = {"azimuth": (-360.0, 360.0), "dip": (-90.0, 90.0)}


@dataclass(frozen=True)
class RoleGuess:
    """One role of a table and the column that seems to hold it.

    ``confidence`` runs from 0 to 1; ``basis`` is what it rests on, and ``reason`` states it; ``others`` are headers of
    columns that might hold the role as well. ``tied`` is true where one of these has the same name and other cells.
    """

    role: str
    index: int
    column: str
    confidence: float
    reason: Message
    basis: Basis
    others: tuple[str, ...] = ()
    tied: bool = False

    @property
    def stated(self) -> bool:
        """Whether the user named the column."""
        return self.basis == "stated"

    @property
    def doubtful(self) -> bool:
        """Whether a person should look: values alone decided, or two columns have one name."""
        return self.basis == "values" or self.tied


def sample_of(table: Table) -> list[int]:
    """Return the indices of the rows that are looked at."""
    places = np.linspace(0, len(table) - 1, min(SAMPLE, len(table))).astype(int)
    return [int(i) for i in np.unique(places)]


def guess_roles(table: Table, schema: Schema, source: Source) -> dict[str, RoleGuess]:
    """Return a guess for each role that a column can hold.

    What the source states is taken. Else columns whose name is a known spelling compete: an earlier spelling,
    filled cells and values that the role can have make a higher confidence. Where no name is known at all,
    values alone may tell (:mod:`geofit.io.guess_values`); else a table without a header is taken in the order
    of the schema when it has exactly the required columns.

    Raises
    ------
    InputError
        If the source names a role or a column that is not there.
    """
    stated = _stated(table, schema, source)
    found = {
        role: RoleGuess(role, j, table.header[j], 1.0, message("io.stated", "stated"), "stated")
        for role, j in stated.items()
    }
    unknown = not stated and _unknown(table)
    if unknown and (recognized := by_values(table, schema.name)):
        return {
            role: RoleGuess(
                role,
                guess.index,
                table.header[guess.index],
                guess.confidence,
                guess.reason,
                "values",
                tuple(table.header[j] for j in guess.others),
            )
            for role, guess in recognized.items()
        }
    if not table.named:
        if not stated and len(table.header) == len(schema.required):
            return {
                role: RoleGuess(role, j, table.header[j], 0.5, message("io.by-location", "by its place"), "place")
                for j, role in enumerate(schema.required)
            }
        return found
    names = [plain_name(name)[0] for name in table.header] if not _lettered(table) else []
    rows = sample_of(table)
    for role, spellings in {**schema.required, **schema.optional}.items():
        if role in found:
            continue
        taken = {guess.index for guess in found.values()}
        rivals = []
        for j, name in enumerate(names):
            if j in taken or name not in spellings:
                continue
            place = spellings.index(name)
            fit, why = _fit(table, role, j, rows)
            rivals.append((0.95 * (1.0 - 0.3 * place / len(spellings)) * fit, -place, j, why))
        if not rivals:
            continue
        rivals.sort(key=lambda rival: (-rival[0], -rival[1], rival[2]))
        confidence, _, j, why = rivals[0]
        others = tuple(table.header[k] for _, _, k, _ in rivals[1:])
        tied = any(names[k] == names[j] and table.columns[k] != table.columns[j] for _, _, k, _ in rivals[1:])
        found[role] = RoleGuess(role, j, table.header[j], round(confidence, 2), why, "name", others, tied)
    return found


def _unknown(table: Table) -> bool:
    """Whether no column has a name that is known for any role: nameless, lettered as in a spreadsheet, or foreign."""
    known = {
        word
        for schema in SCHEMAS.values()
        for words in (*schema.required.values(), *schema.optional.values())
        for word in words
    }
    names = {plain_name(name)[0] for name in table.header}
    return not table.named or _lettered(table) or not names & (known | GEOGRAPHIC)


def _lettered(table: Table) -> bool:
    """Whether the header is A, B, C ... in order: E is not an easting there."""
    return len(table.header) > 2 and "".join(table.header) == ascii_uppercase[: len(table.header)]


def _fit(table: Table, role: str, j: int, rows: list[int]) -> tuple[float, Message]:
    """Return how well the values of a named column suit a role, 0.1 to 1, and why it is taken or doubted."""
    cells = [table.columns[j][i].strip() for i in rows]
    filled = tuple(cell for cell in cells if cell)
    why = message("io.by-name", "by its name")
    if not filled:
        return (0.1, message("io.name-and-empty-cells", "by its name; all its cells are empty")) if rows else (1.0, why)
    fill = len(filled) / len(cells)
    merit = 0.3 + 0.7 * fill
    if fill < 0.9:
        why = message("io.name-and-filled-cells", "by its name; {share:.0%} of its cells are filled", share=fill)
    if role in WORDS:
        return merit, why
    values, bad = parse_numbers(filled, table.decimal)
    share = 1.0 - sum(with_unit(filled[i], table.decimal) is None for i in bad.tolist()) / len(filled)
    if share < 0.9:
        merit *= max(share, 0.1)
        why = message(
            "io.name-without-numbers", "by its name; {share:.0%} of its cells are not numbers", share=1 - share
        )
    low, high = _LIMITS.get(role, (-np.inf, np.inf))
    known = values[np.isfinite(values)]
    inside = np.mean((known >= low) & (known <= high)) if known.size else 1.0
    if inside < 0.5 and share > 0.5:
        merit *= 0.3
        why = message(
            "io.name-despite-values", "by its name; its values are not between {low:g} and {high:g}", low=low, high=high
        )
    return merit, why


def find_columns(table: Table, schema: Schema, source: Source, journal: Journal) -> dict[str, int]:
    """Return the column index of each role of a table; each guess is listed as a note.

    Raises
    ------
    InputError
        If a required column is missing, or the source names a role or a column that is not there.
    """
    guesses = guess_roles(table, schema, source)
    if guesses and all(guess.basis == "place" for guess in guesses.values()):
        order = ", ".join(schema.required)
        journal.add(
            "warning",
            table.name,
            message("io.header-missing", "No header: the columns are taken as {order}", order=order),
            message("io.add-header", "Add a header."),
            row=1,
        )
        return {role: guess.index for role, guess in guesses.items()}
    columns: dict[str, int] = {}
    for role, guess in guesses.items():
        if role in schema.optional and guess.confidence < USABLE:
            if any(cell.strip() for cell in table.columns[guess.index][:SAMPLE]):
                _warn_of_unused(table, guess, journal)
            continue
        columns[role] = guess.index
        if not guess.stated:
            journal.add(
                "warning" if guess.doubtful else "note",
                table.name,
                taken_as(guess),
                message(
                    "io.state-columns-where-wrong",
                    "If this is wrong, rename the column, or state columns = {entry} in a site or mapping file.",
                    entry=f"{{ {role} = ... }}",
                ),
                column=guess.column,
            )
    if schema.name == "picks":
        _warn_of_constant(table, columns, journal)
        if "z" in columns and source.measure is None:
            warn_of_depths(table.name, table.header, guesses, journal)
    if source.target and (table.named or source.columns):
        columns |= _geographic(table, columns, journal)
    missing = [role for role in schema.needed if role not in columns]
    if missing:
        raise _missing(table, schema, missing)
    return columns


def _warn_of_unused(table: Table, guess: RoleGuess, journal: Journal) -> None:
    journal.add(
        "warning",
        table.name,
        message(
            "io.optional-column-not-used",
            "Column '{column}' is not used as {role}: its cells are not numbers with the decimal mark '{mark}', or not "
            "in its range",
            column=Untranslated(guess.column),
            role=guess.role,
            mark=table.decimal,
        ),
        message(
            "io.state-columns-where-wrong",
            "If this is wrong, rename the column, or state columns = {entry} in a site or mapping file.",
            entry=f"{{ {guess.role} = ... }}",
        ),
        column=guess.column,
    )


def taken_as(guess: RoleGuess) -> Message:
    """Say which column was taken as what, why, how surely, and which other ones it could be."""
    text = message(
        "io.column-guessed",
        "Column '{column}' is taken as {role}, {reason}, confidence {confidence:.2f}",
        column=Untranslated(guess.column),
        role=guess.role,
        reason=guess.reason,
        confidence=guess.confidence,
    )
    if not guess.others:
        return text
    others = tuple(message("io.quoted-name", "'{name}'", name=Untranslated(name)) for name in guess.others)
    return message("io.column-alternatives", "{text}; also possible: {others}", text=text, others=others)


def _geographic(table: Table, columns: Mapping[str, int], journal: Journal) -> dict[str, int]:
    """Return longitude and latitude as x and y, to be projected, where there is no easting and northing."""
    if "x" in columns and "y" in columns:
        return {}
    names = [plain_name(name)[0] for name in table.header]
    found = {}
    for role, words in (("x", ("lon", "long", "longitude", "lng", "经度")), ("y", ("lat", "latitude", "纬度"))):
        j = next((j for j, name in enumerate(names) if name in words), None)
        if j is None:
            return {}
        found[role] = j
    journal.add(
        "warning",
        table.name,
        message(
            "io.columns-taken-as-degrees",
            "'{x}' and '{y}' are taken as longitude and latitude (EPSG:4326) and projected",
            x=Untranslated(table.header[found["x"]]),
            y=Untranslated(table.header[found["y"]]),
        ),
        message("io.state-crs-and-columns", "If this is wrong, state crs and columns."),
    )
    return found


def _warn_of_constant(table: Table, columns: Mapping[str, int], journal: Journal) -> None:
    """Warn of an elevation that is one number wherever several horizons share a place."""
    if not {"x", "y", "z", "horizon"} <= set(columns):
        return
    count = min(len(table), 20 * SAMPLE)
    x, y, z, horizon = (table.columns[columns[role]][:count] for role in ("x", "y", "z", "horizon"))
    if len(set(horizon)) < 2:
        return
    first: dict[tuple[str, str], int] = {}
    pairs = equal = 0
    for i in range(count):
        k = first.setdefault((x[i], y[i]), i)
        if k != i and horizon[k] != horizon[i]:
            pairs, equal = pairs + 1, equal + (z[i] == z[k])
    if pairs >= 3 and equal == pairs:
        journal.add(
            "warning",
            table.name,
            message(
                "io.column-same-for-horizons",
                "'{column}' has the same value for all horizons at one location: it may be a property of the hole",
                column=Untranslated(table.header[columns["z"]]),
            ),
            message(
                "io.state-horizon-elevation",
                "State columns = { z = ... } with the elevation of the horizon.",
            ),
            column=table.header[columns["z"]],
        )


def warn_of_depths(file: str, header: Sequence[str], guesses: Mapping[str, RoleGuess], journal: Journal) -> None:
    """Warn of an elevation that is called a depth, and of depths that nobody reads next to a guessed elevation."""
    z, read = guesses["z"], {guess.index for guess in guesses.values()}
    depths = [j for j, name in enumerate(header) if any(word in name.casefold() for word in DEPTHS)]
    if z.index in depths:
        journal.add(
            "warning",
            file,
            message(
                "io.depth-taken-as-elevation",
                "Column '{column}' is named as a depth but read as an elevation, positive upwards",
                column=Untranslated(z.column),
            ),
            message(
                "io.state-measure-of-points", 'Give elevations, or state measure = "depth" in a site or mapping file.'
            ),
            column=z.column,
        )
    elif z.stated:
        return
    for j in (j for j in depths if j not in read):
        journal.add(
            "warning",
            file,
            message(
                "io.depths-not-read",
                "Column '{depth}' is not used: '{column}' is taken as the elevation of the points, not of the collars",
                depth=Untranslated(header[j]),
                column=Untranslated(z.column),
            ),
            message("io.subtract-depths", "If it is that of the collars, subtract the depth first."),
            column=header[j],
        )


def _stated(table: Table, schema: Schema, source: Source) -> dict[str, int]:
    roles = [*schema.required, *schema.optional]
    columns = {}
    for role, wanted in source.columns.items():
        if role not in roles:
            raise InputError(
                message(
                    "io.role-unknown",
                    "A {kind} table has no column role '{role}'",
                    kind=schema.name,
                    role=Untranslated(role),
                ),
                nearest_name(role, roles, message("io.known-roles", "The roles are {names}.", names=", ".join(roles))),
                file=table.name,
            )
        columns[role] = locate(table, role, wanted)
    return columns


def locate(table: Table, role: str, wanted: str | int) -> int:
    """Return the index of a column that is named by its header, or its number from 1.

    Raises
    ------
    InputError
        If there is no such column.
    """
    if isinstance(wanted, str):
        if wanted in table.header:
            return table.header.index(wanted)
        alike = [j for j, name in enumerate(table.header) if plain_name(name)[0] == plain_name(wanted)[0]]
        if len(alike) == 1:
            return alike[0]
    number = int(wanted) if str(wanted).isascii() and str(wanted).isdigit() else 0
    if 1 <= number <= len(table.header):
        return number - 1
    raise InputError(
        message(
            "io.column-unknown",
            "There is no column '{wanted}' for {role}; the columns are {names}",
            wanted=Untranslated(wanted),
            role=Untranslated(role),
            names=first_names(table.header),
        ),
        message(
            "io.name-or-number-column",
            "Name one of them, or give its number from 1 to {count}.",
            count=len(table.header),
        ),
        file=table.name,
    )


def _missing(table: Table, schema: Schema, missing: list[str]) -> InputError:
    if {"x", "y"} & set(missing) and any(plain_name(name)[0] in GEOGRAPHIC for name in table.header):
        return InputError(
            message(
                "io.degrees-not-metres",
                "Longitude and latitude are degrees; easting and northing in metres are needed",
            ),
            message(
                "io.project-to-site-grid",
                'Project them to the site\'s grid first, or name the grid: [site] crs = "EPSG:..." '
                "(geofit fit and geofit import: --crs).",
            ),
            file=table.name,
        )
    names = tuple(message("io.quoted-name", "'{name}'", name=Untranslated(role)) for role in missing)
    what = (
        message(
            "io.column-not-found",
            "No column for {names} was found in this {kind} table; its columns are {found}",
            names=names,
            kind=schema.name,
            found=first_names(table.header),
        )
        if table.named
        else message(
            "io.column-not-found-no-header",
            "No column for {names} was found in this {kind} table without a header; its columns: {count}",
            names=names,
            kind=schema.name,
            count=len(table.header),
        )
    )
    example = ", ".join(f'{role} = "..."' for role in missing)
    on_ground = schema.name == "collar" and missing == ["z"]
    remedy = message(
        "io.name-column",
        "Name the column in the header, in columns = {{ {example} }} of a site or mapping file, or with --x, --y, "
        "--z, --surface or --section of geofit fit, check and export; a column number, counted from 1, also works.",
        example=example,
    )
    ground = message("io.give-ground", "Or give the ground ([ground], a grid): collars are placed on it.")
    return InputError(
        what,
        message("io.column-pair", "{first} {second}", first=remedy, second=ground) if on_ground else remedy,
        file=table.name,
        row=int(table.lines[0]) - 1 if table.named and len(table) and table.lines[0] > 1 else None,
        column=missing[0],
    )

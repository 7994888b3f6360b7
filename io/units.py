"""Units of length: what a header, a units row or the user says, as metres."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from geofit.data.errors import InputError
from geofit.data.messages import EMPTY, Untranslated, message
from geofit.io.columns import plain_name
from geofit.io.crs import axis_units
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table, parse_numbers
from geofit.io.unit_names import ANGLE_UNITS, DEGREE_WORDS, UNITS, is_unit, unit_marked

__all__ = [
    "ANGLES",
    "DEGREES",
    "LENGTHS",
    "METRES",
    "angle_factors",
    "grid_unit",
    "length_factors",
    "list_conversion",
    "map_units",
    "metres_of",
    "unit_marked",
    "with_unit",
]

#: Metres of one unit. The US survey foot differs by 2 in a million: 1.4 m at a state-plane northing of 2.3e6 ft.
METRES = {"m": 1.0, "ft": 0.3048, "ft-us": 1200.0 / 3937.0, "km": 1000.0, "cm": 0.01, "mm": 0.001}

#: What conversions call a unit.
_NAMES = {"ft": "feet", "ft-us": "US survey feet"}

#: Roles that are lengths.
LENGTHS = frozenset(
    {"x", "y", "z", "x0", "y0", "x1", "y1", "depth", "from", "to", "chainage", "distance", "elevation", "accuracy"}
)
#: Roles that are angles, and what their unit is called here.
ANGLES, DEGREES = frozenset({"azimuth", "dip", "strike"}), "deg"

_WITH_UNIT = re.compile(r"(.*\d[.,]?)\s*([^\W\d_].*|°)")


def with_unit(cell: str, decimal: str) -> tuple[float, str] | None:
    """Return the number and the unit, "deg" or one of METRES, of a cell that holds both; None if it does not.

    Examples
    --------
    >>> [with_unit(cell, ".") for cell in ("12.5 m", "1,234.5ft", "45°", "12.5", "5 T2")]
    [(12.5, 'm'), (1234.5, 'ft'), (45.0, 'deg'), None, None]
    """
    found = _WITH_UNIT.fullmatch(cell.strip())
    if found is None:
        return None
    mark = found.group(2).casefold().strip(" .")
    unit = DEGREES if mark in DEGREE_WORDS else UNITS.get(mark)
    values, bad = parse_numbers((found.group(1),), decimal)
    return None if unit is None or len(bad) else (float(values[0]), unit)


def metres_of(unit: str, file: str | None = None) -> float:
    """Return the metres of a unit that the user states."""
    known = unit_marked(unit)
    if known is None:
        raise InputError(
            message("io.unit-unknown", "The unit '{unit}' is unknown", unit=unit),
            message("io.known-units", "The units are {names}.", names=", ".join(METRES)),
            file=file,
            value=unit,
        )
    return METRES[known]


def length_factors(table: Table, columns: Mapping[str, int], source: Source, journal: Journal) -> dict[str, float]:
    """Return the metres of one unit of each length column that is not in metres; every conversion is listed.

    What the source states holds for all of them; else the mark in the header or the units row, else that of the
    coordinate system, else the site's unit.
    """
    stated = None if source.unit is None else metres_of(source.unit, source.name)
    usual = None if source.usual_unit is None else metres_of(source.usual_unit, source.name)
    own = _of_crs(source) if stated is None else {}
    factors: dict[str, float] = {}
    by_crs: list[str] = []
    for role, j in columns.items():
        if role not in LENGTHS:
            continue
        row = table.units[j] if j < len(table.units) else ""
        unit = unit_marked(plain_name(table.header[j])[1]) or unit_marked(row)
        if stated is None and unit is None and row.strip() and not is_unit(row):
            _list_unknown(table, j, role, row, journal)
        if stated is None and unit is not None:
            factors[role] = METRES[unit]
            if unit != "m":
                _list_mark(table, j, role, unit, journal)
        elif role in own:
            factors[role] = own[role]
            by_crs.append(role)
        elif stated is not None or usual is not None:
            factors[role] = (stated if stated is not None else usual) or 1.0
    if by_crs:
        _list_crs(source, factors, by_crs, journal, doubtful="z" in columns and "z" not in factors)
    factors = {role: factor for role, factor in factors.items() if factor != 1.0}
    given = source.unit or source.usual_unit
    roles = [role for role, factor in factors.items() if factor in (stated, usual) and role not in by_crs]
    if given is not None and roles:
        list_conversion(given, tuple(roles), source.name, journal)
    return factors


def map_units(source: Source, crs: str, journal: Journal, height: str = "") -> tuple[float, float]:
    """Return the metres of one unit in plan and of one of elevation of a map or raster that states its system.

    What the source states holds; else the unit of the system, and ``height``, a mark of the elevations; else the
    site's unit. Conversions are listed.
    """
    own = _of_crs(replace(source, crs=crs)) if source.unit is None else {}
    marked = unit_marked(height) if source.unit is None else None
    if marked is not None and METRES[marked] != 1.0:
        journal.add(
            "note",
            source.name,
            message(
                "io.band-unit-converted",
                "The file states its elevations in {unit}; they are converted to metres",
                unit=Untranslated(marked),
            ),
        )
    if not own:
        unit = grid_unit(source, journal)
        return unit, unit if marked is None else METRES[marked]
    of_system = list(own)
    if marked is not None:
        own["z"], of_system = METRES[marked], [role for role in own if role != "z"]
    usual = 1.0 if source.usual_unit is None else metres_of(source.usual_unit, source.name)
    factors = {"z": usual, **own}
    doubtful = "z" not in own and source.usual_unit is None
    _list_crs(replace(source, crs=crs), factors, of_system, journal, doubtful=doubtful)
    return factors["x"], factors["z"]


def _of_crs(source: Source) -> dict[str, float]:
    """Return the metres of one unit of easting, northing and, where it has one, elevation of the file's system."""
    axes = axis_units(source.crs)
    if not axes:
        return {}
    own = dict(zip(("x", "y", "z"), axes, strict=False))
    return own | {f"{axis}{end}": own[axis] for axis in "xy" for end in "01"}


def _list_crs(
    source: Source, factors: Mapping[str, float], roles: Sequence[str], journal: Journal, *, doubtful: bool
) -> None:
    """List what is converted because the coordinate system counts in another unit; ``doubtful`` are elevations."""
    converted = [role for role in roles if role in ("x", "y", "z") and factors[role] != 1.0]
    if not converted:
        return
    journal.add(
        "warning" if doubtful else "note",
        source.name,
        message(
            "io.crs-unit-converted",
            "The coordinate system {crs} counts in units of {metres:.10g} m; converted to metres: {roles}",
            crs=str(source.crs)[:60],
            metres=factors[converted[0]],
            roles=tuple(converted),
        ),
        message(
            "io.state-unit-of-elevations",
            'Elevations are read as metres. If they are in that unit too, state it: unit = "ft-us".',
        )
        if doubtful
        else EMPTY,
    )


def angle_factors(table: Table, columns: Mapping[str, int], journal: Journal) -> dict[str, float]:
    """Return the degrees of one unit of each column of angles whose header marks gon or radians; each is listed."""
    factors: dict[str, float] = {}
    for role in sorted(ANGLES & columns.keys()):
        j = columns[role]
        header = table.header[j]
        marks = (plain_name(header)[1], table.units[j].strip("[]()<> ") if j < len(table.units) else "")
        mark = next((mark.casefold() for mark in marks if mark.casefold() in ANGLE_UNITS), "")
        if mark:
            factors[role] = ANGLE_UNITS[mark]
            journal.add(
                "note",
                table.name,
                message(
                    "io.angles-converted",
                    "The {role} is marked as {mark}; it is converted to degrees (1 {mark} = {degrees:.10g}°)",
                    role=role,
                    mark=Untranslated(mark),
                    degrees=factors[role],
                ),
                column=header,
            )
    return factors


def _list_mark(table: Table, j: int, role: str, unit: str, journal: Journal) -> None:
    journal.add(
        "warning",
        table.name,
        message(
            "io.unit-converted",
            "The {role} is marked as {mark}; it is converted to metres (1 {unit} = {metres:.10g} m)",
            role=role,
            mark=_NAMES.get(unit, unit),
            unit=unit,
            metres=METRES[unit],
        ),
        message("io.state-unit-metres", 'If they are metres already, state unit = "m".'),
        column=table.header[j],
    )


def _list_unknown(table: Table, j: int, role: str, mark: str, journal: Journal) -> None:
    journal.add(
        "warning",
        table.name,
        message(
            "io.unit-of-column-unknown",
            "The row of units has '{mark}' for the {role}, which is not a known unit of length",
            mark=Untranslated(mark),
            role=role,
        ),
        message(
            "io.state-known-unit",
            "State the unit in the file or site file; known units are {names}.",
            names=", ".join(METRES),
        ),
        column=table.header[j],
    )


def list_conversion(unit: str, roles: tuple[str, ...], file: str, journal: Journal) -> None:
    """List that lengths of a file were converted, for the record of what was done to the data."""
    known = unit_marked(unit) or "m"
    if known == "m":
        return
    text = message(
        "io.stated-unit-converted",
        "Lengths in {mark}, converted to metres (1 {unit} = {metres:.10g} m): {roles}",
        mark=_NAMES.get(known, known),
        unit=known,
        metres=METRES[known],
        roles=roles,
    )
    journal.add("note", file, text)


def grid_unit(source: Source, journal: Journal) -> float:
    """Return the metres of the unit that the user states of a grid or drawing; the conversion is listed."""
    unit = source.unit or source.usual_unit
    if unit is None:
        return 1.0
    list_conversion(unit, ("x", "y", "z"), source.name, journal)
    return metres_of(unit, source.name)

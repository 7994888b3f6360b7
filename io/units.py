"""Units of length: what a header, a units row or the user says, as metres."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.io.columns import plain_name
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table, parse_numbers

__all__ = [
    "ANGLES",
    "DEGREES",
    "LENGTHS",
    "METRES",
    "angle_factors",
    "grid_unit",
    "length_factors",
    "list_conversion",
    "metres_of",
    "unit_marked",
    "with_unit",
]

#: Metres of one unit. The US survey foot differs by 2 in a million: 1.4 m at a state-plane northing of 2.3e6 ft.
METRES = {"m": 1.0, "ft": 0.3048, "ft-us": 1200.0 / 3937.0, "km": 1000.0, "cm": 0.01, "mm": 0.001}

#: What a unit is called, without case, blanks and marks.
_WORDS = {
    "m": "m metre metres meter meters 米",
    "ft": "ft feet foot f ift intft internationalft internationalfeet internationalfoot 英尺 国际英尺",
    "ft-us": "ftus usft usfeet usfoot ft(us) ussft sft surveyft surveyfeet surveyfoot ussurveyft ussurveyfeet "
    "ussurveyfoot 美制测量英尺 测量英尺",
    "km": "km kilometre kilometres kilometer kilometers 千米 公里",
    "cm": "cm centimetre centimetres centimeter centimeters 厘米",
    "mm": "mm millimetre millimetres millimeter millimeters 毫米",
}
_UNITS = {word: unit for unit, words in _WORDS.items() for word in words.split()}
#: What conversions call a unit.
_NAMES = {"ft": "feet", "ft-us": "US survey feet"}

#: Roles that are lengths.
LENGTHS = frozenset(
    {"x", "y", "z", "x0", "y0", "x1", "y1", "depth", "from", "to", "chainage", "distance", "elevation", "accuracy"}
)
#: Roles that are angles, and what their unit is called here.
ANGLES, DEGREES = frozenset({"azimuth", "dip", "strike"}), "deg"

#: Degrees of one unit of the angles that a header marks; "grad" is none: a degree in German, a gon in English.
_ANGLE_UNITS = dict.fromkeys(("gon", "gons", "gradian", "gradians", "百分度"), 0.9)
_ANGLE_UNITS |= dict.fromkeys(("rad", "radian", "radians", "弧度"), 180.0 / math.pi)

_WITH_UNIT = re.compile(r"(.*\d[.,]?)\s*([^\W\d_].*|°)")
_DEGREE_WORDS = {"°", "度", "deg", "degree", "degrees"}


def unit_marked(mark: str) -> str | None:
    """Return the unit that a mark names, alone or with words behind it ("ft bgl", "US survey feet"); None if none.

    Examples
    --------
    >>> [unit_marked(mark) for mark in ("Feet", "ft. AMSL", "US Survey ft", "m", "deg")]
    ['ft', 'ft', 'ft-us', 'm', None]
    """
    words = mark.casefold().strip().strip("[]()<>").replace(",", " ").split()
    for count in range(len(words), 0, -1):
        found = _UNITS.get(re.sub(r"[\s_.\-]", "", "".join(words[:count])))
        if found is not None:
            return found
    return None


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
    unit = DEGREES if mark in _DEGREE_WORDS else _UNITS.get(mark)
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

    What the source states holds for all of them; else the mark in the header or the units row, else the site's unit.
    """
    stated = None if source.unit is None else metres_of(source.unit, source.name)
    usual = None if source.usual_unit is None else metres_of(source.usual_unit, source.name)
    factors: dict[str, float] = {}
    for role, j in columns.items():
        if role not in LENGTHS:
            continue
        mark = plain_name(table.header[j])[1] or (table.units[j] if j < len(table.units) else "")
        unit = unit_marked(mark)
        if stated is None and unit is not None:
            factors[role] = METRES[unit]
            if unit != "m":
                _list_mark(table, j, role, unit, journal)
        elif stated is not None or usual is not None:
            factors[role] = (stated if stated is not None else usual) or 1.0
    factors = {role: factor for role, factor in factors.items() if factor != 1.0}
    given = source.unit or source.usual_unit
    if given is not None and (roles := [role for role, factor in factors.items() if factor in (stated, usual)]):
        list_conversion(given, tuple(roles), source.name, journal)
    return factors


def angle_factors(table: Table, columns: Mapping[str, int], journal: Journal) -> dict[str, float]:
    """Return the degrees of one unit of each column of angles whose header marks gon or radians; each is listed."""
    factors: dict[str, float] = {}
    for role in sorted(ANGLES & columns.keys()):
        header = table.header[columns[role]]
        mark = plain_name(header)[1].casefold()
        if mark in _ANGLE_UNITS:
            factors[role] = _ANGLE_UNITS[mark]
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
    """Return the metres of the unit that the user states; a grid does not say its own."""
    unit = source.unit or source.usual_unit
    if unit is None:
        return 1.0
    list_conversion(unit, ("x", "y", "z"), source.name, journal)
    return metres_of(unit, source.name)

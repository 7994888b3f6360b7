"""Units of length: what a header, a units row or the user says, as metres."""

from __future__ import annotations

from collections.abc import Mapping

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.columns import plain_name
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["LENGTHS", "METRES", "grid_unit", "length_factors", "metres_of"]

#: Metres of one unit. The US survey foot differs by 2 in a million: 1.4 m at a state-plane northing of 2.3e6 ft.
METRES = {"m": 1.0, "ft": 0.3048, "ft-us": 1200.0 / 3937.0, "km": 1000.0, "cm": 0.01, "mm": 0.001}

_WORDS = {
    "m": "m metre metres meter meters 米",
    "ft": "ft feet foot f 英尺",
    "ft-us": "ft-us ftus us-ft usft ft(us) ussft",
    "km": "km kilometre kilometres 千米 公里",
    "cm": "cm centimetre centimetres 厘米",
    "mm": "mm millimetre millimetres 毫米",
}
_UNITS = {word: unit for unit, words in _WORDS.items() for word in words.split()}

#: Roles that are lengths.
LENGTHS = frozenset(
    {"x", "y", "z", "x0", "y0", "x1", "y1", "depth", "from", "to", "chainage", "distance", "elevation", "accuracy"}
)


def metres_of(unit: str, file: str | None = None) -> float:
    """Return the metres of a unit that the user states."""
    known = _UNITS.get(unit.strip().casefold())
    if known is None:
        raise InputError(
            message("io.unit-unknown", "The unit '{unit}' is unknown", unit=unit),
            message("io.known-units", "The units are {names}.", names=", ".join(METRES)),
            file=file,
            value=unit,
        )
    return METRES[known]


def length_factors(table: Table, columns: Mapping[str, int], source: Source, journal: Journal) -> dict[str, float]:
    """Return the metres of one unit of each length column that is not in metres.

    What the source states holds for all of them; else the mark in the header or the units row, which is listed.
    """
    stated = None if source.unit is None else metres_of(source.unit, source.name)
    factors: dict[str, float] = {}
    for role, j in columns.items():
        if role not in LENGTHS:
            continue
        if stated is not None:
            factors[role] = stated
            continue
        mark = plain_name(table.header[j])[1] or (table.units[j] if j < len(table.units) else "")
        unit = _UNITS.get(mark.strip().strip("[]()<>").casefold(), "m")
        if unit == "m":
            continue
        factors[role] = METRES[unit]
        name = "feet" if unit == "ft" else "US survey feet" if unit == "ft-us" else unit
        journal.add(
            "warning",
            table.name,
            message(
                "io.unit-converted",
                "The {role} is marked as {mark}; it is converted to metres (1 {unit} = {metres:.10g} m)",
                role=role,
                mark=name,
                unit=unit,
                metres=METRES[unit],
            ),
            message("io.state-unit-metres", 'State unit = "m" where it is metres already.'),
            column=table.header[j],
        )
    return {role: factor for role, factor in factors.items() if factor != 1.0}


def grid_unit(source: Source) -> float:
    """Return the metres of the unit that the user states; a grid does not say its own."""
    return 1.0 if source.unit is None else metres_of(source.unit, source.name)

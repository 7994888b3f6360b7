"""The unit in which lengths are shown: metres, or feet for those who think in them. All data stay in metres.

What is shown goes through one of these functions on its way to the screen: finished texts (:func:`in_lengths`), titles
of columns and axes (:func:`in_title`), numbers (:func:`shown_length`). Section sheets and plans are drawn in it, too.
Other fields in which lengths are entered, files and reports are in metres, and say so; areas and volumes are always
square and cubic metres.
"""

from __future__ import annotations

import math
import re
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from geofit.data.lengths import LENGTH_UNITS, LengthUnit, unit_mark

__all__ = [
    "coordinate_mark", "coordinate_unit", "count_coordinates_in", "in_lengths", "in_title", "length_mark",
    "length_unit", "metres_shown", "show_lengths_in", "shown_coordinate", "shown_length",
]  # fmt: skip

Number = TypeVar("Number", float, NDArray[np.float64])

_unit: LengthUnit = "m"
_grid: LengthUnit | None = None

_GAP = "[  \N{NARROW NO-BREAK SPACE}\N{THIN SPACE}]"
_NUMBER = rf"[+\-−]?\d+(?:{_GAP}\d{{3}})*(?:\.\d+)?(?:e[+\-]?\d+)?"
#: A number, or two with a dash between them, and metres; not square metres, metres a second or millimetres.
_MEASURE = re.compile(rf"(?<![\w.])(?:({_NUMBER})(\s?[–-]\s?))?({_NUMBER})({_GAP}?)m(?![\w/²³])")
#: Easting, northing and elevation with one unit behind them.
_PLACE = re.compile(rf"E\s?{_NUMBER}\s+N\s?{_NUMBER}\s+Z\s?{_NUMBER}\s?m(?!\w)")
_TITLE = re.compile(r"([,，]\s*)m(?=$|\s*[(（])")


def show_lengths_in(unit: LengthUnit) -> None:
    """Choose the unit for all windows that are drawn from now on."""
    global _unit
    _unit = unit


def count_coordinates_in(unit: LengthUnit | None) -> None:
    """Show eastings and northings in feet where the site's own grid counts in them; else as all lengths."""
    global _grid
    _grid = None if unit == "m" else unit


def coordinate_unit() -> LengthUnit:
    """Return the unit of eastings and northings."""
    return _grid or _unit


def coordinate_mark() -> str:
    """Return how the unit of eastings and northings is written."""
    return unit_mark(coordinate_unit())


def shown_coordinate(metres: Number) -> Number:
    """Return eastings or northings in the unit that is shown."""
    unit = coordinate_unit()
    return metres if unit == "m" else metres / LENGTH_UNITS[unit]


def length_unit() -> LengthUnit:
    """Return the unit that is shown."""
    return _unit


def length_mark() -> str:
    """Return how the unit is written: "m" or "ft"."""
    return unit_mark(_unit)


def metres_shown() -> float:
    """Return the metres of one unit that is shown."""
    return LENGTH_UNITS[_unit]


def shown_length(metres: Number) -> Number:
    """Return lengths in the unit that is shown."""
    return metres if _unit == "m" else metres / LENGTH_UNITS[_unit]


def in_title(title: str, *, coordinate: bool = False) -> str:
    """Return the title of a column or an axis of lengths, which ends in ", m"; ``coordinate``: easting or northing."""
    mark = coordinate_mark() if coordinate else length_mark()
    return title if mark == "m" else _TITLE.sub(rf"\1{mark}", title)


def in_lengths(text: str) -> str:
    """Return a finished text with its lengths in the unit that is shown; areas and volumes stay.

    Numbers keep their decimals, fractions three significant digits at least: nothing that could be read is lost.
    """
    if coordinate_unit() != "m":
        text = _PLACE.sub(_place, text)
    return text if _unit == "m" else _MEASURE.sub(_converted, text)


def _place(found: re.Match[str]) -> str:
    east, north, up = re.findall(_NUMBER, found.group())
    heads = re.split(_NUMBER, found.group())
    east, north = (_number(number, LENGTH_UNITS[coordinate_unit()]) for number in (east, north))
    if _unit != "m":
        return f"{heads[0]}{east}{heads[1]}{north}{heads[2]}{_number(up, LENGTH_UNITS[_unit])}{heads[3][:-1]}ft"
    # Its elevation keeps the metres that stand behind it.
    return f"{heads[0]}{east}{heads[1]}{north} ft{heads[2]}{up}{heads[3]}"


def _converted(found: re.Match[str]) -> str:
    first, dash, last, gap = found.groups()
    per = LENGTH_UNITS[_unit]
    before = "" if first is None else _number(first, per) + dash
    return f"{before}{_number(last, per)}{gap}ft"


def _number(text: str, per: float) -> str:
    """Write a number in another unit, with its decimals, sign and gaps."""
    plain = re.sub(_GAP, "", text).replace("−", "-")
    value = float(plain) / per
    if "e" in plain:
        return f"{value:.2e}".replace("e-0", "e-").replace("e+0", "e+").replace("-", "−", int(value < 0))
    decimals = len(plain.partition(".")[2])
    if decimals and value:
        decimals = max(decimals, 2 - math.floor(math.log10(abs(value))))
    sign = "+" if plain.startswith("+") else ""
    made = f"{value:{sign}.{decimals}f}"
    gap = re.search(_GAP, text)
    if gap is not None or (decimals == 0 and abs(value) >= 1e4):
        made = f"{value:{sign},.{decimals}f}".replace(",", gap.group() if gap else "\N{NO-BREAK SPACE}")
    return made.replace("-", "−") if "−" in text or "-" not in text else made

"""The unit in which lengths are shown: metres, or feet for those who think in them. All data stay in metres.

What is shown goes through one of these functions on its way to the screen: finished texts (:func:`in_lengths`), titles
of columns and axes (:func:`in_title`), numbers (:func:`shown_length`). Fields in which lengths are entered, files and
reports are in metres, and say so; areas and volumes are always square and cubic metres.
"""

from __future__ import annotations

import math
import re
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "LENGTH_UNITS", "LengthUnit", "in_lengths", "in_title", "length_mark", "metres_shown",
    "show_lengths_in", "shown_length",
]  # fmt: skip

LengthUnit = Literal["m", "ft", "ft-us"]
#: Metres of one unit.
LENGTH_UNITS: dict[LengthUnit, float] = {"m": 1.0, "ft": 0.3048, "ft-us": 1200.0 / 3937.0}

Number = TypeVar("Number", float, NDArray[np.float64])

_unit: LengthUnit = "m"

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


def length_mark() -> str:
    """Return how the unit is written: "m" or "ft"."""
    return "m" if _unit == "m" else "ft"


def metres_shown() -> float:
    """Return the metres of one unit that is shown."""
    return LENGTH_UNITS[_unit]


def shown_length(metres: Number) -> Number:
    """Return lengths in the unit that is shown."""
    return metres if _unit == "m" else metres / LENGTH_UNITS[_unit]


def in_title(title: str) -> str:
    """Return the title of a column or an axis of lengths, which ends in ", m"."""
    return title if _unit == "m" else _TITLE.sub(rf"\1{length_mark()}", title)


def in_lengths(text: str) -> str:
    """Return a finished text with its lengths in the unit that is shown; areas and volumes stay.

    Numbers keep their decimals, fractions three significant digits at least: nothing that could be read is lost.
    """
    return text if _unit == "m" else _MEASURE.sub(_converted, _PLACE.sub(_place, text))


def _place(found: re.Match[str]) -> str:
    per = LENGTH_UNITS[_unit]
    return re.sub(_NUMBER, lambda number: _number(number.group(), per), found.group()[:-1]) + length_mark()


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

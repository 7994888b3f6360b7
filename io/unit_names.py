"""What units are called in headers, rows of units and site files."""

from __future__ import annotations

import math
import re

__all__ = ["ANGLE_UNITS", "DEGREE_WORDS", "UNITS", "is_unit", "unit_marked"]

#: What a unit of length is called, without case, blanks and marks.
_WORDS = {
    "m": "m metre metres meter meters 米",
    "ft": "ft feet foot f ift intft internationalft internationalfeet internationalfoot 英尺 国际英尺",
    "ft-us": "ftus usft usfeet usfoot ft(us) ussft sft surveyft surveyfeet surveyfoot ussurveyft ussurveyfeet "
    "ussurveyfoot 美制测量英尺 测量英尺",
    "km": "km kilometre kilometres kilometer kilometers 千米 公里",
    "cm": "cm centimetre centimetres centimeter centimeters 厘米",
    "mm": "mm millimetre millimetres millimeter millimeters 毫米",
}
UNITS = {word: unit for unit, words in _WORDS.items() for word in words.split()}
DEGREE_WORDS = {"°", "度", "deg", "degree", "degrees"}
#: Degrees of one unit of other angles; "grad" is none: a degree in German, a gon in English.
ANGLE_UNITS = dict.fromkeys(("gon", "gons", "gradian", "gradians", "百分度"), 0.9)
ANGLE_UNITS |= dict.fromkeys(("rad", "radian", "radians", "弧度"), 180.0 / math.pi)


def unit_marked(mark: str) -> str | None:
    """Return the unit that a mark names, alone or with words behind it ("ft bgl", "US survey feet"); None if none.

    Examples
    --------
    >>> [unit_marked(mark) for mark in ("Feet", "ft. AMSL", "US Survey ft", "m", "deg")]
    ['ft', 'ft', 'ft-us', 'm', None]
    """
    words = mark.casefold().strip().strip("[]()<>").replace(",", " ").split()
    for count in range(len(words), 0, -1):
        found = UNITS.get(re.sub(r"[\s_.\-]", "", "".join(words[:count])))
        if found is not None:
            return found
    return None


def is_unit(cell: str) -> bool:
    """Whether a cell names a unit, or "-" for none.

    Examples
    --------
    >>> [is_unit(cell) for cell in ("m a.s.l.", "(ftUS)", "[gon]", "-", "units", "ID", "12 m")]
    [True, True, True, True, True, False, False]
    """
    words = cell.strip().strip("[]()<>").casefold().split()
    angles = DEGREE_WORDS | ANGLE_UNITS.keys()
    return bool(words) and (unit_marked(cell) is not None or words[0].rstrip(".") in angles | {"-", "units"})

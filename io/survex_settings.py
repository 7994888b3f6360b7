"""What a Survex file has set: data order, units, calibrations, flags. Restored at the end of each block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.io.units import METRES

__all__ = ["CORRECTIONS", "QUANTITIES", "Settings", "Unread", "corrected_by", "finite", "unit_of"]

#: Readings of each kind, under the names used here.
QUANTITIES = {
    "length": ("tape", "backtape", "left", "right", "up", "down"),
    "angle": ("compass", "backcompass", "clino", "backclino", "declination"),
    "walls": ("left", "right", "up", "down"),
}
#: Commands that correct readings, each with what is to be written for one that cannot be read.
CORRECTIONS = {
    "calibrate": message(
        "io.write-calibrate", "Write *calibrate QUANTITY ZERO_ERROR, with units and a scale where they are needed."
    ),
    "declination": message(
        "io.write-declination",
        "Write *declination VALUE degrees, 0 for bearings from grid north; auto is not computed.",
    ),
}
_SAME = {
    "length": "tape", "bearing": "compass", "gradient": "clino", "backlength": "backtape", "backbearing": "backcompass",
    "backgradient": "backclino", "ceiling": "up", "floor": "down",
}  # fmt: skip
#: Quantities of data that are not read.
_OTHERS = frozenset(["altitude", "count", "counter", "depth", "dx", "dy", "dz", "easting", "northing"])
_READ = (*QUANTITIES["length"], *QUANTITIES["angle"])
_UNKNOWN = "unknown"
_NORMAL = ("from", "to", "tape", "compass", "clino")
_READINGS = {
    "normal": {"from", "to", "tape", "backtape", "compass", "backcompass", "clino", "backclino", "ignore", "ignoreall"},
    "passage": {"station", "left", "right", "up", "down", "ignore", "ignoreall"},
}
_UNITS = {
    **dict.fromkeys(("metric", "metres", "meters"), ("length", 1.0)),
    "feet": ("length", METRES["ft"]),
    "yards": ("length", 3 * METRES["ft"]),
    **dict.fromkeys(("degs", "degrees", "deg"), ("angle", 1.0)),
    **dict.fromkeys(("mins", "minutes"), ("angle", 1.0 / 60.0)),
    **dict.fromkeys(("grads",), ("angle", 0.9)),
    **dict.fromkeys(("mils",), ("angle", 360.0 / 6400.0)),
    **dict.fromkeys(("percent", "percentage"), ("percent", 1.0)),
}


def unit_of(word: str) -> tuple[str, float]:
    """Return the kind of a unit, and metres or degrees of one; KeyError if it is unknown."""
    return _UNITS[word.casefold()]


def finite(cell: str) -> float:
    """Return the number of a cell; ValueError if it is not a finite one."""
    value = float(cell)
    if not np.isfinite(value):
        raise ValueError(cell)
    return value


@dataclass(frozen=True)
class Unread:
    """A correction that could not be read, or is not in the file: its command, what it would correct, where it is."""

    word: str
    corrected: Message
    file: str
    row: int = 0
    line: str = ""


def corrected_by(word: str, rest: Sequence[str]) -> Message:
    """Return what a command corrects."""
    names = {_SAME.get(cell.casefold(), cell.casefold()) for cell in rest} | {word}
    lengths, angles = (bool(names & set(QUANTITIES[kind])) for kind in ("length", "angle"))
    if lengths == angles:
        return message("io.lengths-and-directions", "lengths and directions")
    return message("io.lengths", "lengths") if lengths else message("io.directions", "directions")


@dataclass(frozen=True)
class Settings:
    """The state that ``*begin`` stores and ``*end`` restores.

    ``units``: (kind, factor) of a reading; the kind is "unknown" where the unit could not be read. ``calibration``:
    (zero error, scale, whether the zero error was measured outside the instrument and is in metres or degrees).
    """

    prefix: tuple[str, ...] = ()
    style: str = "normal"
    order: tuple[str, ...] = _NORMAL
    units: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    calibration: Mapping[str, tuple[float, float, bool]] = field(default_factory=dict)
    declination: float = 0.0
    infer_plumbs: bool = False
    infer_equates: bool = False
    duplicate: bool = False
    surface: bool = False
    splay: bool = False
    case: str = "tolower"
    unread: tuple[Unread, ...] = ()

    def cased(self, name: str) -> str:
        """Return a name in the case that the file has set."""
        return name if self.case == "preserve" else name.upper() if self.case == "toupper" else name.lower()

    def full(self, name: str) -> str:
        """Return a station's name with the names of its surveys."""
        return ".".join([*self.prefix, self.cased(name)])

    def with_data(self, words: list[str]) -> Settings:
        """Return the settings after ``*data``; a style or order that is not read becomes style "unread"."""
        if not words:
            return self
        if words[0] == "default":
            return replace(self, style="normal", order=_NORMAL)
        if words[0] == "ignore":
            return replace(self, style="ignore", order=())
        style = "normal" if words[0] == "topofil" else words[0]
        order = tuple(_SAME.get(word, word) for word in words[1:])
        needed = {"normal": {"from", "to", "tape", "compass"}, "passage": {"station"}}.get(style)
        if needed is None or not needed <= set(order) <= _READINGS[style]:
            return replace(self, style="unread", order=order)
        # Every ignored field keeps its column.
        order = tuple(f"ignore{i}" if word == "ignore" else word for i, word in enumerate(order))
        return replace(self, style=style, order=order)

    def with_units(self, words: list[str]) -> Settings:
        """Return the settings after ``*units``: quantities, an optional factor, a unit."""
        if words[0].casefold() == "default":
            return replace(self, units={})
        kind, factor = unit_of(words[-1])
        names, numbers = _split(words[:-1])
        if not names or numbers[1:] or 0.0 in numbers or not all(_measures(kind, name) for name in names):
            raise ValueError(words)
        factor *= numbers[0] if numbers else 1.0
        return replace(self, units={**self.units, **dict.fromkeys(names, (kind, factor))})

    def without_units(self, words: list[str]) -> Settings:
        """Return the settings after ``*units`` that cannot be read: its quantities, or all, have no unit any more."""
        names: Sequence[str] = _READ
        with suppress(KeyError):
            names = _split(words[:-1])[0] or _READ
        return replace(self, units={**self.units, **dict.fromkeys(names, (_UNKNOWN, np.nan))})

    def with_calibration(self, words: list[str]) -> Settings:
        """Return the settings after ``*calibrate``: quantities, zero error, an optional unit, an optional scale."""
        if words[0].casefold() == "default":
            return replace(self, calibration={}, declination=0.0)
        unit = next((word for word in words if word.casefold() in _UNITS), None)
        names, numbers = _split([word for word in words if word != unit])
        zero, scale = numbers[0] * (unit_of(unit)[1] if unit else 1.0), numbers[1] if len(numbers) > 1 else 1.0
        if names == ["declination"]:
            return replace(self, declination=-zero)
        entry = (zero, scale, unit is not None)
        return replace(self, calibration={**self.calibration, **dict.fromkeys(names, entry)})

    def without_correction(self, unread: Unread) -> Settings:
        """Return the settings after a correction that cannot be read."""
        return replace(self, unread=(*self.unread, unread))

    def with_correction(self, word: str, rest: list[str]) -> Settings:
        """Return the settings after a correction; it replaces an earlier one of its kind that could not be read."""
        if word == "declination":
            found = replace(self, declination=finite(rest[0]) * unit_of(rest[1])[1])
        else:
            found = self.with_calibration(rest)
            word = "declination" if rest[0].casefold() == "declination" else word
            if rest[0].casefold() == "default":
                return replace(found, unread=())
        if word == "calibrate":
            return found
        return replace(found, unread=tuple(one for one in self.unread if one.word != word))

    def with_inference(self, what: str, on: bool) -> Settings:
        """Return the settings after ``*infer``."""
        if what == "plumbs":
            return replace(self, infer_plumbs=on)
        return replace(self, infer_equates=on) if what == "equates" else self

    def with_flags(self, words: list[str]) -> Settings:
        """Return the settings after ``*flags``; KeyError for one that is unknown."""
        found, on = self, True
        for word in words:
            if word == "not":
                on = False
                continue
            match word:
                case "duplicate":
                    found = replace(found, duplicate=on)
                case "surface":
                    found = replace(found, surface=on)
                case "splay":
                    found = replace(found, splay=on)
                case _:
                    raise KeyError(word)
            on = True
        return found

    def reading(self, name: str, cell: str) -> float:
        """Return a reading in metres or degrees, calibrated; nan for "-" (omitted). ValueError if not a number.

        Raises
        ------
        InputError
            If the unit of the reading is unknown.
        """
        if cell == "-":
            return float("nan")
        kind, factor = self.units.get(name, ("", 1.0))
        if kind == _UNKNOWN:
            raise InputError(
                message("io.reading-unit-unknown", "The unit of the {reading} is unknown", reading=name),
                message("io.correct-units", "Correct the command *units before this line."),
            )
        zero, scale, outside = self.calibration.get(name, (0.0, 1.0, False))
        value = finite(cell) * scale if outside else (finite(cell) - zero) * scale
        value = float(np.degrees(np.arctan(value * factor / 100.0))) if kind == "percent" else value * factor
        return value - zero if outside else value


def _measures(kind: str, name: str) -> bool:
    """Return whether a unit of a kind fits a quantity."""
    if name in QUANTITIES["angle"]:
        return kind == "angle" or (kind == "percent" and name in ("clino", "backclino"))
    return kind == "length" or name in ("count", "counter")


def _split(words: list[str]) -> tuple[list[str], list[float]]:
    """Return the quantities and the numbers of a command; KeyError for a quantity that is unknown."""
    names, numbers = [], []
    for word in words:
        try:
            numbers.append(finite(word))
        except ValueError:
            name = _SAME.get(word.casefold(), word.casefold())
            if name not in _READ and name not in _OTHERS:
                raise KeyError(word) from None
            names.append(name)
    return names, numbers

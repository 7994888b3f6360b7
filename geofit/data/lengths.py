"""Units in which lengths are shown and drawn; all data are in metres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, Literal, TypeVar, cast

import numpy as np

__all__ = ["LENGTH_UNITS", "LengthUnit", "in_unit", "unit_mark"]

Value = TypeVar("Value")

LengthUnit = Literal["m", "ft", "ft-us"]
#: Metres of one unit: of the international foot, and of that of US surveys.
LENGTH_UNITS: dict[LengthUnit, float] = {"m": 1.0, "ft": 0.3048, "ft-us": 1200.0 / 3937.0}


def unit_mark(unit: LengthUnit) -> str:
    """Return how a unit is written.

    Examples
    --------
    >>> [unit_mark(unit) for unit in ("m", "ft", "ft-us")]
    ['m', 'ft', 'ft']
    """
    return "m" if unit == "m" else "ft"


def in_unit(value: Value, unit: LengthUnit) -> Value:
    """Return lengths in metres in another unit: a number, an array, or tuples, mappings and data classes of them.

    Every number in it has to be a length; words and truth values stay.

    Examples
    --------
    >>> in_unit((0.3048, {"depth": 3.048}, "hole"), "ft")
    (1.0, {'depth': 10.0}, 'hole')
    """
    per = LENGTH_UNITS[unit]

    def converted(one: Any) -> Any:
        if isinstance(one, (float, np.ndarray)):
            return one if isinstance(one, np.ndarray) and one.dtype.kind != "f" else one / per
        if isinstance(one, tuple):
            return tuple(map(converted, one))
        if isinstance(one, Mapping):
            return {key: converted(inner) for key, inner in one.items()}
        if is_dataclass(one) and not isinstance(one, type):
            return replace(one, **{field.name: converted(getattr(one, field.name)) for field in fields(one)})
        return one

    return value if unit == "m" else cast("Value", converted(value))

"""Numbers that files and callers give: whole ones of Python have any length, doubles do not."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

from geofit.data.messages import folded

__all__ = ["is_finite", "shown"]


def is_finite(value: Any) -> bool:
    """Whether a value is a number (true and false are none) that a double holds, and neither nan nor infinite.

    Examples
    --------
    >>> is_finite(2), is_finite(10**400), is_finite(float("nan")), is_finite("2"), is_finite(True)
    (True, False, False, False, False)
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def shown(value: Any) -> str:
    """Return a value as a message shows it, however long it is.

    Examples
    --------
    >>> shown("a"), shown(16**5000)
    ("'a'", 'a whole number of more than 4,300 digits')
    """
    try:
        return folded(repr(value))
    except ValueError:  # Python refuses to write more digits
        return "a whole number of more than 4,300 digits"

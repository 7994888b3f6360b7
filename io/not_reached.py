"""Rows of logs that are not a rock: they state that the hole ended before the base of the unit above was reached."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.io.contact_rules import TOUCH, code_key
from geofit.io.rows import Rows

__all__ = ["open_bases", "set_marks_aside"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: What such rows are called, as :func:`geofit.io.contact_rules.code_key` gives it.
WORDS = frozenset(
    {
        "not reached", "base not reached", "bottom not reached", "base unknown", "not penetrated", "unreached",
        "end of hole", "end of borehole", "end of log", "eoh", "total depth",
        "nicht erreicht", "basis nicht erreicht", "endteufe", "bohrende",
        "non atteint", "base non atteinte", "fin de sondage", "fin de trou",
        "未揭穿", "未穿", "未穿透", "未钻穿", "未见底", "未揭露", "终孔", "孔底",
    }
)  # fmt: skip


def set_marks_aside(rows: Rows, code: Sequence[str]) -> Bools:
    """Return which rows (n,) are such marks; they are listed, and not used."""
    marks = np.array([code_key(one) in WORDS for one in code], bool)
    for i in np.flatnonzero(marks & rows.ok).tolist():
        reason = message(
            "io.base-not-reached",
            "'{code}' is not a rock: the unit above has no base in this hole",
            code=code[i],
        )
        rows.reject(i, "code", reason, severity="note")
    return marks


def open_bases(marks: Bools, hole: NDArray[np.str_], top: Floats, base: Floats, used: Bools) -> Bools:
    """Return the intervals (n,) whose lower limit is where the hole, or what is known of it, ends.

    Parameters
    ----------
    marks : (n,) array of bool
        Rows that are such marks.
    hole, top, base : (n,) arrays
        Hole and limits of each row, metres; those of marks may be nan.
    used : (n,) array of bool
        Rows that are used.
    """
    found = np.zeros(len(hole), bool)
    for i in np.flatnonzero(marks).tolist():
        mine = used & (hole == hole[i])
        if np.isfinite(top[i]):
            mine &= base <= top[i] + TOUCH
        if mine.any():
            deepest = base[mine].max()
            found |= mine & (base >= deepest - TOUCH)
    return found

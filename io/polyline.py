"""Polylines from tables and places along them, used by section lines (plan) and adits (space)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.io.rows import Rows

__all__ = ["along", "chainage", "named_lines"]

Floats = NDArray[np.float64]


def chainage(line: Floats) -> Floats:
    """Return the length (k,) of a polyline (k, 2 or 3) from its start to each corner."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])


def along(line: Floats, s: Floats) -> Floats:
    """Return the places (n, 2 or 3) at the distances s (n,) along a polyline, held at its ends."""
    length = chainage(line)
    return np.column_stack([np.interp(s, length, line[:, k]) for k in range(line.shape[1])])


def named_lines(rows: Rows, role: str, places: Floats, what: str) -> dict[str, Floats]:
    """Return the corners (k, 2 or 3) of each line of a table: rows with one name in ``role`` are its corners in order.

    A corner that repeats the one before and a line of a single corner are listed; ``what`` is the word for a line.
    """
    names = np.array(rows.text(role))
    lines: dict[str, Floats] = {}
    for name in dict.fromkeys(names[rows.ok].tolist()):
        corners = np.flatnonzero(rows.ok & (names == name))
        for k in np.flatnonzero((np.diff(places[corners], axis=0) == 0).all(axis=1)).tolist():
            rows.reject(
                int(corners[k + 1]),
                "x",
                message("io.corner-repeated", "The corner repeats the one before"),
                message("io.remove-one-of-two", "Remove one of the two."),
            )
        corners = corners[rows.ok[corners]]
        if len(corners) < 2:
            reason = message("io.one-corner-only", "{what} {name} has one corner only", what=what, name=name)
            rows.reject(
                int(corners[0]), role, reason, message("io.two-corners-needed", "Two or more corners are needed.")
            )
        else:
            lines[name] = places[corners]
    return lines

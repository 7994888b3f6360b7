"""Where the cells of many lines are, as bytes of the text."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "CellPlaces",
    "split_at",
    "split_at_blanks",
    "strange_lines",
    "unquoted",
    "without_blanks",
]

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_NEWLINE, _BLANK, _TAB, _QUOTE = 10, 32, 9, 34
#: Blanks of Python's str.split that are neither a space, a tab, nor a line's end, and every byte beyond ASCII.
_STRANGE = np.zeros(256, bool)
_STRANGE[[11, 12, 13, 28, 29, 30, 31]] = True
_STRANGE[128:] = True


@dataclass(frozen=True, eq=False)
class CellPlaces:
    """Cells of a run of lines: byte ``start`` and one beyond the last, ``end``, in the order of the file.

    ``first`` (lines,) is the first cell of each line, ``count`` (lines,) how many it has.
    """

    start: Ints
    end: Ints
    first: Ints
    count: Ints


def split_at(text: Bytes, sep: int) -> CellPlaces:
    """Return the cells between separators; each line has its end."""
    end = np.flatnonzero((text == sep) | (text == _NEWLINE))
    last = np.flatnonzero(text[end] == _NEWLINE)
    first = np.concatenate([[0], last[:-1] + 1])
    start = np.concatenate([[0], end[:-1] + 1])
    return CellPlaces(start, end, first, last - first + 1)


def split_at_blanks(text: Bytes) -> CellPlaces:
    """Return the cells between runs of blanks and tabs."""
    ends = text == _NEWLINE
    blank = ends | (text == _BLANK) | (text == _TAB)
    before = np.concatenate([[True], blank[:-1]])
    start, end = np.flatnonzero(~blank & before), np.flatnonzero(blank & ~before)
    bounds = np.searchsorted(start, np.flatnonzero(ends))
    first = np.concatenate([[0], bounds[:-1]])
    return CellPlaces(start, end, first, bounds - first)


def strange_lines(text: Bytes, starts: Ints) -> Bools:
    """Return which lines have blanks that only Python's str.split knows."""
    found = _STRANGE[text]
    return np.asarray(np.logical_or.reduceat(found, starts)) if found.any() else np.zeros(len(starts), bool)


def without_blanks(text: Bytes, start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return where cells start and end without the blanks around them."""
    while True:
        lead = (start < end) & (text.take(start, mode="clip") == _BLANK)
        if not lead.any():
            break
        start = start + lead
    while True:
        trail = (start < end) & (text.take(end - 1, mode="clip") == _BLANK)
        if not trail.any():
            break
        end = end - trail
    return start, end


def unquoted(text: Bytes, start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return where cells start and end within the quotes around them."""
    quoted = (
        (end - start >= 2) & (text.take(start, mode="clip") == _QUOTE) & (text.take(end - 1, mode="clip") == _QUOTE)
    )
    return start + quoted, end - quoted

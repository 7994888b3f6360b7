"""Many cells of a text at once: plain numbers and repeated words, from the bytes where they are written.

What is not a plain number (exponents, signs of other scripts, words) is left to the reader of single cells, so that
both read every cell alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "CellPlaces",
    "distinct",
    "plain_numbers",
    "split_at",
    "split_at_blanks",
    "strange_lines",
    "trimmed",
    "unquoted",
]

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_NEWLINE, _BLANK, _TAB, _QUOTE, _ZERO = 10, 32, 9, 34, 48
#: Digits that fit the integers of a double; powers of ten that are doubles themselves. A quotient of both is rounded
#: once, as the nearest double to what is written (W. D. Clinger, PLDI 1990, 92-101).
_DIGITS, _EXACT = 18, 2**53
_POWERS = 10.0 ** np.arange(23)
#: Longest cell that is looked at in columns.
_LONGEST = 24
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


def trimmed(text: Bytes, start: Ints, end: Ints) -> tuple[Ints, Ints]:
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


def plain_numbers(text: Bytes, start: Ints, end: Ints, mark: int) -> tuple[Floats, Bools]:
    """Return the numbers of cells written as digits with at most one decimal mark, and which cells are such."""
    sign = text.take(start, mode="clip")
    negative = sign == ord("-")
    start = start + (negative | (sign == ord("+")))
    length = end - start
    good = (length > 0) & (length <= _LONGEST)
    longest = int(length[good].max(initial=0))
    shortest = int(length.min(initial=longest))
    mantissa, fraction, marks = (np.zeros(len(start), np.int64) for _ in range(3))
    for k in range(longest):
        byte = text.take(start + k, mode="clip")
        value = byte - np.uint8(_ZERO)
        digit, at_mark = value < 10, byte == mark
        if k >= shortest:
            inside = length > k
            digit, at_mark = digit & inside, at_mark & inside
            good &= digit | at_mark | ~inside
        else:
            good &= digit | at_mark
        np.multiply(mantissa, 10, out=mantissa, where=digit)
        np.add(mantissa, value, out=mantissa, where=digit)
        fraction += digit & (marks > 0)
        marks += at_mark
    digits = length - marks
    good &= (marks <= 1) & (digits >= 1) & (digits <= _DIGITS) & (mantissa <= _EXACT)
    numbers = mantissa / _POWERS[np.minimum(fraction, 22)]
    return np.where(negative, -numbers, numbers), good


def distinct(text: Bytes, start: Ints, end: Ints) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the first cell of each different one, in order, and for each cell the place of its like among these."""
    length = np.minimum(end - start, 255)
    width = max(int(length.max(initial=1)), 1)
    table = text.take(start[:, None] + np.arange(width), mode="clip")
    table[np.arange(width) >= length[:, None]] = 0
    # The length tells cells that end in zero bytes apart.
    words = np.concatenate([table, length[:, None].astype(np.uint8)], axis=1)
    changed = np.flatnonzero(np.concatenate([[True], (words[1:] != words[:-1]).any(axis=1)]))
    keys = np.ascontiguousarray(words[changed]).view(np.dtype((np.void, width + 1))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    runs = np.diff(np.append(changed, len(start)))
    return changed[first[order]], np.repeat(place[inverse], runs)

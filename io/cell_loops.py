"""Compiled: plain numbers, and the places of other cells, in one pass over the bytes of many rows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["all_have", "count_fractions", "distinct_cells", "read_cells"]

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_TAB, _NEWLINE, _BLANK, _QUOTE, _PLUS, _COMMA, _MINUS, _POINT, _E, _SMALL_E = 9, 10, 32, 34, 43, 44, 45, 46, 69, 101
_ZERO = np.uint8(48)
#: Unsigned places: numba would look whether others count from the end.
_ONE = np.uint64(1)
#: Digits that fit 64 bits; whole numbers that are doubles; powers of ten that are. A quotient of two of these is
#: rounded once, as the nearest double to what is written (W. D. Clinger, PLDI 1990, 92-101).
_DIGITS, _EXACT, _LARGEST = 19, np.uint64(2**53), 22
_POWERS = 10.0 ** np.arange(_LARGEST + 1)
#: Halves a double; more than the relative error of a correction.
_SPLIT, _DOUBT = 2.0**27 + 1, 2.0**-48


@njit(cache=True, nogil=True)
def all_have(count: int, sep: int, text: Bytes, starts: Ints) -> bool:
    """Return whether each line, from its start to that of the next, (n + 1,), has so many separators."""
    same = True
    for i in range(len(starts) - 1):
        found = 0
        for k in range(np.uint64(starts[i]), np.uint64(starts[i + 1])):
            found += text[k] == sep
        same &= found == count
    return same


@njit(cache=True, nogil=True)
def count_fractions(text: Bytes) -> tuple[int, int]:
    """Return how many runs of digits and marks are digits with one comma among them, and with one point."""
    commas = points = 0
    marks, behind, last = 0, 0, np.uint8(0)
    for byte in text:
        if byte - _ZERO < 10:
            behind += 1
        elif byte == _COMMA or byte == _POINT:  # noqa: SIM109 a tuple would take longer
            marks, behind, last = marks + 1, 0, byte
        else:
            if marks == 1 and behind:
                commas += last == _COMMA
                points += last == _POINT
            marks = behind = 0
    return commas, points


@njit(cache=True, nogil=True, inline="always")
def _ends(byte: Any, sep: int) -> Any:
    """Return whether a byte ends a cell; among blanks a tab is one."""
    return byte == sep or byte == _NEWLINE or (sep == _BLANK and byte == _TAB)  # a tuple would take longer


@njit(cache=True, nogil=True, inline="always")
def _digits(text: Bytes, at: Any, mantissa: Any) -> Any:
    """Return the end of a run of digits, and a number continued by them."""
    digit = text[at] - _ZERO
    while digit < 10:
        mantissa = np.uint64(10) * mantissa + np.uint64(digit)
        at += _ONE
        digit = text[at] - _ZERO
    return at, mantissa


@njit(cache=True, nogil=True, inline="always")
def _zeros(text: Bytes, at: Any) -> Any:
    while text[at] == _ZERO:
        at += _ONE
    return at


@njit(cache=True, nogil=True, inline="always")
def _scaled(mantissa: Any, power: int) -> tuple[float, bool]:
    """Return the double nearest to mantissa x 10^power, and whether it is certain which one that is.

    The first double of the result is corrected by the remainder, which two doubles hold exactly (T. J. Dekker, Numer.
    Math. 18, 1971, 224-242). Where the corrections at the ends of their error round alike, so does the exact value.
    """
    if mantissa <= _EXACT and power <= 0:
        return np.float64(np.int64(mantissa)) / _POWERS[-power], True
    high = np.float64(mantissa)
    low = np.float64(np.int64(mantissa - np.uint64(high)))
    scale = _POWERS[abs(power)]
    if power < 0:
        first = high / scale
        product, error = _product(first, scale)
        rest = (((high - product) - error) + low) / scale
    else:
        first, error = _product(high, scale)
        rest = error + low * scale
    value = first + rest * (1 - _DOUBT)
    return value, value == first + rest * (1 + _DOUBT)


@njit(cache=True, nogil=True, inline="always")
def _product(a: float, b: float) -> tuple[float, float]:
    """Return a product and its rounding error."""
    p = a * b
    c, d = _SPLIT * a, _SPLIT * b
    a1, b1 = c - (c - a), d - (d - b)
    a2, b2 = a - a1, b - b1
    return p, a2 * b2 - (((p - a1 * b1) - a2 * b1) - a1 * b2)


@njit(cache=True, nogil=True)
def _number(text: Bytes, at: Any, sep: int, mark: int) -> tuple[Any, float, bool]:
    """Return the end of a cell that is a number with a decimal mark, its value, and whether it is such a cell."""
    quoted = sep != _BLANK and text[at] == _QUOTE
    at += np.uint64(quoted)
    while sep != _BLANK and text[at] == _BLANK:
        at += _ONE
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += _ONE
    begin = at
    # Leading zeros do not count as digits of the mantissa.
    first = at = _zeros(text, at)
    at, mantissa = _digits(text, at, np.uint64(0))
    power: Any = 0
    written, digits = np.int64(at - begin), np.int64(at - first)
    if text[at] == mark:
        at += _ONE
        begin = at
        if not mantissa:
            at = _zeros(text, at)
        first = at
        at, mantissa = _digits(text, at, mantissa)
        power = np.int64(begin) - np.int64(at)
        written, digits = written - power, digits + np.int64(at - first)
    good: Any = written > 0 and digits <= _DIGITS
    if text[at] == _E or text[at] == _SMALL_E:
        at += _ONE
        less = text[at] == _MINUS
        if less or text[at] == _PLUS:
            at += _ONE
        begin = at
        at, exponent = _digits(text, at, np.uint64(0))
        good &= 0 < np.int64(at - begin) <= 4
        power += -np.int64(exponent) if less else np.int64(exponent)
    while sep != _BLANK and text[at] == _BLANK:
        at += _ONE
    if quoted:
        good &= text[at] == _QUOTE
        at += _ONE
    if not good or not _ends(text[at], sep) or abs(power) > _LARGEST:
        return at, 0.0, False
    value, good = _scaled(mantissa, power)
    return at, -value if negative else value, good


@njit(cache=True, nogil=True)
def read_cells(
    text: Bytes, begins: Ints, columns: Ints, number: Bools, sep: int, mark: int, values: Floats, start: Ints, end: Ints
) -> None:
    """Read some columns of rows, each of which ends with its line and has all of these.

    Parameters
    ----------
    text : (bytes,) array
        The rows, among others.
    begins : (n,) array
        First byte of each.
    columns, number : (k,) arrays
        Columns, ascending, and which of them are read as numbers.
    sep, mark : int
        Separator of cells (a blank: runs of blanks and tabs), decimal mark.
    values : (k, n) array
        Receives the numbers, each the double nearest to what is written in digits, within blanks and quotes or not.
    start, end : (k, n) arrays
        Receive the bytes of all other cells; start is -1 where there is a number.
    """
    for i in range(len(begins)):
        at, cell = np.uint64(begins[i]), 0
        while sep == _BLANK and (text[at] == _BLANK or text[at] == _TAB):
            at += _ONE
        for k in range(len(columns)):
            while cell < columns[k]:
                if sep == _BLANK:
                    while not _ends(text[at], sep):
                        at += _ONE
                    while text[at] == _BLANK or text[at] == _TAB:
                        at += _ONE
                    cell += 1
                else:
                    cell += text[at] == sep
                    at += _ONE
            first = at
            if number[k]:
                # Most numbers are a few digits with a mark between them.
                negative = text[at] == _MINUS
                at += np.uint64(negative)
                begin = at
                at, mantissa = _digits(text, at, np.uint64(0))
                fraction: Any = 0
                if text[at] == mark:
                    at += _ONE
                    begin = at
                    at, mantissa = _digits(text, at, mantissa)
                    fraction = np.int64(at - begin)
                length = np.int64(at - first) - negative
                if _ends(text[at], sep) and 1 < length < _DIGITS:
                    value, good = _scaled(mantissa, -fraction)
                    values[k, i] = -value if negative else value
                else:
                    at, values[k, i], good = _number(text, first, sep, mark)
                if good:
                    start[k, i] = -1
                    continue
                at = first
            while not _ends(text[at], sep):
                at += _ONE
            start[k, i], end[k, i] = np.int64(first), np.int64(at)


@njit(cache=True, nogil=True, inline="always")
def _alike(text: Bytes, start: Ints, end: Ints, i: int, k: int) -> bool:
    """Return whether two cells have the same bytes."""
    a, b, left = start[i], start[k], end[i] - start[i]
    if end[k] - b != left:
        return False
    while left and text[a] == text[b]:
        a, b, left = a + 1, b + 1, left - 1
    return bool(left == 0)


@njit(cache=True, nogil=True)
def distinct_cells(text: Bytes, start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return the first cell of each different one, in order, and for each cell the place of its like among these."""
    n = len(start)
    room = 1
    while room < 2 * n:
        room *= 2
    table = np.full(room, -1, np.int64)
    first, place = np.empty(n, np.int64), np.empty(n, np.int64)
    count = 0
    for i in range(n):
        # Most cells repeat the one above.
        if i and _alike(text, start, end, i, i - 1):
            place[i] = place[i - 1]
            continue
        key = np.uint64(14695981039346656037)  # FNV-1a
        for j in range(start[i], end[i]):
            key = (key ^ np.uint64(text[j])) * np.uint64(1099511628211)
        at = np.int64((key ^ (key >> np.uint64(32))) & np.uint64(room - 1))
        while table[at] >= 0 and not _alike(text, start, end, i, first[table[at]]):
            at = (at + 1) & (room - 1)
        if table[at] < 0:
            table[at], first[count] = count, i
            count += 1
        place[i] = table[at]
    return first[:count].copy(), place

"""Columns recognized by their values alone, where no name is known: places, elevations, depths from and to, codes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.io.tables import Table, parse_numbers

__all__ = ["CONFIDENCE", "ValueGuess", "by_values"]

Floats = NDArray[np.float64]

#: What such a guess is worth, and one of several columns that would do.
CONFIDENCE, UNSURE = 0.45, 0.3
#: Rows that are looked at: the first ones, for depths have to follow each other.
ROWS = 400
#: Eastings and northings are larger than any elevation or depth on Earth, metres.
MAP, EARTH = 10_000.0, 9_000.0
#: This share of the cells must be what a column is taken for.
MOST = 0.95


@dataclass(frozen=True)
class ValueGuess:
    """A role's column (index), how sure it is, why, and which other columns would do."""

    index: int
    confidence: float
    reason: Message
    others: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class _Column:
    index: int
    cells: tuple[str, ...]
    values: Floats
    numeric: bool

    @property
    def size(self) -> float:
        return float(np.nanmedian(np.abs(self.values)))

    @property
    def words(self) -> int:
        """Number of different cells."""
        return len(set(self.cells))


def by_values(table: Table, kind: str) -> dict[str, ValueGuess]:
    """Return the columns of a kind of table, empty unless every role that it must have is found.

    Only picks, collars and intervals have values that tell them: two columns of the size of map coordinates;
    two depths of which one is below the other and which follow each other down a hole.
    """
    rules: dict[str, Callable[[list[_Column]], dict[str, ValueGuess]]] = {
        "picks": _picks,
        "collar": _collar,
        "intervals": _intervals,
    }
    if kind not in rules or len(table) < 3:
        return {}
    columns = []
    for j, cells in enumerate(table.columns):
        sample = tuple(cell.strip() for cell in cells[:ROWS])
        values, bad = parse_numbers(sample, table.decimal)
        columns.append(_Column(j, sample, values, len(bad) <= (1 - MOST) * len(sample)))
    return rules[kind](columns)


def _place(columns: list[_Column]) -> dict[str, ValueGuess]:
    """Return easting, northing and elevation."""
    numbers = [column for column in columns if column.numeric]
    large = [column for column in numbers if column.size >= MAP and np.nanmin(column.values) < np.nanmax(column.values)]
    small = [column for column in numbers if np.nanmax(np.abs(column.values)) < EARTH]
    if len(large) != 2 or not small:
        return {}
    first, second = large
    why = message("io.by-size-of-coordinates", "by its values, the size of map coordinates")
    # Northings have seven digits; eastings six, or eight with the zone in front.
    turned = 1e6 <= first.size < 1e7 and not 1e6 <= second.size < 1e7
    if turned:
        first, second, why = (
            second,
            first,
            message("io.by-seven-digits", "by its values, the size of map coordinates; seven digits are a northing"),
        )
    after = [column for column in small if column.index > max(first.index, second.index)] or small
    z = after[0]
    sure = CONFIDENCE if len(small) == 1 else UNSURE
    return {
        "x": ValueGuess(first.index, CONFIDENCE, why),
        "y": ValueGuess(second.index, CONFIDENCE, why),
        "z": ValueGuess(
            z.index,
            sure,
            message("io.by-size-of-elevations", "by its values, the size of elevations"),
            tuple(c.index for c in small if c is not z),
        ),
    }


def _texts(columns: list[_Column]) -> list[_Column]:
    return [column for column in columns if not column.numeric and all(0 < len(cell) <= 60 for cell in column.cells)]


def _picks(columns: list[_Column]) -> dict[str, ValueGuess]:
    found = _place(columns)
    repeated = [column for column in _texts(columns) if column.words <= 0.5 * len(column.cells)]
    if found and len(repeated) == 1:
        why = message("io.by-words-that-repeat", "by its values, words that repeat")
        found["horizon"] = ValueGuess(repeated[0].index, CONFIDENCE, why)
    return found


def _collar(columns: list[_Column]) -> dict[str, ValueGuess]:
    found = _place(columns)
    names = [column for column in _texts(columns) if column.words == len(column.cells)]
    if not found or len(names) != 1:
        return {}
    return {
        "hole": ValueGuess(
            names[0].index, CONFIDENCE, message("io.by-unique-words", "by its values, words of which none repeats")
        ),
        **found,
    }


def _intervals(columns: list[_Column]) -> dict[str, ValueGuess]:
    texts = _texts(columns)
    holes = [
        c for c in texts if 1 < c.words < len(c.cells) and 1 + sum(a != b for a, b in pairwise(c.cells)) == c.words
    ]
    if not holes:
        return {}
    hole = holes[0]
    same = np.array([a == b for a, b in pairwise(hole.cells)])
    numbers = [c for c in columns if c.numeric and np.nanmax(np.abs(c.values)) < EARTH]
    pairs = [(a, b) for a, b in pairwise(numbers) if _follow(a.values, b.values, same)]
    codes = [c for c in texts if c is not hole and c.words <= max(0.5 * len(c.cells), 3)]
    if len(pairs) != 1 or not codes:
        return {}
    (top, base), why = (
        pairs[0],
        message("io.by-consecutive-depths", "by its values, depths that follow each other down a hole"),
    )
    sure = CONFIDENCE if len(codes) == 1 else UNSURE
    return {
        "hole": ValueGuess(hole.index, CONFIDENCE, message("io.by-words-in-runs", "by its values, words in runs")),
        "from": ValueGuess(top.index, CONFIDENCE, why),
        "to": ValueGuess(base.index, CONFIDENCE, why),
        "code": ValueGuess(
            codes[0].index,
            sure,
            message("io.by-words-that-repeat", "by its values, words that repeat"),
            tuple(c.index for c in codes[1:]),
        ),
    }


def _follow(top: Floats, base: Floats, same: NDArray[np.bool_]) -> bool:
    """Whether ``top`` lies above ``base`` in depth, and the rows of a hole go down."""
    known = np.isfinite(top) & np.isfinite(base)
    if not known.any() or np.mean((top < base)[known]) < MOST or np.nanmin(top) < 0 or not same.any():
        return False
    return bool(np.mean((np.diff(top) > 0)[same]) >= MOST and np.mean((top[1:] >= base[:-1] - 1e-6)[same]) >= 0.5)

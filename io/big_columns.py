"""The columns of a large text: which rows it has, and their cells, numbers and words when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, overload

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels
from geofit.io import big_cells
from geofit.io.big_arrow import read_plain
from geofit.io.big_cells import CellPlaces
from geofit.io.big_text import BigText

__all__ = ["BigColumn", "big_columns", "find_lines"]

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Rows that are looked at cell by cell.
HEAD = 4_096
#: Bytes from which on a cell is compared by itself.
LONG = 250
#: What a line is: nothing, separators alone, a row of the header's cells, or what is looked at by itself.
EMPTY, BLANK, REGULAR, ODD, TAKEN = range(5)


class CellParser(Protocol):
    """Reads the numbers of single cells; see :func:`geofit.io.tables.parse_numbers`."""

    def __call__(self, cells: tuple[str, ...], decimal: str, /) -> tuple[Floats, Ints]:
        """Return the numbers, nan where a cell holds none, and the indices of those cells."""
        ...


def find_lines(text: BigText, start: int, width: int, sep: str) -> NDArray[np.uint8]:
    """Return what each line of a text is, (lines,), those above ``start`` EMPTY."""
    kinds = np.zeros(len(text), np.uint8)
    for first, last in text.pieces():
        if last > start:
            first = max(first, start)
            kinds[first:last] = _kinds(
                text.bytes_of(first, last), text.starts[first : last + 1].astype(np.int64), width, sep
            )
    return kinds


def _kinds(piece: Bytes, starts: Ints, width: int, sep: str) -> NDArray[np.uint8]:
    begins = starts[:-1] - starts[0]
    piece = piece if len(piece) > begins[-1] else np.append(piece, np.uint8(10))
    places = _split(piece, sep)
    kinds = np.where(places.count == width, REGULAR, ODD).astype(np.uint8)
    if sep == " ":
        kinds[places.count == 0] = EMPTY
        kinds[big_cells.strange_lines(piece, begins)] = ODD
        return kinds
    # More separators than the header has, with nothing between them: a table with a comma at each line's end.
    more = np.flatnonzero(places.count > width)
    if len(more):
        last = places.first[more] + places.count[more] - 1
        empty = places.end[last] - places.end[places.first[more] + width - 1] == places.count[more] - width
        kinds[more[empty]] = REGULAR
    quotes = np.flatnonzero(piece == 34)
    if len(quotes):
        line = np.searchsorted(begins, quotes, side="right") - 1
        inside = big_cells.unquoted(piece, places.start, places.end)[0] - places.start
        proper = np.add.reduceat(inside, places.first)
        kinds[np.bincount(line, minlength=len(kinds)) != 2 * proper] = ODD
    marks_of_blank = np.zeros(256, bool)
    marks_of_blank[[32, 9, 10]] = True
    marks = marks_of_blank.copy()
    marks[ord(sep)] = True
    if marks[piece[begins]].any():
        filled = np.add.reduceat(~marks[piece], begins, dtype=np.int64) > 0
        shown = np.add.reduceat(~marks_of_blank[piece], begins, dtype=np.int64) > 0
        kinds[~filled] = np.where(shown[~filled], BLANK, EMPTY)
    return kinds


def _split(piece: Bytes, sep: str) -> CellPlaces:
    return big_cells.split_at_blanks(piece) if sep == " " else big_cells.split_at(piece, ord(sep))


@dataclass(frozen=True, eq=False)
class BigRows:
    """Rows of a large text.

    ``lines`` (n,) number of each row's line, counted from 1; ``odd`` the cells of those rows that were looked at by
    themselves, by the number of the row.
    """

    text: BigText
    lines: Ints
    sep: str
    width: int
    odd: dict[int, list[str]]
    parse: CellParser
    _ready: dict[int, Floats | Labels] = field(default_factory=dict)

    def prepare(self, numbers: Sequence[int], words: Sequence[int], decimal: str) -> None:
        """Read columns together where the rows are plain; each is handed out once."""
        lines = self.lines
        plain = self.sep != " " and len(lines) and lines[-1] - lines[0] + 1 == len(lines)
        if not plain or self.odd or b'"' in self.text.data:
            return
        low, high = int(self.text.starts[lines[0] - 1]), int(self.text.starts[lines[-1]])
        body = memoryview(self.text.data)[low:high]
        self._ready.update(read_plain(body, len(lines), self.sep, self.width, numbers, words, decimal))

    def cells(self, row: int) -> list[str]:
        """Return the cells of one row."""
        if row in self.odd:
            return self.odd[row]
        return self._head[row] if row < HEAD else self._cells(row)

    @cached_property
    def _head(self) -> list[list[str]]:
        """Cells of the first rows, which guesses are made from."""
        return [self.odd.get(row) or self._cells(row) for row in range(min(HEAD, len(self.lines)))]

    def _cells(self, row: int) -> list[str]:
        line = self.text[int(self.lines[row]) - 1]
        cells = line.split() if self.sep == " " else line.split(self.sep)
        if '"' in line and self.sep != " ":
            cells = [cell[1:-1] if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell for cell in cells]
        return (cells + [""] * self.width)[: self.width]

    def pieces(self, column: int) -> Iterator[tuple[Ints, Bytes, Ints, Ints]]:
        """Yield rows, with the bytes in which the cells of a column start and end."""
        odd = np.array(sorted(self.odd), np.int64)
        for first, last in self.text.pieces():
            low, high = np.searchsorted(self.lines, (first + 1, last + 1))
            if low == high:
                continue
            rows = np.arange(low, high)
            rows = rows[~np.isin(rows, odd)] if len(odd) else rows
            if not len(rows):
                continue
            piece = self.text.bytes_of(first, last)
            places = _split(piece, self.sep)
            at = places.first[self.lines[rows] - 1 - first] + column
            start, end = places.start[at], places.end[at]
            if self.sep != " " and (piece == 34).any():
                start, end = big_cells.unquoted(piece, start, end)
            yield rows, piece, start, end

    def numbers(self, column: int, decimal: str) -> tuple[Floats, Ints]:
        """Return the numbers of a column, nan where a cell holds none, and the rows of those cells."""
        if isinstance(ready := self._ready.pop(column, None), np.ndarray):
            return ready, np.empty(0, np.int64)
        values, bad = np.empty(len(self.lines)), [np.empty(0, np.int64)]
        for rows, piece, start, end in self.pieces(column):
            start, end = big_cells.trimmed(piece, start, end)
            found, plain = big_cells.plain_numbers(piece, start, end, ord(decimal))
            empty = start == end
            found[empty] = np.nan
            bad.append(rows[empty])
            rest = np.flatnonzero(~plain & ~empty)
            if len(rest):
                cells = tuple(_texts(piece, start[rest], end[rest]))
                found[rest], wrong = self.parse(cells, decimal)
                bad.append(rows[rest[wrong]])
            values[rows] = found
        if self.odd:
            rows = np.array(sorted(self.odd), np.int64)
            values[rows], wrong = self.parse(tuple(self.odd[i][column] for i in rows.tolist()), decimal)
            bad.append(rows[wrong])
        return values, np.sort(np.concatenate(bad))

    def labels(self, column: int) -> Labels:
        """Return the cells of a column as codes into the different ones, in the order of the rows."""
        if isinstance(ready := self._ready.pop(column, None), Labels):
            return ready
        known: dict[str, int] = {}
        codes = np.empty(len(self.lines), np.int32)
        for rows, piece, start, end in self.pieces(column):
            first = place = np.arange(len(rows))
            if int((end - start).max(initial=0)) < LONG:
                first, place = big_cells.distinct(piece, start, end)
            words = _texts(piece, start[first], end[first])
            codes[rows] = np.array([known.setdefault(word, len(known)) for word in words], np.int32)[place]
        for row, cells in self.odd.items():
            codes[row] = known.setdefault(cells[column], len(known))
        return _in_order(codes, tuple(known)) if self.odd else Labels(codes, tuple(known))


def _in_order(codes: NDArray[np.int32], words: tuple[str, ...]) -> Labels:
    """Return labels whose table is in the order of the words' first appearance."""
    first = np.full(len(words), len(codes), np.int64)
    first[codes[::-1]] = np.arange(len(codes))[::-1]  # the last one written is the first of its kind
    order = np.argsort(first, kind="stable")
    place = np.empty(len(words), np.int32)
    place[order] = np.arange(len(words), dtype=np.int32)
    return Labels(place[codes], tuple(words[k] for k in order.tolist()))


def _texts(piece: Bytes, start: Ints, end: Ints) -> list[str]:
    data = piece.tobytes()
    ends = zip(start.tolist(), end.tolist(), strict=True)
    if data.isascii():
        text = data.decode("ascii")
        return [text[low:high] for low, high in ends]
    return [data[low:high].decode("utf-8", "surrogatepass") for low, high in ends]


class BigColumn(Sequence[str]):
    """The cells of one column, read when they are looked at."""

    def __init__(self, rows: BigRows, column: int) -> None:
        self._rows, self._column = rows, column

    def __len__(self) -> int:
        return len(self._rows.lines)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...
    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        """Return a cell, or a tuple of them."""
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        count = len(self._rows.lines)
        if not -count <= index < count:
            raise IndexError(index)
        return self._rows.cells(index % count)[self._column]

    def __iter__(self) -> Iterator[str]:
        labels = self.labels()
        return (labels.table[code] for code in labels.codes.tolist())

    def prepare(self, numbers: Sequence[int], words: Sequence[int], decimal: str) -> None:
        """Read several columns of this one's table together: quicker than one after the other."""
        self._rows.prepare(numbers, words, decimal)

    def numbers(self, decimal: str) -> tuple[Floats, Ints]:
        """Return the numbers, nan where a cell holds none, and the indices of those cells."""
        return self._rows.numbers(self._column, decimal)

    def labels(self) -> Labels:
        """Return the cells as codes."""
        return self._rows.labels(self._column)


def big_columns(
    text: BigText, kinds: NDArray[np.uint8], odd: dict[int, list[str]], width: int, sep: str, parse: CellParser
) -> tuple[tuple[BigColumn, ...], Ints]:
    """Return the columns of a text, and the line of each row.

    Parameters
    ----------
    text : BigText
        The lines.
    kinds : (lines,) array
        What each line is; of the ODD ones those in ``odd`` are rows.
    odd : dict
        Cells of such rows by the index of their line.
    width : int
        Number of columns.
    sep : str
        Separator.
    parse : callable
        Reads the numbers of single cells.
    """
    kinds = kinds.copy()
    kinds[list(odd)] = REGULAR
    lines = np.flatnonzero(kinds == REGULAR) + 1
    places = np.searchsorted(lines, np.array(list(odd), np.int64) + 1).tolist()
    rows = BigRows(text, lines, sep, width, dict(zip(places, odd.values(), strict=True)), parse)
    return tuple(BigColumn(rows, j) for j in range(width)), lines

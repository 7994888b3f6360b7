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
from geofit.io.big_cells import CellPlaces
from geofit.io.big_text import BigText

__all__ = ["BigColumn", "big_columns", "find_lines"]

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Rows that guesses are made from, cell by cell.
HEAD = 8_192
#: Cells up to which each is decoded by itself.
FEW = 1_000
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
    quoted = b'"' in text.data
    for first, last in text.pieces():
        if last > start:
            first = max(first, start)
            piece, starts = text.bytes_of(first, last), text.starts[first : last + 1].astype(np.int64)
            plain = not quoted and _all_regular(piece, starts - starts[0], width, sep)
            kinds[first:last] = REGULAR if plain else _kinds(piece, starts, width, sep)
    return kinds


def _all_regular(piece: Bytes, starts: Ints, width: int, sep: str) -> bool:
    """Return whether each line has exactly its cells and does not start with an empty one; no cell is quoted."""
    from geofit.io.cell_loops import all_have

    if starts[-1] > len(piece) or sep == " " or _marks(sep)[piece[starts[:-1]]].any():
        return False
    return bool(all_have(width - 1, ord(sep), piece, starts))


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
    marks = _marks(sep)
    if marks[piece[begins]].any():
        filled = np.add.reduceat(~marks[piece], begins, dtype=np.int64) > 0
        shown = np.add.reduceat(~_marks("\n")[piece], begins, dtype=np.int64) > 0
        kinds[~filled] = np.where(shown[~filled], BLANK, EMPTY)
    return kinds


def _marks(sep: str) -> Bools:
    """Return which bytes do not fill a cell, (256,): blanks, tabs, ends of lines and the separator."""
    marks = np.zeros(256, bool)
    marks[[ord(mark) for mark in (" ", "\t", "\n", sep)]] = True
    return marks


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
    _numbers: dict[int, tuple[Floats, Ints]] = field(default_factory=dict)
    _words: dict[int, Labels] = field(default_factory=dict)
    _seen: dict[int, list[str]] = field(default_factory=dict)

    def cell(self, row: int, column: int) -> str:
        """Return one cell."""
        if row < HEAD:
            return self.head[column][row]
        if row not in self._seen:
            if len(self._seen) > HEAD:
                self._seen.clear()
            self._seen[row] = self.odd.get(row) or self._cells(row)
        return self._seen[row][column]

    @cached_property
    def head(self) -> list[tuple[str, ...]]:
        """Cells of the first rows, which guesses are made from, column by column."""
        count = min(HEAD, len(self.lines))
        if not self.odd and self.sep != " ":
            lines = self.text.some(self.lines[:count] - 1)
            joined = self.sep.join(lines)
            cells = joined.split(self.sep)
            # Each row has its cells at least, so the count shows whether one has more.
            if len(cells) == count * self.width and '"' not in joined:
                return [tuple(cells[j :: self.width]) for j in range(self.width)]
        rows = [self.odd.get(row) or self._cells(row) for row in range(count)]
        return list(zip(*rows, strict=True)) or [()] * self.width

    def _cells(self, row: int) -> list[str]:
        line = self.text[int(self.lines[row]) - 1]
        cells = line.split() if self.sep == " " else line.split(self.sep)
        if '"' in line and self.sep != " ":
            cells = [cell[1:-1] if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell for cell in cells]
        return (cells + [""] * self.width)[: self.width]

    def read(self, numbers: Sequence[int], words: Sequence[int], decimal: str) -> None:
        """Read columns together, in one pass over the text; each is handed out once."""
        # Imported where there is a large text: it takes a tenth of a second.
        from geofit.io.cell_loops import distinct_cells, read_cells

        columns = sorted({*numbers, *words})
        number = np.isin(columns, list(numbers))
        # Columns of one array: neighbours make points without a copy (see geofit.io.picks).
        block = np.empty((len(self.lines), int(number.sum())))
        values = dict(zip(np.array(columns)[number].tolist(), block.T, strict=True))
        bad: dict[int, list[Ints]] = {j: [np.empty(0, np.int64)] for j in numbers}
        codes = {j: np.empty(len(self.lines), np.int32) for j in columns if j not in values}
        known: dict[int, dict[str, int]] = {j: {} for j in codes}
        sep, mark = ord(self.sep), ord(decimal) if decimal != self.sep else 0
        for rows, piece, begins in self._pieces():
            found = np.empty((len(columns), len(begins)))
            start, end = np.empty(found.shape, np.int64), np.empty(found.shape, np.int64)
            read_cells(piece, begins, np.array(columns), number, sep, mark, found, start, end)
            for k, j in enumerate(columns):
                if j in values:
                    rest = np.flatnonzero(start[k] >= 0)
                    if len(rest):
                        found[k, rest], wrong = self._parsed(piece, start[k, rest], end[k, rest], decimal)
                        bad[j].append(np.arange(len(self.lines))[rows][rest[wrong]])
                    values[j][rows] = found[k]
                else:
                    low, high = self._unquoted(piece, start[k], end[k])
                    first, place = distinct_cells(piece, low, high)
                    texts = _texts(piece, low[first], high[first])
                    codes[j][rows] = np.array([known[j].setdefault(t, len(known[j])) for t in texts], np.int32)[place]
        for row, cells in self.odd.items():
            for j, column in codes.items():
                column[row] = known[j].setdefault(cells[j], len(known[j]))
        if self.odd:
            odd = np.array(sorted(self.odd), np.int64)
            for j in values:
                values[j][odd], wrong = self.parse(tuple(self.odd[i][j] for i in odd.tolist()), decimal)
                bad[j].append(odd[wrong])
        self._numbers.update({j: (values[j], np.sort(np.concatenate(bad[j]))) for j in values})
        for j, column in codes.items():
            self._words[j] = _in_order(column, tuple(known[j])) if self.odd else Labels(column, tuple(known[j]))

    def _pieces(self) -> Iterator[tuple[slice | Ints, Bytes, Ints]]:
        """Yield rows that are not odd, with the bytes that they are in and where each begins."""
        odd = np.array(sorted(self.odd), np.int64)
        for first, last in self.text.pieces():
            low, high = np.searchsorted(self.lines, (first + 1, last + 1)).tolist()
            rows: slice | Ints = slice(low, high)
            if len(odd) and np.searchsorted(odd, low) < np.searchsorted(odd, high):
                rows = np.setdiff1d(np.arange(low, high), odd, assume_unique=True)
            begins = self.text.starts[self.lines[rows] - 1].astype(np.int64) - int(self.text.starts[first])
            if len(begins):
                yield rows, self.text.bytes_of(first, last), begins

    @cached_property
    def _may_be_quoted(self) -> bool:
        return self.sep != " " and b'"' in self.text.data

    def _unquoted(self, piece: Bytes, start: Ints, end: Ints) -> tuple[Ints, Ints]:
        return big_cells.unquoted(piece, start, end) if self._may_be_quoted else (start, end)

    def _parsed(self, piece: Bytes, start: Ints, end: Ints, decimal: str) -> tuple[Floats, Ints]:
        """Return the numbers of cells that are not plain ones, nan where they hold none, and which those are."""
        start, end = big_cells.without_blanks(piece, *self._unquoted(piece, start, end))
        values = np.full(len(start), np.nan)
        filled = np.flatnonzero(start < end)
        values[filled], _ = self.parse(tuple(_texts(piece, start[filled], end[filled])), decimal)
        return values, np.flatnonzero(np.isnan(values))

    def numbers(self, column: int, decimal: str) -> tuple[Floats, Ints]:
        """Return the numbers of a column, nan where a cell holds none, and the rows of those cells."""
        if column not in self._numbers:
            self.read([column], [], decimal)
        return self._numbers.pop(column)

    def labels(self, column: int) -> Labels:
        """Return the cells of a column as codes into the different ones, in the order of the rows."""
        if column not in self._words:
            self.read([], [column], ".")
        return self._words.pop(column)


def _in_order(codes: NDArray[np.int32], words: tuple[str, ...]) -> Labels:
    """Return labels whose table is in the order of the words' first appearance."""
    first = np.full(len(words), len(codes), np.int64)
    first[codes[::-1]] = np.arange(len(codes))[::-1]  # the last one written is the first of its kind
    order = np.argsort(first, kind="stable")
    place = np.empty(len(words), np.int32)
    place[order] = np.arange(len(words), dtype=np.int32)
    return Labels(place[codes], tuple(words[k] for k in order.tolist()))


def _texts(piece: Bytes, start: Ints, end: Ints) -> list[str]:
    """Return cells, of which most pieces have few different ones."""
    ends = zip(start.tolist(), end.tolist(), strict=True)
    if len(start) < FEW:
        return [piece[low:high].tobytes().decode("utf-8", "surrogatepass") for low, high in ends]
    data = piece.tobytes()
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
            start, stop, step = index.indices(len(self))
            if step > 0 and stop <= HEAD:
                return self._rows.head[self._column][start:stop:step]
            return tuple(self[i] for i in range(start, stop, step))
        count = len(self._rows.lines)
        if not -count <= index < count:
            raise IndexError(index)
        return self._rows.cell(index % count, self._column)

    def __iter__(self) -> Iterator[str]:
        labels = self.labels()
        return (labels.table[code] for code in labels.codes.tolist())

    def prepare(self, numbers: Sequence[int], words: Sequence[int], decimal: str) -> None:
        """Read several columns of this one's table together: quicker than one after the other."""
        self._rows.read(numbers, words, decimal)

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

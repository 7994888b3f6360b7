"""A text table as plain data: header, cells as strings, the line of each row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Message, folded, message
from geofit.io.big_columns import BLANK, ODD, TAKEN, BigColumn, big_columns, find_lines
from geofit.io.big_text import BIG, BigText, big_text
from geofit.io.journal import Journal
from geofit.io.not_tables import require_table
from geofit.io.sniff import (
    decode,
    find_decimal,
    find_header,
    find_separator,
    grouped_number,
    is_header,
    is_units_row,
    joined_header,
    quoted_cells,
    split_line,
)
from geofit.io.source import Source

__all__ = [
    "MOST_COLUMNS",
    "Table",
    "first_names",
    "list_second_header",
    "list_title",
    "parse_numbers",
    "read_table",
    "require_width",
    "unique_names",
]

Floats = NDArray[np.float64]

_SAMPLE, _SHOWN = 200, 40
#: Columns of the widest sheet that a spreadsheet program holds.
MOST_COLUMNS = 16_384
_SEPARATOR_NAMES = {"\t": "tab", " ": "blanks"}


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of one text file.

    ``columns[j][i]`` is the cell of column j in row i as written in the file, ``lines[i]`` the line of
    row i counted from 1 (the feature's number in a map format). ``crs`` is the coordinate system that the file
    itself names. ``read`` counts the rows of the file; those that are not in ``columns`` have cells
    beyond the header's and are listed in the journal already. ``named``: the file has a header.
    """

    name: str
    header: tuple[str, ...]
    units: tuple[str, ...]
    columns: tuple[Sequence[str], ...]
    lines: NDArray[np.int64]
    read: int
    named: bool
    encoding: str
    sep: str
    decimal: str
    crs: str = ""

    def __len__(self) -> int:
        return len(self.lines)


def read_table(source: Source, journal: Journal) -> Table:
    """Read a text table; what is guessed is listed.

    Parameters
    ----------
    source : Source
        The file, with whatever of encoding, separator and decimal mark the user states.
    journal : Journal
        Receives the guesses as notes, and rows whose cells do not fit the header.

    Raises
    ------
    InputError
        If the file is missing, empty, no text, a model or document, or has a header only.
    """
    data = journal.read(source)
    require_table(data, source.name)
    lines, encoding = _lines(data, source)
    _warn_of_characters(lines, encoding, source.name, journal)
    start = _skip_comments(lines, source.name, journal)
    sample = [line for line in lines[start : start + 4 * _SAMPLE] if line.strip()][:_SAMPLE]
    if not sample:
        raise InputError(
            message("io.file-empty", "The file is empty"),
            message("io.give-header-and-row", "A header and at least one row are needed."),
            file=source.name,
        )
    sep = source.sep or find_separator(sample)
    if source.sep == source.decimal == "," and not any('"' in line for line in sample):
        raise InputError(
            message("io.comma-ambiguous", "The comma cannot be both separator and decimal mark: no cell is in quotes"),
            message("io.name-separator", "Name the separator between the cells."),
            file=source.name,
        )
    decimal = source.decimal or (
        lines.decimal(sep) if isinstance(lines, BigText) else find_decimal("\n".join(lines), sep)
    )
    start, upper = _skip_titles(lines, start, sep, source.name, journal)
    first, taken = _quoted(lines, start, sep)
    first = joined_header(upper, first) if upper else first
    below = [line for line in lines[start + taken : start + 4 * _SAMPLE] if line.strip(sep + " \t")][:_SAMPLE]
    named = is_header(first, [split_line(line, sep) for line in below])
    width = len(first)
    while named and width > 1 and not first[width - 1].strip():
        width -= 1
    require_width(width, source.name)
    header = unique_names([cell.strip() for cell in first[:width]]) if named else _numbered(width)
    body = start + taken if named else start
    units: tuple[str, ...] = ()
    if named and below and is_units_row(split_line(below[0], sep)):
        units = tuple(cell.strip() for cell in split_line(below[0], sep))
        body = lines.index(below[0], body) + 1
        journal.add(
            "note",
            source.name,
            message("io.row-of-units", "This row contains the units"),
            row=body,
            value=below[0],
        )
    columns, numbers, malformed = _columns(lines, body, width, sep, source.name, journal)
    if not len(numbers) and not malformed:
        raise InputError(
            message("io.file-without-rows", "The file has a header ({names}) but no rows", names=first_names(header)),
            message("io.export-table-with-rows", "Export the table again with its rows."),
            file=source.name,
        )
    journal.add(
        "note",
        source.name,
        message(
            "io.read-as-table",
            "Read as {encoding}, cells separated by {separator}, decimal mark '{decimal}', {header}",
            encoding=encoding,
            separator=_SEPARATOR_NAMES.get(sep, repr(sep)),
            decimal=decimal,
            header=message("io.with-header", "with a header")
            if named
            else message("io.without-header", "without a header"),
        ),
        message("io.state-table-format", "If this is wrong, state encoding, sep or decimal."),
    )
    return Table(
        name=source.name,
        header=header,
        units=units,
        columns=columns,
        lines=np.asarray(numbers, dtype=np.int64),
        read=len(numbers) + malformed,
        named=named,
        encoding=encoding,
        sep=sep,
        decimal=decimal,
    )


def _lines(data: bytes, source: Source) -> tuple[Sequence[str], str]:
    """Return the lines of a file and its encoding."""
    if len(data) >= BIG:
        return big_text(data, source.name, source.encoding)
    text, encoding = decode(data, source.name, source.encoding)
    return text.replace("\r\n", "\n").replace("\r", "\n").replace("\0", "").split("\n"), encoding


def _warn_of_characters(lines: Sequence[str], encoding: str, name: str, journal: Journal) -> None:
    """Warn of lines in different encodings, and of characters that are lost: names may no longer agree."""
    if "+" in encoding:
        journal.add(
            "warning",
            name,
            message(
                "io.encodings-mixed",
                "Lines of the file are written in different encodings ({encodings}); each is read in its own",
                encodings=encoding,
            ),
            message("io.check-names", "Check the names, or save the file as CSV UTF-8."),
        )
    if isinstance(lines, BigText) and "\ufffd".encode() not in lines.data:
        return
    lost = [i for i, line in enumerate(lines, 1) if "\ufffd" in line]
    if lost:
        journal.add(
            "warning",
            name,
            message(
                "io.characters-lost",
                "Lines with damaged characters, read as \ufffd: {count}; names there may differ from those elsewhere",
                count=len(lost),
            ),
            message("io.correct-names-or-export", "Correct the names there, or export the file again."),
            row=lost[0],
            value=lines[lost[0] - 1][:120],
        )


def _skip_comments(lines: Sequence[str], name: str, journal: Journal) -> int:
    """Return the index of the first line that is not a comment; later '#' are data (hole '#12')."""
    start = 0
    while start < len(lines) and (not lines[start].strip() or lines[start].lstrip().startswith("#")):
        start += 1
    skipped = sum(bool(line.strip()) for line in lines[:start])
    if skipped:
        journal.add(
            "note",
            name,
            message("io.comment-lines", "Comment lines at the head that are not read: {count}", count=skipped),
            row=1,
            value=lines[0],
        )
    return start


def _skip_titles(lines: Sequence[str], start: int, sep: str, name: str, journal: Journal) -> tuple[int, list[str]]:
    """Return the index of the header's last line below any titles, and the names of a line above that belongs to it."""
    marks = sep + " \t"
    filled = [i for i in range(start, min(start + _SAMPLE, len(lines))) if lines[i].strip(marks)]
    if sep == " " or not filled:
        return (filled[0] if filled else start), []
    rows = [split_line(lines[i], sep) for i in filled]
    first, last = find_header(rows)
    for i in filled[:first]:
        list_title(name, i + 1, lines[i], journal)
    if last > first:
        list_second_header(name, filled[last] + 1, lines[filled[last]], journal)
    return filled[last], rows[first] if last > first else []


def list_title(name: str, row: int, value: str, journal: Journal) -> None:
    """List a row above the header."""
    journal.add(
        "note", name, message("io.title-line", "A title above the header is not read"), row=row, value=value.strip()
    )


def list_second_header(name: str, row: int, value: str, journal: Journal) -> None:
    """List the second row of a header."""
    journal.add(
        "note",
        name,
        message("io.header-of-two-rows", "The header has two rows; where both name a column, this one counts"),
        row=row,
        value=value.strip(),
    )


def _columns(
    lines: Sequence[str], start: int, width: int, sep: str, name: str, journal: Journal
) -> tuple[tuple[Sequence[str], ...], Sequence[int] | NDArray[np.int64], int]:
    """Return the columns, the line of each row counted from 1, and how many rows do not fit the header.

    Rows with exactly the header's cells and no quotes are split all at once: a million small lists would keep
    the garbage collector busy for seconds.
    """
    regular: list[str] = []
    numbers: list[int] = []
    odd: dict[int, list[str]] = {}
    marks = sep + " \t"
    blank = malformed = 0
    kinds = find_lines(lines, start, width, sep) if isinstance(lines, BigText) else None
    looked_at = range(start, len(lines)) if kinds is None else np.flatnonzero(kinds == ODD).tolist()
    below = start
    for i in looked_at:
        if i < below:
            continue
        line = lines[i]
        if not line.strip(marks):
            blank += bool(line.strip())
            continue
        if kinds is None and sep != " " and '"' not in line and line.count(sep) == width - 1:
            regular.append(line)
            numbers.append(i + 1)
            continue
        cells, taken = _quoted(lines, i, sep)
        below = i + taken
        if kinds is not None:
            kinds[i + 1 : below] = TAKEN
        # Blanks leave no trace of an empty cell: those behind it would move to the left.
        if any(cell.strip() for cell in cells[width:]) or (sep == " " and len(cells) < width):
            malformed += 1
            _list_malformed(name, i + 1, line, len(cells), width, sep, journal)
        else:
            odd[i] = (cells + [""] * width)[:width]
    if kinds is not None:
        blank += int((kinds == BLANK).sum())
    if blank:
        journal.add(
            "note",
            name,
            message(
                "io.empty-lines",
                "Lines without a filled cell, which are not rows: {count}",
                count=blank,
            ),
        )
    if kinds is not None and isinstance(lines, BigText):
        return *big_columns(lines, kinds, odd, width, sep, _parse_cells), malformed
    cells = sep.join(regular).split(sep) if regular else []
    columns = [cells[j::width] + [row[j] for row in odd.values()] for j in range(width)]
    numbers += [i + 1 for i in odd]
    if odd:
        order = np.argsort(numbers).tolist()
        columns = [[column[k] for k in order] for column in columns]
        numbers.sort()
    return tuple(map(tuple, columns)), numbers, malformed


def _list_malformed(name: str, number: int, line: str, count: int, width: int, sep: str, journal: Journal) -> None:
    journal.add(
        "error",
        name,
        message("io.row-cells-differ", "Cells of the row: {count}, of the header: {width}", count=count, width=width),
        message("io.fill-or-separate-cells", "Write a mark such as - into empty cells, or separate cells by commas.")
        if sep == " "
        else message(
            "io.quote-cells",
            "Quote cells that contain the separator, or use a separator other than the decimal mark.",
        ),
        row=number,
        value=line[:120],
    )


def _quoted(lines: Sequence[str], i: int, sep: str) -> tuple[list[str], int]:
    """Return the cells of a row that may have quotes, and over how many lines it runs.

    A cell may hold line breaks. A quote that is never closed would swallow the rows below it, so a cell ends
    with its line when the lines that it would take look like rows of their own.
    """
    alone = split_line(lines[i], sep)
    if sep == " " or lines[i].count('"') % 2 == 0:
        return alone, 1
    for taken in range(2, min(60, len(lines) - i) + 1):
        if lines[i + taken - 1].count('"') % 2 == 1:
            inner = lines[i + 1 : i + taken - 1]
            joined = quoted_cells([line + "\n" for line in lines[i : i + taken]], sep)
            if any(line.count(sep) >= len(joined) - 1 > 0 for line in inner):
                break
            return joined, taken
    return alone, 1


def require_width(width: int, file: str) -> None:
    """Refuse a table that is wider than any spreadsheet.

    Raises
    ------
    InputError
        If there are more than :data:`MOST_COLUMNS` columns.
    """
    if width > MOST_COLUMNS:
        raise InputError(
            message(
                "io.too-many-columns",
                "The table has {count} columns; at most {most} are read",
                count=width,
                most=MOST_COLUMNS,
            ),
            message(
                "io.state-separator-or-export-less",
                "State the separator of the cells, or export the columns that are needed.",
            ),
            file=file,
        )


def first_names(names: Sequence[str]) -> Message | str:
    """Return the first names of columns with commas, and how many there are more."""
    text = ", ".join(folded(name, 60) for name in names[:_SHOWN])
    return (
        message("io.names-and-more", "{names}, and {count} more", names=text, count=len(names) - _SHOWN)
        if len(names) > _SHOWN
        else text
    )


def unique_names(names: list[str]) -> tuple[str, ...]:
    """Return headers of which none is empty and no two are alike."""
    seen: dict[str, int] = {}
    unique = []
    for j, name in enumerate(names):
        name = name or f"column {j + 1}"
        seen[name] = seen.get(name, 0) + 1
        unique.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return tuple(unique)


def _numbered(width: int) -> tuple[str, ...]:
    return tuple(f"column {j + 1}" for j in range(width))


def parse_numbers(cells: Sequence[str], decimal: str) -> tuple[Floats, NDArray[np.int64]]:
    """Return the numbers of a column, nan where a cell holds none, and the indices of those cells.

    "nan" and "inf" are not numbers here, nor is "1_000", which Python would read; thousands may be marked
    (:func:`geofit.io.sniff.grouped_number`).
    """
    return cells.numbers(decimal) if isinstance(cells, BigColumn) else _parse_cells(tuple(cells), decimal)


#: Minus signs, and the dashes that word processors make of them.
_DASHES = str.maketrans(dict.fromkeys("\u2212\u2010\u2011\u2013\ufe63\uff0d", "-"))


def _parse_cells(cells: tuple[str, ...], decimal: str) -> tuple[Floats, NDArray[np.int64]]:
    joined, written = "".join(cells), cells
    if decimal == "," and ("," in joined or "." in joined):
        swap = str.maketrans(",.", ".,")
        cells = tuple(cell.translate(swap) for cell in cells)
    if not joined.isascii():
        cells = tuple(cell.translate(_DASHES) for cell in cells)
    try:
        values = np.fromiter(map(float, cells), dtype=np.float64, count=len(cells))
    except ValueError:
        values = np.fromiter(map(_float, cells), dtype=np.float64, count=len(cells))
    if "_" in joined:
        values[["_" in cell for cell in cells]] = np.nan
    bad = np.flatnonzero(~np.isfinite(values))
    values[bad] = [grouped_number(written[i].translate(_DASHES), decimal) for i in bad.tolist()]
    bad = bad[np.isnan(values[bad])]
    return values, bad


def _float(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan

"""Sheets of a workbook (openpyxl, extra ``xlsx``)."""

from __future__ import annotations

import datetime
import io
import warnings
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any
from xml.etree.ElementTree import ParseError

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.io.cells import number_text, table_of
from geofit.io.extra import need
from geofit.io.journal import Journal
from geofit.io.sniff import find_header, is_header, is_units_row, joined_header
from geofit.io.source import Source
from geofit.io.tables import Table, list_second_header, list_title

__all__ = ["hidden_sheets", "read_sheet", "sheet_names"]

_SAMPLE = 200
#: Rows of the longest sheet that a spreadsheet program holds; cells that are read, also empty ones before filled ones;
#: bytes that a workbook may unpack to.
MOST_ROWS, MOST_CELLS, MOST_BYTES = 1_048_576, 25_000_000, 2_000_000_000


def sheet_names(source: Source) -> tuple[str, ...]:
    """Return the sheets that hold a filled row, in order."""
    return tuple(name for name, rows in _open(source, source.read()).items() if rows)


def hidden_sheets(source: Source) -> tuple[str, ...]:
    """Return the sheets that a spreadsheet program does not show."""
    with _opened(source, source.read()) as book:
        return tuple(str(sheet.title) for sheet in book.worksheets if sheet.sheet_state != "visible")


def read_sheet(source: Source, journal: Journal) -> Table:
    """Read the sheet that ``source.table`` names, or the only one; formulas give the value that was saved.

    Raises
    ------
    InputError
        If the file is not a workbook, or has no such sheet.
    """
    sheets = _open(source, journal.read(source))
    name = source.table or next((name for name, rows in sheets.items() if rows), "")
    rows = sheets.get(name)
    if not rows:
        raise InputError(
            message(
                "io.sheet-missing",
                "The workbook has no sheet '{name}' with rows; its sheets are {names}",
                name=name,
                names=", ".join(sheets),
            ),
            message("data.name-one", "Name one of them."),
            file=source.name,
        )
    top, last = find_header([cells for _, cells in rows[:_SAMPLE]])
    for line, cells in rows[:top]:
        list_title(source.name, line, " ".join(cells), journal)
    upper, first, rows = rows[top][1], rows[last][1], rows[last:]
    if last > top:
        list_second_header(source.name, rows[0][0], " ".join(first), journal)
        first = joined_header(upper, first)
    width = max(j + 1 for j, cell in enumerate(first) if cell)
    named = is_header(first[:width], [cells for _, cells in rows[1:_SAMPLE]])
    header = first[:width] if named else [f"column {j + 1}" for j in range(width)]
    body = rows[1:] if named else rows
    units: list[str] = []
    if named and body and is_units_row(body[0][1]):
        line, units = body[0]
        body = body[1:]
        journal.add("note", source.name, message("io.row-of-units", "This row contains the units"), row=line)
    journal.add(
        "note",
        source.name,
        message(
            "io.read-sheet",
            "Read from sheet '{sheet}', {header}",
            sheet=name,
            header=message("io.with-header", "with a header")
            if named
            else message("io.without-header", "without a header"),
        ),
    )
    return table_of(source, journal, header, body, units=units, named=named)


def _open(source: Source, data: bytes) -> dict[str, list[tuple[int, list[str]]]]:
    """Return the filled rows of each sheet: line and cells."""
    with _opened(source, data) as book:
        sheets = {}
        for sheet in book.worksheets:
            sheet.reset_dimensions()
            sheets[str(sheet.title)] = _filled_rows(sheet.values, source.name)
        return sheets


@contextmanager
def _opened(source: Source, data: bytes) -> Iterator[Any]:
    """Open a workbook; what openpyxl raises on a damaged one becomes an error of ours."""
    openpyxl = need("openpyxl", "xlsx", message("io.reading-workbook", "Reading the workbook {file}", file=source.name))
    failures = (
        openpyxl.utils.exceptions.InvalidFileException,
        zipfile.BadZipFile,
        ParseError,
        ArithmeticError,
        AttributeError,
        EOFError,
        LookupError,
        OSError,
        RuntimeError,
        TypeError,
        ValueError,
        zlib.error,
    )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # openpyxl warns of styles that it does not know
            _require_size(data, source.name)
            book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
            yield book
            book.close()
    except failures:
        raise InputError(
            _unreadable(data),
            message(
                "io.save-workbook-again",
                "Open it in a spreadsheet program and save it as .xlsx, or the sheet as CSV UTF-8.",
            ),
            file=source.name,
        ) from None


def _unreadable(data: bytes) -> Message:
    """Return why a workbook cannot be read, by how the file begins."""
    if not data:
        return message("io.workbook-empty", "The workbook is empty: the file has no byte")
    if data.startswith(b"\xd0\xcf\x11\xe0"):
        return message("io.workbook-old", "The workbook is one of the old format .xls, or it has a password")
    if not data.startswith(b"PK"):
        return message("io.file-not-workbook", "The file is not an .xlsx workbook")
    return message("io.workbook-unreadable", "The workbook cannot be read: it is damaged or incomplete")


def _require_size(data: bytes, file: str) -> None:
    """Refuse a workbook that unpacks to more than its rows can need."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        unpacked = sum(member.file_size for member in archive.infolist())
    if unpacked > MOST_BYTES:
        raise InputError(
            message(
                "io.workbook-too-large",
                "The workbook unpacks to {size:.0f} MB; at most {most:.0f} are read",
                size=unpacked / 1e6,
                most=MOST_BYTES / 1e6,
            ),
            message("io.save-sheet-as-csv", "Save the sheet as CSV UTF-8."),
            file=file,
        )


def _filled_rows(values: Iterable[Sequence[Any]], file: str) -> list[tuple[int, list[str]]]:
    """Return line and cells of the filled rows, each up to its last filled cell.

    A file of a few bytes may claim two thousand million rows, or rows of which only the last of 16,384 cells is
    filled.
    """
    found: list[tuple[int, list[str]]] = []
    cells_read = 0
    for line, row in enumerate(values, 1):
        if line > MOST_ROWS or cells_read > MOST_CELLS:
            raise InputError(
                message("io.sheet-rows", "The sheet has more than {most} rows", most=MOST_ROWS)
                if line > MOST_ROWS
                else message(
                    "io.sheet-cells",
                    "The first {rows} rows of the sheet have {cells} cells; at most {most} can be read",
                    rows=line - 1,
                    cells=cells_read,
                    most=MOST_CELLS,
                ),
                message(
                    "io.remove-cells-beyond-table",
                    "Remove the rows and columns beyond the table, or save the sheet as CSV UTF-8.",
                ),
                file=file,
            )
        width = len(row)
        while width and row[width - 1] is None:
            width -= 1
        cells_read += width
        cells = [_text(value) for value in row[:width]]
        if any(cells):
            found.append((line, cells))
    return found


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, (int, float)):
        return number_text(float(value))
    if isinstance(value, datetime.datetime) and value.time() == datetime.time():
        return value.date().isoformat()  # a sheet stores every day as its midnight
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    return str(value).strip()

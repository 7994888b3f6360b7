"""Sheets of a workbook (openpyxl, extra ``xlsx``)."""

from __future__ import annotations

import datetime
import io
import warnings
import zipfile
import zlib
from typing import Any
from xml.etree.ElementTree import ParseError

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.cells import number_text, table_of
from geofit.io.extra import need
from geofit.io.journal import Journal
from geofit.io.sniff import is_header, is_units_row
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["read_sheet", "sheet_names"]

_SAMPLE = 200


def sheet_names(source: Source) -> tuple[str, ...]:
    """Return the sheets that hold a filled row, in order."""
    return tuple(name for name, rows in _open(source, source.read()).items() if rows)


def read_sheet(source: Source, journal: Journal) -> Table:
    """Read the sheet that ``source.table`` names, or the only one; formulas give the value that was saved.

    Raises
    ------
    InputError
        If the file is no workbook, or has no such sheet.
    """
    sheets = _open(source, journal.read(source))
    name = source.table or next((name for name, rows in sheets.items() if rows), "")
    rows = sheets.get(name)
    if not rows:
        raise InputError(
            message(
                "import.workbook-no-sheet-rows",
                "The workbook has no sheet '{name}' with rows; its sheets are {names}",
                name=name,
                names=", ".join(sheets),
            ),
            message("import.name-one", "Name one of them."),
            file=source.name,
        )
    while len(rows) > 1 and sum(map(bool, rows[0][1])) == 1 and sum(map(bool, rows[1][1])) > 1:
        line, cells = rows.pop(0)
        journal.add(
            "note",
            source.name,
            message("import.title-above-header-not", "A title above the header is not read"),
            row=line,
            value=" ".join(cells).strip(),
        )
    first = rows[0][1]
    width = max(j + 1 for j, cell in enumerate(first) if cell)
    named = is_header(first[:width], [cells for _, cells in rows[1:_SAMPLE]])
    header = first[:width] if named else [f"column {j + 1}" for j in range(width)]
    body = rows[1:] if named else rows
    units: list[str] = []
    if named and body and is_units_row(body[0][1]):
        line, units = body[0]
        body = body[1:]
        journal.add("note", source.name, message("import.row-holds-units", "This row holds the units"), row=line)
    journal.add(
        "note",
        source.name,
        message(
            "import.read-sheet",
            "Read from sheet '{sheet}', {header}",
            sheet=name,
            header=message("import.with-header", "with a header")
            if named
            else message("import.without-header", "without a header"),
        ),
    )
    return table_of(source, journal, header, body, units=units, named=named)


def _open(source: Source, data: bytes) -> dict[str, list[tuple[int, list[str]]]]:
    """Return the filled rows of each sheet: line and cells."""
    openpyxl = need(
        "openpyxl", "xlsx", message("import.reading-workbook", "Reading the workbook {file}", file=source.name)
    )
    failures = (
        openpyxl.utils.exceptions.InvalidFileException,
        zipfile.BadZipFile,
        ParseError,
        ArithmeticError,
        AttributeError,
        EOFError,
        LookupError,
        NotImplementedError,
        OSError,
        RuntimeError,
        TypeError,
        ValueError,
        zlib.error,
    )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # openpyxl warns of styles that it does not know
            book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
            sheets = {}
            for sheet in book.worksheets:
                sheet.reset_dimensions()
                rows = [(line, [_text(value) for value in row]) for line, row in enumerate(sheet.values, 1)]
                sheets[str(sheet.title)] = [(line, cells) for line, cells in rows if any(cells)]
            book.close()
            return sheets
    except failures as error:
        raise InputError(
            message(
                "import.workbook-cannot-read",
                "The workbook cannot be read: {error}",
                error=str(error) or type(error).__name__,
            ),
            message(
                "import.open-spreadsheet-program-save",
                "Open it in a spreadsheet program and save it as .xlsx, or the sheet as CSV UTF-8.",
            ),
            file=source.name,
        ) from None


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, (int, float)):
        return number_text(float(value))
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    return str(value).strip()

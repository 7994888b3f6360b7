"""Rows of cells that a workbook, an exchange format or a map gives, as a table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table, unique_names

__all__ = ["number_text", "table_of"]


def number_text(value: float) -> str:
    """Return a number as the shortest text that reads back as it; empty for nan."""
    if value != value:
        return ""
    return str(int(value)) if abs(value) < 1e15 and value == int(value) else repr(float(value))


def table_of(
    source: Source,
    journal: Journal,
    header: Sequence[str],
    rows: Sequence[tuple[int, Sequence[str]]],
    *,
    units: Sequence[str] = (),
    malformed: int = 0,
    named: bool = True,
    encoding: str = "",
    crs: str = "",
) -> Table:
    """Return a table of rows (line, cells).

    Short rows are filled with empty cells; rows with filled cells beyond the header are listed. ``malformed``
    counts rows that are listed already.

    Raises
    ------
    InputError
        If there is no row.
    """
    width = len(header)
    kept: list[tuple[int, Sequence[str]]] = []
    for line, cells in rows:
        if any(cell.strip() for cell in cells[width:]):
            malformed += 1
            journal.add(
                "error",
                source.name,
                message(
                    "io.row-cells-differ",
                    "Cells of the row: {count}, of the header: {width}",
                    count=len(cells),
                    width=width,
                ),
                message("io.complete-header", "Complete the header or shorten the row."),
                row=line,
                value=" ".join(cells)[:120],
            )
        else:
            kept.append((line, cells))
    if not kept and not malformed:
        raise InputError(
            message(
                "io.table-without-rows",
                "The table has a header ({names}) but no rows",
                names=", ".join(header[:40]),
            ),
            message("io.export-table-with-rows", "Export the table again with its rows."),
            file=source.name,
        )
    columns = tuple(tuple(cells[j] if j < len(cells) else "" for _, cells in kept) for j in range(width))
    return Table(
        name=source.name,
        header=unique_names([name.strip() for name in header]),
        units=tuple(units),
        columns=columns,
        lines=np.array([line for line, _ in kept], dtype=np.int64),
        read=len(kept) + malformed,
        named=named,
        encoding=encoding,
        sep="",
        decimal=source.decimal or ".",
        crs=crs,
    )

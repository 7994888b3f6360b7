"""Surfer grids: version 6 in ASCII (DSAA) and binary (DSBB), version 7 (DSRB)."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.io.journal import Journal
from geofit.io.no_data import blank_nodes
from geofit.io.source import Source
from geofit.io.units import grid_unit

__all__ = ["read_surfer"]

Floats = NDArray[np.float64]

#: Elevations from this on are blanked cells.
BLANK = 1.70141e38


def read_surfer(data: bytes, source: Source, journal: Journal) -> Ground:
    """Read a grid from its bytes; blanked cells are nan.

    Raises
    ------
    InputError
        If the head is damaged or the cells are not columns x rows.
    """
    try:
        if data[:4] == b"DSAA":
            columns, rows, corners, z, blank = _ascii(data)
        elif data[:4] == b"DSBB":
            columns, rows, corners, z, blank = _binary_6(data)
        else:
            columns, rows, corners, z, blank = _binary_7(data)
    except (struct.error, ValueError, IndexError, OverflowError):
        raise InputError(
            message("io.surfer-grid-damaged", "The Surfer grid is damaged or incomplete"),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        ) from None
    west, east, south, north = corners
    if columns < 2 or rows < 2 or z.size != columns * rows:
        raise InputError(
            message(
                "io.surfer-cells-differ",
                "The grid has {count} cells; columns x rows = {columns} x {rows} are needed, 2 x 2 at least",
                count=z.size,
                columns=columns,
                rows=rows,
            ),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        )
    if not (np.isfinite(corners).all() and east > west and north > south):
        raise InputError(
            message(
                "io.grid-without-area",
                "The grid's corners enclose no area: x {west:g} to {east:g}, y {south:g} to {north:g}",
                west=west,
                east=east,
                south=south,
                north=north,
            ),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        )
    z = np.where(np.isfinite(z) & (z < BLANK) & (z != blank), z, np.nan)
    blank_nodes(z, source.name, journal)
    if np.isnan(z).all():
        raise InputError(
            message("io.grid-without-elevation", "No cell of the grid has an elevation"),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        )
    if np.isnan(z).any():
        journal.add(
            "note",
            source.name,
            message(
                "io.cells-without-data",
                "{count} of {total} cells have no data",
                count=int(np.isnan(z).sum()),
                total=z.size,
            ),
        )
    journal.count(source.name, rows, 0)
    scale = grid_unit(source, journal)
    x, y = np.linspace(west, east, columns), np.linspace(south, north, rows)
    return Ground(scale * x, scale * y, scale * z.reshape(rows, columns))


_Grid = tuple[int, int, tuple[float, float, float, float], Floats, float]


def _ascii(data: bytes) -> _Grid:
    words = data.decode("ascii").split()[1:]
    columns, rows = int(words[0]), int(words[1])
    west, east, south, north = map(float, words[2:6])
    return columns, rows, (west, east, south, north), np.array(words[8:], dtype=np.float64), BLANK


def _binary_6(data: bytes) -> _Grid:
    columns, rows, west, east, south, north = struct.unpack_from("<hhdddd", data, 4)
    z = np.frombuffer(data[56:], dtype="<f4", count=max(columns, 0) * max(rows, 0)).astype(np.float64)
    return columns, rows, (west, east, south, north), z, BLANK


def _binary_7(data: bytes) -> _Grid:
    """Read the sections of a version 7 grid: each has a tag, its size in bytes, and its content."""
    at, head, z = 0, None, None
    while at + 8 <= len(data) and z is None:
        tag, size = struct.unpack_from("<4si", data, at)
        at += 8
        if size < 0:
            raise ValueError(f"a section of {size} bytes")
        if tag == b"GRID":
            head = struct.unpack_from("<iidddddddd", data, at)
        elif tag == b"DATA" and head is not None:
            count = max(head[0], 0) * max(head[1], 0)
            z = np.frombuffer(data[at : at + size], dtype="<f8", count=count).astype(np.float64)
        at += size
    if head is None or z is None:
        raise ValueError("it has no GRID or no DATA section")
    rows, columns, west, south, dx, dy, _, _, _, blank = head
    return columns, rows, (west, west + dx * (columns - 1), south, south + dy * (rows - 1)), z, blank

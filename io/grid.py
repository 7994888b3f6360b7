"""The ground, or a horizon, from an ESRI ASCII grid, a Surfer grid or a GeoTIFF."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message, plural_message
from geofit.data.points import PointSet
from geofit.data.site import Ground
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.no_data import blank_nodes
from geofit.io.sniff import decode
from geofit.io.source import Source, as_source
from geofit.io.units import grid_unit

__all__ = ["load_grid", "load_ground", "read_ground"]

_KEYS = {
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
}


@arguments_checked
def read_ground(path: str | Path | Source) -> Ground:
    """Read a grid of elevations; cells without data are nan.

    Parameters
    ----------
    path : path or Source
        ESRI ASCII, Surfer 6 (ASCII and binary), Surfer 7 or GeoTIFF (extra ``gis``), recognized by its first bytes.

    Returns
    -------
    Ground
        Nodes in map coordinates and elevations, metres.

    Raises
    ------
    InputError
        If the head is incomplete, a cell is not a number, or the cells are not columns x rows.
    MissingDependencyError
        If rasterio is not installed.

    Notes
    -----
    Formats: ``docs/formats_in.md``.
    """
    return load_ground(as_source(path), Journal())


def load_ground(source: Source, journal: Journal) -> Ground:
    """Read a grid; the journal receives the count of lines or rows and of cells without data."""
    data = journal.read(source)
    if data[:4] in (b"DSAA", b"DSBB", b"DSRB"):
        from geofit.io.surfer import read_surfer

        return read_surfer(data, source, journal)
    if data[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
        from geofit.io.raster import read_raster

        return read_raster(source, journal)
    return _read_esri(data, source, journal)


def load_grid(source: Source, horizon: str, horizons: HorizonNames, journal: Journal) -> dict[str, PointSet]:
    """Read the nodes of a grid as points of a horizon, kind "grid": every node that has an elevation.

    ``row`` is the node's number as the grid is read from north to south and west to east, from 1. Nodes without
    data are counted and listed in one line.
    """
    name = horizons.match(horizon)
    if name is None:
        raise InputError(
            message(
                "io.grid-horizon-unknown",
                "The grid is of '{horizon}', which is not a horizon of the site",
                horizon=horizon,
            ),
            message("io.state-grid-horizon", 'State horizon = "..." in [[grids]], or add the [[horizon]].'),
            file=source.name,
        )
    own = Journal(systems=journal.systems)
    grid = load_ground(source, own)
    for file, digest in own.inputs.items():
        journal.inputs[file] = digest
    journal.take(issue for issue in own.issues if issue.reason.code != "io.cells-without-data")
    x, y = np.meshgrid(grid.x, grid.y[::-1])
    xyz = np.column_stack([x.ravel(), y.ravel(), grid.z[::-1].ravel()])
    known = np.isfinite(xyz[:, 2])
    missing = int((~known).sum())
    if missing:
        journal.add(
            "note",
            source.name,
            plural_message(
                "io.nodes-without-data",
                "{count} of {total} nodes has no data and makes no point",
                "{count} of {total} nodes have no data and make no points",
                count=missing,
                total=known.size,
            ),
        )
    journal.count(source.name, known.size, missing)
    return {name: PointSet(xyz[known], kind="grid", row=np.flatnonzero(known) + 1, file=source.name)}


def _read_esri(data: bytes, source: Source, journal: Journal) -> Ground:
    text, _ = decode(data, source.name, source.encoding)
    lines = text.splitlines()
    head: dict[str, float] = {}
    at = 0
    while at < len(lines) and (not lines[at].strip() or lines[at].split()[0].casefold() in _KEYS):
        words = lines[at].split()
        if words:
            head[words[0].casefold()] = _number(words[-1] if len(words) == 2 else "", source.name, at + 1, words[0])
        at += 1
    columns, rows = _size(head, "ncols", source.name), _size(head, "nrows", source.name)
    dx, dy = (head.get(key, head.get("cellsize", float("nan"))) for key in ("dx", "dy"))
    if not (dx > 0 and dy > 0 and np.isfinite(dx + dy)):
        raise InputError(
            message("io.cellsize-missing", "The grid has no cellsize above 0"),
            message("io.add-cellsize-line", "Add a line 'cellsize 10'."),
            file=source.name,
        )
    west = _corner(head, "x", dx, source.name)
    south = _corner(head, "y", dy, source.name)
    if not np.isfinite(west + south):
        raise InputError(
            message("io.grid-corner-not-finite", "The grid's corner is not a finite location"),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        )
    body = [(at + k + 1, line.split()) for k, line in enumerate(lines[at:]) if line.strip()]
    cells = [word for _, words in body for word in words]
    if len(cells) != columns * rows:
        raise InputError(
            message(
                "io.grid-cells-differ",
                "The grid has {count} cells; ncols x nrows = {columns} x {rows} are needed",
                count=len(cells),
                columns=columns,
                rows=rows,
            ),
            message("io.export-grid-again", "Export the grid again."),
            file=source.name,
        )
    try:
        z = np.array(cells, dtype=np.float64)
    except ValueError:
        for line, words in body:
            for word in words:
                _number(word, source.name, line, "cell")
        raise
    blank = ~np.isfinite(z) | (z == head.get("nodata_value", -9999.0))
    z[blank] = np.nan
    blank_nodes(z, source.name, journal)
    blank = np.isnan(z)
    if blank.all():
        raise InputError(
            message("io.grid-without-elevation", "No cell of the grid has an elevation"),
            message("io.check-nodata-value", "Check nodata_value."),
            file=source.name,
        )
    if blank.any():
        journal.add(
            "note",
            source.name,
            message(
                "io.cells-without-data", "{count} of {total} cells have no data", count=int(blank.sum()), total=z.size
            ),
        )
    journal.count(source.name, len(body), 0)
    x, y = np.arange(columns, dtype=np.float64), np.arange(rows, dtype=np.float64)
    scale = grid_unit(source, journal)
    return Ground(scale * (west + dx * x), scale * (south + dy * y), scale * z.reshape(rows, columns)[::-1].copy())


def _number(word: str, file: str, row: int, column: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(
            message("io.not-a-number", "This is not a number"),
            message("io.export-grid-again", "Export the grid again."),
            file=file,
            row=row,
            column=column,
            value=word,
        ) from None


def _size(head: dict[str, float], key: str, file: str) -> int:
    value = head.get(key, np.nan)
    if not (np.isfinite(value) and value >= 2 and value == int(value)):
        raise InputError(
            message(
                "io.grid-header-incomplete",
                "The grid's header has no {key} that is a whole number of at least 2",
                key=Untranslated(key),
            ),
            message(
                "io.give-ascii-grid",
                "An ESRI ASCII grid starts with ncols, nrows, xllcorner, yllcorner, cellsize.",
            ),
            file=file,
        )
    return int(value)


def _corner(head: dict[str, float], axis: str, step: float, file: str) -> float:
    """Return the first cell's centre."""
    if f"{axis}llcenter" in head:
        return head[f"{axis}llcenter"]
    if f"{axis}llcorner" in head:
        return head[f"{axis}llcorner"] + 0.5 * step
    raise InputError(
        message("io.grid-corner-missing", "The grid has no {axis}llcorner", axis=Untranslated(axis)),
        message("io.add-corner-line", "Add a line '{axis}llcorner 500000'.", axis=Untranslated(axis)),
        file=file,
    )

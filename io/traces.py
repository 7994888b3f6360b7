"""Traces of horizons on the geological map, draped on the ground where they state no elevation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.site import Ground
from geofit.io.axes import Region, check_axes, place_in
from geofit.io.columns import TRACES
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.rows import Rows, read_rows
from geofit.io.section_dxf import read_drawing
from geofit.io.source import Source
from geofit.io.vector import RING

__all__ = ["load_traces"]

OFF_GRID = (
    message("io.point-off-ground", "The point lies off the ground's grid"),
    message("io.extend-ground", "Extend the grid or add its elevation."),
)


def load_traces(
    source: Source,
    ground: Ground | None,
    horizons: HorizonNames,
    journal: Journal,
    region: Region | None = None,
) -> dict[str, PointSet]:
    """Read outcrop points, kind "outcrop"; a point without elevation and off the ground's grid is listed.

    Raises
    ------
    InputError
        If elevations are missing and there is no ground.
    """
    if source.path.suffix.casefold() == ".dxf":
        return _from_dxf(source, ground, horizons, journal, region)
    rows = read_rows(source, TRACES, journal)
    horizon = horizons.of(rows)
    x, y = rows.places()
    z = rows.numbers("z", required=False, no_data=True)
    check_axes(rows, x, y, region)
    flat = _flat(rows, z)
    z[flat] = np.nan
    blank = np.flatnonzero(np.isnan(z) & rows.ok)
    if blank.size and ground is None:
        raise _undraped(blank.size, source, int(rows.line[blank[0]]))
    if flat.any():
        journal.add("note", rows.file, _draped(int(flat.sum())))
    if blank.size and ground is not None:
        z[blank] = ground.elevation(x[blank], y[blank])
        for i in blank[np.isnan(z[blank])].tolist():
            rows.reject(i, "x", *OFF_GRID)
    rows.close()
    return horizons.split(rows, horizon, np.column_stack([x, y, z]), kind="outcrop")


def _flat(rows: Rows, z: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the rows of lines that lie at 0 as a whole, as maps without elevations are exported; a table is one."""
    lines = np.array(rows.table.columns[rows.table.header.index(RING)] if RING in rows.table.header else [""] * len(z))
    return np.asarray((z == 0) & ~np.isin(lines, lines[np.isfinite(z) & (z != 0)]))


def _draped(count: int) -> Message:
    return message("io.points-draped", "Points at elevation 0 that are draped on the ground: {count}", count=count)


def _from_dxf(
    source: Source, ground: Ground | None, horizons: HorizonNames, journal: Journal, region: Region | None
) -> dict[str, PointSet]:
    """Read a map: the layer is the horizon, lines that lie at 0 as a whole have no elevation."""
    drawn = read_drawing(source, horizons, journal, scale_stated=False, closed=True)
    xyz, used = drawn.xyz.copy(), np.ones(len(drawn.xyz), bool)
    if region is not None and len(xyz):
        place = place_in(xyz[:, :2], region)
        if place != "inside":
            raise InputError(
                message(
                    "io.map-axes-exchanged",
                    "The map lies far outside the study area; x and y appear to be exchanged",
                )
                if place == "exchanged"
                else message("io.map-far-outside", "The map lies far outside the study area"),
                message(
                    "io.save-in-site-coordinates",
                    "Save the drawing in the site's coordinates; a section is named by [[section]].",
                ),
                file=source.name,
            )
    blank = np.flatnonzero(np.isnan(xyz[:, 2]))
    if blank.size and ground is None:
        raise _undraped(blank.size, source, int(drawn.number[blank[0]]))
    if blank.size and ground is not None:
        journal.add("note", source.name, _draped(blank.size))
        xyz[blank, 2] = ground.elevation(xyz[blank, 0], xyz[blank, 1])
    for i in np.flatnonzero(np.isnan(xyz[:, 2])).tolist():
        used[i] = False
        reason, remedy = OFF_GRID
        journal.add("error", source.name, reason, remedy, row=int(drawn.number[i]), column=drawn.horizon[i])
    journal.count(source.name, len(xyz) + drawn.listed, drawn.listed + int((~used).sum()))
    names = np.array(drawn.horizon, dtype=np.str_)
    return {
        name: PointSet(xyz[chosen], kind="outcrop", row=drawn.number[chosen], file=source.name)
        for name in dict.fromkeys(names[used].tolist())
        for chosen in [np.flatnonzero(used & (names == name))]
    }


def _undraped(count: int, source: Source, row: int) -> InputError:
    return InputError(
        message(
            "io.no-ground-to-drape",
            "The site has no ground on which to place the points without an elevation ({count})",
            count=count,
        ),
        message("io.add-z-or-ground", "Add a column z, or a [ground] table to the site file."),
        file=source.name,
        row=row,
    )

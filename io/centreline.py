"""Centre lines of adits, tunnels and shafts as tables: stations with coordinates and the size of the section."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from geofit.caves.shots import ShotList, require_length
from geofit.caves.survey import LONGEST, Survey
from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message
from geofit.io.columns import ADIT_PATH, Schema, plain_name
from geofit.io.formats import read_any_table
from geofit.io.guess import find_columns
from geofit.io.journal import Journal
from geofit.io.rows import Rows
from geofit.io.source import Source, as_source

__all__ = ["CENTRELINE", "read_centreline"]

#: One row a station. Stations of one line follow each other in the order of the rows.
CENTRELINE = Schema(
    "centre line",
    {role: ADIT_PATH.required[role] for role in ("x", "y", "z")},
    {
        "line": (*ADIT_PATH.required["adit"], "line", "branch", "passage", "drift", "shaft", "线路", "巷道"),
        "station": (
            "station",
            "stationname",
            "stationid",
            "stn",
            "point",
            "pointid",
            "id",
            "no",
            "测点",
            "点号",
            "测站",
        ),
        "radius": ("radius", "r", "半径"),
        "width": ("width", "w", "span", "宽", "宽度", "跨度"),
        "height": ("height", "h", "高", "高度", "净高"),
        "left": ("left", "l", "左", "左宽"),
        "right": ("right", "右", "右宽"),
        "up": ("up", "ceiling", "roof", "上", "顶高"),
        "down": ("down", "floor", "下", "底深"),
    },
)
#: Lengths that are not in the shared list of length roles.
_SIZES = ("radius", "width", "height", "left", "right", "up", "down")


@arguments_checked
def read_centreline(
    source: Source | str | Path, journal: Journal | None = None, *, level: Literal["axis", "floor"] = "axis"
) -> Survey:
    """Read a centre line with its sections.

    Parameters
    ----------
    source : Source, str or Path
        A table (text, workbook, ...) with x, y, z and either radius, width and height, or left, right, up and down;
        optionally the name of the line and of the station. A name in two rows joins lines there.
    journal : Journal, optional
        Receives the rows that are not used.
    level : {"axis", "floor"}
        Whether width and height are about the centre line, or it runs along the floor.

    Returns
    -------
    Survey
        Every station is fixed at its coordinates, and sections are across the line; walls that are missing are nan.

    Raises
    ------
    InputError
        If the table has no line of two usable stations, or no column with a size.

    Notes
    -----
    Headers that are recognized: ``docs/formats_in.md``.
    """
    if level not in ("axis", "floor"):
        raise InputError(
            message("io.level-unknown", "The level '{level}' is unknown", level=level),
            message("io.give-axis-or-floor", "Give 'axis' or 'floor'."),
        )
    source, journal = as_source(source), journal if journal is not None else Journal()
    with journal.handed_over():
        return _survey(source, journal, level)


def _survey(source: Source, journal: Journal, level: Literal["axis", "floor"]) -> Survey:
    first_issue, first_count = len(journal.issues), len(journal.counts)
    rows = _rows(source, journal)
    if not any(role in rows.columns for role in _SIZES):
        raise InputError(
            message("io.section-size-missing", "The table does not give the size of the section"),
            message("io.add-size-columns", "Add a column radius, or width and height, or left, right, up and down."),
            file=source.name,
        )
    (x, y), z = rows.places(), rows.numbers("z", no_data=True)
    line, station = rows.text("line", required=False), rows.text("station", required=False)
    walls = _walls(rows, level)
    shots, previous = ShotList(across=True), dict[str, tuple[str, int]]()
    for i in np.flatnonzero(rows.ok).tolist():
        name = station[i] or f"row {int(rows.line[i])}"
        xyz = (float(x[i]), float(y[i]), float(z[i]))
        if name in shots.fixed and not np.allclose(shots.fixed[name], xyz, rtol=0, atol=1e-3):
            # Numbers that start anew on each line are other stations.
            name = f"{line[i]}.{name}" if line[i] else f"{name} ({int(rows.line[i])})"
        shot, offset = -1, np.zeros(3)
        before, earlier = previous.get(line[i], ("", -1))
        if line[i] in previous:
            offset = np.subtract(xyz, shots.fixed[before])
            if before == name or not np.linalg.norm(offset) > 0:
                rows.reject(
                    i,
                    "x",
                    message("io.station-repeated", "The station repeats row {row}", row=int(rows.line[earlier])),
                    message("io.remove-one", "Remove one."),
                )
                continue
            try:
                require_length(offset)
            except InputError as bad:
                rows.reject(i, "x", bad.reason, bad.remedy)
                continue
        shots.station(name)
        shots.fixed[name] = xyz
        if line[i] in previous:
            shot = shots.add(before, name, offset, int(rows.line[i]))
            if earlier >= 0 and shots.walls and shots.walls[-1][1] == -1:
                shots.walls[-1] = (shots.walls[-1][0], shot, shots.walls[-1][2])
        shots.add_walls(name, shot, walls[i].tolist())
        previous[line[i]] = (name, i)
    rows.close()
    single = [name for name in previous if sum(line[i] == name for i in np.flatnonzero(rows.ok)) == 1]
    for name in single:
        journal.add(
            "warning",
            source.name,
            message("io.line-of-one-station", "The line {line} has one usable station only", line=Untranslated(name))
            if name
            else message("io.table-of-one-station", "The line has one usable station only"),
            message("io.add-stations", "Add its other stations."),
            value=name,
        )
    if not shots.shots:
        raise InputError(
            message("io.no-usable-line", "No line has two usable stations"),
            message("io.see-listed-rows", "See the listed rows."),
            file=source.name,
        )
    return shots.survey(source.name, journal.issues[first_issue:], journal.counts[first_count:])


def _rows(source: Source, journal: Journal) -> Rows:
    """Read the table; columns of names are found by their header alone, since numbers are names too."""
    table = read_any_table(source, journal, CENTRELINE.name)
    headers = {plain_name(header)[0]: header for header in reversed(table.header)} if table.named else {}
    words = dict(source.columns)
    for role in ("line", "station"):
        header = next((headers[word] for word in CENTRELINE.optional[role] if word in headers), None)
        if role not in words and header is not None and header not in words.values():
            words[role] = header
            journal.add(
                "note",
                source.name,
                message(
                    "io.column-taken",
                    "Column '{column}' is taken as {role}, by its name",
                    column=Untranslated(header),
                    role=role,
                ),
                message(
                    "io.state-columns-where-wrong",
                    "If this is wrong, rename the column, or state columns = {entry} in a site or mapping file.",
                    entry=f"{{ {role} = ... }}",
                ),
                column=header,
            )
    source = replace(source, columns=words, crs=source.crs or table.crs or None)
    return Rows(table, find_columns(table, CENTRELINE, source, journal), source, journal)


def _walls(rows: Rows, level: str) -> np.ndarray:
    """Return left, right, up and down (n, 4) in metres; nan where they are missing."""
    sizes = {}
    for role in _SIZES:
        value = rows.numbers(role, required=False)
        if role in rows.columns and role not in rows.factors and "z" in rows.factors:
            value = value * rows.factors["z"]
        for i in np.flatnonzero((value < 0) & rows.ok).tolist():
            rows.warn(
                i, role, message("io.size-taken-as-missing", "The {role} is below 0; it is taken as missing", role=role)
            )
        for i in np.flatnonzero((value > LONGEST) & rows.ok).tolist():
            rows.reject(
                i,
                role,
                message("io.size-too-large", "The {role} is above {longest} m", role=role, longest=int(LONGEST)),
                message("io.correct-value-or-unit", "Correct the value or the unit."),
            )
        sizes[role] = np.where(value >= 0, value, np.nan)
    # Half a width is zero nowhere: such a section has no area.
    half = np.where(sizes["width"] > 0, sizes["width"] / 2, sizes["radius"])
    up, down = sizes["radius"], sizes["radius"]
    high = sizes["height"] > 0
    up = np.where(high, sizes["height"] * (0.5 if level == "axis" else 1.0), up)
    down = np.where(high, sizes["height"] / 2 if level == "axis" else 0.0, down)
    columns = [("left", half), ("right", half), ("up", up), ("down", down)]
    return np.column_stack([np.where(np.isfinite(sizes[role]), sizes[role], other) for role, other in columns])

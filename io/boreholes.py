"""Boreholes: collars, surveys and interval logs to paths in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.logs import IntervalLog
from geofit.data.messages import Untranslated, message
from geofit.data.site import Ground, Hole, ImportIssue, TableCount
from geofit.io.axes import Region, check_axes, check_elevations
from geofit.io.collar_heights import check_heights
from geofit.io.columns import COLLAR, COLLAR_ON_GROUND, INTERVALS, plain_name
from geofit.io.desurvey import Desurvey, WellPath, desurvey
from geofit.io.digits import check_digits
from geofit.io.journal import Journal
from geofit.io.lower_limits import tops_from_above
from geofit.io.not_reached import open_bases, set_marks_aside
from geofit.io.rows import Rows, name_key, read_rows
from geofit.io.source import Source, as_source
from geofit.io.surveys import Collar, Stations, read_stations
from geofit.io.tables import first_names, parse_numbers
from geofit.io.units import METRES

__all__ = ["Boreholes", "DipSign", "IntervalLog", "load_boreholes", "read_boreholes"]

Floats = NDArray[np.float64]
Strings = NDArray[np.str_]
DipSign = Literal["down-positive", "down-negative"]

#: Depths of logs are written in centimetres: smaller differences are none, metres.
DEPTH_TOLERANCE = 0.005
#: Logs and holes are of different units where their depths have the ratio of these, but for this share.
SAME_RATIO = 0.01


@dataclass(frozen=True, eq=False)
class Boreholes:
    """Holes in space with their logs, and what was found on the way.

    ``paths`` holds the path of each hole, ``ends`` its depth in metres, ``logs`` one entry an interval table;
    ``collar`` is the name of the collar table.
    """

    holes: tuple[Hole, ...]
    paths: Mapping[str, WellPath]
    ends: Mapping[str, float]
    logs: tuple[IntervalLog, ...]
    issues: tuple[ImportIssue, ...] = ()
    counts: tuple[TableCount, ...] = ()
    inputs: Mapping[str, str] | None = None
    collar: str = ""


@arguments_checked
def read_boreholes(
    collar: str | Path | Source,
    survey: str | Path | Source | None = None,
    intervals: Sequence[str | Path | Source] = (),
    dip: DipSign | None = None,
    *,
    declination: float | None = None,
    method: Desurvey = "minimum-curvature",
) -> Boreholes:
    """Read collar, survey and interval tables.

    Parameters
    ----------
    collar : path or Source
        Columns hole, x, y, z (elevation of the mouth), optionally depth, azimuth and dip.
    survey : path or Source, optional
        Columns hole, depth, azimuth, dip. A hole without rows is vertical.
    intervals : sequence of path or Source
        Tables with hole, from, to, code.
    dip : {"down-positive", "down-negative"}, optional
        Sign of the dips; if it is not stated the majority's sign is down, with a warning.

    declination : float, optional
        Degrees to add to the azimuths, east positive; 0 where they are relative to grid north. Without it they are
        read as such, which is listed.
    method : {"minimum-curvature", "tangential"}
        Path between two stations.

    Returns
    -------
    Boreholes
        Contacts are taken from it by :func:`geofit.io.take_contacts`.

    Raises
    ------
    InputError
        If a file cannot be used at all; single rows that cannot are listed in ``issues``.

    Notes
    -----
    Formats and headers that are recognized: ``docs/formats_in.md``. Minimum curvature: Sawaryn and Thorogood (2005),
    SPE 84246.
    """
    journal = Journal()
    with journal.handed_over():
        found = load_boreholes(
            as_source(collar),
            as_source(survey) if survey is not None else None,
            [as_source(table) for table in intervals],
            dip,
            journal,
            declination=declination,
            method=method,
        )
    return Boreholes(
        found.holes,
        found.paths,
        found.ends,
        found.logs,
        tuple(journal.issues),
        tuple(journal.counts),
        dict(journal.inputs),
        found.collar,
    )


def load_boreholes(
    collar: Source,
    survey: Source | None,
    intervals: Sequence[Source],
    dip: DipSign | None,
    journal: Journal,
    region: Region | None = None,
    *,
    declination: float | None = None,
    method: Desurvey = "minimum-curvature",
    ground: Ground | None = None,
) -> Boreholes:
    """Read boreholes; the journal receives what is found."""
    collars = _read_collars(collar, dip, journal, region, declination, ground)
    stations = read_stations(survey, dip, collars, journal, declination) if survey is not None else {}
    if survey is None and not any(mouth.stations for mouth in collars.values()):
        journal.add(
            "note",
            collar.name,
            message(
                "io.holes-taken-as-vertical", "No survey: all holes ({count}) are taken as vertical", count=len(collars)
            ),
            message(
                "io.add-survey", "If some are inclined, add the survey table, or azimuth and dip to the collar table."
            ),
        )
    paths = {}
    for name, mouth in collars.items():
        surveyed = stations.get(name) or mouth.stations or Stations.vertical()
        paths[name] = desurvey(method, mouth.xyz, surveyed.depth, surveyed.azimuth, surveyed.dip)
    logs = tuple(_read_log(source, collars, paths, journal) for source in intervals)
    deepest: dict[str, float] = {}
    for log in logs:
        for name, base in zip(log.hole.tolist(), log.base.tolist(), strict=True):
            deepest[name] = max(base, deepest.get(name, 0.0))
    ends, holes = {}, []
    for name, path in paths.items():
        end = collars[name].end
        ends[name] = end if np.isfinite(end) else max(float(path.depth[-1]), deepest.get(name, 0.0))
        depth = np.union1d(path.depth[path.depth < ends[name]], [0.0, ends[name]])
        holes.append(Hole(name, "borehole", depth, path.at(depth)))
    return Boreholes(tuple(holes), paths, ends, logs, collar=collar.name)


def _read_collars(
    source: Source,
    dip: DipSign | None,
    journal: Journal,
    region: Region | None,
    declination: float | None,
    ground: Ground | None,
) -> dict[str, Collar]:
    rows = read_rows(source, COLLAR if ground is None else COLLAR_ON_GROUND, journal)
    name = rows.text("hole")
    x, y = rows.places()
    z = rows.numbers("z", required=ground is None, no_data=True)
    if ground is not None:
        _drape(rows, x, y, z, ground)
    end = rows.numbers("depth", required=False, no_data=True)
    for i in np.flatnonzero(end == 0).tolist():
        rows.warn(
            i,
            "depth",
            message("io.hole-depth-zero", "The hole's depth is 0; it is taken as not known"),
            message("io.give-hole-length", "Give the length of the hole in metres."),
        )
    end[end == 0] = np.nan
    for i in np.flatnonzero(end < 0).tolist():
        rows.reject(
            i,
            "depth",
            message("io.hole-depth-negative", "The hole's depth is negative"),
            message("io.give-hole-length", "Give the length of the hole in metres."),
        )
    check_axes(rows, x, y, region)
    check_elevations(rows, z)
    check_digits(rows, x, y, z)
    check_heights(rows, x, y, z, ground)
    first: dict[str, int] = {}
    alike: dict[tuple[str, ...], int] = {}
    places: dict[tuple[float, float, float], int] = {}
    for i in np.flatnonzero(rows.ok).tolist():
        if name[i] in first:
            k = first[name[i]]
            same = (x[i], y[i], z[i]) == (x[k], y[k], z[k])
            where = (
                message("io.at-same-location", "at the same place")
                if same
                else message("io.at-other-location", "at another place")
            )
            rows.reject(
                i,
                "hole",
                message(
                    "io.hole-repeated",
                    "The hole is listed in row {row} already, {where}",
                    row=rows.line[k],
                    where=where,
                ),
                message("io.keep-rows", "Keep one of the rows."),
            )
            continue
        first[name[i]] = i
        k = alike.setdefault(name_key(name[i]), i)
        if k != i:
            reason = message(
                "io.hole-named-alike",
                "The name differs from hole {hole} (row {row}) only in case, leading zeros, blanks, hyphens or "
                "look-alike letters",
                hole=Untranslated(name[k]),
                row=rows.line[k],
            )
            rows.warn(i, "hole", reason, message("io.remove-or-rename-hole", "If they are one hole, remove one."))
        k = places.setdefault((x[i], y[i], z[i]), i)
        if k != i:
            reason = message(
                "io.collar-repeats-hole",
                "The collar lies exactly where hole {hole} (row {row}) starts",
                hole=name[k],
                row=rows.line[k],
            )
            rows.warn(i, "hole", reason)
    attitudes = _collar_stations(rows, name, dip, declination)
    rows.close()
    for i in np.flatnonzero(~rows.ok).tolist():
        if name[i] not in first:
            journal.refused[name[i]] = (
                Untranslated(rows.file),
                message("data.place-row", "row {row}", row=int(rows.line[i])),
            )
    rows.require_any()
    return {hole: Collar((x[i], y[i], z[i]), end[i], attitudes.get(hole)) for hole, i in first.items() if rows.ok[i]}


def _drape(rows: Rows, x: Floats, y: Floats, z: Floats, ground: Ground) -> None:
    """Give the collars without an elevation that of the ground."""
    blank = np.flatnonzero(np.isnan(z) & rows.ok)
    z[blank] = ground.elevation(x[blank], y[blank])
    for i in blank.tolist():
        if np.isnan(z[i]):
            rows.reject(
                i,
                "z",
                message("io.collar-outside-ground", "The collar has no elevation and lies outside the ground's grid"),
                message("io.give-elevation", "Give its elevation."),
            )
        else:
            reason = message(
                "io.collar-elevation-from-ground",
                "The collar has no elevation; the ground's, {z:.2f} m, is used",
                z=z[i],
            )
            rows.warn(i, "z", reason, message("io.give-elevation", "Give its elevation."), severity="note")


def _collar_stations(
    rows: Rows, name: list[str], dip: DipSign | None, declination: float | None
) -> dict[str, Stations]:
    """Return the straight holes whose azimuth and dip are in the collar table."""
    if not {"azimuth", "dip"} <= set(rows.columns):
        _warn_of_half_attitude(rows)
        return {}
    return Stations.from_rows(rows, name, np.zeros(len(rows)), dip, blank_is_vertical=True, declination=declination)


def _warn_of_half_attitude(rows: Rows) -> None:
    """Warn of collars that have only one of azimuth and dip, unless it is that of vertical holes."""
    for role, missing, upright in (("azimuth", "dip", 0.0), ("dip", "azimuth", 90.0)):
        if role not in rows.columns:
            continue
        angles, _ = parse_numbers(rows.table.columns[rows.columns[role]], rows.table.decimal)
        if not (np.isfinite(angles) & (np.abs(angles) != upright)).any():
            continue
        unread = [name for j, name in enumerate(rows.table.header) if j not in rows.columns.values()]
        reason = message(
            "io.half-attitude",
            "No column is recognised as {missing}, so '{column}' is not used: holes without a survey are vertical",
            column=Untranslated(rows.table.header[rows.columns[role]]),
            missing=missing,
        )
        rows.journal.add(
            "warning",
            rows.file,
            reason,
            message(
                "io.name-column-of-angle",
                "Name its column: columns = {entry}; dips are from the horizontal. Not read: {names}.",
                entry=f"{{ {missing} = ... }}",
                names=first_names(unread) if unread else message("data.none", "none"),
            ),
            column=rows.table.header[rows.columns[role]],
        )


def _by_elevation(rows: Rows, name: Strings, top: Floats, base: Floats, mouth: Floats) -> bool:
    """Whether the limits are elevations: as stated, by their names, or because they descend from the collar."""
    if rows.source.measure is not None:
        return rows.source.measure == "elevation"
    headers = [rows.table.header[rows.columns[role]] for role in ("from", "to") if role in rows.columns]
    named = [plain_name(header)[0] for header in headers]
    sound = np.isfinite(top) & np.isfinite(base) & np.isfinite(mouth)
    falls = (top > base) & (top <= mouth + 1.0) & sound
    elevations = [any(word in name for word in ("elev", "高程", "标高")) for name in named]
    if any(elevations) and any("depth" in name or "深" in name for name in named):
        raise InputError(
            message(
                "io.limits-of-two-kinds",
                "'{top}' and '{base}' are not both depths or both elevations",
                top=headers[0],
                base=headers[1],
            ),
            message("io.state-limit-columns", "State columns = { from = ..., to = ... } that are."),
            file=rows.file,
        )
    if all(elevations):
        reason = message("io.by-column-names", "by their names")
    elif (
        sound.sum() >= 3
        and falls.sum() > 0.6 * sound.sum()
        and np.ptp(mouth[sound]) > 0
        and _begin_at_mouth(name[sound], top[sound], base[sound], mouth[sound])
    ):
        reason = message(
            "io.because-intervals-descend",
            "because {count} of {total} intervals descend from the collar's elevation",
            count=falls.sum(),
            total=sound.sum(),
        )
    else:
        return False
    rows.journal.add(
        "warning",
        rows.file,
        message("io.limits-taken-elevations", "The limits are taken as elevations, {reason}", reason=reason),
        message("io.state-measure-depth", 'If they are depths, state measure = "depth".'),
        column=headers[0],
    )
    return True


def _begin_at_mouth(name: Strings, top: Floats, base: Floats, mouth: Floats) -> bool:
    """Whether most holes begin nearer the elevation of their mouth than 0, where depths that run upwards end."""
    _, first, hole = np.unique(name, return_index=True, return_inverse=True)
    highest, lowest = np.full(len(first), -np.inf), np.full(len(first), np.inf)
    np.maximum.at(highest, hole, top)
    np.minimum.at(lowest, hole, base)
    return bool(np.median(np.abs(highest - mouth[first]) - np.abs(lowest)) < 0)


def _to_depths(rows: Rows, name: list[str], paths: Mapping[str, WellPath], limits: Floats, role: str) -> Floats:
    """Return the depths along the holes of limits that are elevations."""
    depth = np.full(len(limits), np.nan)
    groups: dict[str, list[int]] = {}
    # Rows that are not used, too: they may end the one below them.
    for i in np.flatnonzero(np.isfinite(limits)).tolist():
        if name[i] in paths:
            groups.setdefault(name[i], []).append(i)
    for hole, members in groups.items():
        path = paths[hole]
        # Collar and log are rounded apart: a limit a few centimetres above the mouth is the mouth.
        z = limits[members]
        mouth = float(path.xyz[0, 2])
        depth[members] = path.depth_of(np.where((z > mouth) & (z < mouth + 0.05), mouth, z))
    for i in np.flatnonzero(np.isnan(depth) & rows.ok).tolist():
        reason = message(
            "io.hole-without-depth", "Below its collar the hole does not reach the elevation {z:g} m", z=limits[i]
        )
        rows.reject(i, role, reason, message("io.correct-elevation", "Correct the elevation."))
    return depth


def _warn_of_feet(rows: Rows, name: Strings, base: Floats, end: Floats) -> None:
    """Warn where most logs end 3.28 times as deep as their holes, or at that part of them."""
    used = rows.ok & np.isfinite(end)
    _, first, hole = np.unique(name[used], return_index=True, return_inverse=True)
    deepest = np.zeros(len(first))
    np.maximum.at(deepest, hole, base[used])
    ratio = deepest / end[used][first]
    for factor, log, other in (
        (1.0 / METRES["ft"], "ft", "m"),
        (METRES["ft"], "m", "ft"),
    ):
        count = int((np.abs(ratio / factor - 1.0) < SAME_RATIO).sum())
        if len(ratio) >= 3 and 2 * count > len(ratio):
            rows.journal.add(
                "warning",
                rows.file,
                message(
                    "io.log-of-other-unit",
                    "In {count} of {total} holes the log is {factor:.2f} times as deep as the hole: the log may be in "
                    "{log}, the depths of the collar table in {other}",
                    count=count,
                    total=len(ratio),
                    factor=factor,
                    log=log,
                    other=other,
                ),
                message("io.mark-unit", 'Mark the columns that are in feet, as in "depth (ft)".'),
                column=rows.table.header[rows.columns["to"]],
            )


def _read_log(
    source: Source, collars: Mapping[str, Collar], paths: Mapping[str, WellPath], journal: Journal
) -> IntervalLog:
    rows = read_rows(source, INTERVALS, journal)
    code = np.array(rows.text("code"))
    marks = set_marks_aside(rows, code.tolist())
    top, base = rows.numbers("from"), rows.numbers("to")
    lower_only = "from" not in rows.columns
    name = np.array(rows.require_known("hole", rows.holes(base if lower_only else top), collars, "collar table"))
    end = np.array([collars[h].end if h in collars else np.nan for h in name])
    mouth = np.array([collars[h].xyz[2] if h in collars else np.nan for h in name])
    if _by_elevation(rows, name, top, base, mouth):
        if not lower_only:
            top = _to_depths(rows, name.tolist(), paths, top, "from")
        base = _to_depths(rows, name.tolist(), paths, base, "to")
    if lower_only:
        top = tops_from_above(rows, name.tolist(), base, collars)
    for mask, role, reason, remedy in (
        (
            (top < 0) | (base < 0),
            "from",
            message("io.interval-starts-above-collar", "The interval lies above the collar"),
            message("io.depths-positive-down", "Depths are positive and count from the collar, downwards."),
        ),
        (
            base < top,
            "to",
            message("io.interval-reversed", "The interval is reversed: it ends above its start"),
            message("io.exchange-limits", "Exchange from and to."),
        ),
        (
            base == top,
            "to",
            message("io.interval-no-length", "The interval has zero length"),
            message("io.correct-limits", "Correct from or to."),
        ),
    ):
        for i in np.flatnonzero(mask & rows.ok).tolist():
            rows.reject(i, role, reason, remedy)
    _warn_of_feet(rows, name, base, end)
    for i in np.flatnonzero((top > end - DEPTH_TOLERANCE) & rows.ok).tolist():
        reason = message(
            "io.interval-beyond-hole",
            "The interval starts at or beyond the hole's end at {end:g} m",
            end=end[i],
        )
        rows.reject(i, "from", reason, message("io.correct-depth", "Correct the depth."))
    for i in np.flatnonzero((base > end + DEPTH_TOLERANCE) & rows.ok).tolist():
        rows.warn(
            i,
            "to",
            message(
                "io.interval-cut-at-end",
                "The interval ends {length:.2f} m beyond the hole's end; it is cut there",
                length=base[i] - end[i],
            ),
            message("io.correct-depth-or-hole", "Correct the depth of the interval or of the hole."),
        )
        base[i] = end[i]
    order = np.lexsort((np.arange(len(name)), top, name))
    order = order[rows.ok[order]]
    for i, k in pairwise(order.tolist()):
        if name[i] == name[k] and top[k] < base[i] - DEPTH_TOLERANCE:
            if (top[i], base[i], code[i]) == (top[k], base[k], code[k]):
                rows.reject(
                    k,
                    "from",
                    message("io.interval-repeated", "The interval repeats row {row}", row=rows.line[i]),
                    message("io.remove-one-of-two", "Remove one of the two."),
                )
                continue
            rows.warn(
                k,
                "from",
                message(
                    "io.interval-overlaps",
                    "The interval overlaps that of row {row} by {length:.2f} m; limits inside the other "
                    "interval are not contacts",
                    row=rows.line[i],
                    length=min(base[i], base[k]) - top[k],
                ),
                message("io.correct-limits", "Correct from or to."),
            )
    rows.close()
    ended = open_bases(marks, name, top, base, rows.ok)
    order = order[rows.ok[order]]
    return IntervalLog(rows.file, name[order], top[order], base[order], code[order], rows.line[order], ended[order])

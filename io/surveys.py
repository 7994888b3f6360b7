"""Survey tables: stations of each hole, and the sign of their dips."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message, plural_message
from geofit.io.columns import SURVEY
from geofit.io.desurvey import minimum_curvature
from geofit.io.journal import Journal
from geofit.io.rows import Rows, read_rows
from geofit.io.source import Source

__all__ = ["Collar", "Stations", "read_stations"]

Floats = NDArray[np.float64]

#: A hole that turns by more between two stations has a wrong sign or a wrong row, degrees; one that turns by more than
#: the second number is doubtful.
SHARPEST_TURN, SHARP_TURN = 90.0, 30.0
#: Holes of which none is steeper, degrees: their dips may be from the vertical.
FLAT = 45.0
#: Stations are measured a little below the end of the log, metres.
BELOW_END = 0.5
#: How the header of magnetic azimuths is marked.
_MAGNETIC = re.compile("mag|磁", re.IGNORECASE)
#: The azimuth of a steeper hole does not matter, degrees.
VERTICAL = 89.99


@dataclass(frozen=True, eq=False)
class Stations:
    """Survey of one hole: depth ascending (m), azimuth and dip in degrees, dip positive downwards."""

    depth: Floats
    azimuth: Floats
    dip: Floats

    @classmethod
    def vertical(cls) -> Stations:
        """Return the survey of a hole that has none."""
        return cls(np.zeros(1), np.zeros(1), np.full(1, 90.0))

    @staticmethod
    def from_rows(
        rows: Rows,
        name: list[str],
        depth: Floats,
        sign: Literal["down-positive", "down-negative"] | None,
        *,
        blank_is_vertical: bool = False,
        declination: float | None = None,
    ) -> dict[str, Stations]:
        """Return the stations of each hole; rows that cannot be used are listed."""
        azimuth, dip = (
            rows.numbers("azimuth", required=False),
            rows.numbers("dip", required=not blank_is_vertical),
        )
        azimuth[np.isnan(azimuth) & (np.abs(dip) == 90.0)] = 0.0
        for i in np.flatnonzero((np.isnan(azimuth) & np.isfinite(dip)) & rows.ok).tolist():
            rows.reject(
                i,
                "azimuth",
                message("io.azimuth-empty", "The azimuth of an inclined hole is empty"),
                message("io.complete-the-cell", "Complete the cell."),
            )
        for i in np.flatnonzero((np.abs(dip) > 90.0) & rows.ok).tolist():
            rows.reject(
                i,
                "dip",
                message("io.station-dip-out-of-range", "The dip is not between -90 and 90 degrees"),
                message("io.give-angle-from-horizontal", "Give the angle from horizontal."),
            )
        beyond = np.flatnonzero((azimuth > 360.0) & rows.ok)
        if len(beyond) > 1 and azimuth[beyond].max() <= 400.0:
            rows.warn(
                int(beyond[0]),
                "azimuth",
                message(
                    "io.azimuths-like-gon",
                    "{count} azimuths lie between 360 and 400, none beyond: they may be in gon, and all are read as "
                    "degrees",
                    count=len(beyond),
                ),
                message("io.mark-gon", "If they are in gon, state it in the header, as in 'azimuth (gon)'."),
            )
        for i in np.flatnonzero((np.abs(azimuth) > 360.0) & rows.ok).tolist():
            rows.reject(
                i,
                "azimuth",
                message("io.azimuth-out-of-range", "The azimuth is not between 0 and 360 degrees"),
                message("io.give-azimuth", "Give degrees from north."),
            )
        azimuth = azimuth + (declination or 0.0)
        dip = _downwards(rows, dip, sign)
        _warn_of_flat(rows, name, dip)
        chosen = rows.ok & np.isfinite(dip)
        result: dict[str, Stations] = {}
        order = np.lexsort((np.arange(len(name)), depth, np.array(name)))
        order = order[chosen[order]]
        for group in np.split(order, np.flatnonzero(np.array(name)[order][1:] != np.array(name)[order][:-1]) + 1):
            kept = _sound(rows, group, depth, azimuth, dip)
            if kept.size:
                result[name[kept[0]]] = Stations(depth[kept], azimuth[kept], dip[kept])
        if declination is None and any(np.abs(station.dip).min() < VERTICAL for station in result.values()):
            _tell_north(rows)
        return result


@dataclass(frozen=True)
class Collar:
    """The mouth of a hole, its end (depth in metres, nan where that is not known), its attitude where that is known."""

    xyz: tuple[float, float, float]
    end: float
    stations: Stations | None


def read_stations(
    source: Source,
    sign: Literal["down-positive", "down-negative"] | None,
    collars: Mapping[str, Collar],
    journal: Journal,
    declination: float | None = None,
) -> dict[str, Stations]:
    """Read a survey table; stations of unknown holes, repeated and impossible ones are listed.

    ``declination`` (degrees, east positive) is added to the azimuths; without one they are read as grid azimuths, with
    a warning if their header states that they are magnetic.

    The attitude of the collar table is the station at 0 where the survey has none. Without one, a hole goes straight to
    its first station, and a hole with one station is straight: each is listed as a warning, vertical ones in one note.
    """
    rows = read_rows(source, SURVEY, journal)
    depth = rows.numbers("depth")
    name = rows.holes(depth)
    name = rows.require_known("hole", name, collars, "collar table")
    for i in np.flatnonzero((depth < 0) & rows.ok).tolist():
        rows.reject(
            i,
            "depth",
            message("io.station-above-collar", "The station lies above the collar"),
            message("io.depths-positive-down", "Depths are positive and count from the collar, downwards."),
        )
    stations = Stations.from_rows(rows, name, depth, sign, declination=declination)
    _start_at_collar(rows, stations, collars)
    _warn_beyond_end(rows, name, depth, collars)
    first: dict[str, int] = {}
    for i in np.flatnonzero(rows.ok).tolist():
        if name[i] not in first or depth[i] < depth[first[name[i]]]:
            first[name[i]] = i
    upright: list[str] = []
    for hole, i in first.items():
        if stations[hole].depth[0] > 0:
            rows.warn(
                i,
                "depth",
                message(
                    "io.hole-without-first-station",
                    "Hole {hole} has no station at depth 0; it is straight from the collar to its first station",
                    hole=hole,
                ),
                message("io.add-attitude-collar", "Add the attitude at the collar."),
            )
        if len(stations[hole].depth) == 1 and stations[hole].dip[0] > VERTICAL:
            upright.append(hole)
        elif len(stations[hole].depth) == 1:
            rows.warn(
                i,
                "depth",
                message("io.hole-of-one-station", "Hole {hole} has one station only; it is straight", hole=hole),
                message("io.add-known-stations", "Add its other stations, if there are any."),
            )
    if upright:
        journal.add(
            "note",
            rows.file,
            message(
                "io.holes-of-one-vertical-station",
                "Holes with one station only, which is vertical: {count}: {names}",
                count=len(upright),
                names=", ".join(upright),
            ),
            message("io.add-known-stations", "Add its other stations, if there are any."),
        )
    given = Counter(name)
    for hole, mouth in collars.items():
        if hole in stations or mouth.stations is not None:
            continue
        reason = message("io.hole-taken-as-vertical", "Hole {hole} has no survey; it is taken as vertical", hole=hole)
        remedy = message("io.add-stations-of-inclined", "If it is inclined, add its stations.")
        if given[hole]:
            reason = plural_message(
                "io.hole-of-refused-stations",
                "Hole {hole}: its {count} station cannot be used; the hole is taken as vertical, and its contacts may "
                "be misplaced",
                "Hole {hole}: none of its {count} stations can be used; the hole is taken as vertical, and its "
                "contacts may be misplaced",
                hole=hole,
                count=given[hole],
            )
            remedy = message("io.correct-its-stations", "Correct its stations.")
        journal.add("warning", rows.file, reason, remedy, value=hole)
    rows.close()
    return stations


def _tell_north(rows: Rows) -> None:
    """List that azimuths without a declination are taken from grid north: a warning where they are magnetic."""
    header = rows.table.header[rows.columns["azimuth"]]
    remedy = message("io.state-declination", "If they are magnetic, state declination = ... (degrees, east positive).")
    if _MAGNETIC.search(header):
        reason = message(
            "io.azimuths-magnetic",
            "The azimuths are magnetic, but no declination is stated: they are read as grid azimuths",
        )
        remedy = message(
            "io.state-declination-or-zero",
            "State declination = ... (degrees, east positive) in [boreholes] of a site file; 0 if they are corrected.",
        )
        rows.journal.add("warning", rows.file, reason, remedy, column=header)
        return
    reason = message("io.azimuths-from-grid-north", "The azimuths are taken as relative to grid north")
    rows.journal.add("note", rows.file, reason, remedy, column=header)


def _start_at_collar(rows: Rows, stations: dict[str, Stations], collars: Mapping[str, Collar]) -> None:
    """Begin holes without a station at depth 0 with the attitude of the collar table, if the two agree roughly."""
    begun = 0
    for hole, own in stations.items():
        mouth = collars[hole].stations
        if mouth is None or own.depth[0] <= 0:
            continue
        together = Stations(np.r_[0.0, own.depth], np.r_[mouth.azimuth[:1], own.azimuth], np.r_[mouth.dip[:1], own.dip])
        if _turn(together.azimuth[:2], together.dip[:2]) <= SHARPEST_TURN:
            stations[hole], begun = together, begun + 1
    if begun:
        rows.journal.add(
            "note",
            rows.file,
            message(
                "io.attitudes-from-collars",
                "Holes without a station at depth 0 begin with the azimuth and dip of the collar table: {count}",
                count=begun,
            ),
        )


def _warn_beyond_end(rows: Rows, name: list[str], depth: Floats, collars: Mapping[str, Collar]) -> None:
    """Warn of the first station of each hole that lies below its end: one of the two is wrong."""
    warned: set[str] = set()
    for i in np.flatnonzero(rows.ok).tolist():
        end = collars[name[i]].end
        if depth[i] > end + BELOW_END and name[i] not in warned:
            warned.add(name[i])
            rows.warn(
                i,
                "depth",
                message(
                    "io.station-beyond-hole",
                    "The station lies {distance:.1f} m below the end of hole {hole} at {end:g} m",
                    distance=depth[i] - end,
                    hole=name[i],
                    end=end,
                ),
                message(
                    "io.correct-station-or-hole",
                    "Correct the depth of the station or of the hole; check that both have the same unit.",
                ),
            )


def _turn(azimuth: Floats, dip: Floats) -> float:
    """Return the angle between two attitudes, degrees."""
    tangent = minimum_curvature(np.zeros(3), np.array([0.0, 1.0]), azimuth, dip).tangent
    return float(np.degrees(np.arccos(np.clip(tangent[0] @ tangent[1], -1.0, 1.0))))


def _downwards(rows: Rows, dip: Floats, sign: Literal["down-positive", "down-negative"] | None) -> Floats:
    """Return the dips positive downwards; where no sign is stated the majority decides, and is listed."""
    used = rows.ok & np.isfinite(dip)
    negative, positive = int((dip[used] < 0).sum()), int((dip[used] > 0).sum())
    if sign is None and negative == positive > 0:
        raise InputError(
            message(
                "io.dip-sign-unclear",
                "{positive} dips are positive and {negative} negative: the sign that points down is not clear",
                positive=positive,
                negative=negative,
            ),
            message("io.state-dip-sign", 'State dip = "down-positive" or dip = "down-negative".'),
            file=rows.file,
            column=rows.table.header[rows.columns["dip"]],
        )
    down = sign or ("down-negative" if negative > positive else "down-positive")
    if sign is None and negative + positive:
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.dip-sign-taken",
                "The sign of the dips is not stated: {negative} are negative, {positive} positive; taken as {down} by "
                "majority",
                negative=negative,
                positive=positive,
                down=down,
            ),
            message("io.state-dip-sign", 'State dip = "down-positive" or dip = "down-negative".'),
            column=rows.table.header[rows.columns["dip"]],
        )
        for i in np.flatnonzero(used & ((dip > 0) if down == "down-negative" else (dip < 0))).tolist():
            rows.warn(
                i,
                "dip",
                message("io.hole-points-up", "By the sign of most dips, the hole points upwards here"),
                message("io.check-sign", "Check the sign."),
            )
    return -dip if down == "down-negative" else dip


def _warn_of_flat(rows: Rows, name: list[str], dip: Floats) -> None:
    """Warn of dips that are all flat: in some tables 0 is the vertical."""
    used = np.flatnonzero(rows.ok & np.isfinite(dip))
    if len({name[i] for i in used.tolist()}) < 3 or np.abs(dip[used]).max() > FLAT:
        return
    rows.journal.add(
        "warning",
        rows.file,
        message(
            "io.dips-like-from-vertical",
            "No dip is steeper than {steepest:g} degrees from the horizontal: the angles may be from the vertical",
            steepest=float(np.abs(dip[used]).max()),
        ),
        message("io.give-angle-from-horizontal", "Give the angle from horizontal."),
        column=rows.table.header[rows.columns["dip"]],
    )


def _sound(rows: Rows, group: NDArray[np.int64], depth: Floats, azimuth: Floats, dip: Floats) -> NDArray[np.int64]:
    """Return the stations of one hole without repeated depths and impossible turns, which are listed."""
    kept: list[int] = []
    for i in map(int, group):
        if kept and depth[i] == depth[kept[-1]]:
            rows.reject(
                i,
                "depth",
                message(
                    "io.station-depth-repeated",
                    "The station repeats the depth of row {row}",
                    row=rows.line[kept[-1]],
                ),
                message("io.keep-rows", "Keep one of the rows."),
            )
            continue
        if kept:
            pair = [kept[-1], i]
            turn = _turn(azimuth[pair], dip[pair])
            if turn > SHARP_TURN:
                reason = message(
                    "io.hole-turns-sharply",
                    "The hole turns by {turn:.0f} degrees since row {row}",
                    turn=turn,
                    row=rows.line[kept[-1]],
                )
                remedy = message("io.check-dip-and-azimuth", "Check the sign of the dip and the azimuth.")
                if turn > SHARPEST_TURN:
                    rows.reject(i, "dip", reason, remedy)
                    continue
                rows.warn(i, "dip", reason, remedy)
        kept.append(i)
    return np.array(kept, dtype=np.int64)

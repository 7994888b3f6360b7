"""Compass cave surveys (.dat): shots with left, up, down and right.

The file is stored in fixed units whatever its FORMAT says: decimal feet and degrees, walls in the order left, up, down,
right. FORMAT matters for two things: whether redundant backsights follow the walls, and whether the walls belong to the
first or the second station of a shot. (Fountain Computer Products, "Survey data format".)
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path

import numpy as np

from geofit.caves.shots import ShotList, polar, require_length
from geofit.caves.survey import Survey
from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message, plural_message
from geofit.io.journal import Journal
from geofit.io.source import Source, as_source
from geofit.io.splays import use_splays
from geofit.io.units import METRES

__all__ = ["read_compass"]

FEET = METRES["ft"]
#: Readings from here on, either sign, are marks for "not measured"; so are walls below 0.
_MISSING = 990.0
#: A backsight may differ from its foresight by this much before it is listed, degrees.
_BACKSIGHT = 5.0
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)")


@dataclass(frozen=True)
class _Header:
    """What the head of one survey says about its shots; ``unread``: its corrections that cannot be read."""

    declination: float = 0.0
    corrections: tuple[float, ...] = (0.0, 0.0, 0.0)
    backsight_corrections: tuple[float, ...] = (0.0, 0.0)
    backsights: bool = False
    walls_at_end: bool = False
    row: int = 0
    line: str = ""
    unread: tuple[str, ...] = ()


@arguments_checked
def read_compass(source: Source | str | Path, journal: Journal | None = None) -> Survey:
    """Read a Compass survey file.

    Parameters
    ----------
    source : Source, str or Path
        The file.
    journal : Journal, optional
        Receives the rows that are not used and what was assumed; the survey holds them too.

    Returns
    -------
    Survey
        In metres. No station is fixed: coordinates are in the project file (.mak), not in this one. A wall of 0 is a
        station at the wall; four walls of 0 were not measured.

    Raises
    ------
    InputError
        If the file is missing, or has no survey.

    Notes
    -----
    Columns and flags that are read: ``docs/formats_in.md``.
    """
    source, journal = as_source(source), journal if journal is not None else Journal()
    first_issue, first_count = len(journal.issues), len(journal.counts)
    text = journal.read(source).decode(source.encoding or "cp1252", errors="replace")
    # Ctrl-Z ends the file for the programs that write it.
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\x1a")[0].split("\n")
    shots = ShotList()
    header, in_shots, read, used, surveys, untouched = _Header(), False, 0, 0, 0, 0
    uncorrected: dict[_Header, int] = {}
    for row, line in enumerate(lines, 1):
        if "\f" in line:
            in_shots, header, line = False, _Header(), line.split("\f")[-1]
        if not line.strip():
            continue
        if line.lstrip().startswith("DECLINATION:"):
            header = _header(line.strip(), row)
        elif re.match(r"\s*FROM\s+TO\s+LEN", line):
            in_shots, surveys = True, surveys + 1
            if not header.row:
                header = replace(header, row=row, line=line.strip(), unread=("DECLINATION",))
        elif in_shots:
            read += 1
            found = _shot(line, row, header, shots, source.name, journal)
            used += found > 0
            if found and header.unread:
                uncorrected[header] = uncorrected.get(header, 0) + 1
            untouched += found == 2
    if not surveys:
        raise InputError(
            message("io.compass-heading-missing", "The file has no line FROM TO LENGTH: it is not a Compass survey"),
            message(
                "io.give-compass-file",
                "Give a .dat file of Compass; other surveys are read from .svx or from a table.",
            ),
            file=source.name,
        )
    if untouched:
        journal.add(
            "note",
            source.name,
            message(
                "io.walls-not-measured",
                "Shots with four walls of 0, which are taken as not measured: {count}",
                count=untouched,
            ),
            message("io.walls-interpolated", "They are interpolated along the passage."),
        )
    for header, count in uncorrected.items():
        reason = plural_message(
            "io.shots-uncorrected",
            "{count} shot is used without the correction by {word}: its {what} are as measured",
            "{count} shots are used without the correction by {word}: their {what} are as measured",
            count=count,
            word=Untranslated(", ".join(header.unread)),
            what=message("io.directions", "directions")
            if header.unread == ("DECLINATION",)
            else message("io.lengths-and-directions", "lengths and directions"),
        ).with_severity("warning")
        remedy = message(
            "io.correct-compass-header", "Correct the line DECLINATION of the survey, with decimal points."
        )
        journal.add("warning", source.name, reason, remedy, row=header.row, value=header.line[:120])
    use_splays(shots, source.name, journal)
    journal.count(source.name, read, read - used)
    with journal.handed_over():
        return shots.survey(source.name, journal.issues[first_issue:], journal.counts[first_count:])


def _header(line: str, row: int) -> _Header:
    unread: list[str] = []

    def numbers(word: str, count: int) -> tuple[float, ...]:
        _, stated, rest = line.partition(f"{word}:")
        cells = rest.split()
        values = [float(cell) for cell in takewhile(_NUMBER.fullmatch, cells)][:count]
        after = "".join(cells[len(values) : len(values) + 1])
        # A number with a decimal comma is none: what is before the comma would be taken for all of it.
        if stated and (not values or (len(values) < count and re.match(r"[-+.\d]", after))):
            unread.append(word)
            values = []
        return tuple(values + [0.0] * (count - len(values)))

    form = re.search(r"FORMAT:\s*(\w+)", line)
    letters = form.group(1) if form else ""
    # 11 letters; then whether there are backsights; then at which station the walls are; 15 with their order.
    tail = letters[13:] if len(letters) >= 15 else letters[11:]
    return _Header(
        numbers("DECLINATION", 1)[0],
        numbers("CORRECTIONS", 3),
        numbers("CORRECTIONS2", 2),
        tail[:1] == "B",
        tail[1:2] == "T",
        row,
        line,
        tuple(unread),
    )


def _shot(line: str, row: int, header: _Header, shots: ShotList, file: str, journal: Journal) -> int:
    """Add the shot of a line: 0 if it is not used, 2 if its walls are all 0, else 1."""
    flags = re.search(r"#\|([A-Za-z ]*)#", line)
    cells = (line[: flags.start()] if flags else line).split()
    needed = 11 if header.backsights else 9
    try:
        start, end = cells[:2]
        values = [float(cell) for cell in cells[2:needed]]
        if len(values) < needed - 2 or not np.isfinite(values).all():
            raise ValueError
    except ValueError:
        journal.add(
            "error",
            file,
            message(
                "io.line-not-a-shot",
                "The line is not a shot: two stations and {count} numbers are needed",
                count=needed - 2,
            ),
            message("io.correct-line-in-editor", "Correct the line in the survey editor."),
            row=row,
            value=line.strip()[:120],
        )
        return 0
    marks = flags.group(1).upper() if flags else ""
    if "X" in marks:
        journal.add(
            "note",
            file,
            message("io.shot-excluded", "The shot is flagged X: excluded from all processing"),
            row=row,
            value=f"{start} {end}",
        )
        return 0
    length, bearing, inclination = values[0], values[1], values[2]
    back = values[7:9] if header.backsights else [-999.0, -999.0]
    bearing = _angle(bearing, back[0], header.corrections[0], header.backsight_corrections[0], True, row, file, journal)
    inclination = _angle(
        inclination, back[1], header.corrections[1], header.backsight_corrections[1], False, row, file, journal
    )
    if any(abs(sight) < _MISSING and not 0 <= sight <= 360 for sight in (values[1], back[0])):
        journal.add(
            "warning",
            file,
            message("io.bearing-out-of-range", "The {reading} is not between 0 and 360 degrees", reading="compass"),
            message("io.check-reading", "Check the reading."),
            row=row,
            value=f"{start} {end}",
        )
    if np.isnan(bearing) and abs(inclination) > 89.9:
        bearing = 0.0
    if length < 0 or np.isnan(bearing) or np.isnan(inclination) or abs(inclination) > 90.0:
        journal.add(
            "error",
            file,
            message("io.shot-without-readings", "The shot has no usable length, bearing and inclination"),
            message("io.complete-readings", "Complete its readings."),
            row=row,
            value=f"{start} {end}",
        )
        return 0
    left, up, down, right = (np.nan if v < 0 or v >= _MISSING else v * FEET for v in values[3:7])
    walls = [left, right, up, down]
    untouched = walls == [0.0] * 4
    if untouched:
        walls = [np.nan] * 4
    # A line of length 0 from a station to itself carries the walls of the last station.
    repeated = start == end
    if repeated and length > 0:
        journal.add(
            "error",
            file,
            message(
                "io.shot-to-itself",
                "The shot leads from station {station} to itself",
                station=Untranslated(start),
            ),
            message("io.correct-name", "Correct one of the names."),
            row=row,
            value=f"{start} {end}",
        )
        return 0
    offset = polar((length + header.corrections[2]) * FEET, bearing + header.declination, inclination)
    try:
        require_length(offset)
    except InputError as bad:
        journal.add("error", file, bad.reason, bad.remedy, row=row, value=f"{start} {end}")
        return 0
    shot = -1
    if not repeated:
        shot = shots.add(
            start,
            end,
            offset,
            row,
            counted="L" not in marks,
            passage="P" not in marks and "S" not in marks,
            rigid="C" in marks,
            splay="S" in marks,
        )
    else:
        place = shots.station(start)
        shot = next((n for n in reversed(range(len(shots.shots))) if place in shots.shots[n][:2]), -1)
    shots.add_walls(end if header.walls_at_end else start, shot, walls)
    return 2 if untouched else 1


def _angle(
    fore: float,
    back: float,
    correct: float,
    correct_back: float,
    circular: bool,
    row: int,
    file: str,
    journal: Journal,
) -> float:
    """Return the mean of foresight and backsight, corrected; nan if both are missing."""
    fore = fore + correct if abs(fore) < _MISSING else np.nan
    back = back + correct_back if abs(back) < _MISSING else np.nan
    back = (back + 180.0 if circular else -back) if back == back else np.nan
    if fore != fore or back != back:
        return fore if fore == fore else back
    difference = (back - fore + 180.0) % 360.0 - 180.0 if circular else back - fore
    if abs(difference) > _BACKSIGHT:
        journal.add(
            "warning",
            file,
            message(
                "io.sights-differ",
                "Foresight and backsight differ by {angle:.1f} degrees; their mean is used",
                angle=abs(difference),
            ),
            message("io.check-readings", "Check both readings."),
            row=row,
        )
    return fore + difference / 2

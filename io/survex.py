"""Survex cave surveys (.svx): the commands that surveys of passages use; all others are listed.

Read are begin, end, include, data normal and data passage (one line a shot or station), data ignore, calibrate, units,
declination with a value, equate, fix, flags, infer and case. Commands that do not change geometry are counted in one
note. (Survex manual, "Survex data files".)
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from geofit.caves.shots import ShotList, polar, require_length, require_walls
from geofit.caves.survey import Survey
from geofit.data.errors import InputError
from geofit.data.files import is_file
from geofit.data.given import arguments_checked
from geofit.data.messages import EMPTY, Message, Untranslated, message, plural_message
from geofit.data.site import ImportIssue
from geofit.io.journal import Journal, Severity
from geofit.io.sniff import decode
from geofit.io.source import Source, as_source
from geofit.io.splays import use_splays
from geofit.io.survex_settings import CORRECTIONS, QUANTITIES, Settings, Unread, corrected_by, finite

__all__ = ["read_survex"]

#: Commands that name people, dates and places.
_REMARKS = frozenset(["copyright", "date", "entrance", "export", "instrument", "ref", "require", "sd", "team", "title"])
_PLUMBS = {"u": 90.0, "up": 90.0, "+v": 90.0, "d": -90.0, "down": -90.0, "-v": -90.0, "h": 0.0, "level": 0.0}
_DEEPEST = 32
#: Ends of a splay: a wall, and a point inside the passage.
_WALL, _POINT = "wall", "point"


class _Reader:
    """Everything that lasts from the first line to the last, over included files."""

    def __init__(self, source: Source, journal: Journal) -> None:
        self.source, self.journal = source, journal
        self.shots: list[tuple[str, str, np.ndarray, int, bool, bool, str]] = []
        self.tubes: list[list[tuple[str, tuple[float, ...]]]] = [[]]
        self.same: dict[str, str] = {}
        self.fixed: list[tuple[str, tuple[float, float, float], int]] = []
        self.read = self.used = self.anonymous = 0
        self.bearings, self.declined = 0, False
        self.remarks: dict[str, int] = {}
        self.uncorrected: dict[Unread, int] = {}

    def list_(self, severity: Severity, reason: Message, remedy: Message, file: str, row: int, value: str) -> None:
        self.journal.add(severity, file, reason, remedy, row=row, value=value)

    def root(self, name: str) -> str:
        """Return the station that a name is equated to."""
        while name in self.same:
            name = self.same[name]
        return name

    def file(self, source: Source, settings: Settings, depth: int = 0) -> None:
        """Read one file and those that it includes."""
        text, _ = decode(self.journal.read(source), source.name, source.encoding)
        stack: list[tuple[str, Settings]] = []
        for row, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
            cells = line.split(";")[0].replace(",", " ").split()
            if not cells:
                continue
            if not cells[0].startswith("*"):
                self.data(cells, settings, source.name, row)
                continue
            word = (cells[0][1:] or (cells[1] if len(cells) > 1 else "")).casefold()
            rest = cells[1:] if cells[0] != "*" else cells[2:]
            if word == "begin":
                name = settings.cased(rest[0]) if rest else ""
                stack.append((name, settings))
                settings = replace(settings, prefix=(*settings.prefix, name) if name else settings.prefix)
            elif word == "end":
                if not stack:
                    raise InputError(
                        message("io.end-without-begin", "*end without *begin"),
                        message("io.remove-end-or-add-begin", "Remove it, or add *begin."),
                        file=source.name,
                        row=row,
                        value=line.strip(),
                    )
                begun, before = stack.pop()
                if rest and settings.cased(rest[0]) != begun:
                    raise InputError(
                        message(
                            "io.end-of-other-block",
                            "*end closes the block '{name}', but '{begun}' is open",
                            name=Untranslated(rest[0]),
                            begun=Untranslated(begun),
                        ),
                        message("io.correct-end-name", "Correct the name, or add the missing *begin or *end."),
                        file=source.name,
                        row=row,
                        value=line.strip(),
                    )
                settings = before
            elif word == "include":
                self.include(line, source, settings, depth, row)
            else:
                settings = self.command(word, rest, settings, source.name, row, line.strip())
        if stack:
            raise InputError(
                message("io.begin-not-closed", "*begin {name} is not closed", name=Untranslated(stack[-1][0])),
                message("io.add-end", "Add *end: lines may be missing from the file."),
                file=source.name,
            )

    def include(self, line: str, source: Source, settings: Settings, depth: int, row: int) -> None:
        name = line.split(";")[0].split(None, 1)[1].strip().strip('"').replace("\\", "/")
        path = source.path.parent / name
        if not path.exists() and path.with_name(path.name + ".svx").exists():
            path = path.with_name(path.name + ".svx")
        # A survey from a stranger reads nothing outside its folder.
        beside = path.resolve().is_relative_to(self.source.path.parent.resolve())
        if depth >= _DEEPEST or not beside or not is_file(path):
            raise InputError(
                message("io.include-unreadable", "The included file {name} cannot be read", name=Untranslated(name)),
                message(
                    "io.put-include-into-folder",
                    "Put it into the folder of the file that includes it; files must not include each other.",
                ),
                file=source.name,
                row=row,
            )
        self.file(replace(source, path=path, name=path.name), settings, depth + 1)

    def command(self, word: str, rest: list[str], settings: Settings, file: str, row: int, line: str) -> Settings:
        """Return the settings after a command."""
        try:
            match word:
                case "data":
                    style = rest[0].casefold() if rest else settings.style
                    if style == "passage" or not rest:
                        self.tubes.append([])
                    changed = settings.with_data([cell.casefold() for cell in rest])
                    if changed.style not in ("normal", "passage", "ignore"):
                        self.list_(
                            "error",
                            message(
                                "io.data-style-unknown",
                                "Data of this style are not read: {style}",
                                style=Untranslated(" ".join(rest)),
                            ),
                            message(
                                "io.write-data-normal",
                                "Write one line a shot with *data normal from to tape compass clino.",
                            ),
                            file,
                            row,
                            line,
                        )
                    return changed
                case "units":
                    return settings.with_units(rest)
                case "calibrate" | "declination":
                    self.declined = self.declined or "declination" in line.casefold()
                    if re.search(r"\d,\d", line):  # a decimal comma would make the decimals a scale
                        raise ValueError(line)
                    return settings.with_correction(word, rest)
                case "infer":
                    return settings.with_inference(rest[0].casefold(), rest[1].casefold() == "on")
                case "flags":
                    return settings.with_flags([cell.casefold() for cell in rest])
                case "alias" if [cell.casefold() for cell in rest] == ["station", "-", ".."]:
                    return settings
                case "case":
                    return replace(settings, case=rest[0].casefold())
                case "equate":
                    first, *others = (settings.full(name) for name in rest)
                    for other in others:
                        if self.root(other) != self.root(first):
                            self.same[self.root(other)] = self.root(first)
                    return settings
                case "fix":
                    numbers = [cell for cell in rest[1:] if cell.casefold() != "reference"]
                    x, y, z = (finite(cell) for cell in numbers[:3]) if numbers else (0.0, 0.0, 0.0)
                    self.fixed.append((settings.full(rest[0]), (x, y, z), row))
                    return settings
                case _ if word in _REMARKS:
                    self.remarks[word] = self.remarks.get(word, 0) + 1
                    return settings
        except (ValueError, IndexError, KeyError):
            self.list_(
                "error",
                message("io.command-unreadable", "The command *{word} cannot be read", word=Untranslated(word)),
                CORRECTIONS.get(word, message("io.correct-arguments", "Correct its arguments.")),
                file,
                row,
                line,
            )
            if word in CORRECTIONS:
                return settings.without_correction(Unread(word, corrected_by(word, rest), file, row, line))
            # What is in an unknown unit must not count as metres or degrees.
            return settings.without_units(rest) if word == "units" else settings
        self.list_(
            "warning",
            message("io.command-not-read", "The command *{word} is not read", word=Untranslated(word)),
            message("io.check-shots", "Check that it does not change the shots."),
            file,
            row,
            line,
        )
        return settings

    def data(self, cells: list[str], settings: Settings, file: str, row: int) -> None:
        """Read one line of data."""
        self.read += 1
        if settings.style == "ignore":
            self.list_(
                "note",
                message("io.data-ignored", "The line is in a block of data that is ignored"),
                EMPTY,
                file,
                row,
                " ".join(cells),
            )
            return
        order = settings.order
        if settings.style in ("normal", "passage"):
            try:
                readings = dict(zip(order, cells, strict=False))
                needed = len([name for name in order if name != "ignoreall"])
                # A decimal comma makes two cells of one: Survex takes it for a blank.
                if len(cells) < needed or (len(cells) > needed and "ignoreall" not in order):
                    raise ValueError
                if settings.style == "normal":
                    self.shot(readings, settings, row)
                    self.suspicious(readings, settings, file, row, " ".join(cells))
                else:
                    walls = tuple(settings.reading(name, readings.get(name, "-")) for name in QUANTITIES["walls"])
                    require_walls(walls)
                    self.tubes[-1].append((settings.full(readings["station"]), walls))
                self.used += 1
                return
            except InputError as bad:
                self.list_("error", bad.reason, bad.remedy, file, row, " ".join(cells))
                return
            except (ValueError, KeyError):
                pass
        self.list_(
            "error",
            message(
                "io.line-out-of-order",
                "The line is not data in the order {order}",
                order=Untranslated(" ".join(order) or settings.style),
            ),
            message("io.correct-line-or-data", "Correct the line or the *data command."),
            file,
            row,
            " ".join(cells),
        )

    def suspicious(self, readings: dict[str, str], settings: Settings, file: str, row: int, line: str) -> None:
        """Warn of readings that no instrument shows; they are used, as Survex does."""
        # Zero errors come later: a small bearing may well be below 0 after them.
        shown = replace(settings, calibration={})
        found = []
        for name in ("tape", "backtape"):
            if shown.reading(name, readings.get(name, "-")) < 0:
                found.append(message("io.tape-below-zero", "The {reading} is below 0: the shot is reversed",
                                     reading=name))  # fmt: skip
        for name in ("compass", "backcompass"):
            value = shown.reading(name, readings.get(name, "-"))
            if value < 0 or value > 360.0 + 1e-6:
                found.append(message("io.bearing-out-of-range", "The {reading} is not between 0 and 360 degrees",
                                     reading=name))  # fmt: skip
        for reason in found:
            self.list_("warning", reason, message("io.check-reading", "Check the reading."), file, row, line)

    def shot(self, readings: dict[str, str], settings: Settings, row: int) -> None:
        names = []
        # What a splay leads to: Survex takes "." for a point inside the passage, and "..." for an ordinary station.
        splay = _WALL if settings.splay else ""
        for role in ("from", "to"):
            if set(readings[role]) <= {".", "-"}:
                self.anonymous += 1
                names.append(f"({self.anonymous})")
                splay = {"...": splay, ".": _POINT}.get(readings[role], _WALL)
            else:
                names.append(settings.full(readings[role]))
        tape, back_tape = (settings.reading(name, readings.get(name, "-")) for name in ("tape", "backtape"))
        tape = float(np.nanmean([tape, back_tape]))
        if tape == 0.0 and settings.infer_equates:
            if self.root(names[1]) != self.root(names[0]):
                self.same[self.root(names[1])] = self.root(names[0])
            return
        plumb = _PLUMBS.get(readings.get("clino", "").casefold())
        clino = plumb if plumb is not None else settings.reading("clino", readings.get("clino", "-"))
        if plumb is None and settings.infer_plumbs and readings.get("clino", "").lstrip("+-") in ("90", "90.0"):
            clino = float(readings["clino"])
        back = settings.reading("backclino", readings.get("backclino", "-"))
        clino = float(np.nanmean([clino, -back])) if clino == clino or back == back else 0.0
        compass = settings.reading("compass", readings.get("compass", "-"))
        back = settings.reading("backcompass", readings.get("backcompass", "-")) + 180.0
        if compass == compass and back == back:
            compass += ((back - compass + 180.0) % 360.0 - 180.0) / 2
        compass = compass if compass == compass else back
        if compass != compass and abs(clino) == 90.0:
            compass = 0.0
        if tape != tape or compass != compass or abs(clino) > 90.0:
            raise InputError(
                message("io.shot-without-readings", "The shot has no usable length, bearing and inclination"),
                message("io.complete-readings", "Complete its readings."),
            )
        offset = polar(tape, compass + settings.declination, clino)
        require_length(offset)
        counted = not (splay or settings.duplicate or settings.surface)
        passage = not (splay or settings.surface)
        self.shots.append((names[0], names[1], offset, row, counted, passage, "" if settings.surface else splay))
        self.bearings += abs(clino) < 90.0
        for unread in settings.unread:
            self.uncorrected[unread] = self.uncorrected.get(unread, 0) + 1

    def warn_uncorrected(self) -> None:
        """Warn of shots that are used as they were read: a correction could not be read, or none is stated on a map."""
        # Only a survey with a place on the map has a grid north from which its bearings differ.
        if self.bearings and not self.declined and any(xyz[0] or xyz[1] for _, xyz, _ in self.fixed):
            self.uncorrected[Unread("declination", corrected_by("declination", ()), self.source.name)] = self.bearings
        for unread, count in self.uncorrected.items():
            reason = plural_message(
                "io.shots-uncorrected",
                "{count} shot is used without the correction by {word}: its {what} are as measured",
                "{count} shots are used without the correction by {word}: their {what} are as measured",
                count=count,
                word=Untranslated(f"*{unread.word}"),
                what=unread.corrected,
            ).with_severity("warning")
            self.list_("warning", reason, CORRECTIONS[unread.word], unread.file, unread.row, unread.line)

    def survey(self, issues: Sequence[ImportIssue]) -> Survey:
        """Return what was read, equated stations under one name; ``issues`` may be why there is nothing."""
        found = ShotList()
        between: dict[tuple[str, str], int] = {}
        # Where no splay is marked as one to a wall, all of them lead there.
        to_wall = {_WALL} if any(shot[6] == _WALL for shot in self.shots) else {_POINT}
        for start, end, offset, row, counted, passage, splay in self.shots:
            a, b = self.root(start), self.root(end)
            if a == b:
                self.list_(
                    "error",
                    message("io.shot-joins-itself", "The shot joins two names of one station"),
                    message("io.check-equate", "Check *equate."),
                    self.source.name,
                    row,
                    a,
                )
                self.used -= 1
                continue
            number = found.add(a, b, offset, row, counted=counted, passage=passage, splay=splay in to_wall)
            if passage:
                between.setdefault((a, b), number)
        for tube in self.tubes:
            self.walls(tube, between, found)
        use_splays(found, self.source.name, self.journal)
        for name, xyz, row in self.fixed:
            if self.root(name) in found.stations:
                found.fixed[self.root(name)] = xyz
            else:
                self.list_(
                    "warning",
                    message("io.fixed-station-without-shot", "The fixed station is not in any shot"),
                    message("io.check-name", "Check its name."),
                    self.source.name,
                    row,
                    name,
                )
        return found.survey(self.source.name, issues)

    def walls(
        self, tube: list[tuple[str, tuple[float, ...]]], between: dict[tuple[str, str], int], found: ShotList
    ) -> None:
        """Add the walls of a tube, each along the shot to the next station; the last along the one before."""
        names = [self.root(name) for name, _ in tube]
        for i, (_, walls) in enumerate(tube):
            if names[i] not in found.stations:
                self.list_(
                    "warning",
                    message("io.walls-without-shot", "The walls are at a station without a shot"),
                    EMPTY,
                    self.source.name,
                    0,
                    names[i],
                )
                continue
            ways = [(names[j], names[j + 1]) for j in (i, i - 1) if 0 <= j < len(names) - 1]
            left, right, up, down = walls
            for a, b in ways:
                if (a, b) in between:
                    found.add_walls(names[i], between[a, b], (left, right, up, down))
                    break
                if (b, a) in between:
                    found.add_walls(names[i], between[b, a], (right, left, up, down))
                    break
            else:
                shots = (n for pair, n in between.items() if names[i] in pair)
                found.add_walls(names[i], next(shots, -1), (left, right, up, down))


@arguments_checked
def read_survex(source: Source | str | Path, journal: Journal | None = None) -> Survey:
    """Read a Survex survey file and the files that it includes.

    Parameters
    ----------
    source : Source, str or Path
        The file.
    journal : Journal, optional
        Receives lines and commands that are not used; the survey holds them too.

    Returns
    -------
    Survey
        In metres; names are lower case unless the file says ``*case``, with the names of their surveys before them.

    Raises
    ------
    InputError
        If a file is missing, or ``*begin`` and ``*end`` do not match.

    Notes
    -----
    Commands that are read: ``docs/formats_in.md``.
    """
    source, journal = as_source(source), journal if journal is not None else Journal()
    first_issue, first_count = len(journal.issues), len(journal.counts)
    reader = _Reader(source, journal)
    with journal.handed_over():
        reader.file(source, Settings())
        reader.warn_uncorrected()
        survey = reader.survey(journal.issues[first_issue:])
    if reader.remarks:
        names = ", ".join(f"*{name} ({count})" for name, count in sorted(reader.remarks.items()))
        journal.add(
            "note",
            source.name,
            message("io.commands-ignored", "Commands that do not change geometry: {names}", names=Untranslated(names)),
        )
    journal.count(source.name, reader.read, reader.read - reader.used)
    return replace(survey, issues=tuple(journal.issues[first_issue:]), counts=tuple(journal.counts[first_count:]))

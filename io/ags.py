"""Groups of an AGS file (Association of Geotechnical and Geoenvironmental Specialists), editions 3 and 4.

AGS4: each line starts with GROUP, HEADING, UNIT, TYPE or DATA. AGS3: ``**GROUP``, headings with ``*`` that may run
over several lines, ``<UNITS>``, and ``<CONT>`` for a line that continues the row above.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, field

from geofit.data.errors import InputError
from geofit.data.messages import Message, Untranslated, message
from geofit.io.cells import table_of
from geofit.io.journal import Journal
from geofit.io.sniff import decode, is_number
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["group_names", "read_group"]


@dataclass
class _Group:
    name: str
    header: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    odd: list[tuple[int, str, Message]] = field(default_factory=list)


def group_names(source: Source) -> tuple[str, ...]:
    """Return the groups of a file that have rows, in file order."""
    groups, _ = _parse(*decode(source.read(), source.name, source.encoding), source, Journal())
    return tuple(name for name, group in groups.items() if group.rows or group.odd)


def read_group(source: Source, journal: Journal) -> Table:
    """Read the group that ``source.table`` names; a line that is not a row of it is listed.

    Raises
    ------
    InputError
        If the file is not an AGS file, or has no such group.
    """
    text, encoding = decode(journal.read(source), source.name, source.encoding)
    groups, edition = _parse(text, encoding, source, journal)
    group = groups.get(source.table)
    if group is None:
        raise InputError(
            message(
                "io.group-missing",
                "The file has no group '{table}'; its groups are {names}",
                table=Untranslated(source.table),
                names=", ".join(groups),
            ),
            message("data.name-one", "Name one of them."),
            file=source.name,
        )
    journal.add(
        "note",
        source.name,
        message("io.read-as-ags", "Read as AGS {edition}, {encoding}", edition=edition, encoding=encoding),
        message("io.state-encoding", "If this is wrong, state encoding."),
    )
    for line, value, reason in group.odd:
        journal.add(
            "error",
            source.name,
            reason,
            message("io.correct-line", "Correct the line."),
            row=line,
            value=value[:120],
        )
    return table_of(
        source,
        journal,
        group.header,
        group.rows,
        units=group.units,
        malformed=len(group.odd),
        encoding=encoding,
    )


def _parse(text: str, encoding: str, source: Source, journal: Journal) -> tuple[dict[str, _Group], int]:
    groups: dict[str, _Group] = {}
    group: _Group | None = None
    edition = 0
    lines = text.replace("\r\n", "\n").replace("\r", "\n").replace("\0", "").split("\n")
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        cells = next(csv.reader([line.strip()]), [])
        first = cells[0].strip() if cells else ""
        if first.startswith("**") or (first == "GROUP" and len(cells) > 1):
            edition = edition or (3 if first.startswith("**") else 4)
            name = first.lstrip("*?").strip() if edition == 3 else cells[1].strip()
            group = groups.setdefault(name, _Group(name))
            if group.header:
                # The same group again: its rows follow under the headings that are there now.
                group.header, group.units = [], []
        elif group is None:
            continue
        elif edition == 4:
            _line_of_4(group, number, first, cells)
        else:
            _line_of_3(group, number, first, cells, source, journal)
    if not groups:
        raise InputError(
            message("io.no-group", "The file has no AGS group"),
            message(
                "io.give-ags-groups",
                'An AGS file has lines that start with "GROUP" (edition 4) or "**" (edition 3).',
            ),
            file=source.name,
        )
    return groups, edition


def _line_of_4(group: _Group, number: int, first: str, cells: list[str]) -> None:
    match first:
        case "HEADING":
            group.header = [cell.strip() for cell in cells[1:]]
        case "UNIT":
            group.units = [cell.strip() for cell in cells[1:]]
        case "TYPE":
            return
        case "DATA" if group.header:
            group.rows.append((number, cells[1:]))
        case _:
            headless, strange = (
                message("io.row-above-headings", "The row is above the headings of its group"),
                message("io.line-not-ags", "This line is not valid AGS 4"),
            )
            reason = headless if first == "DATA" else strange
            group.odd.append((number, ",".join(cells), reason))


def _line_of_3(group: _Group, number: int, first: str, cells: list[str], source: Source, journal: Journal) -> None:
    if first.startswith("*"):
        group.header += [cell.strip().strip("*?") for cell in cells if cell.strip()]
    elif first == "<UNITS>":
        group.units = [""] + [cell.strip() for cell in cells[1:]]
    elif first == "<CONT>" and group.rows:
        _continue(group, number, cells, source, journal)
    elif first.startswith("<") or not group.header:
        group.odd.append(
            (
                number,
                ",".join(cells),
                message("io.line-continues-nothing", "The line does not belong to any row or group"),
            )
        )
    else:
        group.rows.append((number, cells))


def _continue(group: _Group, number: int, cells: list[str], source: Source, journal: Journal) -> None:
    """Join a <CONT> line to the row above: texts are joined, a second number is listed."""
    row = group.rows[-1][1]
    row += [""] * (len(cells) - len(row))
    for j, cell in enumerate(cells[1:], 1):
        if not cell.strip():
            continue
        if row[j].strip() and is_number(cell) and is_number(row[j]):
            if cell.strip() != row[j].strip() and group.name == source.table:
                journal.add(
                    "warning",
                    source.name,
                    message(
                        "io.continuation-number-differs",
                        "The <CONT> line gives another number than the row above, '{number}', which is kept",
                        number=row[j],
                    ),
                    message("io.correct-one-of-two", "Correct one of the two."),
                    row=number,
                    column=group.header[j] if j < len(group.header) else "",
                    value=cell,
                )
        else:
            row[j] += cell

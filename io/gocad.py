"""Points of GOCAD files: VSet (.vs), PLine (.pl) and TSurf (.ts), vertices of one or more objects."""

from __future__ import annotations

import re
from contextlib import suppress

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.cells import table_of
from geofit.io.journal import Journal
from geofit.io.no_data import is_no_data
from geofit.io.sniff import decode
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["object_name", "read_vertices", "stated_axis_units"]

#: What programs write where the unit of an axis was never set.
_NO_UNIT = frozenset({"none", "unitless", "undefined", "unknown", "null", "n/a", "-", "?"})


def object_name(line: str) -> str:
    """Return the name that a line of the header states, ``name:Top T1`` or ``HEADER {name:Top T1}``; else ""."""
    found = re.match(r"\s*(?:HEADER\s*\{\s*)?name:([^}]*)", line, re.IGNORECASE)
    return found[1].strip().strip('"') if found else ""


def stated_axis_units(line: str) -> list[str]:
    """Return the units of x, y and z of a line ``AXIS_UNIT "m" " ft " none``; "" where it states that there is none.

    Examples
    --------
    >>> stated_axis_units('AXIS_UNIT "m" " ft " none')
    ['m', 'ft', '']
    """
    found = re.findall(r'"([^"]*)"|(\S+)', line.split(None, 1)[-1])
    units = [(quoted or bare).strip().casefold() for quoted, bare in found[:3]]
    return ["" if unit in _NO_UNIT else unit for unit in units]


def read_vertices(source: Source, journal: Journal) -> Table:
    """Read the vertices with the columns horizon (the object's name), x, y, z.

    Where the file says ``ZPOSITIVE Depth`` z is turned into an elevation, which is listed.

    Raises
    ------
    InputError
        If the file is not a GOCAD file or has no vertex.
    """
    text, encoding = decode(journal.read(source), source.name, source.encoding)
    lines = text.splitlines()
    if not lines or not lines[0].startswith("GOCAD"):
        raise InputError(
            message("io.gocad-heading-missing", "The file does not start with GOCAD"),
            message("io.export-gocad-points", "Export a VSet, PLine or TSurf."),
            file=source.name,
        )
    rows: list[tuple[int, list[str]]] = []
    malformed, name, down = 0, source.path.stem, False
    units: list[str] = []
    for number, line in enumerate(lines, 1):
        words = line.split()
        key = words[0].upper() if words else ""
        if key == "GOCAD":
            name, down = source.path.stem, False
        elif stated := object_name(line):
            name = stated
        elif key == "*NAME:" and words[1:]:
            name = words[1]
        elif key == "AXIS_UNIT":
            units = ["", *stated_axis_units(line)]
        elif key == "ZPOSITIVE" and words[1:]:
            down = words[1].casefold() == "depth"
            if down:
                journal.add(
                    "warning",
                    source.name,
                    message(
                        "io.z-turned-to-elevation",
                        "z is positive downwards; it is turned into an elevation",
                    ),
                    row=number,
                )
        elif key in ("VRTX", "PVRTX"):
            if len(words) < 5:
                malformed += 1
                journal.add(
                    "error",
                    source.name,
                    message("io.vertex-incomplete", "The vertex does not have three coordinates"),
                    row=number,
                    value=line[:120],
                )
                continue
            x, y, z = words[2:5]
            rows.append((number, [name, x, y, _turned(z) if down else z]))
    journal.add("note", source.name, message("io.read-as-gocad", "Read as GOCAD, {encoding}", encoding=encoding))
    return table_of(source, journal, ["horizon", "x", "y", "z"], rows, units=units, malformed=malformed)


def _turned(z: str) -> str:
    """Return a depth as an elevation; a mark for no data stays one."""
    with suppress(ValueError):
        if is_no_data(np.array(float(z))):
            return z
    return z[1:] if z.startswith("-") else f"-{z.removeprefix('+')}"

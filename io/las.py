"""Well logs in LAS (lasio, extra ``las``): the well as a collar, the samples of its curves as intervals."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.cells import number_text, table_of
from geofit.io.extra import need
from geofit.io.journal import Journal
from geofit.io.sniff import decode
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["log_tables", "read_log"]

TABLES = ("WELL", "CURVES")

_WELL = {
    "hole": ("WELL", "UWI", "API"),
    "x": ("XCOORD", "X", "EAST", "XWELL", "UTMX", "EASTING"),
    "y": ("YCOORD", "Y", "NORTH", "YWELL", "UTMY", "NORTHING"),
    "z": ("EREF", "EKB", "KB", "ELEV", "EGL", "GL", "EDF", "ELZ"),
}


def log_tables(source: Source) -> tuple[str, ...]:
    """Return the tables of a log: the same for all of them.

    Raises
    ------
    InputError
        If no line of the file begins a section of LAS.
    """
    text, _ = decode(source.read(), source.name, source.encoding)
    if not any(line.lstrip().startswith("~") for line in text.splitlines()):
        raise _damaged(source)
    return TABLES


def read_log(source: Source, journal: Journal) -> Table:
    """Read "WELL" (one row: hole, x, y, z, depth) or "CURVES" (a row each sample: hole, from, to, curves).

    A sample reaches from its depth to that of the next deeper one, whether the log runs down or up; a curve of codes
    (facies, lithology) thus makes intervals, and the hole is as deep as its samples reach. z is the elevation of the
    depth reference.

    Raises
    ------
    InputError
        If the file is not a LAS file or has no sample.
    """
    log, line = _open(source, journal)
    hole = _head(log, _WELL["hole"])[0] or source.path.stem
    top, base = _reach(np.asarray(log.index, dtype=np.float64))
    unit = str(log.curves[0].unit)
    if source.table == "WELL":
        found = {role: _head(log, names) for role, names in _WELL.items()}
        deepest = float(base[np.isfinite(base)].max(initial=-np.inf))
        cells = [hole, *(found[role][0] for role in ("x", "y", "z")), number_text(deepest) if deepest > 0 else ""]
        units = ["", *(found[role][1] for role in ("x", "y", "z")), unit]
        return table_of(source, journal, [*_WELL, "depth"], [(1, cells)], units=units)
    if source.table != "CURVES":
        raise InputError(
            message("io.las-table-unknown", "A LAS file has no table '{table}'", table=source.table),
            message("io.name-las-table", "Name WELL or CURVES."),
            file=source.name,
        )
    curves = list(log.curves)[1:]
    header = ["hole", "from", "to", *(str(curve.mnemonic) for curve in curves)]
    rows = [
        (line + i, [hole, number_text(top[i]), number_text(base[i]), *(_cell(curve.data[i]) for curve in curves)])
        for i in range(len(top))
    ]
    journal.add(
        "note",
        source.name,
        message(
            "io.samples-as-intervals",
            "{count} samples; each is an interval that reaches to the next sample",
            count=len(top),
        ),
        message("io.give-interval-table", "Give an interval table where the log has one."),
    )
    return table_of(source, journal, header, rows, units=["", unit, unit, *(str(c.unit) for c in curves)])


def _reach(depth: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where each sample begins and ends, that is, where the next deeper one begins."""
    down = depth if depth[-1] >= depth[0] else depth[::-1]
    step = down[-1] - down[-2] if len(down) > 1 else 0.0
    ends = np.append(down[1:], down[-1] + step)
    return depth, ends if down is depth else ends[::-1]


def _cell(value: Any) -> str:
    return number_text(float(value)) if isinstance(value, (int, float, np.floating, np.integer)) else str(value)


def _open(source: Source, journal: Journal) -> tuple[Any, int]:
    """Return the log and the line of its first sample."""
    lasio = need("lasio", "las", message("io.reading-log", "Reading the log {file}", file=source.name))
    text, _ = decode(journal.read(source), source.name, source.encoding)
    failures = (
        lasio.exceptions.LASHeaderError,
        lasio.exceptions.LASDataError,
        lasio.exceptions.LASUnknownUnitError,
        ArithmeticError,
        AttributeError,
        LookupError,
        OSError,
        TypeError,
        ValueError,
    )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            log = lasio.read(text.replace("\r\n", "\n").replace("\r", "\n") + "\n", engine="normal")
            size = len(np.asarray(log.index, dtype=np.float64))
    except failures:
        raise _damaged(source) from None
    if not size:
        raise InputError(
            message("io.log-without-sample", "The log has no sample"),
            message("io.export-ascii-section", "Export it with its ~ASCII section."),
            file=source.name,
        )
    lines = text.splitlines()
    start = next((i for i, line in enumerate(lines) if line.lstrip().upper().startswith("~A")), 0)
    return log, start + 2


def _damaged(source: Source) -> InputError:
    return InputError(
        message("io.log-unreadable", "The log is damaged, incomplete or not a LAS file"),
        message("io.export-las", "Export it as LAS 2.0."),
        file=source.name,
    )


def _head(log: Any, names: tuple[str, ...]) -> tuple[str, str]:
    """Return value and unit of the first of some items of the header that is filled."""
    items = {str(item.mnemonic).upper(): item for section in (log.well, log.params) for item in section}
    for name in names:
        item = items.get(name)
        if item is not None and str(item.value).strip():
            return str(item.value).strip(), str(item.unit)
    return "", ""

"""Structural dips: azimuth and dip, strike and dip, or the normal of the plane."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message, plural_message
from geofit.data.site import ImportIssue, Orientations
from geofit.geometry.attitudes import attitudes
from geofit.io.axes import Region, check_axes
from geofit.io.columns import ORIENTATIONS
from geofit.io.digits import check_digits
from geofit.io.journal import Journal
from geofit.io.rows import Rows, read_rows
from geofit.io.source import Source
from geofit.io.tables import first_names, parse_numbers

__all__ = ["load_orientations", "read_orientations"]

Floats = NDArray[np.float64]

#: Degrees by which strike and azimuth may fail to be at right angles, and dips below which they are hard to measure.
STRIKE, FLAT = 15.0, 5.0


def read_orientations(path: str | Path, horizon: str = "") -> tuple[Orientations, tuple[ImportIssue, ...]]:
    """Read a table of measured dips that belongs to no site file.

    Parameters
    ----------
    path : path
        The table: x, y, z (m), and dip with azimuth or strike, or a normal.
    horizon : str
        Horizon of the measurements that name none.

    Returns
    -------
    orientations : Orientations
        The measurements.
    issues : tuple of ImportIssue
        What was listed of the table.

    Raises
    ------
    InputError
        If the file is missing, no columns hold an attitude, or no row can be used.
    """
    journal = Journal()
    found = load_orientations(Source(path=Path(path)), journal)
    named = np.where(found.horizon == "", horizon, found.horizon).astype(np.str_)
    return replace(found, horizon=named), tuple(journal.issues)


def load_orientations(source: Source, journal: Journal, region: Region | None = None) -> Orientations:
    """Read measurements; rows without a place or an attitude are listed.

    The dip is given with its azimuth (direction of steepest descent), or with the strike, which by the right-hand
    rule lies 90 degrees anticlockwise of it; else by the plane's normal, of either sign.

    Raises
    ------
    InputError
        If no columns hold an attitude, or no row can be used.
    """
    rows = read_rows(source, ORIENTATIONS, journal)
    (x, y), z = rows.places(), rows.numbers("z", no_data=True)
    check_axes(rows, x, y, region)
    check_digits(rows, x, y)
    azimuth, dip = _attitudes(rows)
    horizon = rows.text("horizon", required=False)
    rows.close()
    rows.require_any()
    used = np.flatnonzero(rows.ok)
    return Orientations(
        np.column_stack([x, y, z])[used],
        azimuth[used],
        dip[used],
        np.array(horizon, dtype=np.str_)[used],
        np.full(len(used), rows.file),
        rows.line[used],
    )


def _attitudes(rows: Rows) -> tuple[Floats, Floats]:
    if {"nx", "ny", "nz"} <= set(rows.columns) and "dip" not in rows.columns:
        return _from_normals(rows)
    if "dip" not in rows.columns or not {"azimuth", "strike"} & set(rows.columns):
        raise InputError(
            message(
                "io.attitude-columns-missing",
                "No columns for an attitude were found in this orientations table; its columns are {names}",
                names=first_names(rows.table.header),
            ),
            message("io.name-attitude-columns", "Name dip with azimuth or strike, or the normal nx, ny, nz."),
            file=rows.file,
        )
    dip = rows.numbers("dip")
    if "azimuth" in rows.columns:
        azimuth = rows.numbers("azimuth")
        _compare_strikes(rows, azimuth, dip)
    else:
        azimuth = rows.numbers("strike") + 90.0
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.strike-by-right-hand",
                "The strike is read by the right-hand rule: the plane dips to the right of it",
            ),
            message("io.give-azimuth-instead", "If that is wrong, give the azimuth of the dip."),
            column=rows.table.header[rows.columns["strike"]],
        )
    for i in np.flatnonzero(~((dip >= 0) & (dip <= 90)) & rows.ok).tolist():
        rows.reject(
            i,
            "dip",
            message("io.dip-out-of-range", "The dip is not between 0 and 90 degrees"),
            message("io.give-dip-angle", "Give the angle below the horizontal."),
        )
    for i in np.flatnonzero((np.abs(azimuth) > 450.0) & rows.ok).tolist():
        rows.reject(
            i,
            "azimuth",
            message("io.azimuth-out-of-range", "The azimuth is not between 0 and 360 degrees"),
            message("io.give-azimuth", "Give degrees from north."),
        )
    return azimuth % 360.0, dip


def _compare_strikes(rows: Rows, azimuth: Floats, dip: Floats) -> None:
    """List that strikes and azimuths contradict each other, whichever of its two directions a strike has."""
    if "strike" not in rows.columns:
        return
    # A strike such as N30E is not compared: the row has its azimuth.
    strike, _ = parse_numbers(rows.table.columns[rows.columns["strike"]], rows.table.decimal)
    strike = strike * rows.factors.get("strike", 1.0)
    apart = np.abs((azimuth - strike) % 180.0 - 90.0)
    wrong = np.flatnonzero((apart > STRIKE) & (dip >= FLAT) & rows.ok)
    if len(wrong):
        first = int(wrong[0])
        reason = plural_message(
            "io.strike-contradicts-azimuth",
            "In {count} row the strike and the azimuth of the dip are not at right angles: {strike:g} and "
            "{azimuth:g} degrees",
            "In {count} rows the strike and the azimuth of the dip are not at right angles, first in row {row}: "
            "{strike:g} and {azimuth:g} degrees",
            count=len(wrong),
            row=int(rows.line[first]),
            strike=strike[first],
            azimuth=azimuth[first],
        )
        remedy = message("io.azimuth-is-used", "The azimuth is used; correct whichever is wrong.")
        column = rows.table.header[rows.columns["strike"]]
        rows.journal.add("warning", rows.file, reason, remedy, row=int(rows.line[first]), column=column)


def _from_normals(rows: Rows) -> tuple[Floats, Floats]:
    n = np.column_stack([rows.numbers("nx"), rows.numbers("ny"), rows.numbers("nz")])
    length = np.linalg.norm(n, axis=1)
    for i in np.flatnonzero(~(length > 0) & rows.ok).tolist():
        rows.reject(
            i,
            "nx",
            message("io.normal-zero", "The normal has zero length"),
            message("io.give-normal-components", "Give the three components of the plane's normal."),
        )
    return attitudes(n)

"""How coordinates were stored, by their digits: in single precision, or in kilometres."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, Untranslated, message
from geofit.io.rows import Rows

__all__ = ["LEAST", "check_digits", "lost_by_rounding", "step_of_single"]

Floats = NDArray[np.float64]

#: A number in scientific notation: the decimals of its mantissa, and its exponent.
_SCIENTIFIC = re.compile(r"\s*[-+]?\d(?:[.,](\d*))?[eE]\+?(\d{1,2})\s*")

#: Metres that rounding may move a place by without a word.
LEAST = 0.01
#: Most places that are examined, and the fewest of them with a fraction that are evidence.
_MOST, _FEWEST = 2000, 20
#: Kilometres of easting and northing of national grids; the widest site; elevations, metres, rise by so many times the
#: number of kilometres that the places extend over.
_EAST, _NORTH, _WIDEST, _RISE = (100.0, 1000.0), (100.0, 10_000.0), 100.0, 5.0


def check_digits(rows: Rows, x: Floats, y: Floats, z: Floats | None = None) -> None:
    """Warn of places (n,) that were rounded to single precision, and of kilometres with elevations in metres."""
    east, north = x[rows.ok], y[rows.ok]
    column = rows.table.header[rows.columns["x"]]
    step = max(step_of_single(east), step_of_single(north))
    if step:
        # What was rounded is the file, not the column: the larger coordinate lost more.
        step = max(step, *(float(np.spacing(np.float32(np.abs(part).max(initial=0.0)))) for part in (east, north)))
        rows.journal.add("warning", rows.file, *lost_by_rounding(step), column=column)
    for role in ("x", "y", "z"):
        if role in rows.columns:
            _warn_of_few_digits(rows, role)
    if z is not None and {"x", "y", "z"}.isdisjoint(rows.factors) and _like_kilometres(east, north, z[rows.ok]):
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.places-like-kilometres",
                "x is around {x:.7g} and y around {y:.7g}; they cover {extent:.3g} m, elevations {rise:.3g} m: x and y "
                "may be kilometres, and are read as metres",
                x=float(np.median(east)),
                y=float(np.median(north)),
                extent=_extent(east, north),
                rise=float(np.ptp(z[rows.ok])),
            ),
            message(
                "io.mark-kilometres",
                "If they are kilometres, write the unit into their headers: x [km], y [km].",
            ),
            column=column,
        )


def _warn_of_few_digits(rows: Rows, role: str) -> None:
    """Warn of coordinates that a spreadsheet wrote with the digits that it showed: 3101242.81 becomes 3.10E+06."""
    cells = rows.table.columns[rows.columns[role]]
    some = [cell for i, cell in enumerate(cells[:_MOST]) if rows.ok[i]]
    steps = [
        10.0 ** (int(found[2]) - len(found[1] or "")) for found in map(_SCIENTIFIC.fullmatch, some) if found is not None
    ]
    if 2 * len(steps) <= len(some) or min(steps) <= 1.0:
        return
    rows.journal.add(
        "warning",
        rows.file,
        message(
            "io.few-digits",
            "Coordinates such as {cell} have too few digits: they are rounded to {step:g} m, and up to {most:g} m off",
            cell=Untranslated(next(cell.strip() for cell in some if _SCIENTIFIC.fullmatch(cell))),
            step=min(steps) * rows.factors.get(role, 1.0),
            most=min(steps) * rows.factors.get(role, 1.0) / 2,
        ),
        message("io.export-all-digits", "Export them again with all digits, as numbers with two decimals."),
        column=rows.table.header[rows.columns[role]],
    )


def step_of_single(values: Floats) -> float:
    """Return the step (m) that coordinates (n,) were rounded to if they look like numbers of 32 bits; else 0.

    They do if each is, to the centimetre that it may be written with, a number of 32 bits: of those that lie 1/32 to
    1/8 m apart, one in three or fewer does so by chance.

    Examples
    --------
    >>> places = 500_000 + np.linspace(0.0, 99.0, 40) ** 1.1
    >>> step_of_single(places), step_of_single(places.astype(np.float32).astype(float))
    (0.0, 0.03125)
    """
    some = values[:: max(len(values) // _MOST, 1)]
    size = np.abs(some)
    single = some.astype(np.float32)
    if not len(some) or size.min() < 2.0**18 or size.max() >= 2.0**21 or (np.abs(some - single) > 0.00501).any():
        return 0.0
    # Numbers that are rounded to quarters are of 32 bits whatever they were stored in.
    fractions = np.unique(some[np.abs(4 * single - np.round(4 * single)) > 0.1])
    return float(np.spacing(single.max())) if len(fractions) >= _FEWEST else 0.0


def lost_by_rounding(step: float) -> tuple[Message, Message]:
    """Return a warning of places rounded to a step (m) by numbers of 32 bits, and what to do."""
    return message(
        "io.single-precision",
        "The coordinates were stored in single precision (32-bit numbers): they are rounded to {step:.3g} m, and up "
        "to {most:.2g} m off",
        step=step,
        most=step / 2,
    ), message(
        "io.export-double-precision",
        "Export them again in double precision, or with a constant subtracted from eastings and northings.",
    )


def _like_kilometres(east: Floats, north: Floats, z: Floats) -> bool:
    known = z[np.isfinite(z)]
    if len(np.unique(east)) < 4 or not known.size:
        return False
    x, y = float(np.median(east)), float(np.median(north))
    extent = _extent(east, north)
    finer = any((np.abs(100 * part - np.round(100 * part)) > 1e-4).mean() > 0.5 for part in (east, north))
    like = _EAST[0] <= x < _EAST[1] and _NORTH[0] <= y < _NORTH[1] and 0 < extent < _WIDEST
    return like and finer and float(np.ptp(known)) > _RISE * extent


def _extent(east: Floats, north: Floats) -> float:
    return float(max(np.ptp(east), np.ptp(north)))

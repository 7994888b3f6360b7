"""Wide tables: one row a hole or place, one column a horizon with its elevation, or its depth below the collar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.data.points import PointSet
from geofit.io.axes import Region, check_axes
from geofit.io.columns import HORIZON_COLUMNS
from geofit.io.digits import check_digits
from geofit.io.guess import locate
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.no_data import is_no_data
from geofit.io.rows import Rows, is_blank, read_rows
from geofit.io.source import Source
from geofit.io.tables import parse_numbers
from geofit.io.units import length_factors

__all__ = ["load_horizon_columns"]

Floats = NDArray[np.float64]


def load_horizon_columns(
    source: Source, horizons: HorizonNames, journal: Journal, region: Region | None = None
) -> dict[str, PointSet]:
    """Read the picks of each column that ``source.horizons`` names; its header is the horizon's name.

    Values are elevations unless ``source.measure`` is "depth": then they are taken from z, straight down. A cell
    without a value makes no pick; a row without any pick is listed.

    Raises
    ------
    InputError
        If no column is named as a horizon, one is not there, or no row can be used.
    """
    if not source.horizons:
        raise InputError(
            message("io.no-horizon-column", "No column is named as a horizon"),
            message("io.state-horizons-headers", 'State horizons = ["..."] with their headers.'),
            file=source.name,
        )
    depths = source.measure == "depth"
    rows = read_rows(source, HORIZON_COLUMNS, journal)
    if depths and "z" not in rows.columns:
        raise InputError(
            message(
                "io.depths-without-origin",
                "Depths need the elevation of their origin, and there is no column for it",
            ),
            message("io.state-collar-elevation", "State columns = { z = ... } with the elevation of the collar."),
            file=source.name,
        )
    (x, y), mouth = rows.places(), rows.numbers("z", no_data=True) if depths else np.zeros(len(rows))
    check_axes(rows, x, y, region)
    check_digits(rows, x, y)
    places = [locate(rows.table, "horizons", wanted) for wanted in source.horizons]
    _tell_measure(rows, places, depths)
    found: dict[str, Floats] = {}
    for j in dict.fromkeys(places):
        header = rows.table.header[j]
        name = horizons.match(header)
        if name is None:
            reason = message(
                "io.column-not-a-horizon",
                "Column '{column}' is not a horizon of the site; its values are not used",
                column=Untranslated(header),
            )
            journal.add(
                "warning",
                rows.file,
                reason,
                message("io.add-horizon", "Add a [[horizon]] of its name."),
                column=header,
            )
            continue
        if name in found:
            raise InputError(
                message("io.horizon-column-repeated", "Two columns are of horizon '{name}'", name=name),
                message("io.name-horizon-once", "Name each horizon once."),
                file=source.name,
            )
        values = _values(rows, j, depths)
        found[name] = mouth - values if depths else values
    used = np.any([np.isfinite(z) for z in found.values()], axis=0) if found else np.zeros(len(rows), dtype=bool)
    for i in np.flatnonzero(~used & rows.ok).tolist():
        rows.reject(
            i,
            "horizons",
            message("io.row-without-value", "The row contains no horizon's value"),
            message("io.complete-or-remove-row", "Complete the row or remove it."),
        )
    rows.close()
    rows.require_any()
    _count_blanks(rows, found)
    hole = np.array(rows.text("hole", required=False))
    picks = {}
    for name, z in found.items():
        if (chosen := np.flatnonzero(np.isfinite(z) & rows.ok)).size:
            picks[name] = PointSet(
                np.column_stack([x, y, z])[chosen],
                kind="borehole" if "hole" in rows.columns else "point",
                hole=hole[chosen],
                row=rows.line[chosen],
                file=rows.file,
            )
    return picks


def _tell_measure(rows: Rows, places: list[int], depths: bool) -> None:
    names = ", ".join(dict.fromkeys(rows.table.header[j] for j in places))
    if depths:
        reason = message("io.depths-taken-straight", "Depths of {names} are taken straight down from z", names=names)
        rows.journal.add("note", rows.file, reason)
    elif rows.source.measure is None:
        reason = message("io.values-taken-elevations", "The values of {names} are taken as elevations", names=names)
        rows.journal.add(
            "note",
            rows.file,
            reason,
            message("io.state-measure-depth", 'If they are depths, state measure = "depth".'),
        )


def _values(rows: Rows, j: int, depths: bool) -> Floats:
    """Return the values of a column in metres, nan where there is none; cells that hold something else are listed."""
    cells, header = rows.table.columns[j], rows.table.header[j]
    values, bad = parse_numbers(cells, rows.table.decimal)
    wrong = [i for i in bad.tolist() if not is_blank(cells[i])]
    values[is_no_data(values)] = np.nan
    reasons = dict.fromkeys(wrong, message("io.cell-not-finite", "The cell is not a finite number; it gives no pick"))
    if depths:
        above = np.flatnonzero(values < 0).tolist()
        reasons |= dict.fromkeys(above, message("io.depth-negative", "The depth is negative; it gives no pick"))
        values[above] = np.nan
    for i, reason in sorted(reasons.items()):
        rows.journal.add(
            "warning",
            rows.file,
            reason,
            message("io.correct-cell", "Correct the cell."),
            row=int(rows.line[i]),
            column=header,
            value=cells[i].strip(),
        )
    factor = length_factors(rows.table, {"depth" if depths else "elevation": j}, rows.source, rows.journal)
    return values * next(iter(factor.values()), 1.0)


def _count_blanks(rows: Rows, found: dict[str, Floats]) -> None:
    """List in one note how many used rows have no value of each horizon."""
    blanks = {name: int(np.isnan(z[rows.ok]).sum()) for name, z in found.items()}
    if any(blanks.values()):
        counts = ", ".join(f"{name} {count}" for name, count in blanks.items() if count)
        rows.journal.add(
            "note",
            rows.file,
            message(
                "io.cells-without-value",
                "Cells without a value in rows that are used, which give no pick: {counts}",
                counts=counts,
            ),
        )

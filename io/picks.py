"""Plain picks: points with x, y, z, for one horizon or many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.labels import Labels
from geofit.data.legible import legible
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.data.site import ImportIssue, TableCount
from geofit.io.axes import Region, check_axes, check_elevations
from geofit.io.columns import PICKS, Schema
from geofit.io.digits import check_digits
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping
from geofit.io.places import list_places
from geofit.io.rows import read_rows
from geofit.io.source import Source

Floats = NDArray[np.float64]

__all__ = ["Picks", "load_picks", "read_points"]


@dataclass(frozen=True, eq=False)
class Picks:
    """Points of each horizon of a pick file, with what was found on the way."""

    horizons: Mapping[str, PointSet]
    issues: tuple[ImportIssue, ...]
    counts: tuple[TableCount, ...]
    inputs: Mapping[str, str]


@arguments_checked
def read_points(
    path: str | Path,
    x: str | int | None = None,
    y: str | int | None = None,
    z: str | int | None = None,
    surface: str | int | None = None,
    section: str | int | None = None,
    sep: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
    progress: Progress | None = None,
    mapping: ColumnMapping | None = None,
    crs: str | None = None,
    unit: str | None = None,
) -> Picks:
    """Read a text table of points.

    Parameters
    ----------
    path : path
        CSV, TSV or blank-separated text.
    x, y, z, surface, section : str or int, optional
        Column of easting, northing, elevation (m), horizon and section: its header, or its number from 1.
        What is not given is guessed from the header; each guess is listed as a note.
    sep, decimal, encoding : str, optional
        Separator, decimal mark and encoding, where the guess is wrong.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    mapping : ColumnMapping, optional
        How the table is read, where the other arguments do not report it.
    crs : str, optional
        Projected coordinate system of the site; longitudes and latitudes are brought to it.
    unit : str, optional
        Unit of all lengths: "m", "ft", "ft-us" (US survey foot), "km", "cm" or "mm"; else
        what headers mark, else metres.

    Returns
    -------
    Picks
        Without a column for the horizon there is one, named as the file is.

    Raises
    ------
    InputError
        If the file is missing or empty, a column is missing, or no row can be used.

    Notes
    -----
    Formats and headers that are recognized: ``docs/formats_in.md``.
    """
    given = {"x": x, "y": y, "z": z, "horizon": surface, "section": section}
    source = Source(
        path=Path(path),
        sep=sep,
        decimal=decimal,
        encoding=encoding,
        columns={role: column for role, column in given.items() if column is not None},
        target=crs,
        unit=unit,
    )
    if mapping is not None:
        source = mapping.fill(source)
    journal = Journal()
    tell(progress, "read", 0.0)
    with journal.handed_over():
        horizons = load_picks(source, HorizonNames(), journal, alone=legible(Path(path).stem), progress=progress)
    tell(progress, "compare places", 0.8)
    for name, points in horizons.items():
        list_places(name, points, journal)
    tell(progress, "read", 1.0)
    return Picks(horizons, tuple(journal.issues), tuple(journal.counts), dict(journal.inputs))


def load_picks(
    source: Source,
    horizons: HorizonNames,
    journal: Journal,
    *,
    kind: str = "point",
    region: Region | None = None,
    alone: str | None = None,
    progress: Progress | None = None,
) -> dict[str, PointSet]:
    """Read picks; ``kind`` and ``alone`` stand where the file names no kind and no horizon."""
    required = dict(PICKS.required)
    optional = dict(PICKS.optional)
    if alone is None:
        required = {"horizon": optional.pop("horizon"), **required}
    rows = read_rows(source, Schema("picks", required, optional), journal)
    tell(progress, "check rows", 0.4)
    xyz = _joined(*rows.places(), rows.numbers("z", no_data=True))
    if source.measure == "depth":
        np.negative(xyz[:, 2], out=xyz[:, 2])
        journal.add(
            "note",
            source.name,
            message("io.depth-turned-to-elevation", "z is a depth below 0; it is turned into an elevation"),
        )
    tell(progress, "check rows", 0.6)
    accuracy = rows.numbers("accuracy", required=False) if "accuracy" in rows.columns else np.nan
    for i in np.flatnonzero((np.asarray(accuracy) <= 0) & rows.ok).tolist():
        rows.reject(
            i,
            "accuracy",
            message("io.accuracy-not-positive", "The accuracy is not above 0"),
            message("io.give-standard-deviation", "Give one standard deviation in metres."),
        )
    names = horizons.labels(rows) if "horizon" in rows.columns else Labels.same(alone or "", len(rows))
    check_axes(rows, xyz[:, 0], xyz[:, 1], region)
    check_elevations(rows, xyz[:, 2])
    check_digits(rows, *xyz.T)
    kinds = rows.labels("kind", required=False)
    rows.close()
    rows.require_any()
    hole, section = (rows.labels(role, required=False) for role in ("hole", "section"))
    rows.release()
    return horizons.split(
        rows,
        names,
        xyz,
        kind=kinds.renamed([cell.casefold() or kind for cell in kinds.table]),
        hole=hole,
        section=section,
        accuracy=accuracy,
    )


def _joined(*columns: Floats) -> Floats:
    """Return (n, 3) places; columns that are those of one array, in its order, are not copied."""
    whole = columns[0].base
    if isinstance(whole, np.ndarray) and whole.shape == (len(columns[0]), len(columns)):
        own = [column.ctypes.data for column in whole.T]
        if own == [column.ctypes.data for column in columns] and all(column.base is whole for column in columns):
            return whole
    return np.column_stack(columns)

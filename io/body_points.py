"""Picked points of a body: contacts with or without outward normals, and places known to lie inside or outside."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from geofit.bodies.data import BodyData
from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import ImportIssue
from geofit.io.columns import BODY_POINTS
from geofit.io.journal import Journal
from geofit.io.no_data import is_no_data
from geofit.io.rows import read_rows
from geofit.io.source import Source

__all__ = ["PickedPoints", "read_body_points"]

#: Words for the side of the surface on which a point lies; an empty cell is a contact.
SIDES = {
    "contact": ("", "contact", "on", "surface", "0", "接触", "接触点", "界面", "界面上"),
    "inside": ("inside", "in", "-1", "内", "内部", "体内"),
    "outside": ("outside", "out", "1", "+1", "外", "外部", "体外"),
}


@dataclass(frozen=True, eq=False)
class PickedPoints:
    """Points of a file; ``issues`` lists the rows that are not used, and the guesses that were made."""

    data: BodyData
    issues: tuple[ImportIssue, ...]


def read_body_points(path: str | PathLike[str], *, unit: str | None = None) -> PickedPoints:
    """Read a table of points on a body, with x, y, z, and where known nx, ny, nz and side.

    A row without a normal (empty, or a mark for "no data") is a contact all the same. ``side`` is contact, inside or
    outside; a column for the hole or the section names where the point was picked.

    Parameters
    ----------
    path : path
        A text table, or another of ``docs/formats_in.md``.
    unit : str, optional
        Unit of all lengths, as :func:`geofit.io.read_points` takes it; else what headers mark, else metres.

    Raises
    ------
    InputError
        If the file cannot be read, columns are missing, or no row can be used.
    """
    journal = Journal()
    with journal.handed_over():
        return _picked(Source(path=Path(path), unit=unit), journal)


def _picked(source: Source, journal: Journal) -> PickedPoints:
    rows = read_rows(source, BODY_POINTS, journal)
    (x, y), z = rows.places(), rows.numbers("z", no_data=True)
    normals = np.column_stack([rows.numbers(role, required=False) for role in ("nx", "ny", "nz")])
    unknown = ~np.isfinite(normals).all(axis=1) | is_no_data(normals).any(axis=1) | (normals == 0).all(axis=1)
    normals[unknown] = np.nan
    side = np.array([_side(word) for word in rows.text("side", required=False)])
    for i in np.flatnonzero((side == "?") & rows.ok).tolist():
        rows.reject(
            i,
            "side",
            message("io.side-unknown", "The side is not contact, inside or outside"),
            message("io.write-side", "Write contact, inside or outside."),
        )
    hole = np.array(rows.text("hole" if "hole" in rows.columns else "section", required=False), dtype=np.str_)
    rows.close()
    rows.require_any()
    xyz = np.column_stack([x, y, z])
    on, within, off = (rows.ok & (side == kind) for kind in SIDES)
    if not (on | within).any():
        raise InputError(
            message("io.only-outside-points", "The table has only points outside the body"),
            message("io.add-contacts", "Add points on its surface, or inside it."),
            file=source.name,
        )
    data = BodyData(
        xyz[on], xyz[within], xyz[off], normals[on],
        hole=hole[on], inside_hole=hole[within], outside_hole=hole[off],
    )  # fmt: skip
    return PickedPoints(data, tuple(journal.issues))


def _side(word: str) -> str:
    plain = word.strip().casefold()
    return next((side for side, words in SIDES.items() if plain in words), "?")

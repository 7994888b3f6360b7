"""The lines of a section as a table, which the section reader takes back."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from os import PathLike

from geofit.data.files import replacing, spreadsheet_cell
from geofit.data.given import arguments_checked
from geofit.data.legible import legible_keys
from geofit.sampling.cut import CutLine

__all__ = ["HEADER", "write_section_csv"]

HEADER = ("horizon", "line", "distance", "elevation", "x", "y")


@arguments_checked
def write_section_csv(cuts: Mapping[str, Sequence[CutLine]], path: str | PathLike[str]) -> None:
    """Write a section as a table: one row a vertex, metres to 1e-6.

    Columns: horizon, line (from 1; an overturned fold is one line that turns back), distance along the section,
    elevation, x, y.

    Parameters
    ----------
    cuts : mapping of str to sequence of CutLine
        What :func:`geofit.cut_section` returned, by horizon.
    path : path
        The file, usually ``*.csv``.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    ``docs/formats_out.md``, "Sections".
    """
    # The byte-order mark tells spreadsheets that the text is UTF-8.
    with replacing(path) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(HEADER)
        for name, lines in ((spreadsheet_cell(name), lines) for name, lines in legible_keys(cuts).items()):
            for number, line in enumerate(lines, 1):
                for distance, (x, y, z) in zip(line.distance.tolist(), line.xyz.tolist(), strict=True):
                    writer.writerow((name, number, *(f"{value:.6f}" for value in (distance, z, x, y))))

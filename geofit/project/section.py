"""The work of ``geofit section``: surfaces cut along a line, as drawing, table and picture."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.sampling.cut import CutLine, cut_section, section_line
from geofit.surfaces.protocol import Surface

__all__ = ["read_line", "section"]

Floats = NDArray[np.float64]


Surfaces = Mapping[str, Surface]


def section(
    surfaces: Surfaces, line: Floats, out: Path, tolerance: float = 0.05
) -> tuple[dict[str, list[CutLine]], list[Path]]:
    """Cut every horizon along a line in plan; write drawing, 3D lines, table and picture into a folder.

    Raises
    ------
    InputError
        If the line meets no horizon.
    SettingsError
        If the line has fewer than two different corners.
    """
    from geofit.io.export.dxf import write_section_dxf
    from geofit.io.export.section_csv import write_section_csv
    from geofit.report.section import write_section_picture

    corners = section_line(line)
    cuts = {name: cut_section(surface, corners, tolerance=tolerance) for name, surface in surfaces.items()}
    if not any(cuts.values()):
        raise InputError(
            message(
                "project.section-line-off-horizons",
                "The section line from {first} to {last} meets no horizon",
                first=corners[0].tolist(),
                last=corners[-1].tolist(),
            ),
            message("project.give-map-coordinates", "Give it in the surfaces' map coordinates, metres."),
        )
    out.mkdir(parents=True, exist_ok=True)
    files = [out / name for name in ("section.dxf", "section_3d.dxf", "section.csv", "section.png")]
    write_section_dxf(cuts, files[0])
    write_section_dxf(cuts, files[1], drawn=False)
    write_section_csv(cuts, files[2])
    write_section_picture(cuts, corners, files[3])
    return cuts, files


def read_line(text: str) -> Floats:
    """Read a section's line: a file with its corners, or ``x0,y0,x1,y1`` (and further corners).

    Raises
    ------
    InputError
        If there is no such file, a corner cannot be read, or the text is not a list of coordinates.
    """
    words = text.replace(";", ",").split(",")
    try:
        values = [float(word) for word in words]
    except ValueError:
        return _line_file(Path(text))
    if len(values) < 4 or len(values) % 2 or not all(map(math.isfinite, values)):
        raise InputError(
            message("project.section-line-numbers", "Numbers given for the section line: {count}", count=len(values)),
            message("project.give-two-corners", "Give x0,y0,x1,y1, metres; further corners add two numbers each."),
            value=text,
        )
    return np.array(values).reshape(-1, 2)


def _line_file(path: Path) -> Floats:
    from geofit.io.columns import BOUNDARY
    from geofit.io.journal import Journal
    from geofit.io.rows import read_rows
    from geofit.io.source import as_source

    if not path.is_file():
        raise InputError(
            message("data.file-missing", "There is no such file"),
            message("project.give-line-or-file", "Give a file with columns x and y, or x0,y0,x1,y1."),
            file=str(path),
        )
    journal = Journal()
    rows = read_rows(as_source(path), BOUNDARY, journal)
    corners = np.column_stack(rows.places())
    rows.close()
    bad = [issue for issue in journal.issues if issue.severity == "error"]
    if bad:
        raise InputError(bad[0].reason, bad[0].remedy, file=str(path), row=bad[0].row, value=bad[0].value)
    return np.asarray(corners[:, :2])

"""Sections drawn in 2D (distance along the section line against elevation), lifted to their place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import EMPTY, Message, message
from geofit.data.points import PointSet
from geofit.data.site import Section
from geofit.io.axes import Region, check_axes, place_in
from geofit.io.columns import SECTION, SECTION_LINES, SECTIONS, TRACES, Schema
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.polyline import along, chainage, named_lines
from geofit.io.rows import Rows, read_rows
from geofit.io.section_dxf import read_drawing
from geofit.io.source import Source

__all__ = ["Drawing", "lift", "load_level", "load_lines", "load_section", "load_sections", "off_line_reason"]

Floats = NDArray[np.float64]

#: A drawn point may lie this far beyond the ends of its section line, metres.
END_TOLERANCE = 0.01


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """How drawing units become metres: ``distance = (u - origin[0]) / scale``, elevation alike.

    ``scale`` is drawing units a metre (1000 for millimetres at 1:1), ``origin`` the drawing's coordinates of
    distance 0 and elevation 0.
    """

    scale: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)

    def metres(self, uv: Floats, unit: tuple[float, float] = (1.0, 1.0)) -> Floats:
        """Return (n, 2) drawing coordinates as distance and elevation.

        ``unit`` is the metres of one unit of each coordinate where ``uv`` was converted: the origin is not.
        """
        return np.asarray((uv - np.array(unit) * self.origin) / self.scale)


def lift(line: Floats, distance: Floats, elevation: Floats) -> Floats:
    """Return the places (n, 3) of points of a section whose line in plan is ``line`` (k, 2)."""
    return np.column_stack([along(line, distance), elevation])


def load_section(
    source: Source, section: Section, drawing: Drawing, horizons: HorizonNames, journal: Journal
) -> dict[str, PointSet]:
    """Read one section, CSV or DXF; points keep their order along the drawn line, kind "section".

    A point before the start or beyond the end of the section line is listed and not used.
    """
    if source.path.suffix.casefold() == ".dxf":
        return _from_dxf(source, section, drawing, horizons, journal)
    rows = read_rows(source, SECTION, journal)
    horizon = horizons.of(rows)
    uv = np.column_stack([rows.numbers("distance"), rows.numbers("elevation", no_data=True)])
    uv = drawing.metres(uv, (rows.factors.get("distance", 1.0), rows.factors.get("elevation", 1.0)))
    for i in np.flatnonzero(_off_line(section, uv[:, 0]) & rows.ok).tolist():
        rows.reject(i, "distance", *_off_line_text(section, uv[i, 0]))
    rows.close()
    return horizons.split(rows, horizon, lift(section.line, uv[:, 0], uv[:, 1]), kind="section", section=section.name)


def load_sections(
    source: Source,
    lines: Mapping[str, Floats],
    horizons: HorizonNames,
    journal: Journal,
    region: Region | None = None,
) -> tuple[list[Section], dict[str, PointSet]]:
    """Read one table of several sections: section, horizon, distance, elevation; points as :func:`load_section`.

    A section's line is that of ``lines``, else the straight line from x0, y0 to x1, y1 of its first row; rows
    of a section without a line are listed.
    """
    rows = read_rows(source, SECTIONS, journal)
    horizon, name = horizons.of(rows), np.array(rows.text("section"))
    distance, elevation = rows.numbers("distance"), rows.numbers("elevation", no_data=True)
    ends = _ends(rows, region)
    xyz = np.zeros((len(rows), 3))
    sections: list[Section] = []
    for each in dict.fromkeys(name[rows.ok].tolist()):
        own = np.flatnonzero(rows.ok & (name == each))
        line = lines.get(each)
        if line is None:
            line = _own_line(rows, own, ends)
        if line is None:
            for i in own.tolist():
                rows.reject(
                    i,
                    "section",
                    message("io.named-section-without-line", "Section {section} has no line in plan", section=each),
                    _NO_LINE,
                )
            continue
        section, own = Section(each, line), own[rows.ok[own]]
        for i in own[_off_line(section, distance[own])].tolist():
            rows.reject(i, "distance", *_off_line_text(section, distance[i]))
        xyz[own] = lift(line, distance[own], elevation[own])
        sections.append(section)
    rows.close()
    rows.require_any()
    return sections, horizons.split(rows, horizon, xyz, kind="section", section=name)


_NO_LINE = message(
    "io.add-section-corners",
    "Add its corners to [[section_lines]] (section, x, y), or columns x0, y0, x1, y1 with the ends of its line.",
)


def _ends(rows: Rows, region: Region | None) -> Floats:
    """Return the ends (n, 4) of the rows' own section lines; nan where a table has none."""
    if not {"x0", "y0", "x1", "y1"} <= set(rows.columns):
        return np.full((len(rows), 4), np.nan)
    ends = np.column_stack([rows.numbers(role, required=False) for role in ("x0", "y0", "x1", "y1")])
    known = np.isfinite(ends).all(axis=1)
    if region is not None and known.any() and place_in(ends[known][:, :2], region) == "exchanged":
        raise InputError(
            message("io.section-axes-exchanged", "x and y of the section lines appear to be exchanged"),
            message("io.x-is-easting", "x is the easting, y the northing."),
            file=rows.file,
        )
    return ends


def _own_line(rows: Rows, own: NDArray[np.intp], ends: Floats) -> Floats | None:
    """Return the line that the rows of a section state; rows that state another one are listed."""
    stated = own[np.isfinite(ends[own]).all(axis=1)]
    if not stated.size or np.array_equal(ends[stated[0], :2], ends[stated[0], 2:]):
        return None
    for i in stated[(ends[stated] != ends[stated[0]]).any(axis=1)].tolist():
        reason = message(
            "io.section-line-contradicts",
            "The row states another section line than row {row}",
            row=rows.line[stated[0]],
        )
        rows.reject(
            i,
            "x0",
            reason,
            message(
                "io.section-line-bent",
                "All rows of a section must state the same line; give bent lines in [[section_lines]].",
            ),
        )
    return np.asarray(ends[stated[0]].reshape(2, 2))


def load_lines(source: Source, journal: Journal, region: Region | None = None) -> dict[str, Floats]:
    """Read the lines of sections in plan: rows of one section are its corners in order.

    Returns
    -------
    dict of str to (k, 2) array
        Corners of each section; one with less than two different corners is listed.
    """
    rows = read_rows(source, SECTION_LINES, journal)
    x, y = rows.places()
    check_axes(rows, x, y, region)
    lines = named_lines(rows, "section", np.column_stack([x, y]), "The line of section")
    rows.close()
    return lines


def load_level(
    source: Source,
    elevation: float,
    drawing: Drawing,
    horizons: HorizonNames,
    journal: Journal,
    region: Region | None = None,
) -> dict[str, PointSet]:
    """Read a plan drawn at one level, DXF or a table of horizon, x, y; kind "section".

    ``drawing`` turns the drawing's coordinates into easting and northing.
    """
    section = f"level {elevation:g}"
    if source.path.suffix.casefold() == ".dxf":
        drawn = read_drawing(source, horizons, journal, scale_stated=drawing.scale != 1.0)
        xy = drawing.metres(drawn.uv, (drawn.unit, drawn.unit))
        journal.count(source.name, len(xy) + drawn.listed, drawn.listed)
        xyz, names = np.column_stack([xy, np.full(len(xy), elevation)]), np.array(drawn.horizon, dtype=np.str_)
        return {
            name: PointSet(
                xyz[names == name], kind="section", section=section, row=drawn.number[names == name], file=source.name
            )
            for name in dict.fromkeys(names.tolist())
        }
    rows = read_rows(source, Schema("traces", TRACES.required, {}), journal)
    horizon = horizons.of(rows)
    unit = (rows.factors.get("x", 1.0), rows.factors.get("y", 1.0))
    x, y = drawing.metres(np.column_stack(rows.places()), unit).T
    check_axes(rows, x, y, region)
    rows.close()
    xyz = np.column_stack([x, y, np.full(len(rows), elevation)])
    return horizons.split(rows, horizon, xyz, kind="section", section=section)


def _from_dxf(
    source: Source, section: Section, drawing: Drawing, horizons: HorizonNames, journal: Journal
) -> dict[str, PointSet]:
    drawn = read_drawing(source, horizons, journal, scale_stated=drawing.scale != 1.0)
    uv = drawing.metres(drawn.uv, (drawn.unit, drawn.unit))
    off = _off_line(section, uv[:, 0])
    for i in np.flatnonzero(off).tolist():
        reason, remedy = _off_line_text(section, uv[i, 0])
        journal.add(
            "error",
            source.name,
            reason,
            remedy,
            row=int(drawn.number[i]),
            column=drawn.horizon[i],
            value=f"{drawn.uv[i, 0]:.15g}",
        )
    journal.count(source.name, len(uv) + drawn.listed, drawn.listed + int(off.sum()))
    xyz = lift(section.line, uv[:, 0], uv[:, 1])
    names = np.array(drawn.horizon, dtype=np.str_)
    return {
        name: PointSet(xyz[chosen], kind="section", section=section.name, row=drawn.number[chosen], file=source.name)
        for name in dict.fromkeys(names[~off].tolist())
        for chosen in [np.flatnonzero((names == name) & ~off)]
    }


def _off_line(section: Section, distance: Floats) -> NDArray[np.bool_]:
    length = chainage(section.line)[-1]
    return np.asarray((distance < -END_TOLERANCE) | (distance > length + END_TOLERANCE))


def off_line_reason(section: Section, distance: Floats) -> tuple[Message, Message]:
    """Return why distances (n,) are not all on the line of a section, and the remedy; empty where they are."""
    off = np.flatnonzero(_off_line(section, distance))
    return _off_line_text(section, float(distance[off[0]])) if len(off) else (EMPTY, EMPTY)


def _off_line_text(section: Section, distance: float) -> tuple[Message, Message]:
    length = chainage(section.line)[-1]
    return (
        message(
            "io.distance-off-section",
            "The distance {distance:.2f} m is not on the line of section {section} ({length:.2f} m long)",
            distance=distance,
            section=section.name,
            length=length,
        ),
        message("io.correct-distance-or-line", "Correct the distance, the line, or the drawing's scale and origin."),
    )

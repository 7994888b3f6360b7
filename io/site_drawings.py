"""Drawings of a site file: sections along their lines, and plans at their levels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Message, Untranslated, message
from geofit.data.points import PointSet
from geofit.data.site import Section
from geofit.io.axes import Region, place_in
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.sections import Drawing, load_level, load_lines, load_section, load_sections
from geofit.io.site_keys import Reader
from geofit.io.source import Source

__all__ = ["gather", "placed_levels", "placed_sections", "plan_lines", "read_sections"]

Floats = NDArray[np.float64]


def plan_lines(
    reader: Reader, top: Mapping[str, Any], journal: Journal, region: Region | None = None
) -> dict[str, Floats]:
    """Return the lines of sections in plan that the [section_lines] tables hold."""
    lines: dict[str, Floats] = {}
    for table in reader.tables(top, "section_lines"):
        lines |= load_lines(reader.source(table, "[section_lines]", kind="section lines"), journal, region)
    return lines


def placed_sections(
    reader: Reader, top: Mapping[str, Any], lines: Mapping[str, Floats], region: Region | None = None
) -> Iterator[tuple[Section, Source, Drawing]]:
    """Return each [[section]] with its line in plan, its file, and what the coordinates of its drawing are.

    Raises
    ------
    InputError
        If a section has no name or no line, or two have one name.
    """
    taken: set[str] = set()
    for table in reader.tables(top, "section"):
        name = reader.need(table, "name", str, "[[section]]", message("io.write-name", 'Write name = "...".'))
        where = message("io.section", "section '{name}'", name=name)
        if name in taken:
            raise reader.fail(
                message("io.section-name-repeated", "Two sections have the name '{name}'", name=name),
                message("io.give-each-own-name", "Give each its own name."),
                "name",
            )
        taken.add(name)
        source = reader.source(table, where, ("name", "line", "scale", "origin"), "section")
        remedy = message("io.write-line", "Write line = [[x, y], [x, y]], the corners of the section line in plan.")
        if "line" not in table and name in lines:
            line = lines[name]
        else:
            line = _pairs(
                reader,
                reader.need(table, "line", list, where, remedy),
                message("io.line", "line of {where}", where=where),
                remedy,
            )
        if len(line) < 2 or not (np.diff(line, axis=0) != 0).any(axis=1).all():
            raise reader.fail(
                message(
                    "io.line-too-short",
                    "The line of {where} needs two or more different corners",
                    where=where,
                ),
                remedy,
                "line",
                line.tolist(),
            )
        _check_line(reader, line, where, region)
        yield Section(name, line), source, _drawing(reader, table, where)


def placed_levels(reader: Reader, top: Mapping[str, Any]) -> Iterator[tuple[float, Source, Drawing]]:
    """Return the elevation of each [[level]], its file, and what the coordinates of its drawing are."""
    for table in reader.tables(top, "level"):
        elevation = reader.get(table, "elevation", float, "[[level]]")
        if elevation is None:
            raise reader.fail(
                message("io.level-no-elevation", "A [[level]] has no elevation"),
                message("io.write-elevation-1200", "Write elevation = 1200.0."),
                "elevation",
            )
        where = message("io.level", "level {elevation:g}", elevation=elevation)
        source = reader.source(table, where, ("elevation", "scale", "origin"), "traces")
        yield elevation, source, _drawing(reader, table, where)


def read_sections(
    reader: Reader,
    top: Mapping[str, Any],
    names: HorizonNames,
    journal: Journal,
    region: Region | None,
    gathered: dict[str, list[PointSet]],
) -> tuple[Section, ...]:
    """Read the section lines, the [[section]] and the [[level]] tables; points go to ``gathered``."""
    lines = plan_lines(reader, top, journal, region)
    sections: list[Section] = []
    for section, source, drawing in placed_sections(reader, top, lines, region):
        sections.append(section)
        _warn_of_far_line(section, region, reader.file, journal)
        gather(gathered, load_section(source, section, drawing, names, journal))
    for table in reader.tables(top, "sections"):
        source = reader.source(table, "[sections]", kind="sections")
        found, points = load_sections(source, lines, names, journal, region)
        for one in found:
            if any(section.name == one.name for section in sections):
                raise InputError(
                    message("io.section-name-repeated", "Two sections have the name '{name}'", name=one.name),
                    message("io.give-each-own-name", "Give each its own name."),
                    file=source.name,
                )
        sections += found
        gather(gathered, points)
    for elevation, source, drawing in placed_levels(reader, top):
        gather(gathered, load_level(source, elevation, drawing, names, journal, region))
    return tuple(sections)


def _drawing(reader: Reader, table: Mapping[str, Any], where: Message | str) -> Drawing:
    scale = reader.get(table, "scale", float, where)
    if scale is not None and scale <= 0:
        raise reader.fail(
            message("io.scale-not-positive", "scale in {where} must be above 0", where=where),
            message("io.give-drawing-units-metre", "Give the number of drawing units per metre."),
            "scale",
            scale,
        )
    remedy = message(
        "io.write-origin", "Write origin = [u, v], the drawing's coordinates of distance 0 and elevation 0."
    )
    origin = _pairs(
        reader, [table.get("origin", [0.0, 0.0])], message("io.origin", "origin of {where}", where=where), remedy
    )[0]
    return Drawing(scale=1.0 if scale is None else scale, origin=(float(origin[0]), float(origin[1])))


def _pairs(reader: Reader, value: Any, where: Message | str, remedy: Message) -> Floats:
    try:
        pairs = np.array(value, dtype=np.float64)
    except (ValueError, TypeError):
        pairs = np.empty(0)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not np.isfinite(pairs).all():
        raise reader.fail(
            message("io.not-finite-pairs", "The {where} is not a list of finite pairs", where=where),
            remedy,
            value=value,
        )
    return pairs


def _check_line(reader: Reader, line: Floats, where: Message | str, region: Region | None) -> None:
    if region is not None and place_in(line, region) == "exchanged":
        raise reader.fail(
            message(
                "io.line-axes-exchanged",
                "x and y appear to be exchanged in the line of {where}: it lies far outside the study "
                "area, and inside it with x and y swapped",
                where=where,
            ),
            message("io.x-is-easting", "x is the easting, y the northing."),
            "line",
            line.tolist(),
        )


def _warn_of_far_line(section: Section, region: Region | None, file: str, journal: Journal) -> None:
    """Warn of a section line that lies far off the study area: all points of the section do, too."""
    if region is None or place_in(section.line, region) != "off":
        return
    x, y = section.line.mean(axis=0)
    journal.add(
        "warning",
        file,
        message(
            "io.line-far-outside",
            "The line of section '{name}' lies far outside the study area, around x = {x:.10g}, y = {y:.10g}",
            name=Untranslated(section.name),
            x=x,
            y=y,
        ),
        message(
            "io.line-in-metres",
            "Check its corners and the boundary; under line they are metres, whatever the unit of the site.",
        ),
        column="line",
        value=section.name,
    )


def gather(gathered: dict[str, list[PointSet]], found: Mapping[str, PointSet]) -> None:
    """Add the points of each horizon that were found to those gathered."""
    for name, points in found.items():
        gathered.setdefault(name, []).append(points)

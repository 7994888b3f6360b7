"""Closed outlines of a body in drawings of a site file: each section flat along its line, each plan at its level.

They are placed as the lines of horizons in the same drawings are (:mod:`geofit.io.sections`).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.io.added_tables import with_tables
from geofit.io.dxf import closed_lines
from geofit.io.journal import Journal
from geofit.io.mapping import load_mappings
from geofit.io.sections import Drawing, lift, off_line_reason
from geofit.io.site_drawings import placed_levels, placed_sections, plan_lines
from geofit.io.site_keys import Reader
from geofit.io.source import Source

__all__ = ["site_outlines"]

Floats = NDArray[np.float64]


def site_outlines(source: Source, journal: Journal) -> list[tuple[str, Floats, str]]:
    """Return the closed lines in the drawings of a site file: layer, corners (k, 3) in map metres, name of section.

    An outline that leaves the line of its section is listed, as are tables and everything that is not closed.

    Raises
    ------
    InputError
        If the site file or a drawing cannot be read, or no [[section]] or [[level]] names a drawing.
    """
    top = with_tables(journal.read(source), (), source.name)
    reader = Reader(source.path)
    label = reader.get(top, "site", dict, "the site file") or {}
    reader.unit = reader.get(label, "unit", str, "[site]")
    if mapping := reader.get(label, "mapping", str, "[site]"):
        reader.mappings = load_mappings(source.path.parent / mapping)
    rings: list[tuple[str, Floats, str]] = []
    drawings = 0
    for section, file, drawing in placed_sections(reader, top, plan_lines(reader, top, journal)):
        if not _is_drawing(file):
            continue
        drawings += 1
        for number, (layer, uv) in enumerate(_closed(file, drawing, journal), 1):
            reason, remedy = off_line_reason(section, uv[:, 0])
            if reason:
                _leave(journal, file, number, layer, reason, remedy)
            else:
                rings.append((layer, lift(section.line, uv[:, 0], uv[:, 1]), section.name))
    for elevation, file, drawing in placed_levels(reader, top):
        if not _is_drawing(file):
            continue
        drawings += 1
        for layer, xy in _closed(file, drawing, journal):
            rings.append((layer, np.column_stack([xy, np.full(len(xy), elevation)]), f"level {elevation:g}"))
    if not drawings:
        raise InputError(
            message("io.site-without-drawing", "No [[section]] or [[level]] of the site file names a drawing"),
            message("io.give-section-drawing", "Give each section: name, line in plan, DXF file, scale and origin."),
            file=source.name,
        )
    return rings


def _is_drawing(source: Source) -> bool:
    """Return whether a section is drawn: a table of its points has no closed lines."""
    return Path(source.name).suffix.casefold() == ".dxf"


def _closed(source: Source, drawing: Drawing, journal: Journal) -> list[tuple[str, Floats]]:
    lines, unit = closed_lines(source, journal, scale_stated=drawing.scale != 1.0, with_open_lines=True)
    return [(line.layer, drawing.metres(line.xyz[:, :2], (unit, unit))) for line in lines]


def _leave(journal: Journal, source: Source, number: int, layer: str, reason: Message, remedy: Message) -> None:
    journal.add("error", source.name, reason, remedy, row=number, column=layer)

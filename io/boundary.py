"""The study area: corners of a polygon from a table or a GeoJSON file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.geometry.area import fault_of_area
from geofit.io.columns import BOUNDARY
from geofit.io.journal import Journal
from geofit.io.parser_errors import parser_message
from geofit.io.rows import read_rows
from geofit.io.sniff import decode
from geofit.io.source import Source, as_source
from geofit.io.vector import RING

__all__ = ["load_boundary", "read_boundary"]

Floats = NDArray[np.float64]


def read_boundary(path: str | Path | Source) -> Floats:
    """Read the corners of the study area.

    Parameters
    ----------
    path : path or Source
        A table with the columns x and y, corners in order; or a GeoJSON polygon (``.json``, ``.geojson``).

    Returns
    -------
    (k, 2) array
        Corners in map coordinates, metres, in order, the first not repeated.

    Raises
    ------
    InputError
        If a corner cannot be read, there are fewer than three, or the boundary crosses itself.

    Notes
    -----
    Formats: ``docs/formats_in.md``.
    """
    return load_boundary(as_source(path), Journal())


def load_boundary(source: Source, journal: Journal) -> Floats:
    """Read the study area; the journal receives the guesses."""
    if source.path.suffix.casefold() in (".json", ".geojson") and not source.target:
        corners = _from_geojson(source, journal)
        journal.count(source.name, len(corners), 0)
    else:
        corners = _from_table(source, journal)
    if len(corners) > 1 and np.array_equal(corners[0], corners[-1]):
        corners = corners[:-1]
        journal.add(
            "note",
            source.name,
            message(
                "import.last-corner-repeats-first",
                "The last corner repeats the first; the boundary is closed without it",
            ),
        )
    _check(corners, source.name)
    return corners


def _from_table(source: Source, journal: Journal) -> Floats:
    before = len(journal.issues)
    rows = read_rows(source, BOUNDARY, journal)
    corners = np.column_stack(rows.places())
    if RING in rows.table.header and len(set(rows.table.columns[rows.table.header.index(RING)])) > 1:
        raise InputError(
            message(
                "import.map-several-lines-rings",
                "The map has several lines or rings; one polygon without holes is needed",
            ),
            message("import.export-outline-study-area", "Export the outline of the study area alone."),
            file=source.name,
        )
    rows.close()
    if rows.table.read > rows.ok.sum():
        bad = next(issue for issue in journal.issues[before:] if issue.severity == "error")
        raise InputError(
            message(
                "import.corner-boundary-cannot-read",
                "A corner of the boundary cannot be read: {reason}",
                reason=bad.reason,
            ),
            bad.remedy,
            file=source.name,
            row=bad.row,
            column=bad.column or None,
            value=bad.value,
        )
    return corners


def _from_geojson(source: Source, journal: Journal) -> Floats:
    text, _ = decode(journal.read(source), source.name, source.encoding)
    try:
        rings = _rings(json.loads(text))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        what, line = parser_message(error)
        raise InputError(
            message("import.no-geojson-polygon", "This is not a valid GeoJSON polygon: {error}", error=what),
            message("import.export-polygon-without-holes", "Export one polygon without holes."),
            file=source.name,
            row=line,
        ) from None
    if len(rings) != 1:
        raise InputError(
            message(
                "import.file-rings-polygon-without",
                "The file has {count} rings; one polygon without holes is needed",
                count=len(rings),
            ),
            message("import.export-outline-study-area", "Export the outline of the study area alone."),
            file=source.name,
        )
    try:
        corners = np.array([corner[:2] for corner in rings[0]], dtype=np.float64)
    except (ValueError, TypeError, OverflowError):
        corners = np.empty((0, 0))
    if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        raise InputError(
            message("import.corner-polygon-no-pair", "A corner of the polygon is not a pair of finite numbers"),
            message("import.export-polygon-again", "Export the polygon again."),
            file=source.name,
        )
    if np.abs(corners[:, 0]).max() <= 180.0 and np.abs(corners[:, 1]).max() <= 90.0:
        journal.add(
            "warning",
            source.name,
            message(
                "import.corners-longitude-latitude-read",
                "The corners may be longitude and latitude; they are read as metres",
            ),
            message("import.project-site-grid-degrees", "Project them to the site's grid where they are degrees."),
        )
    return corners


def _rings(node: Any) -> list[Any]:
    match node.get("type"):
        case "FeatureCollection":
            return [ring for feature in node["features"] for ring in _rings(feature)]
        case "Feature":
            return _rings(node["geometry"])
        case "Polygon":
            return list(node["coordinates"])
        case "MultiPolygon":
            return [ring for polygon in node["coordinates"] for ring in polygon]
    raise ValueError(f"its type is {node.get('type')!r}")


def _check(corners: Floats, name: str) -> None:
    fault = fault_of_area(corners)
    if fault is not None:
        raise InputError(
            fault,
            message("import.list-corners-order-around", "List the corners in order around the study area, each once."),
            file=name,
        )

"""The study area: corners of a polygon from a table or a GeoJSON file."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.geometry.area import fault_of_area
from geofit.io.columns import BOUNDARY
from geofit.io.crs import list_system
from geofit.io.journal import Journal
from geofit.io.parser_errors import parser_message
from geofit.io.rows import read_rows
from geofit.io.sniff import decode
from geofit.io.source import Source, as_source
from geofit.io.units import map_units
from geofit.io.vector import RING

__all__ = ["load_boundary", "read_boundary"]

Floats = NDArray[np.float64]


@arguments_checked
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
                "io.boundary-closed-already",
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
                "io.map-of-several-rings",
                "The map has several lines or rings; one polygon without holes is needed",
            ),
            message("io.export-outline-alone", "Export the outline of the study area alone."),
            file=source.name,
        )
    rows.close()
    if rows.table.read > rows.ok.sum():
        bad = next(issue for issue in journal.issues[before:] if issue.severity == "error")
        raise InputError(
            message(
                "io.boundary-corner-unreadable",
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
        top = json.loads(text)
        rings, crs = _rings(top), _system_of(top)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        what, line = parser_message(error)
        raise InputError(
            message("io.geojson-invalid", "This is not a valid GeoJSON polygon: {error}", error=what),
            message("io.export-polygon-without-holes", "Export one polygon without holes."),
            file=source.name,
            row=line,
        ) from None
    if len(rings) != 1:
        raise InputError(
            message(
                "io.file-of-several-rings",
                "The file has {count} rings; one polygon without holes is needed",
                count=len(rings),
            ),
            message("io.export-outline-alone", "Export the outline of the study area alone."),
            file=source.name,
        )
    try:
        corners = np.array([corner[:2] for corner in rings[0]], dtype=np.float64)
    except (ValueError, TypeError, OverflowError):
        corners = np.empty((0, 0))
    if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        raise InputError(
            message("io.polygon-corner-not-finite", "A corner of the polygon is not a pair of finite numbers"),
            message("io.export-polygon-again", "Export the polygon again."),
            file=source.name,
        )
    if np.abs(corners[:, 0]).max() <= 180.0 and np.abs(corners[:, 1]).max() <= 90.0:
        journal.add(
            "warning",
            source.name,
            message(
                "io.corners-maybe-degrees",
                "The corners may be longitude and latitude; they are read as metres",
            ),
            message("io.project-degrees", "If they are degrees, project them to the site's grid."),
        )
    corners *= map_units(source, crs, journal)[0]
    if crs:
        list_system(crs, corners[:, 0], corners[:, 1], source.name, journal)
    return corners


def _system_of(top: dict[str, Any]) -> str:
    """Return the code of the coordinate system that GeoJSON states, as was usual before RFC 7946; empty if none."""
    crs = top.get("crs")
    name = str((crs.get("properties") or {}).get("name") or "") if isinstance(crs, dict) else ""
    return re.sub(r"(?i)^urn:ogc:def:crs:(\w+):[^:]*:", r"\1:", name)


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
            message("io.list-corners-in-order", "List the corners in order around the study area, each once."),
            file=name,
        )

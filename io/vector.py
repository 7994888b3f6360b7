"""Map features: points, lines and polygons of shapefile, GeoPackage, GeoJSON (pyogrio, extra ``gis``)."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.io.cells import number_text, table_of
from geofit.io.crs import WGS84, refuse_degrees
from geofit.io.extra import need
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import Table

__all__ = ["RING", "layer_names", "read_features"]

#: Header of the column with the running number of the line or ring that a vertex belongs to.
RING = "ring"
#: The system of GeoJSON that states none, as GDAL names it: with elevations it is another one.
_OF_GEOJSON = (WGS84, "EPSG:4979")
#: How a shapefile, a GeoPackage and GeoJSON begin.
_BEGINNINGS = (b"\x00\x00\x27\x0a", b"SQLite format 3\x00", b"{")


def layer_names(source: Source) -> tuple[str, ...]:
    """Return the layers of a file that have a geometry."""
    data = source.read()
    pyogrio = need("pyogrio", "gis", message("io.reading-map", "Reading the map {file}", file=source.name))
    _recognise(source, data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of endings that do not suit the format
            layers = pyogrio.list_layers(source.path)
    except (pyogrio.errors.DataSourceError, OSError, ValueError):
        raise _damaged(source) from None
    return tuple(str(name) for name, geometry in layers if geometry is not None)


def read_features(source: Source, journal: Journal) -> Table:
    """Read the vertices with the columns x, y, z (where they have one), ring, and the features' attributes.

    The row of a vertex is the number of its feature, from 1. The table's ``crs`` is that of the layer.

    Raises
    ------
    InputError
        If the file cannot be read, or the places are longitude and latitude and no target system is named.
    """
    data = journal.read(source)
    pyogrio = need("pyogrio", "gis", message("io.reading-map", "Reading the map {file}", file=source.name))
    _recognise(source, data)
    import shapely

    layers = layer_names(source) if source.table else ()
    if source.table and source.table.casefold() not in map(str.casefold, layers):
        raise InputError(
            message(
                "io.layer-missing",
                "The map has no layer '{name}'; its layers are {names}",
                name=Untranslated(source.table),
                names=", ".join(layers) or message("data.none", "none"),
            ),
            message("data.name-one", "Name one of them."),
            file=source.name,
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            meta, _, wkb, fields = pyogrio.raw.read(source.path, layer=source.table or None)
        shapes = shapely.from_wkb(wkb) if wkb is not None else np.array([])
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError, shapely.GEOSException):
        raise _damaged(source) from None
    except (OSError, ValueError, RuntimeError, UnicodeError):
        raise _damaged(source) from None
    crs = str(meta.get("crs") or "")
    if crs in _OF_GEOJSON and data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") and not _may_be_degrees(shapes):
        crs = ""
        journal.add(
            "note",
            source.name,
            message(
                "io.geojson-not-degrees",
                "GeoJSON is in longitude and latitude if it states no coordinate system, but these places cannot be; "
                "they are taken as coordinates of the site",
            ),
        )
    if crs:
        journal.add(
            "note",
            source.name,
            message("io.crs-of-layer", "The coordinate system of the layer is {crs}", crs=crs[:120]),
        )
    if crs and not source.crs and not source.target:
        refuse_degrees(crs, source.name)
    attributes = [str(name) for name in meta["fields"]]
    rows: list[tuple[int, list[str]]] = []
    malformed = rings = 0
    deep = bool(shapely.has_z(shapes).any()) if len(shapes) else False
    for i, shape in enumerate(shapes):
        own = [_text(column[i]) for column in fields]
        lines = [] if shape is None else _rings(shape)
        if not any(len(line) for line in lines):
            malformed += 1
            journal.add(
                "error",
                source.name,
                message("io.feature-without-location", "The feature has no location"),
                message("io.draw-again", "Draw it again."),
                row=i + 1,
            )
        for line in lines:
            rings += 1
            for vertex in line:
                place = [number_text(float(value)) for value in (vertex if deep else vertex[:2])]
                rows.append((i + 1, [*place, str(rings), *own]))
    header = [*(("x", "y", "z") if deep else ("x", "y")), RING]
    # An attribute that is called like a coordinate stays, under another name.
    header += [f"{name} (attribute)" if name.casefold() in {"x", "y", "z", RING} else name for name in attributes]
    return table_of(source, journal, header, rows, malformed=malformed, crs=crs)


def _may_be_degrees(shapes: Any) -> bool:
    """Whether all places may be longitude and latitude."""
    import shapely

    places = np.abs(shapely.get_coordinates(shapes))
    return bool((places <= (360.0, 90.0)).all())


def _recognise(source: Source, data: bytes) -> None:
    """Refuse other contents: GDAL goes by them, not by the ending, and some formats name files elsewhere."""
    if not data.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(_BEGINNINGS):
        raise InputError(
            message("io.map-format-unknown", "The file is not a shapefile, GeoPackage or GeoJSON"),
            message("io.save-as-geopackage", "Open it in a GIS and save it as GeoPackage."),
            file=source.name,
        )


def _rings(shape: Any) -> list[Any]:
    """Return the vertices of each part: points, lines, outer and inner rings."""
    import shapely

    if hasattr(shape, "geoms"):
        return [line for part in shape.geoms for line in _rings(part)]
    if shape.geom_type == "Polygon":
        return [_vertices(ring) for ring in (shape.exterior, *shape.interiors)] if not shape.is_empty else []
    return [_vertices(shape)] if shapely.get_num_coordinates(shape) else []


def _vertices(shape: Any) -> Any:
    import shapely

    return shapely.get_coordinates(shape, include_z=True)


def _text(value: Any) -> str:
    if value is None or value != value:
        return ""
    return number_text(float(value)) if isinstance(value, (int, float, np.number)) else str(value)


def _damaged(source: Source) -> InputError:
    return InputError(
        message("io.map-unreadable", "The map is damaged or incomplete"),
        message("io.save-as-geopackage", "Open it in a GIS and save it as GeoPackage."),
        file=source.name,
    )

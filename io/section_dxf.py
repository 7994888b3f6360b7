"""Horizon lines of a section drawing in DXF: the layer names the horizon."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.errors import InputError
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.source import Source

__all__ = ["Drawn", "read_drawing"]

#: $INSUNITS of the units that are not metres, and drawing units a metre.
_UNITS = {1: ("inches", 39.3701), 2: ("feet", 3.28084), 4: ("millimetres", 1000.0), 5: ("centimetres", 100.0)}


@dataclass(frozen=True, eq=False)
class Drawn:
    """Vertices of the horizon lines in drawing order.

    ``uv`` (n, 2) in drawing units, ``horizon`` the name of each, ``number`` its running number among all
    points of the drawing, from 1; ``listed`` counts what stands on other layers or cannot be used.
    """

    uv: NDArray[np.float64]
    horizon: list[str]
    number: NDArray[np.int64]
    listed: int


@dataclass(frozen=True)
class _Entity:
    type: str
    layer: str
    vertices: list[tuple[float, float]]
    closed: bool
    arcs: bool


def read_drawing(source: Source, horizons: HorizonNames, journal: Journal, *, scale_stated: bool) -> Drawn:
    """Read LWPOLYLINE, POLYLINE, LINE and POINT of the model space; everything else is listed."""
    unit, entities = _open(source, journal)
    if unit in _UNITS and not scale_stated:
        name, per_metre = _UNITS[unit]
        journal.add(
            "warning",
            source.name,
            f"The drawing says that its unit is {name}; it is read as metres",
            f"State scale = {per_metre:g} where that is so.",
        )
    uv: list[tuple[float, float]] = []
    names: list[str] = []
    numbers: list[int] = []
    count = listed = 0
    for entity in entities:
        layer, vertices = entity.layer, entity.vertices
        horizon = horizons.match(layer.strip())
        size = max(len(vertices), 1)
        problem = _problem(entity)
        if horizon is None or problem:
            reason = problem if horizon is not None else f"Layer '{layer}' is no horizon of the site"
            journal.add(
                "error" if horizon is not None else "note",
                source.name,
                f"{reason}; {entity.type} with {size} points is not used",
                "Draw the horizon as a polyline on the layer with its name.",
                row=count + 1,
                column=layer,
                value=entity.type,
            )
            listed, count = listed + size, count + size
            continue
        if entity.arcs:
            journal.add(
                "warning",
                source.name,
                "The polyline has arcs; only its corners are used",
                "Add corners along the arcs.",
                row=count + 1,
                column=layer,
            )
        for vertex in vertices:
            count += 1
            if uv and names[-1] == horizon and uv[-1] == vertex:
                journal.add("note", source.name, "The point repeats the one before", row=count, column=layer)
                listed += 1
                continue
            uv.append(vertex)
            names.append(horizon)
            numbers.append(count)
    return Drawn(np.array(uv, dtype=np.float64).reshape(-1, 2), names, np.array(numbers, dtype=np.int64), listed)


def _open(source: Source, journal: Journal) -> tuple[int, list[_Entity]]:
    """Return the drawing's unit and the entities of its model space."""
    import ezdxf

    journal.read(source)
    # What ezdxf raises on a damaged file is not limited to its own errors.
    failures = (
        ezdxf.DXFError,
        ArithmeticError,
        AssertionError,
        AttributeError,
        LookupError,
        OSError,
        RuntimeError,
        StopIteration,
        TypeError,
        ValueError,
    )
    try:
        document = ezdxf.readfile(source.path, encoding=source.encoding)
        entities = [
            _Entity(
                entity.dxftype(),
                str(entity.dxf.layer),
                _vertices(entity),
                getattr(entity, "closed", False) is True or getattr(entity, "is_closed", False) is True,
                entity.dxftype() in ("LWPOLYLINE", "POLYLINE") and bool(getattr(entity, "has_arc", False)),
            )
            for entity in document.modelspace()
        ]
        return int(document.header.get("$INSUNITS", 0)), entities
    except failures as error:
        raise InputError(
            f"The drawing cannot be read: {error or type(error).__name__}",
            "Open it in CAD, audit it and save it as DXF (2007 or later).",
            file=source.name,
        ) from None


def _vertices(entity: Any) -> list[tuple[float, float]]:
    kind = entity.dxftype()
    if kind == "LWPOLYLINE":
        points = [(p[0], p[1]) for p in entity.get_points("xy")]
    elif kind == "POLYLINE" and (entity.is_2d_polyline or entity.is_3d_polyline):
        points = [(v.dxf.location.x, v.dxf.location.y) for v in entity.vertices]
    elif kind == "LINE":
        points = [(p.x, p.y) for p in (entity.dxf.start, entity.dxf.end)]
    elif kind == "POINT":
        points = [(entity.dxf.location.x, entity.dxf.location.y)]
    else:
        points = []
    return [(float(u), float(v)) for u, v in points]


def _problem(entity: _Entity) -> str:
    if not entity.vertices:
        return f"A {entity.type} is no LWPOLYLINE, POLYLINE, LINE or POINT"
    if not np.isfinite(entity.vertices).all():
        return "A coordinate is no finite number"
    if entity.closed:
        return "The polyline is closed, a horizon line is open"
    return ""

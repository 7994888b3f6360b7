"""Entities of a DXF drawing's model space: lines with their vertices, texts and blocks with their words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.legible import legible
from geofit.data.messages import EMPTY, Message, message
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.units import METRES, grid_unit, metres_of

__all__ = [
    "EXPLODE",
    "LINES",
    "ClosedLine",
    "Entity",
    "closed_lines",
    "count_points",
    "on_layers",
    "open_drawing",
    "problem",
]

#: Types that are read as points in their order; and those whose words name a place.
LINES, WORDS = ("LWPOLYLINE", "POLYLINE", "LINE", "POINT"), ("TEXT", "MTEXT", "INSERT")
#: Types that may be closed lines, and how far corners along an arc may lie off it, as a share of the line's size.
CLOSABLE, ARC = ("LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE"), 0.002

#: What is said of lines in blocks.
BLOCK = message("io.block-not-read", "Lines in a block are not read")
EXPLODE = message("io.explode-block", "Explode the block in CAD.")

#: $INSUNITS of the units that are not metres: what they are called, and the metres of one.
_UNITS = {
    1: ("inches", 0.0254),
    2: ("feet", METRES["ft"]),
    3: ("miles", 1609.344),
    4: ("millimetres", METRES["mm"]),
    5: ("centimetres", METRES["cm"]),
    7: ("kilometres", METRES["km"]),
    10: ("yards", 0.9144),
    21: ("US survey feet", METRES["ft-us"]),
}
#: Those with which CAD begins every drawing, whatever is drawn in it: they state nothing.
_OF_TEMPLATES = (1, 4)


@dataclass(frozen=True)
class Entity:
    """One entity: ``vertices`` (x, y, z) in drawing units, ``words`` of a text or block, ``first`` its first number.

    ``size`` counts its points, 1 for an entity without any; z is nan where a whole entity lies at 0; ``inside`` holds
    the layers of the lines in a block.
    """

    type: str
    layer: str
    vertices: tuple[tuple[float, float, float], ...]
    closed: bool = False
    arcs: bool = False
    words: str = ""
    first: int = 1
    inside: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Points that the entity counts for."""
        return max(len(self.vertices), 1)


@dataclass(frozen=True, eq=False)
class ClosedLine:
    """A closed line: its layer and its corners (k, 3), metres; the last one is not the first again."""

    layer: str
    xyz: NDArray[np.float64]


def open_drawing(source: Source, journal: Journal, *, scale_stated: bool = False) -> tuple[list[Entity], float]:
    """Return the entities of the model space in metres, and the metres of one unit of the drawing.

    The unit is that of ``source``; else, unless a scale is stated, the drawing's own, with a warning.

    Raises
    ------
    InputError
        If the file is missing, or no drawing that can be read.
    """
    journal.read(source)
    with _readable(source):
        document = _document(source)
        factor = _unit(document, source, journal, scale_stated)
        entities, first = [], 1
        for raw in document.modelspace():
            entity = _entity(raw, first, factor)
            entities.append(entity)
            first += entity.size
        _warn_of_paper(document, source, journal)
    return entities, factor


def closed_lines(
    source: Source, journal: Journal, *, scale_stated: bool = False, with_open_lines: bool = False
) -> tuple[list[ClosedLine], float]:
    """Return the closed lines of the model space in metres, and the metres of one unit of the drawing.

    All other entities are listed; the unit is found as by :func:`open_drawing`.

    Polylines of a coordinate system of their own, arcs, circles, ellipses and splines become corners in the
    coordinates of the drawing. ``source.table`` chooses layers by a pattern.

    Parameters
    ----------
    source, journal
        The drawing, and where everything that is not used is listed.
    scale_stated : bool
        Whether a scale is stated, which counts instead of the drawing's own unit.
    with_open_lines : bool
        Whether open lines belong to the drawing, as those of horizons do: they are listed as notes.

    Raises
    ------
    InputError
        If the file is missing, or no drawing that can be read.
    """
    from ezdxf.path import make_path

    journal.read(source)
    found: list[ClosedLine] = []
    with _readable(source):
        document = _document(source)
        factor = _unit(document, source, journal, scale_stated)
        for number, raw in enumerate(document.modelspace(), 1):
            kind, layer = str(raw.dxftype()), _clean(str(raw.dxf.layer))
            xyz = np.zeros((0, 3))
            if kind in CLOSABLE:
                path = make_path(raw)
                corners = [tuple(place) for place in path.control_vertices()]
                size = float(np.ptp(np.array(corners), axis=0).max()) if corners else 0.0
                if path.is_closed and size > 0:
                    xyz = np.array([tuple(place) for place in path.flattening(ARC * size)], float)[:-1]
            inside = _layers_inside(raw, layer) if kind == "INSERT" else ()
            if source.table:
                pattern = source.table.casefold()
                inside = tuple(one for one in inside if fnmatchcase(one.casefold(), pattern))
                if not inside and not fnmatchcase(layer.casefold(), pattern):
                    continue
            for one in inside:
                journal.add("error", source.name, BLOCK, EXPLODE, row=number, column=one, value=kind)
            if inside:
                continue
            if len(xyz) < 3 or not np.isfinite(xyz).all():
                journal.add(
                    "note" if with_open_lines or kind not in CLOSABLE else "error",
                    source.name,
                    message("io.not-closed-line", "The {entity} is not a closed line and is not used", entity=kind),
                    message("io.close-polyline", "Close the polyline in CAD if it outlines the body."),
                    row=number,
                    column=layer,
                    value=kind,
                )
                continue
            found.append(ClosedLine(layer, factor * xyz))
        _warn_of_paper(document, source, journal)
    return found, factor


def _document(source: Source) -> Any:
    import ezdxf

    return ezdxf.readfile(source.path, encoding=source.encoding)


@contextmanager
def _readable(source: Source) -> Iterator[None]:
    """Turn what ezdxf raises on a damaged file, which is not limited to its own errors, into one of ours."""
    import ezdxf

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
        yield
    except failures:
        raise InputError(
            message("io.drawing-unreadable", "The drawing is damaged, incomplete or not a DXF file"),
            message("io.audit-in-cad", "Open it in CAD, audit it and save it as DXF (2007 or later)."),
            file=source.name,
        ) from None


def _warn_of_paper(document: Any, source: Source, journal: Journal) -> None:
    """Warn of lines on the sheets of a drawing: only its model space is to scale."""
    for sheet in document.layouts:
        if sheet.is_modelspace:
            continue
        layers = [_clean(str(raw.dxf.layer)) for raw in sheet if raw.dxftype() in (*LINES, *CLOSABLE)]
        if layers:
            journal.add(
                "warning",
                source.name,
                message(
                    "io.paper-space-not-read",
                    "Lines in the paper space '{sheet}' are not read ({count}); their layers: {layers}",
                    sheet=_clean(str(sheet.name)),
                    count=len(layers),
                    layers=", ".join(sorted(set(layers))),
                ),
                message("io.move-to-model-space", "Move lines of horizons and bodies to the model space."),
            )


def _unit(document: Any, source: Source, journal: Journal, scale_stated: bool) -> float:
    """Return the metres of one unit of a drawing; what it states itself is listed, converted or not."""
    code = int(document.header.get("$INSUNITS", 0))
    if source.unit is not None or scale_stated or code not in _UNITS:
        return grid_unit(source, journal)
    name, metres = _UNITS[code]
    if code not in _OF_TEMPLATES:
        if source.usual_unit is not None and metres_of(source.usual_unit, source.name) == metres:
            return grid_unit(source, journal)
        journal.add(
            "warning",
            source.name,
            message(
                "io.drawing-unit-converted",
                "The drawing states that its unit is {unit}; it is converted to metres (1 unit = {metres:.10g} m)",
                unit=name,
                metres=metres,
            ),
            message(
                "io.state-unit-of-drawing",
                'If it is in metres, state that: --unit m of geofit import and geofit body, unit = "m" in a site file.',
            ),
        )
        return metres
    if source.usual_unit is None:
        journal.add(
            "warning",
            source.name,
            message(
                "io.drawing-unit-ignored",
                "The drawing states that its unit is {unit}, as CAD templates do; it is read as metres",
                unit=name,
            ),
            message(
                "io.state-scale-or-unit",
                "If it is in {unit}, state that: --unit of geofit import and geofit body, unit in a site file or, for "
                "a section, scale = {scale:g}.",
                unit=name,
                scale=1.0 / metres,
            ),
        )
    return grid_unit(source, journal)


def _entity(raw: Any, first: int, factor: float) -> Entity:
    kind = str(raw.dxftype())
    vertices, words = _vertices(raw, kind), ""
    if kind in WORDS:
        words = _clean(_words(raw, kind))
    if vertices and all(z == 0 for _, _, z in vertices):
        vertices = [(x, y, float("nan")) for x, y, _ in vertices]
    return Entity(
        kind,
        _clean(str(raw.dxf.layer)),
        tuple((factor * float(x), factor * float(y), factor * float(z)) for x, y, z in vertices),
        getattr(raw, "closed", False) is True or getattr(raw, "is_closed", False) is True,
        kind in ("LWPOLYLINE", "POLYLINE") and bool(getattr(raw, "has_arc", False)),
        words,
        first,
        _layers_inside(raw, _clean(str(raw.dxf.layer))) if kind == "INSERT" else (),
    )


def _layers_inside(raw: Any, layer: str) -> tuple[str, ...]:
    """Return the layers of the lines in an inserted block; those on layer 0 take the layer of the insert, as in CAD."""
    block = raw.block()
    lines = () if block is None else (one for one in block if one.dxftype() in (*LINES, *CLOSABLE, "INSERT"))
    names = {_clean(str(one.dxf.layer)) for one in lines if one.dxftype() != "POINT"}
    return tuple(sorted(layer if name == "0" else name for name in names))


def _clean(text: str) -> str:
    """Return text without the halves of characters that a damaged file, or one in GBK that states UTF-8, leaves."""
    return legible(text)


def _vertices(raw: Any, kind: str) -> list[tuple[float, float, float]]:
    """Return the points of an entity in world coordinates: flat entities, texts and blocks have some of their own."""
    if kind == "LWPOLYLINE":
        places = list(raw.vertices_in_ocs())
    elif kind == "POLYLINE" and (raw.is_2d_polyline or raw.is_3d_polyline):
        places = [v.dxf.location for v in raw.vertices]
        if raw.is_2d_polyline and (level := raw.dxf.elevation.z):
            places = [place.replace(z=level) for place in places]
    elif kind == "LINE":
        places = [raw.dxf.start, raw.dxf.end]
    elif kind == "POINT":
        places = [raw.dxf.location]
    elif kind in WORDS:
        places = [raw.dxf.insert]
    else:
        places = []
    if kind in ("LWPOLYLINE", "TEXT", "INSERT") or (kind == "POLYLINE" and raw.is_2d_polyline):
        places = list(raw.ocs().points_to_wcs(places))
    return [(p.x, p.y, p.z) for p in places]


def _words(raw: Any, kind: str) -> str:
    """Return a text's words, or the first attribute of a block, or else the block's name."""
    if kind == "TEXT":
        return str(raw.plain_text()).strip()
    if kind == "MTEXT":
        return " ".join(str(raw.plain_text()).split())
    attributes = [str(attribute.dxf.text).strip() for attribute in raw.attribs]
    return next((text for text in attributes if text), str(raw.dxf.name))


def count_points(source: Source) -> int:
    """Return the number of points of a drawing, as its readers count them; errors as :func:`open_drawing`."""
    return sum(entity.size for entity in open_drawing(source, Journal())[0])


def on_layers(entities: Iterable[Entity], source: Source, journal: Journal) -> tuple[list[Entity], int]:
    """Return the entities on the layers that ``source.table`` names (a pattern), and how many points are not."""
    if not source.table:
        return list(entities), 0
    pattern, kept, aside = source.table.casefold(), list[Entity](), dict[str, int]()
    for entity in entities:
        if fnmatchcase(entity.layer.casefold(), pattern):
            kept.append(entity)
        else:
            aside[entity.layer] = aside.get(entity.layer, 0) + entity.size
    for layer, size in aside.items():
        reason = message(
            "io.layer-not-used",
            "Layer '{layer}' is not among the layers '{pattern}'; its points are not used ({count})",
            layer=layer,
            pattern=source.table,
            count=size,
        )
        journal.add("note", source.name, reason, column=layer)
    return kept, sum(aside.values())


def problem(entity: Entity, *, closed: bool = False) -> Message:
    """Return why an entity is not a line of points, empty if it is one; ``closed`` allows closed polylines."""
    if entity.inside:
        return BLOCK
    if entity.type not in LINES or not entity.vertices:
        return message(
            "io.entity-not-a-line",
            "The {entity} is not an LWPOLYLINE, POLYLINE, LINE or POINT",
            entity=entity.type,
        )
    xyz = np.array(entity.vertices)
    if not np.isfinite(xyz[:, :2]).all() or np.isinf(xyz[:, 2]).any():
        return message("io.coordinate-not-finite", "A coordinate is not a finite number")
    if entity.closed and not closed:
        return message("io.polyline-closed", "The polyline is closed, but a horizon line must be open")
    return EMPTY

"""Closed outlines of a body on sections: in a drawing (DXF), in GeoJSON, or in the flat drawings of a site file."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.outlines import FLAT, Outline
from geofit.data.errors import InputError
from geofit.data.messages import Message, message, plural_message
from geofit.data.site import ImportIssue
from geofit.io.crs import WGS84, refuse_degrees
from geofit.io.dxf import closed_lines
from geofit.io.journal import Journal
from geofit.io.section_outlines import site_outlines
from geofit.io.source import Source
from geofit.io.units import grid_unit

__all__ = ["OUTLINE_ENDINGS", "DrawnOutlines", "read_outlines"]

Floats = NDArray[np.float64]

#: Endings of the files that :func:`read_outlines` reads.
OUTLINE_ENDINGS = (".dxf", ".geojson", ".json", ".toml")
#: Attributes of a feature that name its section, the surest first.
SECTION_NAMES = ("section", "profile", "剖面", "剖面号", "layer", "name")
#: Longitudes and latitudes lie within these, and sections of a body within less than this of each other.
DEGREES, CLOSE = np.array([180.0, 90.0]), 1.0


@dataclass(frozen=True, eq=False)
class DrawnOutlines:
    """Outlines of a file, by the planes on which they lie.

    ``outlines`` carry the names of their sections. ``layers`` counts the closed lines of each layer, also of those that
    were not chosen; ``issues`` lists everything that is not used; ``inputs`` has the SHA-256 of each file by its name.
    """

    outlines: tuple[Outline, ...]
    layers: dict[str, int]
    issues: tuple[ImportIssue, ...]
    inputs: dict[str, str]


#: A closed line: its layer, its corners (k, 3), and the name of its section where that is known.
Ring = tuple[str, Floats, str]


def read_outlines(path: str | PathLike[str], layers: Collection[str] = (), *, unit: str | None = None) -> DrawnOutlines:
    """Read closed outlines at their true place: map coordinates and elevations, metres.

    Outlines that lie on one plane are those of one section, whatever their layers; a section is named after its layer,
    or the attribute ``section`` of its features, with a number where the layer has several planes.

    Parameters
    ----------
    path : path
        DXF: closed polylines (2D ones in the plane of their own coordinate system), circles, ellipses and splines;
        GeoJSON: polygons, and lines that end where they begin, with elevations; TOML: a site file, whose drawings of
        sections and levels are read, each in its own coordinates.
    layers : collection of str
        Layers of the drawing, or names of sections; empty: all.
    unit : str, optional
        Unit of all lengths, as :func:`geofit.io.read_points` takes it; metres by default. A site file states its own.

    Raises
    ------
    InputError
        If the file cannot be read, a layer is missing, or there are no outlines on two or more planes.
    """
    journal = Journal()
    with journal.handed_over():
        return _drawn(Source(path=Path(path), unit=unit), layers, journal)


def _drawn(source: Source, layers: Collection[str], journal: Journal) -> DrawnOutlines:
    match source.path.suffix.casefold():
        case ".dxf":
            lines, _ = closed_lines(source, journal)
            rings = [(line.layer, line.xyz, "") for line in lines]
        case ".toml":
            if source.unit is not None:
                raise InputError(
                    message("io.site-states-units", "A site file states its own units"),
                    message("io.leave-unit-out", "Leave the unit out, or state unit in [site]."),
                    file=source.name,
                )
            rings = site_outlines(source, journal)
        case ".geojson" | ".json":
            factor = grid_unit(source, journal)
            rings = [(layer, factor * ring, name) for layer, ring, name in _features(source, journal)]
        case ending:
            raise InputError(
                message("io.outline-ending", "Outlines are not read from a file that ends in '{ending}'",
                        ending=ending),
                message("io.give-known-ending", "Give a file that ends in {names}.",
                        names=", ".join(OUTLINE_ENDINGS)),
                file=source.name,
            )  # fmt: skip
    counts: dict[str, int] = {}
    for layer, *_ in rings:
        counts[layer] = counts.get(layer, 0) + 1
    missing = [layer for layer in layers if layer not in counts]
    if missing:
        raise _no_outline(missing[0], counts, source, journal)
    planes = _by_plane([one for one in rings if not layers or one[0] in layers], source, journal)
    if len(planes) < 2:
        raise InputError(
            plural_message(
                "io.outlines-on-planes",
                "The file has closed outlines on {count} plane; a body needs two or more sections",
                "The file has closed outlines on {count} planes; a body needs two or more sections",
                count=len(planes),
            ),
            message(
                "io.draw-outlines-in-place",
                "Draw each section at its true place, with elevations, as closed polylines, or name flat drawings "
                "in the [[section]] tables of a site file.",
            ),
            file=source.name,
        )
    outlines = tuple(Outline(name, one[1]) for name, own in zip(_names(planes), planes, strict=True) for one in own)
    return DrawnOutlines(outlines, counts, tuple(journal.issues), dict(journal.inputs))


def _no_outline(layer: str, counts: dict[str, int], source: Source, journal: Journal) -> InputError:
    """Return the error for a layer without a closed line: what else is on it, or which layers have one."""
    there = [issue for issue in journal.issues if issue.column == layer]
    remedy = (
        message("io.close-or-explode", "Close the polylines that outline the body, explode blocks in CAD.")
        if there
        else message("io.name-one-of-these", "Name one of: {names}.", names=", ".join(counts))
        if counts
        else message("io.draw-closed-polylines", "No layer has one: draw the outlines as closed polylines.")
    )
    blocks = sum(issue.reason.code == "io.block-not-read" for issue in there)
    reason = message("io.no-outline-layer", "No closed line lies on layer '{layer}'", layer=layer)
    if there:
        reason = message(
            "io.other-on-layer",
            "{reason}; entities there that are not used: {others}, blocks with its lines: {blocks}",
            reason=reason,
            others=len(there) - blocks,
            blocks=blocks,
        )
    return InputError(reason, remedy, file=source.name)


def _by_plane(rings: Sequence[Ring], source: Source, journal: Journal) -> list[list[Ring]]:
    """Group closed lines by their planes, the largest first, since it knows its plane best; list those without one."""
    flat: list[tuple[float, Ring, Floats]] = []
    for k, one in enumerate(rings, 1):
        layer, ring, _ = one
        _, sizes, axes = np.linalg.svd(ring - ring.mean(axis=0), full_matrices=False)
        spread = sizes[0] / np.sqrt(len(ring))
        off = float(np.abs((ring - ring.mean(axis=0)) @ axes[2]).max())
        if sizes[1] <= 1e-6 * sizes[0]:
            _leave(source, journal, k, layer, message("io.outline-no-area", "The outline bounds no area"))
        elif off > FLAT * spread:
            reason = message("io.outline-not-flat", "The outline lies up to {off:.2f} m off one plane", off=off)
            _leave(source, journal, k, layer, reason)
        else:
            flat.append((float(spread), one, axes[2]))
    groups: list[tuple[float, Floats, Floats, list[Ring]]] = []
    for spread, one, normal in sorted(flat, key=lambda one: -one[0]):
        for size, middle, across, own in groups:
            if np.abs((one[1] - middle) @ across).max() <= FLAT * size:
                own.append(one)
                break
        else:
            groups.append((spread, one[1].mean(axis=0), normal, [one]))
    if not groups:
        return []
    middles = np.array([group[1] for group in groups])
    along = groups[0][2] if np.ptp(middles @ groups[0][2]) > 0 else np.array([1.0, 0.0, 0.0])
    along = along * np.sign(along[np.abs(along).argmax()])
    return [groups[k][3] for k in np.argsort(middles @ along, kind="stable")]


def _names(planes: Sequence[Sequence[Ring]]) -> list[str]:
    """Return a name for each plane: its section's, else its layer's; with a number where that lies on several."""
    first = [own[0][2] or own[0][0] for own in planes]
    names: list[str] = []
    for k, layer in enumerate(first):
        several = first.count(layer) > 1
        names.append(f"{layer} {first[:k].count(layer) + 1}".strip() if several or not layer else layer)
    return names


def _leave(source: Source, journal: Journal, number: int, layer: str, reason: Message) -> None:
    journal.add(
        "error",
        source.name,
        reason,
        message("io.draw-outline-again", "Draw it again as a closed line on the plane of its section."),
        row=number,
        column=layer,
    )


def _features(source: Source, journal: Journal) -> list[Ring]:
    """Return the closed rings of GeoJSON features with the names of their sections."""
    import shapely

    try:
        top = json.loads(journal.read(source).decode("utf-8-sig"))
        features = top["features"] if top["type"] == "FeatureCollection" else [top]
        shapes = [shapely.from_geojson(json.dumps(one)) for one in features]
        named = [one.get("properties") or {} for one in features]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError, shapely.GEOSException):
        raise InputError(
            message("io.map-unreadable", "The map is damaged or incomplete"),
            message("io.save-geojson-elevations", "Save polygons with elevations as GeoJSON."),
            file=source.name,
        ) from None
    crs = top.get("crs") or {}
    code = str((crs.get("properties") or {}).get("name", "")) if isinstance(crs, dict) else ""
    if code:
        refuse_degrees(code, source.name)
    rings: list[Ring] = []
    for number, (shape, attributes) in enumerate(zip(shapes, named, strict=True), 1):
        layer = next((str(attributes[key]) for key in SECTION_NAMES if attributes.get(key) is not None), "")
        found = _closed(shape)
        if not found:
            _leave(source, journal, number, layer, message("io.line-not-closed", "It is not a closed line"))
        for ring in found:
            if np.isfinite(ring).all():
                rings.append((layer, ring, ""))
            else:
                _leave(source, journal, number, layer, message("io.outline-no-z", "The outline has no elevations"))
    if not code and rings:
        corners = np.concatenate([ring[:, :2] for _, ring, _ in rings])
        if (np.abs(corners) <= DEGREES).all() and (np.ptp(corners, axis=0) < CLOSE).all():
            refuse_degrees(WGS84, source.name)
    return rings


def _closed(shape: Any) -> list[Floats]:
    """Return the closed lines (k, 3) of a shape; z is nan where it has none."""
    import shapely

    if hasattr(shape, "geoms"):
        return [ring for part in shape.geoms for ring in _closed(part)]
    lines = [shape.exterior, *shape.interiors] if shape.geom_type == "Polygon" else [shape]
    return [
        np.asarray(shapely.get_coordinates(line, include_z=True), float)[:-1]
        for line in lines
        if line.geom_type in ("LineString", "LinearRing") and len(line.coords) > 3 and _ends_meet(line)
    ]


def _ends_meet(line: Any) -> bool:
    return bool(line.coords[0] == line.coords[-1])

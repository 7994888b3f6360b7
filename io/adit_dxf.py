"""Adits of a plan in DXF: 3D polylines are their paths, texts and blocks beside them name the contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import EMPTY, Message, message
from geofit.data.points import PointSet
from geofit.data.site import Hole
from geofit.io.axes import Region
from geofit.io.dxf import Entity, on_layers, open_drawing, problem
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.polyline import along, chainage
from geofit.io.source import Source

__all__ = ["draw_adits", "drawn_contacts"]

Floats = NDArray[np.float64]

#: A contact's text or block stands within this distance of the adit in plan, metres.
BESIDE = 5.0


def draw_adits(source: Source, journal: Journal, region: Region | None = None) -> tuple[Hole, ...]:
    """Read each open polyline with elevations as an adit named after its layer; everything else is listed.

    Several polylines on one layer are numbered. ``source.table`` chooses layers by a pattern ("PD*").

    Raises
    ------
    InputError
        If the drawing cannot be read, or no polyline is an adit.
    """
    entities, _ = open_drawing(source, journal)
    chosen, listed = on_layers(entities, source, journal)
    adits: list[Hole] = []
    for entity in chosen:
        xyz = np.array(entity.vertices, dtype=np.float64).reshape(-1, 3)
        trouble = _no_path(entity, xyz, region)
        if trouble:
            remedy = message("io.draw-adit", "Draw the adit as an open 3D polyline on a layer with its name.")
            _list(journal, source, entity, trouble, remedy)
            listed += entity.size
            continue
        keep = np.append(True, (np.diff(xyz, axis=0) != 0).any(axis=1))
        for k in np.flatnonzero(~keep).tolist():
            reason = message("io.corner-repeated", "The corner repeats the one before")
            journal.add("note", source.name, reason, row=entity.first + k, column=entity.layer)
        listed += int((~keep).sum())
        same = sum(adit.name == entity.layer or adit.name.startswith(f"{entity.layer} ") for adit in adits)
        name = entity.layer if not same else f"{entity.layer} {same + 1}"
        adits.append(Hole(name, "adit", chainage(xyz[keep]), xyz[keep]))
    journal.count(source.name, sum(entity.size for entity in entities), listed)
    if not adits:
        raise InputError(
            message("io.no-adit-in-drawing", "No polyline of the drawing is an adit"),
            message("io.see-listed-entities", "See the listed entities."),
            file=source.name,
        )
    return tuple(adits)


def _no_path(entity: Entity, xyz: Floats, region: Region | None) -> Message:
    if entity.type == "POINT" or (trouble := problem(entity)):
        return (
            message("io.entity-not-a-path", "A {entity} is not a path", entity=entity.type)
            if entity.type == "POINT"
            else trouble
        )
    if np.isnan(xyz[:, 2]).any():
        return message("io.polyline-no-elevation", "The polyline has no elevation")
    if not (np.diff(xyz, axis=0) != 0).any():
        return message("io.polyline-of-one-point", "The polyline has only one distinct point")
    if region is not None:
        west, east, south, north = region
        x, y = xyz[:, :2].mean(axis=0)
        if not (west <= x <= east and south <= y <= north):
            return message("io.polyline-far-outside", "The polyline lies far outside the study area")
    return EMPTY


def drawn_contacts(
    source: Source, adits: tuple[Hole, ...], horizons: HorizonNames, journal: Journal
) -> dict[str, PointSet]:
    """Read texts and blocks (first attribute, else name) that name a horizon beside an adit, kind "adit".

    The contact is the place of the adit's axis nearest in plan to the insertion point. Words that are no
    horizon are notes; a contact farther than 5 m from every adit is listed.
    """
    entities, _ = open_drawing(source, journal)
    chosen, listed = on_layers(entities, source, journal)
    found: list[tuple[str, str, Floats, int]] = []
    for entity in chosen:
        horizon = horizons.match(entity.words) if entity.words else None
        if horizon is None or entity.words in (entity.layer, *(adit.name for adit in adits)):
            what = (
                message("io.words-not-a-horizon", "'{words}' is not a horizon", words=entity.words)
                if entity.words
                else message("io.entity-without-horizon", "A {entity} names no horizon", entity=entity.type)
            )
            _list(
                journal,
                source,
                entity,
                what,
                message("io.write-horizon-text", "Write the horizon as text next to the adit."),
                "note",
            )
            listed += entity.size
            continue
        adit, place, apart = _nearest(adits, np.array(entity.vertices[0][:2]))
        if not apart <= BESIDE:
            reason = message(
                "io.contact-far-from-adit",
                "The contact '{words}' is {apart:.1f} m from the nearest adit, {adit}",
                words=entity.words,
                apart=apart,
                adit=adit.name,
            )
            remedy = message("io.place-near-adit", "Place it within {reach:g} m of the adit's axis.", reach=BESIDE)
            _list(journal, source, entity, reason, remedy)
            listed += 1
            continue
        found.append((horizon, adit.name, place, entity.first))
    journal.count(source.name, sum(entity.size for entity in entities), listed)
    return {
        name: PointSet(
            np.array([place for _, _, place, _ in own]),
            kind="adit",
            hole=np.array([adit for _, adit, _, _ in own]),
            row=np.array([row for *_, row in own]),
            file=source.name,
        )
        for name in dict.fromkeys(horizon for horizon, *_ in found)
        for own in [[one for one in found if one[0] == name]]
    }


def _nearest(adits: tuple[Hole, ...], xy: Floats) -> tuple[Hole, Floats, float]:
    """Return the adit that runs nearest to a place in plan, the place on it, and the distance."""
    best: tuple[Hole, Floats, float] | None = None
    for adit in adits:
        start, way = adit.xyz[:-1, :2], np.diff(adit.xyz[:, :2], axis=0)
        square = np.maximum((way**2).sum(axis=1), 1e-300)
        t = (((xy - start) * way).sum(axis=1) / square).clip(0, 1)
        apart = np.linalg.norm(start + t[:, None] * way - xy, axis=1)
        k = int(apart.argmin())
        if best is None or apart[k] < best[2]:
            s = adit.depth[k] + t[k] * (adit.depth[k + 1] - adit.depth[k])
            best = (adit, along(adit.xyz, np.array([s]))[0], float(apart[k]))
    assert best is not None
    return best


def _list(
    journal: Journal, source: Source, entity: Entity, reason: Message, remedy: Message, severity: str = "error"
) -> None:
    journal.add(
        "note" if severity == "note" else "error",
        source.name,
        reason,
        remedy,
        row=entity.first,
        column=entity.layer,
        value=entity.words or entity.type,
    )

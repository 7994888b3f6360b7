"""Horizon lines of a drawing in DXF, section or map: the layer names the horizon."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.dxf import EXPLODE, LINES, on_layers, open_drawing, problem
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.source import Source

__all__ = ["DrawnLines", "read_drawing"]


@dataclass(frozen=True, eq=False)
class DrawnLines:
    """Vertices of the horizon lines in drawing order.

    ``xyz`` (n, 3) in metres, of which one unit of the drawing has ``unit``, z nan where the drawing is flat;
    ``horizon`` the name of each, ``number`` its running number among all points of the drawing, from 1; ``listed``
    counts what is on other layers or cannot be used.
    """

    xyz: NDArray[np.float64]
    horizon: list[str]
    number: NDArray[np.int64]
    listed: int
    unit: float

    @property
    def uv(self) -> NDArray[np.float64]:
        """Drawing coordinates (n, 2)."""
        return self.xyz[:, :2]


def read_drawing(
    source: Source, horizons: HorizonNames, journal: Journal, *, scale_stated: bool, closed: bool = False
) -> DrawnLines:
    """Read LWPOLYLINE, POLYLINE, LINE and POINT of the model space; everything else is listed.

    ``closed`` allows closed polylines (outcrops on a map). ``source.table`` chooses layers by a pattern.

    Raises
    ------
    InputError
        If the drawing cannot be read, or is empty.
    """
    entities, unit = open_drawing(source, journal, scale_stated=scale_stated)
    if not entities:
        raise InputError(
            message("io.drawing-empty", "The drawing is empty"),
            message("io.draw-in-model-space", "Draw the horizons in model space."),
            file=source.name,
        )
    entities, listed = on_layers(entities, source, journal)
    xyz: list[tuple[float, float, float]] = []
    names: list[str] = []
    numbers: list[int] = []
    for entity in entities:
        layer = entity.layer
        trouble = problem(entity, closed=closed)
        named = (horizons.match(name.strip()) for name in (layer, *entity.inside))
        horizon = next((name for name in named if name is not None), None)
        if horizon is None or trouble:
            stranger = message("io.layer-not-a-horizon", "Layer '{layer}' is not a horizon of the site", layer=layer)
            reason = trouble if horizon is not None else stranger
            journal.add(
                "error" if horizon is not None else "note",
                source.name,
                message(
                    "io.entity-not-used",
                    "{reason}; {entity} is not used (points: {count})",
                    reason=reason,
                    entity=entity.type,
                    count=entity.size,
                )
                if entity.type in LINES and entity.vertices
                else message(
                    "io.whole-entity-not-used", "{reason}; {entity} is not used", reason=reason, entity=entity.type
                ),
                EXPLODE
                if entity.inside and horizon is not None
                else message("io.draw-polyline-on-layer", "Draw the horizon as a polyline on the layer with its name."),
                row=entity.first,
                column=layer,
                value=entity.type,
            )
            listed += entity.size
            continue
        if entity.arcs:
            journal.add(
                "warning",
                source.name,
                message("io.polyline-with-arcs", "The polyline has arcs; only its corners are used"),
                message("io.add-corners-on-arcs", "Add corners along the arcs."),
                row=entity.first,
                column=layer,
            )
        for number, vertex in enumerate(entity.vertices, entity.first):
            if xyz and names[-1] == horizon and np.array_equal(xyz[-1], vertex, equal_nan=True):
                journal.add(
                    "note",
                    source.name,
                    message("io.point-repeated", "The point repeats the one before"),
                    row=number,
                    column=layer,
                )
                listed += 1
                continue
            xyz.append(vertex)
            names.append(horizon)
            numbers.append(number)
    places = np.array(xyz, dtype=np.float64).reshape(-1, 3)
    return DrawnLines(places, names, np.array(numbers, dtype=np.int64), listed, unit)

"""What lies under the pointer: points, holes, surfaces. True coordinates; no Qt, and VTK only to find triangles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

from geofit.gui.view3d.actors import poly
from geofit.gui.view3d.cloud import PointCloud
from geofit.gui.view3d.item import Item
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.projector import Projector
from geofit.gui.view3d.shape import Shape

__all__ = ["Hit", "Sights", "nearest_target", "nearest_way"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: How far from the pointer a thing may be drawn and still be meant, logical pixels; within EXACT it is meant first.
REACH, EXACT = 8.0, 3.0


@dataclass(frozen=True, eq=False)
class Hit:
    """Something under the pointer: its layer, number or name, where it is, how far from the viewpoint (0 to 1)."""

    layer: Layer
    which: Any
    xyz: Floats
    depth: float
    away: float


def nearest_target(
    items: Iterable[tuple[Layer, Item]], view: Projector, column: float, row: float, box: Floats | None = None
) -> Hit | None:
    """Return the point under the pointer: those drawn right there first, of these the one in front.

    With a clip box (2, 3) only points inside of it.
    """
    hits = []
    for layer, item in items:
        if item.targets is None:
            continue
        if item.crowd is None:
            hit = _nearest(layer, item.targets, np.arange(len(item.targets)), view, column, row, box, REACH)
        else:
            hit = _nearest_of_many(layer, item.targets, item.crowd.cloud, view, column, row, box)
        if hit is not None:
            hits.append(hit)
    return min(hits, key=lambda hit: (hit.away > EXACT, hit.depth), default=None)


def _nearest_of_many(
    layer: Layer, targets: Floats, cloud: PointCloud, view: Projector, column: float, row: float, box: Floats | None
) -> Hit | None:
    """Return what a search of all points finds: from front to back, first of those drawn right there."""
    for reach in (EXACT, REACH):
        best: Hit | None = None
        for least, some in cloud.under(view, column, row, reach):
            if best is not None and best.depth < least:
                break
            hit = _nearest(layer, targets[some], some, view, column, row, box, reach)
            if hit is not None and (best is None or (hit.depth, hit.which) < (best.depth, best.which)):
                best = hit
        if best is not None:
            return best
    return None


def _nearest(
    layer: Layer,
    places: Floats,
    which: Ints,
    view: Projector,
    column: float,
    row: float,
    box: Floats | None,
    reach: float,
) -> Hit | None:
    """Return the one of some places, known by the numbers ``which``, that is meant by a pixel."""
    seen = view.screen(places)
    away = np.hypot(seen[:, 0] - column, seen[:, 1] - row)
    near = np.flatnonzero(away <= reach)
    if box is not None:
        near = near[((places[near] >= box[0]) & (places[near] <= box[1])).all(axis=1)]
    if not near.size:
        return None
    best = near[np.lexsort([which[near], seen[near, 2], away[near] > EXACT])[0]]
    return Hit(layer, int(which[best]), places[best], float(seen[best, 2]), float(away[best]))


def nearest_way(items: Iterable[tuple[Layer, Item]], view: Projector, column: float, row: float) -> Hit | None:
    """Return the line (hole, adit) under the pointer, by its name."""
    hits, here = [], np.array([column, row])
    for layer, item in items:
        for name, xyz in item.ways:
            seen = view.screen(xyz)
            start, way = seen[:-1, :2], np.diff(seen[:, :2], axis=0)
            share = np.clip(((here - start) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12), 0, 1)
            away = np.linalg.norm(start + share[:, None] * way - here, axis=1)
            if np.isfinite(away).any() and np.nanmin(away) <= REACH:
                k = int(np.nanargmin(away))
                depth = seen[k, 2] + share[k] * (seen[k + 1, 2] - seen[k, 2])
                hits.append(Hit(layer, name, xyz[k] + share[k] * (xyz[k + 1] - xyz[k]), float(depth), float(away[k])))
    return min(hits, key=lambda hit: (hit.away > EXACT, hit.depth), default=None)


class Sights:
    """Finds where a line of sight meets the surfaces; the search tree of each is kept."""

    def __init__(self) -> None:
        self._trees: WeakKeyDictionary[Shape, tuple[Any, Floats]] = WeakKeyDictionary()

    def prepare(self, items: Iterable[Item]) -> None:
        """Make the search trees of surfaces."""
        for item in items:
            if item.shape is not None and len(item.shape.triangles):
                self._tree(item.shape)

    def first(
        self, items: Iterable[tuple[Layer, Item]], view: Projector, column: float, row: float, box: Floats | None
    ) -> Hit | None:
        """Return the surface in front under the pointer; with a clip box (2, 3) only inside of it."""
        near, far = view.ray(column, row)
        if box is not None:
            ends = _inside(near, far, box)
            if ends is None:
                return None
            near, far = ends
        hits = []
        for layer, item in items:
            if item.shape is None or not len(item.shape.triangles):
                continue
            tree, origin = self._tree(item.shape)
            t: Any = mutable(0.0)
            place, local, part = [0.0] * 3, [0.0] * 3, mutable(0)
            if tree.IntersectWithLine(near - origin, far - origin, 0.0, t, place, local, part):
                hits.append(Hit(layer, layer.horizon, np.array(place) + origin, float(t), 0.0))
        return min(hits, key=lambda hit: hit.depth, default=None)

    def _tree(self, shape: Shape) -> tuple[Any, Floats]:
        if shape not in self._trees:
            origin = np.round(shape.xyz.mean(axis=0))
            tree = vtkStaticCellLocator()
            tree.SetDataSet(poly(shape.xyz - origin, faces=shape.triangles))
            tree.BuildLocator()
            self._trees[shape] = tree, origin
        return self._trees[shape]


def _inside(near: Floats, far: Floats, box: Floats) -> tuple[Floats, Floats] | None:
    """Return the part of a line inside a box, None if it passes by."""
    way = far - near
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (box - near) / way
    t = np.where(np.isfinite(t), t, [[-np.inf], [np.inf]])
    enter, leave = max(float(t.min(axis=0).max()), 0.0), min(float(t.max(axis=0).min()), 1.0)
    return None if enter >= leave else (near + enter * way, near + leave * way)

"""What one horizon puts into the scene: points, surface, isolines, seams, control net, 90 % band, suggested holes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkFiltersCore import vtkContourFilter

from geofit.data.accuracy import Seam
from geofit.data.points import PointSet
from geofit.data.prediction import Suggestion
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.view3d.actors import ActorPart, coloured, dots, lines, poly, ramped, shaded, triangles
from geofit.gui.view3d.cloud import PointCloud
from geofit.gui.view3d.colouring import SIZE, points_by, ramp, seam_colours
from geofit.gui.view3d.crowd import GHOSTLY, Crowd
from geofit.gui.view3d.item import Item, Look, corners_of
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.moved_region import MovedRegion
from geofit.gui.view3d.shape import Shape
from geofit.report.style import rgb
from geofit.sampling.contours import interval_for

__all__ = ["control_item", "place_control", "points_item", "seams_item", "shape_item", "suggestions_item"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Colour by day and by night of points that take no part in the fit.
GHOST = "#5d6b7a", "#b9c4cf"
#: Opacity of a surface above the ground or beyond its points.
FADED = 0.28
#: Diameter of a control point, logical pixels.
CONTROL = 2.5
#: Every so many isolines one is thicker.
MAJOR = 5


def points_item(
    points: PointSet,
    residuals: Floats | None,
    settings: FitSettings,
    layer: Layer,
    look: Look,
    excluded: Bools | None = None,
    cloud: PointCloud | None = None,
) -> Item:
    """Points of a horizon, coloured as the layer says; those of excluded rows are ghosts.

    Of a ``cloud`` of these points each view draws as many as it has room for.
    """
    made = points_by(layer.colour_by, points, layer.colour, residuals, settings, look.dark)
    if cloud is not None:
        crowd = Crowd(cloud, made, excluded, look.origin, GHOST[look.dark], look.points)
        return Item(crowd.parts, cloud.box, targets=points.xyz, crowd=crowd, legend=made.legend)
    used = np.ones(len(points), bool) if excluded is None else ~excluded
    parts = []
    for size in np.unique(made.size[used]):
        mine = used & (made.size == size)
        actor = dots(poly(points.xyz[mine] - look.origin), "#000000", balls=True)
        coloured(actor, made.colour[mine])
        parts.append(ActorPart(actor, size=float(size) * look.points))
    if not used.all():
        ghosts = dots(poly(points.xyz[~used] - look.origin), GHOST[look.dark], balls=True)
        parts.append(ActorPart(ghosts, size=SIZE * look.points, opacity=GHOSTLY))
    return Item(parts, corners_of(points.xyz), targets=points.xyz, legend=made.legend)


def shape_item(
    shape: Shape,
    values: tuple[Floats, Floats] | None,
    layer: Layer,
    look: Look,
    supported: tuple[Bools, Bools] | None = None,
    cut: MovedRegion | None = None,
    most: float | None = None,
) -> Item:
    """Return triangles coloured by a value at their corners (fine, coarse), or plain; isolines if wanted.

    ``most`` is the value at the end of the colours; None: the largest.
    Triangles that are not ``supported`` (fine, coarse) are drawn translucent; None: all are. What a control point moves
    just now is ``cut`` out.
    """
    coarse = shape.coarse or shape if cut is None else shape
    details = (("both", shape, 0),) if coarse is shape else (("full", shape, 0), ("coarse", coarse, 1))
    made = ramp(layer.colour_by, values[0], most) if values is not None else None
    parts = []
    for detail, one, k in details:
        held = np.ones(len(one.triangles), bool) if supported is None else supported[k]
        there = np.ones(len(one.triangles), bool) if cut is None else ~cut.touched
        for faces, opacity in ((one.triangles[held & there], 1.0), (one.triangles[~held & there], FADED)):
            if not len(faces):
                continue
            data = _data(replace(one, triangles=faces), look)
            if detail == "coarse":
                flat = np.tile(np.array(rgb(layer.colour), np.uint8), (len(one.xyz), 1))
                shades = made.of(values[k]) if made is not None and values is not None else flat
                actor = shaded(data, shades, one.normals)
            else:
                actor = triangles(data, layer.colour)
                if made is not None and values is not None:
                    ramped(actor, values[k], made)
            parts.append(ActorPart(actor, detail, opacity=opacity))
        if cut is not None and len(cut.beside.triangles):
            actor = triangles(_data(cut.beside, look), layer.colour)
            if made is not None and values is not None:
                ramped(actor, values[k][cKDTree(one.xyz).query(cut.beside.xyz)[1]], made)
            parts.append(ActorPart(actor, detail, opacity=1.0 if held[cut.touched].all() else FADED))
        if layer.isolines:
            parts += _isolines(replace(one, triangles=one.triangles[there]), shape, detail, look)
    return Item(parts, corners_of(shape.xyz), shape=shape, legend=made.legend if made else None)


def _data(shape: Shape, look: Look) -> Any:
    return poly(shape.xyz - look.origin, faces=shape.triangles, normals=shape.normals)


def _isolines(one: Shape, whole: Shape, detail: str, look: Look) -> list[ActorPart]:
    low, high = float(whole.xyz[:, 2].min()), float(whole.xyz[:, 2].max())
    step = interval_for(low, high)
    numbers = np.arange(math.ceil(low / step), math.floor(high / step) + 1)
    data = poly(one.xyz - look.origin, faces=one.triangles)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(one.xyz[:, 2]), deep=True))
    parts = []
    for major in (False, True):
        levels = step * numbers[(numbers % MAJOR == 0) == major]
        if not len(levels):
            continue
        cut = vtkContourFilter()
        cut.SetInputData(data)
        cut.ComputeNormalsOff()
        cut.ComputeScalarsOff()
        for k, level in enumerate(levels.tolist()):
            cut.SetValue(k, level)
        cut.Update()
        parts.append(ActorPart(lines(cut.GetOutput(), "#1c2733"), detail, width=1.6 if major else 0.9, opacity=0.6))
    return parts


def seams_item(runs: Sequence[Sequence[Floats]], seams: Sequence[Seam], layer: Layer, look: Look) -> Item:
    """Seams of a surface, each in the colour of its gap or angle."""
    colours, legend = seam_colours(seams, layer.colour_by, look.dark)
    parts, boxes = [], []
    for colour in dict.fromkeys(colours):
        mine = [run for these, c in zip(runs, colours, strict=True) if c == colour for run in these]
        if mine:
            ends = np.cumsum([0] + [len(run) for run in mine])
            numbers = [np.arange(a, b) for a, b in pairwise(ends)]
            every = np.concatenate(mine)
            parts.append(ActorPart(lines(poly(every - look.origin, runs=numbers), colour, 4.0), width=3.5))
            boxes.append(every)
    return Item(parts, corners_of(np.concatenate(boxes) if boxes else look.origin[None]), legend=legend)


def control_item(surface: HorizonFit, layer: Layer, look: Look) -> tuple[Item, list[tuple[str, int, int]]]:
    """Control net of every patch, and the name, row and column of each of its points."""
    points, runs, known, start = [], [], [], 0
    for patch in surface.patches:
        nu, nv = patch.control.shape[:2]
        number = start + np.arange(nu * nv).reshape(nu, nv)
        runs += [*number, *number.T]
        points.append(patch.control.reshape(-1, 3) + surface.origin)
        known += [(patch.name, i, j) for i in range(nu) for j in range(nv)]
        start += nu * nv
    xyz = np.concatenate(points)
    mesh = min(_spacing(patch.control) for patch in surface.patches)
    net = lines(poly(xyz - look.origin, runs=runs), look.text)
    parts = [
        ActorPart(net, "full", width=1.0, opacity=0.4, spacing=mesh),
        ActorPart(dots(poly(xyz - look.origin), look.text, balls=False), size=CONTROL, opacity=0.9, spacing=mesh),
    ]
    return Item(parts, corners_of(xyz), targets=xyz), known


def place_control(item: Item, xyz: Floats, look: Look) -> None:
    """Put the points of a control net elsewhere, (n, 3) map coordinates."""
    item.targets = xyz
    for part in item.parts:
        points = part.actor.GetMapper().GetInput().GetPoints()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(xyz - look.origin, np.float32), deep=True))


def _spacing(control: Floats) -> float:
    """Return the mean distance between neighbours of a control net (nu, nv, 3), metres."""
    along = [float(np.median(np.linalg.norm(np.diff(control, axis=axis), axis=2))) for axis in (0, 1)]
    return math.sqrt(along[0] * along[1])


def suggestions_item(suggestions: Sequence[Suggestion], top: float, layer: Layer, look: Look) -> Item:
    """Places for the next holes, as dashed lines from above the ground down to the surface, numbered."""
    colour = "#7ed0a0" if look.dark else "#1b6e3c"
    feet = np.array([[s.x, s.y, s.z] for s in suggestions])
    heads = feet.copy()
    heads[:, 2] = np.maximum(top, feet[:, 2])
    share = np.linspace(0, 1, 30).reshape(15, 2)
    dashes = feet[:, None, None] + share[None, :, :, None] * (heads - feet)[:, None, None]
    xyz = dashes.reshape(-1, 3)
    parts = [
        ActorPart(lines(poly(xyz - look.origin, runs=list(np.arange(len(xyz)).reshape(-1, 2))), colour), width=2.5),
        ActorPart(dots(poly(feet - look.origin), colour, balls=True), size=10.0),
    ]
    names = [in_lengths(f"{k} · ± {s.sd:.2f} m") for k, s in enumerate(suggestions, 1)] if layer.labels else []
    return Item(parts, corners_of(np.concatenate([feet, heads])), places=heads, names=tuple(names))

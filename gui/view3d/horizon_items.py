"""What one horizon puts into the scene: points, surface, isolines, seams, control net, 90 % band, suggested holes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkFiltersCore import vtkContourFilter

from geofit.data.accuracy import Seam
from geofit.data.points import PointSet
from geofit.data.prediction import Suggestion
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.view3d.actors import ActorPart, coloured, dots, lines, poly, ramped, shaded, triangles
from geofit.gui.view3d.colouring import SIZE, PointColours, points_by, ramp, seam_colours
from geofit.gui.view3d.item import Item, Look, corners_of
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.shape import Shape
from geofit.report.style import rgb
from geofit.sampling.contours import interval_for

__all__ = ["control_item", "points_item", "seams_item", "shape_item", "suggestions_item"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: More points than BALLS are drawn flat and small, more than THIN thinned while the picture moves.
BALLS, THIN = 20_000, 10_000
SMALL = 2.0
#: Colour by day and by night, and opacity, of points that take no part in the fit.
GHOST, GHOSTLY = ("#5d6b7a", "#b9c4cf"), 0.3
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
) -> Item:
    """Points of a horizon, coloured as the layer says; those of excluded rows are ghosts."""
    made = points_by(layer.colour_by, points, layer.colour, residuals, settings, look.dark)
    many = len(points) > BALLS
    used = np.ones(len(points), bool) if excluded is None else ~excluded
    parts = [
        part
        for size in np.unique(made.size[used])
        for part in _cloud(points.xyz, made, used & (made.size == size), many, look)
    ]
    if not used.all():
        ghosts = dots(poly(points.xyz[~used] - look.origin), GHOST[look.dark], balls=not many)
        parts.append(ActorPart(ghosts, size=SIZE * look.points, opacity=GHOSTLY))
    return Item(parts, corners_of(points.xyz), targets=points.xyz, legend=made.legend)


def _cloud(xyz: Floats, made: PointColours, mask: NDArray[np.bool_], many: bool, look: Look) -> list[ActorPart]:
    size = float(made.size[mask][0])
    chosen = np.flatnonzero(mask)
    share = min(THIN / len(mask), 1.0)
    if share == 1:
        return [_dots(xyz, made, chosen, size, many, "both", look)]
    few = np.random.default_rng(0).permutation(chosen)[: max(math.ceil(share * len(chosen)), 1)]
    small = SMALL * size / float(made.size.min())
    return [
        _dots(xyz, made, chosen, small, True, "full", look),
        _dots(xyz, made, few, 1.5 * small, True, "coarse", look),
    ]


def _dots(
    xyz: Floats, made: PointColours, which: NDArray[np.int64], size: float, flat: bool, detail: str, look: Look
) -> ActorPart:
    actor = dots(poly(xyz[which] - look.origin), "#000000", balls=not flat)
    coloured(actor, made.colour[which])
    return ActorPart(actor, detail, size=size * look.points)


def shape_item(
    shape: Shape,
    values: tuple[Floats, Floats] | None,
    layer: Layer,
    look: Look,
    supported: tuple[Bools, Bools] | None = None,
) -> Item:
    """Return triangles coloured by a value at their corners (fine, coarse), or plain; isolines if wanted.

    Triangles that are not ``supported`` (fine, coarse) are drawn translucent; None: all are.
    """
    coarse = shape.coarse or shape
    details = (("both", shape, 0),) if coarse is shape else (("full", shape, 0), ("coarse", coarse, 1))
    made = ramp(layer.colour_by, values[0]) if values is not None else None
    parts = []
    for detail, one, k in details:
        held = np.ones(len(one.triangles), bool) if supported is None else supported[k]
        for faces, opacity in ((one.triangles[held], 1.0), (one.triangles[~held], FADED)):
            if not len(faces):
                continue
            data = poly(one.xyz - look.origin, faces=faces, normals=one.normals)
            if detail == "coarse":
                flat = np.tile(np.array(rgb(layer.colour), np.uint8), (len(one.xyz), 1))
                shades = made.of(values[k]) if made is not None and values is not None else flat
                actor = shaded(data, shades, one.normals)
            else:
                actor = triangles(data, layer.colour)
                if made is not None and values is not None:
                    ramped(actor, values[k], made)
            parts.append(ActorPart(actor, detail, opacity=opacity))
        if layer.isolines:
            parts += _isolines(one, shape, detail, look)
    return Item(parts, corners_of(shape.xyz), shape=shape, legend=made.legend if made else None)


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

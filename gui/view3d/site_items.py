"""What a whole site puts into the scene: ground, boundary, holes, adits, sections, measured dips."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Ground, Hole, Orientations, Section, Site
from geofit.gui.view3d.actors import ActorPart, dots, lines, poly, triangles
from geofit.gui.view3d.colouring import legible_on
from geofit.gui.view3d.item import Item, Look, corners_of
from geofit.gui.view3d.layers import Layer, Legend, Swatch
from geofit.gui.view3d.shape import Shape
from geofit.report.section_pages import lithology_style
from geofit.report.style import FAIL, KIND_STYLE
from geofit.site.hole_logs import hole_intervals, log_files

__all__ = ["boundary_item", "dips_item", "ground_item", "holes_item", "sections_item"]

Floats = NDArray[np.float64]

#: Colours of the ground and of boreholes by day and by night.
EARTH, DRILLED = ("#b9b19c", "#8f8a7a"), ("#3d4852", "#8f9aa5")
#: Width of a logged interval, logical pixels.
LOGGED = 6.0
#: Cells along a side of the ground while the picture moves.
FEW = 60
#: Lines on the ground are raised by this share of the site's width, so that they do not sink into it.
RAISED = 5e-4
#: Radius of the disc of a measured dip, as a share of the site's width, and its corners.
DISC, CORNERS = 0.012, 20


def ground_item(ground: Ground, layer: Layer, look: Look) -> Item:
    """Triangles of the ground's grid."""
    step = max(len(ground.x) // FEW, len(ground.y) // FEW, 1)
    fine, few = _grid(ground, 1), _grid(ground, step)
    parts = []
    for shape, detail in ((fine, "full"), (few, "coarse")):
        data = poly(shape.xyz - look.origin, faces=shape.triangles, normals=shape.normals)
        parts.append(ActorPart(triangles(data, EARTH[look.dark]), detail))
    return Item(parts, corners_of(fine.xyz), shape=fine)


def _grid(ground: Ground, step: int) -> Shape:
    # The last row and column belong to the coarse grid too.
    i, j = (np.unique(np.append(np.arange(0, n, step), n - 1)) for n in (len(ground.x), len(ground.y)))
    x, y, z = ground.x[i], ground.y[j], ground.z[np.ix_(j, i)]
    slope_y, slope_x = np.gradient(z, y, x)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(z)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.where(np.isfinite(normals), normals, (0.0, 0.0, 1.0))
    xyz = np.stack([*np.meshgrid(x, y), z], axis=-1)
    n = np.arange(z.size).reshape(z.shape)
    a, b, c, d = (part.ravel() for part in (n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    known = np.isfinite(z).ravel()
    faces = faces[known[faces].all(axis=1)]
    xyz = np.where(np.isfinite(xyz), xyz, np.nanmin(z))
    return Shape(xyz.reshape(-1, 3), faces, normals.reshape(-1, 3))


def boundary_item(boundary: Floats, ground: Ground | None, level: float, layer: Layer, look: Look) -> Item:
    """Outline of the study area, on the ground where there is one, else at a level."""
    return _draped([np.vstack([boundary, boundary[:1]])], ground, level, "#d0453a" if look.dark else FAIL, look, 2.0)


def sections_item(sections: Sequence[Section], ground: Ground | None, level: float, layer: Layer, look: Look) -> Item:
    """Lines of the section drawings, with their names at their starts."""
    item = _draped([np.asarray(s.line, float) for s in sections], ground, level, look.text, look, 1.5)
    starts = np.array([np.asarray(s.line, float)[0] for s in sections])
    item.places = _on_ground(starts, ground, level)
    item.names = tuple(section.name for section in sections) if layer.labels else ()
    return item


def _draped(plans: list[Floats], ground: Ground | None, level: float, colour: str, look: Look, width: float) -> Item:
    runs = [_on_ground(_refined(plan), ground, level) for plan in plans]
    return Item([ActorPart(lines(_runs(runs, look), colour), width=width)], corners_of(np.concatenate(runs)))


def _refined(plan: Floats, pieces: int = 60) -> Floats:
    """Return a plan line with so many places on each of its straight parts that it follows the ground."""
    share = np.linspace(0, 1, pieces, endpoint=False)[:, None]
    return np.vstack([*(a + share * (b - a) for a, b in pairwise(plan)), plan[-1:]])


def _on_ground(plan: Floats, ground: Ground | None, level: float) -> Floats:
    z = np.full(len(plan), np.nan) if ground is None else ground.elevation(plan[:, 0], plan[:, 1])
    lift = 0.0 if ground is None else RAISED * float(np.ptp(ground.x))
    return np.column_stack([plan, np.where(np.isfinite(z), z + lift, level)])


def _runs(runs: Sequence[Floats], look: Look) -> object:
    ends = np.cumsum([0] + [len(run) for run in runs])
    numbers = [np.arange(a, b) for a, b in pairwise(ends)]
    return poly(np.concatenate(list(runs)) - look.origin, runs=numbers)


def holes_item(holes: Sequence[Hole], site: Site, layer: Layer, look: Look) -> Item:
    """Paths of boreholes or adits, their collars, and their names there; coloured by an interval table if wanted."""
    kind = holes[0].kind
    # Boreholes are grey: blue means "below" where points are coloured by their deviation.
    colour = DRILLED[look.dark] if kind == "borehole" else legible_on(KIND_STYLE[kind][1], look.dark)
    collars = np.array([hole.xyz[0] for hole in holes])
    tube = lines(_runs([hole.xyz for hole in holes], look), colour, 0.0)
    parts = [
        ActorPart(tube, width=2.5),
        ActorPart(dots(poly(collars - look.origin), colour, balls=True), size=6.0),
    ]
    logged, legend = _logged(holes, site, layer, look)
    return Item(
        [*parts, *logged],
        corners_of(np.concatenate([hole.xyz for hole in holes])),
        places=collars,
        names=tuple(hole.name for hole in holes) if layer.labels else (),
        ways=tuple((hole.name, hole.xyz) for hole in holes),
        legend=legend,
    )


def _logged(holes: Sequence[Hole], site: Site, layer: Layer, look: Look) -> tuple[list[ActorPart], Legend | None]:
    """Return the intervals of the table that the layer is coloured by, a part and a swatch a code."""
    if layer.colour_by not in log_files(site):
        return [], None
    pieces: dict[str, list[Floats]] = {}
    for hole in holes:
        for one in hole_intervals(site, hole, layer.colour_by):
            pieces.setdefault(one.code, []).append(one.xyz)
    # The same colours as on a section sheet, which shows all tables.
    every = {str(code) for campaign in site.boreholes for log in campaign.logs for code in np.unique(log.code)}
    styles = lithology_style(sorted(every))
    parts = [
        ActorPart(lines(_runs(runs, look), styles[code][0], 2.0), width=LOGGED) for code, runs in sorted(pieces.items())
    ]
    swatches = tuple(Swatch(styles[code][0], code) for code in sorted(pieces))
    return parts, Legend(layer.colour_by, "", swatches)


def dips_item(dips: Orientations, width: float, layer: Layer, look: Look) -> Item:
    """Return a small disc for each measured dip, lying as it was measured."""
    a, d = np.radians(dips.azimuth), np.radians(dips.dip)
    strike = np.stack([np.cos(a), -np.sin(a), 0 * a], axis=1)
    down = np.stack([np.sin(a) * np.cos(d), np.cos(a) * np.cos(d), -np.sin(d)], axis=1)
    turn = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)
    rim = np.cos(turn)[:, None, None] * strike + np.sin(turn)[:, None, None] * down
    xyz = (dips.xyz + DISC * width * rim).transpose(1, 0, 2).reshape(-1, 3)
    first = CORNERS * np.arange(len(dips))[:, None]
    k = np.arange(1, CORNERS - 1)
    fan = np.stack([0 * k + first, k + first, k + 1 + first], axis=-1).reshape(-1, 3)
    normals = np.repeat(np.cross(strike, down), CORNERS, axis=0)
    colour = "#e08a3c" if look.dark else "#b2611b"
    ends = CORNERS * np.arange(len(dips))
    rings = [np.append(np.arange(e, e + CORNERS), e) for e in ends]
    parts = [
        ActorPart(triangles(poly(xyz - look.origin, faces=fan, normals=normals), colour), opacity=0.85),
        ActorPart(lines(poly(xyz - look.origin, runs=rings), look.text), width=1.0),
    ]
    names = [f"{azimuth:03.0f}/{dip:02.0f}" for azimuth, dip in zip(dips.azimuth, dips.dip, strict=True)]
    return Item(parts, corners_of(xyz), places=dips.xyz, names=tuple(names) if layer.labels else (), targets=dips.xyz)

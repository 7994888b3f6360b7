"""Bodies in a section: what the curtain cuts out of them, with the contacts and logged intervals near it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from geofit.bodies.data import BodyData
from geofit.gui.panels.canvas import PlotColours
from geofit.gui.panels.curtain import Curtain
from geofit.implicit.mesh import TriangleMesh
from geofit.sampling.mesh_section import mesh_section

__all__ = ["SectionBody", "draw_bodies"]

Floats = NDArray[np.float64]

#: How strongly the inside of a body is filled, times its opacity.
FILL = 0.30
#: Widths of logged intervals inside and outside a body, points.
INSIDE, OUTSIDE = 3.0, 1.0


@dataclass(frozen=True, eq=False)
class SectionBody:
    """A body to be cut: triangles in map coordinates, colour, opacity, and what it was fitted to, if anything.

    A ``dashed`` one is drawn as an outline alone: it is a preview.
    """

    name: str
    mesh: TriangleMesh
    colour: str
    opacity: float = 1.0
    data: BodyData | None = None
    dashed: bool = False


def draw_bodies(
    axes: Axes, bodies: Sequence[SectionBody], curtain: Curtain, thickness: float, colours: PlotColours
) -> None:
    """Draw bodies under the holes and traces of a section."""
    for body in bodies:
        colour, named = colours.of(body.colour), False
        for outline in mesh_section(body.mesh.vertices, body.mesh.triangles, curtain.line):
            path = _path(outline)
            if not body.dashed:
                axes.add_patch(PathPatch(path, fc=colour, alpha=FILL * body.opacity, lw=0, zorder=1.5))
            label, style = None if named else body.name, "--" if body.dashed else "-"
            edge = PathPatch(path, fill=False, ec=colour, lw=1.7, ls=style, zorder=4.1, label=label)
            axes.add_patch(edge)
            axes.update_datalim(path.vertices)
            named = True
        if body.data is not None:
            _data(axes, body.data, curtain, thickness, colour, colours)


def _path(outline: Any) -> Path:
    """Return a polygon or several as one path; holes turn the other way, so that they stay empty."""
    import shapely

    paths = []
    for part in shapely.get_parts(outline):
        if part.geom_type == "Polygon":
            turned = shapely.geometry.polygon.orient(part)
            paths += [Path(np.asarray(ring.coords), closed=True) for ring in (turned.exterior, *turned.interiors)]
    return Path.make_compound_path(*paths)


def _data(axes: Axes, data: BodyData, curtain: Curtain, thickness: float, colour: str, colours: PlotColours) -> None:
    sides = (
        (data.outside, data.outside_hole, data.outside_length, colours.muted, OUTSIDE),
        (data.inside, data.inside_hole, data.inside_length, colour, INSIDE),
    )
    for xyz, hole, length, shade, width in sides:
        cut = (_beside(run, curtain, thickness) for run in _runs(xyz, hole, length))
        runs = [run for run in cut if run is not None]
        axes.add_collection(LineCollection(runs, colors=shade, linewidths=width, capstyle="butt", zorder=3.2))
        for run in runs:
            axes.update_datalim(run)
    contacts = _beside(data.contacts, curtain, thickness, several=False)
    if contacts is not None:
        axes.plot(*contacts.T, ls="none", marker="o", ms=4.5, color=colour, mec=colours.paper, mew=0.6, zorder=5)


def _runs(xyz: Floats, hole: NDArray[np.str_], length: Floats) -> Iterable[Floats]:
    """Return logged stretches as lines (k, 3): samples that follow each other, with half a sample at each end."""
    if not len(xyz):
        return
    gap = np.linalg.norm(np.diff(xyz, axis=0), axis=1)
    known = np.nan_to_num(length)
    apart = (hole[1:] != hole[:-1]) | (hole[1:] == "") | (gap > 1.01 * np.maximum(known[1:], known[:-1]))
    for part in np.split(np.arange(len(xyz)), np.flatnonzero(apart) + 1):
        places, half = xyz[part], known[part[0]] / 2
        way = places[-1] - places[0] if len(part) > 1 else np.array([0.0, 0.0, -1.0])
        way = way / max(float(np.linalg.norm(way)), 1e-12)
        yield np.concatenate([places[:1] - half * way, places, places[-1:] + half * way])


def _beside(xyz: Floats, curtain: Curtain, thickness: float, *, several: bool = True) -> Floats | None:
    """Return distance and elevation of places within the thickness; of a line with two such places at least."""
    if not len(xyz):
        return None
    along, beside = curtain.project(xyz[:, :2])
    near = beside <= thickness / 2
    return np.column_stack([along[near], xyz[near, 2]]) if near.sum() >= (2 if several else 1) else None

"""A body on a vertical section: its outline, and the lines of equal chance of lying inside about it."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.posterior import BodyPosterior
from geofit.sampling.cut import section_line
from geofit.sampling.mesh_section import mesh_section

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit
    from geofit.implicit.mesh import TriangleMesh

__all__ = ["chance_lines", "outline_rings"]

Floats = NDArray[np.float64]

#: The band: a place on its outer line lies inside with this chance, one on its inner line outside.
CHANCE = 0.1
#: Nodes of the raster on which the chance is evaluated, along the longer side of what is shown.
NODES = 120


def outline_rings(mesh: TriangleMesh, line: ArrayLike) -> tuple[Floats, ...]:
    """Return the closed outlines (k, 2) of a closed mesh on a vertical section: distance along it and elevation.

    Outlines run anticlockwise, those of holes clockwise.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed triangles in the coordinates of the line, metres.
    line : (k, 2) array_like
        Corners of the section in plan, metres.
    """
    import shapely

    rings = []
    for outline in mesh_section(mesh.vertices, mesh.triangles, line):
        for part in shapely.get_parts(outline):
            if part.geom_type == "Polygon":
                turned = shapely.geometry.polygon.orient(part)
                rings += [np.asarray(ring.coords)[:-1, :2] for ring in (turned.exterior, *turned.interiors)]
    return tuple(rings)


def chance_lines(body: BodyFit, line: ArrayLike) -> tuple[Floats, ...]:
    """Return the lines (k, 2) on a vertical section between which the surface of a body lies with 80 % chance.

    Where the data leave nothing open both lines fall on the outline.

    Parameters
    ----------
    body : BodyFit
        The body.
    line : (k, 2) array_like
        Corners of the section in plan, map coordinates, metres.
    """
    import contourpy

    posterior = BodyPosterior(body)
    lower, upper = (corner + body.origin for corner in body.extent)
    margin = body.region.reach / 2
    lower, upper = lower - margin, upper + margin
    found: list[Floats] = []
    at = 0.0
    for start, end in pairwise(section_line(line)):
        length = float(np.linalg.norm(end - start))
        shares = _within(start, end, lower, upper)
        if shares is not None:
            first, last = at + length * shares[0], at + length * shares[1]
            step = max(last - first, upper[2] - lower[2]) / NODES
            s = np.linspace(first, last, max(int((last - first) / step), 2) + 1)
            z = np.linspace(lower[2], upper[2], max(int((upper[2] - lower[2]) / step), 2) + 1)
            plan = start + ((s - at) / length)[:, None] * (end - start)
            places = np.column_stack([np.tile(plan, (len(z), 1)), np.repeat(z, len(s))])
            for chance in (CHANCE, 1 - CHANCE):
                values = posterior.margin(places, chance).reshape(len(z), len(s))
                found += [np.asarray(one) for one in contourpy.contour_generator(s, z, values).lines(0.0)]
        at += length
    return tuple(found)


def _within(start: Floats, end: Floats, lower: Floats, upper: Floats) -> tuple[float, float] | None:
    """Return from where to where a leg of the section lies over a box in plan, as shares of it; None: nowhere."""
    way = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.sort(np.stack([(lower[:2] - start) / way, (upper[:2] - start) / way]), axis=0)
    level = way == 0
    if (level & ((start < lower[:2]) | (start > upper[:2]))).any():
        return None
    sides[:, level] = np.array([[-np.inf], [np.inf]])
    first, last = max(0.0, float(sides[0].max())), min(1.0, float(sides[1].min()))
    return (first, last) if last > first else None

"""Closed triangle meshes cut by a vertical curtain: filled outlines, distance along the curtain against elevation."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.geometry.chains import chains_of
from geofit.sampling.cut import section_line

if TYPE_CHECKING:
    import shapely

__all__ = ["mesh_section"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Corners of the mesh nearer than this to the plane are moved off it, as a share of the mesh's size.
OFF = 1e-9


def mesh_section(vertices: Floats, triangles: Ints, line: ArrayLike) -> tuple[shapely.Geometry, ...]:
    """Return what a vertical curtain cuts out of a closed body.

    Parameters
    ----------
    vertices : (n, 3) array
        Vertices in metres, in the coordinates of the line.
    triangles : (m, 3) array of int
        A closed mesh.
    line : (k, 2) array_like
        Corners of the curtain in plan.

    Returns
    -------
    tuple of shapely geometry
        One polygon or multipolygon for each leg of the curtain that meets the body: x is the distance from the first
        corner along the line, y the elevation, metres. Holes are holes of the polygons.

    Raises
    ------
    SettingsError
        If the line has fewer than two different corners.
    """
    import shapely
    import shapely.affinity

    corners = section_line(line)
    found = []
    at = 0.0
    for start, end in pairwise(corners):
        length = float(np.linalg.norm(end - start))
        way = (end - start) / length
        along = (vertices[:, :2] - start) @ way
        beside = (vertices[:, :2] - start) @ np.array([way[1], -way[0]])
        loops = _loops(along, vertices[:, 2], beside, triangles)
        whole: shapely.Geometry = shapely.Polygon()
        for loop in loops:
            # A loop within another is a hole, one within that an island.
            whole = shapely.symmetric_difference(whole, shapely.make_valid(shapely.Polygon(loop)))
        if loops:
            low, high = float(vertices[:, 2].min()) - 1, float(vertices[:, 2].max()) + 1
            leg = shapely.intersection(whole, shapely.box(0.0, low, length, high))
            if not leg.is_empty and leg.area > 0:
                found.append(shapely.affinity.translate(leg, at))
        at += length
    return tuple(found)


def _loops(along: Floats, height: Floats, beside: Floats, triangles: Ints) -> list[Floats]:
    """Return the closed lines (k, 2) in which triangles cross the plane where ``beside`` vanishes."""
    size = float(np.ptp(beside)) if len(beside) else 0.0
    beside = np.where(np.abs(beside) <= OFF * size, OFF * size, beside)
    side = beside > 0
    crossing = triangles[side[triangles].any(axis=1) & ~side[triangles].all(axis=1)]
    if not len(crossing):
        return []
    edges = np.sort(crossing[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
    crossed = side[edges[..., 0]] != side[edges[..., 1]]
    # Each triangle that crosses has two edges that do.
    pairs = edges[crossed].reshape(-1, 2, 2)
    known, node = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    node = node.reshape(-1, 2)
    share = beside[known[:, 0]] / (beside[known[:, 0]] - beside[known[:, 1]])
    ends = np.stack([along, height], axis=1)
    places = ends[known[:, 0]] + share[:, None] * (ends[known[:, 1]] - ends[known[:, 0]])
    return [places[chain] for chain in chains_of(node, len(known)) if len(chain) > 3]

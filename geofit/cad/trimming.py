"""Trimming a surface to a plan polygon.

Over a height field a straight line of the plan is a straight line of the parameters, so the trimmed faces are
built exactly. Other surfaces are cut with a vertical prism, whose section curves OpenCASCADE approximates (to
about 1e-3 m).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import to_geom
from geofit.geometry.elevation import plan_map
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import Surface

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["cut_along", "faces", "is_height_field", "needed"]

Floats = NDArray[np.float64]

#: The 3D curves of trimmed edges follow the surface within this (metres).
CURVE = 1e-8
#: Corners nearer than this (metres) are one, and slivers narrower than this are left out.
SMALL = 1e-6


def is_height_field(surface: Surface) -> bool:
    """Whether every patch is a height field over the map."""
    return all(plan_map(patch) is not None for patch in surface.patches)


def needed(surface: Surface, tolerance: float) -> Polygon | None:
    """Return the outline in local coordinates if it cuts something off the surface, else None."""
    if surface.outline is None:
        return None
    import shapely

    outline = shapely.Polygon(np.asarray(surface.outline, float) - surface.origin[:2])
    if is_height_field(surface):
        wider = outline.buffer(tolerance, join_style="mitre")
        return None if all(wider.covers(_quad(patch)) for patch in surface.patches) else outline
    samples = []
    for patch in surface.patches:
        u, v = (_places(knots) for knots in (patch.knots_u, patch.knots_v))
        samples.append(patch.evaluate(u[:, None], v[None, :])[..., :2].reshape(-1, 2))
    shapely.prepare(outline)
    return None if shapely.dwithin(outline, shapely.points(np.concatenate(samples)), tolerance).all() else outline


def _places(knots: Floats) -> Floats:
    """Return parameters close enough to each other that what the patch does between them is seen."""
    breaks = np.unique(knots)
    pieces = max(4, -(-40 // (len(breaks) - 1)))
    return np.interp(np.linspace(0, len(breaks) - 1, pieces * (len(breaks) - 1) + 1), np.arange(len(breaks)), breaks)


def faces(patch: Patch, outline: Polygon) -> list[Any]:
    """Return the faces of a height-field patch inside an outline (local coordinates), with exact edges."""
    import shapely

    mapping = plan_map(patch)
    assert mapping is not None
    quad = _quad(patch)
    if outline.buffer(SMALL, join_style="mitre").covers(quad):
        pieces = [quad]
    else:
        pieces = list(shapely.get_parts(shapely.intersection(outline, quad)))
    surface, result = to_geom(patch), []
    for piece in pieces:
        if piece.geom_type != "Polygon" or piece.buffer(-SMALL).is_empty:
            continue
        rings = []
        for ring in (piece.exterior, *piece.interiors):
            plan = _distinct(shapely.get_coordinates(ring)[:-1])
            uv = mapping.parameters(plan.T).T
            rings.append(_snapped(uv, patch))
        result.append(_face(surface, rings))
    return result


def _quad(patch: Patch) -> Polygon:
    """Return the plan of a height-field patch."""
    import shapely

    mapping = plan_map(patch)
    assert mapping is not None
    u0, u1, v0, v1 = patch.domain
    return shapely.Polygon(np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]) @ mapping.matrix.T + mapping.start)


def _distinct(ring: Floats) -> Floats:
    apart = np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1) > SMALL
    return np.asarray(ring[apart])


def _snapped(uv: Floats, patch: Patch) -> Floats:
    """Put corners that lie on the patch's edge, up to rounding, exactly on it."""
    ends = np.array(patch.domain).reshape(2, 2)
    near = 1e-10 * (ends[:, 1] - ends[:, 0])
    for axis in (0, 1):
        for end in ends[axis]:
            uv[np.abs(uv[:, axis] - end) <= near[axis], axis] = end
    return uv


def _face(surface: Any, rings: list[Floats]) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace

    builder = BRepBuilderAPI_MakeFace(surface, _wire(surface, rings[0], True), True)
    for ring in rings[1:]:
        builder.Add(_wire(surface, ring, False))
    return builder.Face()


def _wire(surface: Any, ring: Floats, outer: bool) -> Any:
    """Edges along straight parameter lines, counter-clockwise for the outer ring."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex, BRepBuilderAPI_MakeWire
    from OCP.BRepLib import BRepLib
    from OCP.GCE2d import GCE2d_MakeSegment
    from OCP.GeomAbs import GeomAbs_C0
    from OCP.gp import gp_Pnt2d

    x, y = ring.T
    turns_left = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0
    if turns_left != outer:
        ring = ring[::-1]
    vertices = [BRepBuilderAPI_MakeVertex(surface.Value(*uv)).Vertex() for uv in ring.tolist()]
    wire = BRepBuilderAPI_MakeWire()
    for k, start in enumerate(ring.tolist()):
        nxt = (k + 1) % len(ring)
        line = GCE2d_MakeSegment(gp_Pnt2d(*start), gp_Pnt2d(*ring[nxt].tolist())).Value()
        edge = BRepBuilderAPI_MakeEdge(line, surface, vertices[k], vertices[nxt]).Edge()
        BRepLib.BuildCurve3d_s(edge, CURVE, GeomAbs_C0, 14, 1000)
        wire.Add(edge)
    return wire.Wire()


def cut_along(shape: Any, outline: Polygon) -> Any:
    """Return the part of a shape inside the vertical prism over an outline."""
    import shapely
    from OCP.Bnd import Bnd_Box
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    low, high = box.CornerMin().Z() - 1.0, box.CornerMax().Z() + 1.0
    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in shapely.get_coordinates(outline.exterior)[:-1].tolist():
        polygon.Add(gp_Pnt(x, y, low))
    polygon.Close()
    base = BRepBuilderAPI_MakeFace(polygon.Wire(), True).Face()
    return BRepAlgoAPI_Common(shape, BRepPrimAPI_MakePrism(base, gp_Vec(0, 0, high - low)).Shape()).Shape()

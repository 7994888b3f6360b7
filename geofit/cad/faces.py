"""Patches as OpenCASCADE geometry and back, and questions put to a shape's topology.

OpenCASCADE is imported inside the functions: it takes seconds to load. Its shapes and curves are typed
``Any``.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.splines.patch import Patch

__all__ = [
    "compound_of",
    "edge_places",
    "edges_with_faces",
    "explore",
    "faces_of",
    "free_edges",
    "free_loops",
    "from_geom",
    "placement",
    "to_geom",
]

Floats = NDArray[np.float64]


def to_geom(patch: Patch) -> Any:
    """Return a patch as Geom_BSplineSurface, in the patch's coordinates."""
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array2OfReal

    nu, nv = patch.control.shape[:2]
    poles = TColgp_Array2OfPnt(1, nu, 1, nv)
    rows, columns = (np.ravel(grid).tolist() for grid in np.mgrid[1 : nu + 1, 1 : nv + 1])
    places = map(gp_Pnt, *patch.control.reshape(-1, 3).T.tolist())
    # A loop in C: there are thousands of poles.
    deque(map(poles.SetValue, rows, columns, places), maxlen=0)
    knots_u, count_u = _occ_knots(patch.knots_u)
    knots_v, count_v = _occ_knots(patch.knots_v)
    if patch.weights is None:
        return Geom_BSplineSurface(poles, knots_u, knots_v, count_u, count_v, *patch.degree)
    weights = TColStd_Array2OfReal(1, nu, 1, nv)
    for i, values in enumerate(patch.weights.tolist(), 1):
        for j, value in enumerate(values, 1):
            weights.SetValue(i, j, value)
    return Geom_BSplineSurface(poles, weights, knots_u, knots_v, count_u, count_v, *patch.degree)


def _occ_knots(knots: Floats) -> tuple[Any, Any]:
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

    values, counts = np.unique(knots, return_counts=True)
    reals, integers = TColStd_Array1OfReal(1, len(values)), TColStd_Array1OfInteger(1, len(values))
    for k, (value, count) in enumerate(zip(values.tolist(), counts.tolist(), strict=True), 1):
        reals.SetValue(k, value)
        integers.SetValue(k, count)
    return reals, integers


def from_geom(name: str, surface: Any) -> Patch:
    """Return a Geom_BSplineSurface (not periodic) as a patch."""
    nu, nv = surface.NbUPoles(), surface.NbVPoles()
    poles = [[surface.Pole(i, j) for j in range(1, nv + 1)] for i in range(1, nu + 1)]
    weights = None
    if surface.IsURational() or surface.IsVRational():
        weights = np.array([[surface.Weight(i, j) for j in range(1, nv + 1)] for i in range(1, nu + 1)])
    return Patch(
        name=name,
        degree=(surface.UDegree(), surface.VDegree()),
        knots_u=np.array(list(surface.UKnotSequence())),
        knots_v=np.array(list(surface.VKnotSequence())),
        control=np.array([[(p.X(), p.Y(), p.Z()) for p in row] for row in poles]),
        weights=weights,
    )


def placement(origin: Floats) -> Any:
    """Return the TopLoc_Location that moves local coordinates to map coordinates."""
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    move = gp_Trsf()
    move.SetTranslation(gp_Vec(*(float(c) for c in origin)))
    return TopLoc_Location(move)


def compound_of(shapes: Iterable[Any]) -> Any:
    """Return a TopoDS_Compound of shapes, in order."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    result, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(result)
    for shape in shapes:
        builder.Add(result, shape)
    return result


def explore(shape: Any, kind: Any, outside: Any = None) -> Iterator[Any]:
    """Walk over the parts of one kind (TopAbs_FACE, ...) in a shape, or those ``outside`` parts of another kind."""
    from OCP.TopAbs import TopAbs_SHAPE
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind, TopAbs_SHAPE if outside is None else outside)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def faces_of(shape: Any) -> list[Any]:
    """Return the faces of a shape."""
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopoDS import TopoDS

    return [TopoDS.Face_s(face) for face in explore(shape, TopAbs_FACE)]


def edges_with_faces(shape: Any) -> list[tuple[Any, list[Any]]]:
    """Return every edge of a shape (collapsed ones left out) with the faces that meet there."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

    table = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, table)
    found = []
    for k in range(1, table.Extent() + 1):
        edge = TopoDS.Edge_s(table.FindKey(k))
        if not BRep_Tool.Degenerated_s(edge):
            found.append((edge, _faces_in(table.FindFromIndex(k))))
    return found


def _faces_in(shapes: Any) -> list[Any]:
    """Return the faces of a list of OpenCASCADE's; its iterator takes 0.4 ms to begin, most lists hold one or two."""
    from OCP.TopoDS import TopoDS

    few = {1: (shapes.First,), 2: (shapes.First, shapes.Last)}.get(shapes.Extent())
    return [TopoDS.Face_s(face) for face in (shapes if few is None else (one() for one in few))]


def free_edges(shape: Any) -> list[Any]:
    """Return the edges that belong to one face only."""
    return [edge for edge, faces in edges_with_faces(shape) if len(faces) == 1]


def free_loops(shape: Any) -> int:
    """Count the closed loops that the free edges of a shape make; 0 for none, -1 if some do not close."""
    from OCP.TopExp import TopExp
    from OCP.TopTools import TopTools_IndexedMapOfShape
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    vertices = TopTools_IndexedMapOfShape()
    ends = [
        [vertices.Add(TopExp.FirstVertex_s(edge)) - 1, vertices.Add(TopExp.LastVertex_s(edge)) - 1]
        for edge in free_edges(shape)
    ]
    if not ends:
        return 0
    index = np.array(ends)
    if (np.bincount(index.ravel()) != 2).any():
        return -1
    size = vertices.Extent()
    graph = coo_array((np.ones(len(index)), (index[:, 0], index[:, 1])), shape=(size, size))
    return int(connected_components(graph, directed=False)[0])


def edge_places(edge: Any, count: int) -> Floats:
    """Return places (count, 3) along an edge, evenly in its parameter."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    values = np.linspace(curve.FirstParameter(), curve.LastParameter(), count)
    return np.array([(p.X(), p.Y(), p.Z()) for p in (curve.Value(float(t)) for t in values)])

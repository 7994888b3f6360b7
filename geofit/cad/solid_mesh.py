"""Solids of a STEP file as closed triangle meshes.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import explore, faces_of
from geofit.cad.foreign import read_in_child
from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh

__all__ = ["read_solids", "solid_meshes", "solid_triangles"]

Floats = NDArray[np.float64]

#: Largest distance of triangles from the faces, as a share of the solid's size, and angle between neighbours, radians.
DEFLECTION, ANGLE = 5e-4, 0.2
#: Vertices nearer than this share of the solid's size are one.
WELD = 1e-8


def read_solids(path: str | PathLike[str]) -> dict[str, TriangleMesh]:
    """Read the solids of a STEP file as triangles, one mesh for each product, in map coordinates and metres.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no solid.
    """
    return read_in_child(path, "solid")


def solid_meshes(path: str | PathLike[str]) -> dict[str, TriangleMesh]:
    """Read a STEP file in this process, which a damaged file may end; see :func:`read_solids`."""
    from OCP.TopAbs import TopAbs_SOLID

    from geofit.cad.step import read_shapes

    found = {}
    for shape in read_shapes(path):
        if any(True for _ in explore(shape.shape, TopAbs_SOLID)):
            found[shape.name] = solid_triangles(shape.shape.Located(shape.location))
    if not found:
        raise InputError(
            message("cad.no-solid", "The file holds no solid"),
            message("cad.export-solid", "Export the body as a STEP solid."),
            file=str(path),
        )
    return found


def solid_triangles(shape: Any) -> TriangleMesh:
    """Return the triangles of an OpenCASCADE shape's faces, joined along their edges."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    bounds = np.array(box.Get())
    size = float(np.linalg.norm(bounds[3:] - bounds[:3]))
    BRepMesh_IncrementalMesh(shape, DEFLECTION * size, False, ANGLE, False)
    vertices: list[Floats] = []
    triangles: list[NDArray[np.int64]] = []
    count = 0
    for face in faces_of(shape):
        location = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            continue
        move = location.Transformation()
        nodes = [mesh.Node(k).Transformed(move) for k in range(1, mesh.NbNodes() + 1)]
        corners = np.array([mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)]) - 1
        vertices.append(np.array([(p.X(), p.Y(), p.Z()) for p in nodes]))
        triangles.append((corners[:, ::-1] if face.Orientation() == TopAbs_REVERSED else corners) + count)
        count += len(nodes)
    xyz, faces = np.concatenate(vertices), np.concatenate(triangles)
    # Neighbouring faces have the same nodes on their common edge.
    _, first, index = np.unique(
        np.rint((xyz - bounds[:3]) / (WELD * size)).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    faces = index.reshape(-1)[faces]
    sound = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return TriangleMesh(xyz[first], faces[sound])

"""The solid of a body: sewn from NURBS patches, or made of triangles. OpenCASCADE is imported inside the functions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import compound_of, explore, faces_of, free_edges, from_geom, to_geom
from geofit.data.errors import StitchError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh
from geofit.splines.patch import Patch

__all__ = ["patch_solid", "triangle_solid", "volume_of"]

Floats = NDArray[np.float64]

#: Edges nearer than this (metres) are one edge: neighbours share their control points.
SEWING = 1e-6
#: Cells along each side of a face, by which a shell shows whether its faces look inwards.
CELLS = 8


def patch_solid(components: Sequence[Sequence[Patch]]) -> Any:
    """Return the solid that closed groups of patches bound, or a compound of several, in the patches' coordinates.

    A component whose patches face inwards is a cavity of the smallest solid around it.

    Raises
    ------
    StitchError
        If a group does not close, or OpenCASCADE finds the solid invalid.
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.TopAbs import TopAbs_SHELL
    from OCP.TopoDS import TopoDS

    shells = []
    for patches in components:
        sewing = BRepBuilderAPI_Sewing(SEWING)
        for patch in patches:
            sewing.Add(BRepBuilderAPI_MakeFace(to_geom(patch), SEWING).Face())
        sewing.Perform()
        sewn = sewing.SewedShape()
        found = [TopoDS.Shell_s(part) for part in explore(sewn, TopAbs_SHELL)]
        if len(found) != 1 or free_edges(found[0]):
            raise StitchError(
                message(
                    "cad.patches-open",
                    "{count} patches of a body do not make one closed shell. Write triangles instead.",
                    count=len(patches),
                )
            )
        shells.append(found[0])
    return _solids(shells)


def triangle_solid(mesh: TriangleMesh) -> Any:
    """Return the solid that a closed triangle mesh bounds, one tessellated face a component, without surfaces.

    Raises
    ------
    StitchError
        If the mesh is not closed.
    """
    from OCP.BRep import BRep_Builder
    from OCP.gp import gp_Pnt
    from OCP.Poly import Poly_Triangle, Poly_Triangulation
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shell, TopoDS_Solid

    if not mesh.is_closed:
        raise StitchError(
            message(
                "cad.triangles-open",
                "The triangles do not close: {count} edges are free.",
                count=len(mesh.boundary_edges),
            )
        )
    builder = BRep_Builder()
    solids = []
    for part in mesh.split():
        triangulation = Poly_Triangulation(len(part.vertices), len(part.triangles), False)
        for k, vertex in enumerate(part.vertices.tolist(), 1):
            triangulation.SetNode(k, gp_Pnt(*vertex))
        for k, corners in enumerate((part.triangles + 1).tolist(), 1):
            triangulation.SetTriangle(k, Poly_Triangle(*corners))
        face, shell, solid = TopoDS_Face(), TopoDS_Shell(), TopoDS_Solid()
        builder.MakeFace(face, triangulation)
        builder.MakeShell(shell)
        builder.Add(shell, face)
        shell.Closed(True)
        builder.MakeSolid(solid)
        builder.Add(solid, shell)
        solids.append(solid)
    return compound_of(solids)


def _solids(shells: Sequence[Any]) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid
    from OCP.BRepCheck import BRepCheck_Analyzer

    makers, boxes, cavities = [], [], []
    for shell in shells:
        if _inward(shell):
            cavities.append(shell)
        else:
            makers.append(BRepBuilderAPI_MakeSolid(shell))
            boxes.append(_box(shell))
    for shell in cavities:
        low, high = _box(shell)
        around = [k for k, (first, last) in enumerate(boxes) if (first <= low).all() and (high <= last).all()]
        if not around:
            raise StitchError(
                message(
                    "cad.cavity-outside", "A cavity of the body lies in none of its solids. Write triangles instead."
                )
            )
        makers[min(around, key=lambda k: float((boxes[k][1] - boxes[k][0]).prod()))].Add(shell)
    solids = [maker.Solid() for maker in makers]
    result = solids[0] if len(solids) == 1 else compound_of(solids)
    if not BRepCheck_Analyzer(result).IsValid():
        raise StitchError(
            message(
                "cad.solid-invalid",
                "OpenCASCADE finds the solid of the body invalid (BRepCheck). Write triangles instead.",
            )
        )
    return result


def _inward(shell: Any) -> bool:
    """Whether the faces of a closed shell look inwards: by the volume under cells of their surfaces, which are whole.

    OpenCASCADE's own volume is exact, and takes a hundred times as long.
    """
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_REVERSED

    share, total = np.linspace(0, 1, CELLS + 1), 0.0
    for face in faces_of(shell):
        patch = from_geom("", BRep_Tool.Surface_s(face))
        u0, u1, v0, v1 = patch.domain
        xyz = patch.evaluate(u0 + share[:, None] * (u1 - u0), v0 + share[None] * (v1 - v0))
        a, b, c, d = xyz[:-1, :-1], xyz[1:, :-1], xyz[1:, 1:], xyz[:-1, 1:]
        volume = float(((a + b + c + d) * np.cross(c - a, d - b)).sum())
        total += -volume if face.Orientation() == TopAbs_REVERSED else volume
    return total < 0


def volume_of(shape: Any) -> float:
    """Return the volume of a shape, negative where its faces look inwards."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())


def _box(shape: Any) -> tuple[Floats, Floats]:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    bounds = np.array(box.Get())
    return bounds[:3], bounds[3:]

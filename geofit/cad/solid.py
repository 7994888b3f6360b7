"""A body as an OpenCASCADE solid: sewn from NURBS patches or made of triangles, written as STEP AP242, read back.

OpenCASCADE is imported inside the functions: it takes seconds to load. The geometry stays about the body's local
origin; the offset to map coordinates is the placement of the product.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import explore, faces_of, free_edges, from_geom, placement, to_geom
from geofit.data.accuracy import Check
from geofit.data.errors import InputError, StitchError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh
from geofit.splines.patch import Patch

if TYPE_CHECKING:
    from geofit.bodies.implicit_body import ImplicitBody

__all__ = ["SolidReadBack", "patch_solid", "triangle_solid", "write_body"]

Floats = NDArray[np.float64]

#: Edges nearer than this (metres) are one edge: neighbours share their control points.
SEWING = 1e-6
#: Largest difference of volumes between the file and the triangulated body, relative: NURBS, triangles.
VOLUME = {"nurbs": 2e-3, "triangles": 1e-6}
SCHEMA = "AP242DIS"
TIMESTAMP = "2000-01-01T00:00:00"


@dataclass(frozen=True)
class SolidReadBack:
    """What an independent reader (OpenCASCADE) finds in the file of a body.

    ``grade`` is "nurbs" or "triangles". ``volume`` (m3) is that of the solids in the file, ``deviation`` the largest
    distance in metres of the file's faces from the surface of the body, ``sigma`` and ``max_abs`` are of the contacts'
    distances from the faces (nan for triangles), ``edge_tolerance`` is the largest in the file, metres.
    """

    file: str
    sha256: str
    grade: str
    faces: int
    solids: int
    volume: float
    deviation: float
    sigma: float
    max_abs: float
    brep_valid: bool
    free_edges: int
    edge_tolerance: float
    checks: tuple[Check, ...]

    @property
    def passed(self) -> bool:
        """Whether every check of the file passes."""
        return all(check.passed is not False for check in self.checks)


def write_body(
    body: ImplicitBody,
    path: str | PathLike[str],
    patches: Sequence[Sequence[Patch]] = (),
    reason: str = "",
    shape: Any = None,
) -> SolidReadBack:
    """Write a body as a STEP AP242 solid, read it back and check it.

    Parameters
    ----------
    body : ImplicitBody
        The body.
    path : path
        The file, usually ``*.step``.
    patches : sequence of sequence of Patch
        Closed groups of NURBS patches, about the body's local origin; without them, or where they cannot be sewn, the
        overview's triangles are written.
    reason : str
        Why patches could not be written although requested; the check "grade" reports it.
    shape : TopoDS_Shape, optional
        The solid itself, about the body's local origin, in place of patches: its faces may be trimmed.

    Raises
    ------
    InputError
        If the body is empty, or the file cannot be written.
    """
    target = Path(path)
    if not len(body.overview.triangles):
        raise InputError(
            message("cad.body-empty", "The body '{name}' is empty", name=body.name),
            message("cad.check-data", "Check its data."),
            file=str(target),
        )
    trimmed = shape is not None
    if patches:
        try:
            shape = patch_solid(patches)
        except StitchError as error:
            reason = str(error)
    smooth = shape is not None
    _write(shape if smooth else triangle_solid(body.overview), body.name, body.origin, target, nurbs=smooth)
    found = _read_back(body, target, nurbs=smooth, trimmed=trimmed)
    if not reason:
        return found
    text = message(
        "cad.triangles-instead-of-patches", "Triangles are written in place of NURBS patches: {reason}", reason=reason
    )
    return replace(found, checks=(*found.checks, Check("grade", None, 0.0, 0.0, "1", text)))


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
    from OCP.TopoDS import TopoDS_Compound, TopoDS_Face, TopoDS_Shell, TopoDS_Solid

    if not mesh.is_closed:
        raise StitchError(
            message(
                "cad.triangles-open",
                "The triangles do not close: {count} edges are free.",
                count=len(mesh.boundary_edges),
            )
        )
    builder = BRep_Builder()
    compound, solids = TopoDS_Compound(), []
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
    builder.MakeCompound(compound)
    for solid in solids:
        builder.Add(compound, solid)
    return compound


def _solids(shells: Sequence[Any]) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopoDS import TopoDS_Compound

    makers, boxes, cavities = [], [], []
    for shell in shells:
        if _volume(shell) < 0:
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
    if len(solids) == 1:
        result = solids[0]
    else:
        result, builder = TopoDS_Compound(), BRep_Builder()
        builder.MakeCompound(result)
        for solid in solids:
            builder.Add(result, solid)
    if not BRepCheck_Analyzer(result).IsValid():
        raise StitchError(
            message(
                "cad.solid-invalid",
                "OpenCASCADE finds the solid of the body invalid (BRepCheck). Write triangles instead.",
            )
        )
    return result


def _volume(shape: Any) -> float:
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


@contextmanager
def _parameters(*, nurbs: bool) -> Iterator[None]:
    """Set OpenCASCADE's global STEP parameters, and put them back."""
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_Controller

    STEPControl_Controller.Init_s()
    words = {"write.step.schema": SCHEMA, "xstep.cascade.unit": "M", "write.step.unit": "M"}
    counts = {"write.step.tessellated": 0 if nurbs else 1, "read.step.tessellated": 1, "write.precision.mode": 0}
    before = {**{k: Interface_Static.CVal_s(k) for k in words}, **{k: Interface_Static.IVal_s(k) for k in counts}}
    try:
        for name, word in words.items():
            Interface_Static.SetCVal_s(name, word)
        for name, count in counts.items():
            Interface_Static.SetIVal_s(name, count)
        yield
    finally:
        for name, value in before.items():
            setter: Any = Interface_Static.SetCVal_s if isinstance(value, str) else Interface_Static.SetIVal_s
            setter(name, value)


def _write(shape: Any, name: str, origin: Floats, target: Path, *, nurbs: bool) -> None:
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    from geofit import __version__
    from geofit.cad.imported import empty_document, quiet
    from geofit.cad.step_text import canonical

    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=".step")
    except OSError as error:
        raise InputError(
            message("data.file-not-written", "The file cannot be written: {error}", error=error.strerror or str(error)),
            message("data.make-or-name-folder", "Make the folder, or name another."),
            file=str(target),
        ) from None
    os.close(handle)
    try:
        with _parameters(nurbs=nurbs), quiet():
            filled = empty_document()
            tool = XCAFDoc_DocumentTool.ShapeTool_s(filled.Main())
            assembly, product = tool.NewShape(), tool.AddShape(shape, False)
            for label, text in (
                (assembly, "bodies"),
                (product, name),
                (tool.AddComponent(assembly, product, placement(origin)), name),
            ):
                TDataStd_Name.Set_s(label, TCollection_ExtendedString(text, True))
            tool.UpdateAssemblies()
            writer = STEPCAFControl_Writer()
            writer.SetNameMode(True)
            writer.Transfer(filled)
            header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
            header.SetName(TCollection_HAsciiString("bodies"))
            header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP))
            header.SetAuthorValue(1, TCollection_HAsciiString("geofit"))
            header.SetOrganizationValue(1, TCollection_HAsciiString(""))
            header.SetOriginatingSystem(TCollection_HAsciiString(f"geofit {__version__}"))
            if writer.Write(temporary) != IFSelect_RetDone:
                raise InputError(
                    message("cad.file-not-written-by-opencascade", "OpenCASCADE cannot write the file"),
                    message("cad.check-disk", "Check the disk."),
                    file=str(target),
                )
        Path(temporary).write_text(canonical(Path(temporary).read_text("utf-8")), "ascii", newline="\n")
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    finally:
        Path(temporary).unlink(missing_ok=True)


def _read_back(body: ImplicitBody, target: Path, *, nurbs: bool, trimmed: bool) -> SolidReadBack:
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_SOLID

    from geofit.cad.solid_mesh import solid_triangles
    from geofit.cad.step import read_shapes
    from geofit.geometry.projection import project

    # In the product's own coordinates: the body's local ones.
    shape = read_shapes(target)[0].shape
    faces = faces_of(shape)
    solids = list(explore(shape, TopAbs_SOLID))
    if trimmed:
        # Places of the faces themselves: beyond its trims a surface is none of the body's.
        places = solid_triangles(shape).vertices
        measured, residuals = False, np.full(1, np.nan)
        volume = sum(_volume(solid) for solid in solids)
        free = len(free_edges(shape))
    elif nurbs:
        patches = tuple(from_geom(str(k), BRep_Tool.Surface_s(face)) for k, face in enumerate(faces, 1))
        t = np.linspace(0.0, 1.0, 17)
        places = np.concatenate(
            [p.evaluate((p.domain[0] + t * (p.domain[1] - p.domain[0]))[:, None],
                        (p.domain[2] + t * (p.domain[3] - p.domain[2]))[None]).reshape(-1, 3) for p in patches]
        )  # fmt: skip
        measured = len(body.contacts) > 0
        residuals = np.full(1, np.nan)
        if measured:
            residuals = np.abs(project(patches, body.contacts - body.origin).distance)
        volume = sum(_volume(solid) for solid in solids)
        free = len(free_edges(shape))
    else:
        meshes = [_triangles_of(face) for face in faces]
        places = np.concatenate([mesh.vertices for mesh in meshes])
        measured, residuals = False, np.full(1, np.nan)
        volume = sum(mesh.volume for mesh in meshes)
        free = sum(len(mesh.boundary_edges) for mesh in meshes)
    slope = np.linalg.norm(body.field.gradient(places), axis=1)
    deviation = float((np.abs(body.field.value(places)) / np.maximum(slope, 1e-300)).max())
    tolerances = ShapeAnalysis_ShapeTolerance()
    edge = float(tolerances.Tolerance(shape, 1, TopAbs_EDGE)) if nurbs else 0.0
    valid = bool(BRepCheck_Analyzer(shape).IsValid())
    sigma = float(np.sqrt((residuals**2).sum() / max(len(residuals) - 1, 1)))
    grade = "nurbs" if nurbs else "triangles"
    best = _reference_volume(body) if nurbs else body.overview.volume
    epsilon = body.epsilon
    checks = (
        Check(
            "solids",
            len(solids) > 0,
            float(len(solids)),
            1.0,
            "1",
            message("cad.solids-count", "{count} solids in the file", count=len(solids)),
        ),
        # A tessellated face has no surface, which the check of a B-rep would miss.
        Check(
            "valid",
            valid if nurbs else None,
            float(valid),
            1.0,
            "1",
            message("cad.solids-valid", "OpenCASCADE finds the solids valid")
            if valid
            else message("cad.solids-invalid", "OpenCASCADE finds the solids invalid"),
        ),
        Check(
            "closed",
            free == 0,
            float(free),
            0.0,
            "1",
            message("cad.free-edges-count", "{count} free edges in the file", count=free),
        ),
        Check(
            "deviation",
            deviation <= epsilon,
            deviation,
            epsilon,
            "m",
            message(
                "cad.faces-deviation",
                "The faces of the file lie within {deviation:.3g} m of the body",
                deviation=deviation,
            ),
        ),
        Check(
            "sigma",
            sigma < epsilon if measured else None,
            sigma,
            epsilon,
            "m",
            message(
                "cad.contacts-sigma",
                "The contacts lie on the faces of the file with sigma {sigma:.3g} m",
                sigma=sigma,
            ),
        ),
        Check(
            "volume",
            abs(volume / best - 1) <= VOLUME[grade],
            volume,
            best,
            "m3",
            message(
                "cad.volume-differs",
                "The file's solids have {volume:.6g} m3, the body {best:.6g} m3",
                volume=volume,
                best=best,
            ),
        ),
    )
    return SolidReadBack(
        file=str(target),
        sha256=hashlib.sha256(target.read_bytes()).hexdigest(),
        grade=grade,
        faces=len(faces),
        solids=len(solids),
        volume=volume,
        deviation=deviation,
        sigma=sigma,
        max_abs=float(residuals.max()),
        brep_valid=valid,
        free_edges=free,
        edge_tolerance=edge,
        checks=checks,
    )


def _reference_volume(body: ImplicitBody) -> float:
    """Return the body's volume from two meshes, by Richardson's extrapolation: triangles err with the square."""
    lower, upper = body.extent
    spacing = float((upper - lower).max()) / 40
    coarse, fine = body.local_mesh(spacing).volume, body.local_mesh(spacing / 2).volume
    return (4 * fine - coarse) / 3


def _triangles_of(face: Any) -> TriangleMesh:
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    location = TopLoc_Location()
    found = BRep_Tool.Triangulation_s(face, location)
    if found is None:
        raise StitchError(message("cad.face-without-triangles", "A face of the file has no triangles."))
    move = location.Transformation()
    nodes = [found.Node(k).Transformed(move) for k in range(1, found.NbNodes() + 1)]
    corners = [found.Triangle(k).Get() for k in range(1, found.NbTriangles() + 1)]
    return TriangleMesh(np.array([(p.X(), p.Y(), p.Z()) for p in nodes]), np.array(corners) - 1)

"""IGES and OpenCASCADE's BREP as surfaces to be checked.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike

from geofit.cad.faces import compound_of, faces_of
from geofit.cad.foreign import read_in_child
from geofit.cad.imported import FileShape, empty_document, existing, no_faces, products, quiet, surface_of, unique_name
from geofit.data.messages import message
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["brep_surfaces", "iges_surfaces", "read_brep", "read_iges"]

#: Edges of IGES faces nearer than this (metres) are one.
SEWN = 1e-5
#: What OpenCASCADE calls a shape that has no name.
UNNAMED = ("COMPOUND", "COMPSOLID", "SOLID", "SHELL", "FACE")


def read_iges(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read the surfaces of an IGES file by name, in metres whatever its unit; see :func:`geofit.io.read_step`.

    Loose faces without a name make one surface, named as the file is.

    Raises
    ------
    InputError
        If the file does not exist, is not an IGES file or holds no face.
    """
    return read_in_child(path, "iges")


def iges_surfaces(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read an IGES file in this process, which a damaged file may end; see :func:`read_iges`."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.IGESCAFControl import IGESCAFControl_Reader

    source = existing(path)
    found = empty_document()
    with _unit_of_metres(), quiet():
        reader = IGESCAFControl_Reader()
        reader.SetNameMode(True)
        done = reader.ReadFile(str(source)) == IFSelect_RetDone and reader.Transfer(found)
    shapes = list(products(found, source.stem)) if done else []
    if not shapes:
        raise no_faces(
            source,
            done,
            message("cad.not-iges", "The file cannot be read as IGES"),
            message("cad.export-iges-or-step", "Export the surface as IGES 5.3 or as STEP again."),
        )
    return {shape.name: surface_of(_sewn(shape)) for shape in _joined(shapes, source.stem)}


def read_brep(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read the shapes of a BREP file, in the file's coordinates, which must be metres: the format has no unit.

    Each part of the outermost compound is a surface, a shell of one face too; loose faces are one surface. The format
    has no names either: they are the file's, numbered.

    Raises
    ------
    InputError
        If the file does not exist, is not a BREP file or holds no face.
    """
    return read_in_child(path, "brep")


def brep_surfaces(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read a BREP file in this process, which a damaged file may end; see :func:`read_brep`."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_COMPOUND, TopAbs_FACE
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Iterator, TopoDS_Shape

    source = existing(path)
    whole = TopoDS_Shape()
    with quiet():
        done = BRepTools.Read_s(whole, str(source), BRep_Builder()) and not whole.IsNull()
    if not done or not faces_of(whole):
        raise no_faces(
            source,
            done,
            message("cad.not-brep", "The file cannot be read as BREP"),
            message("cad.export-brep-or-step", "Export the surface as BREP or as STEP again."),
        )
    parts = []
    if whole.ShapeType() == TopAbs_COMPOUND:
        walk = TopoDS_Iterator(whole)
        while walk.More():
            parts += [walk.Value()] if faces_of(walk.Value()) else []
            walk.Next()
    if all(part.ShapeType() == TopAbs_FACE for part in parts):
        parts = [whole]
    found: dict[str, PatchSurface] = {}
    for part in parts:
        count = len(faces_of(part))
        name = unique_name(source.stem, found)
        shape = FileShape(
            name,
            part.Located(TopLoc_Location()),
            part.Location(),
            tuple(f"face {k}" for k in range(1, count + 1)),
        )
        found[name] = surface_of(shape)
    return found


@contextmanager
def _unit_of_metres() -> Iterator[None]:
    """Have IGES lengths converted to metres, and put OpenCASCADE's global setting back."""
    from OCP.IGESControl import IGESControl_Controller
    from OCP.Interface import Interface_Static

    IGESControl_Controller.Init_s()
    unit = Interface_Static.CVal_s("xstep.cascade.unit")
    Interface_Static.SetCVal_s("xstep.cascade.unit", "M")
    try:
        yield
    finally:
        Interface_Static.SetCVal_s("xstep.cascade.unit", unit)


def _joined(shapes: list[FileShape], stem: str) -> list[FileShape]:
    """Join the loose faces of one name, or of none: a surface of many trimmed faces has no shell in IGES."""
    known = {shape.name for shape in shapes}
    groups: dict[str, list[FileShape]] = {}
    for shape in shapes:
        label = re.sub(r" \(\d+\)$", "", shape.name)  # an entity's label with its subscript
        again = re.fullmatch(r"(.+) \d+", label)
        base = again[1] if again and again[1] in known else label
        groups.setdefault(stem if base in UNNAMED else base, []).append(shape)
    joined: list[FileShape] = []
    for name, parts in groups.items():
        faces = [part for part in parts if len(part.face_names) == 1]
        shells = [part for part in parts if len(part.face_names) > 1]
        found = [_compound(name, faces), *shells] if len(faces) > 1 else parts
        for shape in found:
            joined.append(replace(shape, name=unique_name(name, {one.name for one in joined})))
    return joined


def _sewn(shape: FileShape) -> FileShape:
    """Join the faces along common edges, so that the edges that are left free are the outline."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    if len(shape.face_names) == 1:
        return shape
    sewing = BRepBuilderAPI_Sewing(SEWN)
    sewing.Add(shape.shape)
    sewing.Perform()
    found = sewing.SewedShape()
    return replace(shape, shape=found) if len(faces_of(found)) == len(shape.face_names) else shape


def _compound(name: str, shapes: list[FileShape]) -> FileShape:
    from OCP.TopLoc import TopLoc_Location

    compound = compound_of(shape.shape.Located(shape.location) for shape in shapes)
    return FileShape(name, compound, TopLoc_Location(), tuple(f"face {k}" for k in range(1, len(shapes) + 1)))

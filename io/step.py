"""STEP AP242 (ISO 10303-242): horizons written as one assembly, and any file's faces read as surfaces.

The geometry of each horizon stays about its local origin and the offset to map coordinates is its placement
in the assembly: at 3e6 m a control point would lose the digits that the core's exactness needs. OpenCASCADE
is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit import __version__
from geofit.accuracy import ReadBack
from geofit.errors import InputError
from geofit.io.step_check import read_back
from geofit.io.step_text import canonical
from geofit.occ import along, edges_with_faces, faces_of, from_geom, placement
from geofit.points import PointSet
from geofit.stitch import shell
from geofit.surface import HorizonSurface, Patch
from geofit.trim import is_height_field, needed

__all__ = ["StepShape", "read_shapes", "read_step", "write_step"]

Floats = NDArray[np.float64]

#: Fixed, so that the same surfaces give the same bytes.
TIMESTAMP = "2000-01-01T00:00:00"
#: Samples along a curved edge when the outline is read.
ALONG = 24
#: A file's face that fills its parameter rectangle to this share is not cut down to it.
FULL = 1e-9

PARAMETERS = {
    "write.step.schema": "AP242DIS",
    "write.step.unit": "M",
    "xstep.cascade.unit": "M",
    "write.stepcaf.subshapes.name": 1,
    "read.stepcaf.subshapes.name": 1,
    "write.precision.mode": 1,
    "write.precision.val": 1e-7,
}


@dataclass(frozen=True, eq=False)
class StepShape:
    """A product of a file: its shape in its own coordinates (m), where it stands, its faces' names."""

    name: str
    shape: Any
    location: Any
    face_names: tuple[str, ...]


def write_step(surfaces: Mapping[str, HorizonSurface], path: str | PathLike[str]) -> dict[str, ReadBack]:
    """Write horizons as one STEP AP242 assembly in metres, read it back with OpenCASCADE and check it.

    Each horizon is a named, coloured product, each face has its patch's name. The file is written under a
    temporary name and renamed when it is complete; the same surfaces give the same bytes.

    Parameters
    ----------
    surfaces : mapping of str to HorizonSurface
        Horizons by the name that the file shall give them.
    path : path
        The file, usually ``*.step``.

    Returns
    -------
    dict of str to ReadBack
        What the reader found in the file, a horizon.

    Raises
    ------
    StitchError
        If patches do not make one valid shell.
    InputError
        If there is nothing to write, or the file cannot be written.
    """
    target = Path(path)
    if not surfaces:
        raise InputError("No surface to write", "Give at least one horizon.", file=str(target))
    shells = {name: shell(surface) for name, surface in surfaces.items()}
    with _parameters():
        document = _document()
        _fill(document, surfaces, shells)
        _save(document, [_patch_names(shells[name], s.patches) for name, s in surfaces.items()], target)
    return {
        name: read_back(surface, shape, _surface(shape, whole=True), shells[name], target)
        for (name, surface), shape in zip(surfaces.items(), read_shapes(target), strict=True)
    }


def read_step(path: str | PathLike[str]) -> dict[str, HorizonSurface]:
    """Read the faces of a STEP file, ours or any other, as surfaces: one for each product.

    Planes, cylinders and other surfaces are converted to NURBS. A trimmed face becomes the patch over the
    smallest parameter rectangle that holds it; if the product is a height field, the loop of its free edges
    becomes the surface's outline, which :meth:`HorizonSurface.elevation` respects. ``distance`` measures to
    the patches, so a foot may lie beyond a trimmed edge by as much as the rectangle reaches over it.

    Parameters
    ----------
    path : path
        A STEP file in any length unit; the result is in metres.

    Returns
    -------
    dict of str to HorizonSurface
        Without points. The origin is the product's placement, or for a product that stands in map coordinates
        itself, a rounded corner near its first control point.

    Raises
    ------
    InputError
        If the file does not exist, is no STEP file or holds no face.
    """
    return {shape.name: _surface(shape) for shape in read_shapes(path)}


def read_shapes(path: str | PathLike[str]) -> list[StepShape]:
    """Read the products of a STEP file that have faces, in its order; errors as :func:`read_step`."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    source = Path(path)
    if not source.is_file():
        raise InputError("There is no such file", "Check the path.", file=str(source))
    with _parameters(), _quiet():
        document = _document()
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        done = reader.ReadFile(str(source)) == IFSelect_RetDone and reader.Transfer(document)
    shapes = list(_products(document, source.stem)) if done else []
    if not shapes:
        what = "The file holds no face" if done else "The file cannot be read as STEP"
        raise InputError(what, "Export the surface as STEP (AP203, AP214 or AP242) again.", file=str(source))
    return shapes


@contextmanager
def _parameters() -> Iterator[None]:
    """Set OpenCASCADE's global STEP parameters, and put them back."""
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_Controller

    STEPControl_Controller.Init_s()
    before: dict[str, Any] = {}
    for name, value in PARAMETERS.items():
        if isinstance(value, str):
            before[name] = Interface_Static.CVal_s(name)
            Interface_Static.SetCVal_s(name, value)
        elif isinstance(value, int):
            before[name] = Interface_Static.IVal_s(name)
            Interface_Static.SetIVal_s(name, value)
        else:
            before[name] = Interface_Static.RVal_s(name)
            Interface_Static.SetRVal_s(name, value)
    try:
        yield
    finally:
        for name, value in before.items():
            setter = {str: "SetCVal_s", int: "SetIVal_s", float: "SetRVal_s"}[type(value)]
            getattr(Interface_Static, setter)(name, value)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep OpenCASCADE from printing on the terminal."""
    from OCP.Message import Message, Message_Gravity

    printers = list(Message.DefaultMessenger_s().Printers())
    before = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, before, strict=True):
            printer.SetTraceLevel(level)


def _document() -> Any:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1.0)
    return document


def _fill(document: Any, surfaces: Mapping[str, HorizonSurface], shells: Mapping[str, Any]) -> None:
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    assembly = tool.NewShape()
    _name(assembly, "horizons")
    for name, surface in surfaces.items():
        product = tool.AddShape(shells[name], False)
        _name(product, name)
        _name(tool.AddComponent(assembly, product, placement(surface.origin)), name)
    tool.UpdateAssemblies()


def _name(label: Any, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def _patch_names(shape: Any, patches: Sequence[Patch]) -> list[str]:
    """Name the faces of a sewn shell after the patches that they came from."""
    from OCP.BRep import BRep_Tool

    names = []
    for face in faces_of(shape):
        surface = BRep_Tool.Surface_s(face)
        count = surface.NbUPoles(), surface.NbVPoles()
        corners = [surface.Pole(i, j) for i in (1, count[0]) for j in (1, count[1])]
        place = np.array([(p.X(), p.Y(), p.Z()) for p in corners])
        names.append(
            next(
                patch.name
                for patch in patches
                if patch.control.shape[:2] == count
                and np.array_equal(patch.control[[0, 0, -1, -1], [0, -1, 0, -1]], place)
            )
        )
    return names


def _save(document: Any, face_names: Sequence[Sequence[str]], target: Path) -> None:
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_HAsciiString

    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=".step")
    except OSError as error:
        raise InputError(
            f"The file cannot be written: {error.strerror}",
            "Make the folder, or name another.",
            file=str(target),
        ) from None
    os.close(handle)
    try:
        with _quiet():
            writer = STEPCAFControl_Writer()
            writer.SetNameMode(True)
            writer.Transfer(document)
            _name_faces(writer.ChangeWriter().Model(), face_names)
            header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
            header.SetName(TCollection_HAsciiString("horizons"))
            header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP))
            header.SetAuthorValue(1, TCollection_HAsciiString("geofit"))
            header.SetOrganizationValue(1, TCollection_HAsciiString(""))
            header.SetOriginatingSystem(TCollection_HAsciiString(f"geofit {__version__}"))
            done = writer.Write(temporary) == IFSelect_RetDone
        if not done:
            raise InputError("OpenCASCADE cannot write the file", "Check the disk.", file=str(target))
        Path(temporary).write_text(canonical(Path(temporary).read_text("utf-8")), "ascii", newline="\n")
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    finally:
        Path(temporary).unlink(missing_ok=True)


def _name_faces(model: Any, names: Sequence[Sequence[str]]) -> None:
    """Give the faces in the file, shell by shell, the names of their patches.

    Names of sub-shapes in the document get lost where the writer rebuilds a face.
    """
    from OCP.StepShape import StepShape_OpenShell
    from OCP.TCollection import TCollection_HAsciiString

    entities = (model.Value(k) for k in range(1, model.NbEntities() + 1))
    shells = [entity for entity in entities if isinstance(entity, StepShape_OpenShell)]
    for entity, faces in zip(shells, names, strict=True):
        for k, name in enumerate(faces, 1):
            entity.CfsFacesValue(k).SetName(TCollection_HAsciiString(name))


def _products(document: Any, stem: str) -> Iterator[StepShape]:
    from OCP.TDF import TDF_LabelSequence
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots = TDF_LabelSequence()
    tool.GetFreeShapes(roots)
    taken: set[str] = set()
    for root in roots:
        for label, location in _leaves(tool, root, TopLoc_Location()):
            shape = tool.GetShape_s(label)
            own = shape.Location()
            shape = shape.Located(TopLoc_Location())
            names = tuple(_face_name(tool, label, face, k) for k, face in enumerate(faces_of(shape), 1))
            if not names:
                continue
            base = _label_name(label) or stem
            name, k = base, 2
            while name in taken:
                name, k = f"{base} {k}", k + 1
            taken.add(name)
            yield StepShape(name, shape, location.Multiplied(own), names)


def _leaves(tool: Any, label: Any, location: Any) -> Iterator[tuple[Any, Any]]:
    """Walk an assembly down to its parts, multiplying the placements on the way."""
    from OCP.TDF import TDF_Label, TDF_LabelSequence

    if tool.IsReference_s(label):
        referred = TDF_Label()
        tool.GetReferredShape_s(label, referred)
        yield from _leaves(tool, referred, location.Multiplied(tool.GetLocation_s(label)))
    elif tool.IsAssembly_s(label):
        parts = TDF_LabelSequence()
        tool.GetComponents_s(label, parts, False)
        for part in parts:
            yield from _leaves(tool, part, location)
    else:
        yield label, location


def _label_name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    return str(name.Get().ToExtString()) if label.FindAttribute(TDataStd_Name.GetID_s(), name) else ""


def _face_name(tool: Any, label: Any, face: Any, number: int) -> str:
    from OCP.TDF import TDF_Label

    found = TDF_Label()
    name = _label_name(found) if tool.FindSubShape(label, face, found) else ""
    return name or f"face {number}"


def _surface(shape: StepShape, whole: bool = False) -> HorizonSurface:
    faces = zip(faces_of(shape.shape), shape.face_names, strict=True)
    patches = [_patch(name, face, whole) for face, name in faces]
    matrix, origin = _transformation(shape.location)
    if not np.array_equal(matrix, np.eye(3)):
        patches = [_moved(patch, matrix, np.zeros(3)) for patch in patches]
    first = patches[0].control[0, 0]
    if not origin.any() and np.abs(first).max() > 1e4:
        origin = np.round(first, -2)
        patches = [_moved(patch, np.eye(3), -origin) for patch in patches]
    surface = HorizonSurface(patches=tuple(patches), origin=origin, points=PointSet(np.empty((0, 3))), name=shape.name)
    outline = _outline(shape) if is_height_field(surface) else None
    if outline is None or needed(surface.with_(outline=outline), 1e-6) is None:
        return surface
    return surface.with_(outline=outline)


def _patch(name: str, face: Any, whole: bool) -> Patch:
    """Convert a face to NURBS on its parameter rectangle (or whole), with the normal on its side."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepTools import BRepTools
    from OCP.Geom import Geom_BSplineSurface
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopoDS import TopoDS

    if not isinstance(BRep_Tool.Surface_s(face), Geom_BSplineSurface):
        face = TopoDS.Face_s(BRepBuilderAPI_NurbsConvert(face, True).Shape())
    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom_BSplineSurface):
        surface = surface.BasisSurface()
    surface = surface.Copy()
    u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
    if surface.IsUPeriodic() or surface.IsVPeriodic():
        surface.Segment(u0, u1, v0, v1)
        if surface.IsUPeriodic():
            surface.SetUNotPeriodic()
        if surface.IsVPeriodic():
            surface.SetVNotPeriodic()
    low_u, high_u, low_v, high_v = surface.Bounds()
    room = FULL * max(high_u - low_u, 1e-300), FULL * max(high_v - low_v, 1e-300)
    trimmed = u0 > low_u + room[0] or u1 < high_u - room[0] or v0 > low_v + room[1] or v1 < high_v - room[1]
    if trimmed and not whole:
        surface.Segment(max(u0, low_u), min(u1, high_u), max(v0, low_v), min(v1, high_v))
    if face.Orientation() == TopAbs_REVERSED:
        surface.UReverse()
    return from_geom(name, surface)


def _transformation(location: Any) -> tuple[Floats, Floats]:
    move = location.Transformation()
    matrix = np.array([[move.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    part = move.TranslationPart()
    return matrix, np.array([part.X(), part.Y(), part.Z()])


def _moved(patch: Patch, matrix: Floats, shift: Floats) -> Patch:
    control = patch.control @ matrix.T + shift
    return Patch(patch.name, patch.degree, patch.knots_u, patch.knots_v, control, patch.weights)


def _outline(shape: StepShape) -> Floats | None:
    """Loop of the free edges in plan, in map coordinates; None if it is not one simple polygon."""
    import shapely

    lines = []
    for edge, faces in edges_with_faces(shape.shape):
        if len(faces) == 1:
            line = along(edge, ALONG)[:, :2]
            chord = line[-1] - line[0]
            off = np.abs(chord[0] * (line - line[0])[:, 1] - chord[1] * (line - line[0])[:, 0])
            straight = off.max() <= 1e-7 * np.linalg.norm(chord)
            lines.append(np.round(line[[0, -1]] if straight else line, 7))
    if not lines:
        return None
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(lines))).tolist()
    if len(merged) != 1 or not merged[0].is_ring:
        return None
    matrix, origin = _transformation(shape.location)
    polygon = shapely.Polygon(merged[0].simplify(1e-7))
    if not polygon.is_valid or not np.array_equal(matrix, np.eye(3)):
        return None
    return np.asarray(shapely.get_coordinates(polygon.exterior)[:-1] + origin[:2])

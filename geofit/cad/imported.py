"""Shapes of CAD files (OpenCASCADE) as surfaces: what STEP, IGES and BREP have in common.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import edge_places, edges_with_faces, explore, faces_of, from_geom, placement
from geofit.cad.step_attributes import attributes_at
from geofit.cad.step_origin import offset_at
from geofit.cad.trimming import is_height_field, needed
from geofit.data.errors import InputError
from geofit.data.files import is_file
from geofit.data.messages import Message, message
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface
from geofit.surfaces.trimmed import TrimmedSurface

__all__ = [
    "FileShape", "empty_document", "existing", "no_faces", "outline_of", "products", "quiet", "surface_of",
    "transformation_of", "unique_name",
]  # fmt: skip

Floats = NDArray[np.float64]

#: Samples along a curved edge of a shape's outline, and along one of a face's loops in its parameters.
ALONG, AROUND = 24, 128
#: A file's face that fills its parameter rectangle to this share is not cut down to it.
FULL = 1e-9
#: A face this near to upright (cosine) is not distinguished from an overturned one.
STEEP = 1e-3
#: Loops that leave less than this share of the parameter rectangle out do not trim.
WHOLE = 1e-9


@dataclass(frozen=True, eq=False)
class FileShape:
    """A product of a file: shape in its own coordinates (m), place in the map, names of the faces, our attributes."""

    name: str
    shape: Any
    location: Any
    face_names: tuple[str, ...]
    attributes: Mapping[str, str] = field(default_factory=dict)


@contextmanager
def quiet() -> Iterator[None]:
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


def empty_document() -> Any:
    """Return an empty XCAF document in metres."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 1.0)
    return document


def products(document: Any, stem: str) -> Iterator[FileShape]:
    """Return the parts of a document that have faces, in its order; one without a name is called ``stem``."""
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
            name = unique_name(_label_name(label) or stem, taken)
            taken.add(name)
            attributes = attributes_at(label)
            stands = placement(offset_at(attributes)).Multiplied(location.Multiplied(own))
            yield FileShape(name, shape, stands, names, attributes)


def unique_name(base: str, taken: Container[str]) -> str:
    """Return a name that is not taken: itself, or with a number."""
    name, k = base, 2
    while name in taken:
        name, k = f"{base} {k}", k + 1
    return name


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


def surface_of(shape: FileShape, whole: bool = False) -> PatchSurface:
    """Return the faces of a shape as patches; where loops cut them, they are kept (unless ``whole``).

    If the shape is single-valued, the loop of its free edges becomes the surface's outline.
    """
    named = zip(faces_of(shape.shape), shape.face_names, strict=True)
    faces = [_patch(name, face, whole) for face, name in named]
    patches = [patch for patch, _ in faces]
    matrix, origin = transformation_of(shape.location)
    if not np.array_equal(matrix, np.eye(3)):
        patches = [_moved(patch, matrix, np.zeros(3)) for patch in patches]
    first = patches[0].control[0, 0]
    if not origin.any() and np.abs(first).max() > 1e4:
        origin = np.round(first, -2)
        patches = [_moved(patch, np.eye(3), -origin) for patch in patches]
    loops = tuple(loops for _, loops in faces)
    surface = PatchSurface(tuple(patches), origin, shape.name)
    if any(loops):
        surface = TrimmedSurface(tuple(patches), origin, shape.name, trim_loops=loops)
    outline = outline_of(shape) if is_height_field(surface) or _looks_one_way(surface) else None
    if outline is None or needed(ended := replace(surface, outline=outline), 1e-6) is None:
        return surface
    return ended


def _looks_one_way(surface: PatchSurface) -> bool:
    """Whether all normals point upwards, or all downwards: rounded control points are not exact height field."""
    share = np.linspace(0, 1, ALONG)
    heights = []
    for patch in surface.patches:
        u0, u1, v0, v1 = patch.domain
        u, v = u0 + share[:, None] * (u1 - u0), v0 + share * (v1 - v0)
        cross = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1))
        heights.append((cross[..., 2] / np.maximum(np.linalg.norm(cross, axis=-1), 1e-300)).ravel())
    up = np.concatenate(heights)
    return bool(np.abs(up).min() > STEEP and (np.sign(up) == np.sign(up[0])).all())


def _patch(name: str, face: Any, whole: bool) -> tuple[Patch, tuple[Floats, ...]]:
    """Convert a face to NURBS on its parameter rectangle (or whole), with the normal on its side; and its loops."""
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
    loops = () if whole else _loops(face, surface.Bounds())
    if face.Orientation() == TopAbs_REVERSED:
        low_u, high_u, *_ = surface.Bounds()
        surface.UReverse()
        loops = tuple(np.column_stack([low_u + high_u - loop[:, 0], loop[:, 1]]) for loop in loops)
    return from_geom(name, surface), loops


def _loops(face: Any, bounds: tuple[float, float, float, float]) -> tuple[Floats, ...]:
    """Return the loops (k, 2) of a face in its parameters; none where they leave nothing of the rectangle out."""
    import shapely
    from OCP.TopAbs import TopAbs_WIRE
    from OCP.TopoDS import TopoDS

    low_u, high_u, low_v, high_v = bounds
    loops = [_loop(TopoDS.Wire_s(wire), face) for wire in explore(face, TopAbs_WIRE)]
    loops = [loop.clip([low_u, low_v], [high_u, high_v]) for loop in loops if len(loop) >= 3]
    scale = np.array([high_u - low_u, high_v - low_v])
    areas = [abs(shapely.Polygon((loop - [low_u, low_v]) / scale).area) for loop in loops]
    if not loops or (len(loops) == 1 and areas[0] > 1 - WHOLE):
        return ()
    # A closed surface may have its loops as two rings around it, which bound nothing in the parameters.
    return tuple(loops) if max(areas) > WHOLE else ()


def _loop(wire: Any, face: Any) -> Floats:
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d
    from OCP.BRepTools import BRepTools_WireExplorer
    from OCP.GeomAbs import GeomAbs_Line
    from OCP.TopAbs import TopAbs_REVERSED

    places: list[tuple[float, float]] = []
    walk = BRepTools_WireExplorer(wire, face)
    while walk.More():
        curve = BRepAdaptor_Curve2d(walk.Current(), face)
        count = 1 if curve.GetType() == GeomAbs_Line else AROUND
        first, last = curve.FirstParameter(), curve.LastParameter()
        if walk.Current().Orientation() == TopAbs_REVERSED:
            first, last = last, first
        for t in np.linspace(first, last, count, endpoint=False):
            place = curve.Value(float(t))
            places.append((place.X(), place.Y()))
        walk.Next()
    return np.array(places).reshape(-1, 2)


def transformation_of(location: Any) -> tuple[Floats, Floats]:
    """Return the matrix (3, 3) and the shift (3,) of a placement."""
    move = location.Transformation()
    matrix = np.array([[move.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    part = move.TranslationPart()
    return matrix, np.array([part.X(), part.Y(), part.Z()])


def _moved(patch: Patch, matrix: Floats, shift: Floats) -> Patch:
    control = patch.control @ matrix.T + shift
    return Patch(patch.name, patch.degree, patch.knots_u, patch.knots_v, control, patch.weights)


def outline_of(shape: FileShape) -> Floats | None:
    """Loop of the free edges in plan, in map coordinates; None if it is not one simple polygon."""
    import shapely

    lines = []
    for edge, faces in edges_with_faces(shape.shape):
        if len(faces) == 1:
            line = edge_places(edge, ALONG)[:, :2]
            chord = line[-1] - line[0]
            off = np.abs(chord[0] * (line - line[0])[:, 1] - chord[1] * (line - line[0])[:, 0])
            straight = off.max() <= 1e-7 * np.linalg.norm(chord)
            lines.append(np.round(line[[0, -1]] if straight else line, 7))
    if not lines:
        return None
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(lines))).tolist()
    if len(merged) != 1 or not merged[0].is_ring:
        return None
    matrix, origin = transformation_of(shape.location)
    polygon = shapely.Polygon(merged[0].simplify(1e-7))
    if not polygon.is_valid or not np.array_equal(matrix, np.eye(3)):
        return None
    return np.asarray(shapely.get_coordinates(polygon.exterior)[:-1] + origin[:2])


def existing(path: str | PathLike[str]) -> Path:
    """Return the path of a file that is there.

    Raises
    ------
    InputError
        If it is not.
    """
    source = Path(path)
    if source.is_dir():
        raise InputError(
            message("cad.path-is-folder", "This is a folder, not a file"),
            message("cad.name-file-in-folder", "Name a file in it."),
            file=str(source),
        )
    if not is_file(source):
        raise InputError(
            message("data.file-missing", "There is no such file"),
            message("data.check-path", "Check the path."),
            file=str(source),
        )
    return source


def no_faces(file: Path, read: bool, unreadable: Message, remedy: Message) -> InputError:
    """Return the error of a file that OpenCASCADE could not read, or in which it found no face."""
    reason = message("cad.no-face", "The file contains no face") if read else unreadable
    return InputError(reason, remedy, file=str(file))

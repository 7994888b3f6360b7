"""STEP AP242 (ISO 10303-242): horizons written as one assembly, and any file's faces read as surfaces.

The geometry of each horizon stays about its local origin and the offset to map coordinates is its placement
in the assembly: at 3e6 m a control point would lose the digits that the core's exactness needs. OpenCASCADE
is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit import __version__
from geofit.cad.faces import faces_of, placement
from geofit.cad.foreign import read_in_child
from geofit.cad.imported import (
    FileShape,
    empty_document,
    existing,
    no_faces,
    outline_of,
    products,
    quiet,
    surface_of,
    transformation_of,
)
from geofit.cad.read_back import read_back
from geofit.cad.sewing import shell
from geofit.cad.step_attributes import CONTINUED, attributes_of, stated_frame, stated_outline, with_attributes
from geofit.cad.step_beyond import patches_beyond, with_patches_beyond
from geofit.cad.step_origin import Origin, offset_attributes, offset_of, offset_words
from geofit.cad.step_text import canonical, read_written
from geofit.data.accuracy import ReadBack
from geofit.data.columns import LARGEST
from geofit.data.errors import InputError
from geofit.data.files import cannot_write, replacing, unfinished_file
from geofit.data.legible import legible, legible_keys
from geofit.data.messages import message
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface
from geofit.surfaces.protocol import Surface
from geofit.surfaces.unfitted import as_fitted

__all__ = ["UNITS", "Unit", "read_shapes", "read_step", "step_surfaces", "store_step", "write_step"]

Unit = Literal["m", "mm"]
#: Length units of a file, and OpenCASCADE's words for them. No feet: the writer gives 13 digits, and a placement in
#: map coordinates that is not a whole number of the unit would lose more than the core may miss its points by.
UNITS: dict[Unit, str] = {"m": "M", "mm": "MM"}

#: Fixed, so that the same surfaces give the same bytes.
TIMESTAMP = "2000-01-01T00:00:00"

PARAMETERS = {
    "write.step.schema": "AP242DIS",
    "xstep.cascade.unit": "M",
    "write.stepcaf.subshapes.name": 1,
    "read.stepcaf.subshapes.name": 1,
    "write.precision.mode": 1,
    "write.precision.val": 1e-7,
}


def write_step(
    surfaces: Mapping[str, Surface],
    path: str | PathLike[str],
    *,
    unit: Unit = "m",
    author: str = "",
    organisation: str = "",
    origin: Origin = "map",
) -> dict[str, ReadBack]:
    """Write horizons as one STEP AP242 assembly, read it back with OpenCASCADE and check it.

    Each horizon is a named, coloured product with attributes (sigma, epsilon, largest residual, number of points and
    their SHA-256, the version of geofit); each face has its patch's name. The file is written under a
    temporary name and renamed when it is complete; the same surfaces give the same bytes.

    Parameters
    ----------
    surfaces : mapping of str to Surface
        Fits, or surfaces read from files, by the name that the file shall give them.
    path : path
        The file, usually ``*.step``.
    unit : {"m", "mm"}
        In which the file gives lengths. It reports it, and CAD systems convert: the surfaces are the same.
    author, organisation : str
        Who answers for the file, for its header.
    origin : {"map", "local"} or (3,) array_like
        Zero of the file: that of the map; a round place below the data; or the project datum in map coordinates,
        metres. The file states the offset, and :func:`read_step` restores map coordinates.

    Returns
    -------
    dict of str to ReadBack
        What the reader found in the file, a horizon; in metres, whatever the file's unit.

    Raises
    ------
    StitchError
        If patches do not make one valid shell.
    InputError
        If there is nothing to write, the unit is unknown, or the file cannot be written.
    SettingsError
        If the origin is neither a known word nor three numbers.
    """
    surfaces = legible_keys(surfaces)
    target, offset = Path(path), _offset(surfaces, origin)
    shells = store_step(surfaces, target, unit=unit, author=author, organisation=organisation, origin=offset)
    stated = offset_attributes(offset)
    found = {}
    for (name, surface), shape in zip(surfaces.items(), read_shapes(target), strict=True):
        fitted = as_fitted(surface)
        # Measured as the surface was: to its trim loops if it was read with them.
        whole = surface_of(shape, whole=not any(fitted.loops))
        found[name] = read_back(fitted, shape, whole, shells[name], target, stated)
    return found


def store_step(
    surfaces: Mapping[str, Surface],
    path: str | PathLike[str],
    *,
    unit: Unit = "m",
    author: str = "",
    organisation: str = "",
    origin: Origin = "map",
) -> dict[str, Any]:
    """Write the same file without reading it back, for a project of one's own; return the shells by horizon.

    Errors as :func:`write_step`.
    """
    target, surfaces = Path(path), legible_keys(surfaces)
    if not surfaces:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(target),
        )
    if unit not in UNITS:
        raise InputError(
            message("cad.unit-unknown", "The unit '{unit}' of a STEP file is unknown", unit=unit),
            message("cad.known-names", "Choose {names}.", names=" or ".join(UNITS)),
            file=str(target),
        )
    for name, surface in surfaces.items():
        reach = max(float(np.abs(patch.control + surface.origin).max()) for patch in surface.patches)
        if not reach <= LARGEST:
            raise InputError(
                message(
                    "cad.control-point-too-far",
                    "A control point of '{name}' has a coordinate of {reach:.3g} m; at most {most:.0e} m can be "
                    "written",
                    name=name,
                    reach=reach,
                    most=LARGEST,
                ),
                message("cad.fit-in-grid-metres", "Fit the surface to points in the metres of the site's grid."),
                file=str(target),
            )
    offset = _offset(surfaces, origin)
    shells = {name: shell(surface) for name, surface in surfaces.items()}
    with _parameters(unit):
        filled = empty_document()
        _fill(filled, surfaces, shells, offset)
        names = [_patch_names(shells[name], s.patches) for name, s in surfaces.items()]
        stated = offset_attributes(offset)
        attributes = [attributes_of(as_fitted(surface)) | stated for surface in surfaces.values()]
        beyond = [
            [patch for patch in surface.patches if patch.name not in own and "beyond_loops" in known]
            for surface, own, known in zip(surfaces.values(), names, attributes, strict=True)
        ]
        _save(
            filled, names, target, attributes, (author or "geofit", organisation), offset_words(offset), beyond,
            1000.0 if unit == "mm" else 1.0,
        )  # fmt: skip
    return shells


def _offset(surfaces: Mapping[str, Surface], origin: Origin) -> NDArray[np.float64]:
    corners = [surface.bounds[0] for surface in surfaces.values() if surface.patches] or [np.zeros(3)]
    return offset_of(origin, corners)


def read_step(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read the faces of a STEP file, ours or any other, as surfaces: one for each product.

    Planes, cylinders and other surfaces are converted to NURBS. A trimmed face becomes the patch over the
    smallest parameter rectangle that holds it, with the loops that cut it: such a surface is a
    :class:`geofit.surfaces.trimmed.TrimmedSurface`, whose ``distance`` ends at the loops. If the product is a height
    field, the loop of its free edges becomes the surface's outline, which ``elevation`` respects.

    Parameters
    ----------
    path : path
        A STEP file in any length unit; the result is in metres.

    Returns
    -------
    dict of str to PatchSurface
        Without points. An offset that the file states is added. The origin is the product's placement, or for a
        product in map coordinates itself, a rounded corner near its first control point.

    Raises
    ------
    InputError
        If the file does not exist, is not a STEP file or holds no face.
    """
    return read_in_child(path, "step")


def step_surfaces(path: str | PathLike[str]) -> dict[str, PatchSurface]:
    """Read a STEP file in this process, which a damaged file may end; see :func:`read_step`.

    What lies beneath the loops of a face is known only where the file states that a fit continues there: then points
    outside are measured as in the fit.
    """
    shapes = read_shapes(path)
    beyond = patches_beyond(Path(path)) if any(map(_continues, shapes)) else {}
    return {shape.name: _surface(shape, beyond.get(k, [])) for k, shape in enumerate(shapes)}


def _continues(shape: FileShape) -> bool:
    return shape.attributes.get("beyond_loops") == CONTINUED


def _surface(shape: FileShape, beyond: Sequence[Patch]) -> PatchSurface:
    """Return a product's surface; where a fit continues beneath the loops with all its patches."""
    frame = stated_frame(shape.attributes)
    if not _continues(shape):
        return replace(surface_of(shape), frame=frame)
    surface = replace(surface_of(shape, whole=True), frame=frame)
    matrix, shift = transformation_of(shape.location)
    if np.array_equal(matrix, np.eye(3)):
        more = (replace(patch, control=patch.control + (shift - surface.origin)) for patch in beyond)
        outline = stated_outline(shape.attributes) if frame else outline_of(shape)
        surface = replace(surface, patches=_once((*surface.patches, *more)), outline=outline)
    # Without an outline only the loops end the faces.
    return replace(surface_of(shape), frame=frame) if surface.outline is None else surface


def _once(patches: Sequence[Patch]) -> tuple[Patch, ...]:
    """Return patches without repetition: an outline may cut one into several faces."""
    kept: dict[tuple[str, bytes], Patch] = {}
    for patch in patches:
        kept.setdefault((patch.name, patch.control.tobytes()), patch)
    return tuple(kept.values())


def read_shapes(path: str | PathLike[str]) -> list[FileShape]:
    """Read the products of a STEP file that have faces, in its order; errors as :func:`read_step`."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    source = existing(path)
    with _parameters(), quiet():
        found = empty_document()
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetMetaMode(True)
        with _utf8_name(source) as name:
            done = reader.ReadFile(name) == IFSelect_RetDone and reader.Transfer(found)
    shapes = list(products(found, legible(source.stem))) if done else []
    if not shapes:
        raise no_faces(
            source,
            done,
            message("cad.not-step", "The file cannot be read as STEP"),
            message("cad.export-step", "Export the surface as STEP (AP203, AP214 or AP242) again."),
        )
    return shapes


@contextmanager
def _utf8_name(path: Path) -> Iterator[str]:
    """Give a name of a file that OpenCASCADE can open: one that is not UTF-8 it cannot."""
    if legible(str(path)) == str(path):
        yield str(path)
        return
    with tempfile.TemporaryDirectory(prefix="geofit-") as folder:
        yield str(shutil.copy(path, Path(folder) / "copy.step"))


@contextmanager
def _parameters(unit: Unit = "m") -> Iterator[None]:
    """Set OpenCASCADE's global STEP parameters, and put them back."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller

    # Before it, a fresh process knows no "stepcaf" parameter, and setting one does nothing.
    STEPCAFControl_Controller.Init_s()
    before: dict[str, Any] = {}
    for name, value in {**PARAMETERS, "write.step.unit": UNITS[unit]}.items():
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


def _fill(
    document: Any, surfaces: Mapping[str, Surface], shells: Mapping[str, Any], offset: NDArray[np.float64]
) -> None:
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    assembly = tool.NewShape()
    _name(assembly, "horizons")
    for name, surface in surfaces.items():
        product = tool.AddShape(shells[name], False)
        _name(product, name)
        _name(tool.AddComponent(assembly, product, placement(surface.origin - offset)), name)
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


def _save(
    document: Any,
    face_names: Sequence[Sequence[str]],
    target: Path,
    attributes: Sequence[Mapping[str, str]],
    signed: tuple[str, str],
    about: str,
    beyond: Sequence[Sequence[Patch]],
    metre: float,
) -> None:
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_HAsciiString

    try:
        # Next to its place, unless OpenCASCADE could not open it there.
        adjacent = legible(str(target.parent)) == str(target.parent)
        handle, temporary = tempfile.mkstemp(dir=target.parent if adjacent else None, prefix=".geofit-", suffix=".step")
    except OSError as error:
        raise cannot_write(error, target) from None
    os.close(handle)
    try:
        with unfinished_file(temporary):
            with quiet():
                writer = STEPCAFControl_Writer()
                writer.SetNameMode(True)
                writer.Transfer(document)
                _name_faces(writer.ChangeWriter().Model(), face_names)
                header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
                header.SetName(TCollection_HAsciiString("horizons"))
                header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP))
                header.SetAuthorValue(1, TCollection_HAsciiString(signed[0]))
                header.SetOrganizationValue(1, TCollection_HAsciiString(signed[1]))
                header.SetOriginatingSystem(TCollection_HAsciiString(f"geofit {__version__}"))
                if about:
                    header.SetDescriptionValue(1, TCollection_HAsciiString(about))
                done = writer.Write(temporary) == IFSelect_RetDone
            if not done:
                raise InputError(
                    message("cad.disk-full", "The file cannot be written: the disk may be full"),
                    message("cad.make-room", "Make room, or name another folder."),
                    file=str(target),
                )
            with replacing(target) as part:
                text = with_attributes(canonical(read_written(temporary)), attributes)
                text = with_patches_beyond(text, beyond, metre)
                part.write_text(text, "ascii", newline="\n")
    except OSError as error:
        raise cannot_write(error, target) from None
    except ValueError:  # a text that was cut off in the middle
        raise InputError(
            message("cad.disk-full", "The file cannot be written: the disk may be full"),
            message("cad.make-room", "Make room, or name another folder."),
            file=str(target),
        ) from None


def _name_faces(model: Any, names: Sequence[Sequence[str]]) -> None:
    """Give the faces in the file, shell by shell, the names of their patches.

    Names of sub-shapes in the document get lost where the writer rebuilds a face.
    """
    from OCP.StepShape import StepShape_OpenShell
    from OCP.TCollection import TCollection_HAsciiString

    entities = (model.Value(k) for k in range(1, model.NbEntities() + 1))
    shells = [entity for entity in entities if isinstance(entity, StepShape_OpenShell)]
    faces = (shell.CfsFacesValue(k) for shell in shells for k in range(1, shell.NbCfsFaces() + 1))
    for face, name in zip(faces, chain.from_iterable(names), strict=True):
        face.SetName(TCollection_HAsciiString(name))

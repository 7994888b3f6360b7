"""A body written as a STEP AP242 solid (:mod:`geofit.cad.solid_shapes`), and read back.

OpenCASCADE is imported inside the functions: it takes seconds to load. The geometry stays about the body's local
origin; the offset to map coordinates is the placement of the product.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import placement
from geofit.cad.solid_read_back import SolidReadBack, read_back_body
from geofit.cad.solid_shapes import patch_solid, triangle_solid
from geofit.cad.step_attributes import attributes_of_body, with_attributes
from geofit.cad.step_origin import StepFields, offset_attributes, offset_of, offset_words
from geofit.data.accuracy import Check
from geofit.data.errors import InputError, StitchError
from geofit.data.files import replacing
from geofit.data.messages import message
from geofit.implicit.closed_body import ClosedBody
from geofit.splines.patch import Patch

__all__ = ["write_body"]

Floats = NDArray[np.float64]

SCHEMA = "AP242DIS"
TIMESTAMP = "2000-01-01T00:00:00"


def write_body(
    body: ClosedBody,
    path: str | PathLike[str],
    patches: Sequence[Sequence[Patch]] = (),
    reason: str = "",
    shape: Any = None,
    **stated: Unpack[StepFields],
) -> SolidReadBack:
    """Write a body as a STEP AP242 solid, read it back and check it.

    Parameters
    ----------
    body : ClosedBody
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
    **stated : StepFields
        ``author`` and ``organisation`` for the file's head; ``origin`` as for
        :func:`~geofit.cad.step.write_step`; ``colour`` of the solids, ``#rrggbb``.

    Raises
    ------
    InputError
        If the body is empty, or the file cannot be written.
    SettingsError
        If the origin is neither a known word nor three numbers.
    """
    target = Path(path)
    offset = offset_of(stated.get("origin", "map"), [body.extent[0] + body.origin])
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
    attributes = attributes_of_body(body) | offset_attributes(offset)
    _write(shape if smooth else triangle_solid(body.overview), body, target, offset, attributes, stated, nurbs=smooth)
    found = read_back_body(body, target, attributes, nurbs=smooth, trimmed=trimmed)
    if not reason:
        return found
    text = message(
        "cad.triangles-instead-of-patches", "Triangles are written in place of NURBS patches: {reason}", reason=reason
    )
    return replace(found, checks=(*found.checks, Check("grade", None, 0.0, 0.0, "1", text)))


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


def _write(
    shape: Any, body: ClosedBody, target: Path, offset: Floats, attributes: Mapping[str, str], stated: StepFields, *,
    nurbs: bool,
) -> None:  # fmt: skip
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    from geofit import __version__
    from geofit.cad.imported import empty_document, quiet
    from geofit.cad.step_text import canonical, read_written

    with replacing(target) as part:
        part.touch()  # the system's reason where it refuses: OpenCASCADE gives none
        with _parameters(nurbs=nurbs), quiet():
            filled = empty_document()
            tool = XCAFDoc_DocumentTool.ShapeTool_s(filled.Main())
            assembly, product = tool.NewShape(), tool.AddShape(shape, False)
            for label, text in (
                (assembly, "bodies"),
                (product, body.name),
                (tool.AddComponent(assembly, product, placement(body.origin - offset)), body.name),
            ):
                TDataStd_Name.Set_s(label, TCollection_ExtendedString(text, True))
            tool.UpdateAssemblies()
            writer = STEPCAFControl_Writer()
            writer.SetNameMode(True)
            writer.Transfer(filled)
            header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
            header.SetName(TCollection_HAsciiString("bodies"))
            header.SetTimeStamp(TCollection_HAsciiString(TIMESTAMP))
            header.SetAuthorValue(1, TCollection_HAsciiString(stated.get("author") or "geofit"))
            header.SetOrganizationValue(1, TCollection_HAsciiString(stated.get("organisation", "")))
            header.SetOriginatingSystem(TCollection_HAsciiString(f"geofit {__version__}"))
            if about := offset_words(offset):
                header.SetDescriptionValue(1, TCollection_HAsciiString(about))
            if writer.Write(str(part)) != IFSelect_RetDone:
                raise InputError(
                    message("cad.file-not-written-by-opencascade", "OpenCASCADE cannot write the file"),
                    message("cad.check-disk", "Check the disk."),
                    file=str(target),
                )
        text = canonical(read_written(part), stated.get("colour", ""))
        part.write_text(with_attributes(text, [attributes]), "ascii", newline="\n")

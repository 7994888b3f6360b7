"""IGES 5.3 and OpenCASCADE's BREP: the sewn, trimmed shells as exact NURBS in map coordinates.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from os import PathLike
from typing import Any

from geofit.cad.faces import compound_of, placement
from geofit.cad.iges_names import iges_labels, iges_names
from geofit.cad.sewing import shell
from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.messages import message
from geofit.surfaces.protocol import Surface

__all__ = ["write_brep", "write_iges"]

#: Fixed, so that the same surfaces give the same bytes.
DATE = "20000101.000000"


def write_brep(surfaces: Mapping[str, Surface], path: str | PathLike[str]) -> None:
    """Write horizons as one compound of shells, in order; the format holds no names.

    The geometry stays about each horizon's origin, which is the shell's placement.

    Raises
    ------
    StitchError
        If patches do not make one valid shell.
    InputError
        If there is no surface or the file cannot be written.
    """
    from OCP.BRepTools import BRepTools

    given = _given(surfaces, path).values()
    compound = compound_of(shell(surface).Located(placement(surface.origin)) for surface in given)
    with replacing(path) as part:
        if not BRepTools.Write_s(compound, str(part)):
            raise InputError(
                message("cad.file-not-written-by-opencascade", "OpenCASCADE cannot write the file"),
                message("cad.check-folder-and-disk", "Check the folder and the disk."),
                file=str(path),
            )


def write_iges(surfaces: Mapping[str, Surface], path: str | PathLike[str]) -> None:
    """Write horizons as trimmed NURBS surfaces (entity 144), each with its horizon's name (entity 406-15).

    The names are ASCII: :func:`geofit.cad.iges_names.iges_names`.

    Raises
    ------
    StitchError
        If patches do not make one valid shell.
    InputError
        If there is no surface or the file cannot be written.
    """
    from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer
    from OCP.IGESData import IGESData_IGESWriter
    from OCP.IGESSelect import IGESSelect_WorkLibrary
    from OCP.TCollection import TCollection_HAsciiString

    given = _given(surfaces, path)
    names, labels = iges_names(given), iges_labels(given)
    with _metres():
        IGESControl_Controller.Init_s()
        maker = IGESControl_Writer("M", 0)
        model = maker.Model()
        section = model.GlobalSection()
        section.SetCascadeUnit(1000.0)
        model.SetGlobalSection(section)
        for name, surface in given.items():
            first = model.NbEntities() + 1
            maker.AddShape(shell(surface).Located(placement(surface.origin)))
            _name(model, names[name], labels[name], first)
        maker.ComputeModel()
        section = model.GlobalSection()
        section.SetDate(TCollection_HAsciiString(DATE))
        section.SetLastChangeDate(TCollection_HAsciiString(DATE))
        section.SetFileName(TCollection_HAsciiString("horizons.igs"))
        section.SetAuthorName(TCollection_HAsciiString("geofit"))
        model.SetGlobalSection(section)
        writer = IGESData_IGESWriter(model)
        # The default of 12 characters loses everything below 1e-5 m at 3e6 m.
        writer.FloatWriter().SetFormat("%.12E", True)
        writer.FloatWriter().SetFormatForRange("%.9f", 0.1, 1e8)
        writer.SendModel(IGESSelect_WorkLibrary.DefineProtocol_s())
        text = BytesIO()
        if not writer.Print(text):
            raise InputError(
                message("cad.iges-not-written", "OpenCASCADE cannot write IGES"),
                message("cad.write-step-instead", "Write STEP instead."),
                file=str(path),
            )
    with replacing(path) as part:
        part.write_bytes(text.getvalue())


@contextmanager
def _metres() -> Iterator[None]:
    """Tell OpenCASCADE that coordinates are metres, and put its global unit back."""
    from OCP.UnitsMethods import UnitsMethods

    before = UnitsMethods.GetCasCadeLengthUnit_s()
    UnitsMethods.SetCasCadeLengthUnit_s(1000.0)
    try:
        yield
    finally:
        UnitsMethods.SetCasCadeLengthUnit_s(before)


def _name(model: Any, name: str, label: str, first: int) -> None:
    """Name the entities of one shell: its group, or its one face, whole (406-15), every face by its label."""
    from OCP.IGESBasic import IGESBasic_Group, IGESBasic_Name
    from OCP.IGESGeom import IGESGeom_TrimmedSurface
    from OCP.TCollection import TCollection_HAsciiString

    entities = [model.Entity(k) for k in range(first, model.NbEntities() + 1)]
    faces = [entity for entity in entities if isinstance(entity, IGESGeom_TrimmedSurface)]
    for face in faces:
        face.SetLabel(TCollection_HAsciiString(label), 0)
    title = IGESBasic_Name()
    title.Init(1, TCollection_HAsciiString(name))
    model.AddEntity(title)
    groups = [entity for entity in entities if isinstance(entity, IGESBasic_Group)]
    for entity in groups or faces:
        entity.AddProperty(title)


def _given(surfaces: Mapping[str, Surface], path: str | PathLike[str]) -> Mapping[str, Surface]:
    if not surfaces:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(path),
        )
    return surfaces

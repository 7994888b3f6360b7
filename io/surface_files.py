"""Surfaces from files of any format that geofit reads: STEP, IGES, BREP, GOCAD TSurf."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["ENDINGS", "is_surface_file", "read_surface", "read_surfaces"]

#: Endings of the files that :func:`read_surface` reads.
ENDINGS = (".step", ".stp", ".igs", ".iges", ".brep", ".brp", ".ts")


def is_surface_file(path: str | PathLike[str]) -> bool:
    """Whether a file's ending is one of a surface."""
    return Path(path).suffix.casefold() in ENDINGS


@arguments_checked
def read_surface(path: str | PathLike[str], name: str = "") -> PatchSurface | MeshSurface:
    """Read one surface of a file: NURBS patches, or triangles.

    Parameters
    ----------
    path : path
        STEP, IGES, BREP or GOCAD TSurf, by its ending.
    name : str
        Name of the surface, where the file has several.

    Returns
    -------
    PatchSurface or MeshSurface
        In map coordinates, metres, whatever the unit of the file. :func:`geofit.judge` checks it against points.

    Raises
    ------
    InputError
        If the ending is unknown, the file cannot be read, it has several surfaces and none is named, or none of
        them has this name.

    Notes
    -----
    What is read of each format: ``docs/formats_in.md``.
    """
    found = read_surfaces(path)
    if not name and len(found) == 1:
        return next(iter(found.values()))
    if name not in found:
        reason = (
            message("io.surface-missing", "The file has no surface '{name}'", name=name)
            if name
            else message("io.several-surfaces", "The file has several surfaces")
        )
        raise InputError(
            reason, message("io.name-one-of-these", "Name one of: {names}.", names=", ".join(found)), file=str(path)
        )
    return found[name]


@arguments_checked
def read_surfaces(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]],
) -> dict[str, PatchSurface | MeshSurface]:
    """Read all surfaces of one or several files, by name.

    Parameters
    ----------
    paths : path or sequence of path
        STEP, IGES, BREP or GOCAD TSurf, by their endings.

    Returns
    -------
    dict of str to PatchSurface or MeshSurface
        In map coordinates, metres. A name that occurs in several files is preceded by the name of its file, except
        for the first.

    Raises
    ------
    InputError
        If an ending is unknown, a file cannot be read, or is given twice.

    Notes
    -----
    What is read of each format: ``docs/formats_in.md``.
    """
    if isinstance(paths, (str, PathLike)):
        return dict(_read(Path(paths)))
    found: dict[str, PatchSurface | MeshSurface] = {}
    for file in map(Path, paths):
        for name, surface in _read(file).items():
            unique = name if name not in found else f"{file.stem} {name}"
            if unique in found:
                raise InputError(
                    message("io.file-given-twice", "The file is given twice"),
                    message("io.name-file-once", "Name each file once."),
                    file=str(file),
                )
            found[unique] = replace(surface, name=unique)
    return found


def _read(path: Path) -> Mapping[str, PatchSurface | MeshSurface]:
    match path.suffix.casefold():
        case ".step" | ".stp":
            from geofit.cad.step import read_step as read
        case ".igs" | ".iges":
            from geofit.cad.iges_brep import read_iges as read
        case ".brep" | ".brp":
            from geofit.cad.iges_brep import read_brep as read
        case ".ts":
            from geofit.io.tsurf import read_tsurf

            return read_tsurf(path)
        case ending:
            raise InputError(
                message(
                    "io.surface-ending-unknown",
                    "A surface is not read from a file that ends in '{ending}'",
                    ending=ending,
                ),
                message("io.give-known-ending", "Give a file that ends in {names}.", names=", ".join(ENDINGS)),
                file=str(path),
            )
    return read(path)

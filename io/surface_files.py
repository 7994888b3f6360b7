"""Surfaces from files of any format that geofit reads: STEP, IGES, BREP, GOCAD TSurf."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["ENDINGS", "is_surface_file", "read_surface_file"]

#: Endings of the files that :func:`read_surface_file` reads.
ENDINGS = (".step", ".stp", ".igs", ".iges", ".brep", ".brp", ".ts")


def is_surface_file(path: str | Path) -> bool:
    """Whether a file's ending is one of a surface."""
    return Path(path).suffix.casefold() in ENDINGS


def read_surface_file(path: str | Path) -> Mapping[str, PatchSurface | MeshSurface]:
    """Read the surfaces of a file by name: NURBS patches, or triangles.

    Raises
    ------
    InputError
        If the ending is unknown, or the file cannot be read.
    """
    match Path(path).suffix.casefold():
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
                    "import.surface-not-read-file",
                    "A surface is not read from a file that ends in '{ending}'",
                    ending=ending,
                ),
                message("import.give-file-ends", "Give a file that ends in {names}.", names=", ".join(ENDINGS)),
                file=str(path),
            )
    return read(path)

"""Bodies from files: closed triangle meshes and solids."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh

__all__ = ["BODY_ENDINGS", "read_body"]

#: Endings of the files that :func:`read_body` reads.
BODY_ENDINGS = (".stl", ".obj", ".ply", ".ts", ".step", ".stp")


@arguments_checked
def read_body(path: str | PathLike[str], name: str = "") -> TriangleMesh:
    """Read a closed body: a triangle mesh, or a solid, which becomes triangles.

    Parameters
    ----------
    path : path
        STL, OBJ, PLY, GOCAD TSurf or STEP, by its ending.
    name : str
        Name of the TSurf or of the product, where a file has several.

    Returns
    -------
    TriangleMesh
        In map coordinates, metres. Whether it is closed is checked where it is used, by :func:`geofit.morph` for one.

    Raises
    ------
    InputError
        If the ending is unknown, the file cannot be read, or it has several bodies and none is named.

    Notes
    -----
    What is read of each format: ``docs/formats_in.md``.
    """
    target = Path(path)
    match target.suffix.casefold():
        case ".stl":
            from geofit.io.meshes import read_stl

            return read_stl(target)
        case ".obj":
            from geofit.io.meshes import read_obj

            return read_obj(target)
        case ".ply":
            from geofit.io.meshes import read_ply

            return read_ply(target)
        case ".ts":
            from geofit.io.tsurf import read_tsurf

            found = {
                key: TriangleMesh(surface.mesh.xyz, surface.mesh.triangles)
                for key, surface in read_tsurf(target).items()
            }
        case ".step" | ".stp":
            from geofit.cad.solid_mesh import read_solids

            found = read_solids(target)
        case ending:
            raise InputError(
                message(
                    "io.body-ending-unknown", "A body is not read from a file that ends in '{ending}'", ending=ending
                ),
                message("io.give-known-ending", "Give a file that ends in {names}.", names=", ".join(BODY_ENDINGS)),
                file=str(path),
            )
    if not name and len(found) == 1:
        return next(iter(found.values()))
    if name not in found:
        reason = (
            message("io.body-missing", "The file has no body '{name}'", name=name)
            if name
            else message("io.several-bodies", "The file has several bodies")
        )
        raise InputError(
            reason, message("io.name-one-of-these", "Name one of: {names}.", names=", ".join(found)), file=str(path)
        )
    return found[name]

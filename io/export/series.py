"""A series of triangle meshes in time: ParaView's PVD with a VTP file a frame."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from xml.sax.saxutils import quoteattr

from geofit.data.files import folder_for, replacing
from geofit.geometry.mesh import Mesh
from geofit.io.export.vtk import write_vtp

__all__ = ["write_pvd"]


def write_pvd(frames: Sequence[tuple[float, Mesh]], path: str | PathLike[str]) -> tuple[Path, ...]:
    """Write a mesh for each time step as ``NAME/NAME_0000.vtp``, ..., and ``NAME.pvd``, which lists them.

    Parameters
    ----------
    frames : sequence of (float, Mesh)
        Time and triangles of each frame, in order.
    path : path
        The file ``NAME.pvd``.

    Returns
    -------
    tuple of Path
        The list, and the files that it names.
    """
    target = Path(path)
    folder = target.with_suffix("")
    folder_for(folder)
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">']
    lines.append("<Collection>")
    files = []
    for k, (time, mesh) in enumerate(frames):
        file = folder / f"{target.stem}_{k:04d}.vtp"
        write_vtp(mesh, file)
        files.append(file)
        lines.append(f'<DataSet timestep="{time:.9g}" part="0" file={quoteattr(f"{folder.name}/{file.name}")}/>')
    with replacing(target) as part:
        part.write_text("\n".join([*lines, "</Collection>", "</VTKFile>", ""]), encoding="utf-8", newline="\n")
    return target, *files

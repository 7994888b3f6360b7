"""VTK XML polydata (.vtp) and multi-block (.vtm), double precision, map coordinates."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import InputError
from geofit.data.files import file_stems, folder_for, replacing
from geofit.data.legible import legible_keys
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.geometry.mesh import Mesh

__all__ = ["write_vtm", "write_vtp"]

TYPES = {"float64": "Float64", "int64": "Int64", "int32": "Int32"}


def write_vtp(
    mesh: Mesh, path: str | PathLike[str], points: PointSet | None = None, deviation: ArrayLike | None = None
) -> None:
    """Write the triangles of one horizon, and the points it is measured against.

    Point arrays: ``elevation``; ``deviation``, the signed distance in metres of a data point from the
    surface, nan at the mesh's own vertices. Cell array: ``patch``, the number of the patch, -1 at data
    points. Field array: ``patch names``.

    Parameters
    ----------
    mesh : Mesh
        Triangles.
    path : path
        The file.
    points : PointSet, optional
        Data points; they become vertices of the same data set.
    deviation : (n,) array_like, optional
        Residual of each data point, metres; needed with ``points``.
    """
    data = np.empty((0, 3)) if points is None else points.xyz
    off = np.full(len(data), np.nan) if deviation is None else np.asarray(deviation, float)
    if len(off) != len(data):
        raise InputError(
            message(
                "io.deviations-differ-in-number",
                "Deviations given: {count}; points: {points}",
                count=len(off),
                points=len(data),
            ),
            message("io.give-deviations-with-points", "Give the deviations with their points, one for each."),
            file=str(path),
        )
    xyz = np.concatenate([mesh.xyz, data])
    count, triangles = len(mesh.points), len(mesh.triangles)
    # VTK counts cells in the order vertices, lines, strips, polygons.
    patch = np.concatenate([np.full(len(data), -1), mesh.patch]).astype(np.int32)
    names = np.concatenate([np.frombuffer(name.encode() + b"\0", np.uint8) for name in mesh.names])
    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<PolyData>",
        f'<FieldData><Array type="String" Name="patch names" NumberOfTuples="{len(mesh.names)}" format="ascii">'
        f"{' '.join(map(str, names))}</Array></FieldData>",
        f'<Piece NumberOfPoints="{len(xyz)}" NumberOfVerts="{len(data)}" NumberOfLines="0" NumberOfStrips="0" '
        f'NumberOfPolys="{triangles}">',
        '<PointData Scalars="elevation">',
        _array("elevation", xyz[:, 2]),
        _array("deviation", np.concatenate([np.full(count, np.nan), off])),
        "</PointData>",
        "<CellData>",
        _array("patch", patch),
        "</CellData>",
        "<Points>",
        _array("Points", xyz),
        "</Points>",
        "<Verts>",
        _array("connectivity", np.arange(count, count + len(data))),
        _array("offsets", np.arange(1, len(data) + 1)),
        "</Verts>",
        "<Polys>",
        _array("connectivity", mesh.triangles.reshape(-1)),
        _array("offsets", 3 * np.arange(1, triangles + 1)),
        "</Polys>",
        "</Piece>",
        "</PolyData>",
        "</VTKFile>",
    ]
    with replacing(path) as part:
        part.write_text("\n".join(parts) + "\n", encoding="utf-8", newline="\n")


def write_vtm(
    meshes: Mapping[str, Mesh],
    path: str | PathLike[str],
    points: Mapping[str, tuple[PointSet, NDArray[np.float64]]] | None = None,
) -> None:
    """Write a block for each horizon: ``NAME.vtm`` and, in a folder ``NAME`` beside it, the blocks.

    ``points`` holds data points and their deviations by horizon, as in :func:`write_vtp`.
    """
    target = Path(path)
    folder = target.with_suffix("")
    folder_for(folder)
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">',
        "<vtkMultiBlockDataSet>",
    ]
    meshes, points = legible_keys(meshes), legible_keys(points or {})
    stems = file_stems(meshes)
    for k, (name, mesh) in enumerate(meshes.items()):
        data, deviation = points.get(name, (None, None))
        write_vtp(mesh, folder / f"{stems[name]}.vtp", data, deviation)
        file = quoteattr(f"{folder.name}/{stems[name]}.vtp")
        lines.append(f'<DataSet index="{k}" name={quoteattr(_plain(name))} file={file}/>')
    with replacing(target) as part:
        part.write_text(
            "\n".join([*lines, "</vtkMultiBlockDataSet>", "</VTKFile>", ""]), encoding="utf-8", newline="\n"
        )


def _plain(name: str) -> str:
    """Leave out what XML does not hold."""
    return re.sub(r"[\x00-\x1f]", " ", name)


def _array(name: str, values: NDArray[np.generic]) -> str:
    """Return a data array, base64 behind the count of its bytes."""
    kind = TYPES[values.dtype.name]
    raw = np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes()
    text = base64.b64encode(np.uint64(len(raw)).astype("<u8").tobytes() + raw).decode()
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    return f'<DataArray type="{kind}" Name="{name}"{components} format="binary">{text}</DataArray>'

"""Closed triangle meshes from the formats of viewers and printers: STL, OBJ, PLY."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh
from geofit.io.source import Source

__all__ = ["read_obj", "read_ply", "read_stl"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: numpy's letters for the numbers of PLY.
NUMBERS = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip


def read_stl(path: Path) -> TriangleMesh:
    """Read STL, binary or text; corners at the same place become one vertex.

    The origin that :func:`geofit.io.export.triangles.write_stl` leaves in ``FILE.origin.txt`` is added.

    Raises
    ------
    InputError
        If the file is missing or damaged.
    """
    source = Source(path=path)
    data = source.read()
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        corners = np.frombuffer(data, kind, count, 84)["corners"].astype(np.float64)
    else:
        rows = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
        try:
            corners = np.array(rows, dtype=np.float64).reshape(-1, 3, 3)
        except ValueError:
            raise _damaged(source, "STL") from None
    if not len(corners) or not np.isfinite(corners).all():
        raise _damaged(source, "STL")
    places, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return _sound(places + _origin(path), index.reshape(-1, 3))


def read_obj(path: Path) -> TriangleMesh:
    """Read the vertices and faces of a Wavefront OBJ file; polygons become fans of triangles.

    Raises
    ------
    InputError
        If the file is missing or damaged.
    """
    source = Source(path=path)
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for row, line in enumerate(source.read().decode("utf-8-sig", "replace").splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) for word in words[1:]]
                corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
                faces += [(corners[0], a, b) for a, b in pairwise(corners[1:])]
        except ValueError:
            raise _damaged(source, "OBJ", row) from None
    places = np.array([one for one in vertices if len(one) == 3], dtype=np.float64).reshape(-1, 3)
    if len(places) < len(vertices):  # the file was cut off within a line
        raise _damaged(source, "OBJ")
    return _checked(source, "OBJ", places, np.array(faces, dtype=np.int64).reshape(-1, 3))


def read_ply(path: Path) -> TriangleMesh:
    """Read the vertices and faces of a PLY file, text or binary; polygons become fans of triangles.

    Raises
    ------
    InputError
        If the file is missing or damaged.
    """
    source = Source(path=path)
    data = source.read()
    head, mark, body = data.partition(b"end_header")
    if not mark:
        raise _damaged(source, "PLY")
    body = body[body.index(b"\n") + 1 :]
    kind = ""
    elements: list[tuple[str, int, list[list[str]]]] = []
    for line in head.decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            kind = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"] and elements:
            elements[-1][2].append(words[1:])
    try:
        found = dict(_elements(kind, elements, body))
        vertices = np.array([found["vertex"][axis] for axis in "xyz"], dtype=np.float64).T
        faces = found.get("face", {})
        polygons: Any = faces.get("vertex_indices", faces.get("vertex_index", []))
    except (KeyError, ValueError, IndexError, TypeError):
        raise _damaged(source, "PLY") from None
    fans = [(p[0], a, b) for p in polygons for a, b in pairwise(p[1:])]
    return _checked(source, "PLY", vertices, np.array(fans, dtype=np.int64))


def _elements(
    kind: str, elements: list[tuple[str, int, list[list[str]]]], body: bytes
) -> Iterator[tuple[str, dict[str, list[float] | list[list[int]]]]]:
    """Return each element of a PLY file: its properties by name, lists as lists."""
    words = iter(body.split()) if kind == "ascii" else iter(())
    order = ">" if kind == "binary_big_endian" else "<"
    at = 0

    def take(letter: str, count: int) -> list[float]:
        nonlocal at
        if kind == "ascii":
            return [float(next(words)) for _ in range(count)]
        numbers = np.frombuffer(body, order + NUMBERS[letter], count, at)
        at += numbers.nbytes
        return [float(number) for number in numbers]

    for name, count, properties in elements:
        values: dict[str, list[float] | list[list[int]]] = {words_[-1]: [] for words_ in properties}
        if kind != "ascii" and not any(one[0] == "list" for one in properties):
            record = np.dtype([(one[-1], order + NUMBERS[one[0]]) for one in properties])
            rows = np.frombuffer(body, record, count, at)
            at += rows.nbytes
            yield name, {one[-1]: rows[one[-1]].astype(float).tolist() for one in properties}
            continue
        for _ in range(count):
            for one in properties:
                if one[0] == "list":
                    length = int(take(one[1], 1)[0])
                    values[one[-1]].append([int(v) for v in take(one[2], length)])  # type: ignore[arg-type]
                else:
                    values[one[-1]].append(take(one[0], 1)[0])  # type: ignore[arg-type]
        yield name, values


def _checked(source: Source, kind: str, vertices: Floats, faces: Ints) -> TriangleMesh:
    if not len(faces) or vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
        raise _damaged(source, kind)
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise _damaged(source, kind)
    # Exporters repeat the vertices of faces and groups: one place is one vertex.
    places, index = np.unique(vertices, axis=0, return_inverse=True)
    return _sound(places + _origin(source.path), index.reshape(-1)[faces])


def _sound(vertices: Floats, triangles: Ints) -> TriangleMesh:
    """Return the triangles that have three different corners."""
    keep = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return TriangleMesh(vertices, triangles[keep])


def _origin(path: Path) -> Floats:
    """Return the origin in the text file beside a mesh, zero without one."""
    beside = path.with_name(path.name + ".origin.txt")
    if not beside.is_file():
        return np.zeros(3)
    # A sample has the axes of its array in place of those of the map.
    axes = r"^(?:easting|northing|elevation|axis[012]) (\S+)$"
    found = re.findall(axes, beside.read_text(encoding="utf-8"), re.MULTILINE)
    return np.array([float(place) for place in found]) if len(found) == 3 else np.zeros(3)


def _damaged(source: Source, kind: str, row: int | None = None) -> InputError:
    return InputError(
        message("io.mesh-damaged", "The file cannot be read as {kind}", kind=kind),
        message("io.export-mesh-again", "Export the triangles again."),
        file=source.name,
        row=row,
    )

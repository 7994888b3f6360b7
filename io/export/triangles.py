"""Triangle formats of viewers and printers: OBJ, PLY, STL and glTF.

OBJ and PLY hold the coordinates of the data in double precision: those of the map where the data are in them. STL and
glTF store single precision, which at 3e6 m is a quarter of a metre: their coordinates are relative to an origin,
written to ``FILE.origin.txt`` next to them.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.legible import legible_keys
from geofit.data.messages import message
from geofit.geometry.mesh import Mesh

__all__ = ["common_origin", "write_glb", "write_obj", "write_ply", "write_stl"]

Floats = NDArray[np.float64]

#: What the head of OBJ and PLY files states: whether the data are in map coordinates, no writer knows.
COORDINATES = "metres, coordinates as in the data, no offset"
#: Base colours of the horizons in turn in glTF: earth tones that stay apart.
COLOURS = ((0.76, 0.60, 0.42), (0.55, 0.64, 0.45), (0.45, 0.56, 0.68), (0.70, 0.47, 0.43), (0.60, 0.52, 0.66))
#: What the origin of a rock sample is along: the axes of its array.
AXES = ("axis0", "axis1", "axis2")
#: glTF codes: float, unsigned int; vertex and index buffers; triangles.
FLOAT, UINT, VERTICES, INDICES, TRIANGLES = 5126, 5125, 34962, 34963, 4


def write_obj(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> None:
    """Write Wavefront OBJ: an object a horizon, coordinates to 1e-6 m, of small bodies finer, z upwards."""
    meshes = _given(meshes, path)
    lines, first = [f"# {COORDINATES}, z upwards"], 1
    digits = max(7 - _magnitude(meshes), 6)
    for name, mesh in meshes.items():
        lines.append(f"o {_word(name)}")
        lines += [f"v {x:.{digits}f} {y:.{digits}f} {z:.{digits}f}" for x, y, z in mesh.xyz.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (mesh.triangles + first).tolist()]
        first += len(mesh.points)
    with replacing(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def write_ply(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> None:
    """Write binary PLY with double coordinates and, a face, the numbers of its horizon and patch."""
    vertices, faces, first = [], [], 0
    comments = []
    kind = np.dtype([("n", "u1"), ("corners", "<i4", 3), ("horizon", "<i4"), ("patch", "<i4")])
    for k, (name, mesh) in enumerate(_given(meshes, path).items()):
        comments.append(f"comment horizon {k}: {_word(name).encode('ascii', 'backslashreplace').decode()}")
        vertices.append(mesh.xyz.astype("<f8"))
        face = np.zeros(len(mesh.triangles), kind)
        face["n"], face["corners"], face["horizon"], face["patch"] = 3, mesh.triangles + first, k, mesh.patch
        faces.append(face)
        first += len(mesh.points)
    head = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment {COORDINATES}",
        *comments,
        f"element vertex {first}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {sum(map(len, faces))}",
        "property list uchar int vertex_indices",
        "property int horizon",
        "property int patch",
        "end_header",
        "",
    ]
    with replacing(path) as part:
        body = b"".join(array.tobytes() for array in (*vertices, *faces))
        part.write_bytes("\n".join(head).encode("ascii") + body)


def write_stl(meshes: Mapping[str, Mesh], path: str | PathLike[str], *, sample: bool = False) -> Floats:
    """Write binary STL, relative to an origin; return the origin, which is in ``FILE.origin.txt`` too.

    The coordinates are those of the map, or of a ``sample`` along the axes of its array.
    """
    origin = common_origin(_given(meshes, path))
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles = []
    for mesh in meshes.values():
        corners = (mesh.points + (mesh.origin - origin))[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        triangle = np.zeros(len(corners), kind)
        triangle["normal"] = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        triangle["corners"] = corners
        triangles.append(triangle)
    every = np.concatenate(triangles)
    head = b"metres relative to the origin in the text file next to it".ljust(80)
    with replacing(path) as part:
        part.write_bytes(head + np.uint32(len(every)).astype("<u4").tobytes() + every.tobytes())
    _state_origin(origin, path, "x axis 0, y axis 1, z axis 2" if sample else "x east, y north, z up", sample=sample)
    return origin


def write_glb(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> Floats:
    """Write binary glTF 2.0, a named, coloured node a horizon; return the origin as :func:`write_stl` does.

    glTF has y upwards: x east, y up, z south.
    """
    meshes = _given(meshes, path)
    origin = common_origin(meshes)
    views: list[dict[str, int]] = []
    accessors: list[dict[str, Any]] = []
    scene: dict[str, Any] = {"meshes": [], "materials": [], "nodes": []}
    blob = b""
    for k, (name, mesh) in enumerate(meshes.items()):
        x, y, z = (mesh.points + (mesh.origin - origin)).T
        place = np.stack([x, z, -y], axis=1).astype("<f4")
        index = mesh.triangles.astype("<u4").reshape(-1)
        for array, target in ((place, VERTICES), (index, INDICES)):
            raw = array.tobytes()
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(raw), "target": target})
            blob += raw
        accessors.append(
            {
                "bufferView": 2 * k, "componentType": FLOAT, "count": len(place), "type": "VEC3",
                "min": place.min(axis=0).tolist(), "max": place.max(axis=0).tolist(),
            }
        )  # fmt: skip
        accessors.append({"bufferView": 2 * k + 1, "componentType": UINT, "count": len(index), "type": "SCALAR"})
        colour = [*COLOURS[k % len(COLOURS)], 1.0]
        scene["materials"].append(
            {
                "name": name,
                "doubleSided": True,
                "pbrMetallicRoughness": {
                    "baseColorFactor": colour,
                    "metallicFactor": 0,
                    "roughnessFactor": 0.9,
                },
            }
        )
        primitive = {
            "attributes": {"POSITION": 2 * k},
            "indices": 2 * k + 1,
            "material": k,
            "mode": TRIANGLES,
        }
        scene["meshes"].append({"name": name, "primitives": [primitive]})
        scene["nodes"].append({"name": name, "mesh": k})
    document = {
        "asset": {
            "version": "2.0",
            "generator": "geofit",
            "extras": {"origin": origin.tolist(), "unit": "metre"},
        },
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        **scene,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with replacing(path) as part:
        part.write_bytes(
            np.array([0x46546C67, 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A], "<u4").tobytes()
            + text
            + np.array([len(blob), 0x004E4942], "<u4").tobytes()
            + blob
        )
    _state_origin(origin, path, "x east, y up, z south")
    return origin


def common_origin(meshes: Mapping[str, Mesh]) -> Floats:
    """Return the origin of single precision: the south-western bottom of all meshes, rounded down.

    It is rounded to 100 m, or to the next power of ten above the size of what is smaller: coordinates of the pores of a
    rock, micrometres apart, would be equal at 100 m.
    """
    low = np.min([mesh.xyz.min(axis=0) for mesh in meshes.values()], axis=0)
    power = min(_magnitude(meshes), 2)
    step = 10.0**power
    return np.asarray(np.round(np.floor(low / step) * step, max(-power, 0)) + 0.0)


def _magnitude(meshes: Mapping[str, Mesh]) -> int:
    """Return the exponent of the least power of ten that is not below the longest side of all meshes in metres."""
    xyz = np.concatenate([mesh.xyz for mesh in meshes.values()])
    longest = float(np.ptp(xyz, axis=0).max()) if len(xyz) else 0.0
    # One place has no size.
    return math.ceil(math.log10(longest)) if longest > 0 else 0


def _state_origin(origin: Floats, path: str | PathLike[str], axes: str, *, sample: bool = False) -> None:
    target = Path(path)
    wanted, names = "map coordinates, metres", ("easting", "northing", "elevation")
    if sample:
        wanted, names = "metres from the low corner of the sample, along the axes of the array", AXES
    places = (np.format_float_positional(c, min_digits=3) for c in origin.tolist())
    text = (
        f"Origin of {target.name}: add it to the file's coordinates to get {wanted}.\nAxes of the file: {axes}.\n"
        + "".join(f"{name} {place}\n" for name, place in zip(names, places, strict=True))
    )
    with replacing(target.with_name(target.name + ".origin.txt")) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def _given(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> Mapping[str, Mesh]:
    if not meshes:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(path),
        )
    return legible_keys(meshes)


def _word(name: str) -> str:
    return re.sub(r"\s+", "_", name.strip()) or "horizon"

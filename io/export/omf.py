"""OMF 0.9 (Open Mining Format): triangles of horizons, data points with their deviations, block models of bodies.

Layout: Global Mining Guidelines Group, "Open Mining Format", as its reference implementation documents it: a head
of 60 bytes, compressed arrays, and a JSON object of all elements by identifier. Written without that package:
its maintained edition, mira-omf, which reads the file in the tests where it is installed, holds numpy to 1.26.
"""

from __future__ import annotations

import json
import struct
import uuid
import zlib
from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.legible import legible_keys
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.geometry.mesh import Mesh

if TYPE_CHECKING:
    from geofit.bodies.blocks import BlockModel

__all__ = ["write_omf", "write_omf_blocks"]

Floats = NDArray[np.float64]

MAGIC, VERSION = b"\x84\x83\x82\x81", b"OMF-v0.9.0"
HEAD = struct.Struct("<4s32s16sQ")
#: Identifiers are made of names in this space, and the dates are fixed: the same surfaces give the same bytes.
NAMESPACE = uuid.UUID("8f4cfb44-02c5-55b0-9d2c-5ad0ab3a1c57")
DATE = "2000-01-01T00:00:00Z"
#: Colours of the horizons in turn: earth tones that stay apart.
COLOURS = ([194, 153, 107], [140, 163, 115], [115, 143, 173], [179, 120, 110], [153, 133, 168])


def write_omf(
    meshes: Mapping[str, Mesh],
    path: str | PathLike[str],
    points: Mapping[str, tuple[PointSet, Floats]] | None = None,
) -> None:
    """Write a surface element a horizon (data ``elevation`` at vertices, ``patch`` at faces), double precision.

    The vertices stand about the horizon's origin, which the element states.

    Parameters
    ----------
    meshes : mapping of str to Mesh
        Triangles by horizon.
    path : path
        The file, usually ``*.omf``.
    points : mapping of str to (PointSet, (n,) array), optional
        Data points and their deviations (m) by horizon: a point set each, data ``deviation``.

    Raises
    ------
    InputError
        If there is no surface.
    """
    if not meshes:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(path),
        )
    model = _Model()
    elements = []
    for k, (name, mesh) in enumerate(legible_keys(meshes).items()):
        shape = {
            "vertices": model.array(f"{name}/vertices", "Vector3Array", mesh.points),
            "triangles": model.array(f"{name}/triangles", "Int3Array", mesh.triangles),
        }
        data = [
            model.values(name, "elevation", "vertices", mesh.xyz[:, 2]),
            model.values(name, "patch", "faces", mesh.patch.astype(np.float64)),
        ]
        elements.append(model.element(name, "Surface", "surface", k, mesh.origin, shape, data))
    for k, (name, (known, deviation)) in enumerate(legible_keys(points or {}).items()):
        title, origin = f"{name} points", np.round(known.xyz.min(axis=0), -2) if len(known) else np.zeros(3)
        shape = {"vertices": model.array(f"{title}/vertices", "Vector3Array", known.xyz - origin)}
        data = [model.values(title, "deviation", "vertices", np.asarray(deviation, float))]
        elements.append(model.element(title, "PointSet", "point", k, origin, shape, data))
    model.write(path, "horizons", elements)


def write_omf_blocks(blocks: Mapping[str, BlockModel], path: str | PathLike[str]) -> None:
    """Write a volume element a block model (data at cells: ``field``, negative inside, and ``probability``).

    Parameters
    ----------
    blocks : mapping of str to BlockModel
        Block models by body.
    path : path
        The file, usually ``*.omf``.
    """
    model = _Model()
    elements = []
    for k, (name, body) in enumerate(legible_keys(blocks).items()):
        corner = body.centres[0] - body.spacing / 2
        # The last axis runs fastest in the cells, as in the block model.
        tensors = {f"tensor_{axis}": [body.spacing] * count for axis, count in zip("uvw", body.shape, strict=True)}
        axes = {f"axis_{axis}": row for axis, row in zip("uvw", np.eye(3).tolist(), strict=True)}
        data = [
            model.values(name, "field", "cells", body.value),
            model.values(name, "probability", "cells", body.probability),
        ]
        elements.append(model.element(name, "VolumeGrid", "volume", k, corner, {**tensors, **axes}, data))
    model.write(path, "bodies", elements)


class _Model:
    """The file while it is being filled: compressed arrays, and the elements by identifier."""

    def __init__(self) -> None:
        self.arrays = bytearray()
        self.parts: dict[str, dict[str, Any]] = {}

    def add(self, key: str, kind: str, **values: Any) -> str:
        """Add an element of the class ``kind``; return its identifier."""
        identifier = str(uuid.uuid5(NAMESPACE, f"{kind}/{key}"))
        self.parts[identifier] = {"date_created": DATE, "date_modified": DATE, **values, "__class__": kind}
        return identifier

    def array(self, key: str, kind: str, values: NDArray[Any]) -> str:
        """Add an array, numbers of 8 bytes, least first."""
        code = "<i8" if values.dtype.kind == "i" else "<f8"
        data = zlib.compress(np.ascontiguousarray(values, code).tobytes(), 6)
        place = {"start": HEAD.size + len(self.arrays), "dtype": code, "length": len(data)}
        self.arrays += data
        return self.add(key, kind, array=place)

    def values(self, owner: str, name: str, location: str, values: Floats) -> str:
        """Add numbers at vertices or faces."""
        array = self.array(f"{owner}/{name}", "ScalarArray", values)
        return self.add(f"{owner}/{name}", "ScalarData", name=name, description="", array=array, location=location)

    def element(
        self, name: str, kind: str, subtype: str, number: int, origin: Floats, shape: Mapping[str, Any], data: list[str]
    ) -> str:
        """Add a surface, point set or volume with its geometry and data."""
        geometry = self.add(name, f"{kind}Geometry", origin=origin.tolist(), **shape)
        colour = COLOURS[number % len(COLOURS)]
        textures: dict[str, Any] = {} if subtype == "volume" else {"textures": []}
        return self.add(
            name,
            f"{kind.removesuffix('Grid')}Element",
            name=name,
            description="",
            data=data,
            color=colour,
            subtype=subtype,
            geometry=geometry,
            **textures,
        )

    def write(self, path: str | PathLike[str], name: str, elements: list[str]) -> None:
        """Write the file: a project of these elements."""
        project = self.add(
            "project",
            "Project",
            name=name,
            description="",
            author="geofit",
            revision="",
            units="m",
            elements=elements,
            origin=[0.0, 0.0, 0.0],
        )
        head = HEAD.pack(MAGIC, VERSION, uuid.UUID(project).bytes, HEAD.size + len(self.arrays))
        with replacing(path) as part:
            part.write_bytes(head + bytes(self.arrays) + json.dumps(self.parts, ensure_ascii=False).encode("utf-8"))

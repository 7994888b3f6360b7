"""geoh5 2.1 (HDF5): triangles of horizons, data points with their deviations, block models of bodies.

Layout: Mira Geoscience, "GEOH5 format", https://mirageoscience-geoh5py.readthedocs-hosted.com. Written with
h5py alone: geoh5py, which reads it in the tests, holds numpy below 2.
"""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from io import BytesIO
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
from geofit.io.extra import need

if TYPE_CHECKING:
    from geofit.bodies.blocks import BlockModel

__all__ = ["write_geoh5", "write_geoh5_blocks"]

Floats = NDArray[np.float64]

#: Types that the format fixes.
SURFACE, POINTS, BLOCKS, ROOT = (
    "f26feba3-aded-494b-b9e9-b2bbcbe298e1",
    "202c5db1-a56d-4004-9cad-baafd8899406",
    "b020a277-90e2-4cd7-84d6-612ee3f25051",
    "dd99b610-be92-48c0-873c-5b5946ea2840",
)
#: Identifiers are made of names in this space, so that the same surfaces give the same bytes.
NAMESPACE = uuid.UUID("0d1a7f0c-70e8-5c0a-8d3e-2a6b7b2f5b11")
VERTEX = np.dtype([("x", "<f8"), ("y", "<f8"), ("z", "<f8")])
SHOWN = {
    "Allow delete": 1,
    "Allow move": 1,
    "Allow rename": 1,
    "Partially hidden": 0,
    "Public": 1,
    "Visible": 1,
}


def write_geoh5(
    meshes: Mapping[str, Mesh],
    path: str | PathLike[str],
    points: Mapping[str, tuple[PointSet, Floats]] | None = None,
) -> None:
    """Write a Surface a horizon (data: ``elevation`` at vertices, ``patch`` at cells), map coordinates.

    Parameters
    ----------
    meshes : mapping of str to Mesh
        Triangles by horizon.
    path : path
        The file.
    points : mapping of str to (PointSet, (n,) array), optional
        Data points and their deviations (m) by horizon: a Points object each, data ``deviation``.

    Raises
    ------
    MissingDependencyError
        If h5py is not installed.
    InputError
        If there is no surface.
    """
    h5py = need("h5py", "geoh5", message("io.package-missing-for-format", "Writing {format}", format="geoh5"))
    if not meshes:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(path),
        )
    # In memory: on a full disk the library ends the process.
    whole = BytesIO()
    with h5py.File(whole, "w", track_order=False) as file:
        model = _Model(file.create_group("GEOSCIENCE"), h5py.string_dtype())
        for name, mesh in legible_keys(meshes).items():
            item = model.add(name, SURFACE, "Surface", mesh.xyz)
            item["Cells"] = mesh.triangles.astype("<i4")
            model.values(item, "elevation", "Vertex", mesh.xyz[:, 2])
            model.values(item, "patch", "Cell", mesh.patch.astype("<i4"))
        for name, (data, deviation) in legible_keys(points or {}).items():
            item = model.add(f"{name} points", POINTS, "Points", data.xyz)
            model.values(item, "deviation", "Vertex", np.asarray(deviation, float))
    with replacing(path) as part:
        part.write_bytes(whole.getvalue())


def write_geoh5_blocks(blocks: Mapping[str, BlockModel], path: str | PathLike[str]) -> None:
    """Write a Block model a body (data at cells: ``field``, negative inside, and ``probability``), map coordinates.

    Parameters
    ----------
    blocks : mapping of str to BlockModel
        Block models by body.
    path : path
        The file.

    Raises
    ------
    MissingDependencyError
        If h5py is not installed.
    """
    h5py = need("h5py", "geoh5", message("io.package-missing-for-format", "Writing {format}", format="geoh5"))
    whole = BytesIO()
    with h5py.File(whole, "w", track_order=False) as file:
        model = _Model(file.create_group("GEOSCIENCE"), h5py.string_dtype())
        for name, body in legible_keys(blocks).items():
            item = model.blocks(name, body.centres[0] - body.spacing / 2, body.spacing, body.shape)
            for word, values in (("field", body.value), ("probability", body.probability)):
                # Cells of the format: z runs fastest, then the first axis, then the second.
                model.values(item, word, "Cell", values.reshape(body.shape).transpose(1, 0, 2).ravel())
    with replacing(path) as part:
        part.write_bytes(whole.getvalue())


class _Model:
    """The workspace while it is being filled."""

    def __init__(self, base: Any, text: Any) -> None:
        self._base, self._text = base, text
        self._set(base, {"Distance unit": "meter", "GA Version": "1"})
        base.attrs["Version"] = 2.1
        base.attrs.create("Contributors", np.array(["geofit"], object), dtype=text)
        for name in (
            "Data",
            "Groups",
            "Objects",
            "Types/Data types",
            "Types/Group types",
            "Types/Object types",
        ):
            base.create_group(name)
        kind = base.create_group(f"Types/Group types/{{{ROOT}}}")
        self._set(kind, {"ID": f"{{{ROOT}}}", "Name": "Workspace", "Description": "Entity"})
        self._set(kind, {"Allow delete contents": 1, "Allow move contents": 1})
        self._root = self._entity("Groups", "Workspace", SHOWN | {"Allow delete": 0, "Allow move": 0})
        self._root["Type"] = kind
        for name in ("Data", "Groups", "Objects"):
            self._root.create_group(name)
        base["Root"] = self._root

    def add(self, name: str, kind: str, word: str, xyz: Floats) -> Any:
        item = self._object(name, kind, word)
        item["Vertices"] = np.ascontiguousarray(xyz, "<f8").view(VERTEX).reshape(-1)
        return item

    def blocks(self, name: str, corner: Floats, spacing: float, shape: tuple[int, int, int]) -> Any:
        item = self._object(name, BLOCKS, "Block model")
        item.attrs.create("Origin", np.array(tuple(corner.tolist()), VERTEX))
        item.attrs.create("Rotation", 0.0, dtype="<f8")
        for axis, count in zip("UVZ", shape, strict=True):
            item[f"{axis} cell delimiters"] = spacing * np.arange(count + 1, dtype="<f8")
        return item

    def _object(self, name: str, kind: str, word: str) -> Any:
        item = self._entity("Objects", name, SHOWN | {"Last focus": "None"}, of=kind)
        types = self._base["Types/Object types"]
        if f"{{{kind}}}" not in types:
            self._set(types.create_group(f"{{{kind}}}"), {"ID": f"{{{kind}}}", "Name": word, "Description": word})
        item["Type"] = types[f"{{{kind}}}"]
        item.create_group("Data")
        self._root["Objects"][item.attrs["ID"]] = item
        return item

    def values(self, item: Any, name: str, association: str, values: NDArray[Any]) -> None:
        owner = item.attrs["ID"]
        shown = SHOWN | {"Association": association, "Modifiable": 1, "Visible": 0}
        entity = self._entity("Data", name, shown, of=owner)
        primitive = "Float" if values.dtype.kind == "f" else "Integer"
        key = f"{{{uuid.uuid5(NAMESPACE, f'type/{name}')}}}"
        types = self._base["Types/Data types"]
        if key not in types:
            head = {"ID": key, "Name": name, "Description": "Entity", "Primitive type": primitive}
            more = {"Hidden": 0, "Mapping": "equal_area", "Precision": 3, "Transparent no data": 1}
            self._set(types.create_group(key), head | more)
        entity["Type"] = types[key]
        entity["Data"] = values
        item["Data"][entity.attrs["ID"]] = entity

    def _entity(self, folder: str, name: str, attributes: Mapping[str, Any], of: str = "") -> Any:
        key = f"{{{uuid.uuid5(NAMESPACE, f'{folder}/{of}/{name}')}}}"
        entity = self._base[folder].create_group(key)
        self._set(entity, {"ID": key, "Name": name, **attributes})
        return entity

    def _set(self, group: Any, attributes: Mapping[str, Any]) -> None:
        for name, value in attributes.items():
            if isinstance(value, str):
                group.attrs.create(name, value, dtype=self._text)
            else:
                group.attrs.create(name, value, dtype="i1")

"""OMF read back: along the format's own identifiers, and by mira-omf where it is installed."""

from __future__ import annotations

import json
import struct
import zlib

import numpy as np
import pytest
from surfaces import fold, horizon, nine

from geofit.data.errors import InputError
from geofit.data.points import PointSet
from geofit.io.export.omf import write_omf

POINTS = PointSet(np.array([[5e5, 3.1e6, 400.0], [500010.5, 3100020.25, 410.125]]))
OFF = np.array([0.25, -0.5])


@pytest.fixture(scope="module")
def meshes():
    return {"T2/T1": horizon(nine()[1]).triangulate(2.0), "强风化": horizon([fold()]).triangulate(2.0)}


@pytest.fixture(scope="module")
def written(meshes, tmp_path_factory):
    path = tmp_path_factory.mktemp("omf") / "site.omf"
    write_omf(meshes, path, {"T2/T1": (POINTS, OFF)})
    return path


def read(path):
    """The elements of a file by name: class, places in map coordinates, corners, values."""
    data = path.read_bytes()
    magic, version, identifier, start = struct.unpack_from("<4s32s16sQ", data)
    assert (magic, version.rstrip(b"\0")) == (b"\x84\x83\x82\x81", b"OMF-v0.9.0")
    parts = json.loads(data[start:])
    text = identifier.hex()
    project = parts["-".join([text[:8], text[8:12], text[12:16], text[16:20], text[20:]])]
    assert project["__class__"] == "Project"

    def array(key, width):
        place = parts[key]["array"]
        raw = zlib.decompress(data[place["start"] : place["start"] + place["length"]])
        return np.frombuffer(raw, place["dtype"]).reshape((-1, width) if width > 1 else -1)

    found = {}
    for element in (parts[key] for key in project["elements"]):
        shape = parts[element["geometry"]]
        corners = array(shape["triangles"], 3) if "triangles" in shape else None
        values = {
            parts[key]["name"]: (parts[key]["location"], array(parts[key]["array"], 1)) for key in element["data"]
        }
        found[element["name"]] = (array(shape["vertices"], 3) + shape["origin"], corners, values)
    return found


def test_the_identifiers_of_the_format(written, meshes):
    found = read(written)
    assert list(found) == [*meshes, "T2/T1 points"]
    for name, mesh in meshes.items():
        xyz, corners, values = found[name]
        assert np.array_equal(xyz, mesh.xyz)
        assert np.array_equal(corners, mesh.triangles)
        assert values["elevation"][0] == "vertices"
        assert np.array_equal(values["elevation"][1], mesh.xyz[:, 2])
        assert values["patch"][0] == "faces"
        assert np.array_equal(values["patch"][1], mesh.patch)
    xyz, corners, values = found["T2/T1 points"]
    assert corners is None
    assert np.abs(xyz - POINTS.xyz).max() < 1e-9
    assert np.array_equal(values["deviation"][1], OFF)


def test_mira_omf_reads_it(written, meshes):
    omf = pytest.importorskip("omf", reason="mira-omf holds numpy to 1.26")
    project = omf.OMFReader(str(written)).get_project()
    project.validate()
    for element, mesh in zip(project.elements, meshes.values(), strict=False):
        assert np.array_equal(np.array(element.geometry.vertices.array) + element.geometry.origin, mesh.xyz)
        assert np.array_equal(np.array(element.geometry.triangles.array), mesh.triangles)


def test_same_surfaces_give_the_same_bytes_and_nothing_else(written, meshes, tmp_path):
    write_omf(meshes, tmp_path / "b.omf", {"T2/T1": (POINTS, OFF)})
    assert (tmp_path / "b.omf").read_bytes() == written.read_bytes()
    assert [p.name for p in tmp_path.iterdir()] == ["b.omf"]
    with pytest.raises(InputError, match="No surface"):
        write_omf({}, tmp_path / "c.omf")

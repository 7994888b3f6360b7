"""geoh5 read back: by h5py along the format's own links, and by geoh5py where it is installed."""

from __future__ import annotations

import numpy as np
import pytest
from surfaces import fold, horizon, nine

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.points import PointSet
from geofit.io.export.geoh5 import write_geoh5

POINTS = PointSet(np.array([[5e5, 3.1e6, 400.0], [500010.5, 3100020.25, 410.125]]))
OFF = np.array([0.25, -0.5])


@pytest.fixture(scope="module")
def meshes():
    return {"T2/T1": horizon(nine()[1]).triangulate(2.0), "强风化": horizon([fold()]).triangulate(2.0)}


@pytest.fixture(scope="module")
def written(meshes, tmp_path_factory):
    pytest.importorskip("h5py")
    path = tmp_path_factory.mktemp("geoh5") / "site.geoh5"
    write_geoh5(meshes, path, {"T2/T1": (POINTS, OFF)})
    return path


def test_the_links_of_the_format(written, meshes):
    h5py = pytest.importorskip("h5py")
    with h5py.File(written) as file:
        base = file["GEOSCIENCE"]
        assert base.attrs["Distance unit"] == "meter"
        objects = {item.attrs["Name"]: item for item in base["Root/Objects"].values()}
        assert set(objects) == {*meshes, "T2/T1 points"}
        for name, mesh in meshes.items():
            item = objects[name]
            assert item == base["Objects"][item.attrs["ID"]]
            assert item["Type"].attrs["ID"] == "{f26feba3-aded-494b-b9e9-b2bbcbe298e1}"
            xyz = np.column_stack([item["Vertices"][axis] for axis in "xyz"])
            assert np.array_equal(xyz, mesh.xyz)
            assert np.array_equal(item["Cells"][:], mesh.triangles)
            data = {entry.attrs["Name"]: entry for entry in item["Data"].values()}
            assert np.array_equal(data["elevation"]["Data"][:], mesh.xyz[:, 2])
            assert data["patch"].attrs["Association"] == "Cell"
        (deviation,) = objects["T2/T1 points"]["Data"].values()
        assert np.array_equal(deviation["Data"][:], OFF)


def test_geoh5py_reads_it(written, meshes):
    geoh5py = pytest.importorskip("geoh5py", reason="geoh5py holds numpy below 2")
    with geoh5py.Workspace(written, mode="r") as workspace:
        for name, mesh in meshes.items():
            (surface,) = workspace.get_entity(name)
            assert type(surface).__name__ == "Surface"
            assert np.array_equal(surface.vertices, mesh.xyz)
            assert np.array_equal(surface.cells, mesh.triangles)
            assert np.array_equal(surface.get_data("patch")[0].values, mesh.patch)
        (data,) = workspace.get_entity("T2/T1 points")
        assert np.array_equal(data.get_data("deviation")[0].values, OFF)


def test_same_bytes_and_refusals(written, meshes, tmp_path, monkeypatch):
    write_geoh5(meshes, tmp_path / "b.geoh5", {"T2/T1": (POINTS, OFF)})
    assert (tmp_path / "b.geoh5").read_bytes() == written.read_bytes()
    with pytest.raises(InputError, match="No surface"):
        write_geoh5({}, tmp_path / "a.geoh5")
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    with pytest.raises(MissingDependencyError, match=r"geofit-geology\[geoh5\]"):
        write_geoh5(meshes, tmp_path / "a.geoh5")
    assert [p.name for p in tmp_path.iterdir()] == ["b.geoh5"]

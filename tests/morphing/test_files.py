"""Bodies from files, the files of a metamorphosis, and the command."""

from __future__ import annotations

import csv
import json
import struct

import numpy as np
import pytest
import trimesh

import geofit
import geofit.implicit as implicit
from geofit.cli.main import app
from geofit.data.errors import InputError, SettingsError
from geofit.geometry.mesh import Mesh
from geofit.io.export.triangles import write_obj, write_ply, write_stl
from geofit.io.export.tsurf import write_tsurf
from geofit.project.morph_run import run_morph

PLACE = np.array([512_300.0, 4_012_300.0, 700.0])


def ball(radius: float = 5.0) -> implicit.TriangleMesh:
    field = implicit.Sphere([0, 0, 0], radius)
    return implicit.isosurface(field, implicit.Lattice.around(*field.bounds, cells=24), capped=True)


def as_mesh(body: implicit.TriangleMesh, name: str) -> Mesh:
    count = len(body.triangles)
    return Mesh(body.vertices, body.triangles, np.zeros(count, int), np.zeros((count, 3, 2)), PLACE, (name,))


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "ts"])
def test_a_written_body_is_read_again(ending: str, tmp_path) -> None:
    body, path = ball(), tmp_path / f"cavern.{ending}"
    mesh = as_mesh(body, "cavern")
    {"stl": write_stl, "obj": write_obj, "ply": write_ply, "ts": write_tsurf}[ending]({"cavern": mesh}, path)
    found = geofit.io.read_body(path)
    assert found.is_closed
    assert found.euler == 2
    assert found.volume == pytest.approx(body.volume, rel=1e-5)
    np.testing.assert_allclose(found.vertices.mean(axis=0), PLACE, atol=0.01)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
def test_a_ply_of_another_program_is_read(kind: str, tmp_path) -> None:
    body, path = ball(), tmp_path / "other.ply"
    data = trimesh.Trimesh(body.vertices, body.triangles, process=False).export(
        file_type="ply", encoding="ascii" if kind == "ascii" else "binary"
    )
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    assert geofit.io.read_body(path).volume == pytest.approx(body.volume, rel=1e-5)


def test_a_text_stl_and_polygons_of_an_obj_are_read(tmp_path) -> None:
    box = trimesh.creation.box((2, 3, 4))
    (tmp_path / "box.stl").write_text(box.export(file_type="stl_ascii"))
    assert geofit.io.read_body(tmp_path / "box.stl").volume == pytest.approx(24)
    corners = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
    faces = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf -7 -3 -1 -5\n"
    (tmp_path / "box.obj").write_text(corners + faces)
    found = geofit.io.read_body(tmp_path / "box.obj")
    assert found.is_closed
    assert abs(found.volume) == pytest.approx(1)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.stl", b"solid nothing\nendsolid\n"),
        ("b.stl", b" " * 80 + struct.pack("<I", 7)),
        ("c.obj", b"v 0 0 0\nf 1 2 9\n"),
        ("d.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n"),
        ("e.ply", b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n1 2\n"),
        ("f.xyz", b""),
    ],
)
def test_damaged_files_are_refused(name: str, data: bytes, tmp_path) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError):
        geofit.io.read_body(tmp_path / name)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("morph")
    a = implicit.union(implicit.Sphere(PLACE, 5), implicit.Sphere(PLACE + np.array([14, 0, 0]), 2))
    b = implicit.Sphere(PLACE + np.array([1, 0, 0]), 6)
    m = geofit.morph(a, b, cells=32, dates=["2023-05-01", "2024-05-01"], sd=[0.1, 0.1])

    class Flat:
        def elevation(self, x, y):
            return np.full(np.shape(x), PLACE[2])

    return run_morph(m, out, frames=5, name="void", step=0.5, horizons={"T1": Flat()}), out


def test_frames_are_closed_in_every_format(run) -> None:
    found, out = run
    volumes = [row.volume for row in found.rows]
    for k, volume in enumerate(volumes):
        for kind in ("stl", "obj"):
            mesh = trimesh.load(out / f"void_{kind}" / f"void_{k:04d}.{kind}", process=True)
            mesh.merge_vertices()
            assert mesh.is_watertight
            assert mesh.volume == pytest.approx(volume, rel=1e-4)
        vtp = implicit.TriangleMesh(*_vtp(out / "void" / f"void_{k:04d}.vtp"))
        assert vtp.volume == pytest.approx(volume, rel=1e-6)
    scene = trimesh.load(out / "void.glb")
    assert len(scene.geometry) == 5
    listed = (out / "void.pvd").read_text()
    assert listed.count("<DataSet") == 5
    assert 'file="void/void_0004.vtp"' in listed


def _vtp(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    faces = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(data.GetPoints().GetData()), faces


def test_the_table_has_dates_volumes_and_drift(run) -> None:
    found, out = run
    with (out / "void.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["date"] for row in rows] == [row.date.isoformat() for row in found.rows]
    assert float(rows[-1]["drift_m3"]) <= 1e-4 * float(rows[-1]["volume_m3"])
    assert rows[0]["interpolated"] == "False"
    assert rows[2]["interpolated"] == "True"
    figures = json.loads((out / "void.json").read_text(encoding="utf-8"))
    assert "nothing is known" in figures["note"]
    assert figures["vanishing"][0]["volume"] == pytest.approx(4 / 3 * np.pi * 8, rel=0.1)
    assert figures["events"][0]["components"] == [2, 1]
    assert figures["alignment"]["applied"] is False


def test_the_volume_of_each_frame_is_divided_by_horizons(run) -> None:
    found, _ = run
    for row, strata in zip(found.rows, found.strata, strict=True):
        assert sum(strata.values()) == pytest.approx(row.volume, rel=1e-6)
        assert strata["above T1"] == pytest.approx(row.volume / 2, rel=0.02)


def test_a_frame_becomes_a_solid(run) -> None:
    found, out = run
    assert found.read_back.passed
    assert found.read_back.solids >= 1
    again = geofit.io.read_body(out / "void_0.5.step")
    assert again.is_closed
    assert again.volume == pytest.approx(found.morph(0.5).volume, rel=0.01)


def test_the_film_has_every_frame(run) -> None:
    from PIL import Image

    _, out = run
    with Image.open(out / "void.gif") as film:
        assert film.n_frames == 5
        film.seek(2)
        assert np.asarray(film.convert("L")).std() > 5


def test_the_command_writes_what_it_names(tmp_path) -> None:
    from typer.testing import CliRunner

    for name, radius in (("a", 4.0), ("b", 5.0)):
        write_stl({name: as_mesh(ball(radius), name)}, tmp_path / f"{name}.stl")
    asked = [str(tmp_path / "a.stl"), str(tmp_path / "b.stl"), "--frames", "3", "--cells", "24", "--film", "none"]
    done = CliRunner().invoke(app, ["morph", *asked, "--out", str(tmp_path / "out"), "--json"])
    assert done.exit_code == 0, done.output
    figures = json.loads(done.stdout)
    assert len(figures["frames"]) == 3
    assert figures["changes"][0]["net"] == pytest.approx(4 / 3 * np.pi * (125 - 64), rel=0.02)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"a-b.csv", "a-b.pvd", "a-b.glb", "a-b.json", "a-b_stl", "a-b_obj", "a-b"} <= names
    triangle = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    (tmp_path / "open.stl").write_text(triangle.export(file_type="stl_ascii"))
    (tmp_path / "packed.stl").write_bytes(triangle.export(file_type="stl"))
    for name in ("open.stl", "packed.stl"):
        refused = CliRunner().invoke(app, ["morph", str(tmp_path / name), asked[1], "--out", str(tmp_path / "no")])
        assert refused.exit_code == 2
        assert f"The mesh '{name}' is open: 3 edges" in " ".join(refused.output.split())
        assert not (tmp_path / "no").exists()


def test_solids_of_step_files_are_the_ends_of_a_metamorphosis(tmp_path, run) -> None:
    solid = run[0].morph(0.5)
    solid.write_step(tmp_path / "half.step")
    half = geofit.io.read_body(tmp_path / "half.step")
    assert half.volume == pytest.approx(solid.volume, rel=0.01)
    m = geofit.morph(half, half, cells=24, names=["half", "half again"])
    assert m(0.5).volume == pytest.approx(half.volume, rel=0.01)
    (tmp_path / "cut.step").write_bytes((tmp_path / "half.step").read_bytes()[:5000])
    with pytest.raises(InputError, match="cut"):
        geofit.io.read_body(tmp_path / "cut.step")
    with pytest.raises(SettingsError, match="1 names are given for 2 bodies"):
        geofit.morph(half, half, names=["half"])

"""Triangle formats read back by meshio, pyvista, trimesh and the standard library's XML."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from surfaces import fold, horizon, nine

from geofit.data.errors import InputError
from geofit.data.points import PointSet
from geofit.geometry.mesh import Mesh
from geofit.io.export import dxf, landxml, triangles, tsurf, vtk
from geofit.io.meshes import read_obj, read_stl


@pytest.fixture(scope="module")
def meshes():
    """Nine trimmed patches and an overturned fold, of different origins."""
    first = horizon(nine()[1], outline=[[100, 80], [500, 20], [900, 100], [950, 600], [80, 650]])
    second = horizon([fold()])
    second = second.with_(origin=second.origin + np.array([700.0, -50.0, 30.0]))
    return {"T1 top": first.triangulate(1.0), "强风化": second.triangulate(1.0)}


def corners(xyz, faces):
    """Corners of every triangle, (m, 3, 3)."""
    return np.asarray(xyz)[np.asarray(faces)]


def truth(meshes):
    return np.concatenate([corners(mesh.xyz, mesh.triangles) for mesh in meshes.values()])


def test_obj(meshes, tmp_path):
    meshio = pytest.importorskip("meshio")
    triangles.write_obj(meshes, tmp_path / "a.obj")
    back = meshio.read(tmp_path / "a.obj")
    found = np.concatenate([corners(back.points, cells.data) for cells in back.cells])
    assert np.abs(found - truth(meshes)).max() <= 5.1e-7
    assert [line for line in (tmp_path / "a.obj").read_text("utf-8").splitlines() if line.startswith("o ")] == [
        "o T1_top",
        "o 强风化",
    ]


def test_ply_holds_doubles_and_the_patch(meshes, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    triangles.write_ply(meshes, tmp_path / "a.ply")
    back = trimesh.load(tmp_path / "a.ply", process=False)
    assert np.array_equal(corners(back.vertices, back.faces), truth(meshes))
    data = back.metadata["_ply_raw"]["face"]["data"]
    assert np.array_equal(data["patch"].ravel(), np.concatenate([m.patch for m in meshes.values()]))
    assert np.array_equal(np.unique(data["horizon"]), [0, 1])


def test_stl_is_local_and_says_where(meshes, tmp_path):
    meshio = pytest.importorskip("meshio")
    origin = triangles.write_stl(meshes, tmp_path / "a.stl")
    back = meshio.read(tmp_path / "a.stl")
    found = corners(back.points, back.cells_dict["triangle"]).astype(float) + origin
    assert np.abs(found - truth(meshes)).max() < 1e-4  # single precision over 1 km
    words = (tmp_path / "a.stl.origin.txt").read_text("utf-8").split()
    stated = [float(words[words.index(axis) + 1]) for axis in ("easting", "northing", "elevation")]
    assert stated == origin.tolist()
    assert (origin % 100 == 0).all()


def test_glb_has_y_up_names_and_the_origin(meshes, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    origin = triangles.write_glb(meshes, tmp_path / "a.glb")
    scene = trimesh.load(tmp_path / "a.glb", process=False)
    assert sorted(scene.graph.nodes_geometry) == sorted(meshes)
    for name, mesh in meshes.items():
        part = scene.geometry[scene.graph[name][1]]
        x, y, z = np.asarray(part.vertices, float).T
        back = np.stack([x, -z, y], axis=1) + origin
        assert np.abs(corners(back, part.faces) - corners(mesh.xyz, mesh.triangles)).max() < 1e-4
    raw = (tmp_path / "a.glb").read_bytes()
    assert int.from_bytes(raw[8:12], "little") == len(raw)
    length = int.from_bytes(raw[12:16], "little")
    assert json.loads(raw[20 : 20 + length])["asset"]["extras"]["origin"] == origin.tolist()


@pytest.mark.parametrize(("low", "size"), [(-3e-6, 2e-4), (0.0, 5e-5), (7.0, 0.03), (123.0, 40.0)])
def test_triangles_of_a_rock_sample_keep_their_size(low, size, tmp_path):
    """Micrometres apart, coordinates relative to 100 m were equal in single precision."""
    xyz = low + size * np.random.default_rng(0).random((300, 3))
    faces = np.arange(300).reshape(-1, 3)
    mesh = Mesh(xyz, faces, np.zeros(100, int), np.zeros((100, 3, 2)), np.zeros(3), ("pores",))
    triangles.write_obj({"pores": mesh}, tmp_path / "a.obj")
    origin = triangles.write_stl({"pores": mesh}, tmp_path / "a.stl")
    assert (origin == triangles.write_glb({"pores": mesh}, tmp_path / "a.glb")).all()
    for back in (read_stl(tmp_path / "a.stl"), read_obj(tmp_path / "a.obj")):
        assert len(back.triangles) == 100
        assert np.abs(np.sort(back.corners, axis=1) - np.sort(xyz[faces], axis=1)).max() < 2e-6 * size
    words = (tmp_path / "a.stl.origin.txt").read_text("utf-8").split()
    assert [float(words[words.index(axis) + 1]) for axis in ("easting", "northing", "elevation")] == origin.tolist()


def test_vtp_holds_deviation_and_patch(meshes, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    mesh = meshes["T1 top"]
    data = PointSet(mesh.xyz[:5] + np.array([0, 0, 0.25]))
    vtk.write_vtp(mesh, tmp_path / "a.vtp", data, np.array([0.25, -0.5, 0.0, 1.0, 2.0]))
    back = pyvista.read(tmp_path / "a.vtp")
    assert back.points.dtype == np.float64
    assert np.array_equal(back.points, np.concatenate([mesh.xyz, data.xyz]))
    assert np.array_equal(back.faces.reshape(-1, 4)[:, 1:], mesh.triangles)
    assert back.n_verts == 5
    assert np.array_equal(back["deviation"][-5:], [0.25, -0.5, 0.0, 1.0, 2.0])
    assert np.isnan(back["deviation"][:-5]).all()
    assert np.array_equal(back.cell_data["patch"], np.concatenate([[-1] * 5, mesh.patch]))
    assert back.field_data["patch names"].tolist() == list(mesh.names)
    with pytest.raises(InputError, match="given: 0; points: 5"):
        vtk.write_vtp(mesh, tmp_path / "b.vtp", data, [])
    assert not (tmp_path / "b.vtp").exists()


def test_vtm_names_its_blocks(meshes, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    data = PointSet(np.array([[5e5, 3.1e6, 400.0]]))
    vtk.write_vtm(meshes, tmp_path / "site.vtm", {"强风化": (data, np.array([0.5]))})
    back = pyvista.read(tmp_path / "site.vtm")
    assert back.keys() == list(meshes)
    assert [back[name].n_verts for name in meshes] == [0, 1]
    assert np.array_equal(back["T1 top"].points, meshes["T1 top"].xyz)


def read_tsurf(path):
    """The format's own words: objects between GOCAD and END, VRTX and TRGL lines."""
    found, name, vertices, faces = {}, "", {}, []
    for line in path.read_text("utf-8").splitlines():
        key, _, rest = line.partition(" ")
        if line.startswith("name:"):
            name, vertices, faces = line[5:], {}, []
        elif key == "VRTX":
            number, *place = rest.split()
            vertices[int(number)] = [float(c) for c in place]
        elif key == "TRGL":
            faces.append([int(n) for n in rest.split()])
        elif line == "END":
            found[name] = np.array([[vertices[n] for n in face] for face in faces])
    return found


def test_tsurf(meshes, tmp_path):
    tsurf.write_tsurf(meshes, tmp_path / "a.ts")
    back = read_tsurf(tmp_path / "a.ts")
    assert list(back) == list(meshes)
    for name, mesh in meshes.items():
        assert np.abs(back[name] - corners(mesh.xyz, mesh.triangles)).max() <= 5.1e-7


def test_tsurf_is_read_by_the_own_reader(meshes, tmp_path):
    from geofit.io.picks import read_points

    tsurf.write_tsurf(meshes, tmp_path / "a.ts")
    horizons = read_points(tmp_path / "a.ts").horizons
    assert list(horizons) == list(meshes)
    assert np.abs(horizons["T1 top"].xyz - meshes["T1 top"].xyz).max() <= 5.1e-7


coordinates = st.floats(-9e6, 9e6, allow_nan=False).map(lambda x: x + 0.0)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    xyz=st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=3, max_size=12),
    name=st.text(st.characters(exclude_categories=["C", "Z"], exclude_characters="{}"), min_size=1, max_size=12),
    data=st.data(),
)
def test_any_tsurf_comes_back(xyz, name, data, tmp_path):
    index = st.integers(0, len(xyz) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(index, index, index), min_size=1, max_size=8)))
    mesh = Mesh(np.array(xyz), faces, np.zeros(len(faces), int), np.zeros((len(faces), 3, 2)), np.zeros(3), ("core",))
    tsurf.write_tsurf({name: mesh}, tmp_path / "any.ts")
    back = read_tsurf(tmp_path / "any.ts")
    assert np.abs(back[name] - np.array(xyz)[faces]).max() <= 5.1e-7


def test_landxml_follows_the_schema_and_agrees(meshes, tmp_path):
    mesh = meshes["T1 top"]
    landxml.write_landxml({"T1 <top> & 'x'": mesh}, tmp_path / "a.xml")
    space = {"l": "http://www.landxml.org/schema/LandXML-1.2"}
    root = ET.parse(tmp_path / "a.xml").getroot()
    assert root.tag == "{" + space["l"] + "}LandXML"
    # Required by the schema: version, date, time; Units first with their attributes; then the surfaces.
    assert {"version", "date", "time"} <= set(root.attrib)
    assert [child.tag.split("}")[1] for child in root] == ["Units", "Application", "Surfaces"]
    metric = root.find("l:Units/l:Metric", space)
    needed = {"linearUnit", "areaUnit", "volumeUnit", "temperatureUnit", "pressureUnit"}
    assert needed <= set(metric.attrib)
    (surface,) = root.findall("l:Surfaces/l:Surface", space)
    assert surface.get("name") == "T1 <top> & 'x'"
    definition = surface.find("l:Definition", space)
    assert definition.get("surfType") == "TIN"
    points = {p.get("id"): [float(c) for c in str(p.text).split()] for p in definition.findall("l:Pnts/l:P", space)}
    faces = [[points[n] for n in str(f.text).split()] for f in definition.findall("l:Faces/l:F", space)]
    back = np.array(faces)[..., [1, 0, 2]]
    assert np.abs(back - corners(mesh.xyz, mesh.triangles)).max() <= 5.1e-7
    assert float(definition.get("area2DSurf")) == pytest.approx(488000 + 2500, rel=0.05)


#: What LandXML 1.2 documents of the elements that are written: needed and further attributes, and the children.
LANDXML = {
    "LandXML": ({"version", "date", "time"}, {"language", "readOnly"}, ["Units", "Application", "Surfaces"]),
    "Units": (set(), set(), ["Metric"]),
    "Metric": (
        {"linearUnit", "areaUnit", "volumeUnit", "temperatureUnit", "pressureUnit"},
        {"diameterUnit", "angularUnit", "directionUnit"},
        [],
    ),
    "Application": ({"name"}, {"version", "desc", "manufacturer", "manufacturerURL", "timeStamp"}, []),
    "Surfaces": (set(), {"name", "desc", "state"}, ["Surface+"]),
    "Surface": ({"name"}, {"desc", "OID", "state"}, ["Definition"]),
    "Definition": ({"surfType"}, {"area2DSurf", "area3DSurf", "elevMax", "elevMin"}, ["Pnts", "Faces"]),
    "Pnts": (set(), set(), ["P+"]),
    "P": ({"id"}, {"name", "desc", "code"}, []),
    "Faces": (set(), set(), ["F+"]),
    "F": (set(), {"i", "n", "b"}, []),
}
#: The words that its units may be.
LANDXML_UNITS = {
    "linearUnit": {"millimeter", "centimeter", "meter", "kilometer"},
    "areaUnit": {"hectare", "squareMeter", "squareMillimeter", "squareCentimeter"},
    "volumeUnit": {"cubicMeter", "liter", "hectareMeter"},
    "temperatureUnit": {"celsius", "kelvin"},
    "pressureUnit": {"HPA", "milliBars", "mmHG", "millimeterHG"},
    "diameterUnit": {"millimeter", "centimeter", "meter", "kilometer"},
}


def landxml_faults(element):
    """What an element and all below it have that LandXML 1.2 does not allow, or lack."""
    name = element.tag.removeprefix("{http://www.landxml.org/schema/LandXML-1.2}")
    if name not in LANDXML:
        return [f"unknown {name}"]
    needed, further, order = LANDXML[name]
    faults = [f"{name} without {one}" for one in needed - set(element.attrib)]
    faults += [f"{name} with {one}" for one in set(element.attrib) - needed - further]
    children = [child.tag.rsplit("}", 1)[1] for child in element]
    pattern = "".join(f"({one.removesuffix('+')} ){'+' if one.endswith('+') else ''}" for one in order)
    if not re.fullmatch(pattern, "".join(f"{child} " for child in children)):
        faults.append(f"{name} holds {children[:3]}")
    if name == "Metric":
        faults += [f"{key}={value}" for key, value in element.items() if value not in LANDXML_UNITS.get(key, {value})]
    return faults + [fault for child in element for fault in landxml_faults(child)]


def test_landxml_holds_no_element_or_attribute_that_the_schema_lacks(meshes, tmp_path):
    mesh = meshes["T1 top"]
    landxml.write_landxml({"one": mesh, "two": mesh}, tmp_path / "a.xml")
    root = ET.parse(tmp_path / "a.xml").getroot()
    assert landxml_faults(root) == []
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d", f"{root.get('date')} {root.get('time')}")
    for surface in root.findall(".//{*}Surface"):
        definition = surface.find("{*}Definition")
        assert definition.get("surfType") == "TIN"
        # Ids are positive whole numbers, each once; a face names three of them, all different.
        ids = [p.get("id") for p in surface.findall(".//{*}P")]
        assert all(re.fullmatch("[1-9][0-9]*", one) for one in ids)
        assert len(set(ids)) == len(ids) >= 3
        faces = [str(f.text).split() for f in surface.findall(".//{*}F")]
        assert all(len(set(face)) == 3 and set(face) <= set(ids) for face in faces)
        # Northing, easting, elevation: the first of these is some 3,100 km, the second some 500 km.
        place = np.array([[float(c) for c in str(p.text).split()] for p in surface.findall(".//{*}P")])
        assert np.array_equal(np.round(place.mean(axis=0), -5), [3.1e6, 5e5, 0])
        heights = float(definition.get("elevMin")), float(definition.get("elevMax"))
        assert heights == pytest.approx((place[:, 2].min(), place[:, 2].max()), abs=1e-6)
    # The check itself finds what is wrong.
    definition.set("surfaceType", "TIN")
    definition.insert(0, definition[1])
    assert len(landxml_faults(root)) == 2


def test_landxml_refuses_an_overturned_surface(meshes, tmp_path):
    with pytest.raises(InputError, match="overturned"):
        landxml.write_landxml(meshes, tmp_path / "a.xml")
    assert list(tmp_path.iterdir()) == []


def test_dxf_faces(meshes, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    dxf.write_mesh_dxf(meshes, tmp_path / "a.dxf")
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert not document.audit().errors
    assert document.units == 6
    faces = [
        face for layer in ("T1_top", "强风化") for face in document.modelspace().query(f'3DFACE[layer=="{layer}"]')
    ]
    back = np.array([[list(v) for v in face.wcs_vertices()[:3]] for face in faces])
    assert np.abs(back - truth(meshes)).max() < 1e-9


@pytest.mark.parametrize(
    "write",
    [
        triangles.write_obj,
        triangles.write_ply,
        triangles.write_stl,
        triangles.write_glb,
        tsurf.write_tsurf,
        dxf.write_mesh_dxf,
        vtk.write_vtm,
    ],
)
def test_the_same_meshes_give_the_same_bytes(write, meshes, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    for folder in ("one", "two"):
        write(meshes, tmp_path / folder / "a.x")
    files = [sorted(p for p in (tmp_path / folder).rglob("*") if p.is_file()) for folder in ("one", "two")]
    assert [p.read_bytes() for p in files[0]] == [p.read_bytes() for p in files[1]]
    assert not [p for p in files[0] if ".part" in p.name]


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (4_500_000.0, 3_100_000.0, 100.0)])
def test_obj_and_ply_state_what_is_true_of_every_origin(origin, tmp_path):
    """A survey about its first station, or a body read about a local zero, is not in map coordinates."""
    place = np.array([[0.0, 0, 0], [100, 0, 0], [0, 100, 5]])
    mesh = Mesh(place, np.array([[0, 1, 2]]), np.zeros(1, int), np.zeros((1, 3, 2)), np.array(origin), ("a",))
    triangles.write_obj({"a": mesh}, tmp_path / "a.obj")
    triangles.write_ply({"a": mesh}, tmp_path / "a.ply")
    for name in ("a.obj", "a.ply"):
        head = (tmp_path / name).read_bytes()[:300].decode("latin-1")
        assert "map coordinates" not in head
        assert "coordinates as in the data, no offset" in head
    assert read_obj(tmp_path / "a.obj").vertices.min(axis=0).tolist() == list(origin)

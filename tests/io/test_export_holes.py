"""Holes of a file's faces in every format of triangles, lines and grids, measured by independent readers."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from surfaces import area, bored, height_field, split

from geofit.io.export.write import write_surface
from geofit.io.surface_files import read_surfaces
from geofit.project.section import section
from geofit.sampling.contours import contours

ROUND = ((500, 350, 120), (250, 180, 60), (700, 700, 90))


@pytest.fixture(scope="module")
def holed(tmp_path_factory):
    """A horizon of four faces that three round holes cut, as read from a file; and its true area."""
    path = tmp_path_factory.mktemp("holed") / "a.brep"
    truth, _ = bored(path, split(height_field(21, 17), [500.0], [350.0]))
    return read_surfaces([path]), truth


def by_meshio(path):
    back = pytest.importorskip("meshio").read(path)
    return np.concatenate([np.asarray(back.points, float)[cells.data] for cells in back.cells])


def by_trimesh(path):
    back = pytest.importorskip("trimesh").load(path, process=False, force="mesh")
    return np.asarray(back.vertices, float)[back.faces]


def by_pyvista(path):
    back = pytest.importorskip("pyvista").read(path)
    faces = back if path.suffix == ".vtp" else back[0]
    return faces.points[faces.faces.reshape(-1, 4)[:, 1:]]


def by_ezdxf(path):
    space = pytest.importorskip("ezdxf").readfile(path).modelspace()
    return np.array([[list(v) for v in face.wcs_vertices()[:3]] for face in space.query("3DFACE")])


def by_words(path):
    lines = [line.split() for line in path.read_text("utf-8").splitlines()]
    place = {words[1]: [float(c) for c in words[2:5]] for words in lines if words[0] == "VRTX"}
    return np.array([[place[n] for n in words[1:4]] for words in lines if words[0] == "TRGL"])


def by_xml(path):
    space = {"l": "http://www.landxml.org/schema/LandXML-1.2"}
    root = ET.parse(path).getroot()
    place = {p.get("id"): [float(c) for c in str(p.text).split()] for p in root.findall(".//l:P", space)}
    return np.array([[place[n] for n in str(f.text).split()] for f in root.findall(".//l:F", space)])[..., [1, 0, 2]]


@pytest.mark.parametrize(
    ("to", "read"),
    [
        ("obj", by_meshio),
        ("ply", by_trimesh),
        ("stl", by_meshio),
        ("stl", by_trimesh),
        ("glb", by_trimesh),
        ("vtp", by_pyvista),
        ("vtm", by_pyvista),
        ("tsurf", by_words),
        ("landxml", by_xml),
        ("dxf-mesh", by_ezdxf),
    ],
)
def test_the_area_in_the_file_is_that_of_the_faces(to, read, holed, tmp_path):
    surfaces, truth = holed
    (file, *_) = write_surface(surfaces, tmp_path / f"a.{to.removesuffix('-mesh')}", format=to, tolerance=0.2)
    # Whole faces would be a tenth larger.
    assert area(read(file)) == pytest.approx(truth, rel=1e-3)


def test_contours_sections_and_grids_end_at_the_holes(holed, tmp_path):
    surfaces, _ = holed
    (surface,) = surfaces.values()

    def clear(plan, of=0.05):
        return min(np.hypot(plan[:, 0] - x, plan[:, 1] - y).min() - radius for x, y, radius in ROUND) > -of

    lines = contours(surface, 10.0, tolerance=0.2)
    assert clear(np.concatenate([one.line for one in lines]))
    cuts, _ = section(surfaces, np.array([[100.0, 350], [900, 350]]), tmp_path / "s", tolerance=0.2)
    (west, east) = next(iter(cuts.values()))
    assert (west.distance[[0, -1]], east.distance[[0, -1]]) == (
        pytest.approx([0, 280], abs=0.05),
        pytest.approx([520, 800], abs=0.05),
    )
    from geofit.io.grid import read_ground

    (file,) = write_surface(surfaces, tmp_path / "a.asc", format="asc", cell=20.0)
    grid = read_ground(file)
    x, y = np.meshgrid(grid.x, grid.y)
    over = np.any([np.hypot(x - a, y - b) < radius for a, b, radius in ROUND], axis=0)
    on_rim = np.any([np.abs(np.hypot(x - a, y - b) - radius) < 0.1 for a, b, radius in ROUND], axis=0)
    assert (np.isnan(grid.z) == over)[~on_rim].all()

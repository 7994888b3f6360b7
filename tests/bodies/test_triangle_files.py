"""Triangles of a body in the usual formats: closed, and of the body's volume, as other readers find them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geofit.bodies.body import BodyFit
from geofit.geometry.mesh import Mesh
from geofit.io.export import triangles as files
from geofit.io.export.vtk import write_vtp


def mesh_of(body: BodyFit) -> Mesh:
    surface = body.overview
    count = len(surface.triangles)
    return Mesh(
        surface.vertices,
        surface.triangles,
        np.zeros(count, np.int64),
        np.zeros((count, 3, 2)),
        body.origin,
        (body.name,),
    )


@pytest.mark.parametrize("ending", ["stl", "obj", "vtp"])
def test_triangles_as_vtk_reads_them(ring: BodyFit, tmp_path: Path, ending: str) -> None:
    pyvista = pytest.importorskip("pyvista")
    path = tmp_path / f"ring.{ending}"
    if ending == "vtp":
        write_vtp(mesh_of(ring), path)
    else:
        getattr(files, f"write_{ending}")({"ring": mesh_of(ring)}, path)
    # An STL repeats each corner, and its numbers have seven digits.
    read = pyvista.read(path)
    read.clear_data()
    read = read.clean(tolerance=1e-9).triangulate()
    points = np.asarray(read.points, float)
    corners = points[read.regular_faces] - points.mean(axis=0)
    assert np.linalg.det(corners).sum() / 6 == pytest.approx(ring.overview.volume, rel=1e-6)
    edges = np.sort(read.regular_faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert len(points) - len(edges) // 2 + len(read.regular_faces) == ring.overview.euler


# VTK reads the doubles of a PLY as floats, so it cannot judge a file in map coordinates.
@pytest.mark.parametrize("ending", ["ply", "glb"])
def test_triangles_as_trimesh_reads_them(ring: BodyFit, tmp_path: Path, ending: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    path = tmp_path / f"ring.{ending}"
    getattr(files, f"write_{ending}")({"ring": mesh_of(ring)}, path)
    read = trimesh.load(path, force="mesh")
    assert read.is_watertight
    assert read.euler_number == ring.overview.euler
    corners = np.asarray(read.triangles, float) - np.asarray(read.vertices, float).mean(axis=0)
    assert np.linalg.det(corners).sum() / 6 == pytest.approx(ring.overview.volume, rel=1e-6)

"""Distance to triangles and height over them, against brute force by another library."""

from __future__ import annotations

import numpy as np
import pytest
from surfaces import ORIGIN, fold, height_field, horizon

from geofit.geometry.mesh import Mesh
from geofit.geometry.mesh_projection import mesh_elevation, nearest_on_mesh
from geofit.sampling.contours import contours
from geofit.sampling.cut import cut_section
from geofit.sampling.grids import elevation_grid
from geofit.surfaces.mesh_surface import MeshSurface


def mesh_of(points, triangles, origin=(0.0, 0.0, 0.0)):
    points, triangles = np.asarray(points, float), np.asarray(triangles)
    count = len(triangles)
    return Mesh(points, triangles, np.zeros(count, int), np.zeros((count, 3, 2)), np.asarray(origin, float), ("T1",))


@pytest.mark.parametrize("patch", [height_field(nu=9, nv=7), fold()], ids=["wavy", "overturned"])
def test_the_nearest_place_is_that_of_trimesh(patch):
    trimesh = pytest.importorskip("trimesh")
    mesh = horizon([patch]).triangulate(2.0)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    rng = np.random.default_rng(1)
    target = rng.uniform(low - 0.3 * (high - low), high + 0.3 * (high - low), (300, 3))
    truth = trimesh.Trimesh(mesh.points, mesh.triangles, process=False)
    foot, distance, _ = trimesh.proximity.closest_point_naive(truth, target)
    found = nearest_on_mesh(mesh, target)
    assert np.abs(np.abs(found.distance) - distance).max() < 1e-9
    assert np.abs(found.foot - foot).max() < 1e-6


def test_large_and_small_triangles_together():
    rng = np.random.default_rng(2)
    corners = rng.uniform(0, 100, (200, 1, 3)) + rng.normal(0, 1, (200, 3, 3)) * 10 ** rng.uniform(-2, 2, (200, 1, 1))
    mesh = mesh_of(corners.reshape(-1, 3), np.arange(600).reshape(-1, 3))
    target = rng.uniform(-50, 150, (200, 3))
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    share = np.stack(np.meshgrid(*[np.linspace(0, 1, 41)] * 2)).reshape(2, -1)
    share = share[:, share.sum(axis=0) <= 1]
    places = a[:, None] + share[0][:, None] * (b - a)[:, None] + share[1][:, None] * (c - a)[:, None]
    sampled = np.array([np.linalg.norm(places - p, axis=2).min() for p in target])
    found = nearest_on_mesh(mesh, target)
    # No sample of any triangle is nearer, and the foot lies on the triangle that is named.
    assert (np.abs(found.distance) <= sampled + 1e-9).all()
    own = nearest_on_mesh(mesh_of(corners.reshape(-1, 3), np.arange(600).reshape(-1, 3)), found.foot)
    assert np.abs(own.distance).max() < 1e-9


def test_sides_and_what_lies_beyond():
    # A ridge along y = 0, the roof's two slopes from x = -1 to 1.
    points = [[-1, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 4, 0], [0, 4, 1], [1, 4, 0]]
    mesh = mesh_of(points, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    target = np.array([[0, 2, 2], [0, 2, 0.2], [0.3, 2, 0.2], [3, 2, 0], [0, 5, 1.5], [-0.5, 2, 1.5]])
    found = nearest_on_mesh(mesh, target)
    root = np.sqrt(0.5)
    assert found.distance[:3] == pytest.approx([1, -0.8 * root, -0.5 * root])
    assert np.abs(found.distance[3:]) == pytest.approx([2, np.sqrt(1.25), root])
    # Over the ridge is not beside the surface; past the eave and past the gable is.
    assert found.beyond.tolist() == [False, False, False, True, True, False]
    turned = mesh_of(points, np.array(mesh.triangles)[:, ::-1])
    assert nearest_on_mesh(turned, target).distance == pytest.approx(found.distance)


def test_over_a_sharp_ridge_the_side_is_that_of_the_slope_that_faces_the_point():
    points = [[-1, 0, 0], [0, 0, 3], [1, 0, 0], [-1, 4, 0], [0, 4, 3], [1, 4, 0]]
    mesh = mesh_of(points, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    found = nearest_on_mesh(mesh, [[0.3, 2, 3.2], [-0.3, 2, 3.2]])
    assert found.distance == pytest.approx(np.hypot([0.3, 0.3], 0.2))


def test_a_triangle_without_area_does_no_harm():
    points = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [2, 0, 0]]
    found = nearest_on_mesh(mesh_of(points, [[0, 1, 2], [0, 3, 1]]), [[1.0, 1.0, 3.0]])
    assert found.distance.tolist() == [3.0]


def test_height_of_the_highest_and_nan_outside():
    points = [[0, 0, 0], [4, 0, 0], [0, 4, 4], [0, 0, 9], [1, 0, 9], [0, 1, 9]]
    mesh = mesh_of(points, [[0, 1, 2], [3, 4, 5]], (100, 200, 300))
    z = mesh_elevation(mesh, [[101.0, 100.2], [104.0, 103.9]], [[201.0, 200.2], [200.0, 203.0]])
    assert z[0].tolist() == pytest.approx([301, 309])
    assert z[1, 0] == pytest.approx(300)
    assert np.isnan(z[1, 1])


def test_a_mesh_is_cut_contoured_and_gridded_as_it_stands():
    mesh = horizon([height_field(z=lambda x, y: 0.2 * x + 0 * y)]).triangulate(0.05)
    surface = MeshSurface(mesh)
    assert surface.triangulate(9.0) is mesh
    lines = contours(surface, 70.0)
    assert [line.elevation for line in lines] == [420, 490, 560]
    for line in lines:
        assert np.abs(0.2 * (line.line[:, 0] - ORIGIN[0]) + ORIGIN[2] - line.elevation).max() < 1e-6
    (one,) = cut_section(surface, np.array([[100, 50], [400, 60], [900, 600]]) + ORIGIN[:2])
    assert np.abs(one.xyz[:, 2] - ORIGIN[2] - 0.2 * (one.xyz[:, 0] - ORIGIN[0])).max() < 1e-6
    assert one.distance[-1] == pytest.approx(np.hypot(300, 10) + np.hypot(500, 540))
    grid = elevation_grid(surface, 100.0)
    assert np.abs(grid.z - ORIGIN[2] - 0.2 * (grid.x - ORIGIN[0])).max() < 1e-6

"""Closed meshes cut by a curtain: areas of balls and rings, holes, bends."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.implicit import Sphere, Torus
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.sampling.mesh_section import mesh_section

LINE = np.array([[-20.0, 0.3], [20.0, 0.3]])


def mesh_of(field, half=8.0, cells=60):
    low, high = np.full(3, -half), np.full(3, half)
    return isosurface(field, Lattice.around(low, high, cells=cells), capped=True)


def test_a_ball_is_cut_in_a_disc():
    mesh = mesh_of(Sphere([0, 0, 0], 5.0))
    (cut,) = mesh_section(mesh.vertices, mesh.triangles, LINE)
    assert cut.area == pytest.approx(np.pi * (25 - 0.09), rel=0.005)
    assert (cut.centroid.x, cut.centroid.y) == pytest.approx((20, 0), abs=0.02)
    assert len(cut.interiors) == 0


def test_a_ring_is_cut_in_two_discs_or_in_a_disc_with_a_hole():
    torus = mesh_of(Torus([0, 0, 0], [0, 0, 1], 4.0, 1.5))
    (cut,) = mesh_section(torus.vertices, torus.triangles, LINE)
    assert cut.geom_type == "MultiPolygon"
    assert cut.area == pytest.approx(2 * np.pi * 1.5**2, rel=0.02)
    upright = mesh_of(Torus([0, 0, 0], [0, 1, 0], 4.0, 1.5))
    (cut,) = mesh_section(upright.vertices, upright.triangles, [[-20, 0], [20, 0]])
    assert len(cut.interiors) == 1
    assert cut.area == pytest.approx(np.pi * (5.5**2 - 2.5**2), rel=0.01)


def test_a_bent_line_cuts_each_of_its_legs():
    mesh = mesh_of(Sphere([0, 0, 0], 5.0))
    first, second = mesh_section(mesh.vertices, mesh.triangles, [[-20, 0], [0, 0], [0, 20]])
    assert first.bounds[2] == pytest.approx(20)
    assert second.bounds[0] == pytest.approx(20)
    assert first.area == pytest.approx(np.pi * 25 / 2, rel=0.01)
    assert second.area == pytest.approx(np.pi * 25 / 2, rel=0.01)


def test_a_line_beside_the_body_cuts_nothing():
    mesh = mesh_of(Sphere([0, 0, 0], 5.0))
    assert mesh_section(mesh.vertices, mesh.triangles, [[-20, 6], [20, 6]]) == ()
    assert mesh_section(mesh.vertices, mesh.triangles, [[-20, 0], [-6, 0]]) == ()


def test_a_plane_through_vertices_is_no_exception():
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 0, 1) for z in (-1.0, 1)])
    from scipy.spatial import ConvexHull

    hull = ConvexHull(corners + 1e-9 * np.random.default_rng(0).normal(size=corners.shape))
    (cut,) = mesh_section(corners, hull.simplices, [[-3, 0], [3, 0]])
    assert cut.area == pytest.approx(4, rel=1e-6)

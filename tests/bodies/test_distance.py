"""Distances to the surface of a body where its field is rounded and its mesh is coarser than its parts."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.bodies.distance import body_distance
from geofit.implicit import TriangleMesh

CENTRES, RADII = np.array([[0.0, 0.0, 0.0], [900.0, 0.0, 0.0]]), np.array([100.0, 2.0])


class RoundedSpheres:
    """Two spheres, with the rounding of a micrometre that a field of many contacts has."""

    def value(self, xyz):
        return self.distances(xyz).min(axis=1) + 1e-6 * np.sin(1e9 * xyz.sum(axis=1))

    def gradient(self, xyz):
        way = xyz[:, None] - CENTRES
        chosen = way[np.arange(len(xyz)), self.distances(xyz).argmin(axis=1)]
        return chosen / np.maximum(np.linalg.norm(chosen, axis=1), 1e-12)[:, None]

    def distances(self, xyz):
        return np.linalg.norm(xyz[:, None] - CENTRES, axis=2) - RADII


def large_sphere():
    """A mesh of the large sphere: its cells are wider than the small one."""
    import pyvista

    mesh = pyvista.Sphere(radius=100.0, theta_resolution=24, phi_resolution=24).triangulate()
    return TriangleMesh(np.asarray(mesh.points, float), mesh.faces.reshape(-1, 4)[:, 1:])


@pytest.mark.parametrize("out", [0.0, 3e-7, 0.5, 5.0])
def test_contacts_of_a_part_that_the_mesh_lacks_are_measured_to_that_part(out):
    rng = np.random.default_rng(3)
    way = rng.normal(size=(60, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    places = np.concatenate([centre + (radius + out) * way for centre, radius in zip(CENTRES, RADII, strict=True)])
    found = body_distance(RoundedSpheres(), places, 60.0, large_sphere)
    assert np.abs(np.abs(found) - out).max() < 3e-6

"""T21 of the arrival field: fronts whose course is known, at every vertex and every resolution."""

from __future__ import annotations

import numpy as np
import pytest

import geofit
import geofit.implicit as implicit
from geofit.morphing.arrival import arrival


@pytest.mark.parametrize(("first", "last"), [(0.3, 0.7), (0.7, 0.3)])
def test_the_worst_vertex_between_concentric_spheres_is_of_second_order(first: float, last: float) -> None:
    worst = []
    for cells in (24, 48, 72, 96):
        h = 2.0 / cells
        m = geofit.morph(implicit.Sphere([0, 0, 0], first), implicit.Sphere([0, 0, 0], last), spacing=h, pace="time")
        off = [
            np.linalg.norm(m(s).mesh.vertices, axis=1) - first - s * (last - first)
            for s in (0.1, 0.25, 0.5, 1 - np.exp(-1), 0.9)
        ]
        worst.append(max(np.abs(one).max() for one in off))
        assert worst[-1] <= 0.02 * h
    assert np.log2(worst[0] / worst[-1]) / 2 >= 1.9


def test_a_cap_on_a_plane_falls_as_caps_through_its_rim() -> None:
    """With B a plane, 1 / |d_B| is the metric of the hyperbolic half-space: fronts are caps through one circle."""
    radius, rise = 0.6, 0.03
    for cells in (48, 96):
        lattice = implicit.Lattice.around([-1] * 3, [1] * 3, cells=cells)
        xyz = lattice.nodes()
        place = xyz - [0.01, 0.02, 0.0123]
        d_a = np.linalg.norm(place - [0, 0, rise], axis=1) - radius
        beyond = np.abs(place + np.array([0, 0, 0.4])) - [0.75, 0.75, 0.4]
        d_b = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
        u = arrival(d_a.reshape(lattice.shape), d_b.reshape(lattice.shape), lattice.spacing).ravel()
        rim, q, z = np.sqrt(radius**2 - rise**2), np.hypot(*place[:, :2].T), place[:, 2]
        cap = (d_a < 0) & (z > 0.5 * lattice.spacing)
        assert not np.isnan(u[cap]).any()
        centre = (q[cap] ** 2 + z[cap] ** 2 - rim**2) / (2 * z[cap])
        truth = (centre + np.hypot(centre, rim)) / (rise + radius)
        off = np.abs(u[cap] / truth - 1) * z[cap] / lattice.spacing
        from_rim = np.hypot(q[cap] - rim, z[cap]) / lattice.spacing
        assert off.mean() <= 0.01
        assert np.percentile(off[from_rim > 4], 99) <= 0.05


def test_no_hollow_appears_in_a_neck_that_the_front_hardly_passes() -> None:
    a = implicit.ellipsoid([0, 0, 0], [0.8, 0.45, 0.3])
    b = implicit.union(implicit.Sphere([0.35, 0.1, 0], 0.4), implicit.Sphere([-0.4, 0, 0.1], 0.35))
    m = geofit.morph(a, b, cells=48, pace="time")
    for s in (0.1, 0.5, 0.85):
        assert m(s).components == 1


def test_a_hollow_of_the_later_body_opens_within_the_earlier_one() -> None:
    ball = implicit.Sphere([0, 0, 0], 1.0)
    shell = implicit.difference(implicit.Sphere([0.1, 0, 0], 1.1), implicit.Sphere([0, 0, 0], 0.4))
    m = geofit.morph(ball, shell, cells=40, pace="time")
    assert m(0.1).components == 1
    assert m(0.95).mesh.components == 2
    assert m(0.95).components == 1
    assert all(body.overview.is_closed and body.overview.is_manifold for body in m.frames(5))

"""Fields keep their promises: gradient, bounds, Lipschitz bound and ranges, for every kind of field."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import geofit.implicit as implicit
from geofit.data.errors import SettingsError
from geofit.implicit.field import box_of, points_of
from geofit.implicit.foot import project_along_gradient

RNG = np.random.default_rng(7)
LINE = np.array([[0.0, 0, 0], [1, 1, 0], [2, 0, 1], [3, 1, 1]])
BALLS = RNG.uniform(-1, 1, (8, 3))
FORK = np.array([[[0.0, 0, 0], [1, 0, 0]], [[1, 0, 0], [1.5, 0.8, 0]], [[1, 0, 0], [1.5, -0.8, 0.3]]])
A, B = implicit.Sphere([0, 0, 0], 1.0), implicit.Sphere([1.2, 0, 0], 0.9)
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])

FIELDS = {
    "plane": implicit.Plane([0, 0, 0.2], [1, 2, 2]),
    "ellipsoid": implicit.ellipsoid([0.1, 0, 0], [1.5, 1, 0.6]),
    "cone": implicit.quadric_from_coefficients([1, 0, 0, 0, 1, 0, 0, -1, 0, 0]),
    "sphere": A,
    "cylinder": implicit.Cylinder([0, 0, 0], [1, 1, 0], 0.5),
    "torus": implicit.Torus([0, 0, 0], [0, 1, 1], 1.0, 0.3),
    "curve": implicit.CurveTube(LINE, 0.2),
    "round cones": implicit.RoundCones(LINE, [0.1, 0.4, 0.2, 0.5]),
    **{f"balls {k}": implicit.spherical_metaballs(BALLS, 0.7, np.where(np.arange(8) == 3, -1, 1.2), kernel=k)
       for k in implicit.POTENTIALS},
    **{f"segments {k}": implicit.Convolution(FORK, [0.3, 0.2, 0.25], k) for k in ("compact", "gauss", "cauchy")},
    "union": implicit.union(A, B),
    "intersection": implicit.intersection(A, B),
    "difference": implicit.difference(A, B),
    "complement": implicit.complement(A),
    "smooth union": implicit.smooth_union(A, B, 0.3),
    "smooth intersection": implicit.smooth_intersection(A, B, 0.3),
    "smooth difference": implicit.smooth_difference(A, B, 0.3),
    "r union": implicit.r_union(A, B),
    "r intersection": implicit.r_intersection(A, B),
    "spline": implicit.spline_of_field(A, implicit.Lattice.around([-1.5] * 3, [1.5] * 3, cells=12)),
    "moved": implicit.moved(implicit.Torus([1, 0, 0], [1, 0, 0], 0.8, 0.3), TURN, [0.1, 0.2, 0.3]),
}  # fmt: skip


@pytest.mark.parametrize("name", FIELDS)
def test_gradient_is_that_of_the_values(name: str) -> None:
    field, eps = FIELDS[name], 1e-6
    xyz = np.random.default_rng(1).uniform(-2, 2.5, (300, 3))
    slope = [(field.value(xyz + eps * e) - field.value(xyz - eps * e)) / (2 * eps) for e in np.eye(3)]
    error = np.sort(np.abs(field.gradient(xyz) - np.stack(slope, axis=1)).max(axis=1))
    # A crease may lie between the two values of a difference: a few points are left out.
    assert error[295] < 1e-7
    assert isinstance(field, implicit.Field)


@pytest.mark.parametrize("name", FIELDS)
def test_no_value_leaves_its_range(name: str) -> None:
    field, rng = FIELDS[name], np.random.default_rng(2)
    lower = rng.uniform(-2, 2.5, (200, 3))
    upper = lower + rng.uniform(0, 0.6, (200, 3))
    low, high = implicit.range_in(field, lower, upper)
    for _ in range(30):
        value = field.value(lower + (upper - lower) * rng.uniform(size=(200, 3)))
        assert (value >= low - 1e-12).all()
        assert (value <= high + 1e-12).all()


@pytest.mark.parametrize("name", FIELDS)
def test_no_gradient_exceeds_the_lipschitz_bound_and_the_body_is_in_its_box(name: str) -> None:
    field, rng = FIELDS[name], np.random.default_rng(3)
    low, high = field.bounds
    xyz = rng.uniform(np.maximum(low, -4), np.minimum(high, 4), (20000, 3))
    assert np.linalg.norm(field.gradient(xyz), axis=1).max() <= field.lipschitz * (1 + 1e-9)
    around = rng.uniform(-6, 6, (20000, 3))
    outside = ((around < low) | (around > high)).any(axis=1)
    assert (field.value(around[outside]) >= 0).all()


def test_moved_field_is_the_field_at_the_point_moved_back() -> None:
    torus = implicit.Torus([1, 0, 0], [1, 0, 0], 0.8, 0.3)
    xyz = np.random.default_rng(4).uniform(-1, 1, (50, 3))
    np.testing.assert_allclose(FIELDS["moved"].value(xyz @ TURN.T + [0.1, 0.2, 0.3]), torus.value(xyz), atol=1e-14)


def test_arrays_of_other_shapes_boxes_upside_down_and_mirrors_are_refused() -> None:
    with pytest.raises(SettingsError, match=r"need \(n, 3\)"):
        points_of([1, 2, 3])
    with pytest.raises(SettingsError, match="lower <= upper"):
        box_of([0, 0, 1], [1, 1, 0])
    with pytest.raises(SettingsError, match="not a rotation"):
        implicit.moved(A, 2 * np.eye(3))
    with pytest.raises(SettingsError, match="positive"):
        implicit.Sphere([0, 0, 0], -1.0)
    with pytest.raises(SettingsError, match="coincide"):
        implicit.RoundCones([[0, 0, 0], [0, 0, 0]], 1.0)


def test_import_needs_numpy_only() -> None:
    code = "import sys, geofit.implicit; print(sorted({'scipy', 'numba', 'vtkmodules', 'pyvista'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_exported_name_exists() -> None:
    assert all(callable(getattr(implicit, name)) or name == "POTENTIALS" for name in implicit.__all__)
    assert implicit.isosurface.__name__ == "isosurface"


def test_newton_steps_end_where_they_move_nothing() -> None:
    asked = []

    class Counted(implicit.Sphere):
        def gradient(self, xyz: np.ndarray) -> np.ndarray:
            asked.append(len(xyz))
            return super().gradient(xyz)

    ball = Counted([0, 0, 0], 1.0)
    places = np.random.default_rng(3).normal(size=(200, 3))
    moved = project_along_gradient(ball, places, steps=30)
    assert np.abs(np.linalg.norm(moved, axis=1) - 1).max() < 1e-12
    assert len(asked) < 5
    # A reach that is short against the way takes as many steps as the way asks for.
    assert (
        np.abs(np.linalg.norm(project_along_gradient(ball, 3 * places, reach=0.5, steps=40), axis=1) - 1).max() < 1e-12
    )


def test_a_field_that_bounds_its_values_is_not_asked_for_a_costly_bound():
    """The bound of a spline's gradient took a third of a metamorphosis, and nothing needed it."""

    class Costly:
        bounds = np.zeros(3), np.ones(3)

        def value(self, xyz):
            return xyz[:, 0]

        def gradient(self, xyz):
            return np.zeros_like(xyz)

        @property
        def lipschitz(self):
            raise AssertionError("nothing needs this bound")

        def range_in(self, lower, upper):
            return lower[:, 0], upper[:, 0]

    low, high = implicit.range_in(Costly(), np.zeros((2, 3)), np.ones((2, 3)))
    assert (low.tolist(), high.tolist()) == ([0, 0], [1, 1])

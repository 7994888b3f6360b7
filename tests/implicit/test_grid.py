"""T18-T20: tricubic splines are C2, their curvature converges; foot points, distances, reinitialisation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import geofit.implicit as implicit
from geofit.data.errors import FitError, SettingsError

BOX = ([-1.0] * 3, [1.0] * 3)
SPHERE = implicit.Sphere([0, 0, 0], 0.6)


def on_sphere(n: int, seed: int = 0) -> np.ndarray:
    u = np.random.default_rng(seed).normal(size=(n, 3))
    return u / np.linalg.norm(u, axis=1)[:, None]


def wavy(xyz: np.ndarray) -> np.ndarray:
    x, y, z = xyz.T
    return ((xyz**2).sum(axis=1) - 0.36) * (1.5 + np.sin(3 * x) + 0.5 * y * z)


def wavy_slope(xyz: np.ndarray) -> np.ndarray:
    x, y, z = xyz.T
    factor = 1.5 + np.sin(3 * x) + 0.5 * y * z
    rest = (xyz**2).sum(axis=1) - 0.36
    return 2 * xyz * factor[:, None] + rest[:, None] * np.stack([3 * np.cos(3 * x), 0.5 * z, 0.5 * y], axis=1)


WAVY = implicit.FunctionField(wavy, wavy_slope)


def reference(grid: implicit.SplineGrid, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, gradients and Hessians by numpy, from the coefficients."""
    place = (xyz - grid.lattice.origin) / grid.lattice.spacing
    cell = np.minimum(np.floor(place).astype(int), np.array(grid.lattice.shape) - 2)
    u = place - cell
    basis = [
        np.stack([(1 - u) ** 3, 4 - 6 * u**2 + 3 * u**3, 1 + 3 * u + 3 * u**2 - 3 * u**3, u**3], axis=-1) / 6,
        np.stack([-((1 - u) ** 2), 3 * u**2 - 4 * u, 1 + 2 * u - 3 * u**2, u**2], axis=-1) / 2,
        np.stack([1 - u, 3 * u - 2, 1 - 3 * u, u], axis=-1),
    ]
    local = cell[:, :, None] + np.arange(4)
    c = grid.coefficients[local[:, 0, :, None, None], local[:, 1, None, :, None], local[:, 2, None, None, :]]

    def part(i: int, j: int, k: int) -> np.ndarray:
        return np.einsum("nijk,ni,nj,nk->n", c, basis[i][:, 0], basis[j][:, 1], basis[k][:, 2])

    h = grid.lattice.spacing
    gradient = np.stack([part(1, 0, 0), part(0, 1, 0), part(0, 0, 1)], axis=1) / h
    xx, yy, zz, xy, xz, yz = (part(*o) for o in ((2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1)))
    hessian = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3) / h**2
    return part(0, 0, 0), gradient, hessian


@pytest.mark.parametrize("shape", [(7, 9, 12), (2, 3, 4), (30, 2, 5)])
def test_compiled_splines_are_those_of_numpy(shape: tuple[int, int, int]) -> None:
    rng = np.random.default_rng(1)
    lattice = implicit.Lattice([0.1, -2, 3], 0.3, shape)
    grid = implicit.spline_grid(rng.normal(size=shape), lattice)
    xyz = rng.uniform(*lattice.bounds, (500, 3))
    for ours, numpys in zip(grid.jet(xyz), reference(grid, xyz), strict=True):
        np.testing.assert_allclose(ours, numpys, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(grid.value(xyz), grid.jet(xyz)[0], atol=1e-13)


def test_spline_passes_through_its_samples_and_is_the_natural_one() -> None:
    rng = np.random.default_rng(2)
    lattice = implicit.Lattice([0, 0, 0], 0.5, (8, 5, 6))
    values = rng.normal(size=lattice.shape)
    grid = implicit.spline_grid(values, lattice)
    np.testing.assert_allclose(grid.value(lattice.nodes()), values.ravel(), atol=1e-12)
    x = np.linspace(0, 3.5, 50)
    line = np.stack([x, 0 * x + 1.0, 0 * x + 1.5], axis=1)
    natural = CubicSpline(lattice.axes[0], values[:, 2, 3], bc_type="natural")
    np.testing.assert_allclose(grid.value(line), natural(x), atol=1e-12)


def test_value_gradient_and_hessian_do_not_jump_at_cell_faces_but_the_third_derivative_does() -> None:
    rng = np.random.default_rng(3)
    lattice = implicit.Lattice([0, 0, 0], 1.0, (14, 14, 14))
    grid = implicit.spline_grid(rng.normal(size=lattice.shape), lattice)
    xyz = rng.uniform(1, 12, (1000, 3))
    axis = rng.integers(0, 3, 1000)
    xyz[np.arange(1000), axis] = rng.integers(2, 11, 1000)
    step = np.eye(3)[axis]
    eps = 1e-13
    before, after = grid.jet(xyz - eps * step), grid.jet(xyz + eps * step)
    size = np.abs(grid.coefficients).max()
    for order, limit in enumerate((1e-12, 1e-12, 1e-11)):
        assert np.abs(before[order] - after[order]).max() <= limit * max(size, 1.0) * 10**order
    far = [grid.jet(xyz + t * step)[2][np.arange(1000), axis, axis] for t in (-0.2, -0.1, 0.1, 0.2)]
    third = (far[1] - far[0]) / 0.1, (far[3] - far[2]) / 0.1
    assert np.median(np.abs(third[1] - third[0])) > 0.1


def test_outside_its_box_a_spline_grows_by_the_distance() -> None:
    grid = implicit.spline_of_field(SPHERE, implicit.Lattice.around(*BOX, cells=16))
    xyz = np.array([[3.0, 0, 0], [2.0, 2.0, 0.2]])
    corner = np.array([[1.0, 0, 0], [1.0, 1.0, 0.2]])
    np.testing.assert_allclose(grid.value(xyz), grid.value(corner) + np.array([2.0, 2**0.5]))


def test_curvature_of_sphere_and_torus_converges() -> None:
    torus = implicit.Torus([0, 0, 0], [0, 0, 1], 0.6, 0.25)
    errors = []
    for n in (24, 48, 96):
        lattice = implicit.Lattice.around(*BOX, cells=n)
        xyz = 0.6 * on_sphere(4000)
        sphere = np.abs(implicit.spline_of_field(SPHERE, lattice).mean_curvature(xyz) - 2 / 0.6).max()
        a, b = np.random.default_rng(4).uniform(0, 2 * np.pi, (2, 4000))
        ring = 0.6 + 0.25 * np.cos(b)
        spot = np.stack([ring * np.cos(a), ring * np.sin(a), 0.25 * np.sin(b)], axis=1)
        truth = 1 / 0.25 + np.cos(b) / ring
        errors.append((sphere, np.abs(implicit.spline_of_field(torus, lattice).mean_curvature(spot) - truth).max()))
    assert (np.log2(errors[0]) - np.log2(errors[2]) >= 2 * 1.9).all()
    assert errors[2][0] <= 0.002


def test_foot_points_are_the_nearest_points() -> None:
    ellipsoid = implicit.ellipsoid([0, 0, 0], [3, 2, 1])
    mesh = implicit.isosurface(ellipsoid, implicit.Lattice.around([-3.1] * 3, [3.1] * 3, cells=40))
    xyz = np.random.default_rng(5).uniform(-4, 4, (300, 3))
    # Lagrange: the foot of p is p / (1 + t a), by bisection for points outside.
    outside = ellipsoid.value(xyz) > 0
    p, a2 = xyz[outside], np.array([9.0, 4, 1])
    low, high = np.zeros(len(p)), np.full(len(p), 100.0)
    for _ in range(200):
        t = (low + high) / 2
        f = ((p**2 * a2) / (a2 + t[:, None]) ** 2).sum(axis=1) - 1
        low, high = np.where(f > 0, t, low), np.where(f > 0, high, t)
    foot = p * a2 / (a2 + t[:, None])
    found = implicit.signed_distance(ellipsoid, p, mesh)
    np.testing.assert_allclose(found, np.linalg.norm(p - foot, axis=1), atol=1e-9)
    inside = implicit.signed_distance(ellipsoid, xyz[~outside], mesh)
    brute = -np.array([np.linalg.norm(mesh.vertices - q, axis=1).min() for q in xyz[~outside]])
    assert (inside >= brute - 1e-9).all()
    np.testing.assert_allclose(inside, brute, atol=0.12)


def test_reinitialised_field_is_the_distance_to_fourth_order() -> None:
    errors, h = [], 0.0
    for n in (24, 48, 96):
        lattice = implicit.Lattice.around(*BOX, cells=n)
        h = lattice.spacing
        distance = implicit.distance_field(WAVY, lattice)
        offset = np.random.default_rng(6).uniform(-2 * h, 2 * h, 8000)
        xyz = on_sphere(8000) * (0.6 + offset)[:, None]
        errors.append(np.abs(distance.value(xyz) - offset).max())
        slope = np.linalg.norm(distance.gradient(xyz), axis=1)
        assert np.abs(slope - 1).max() < 0.01
    assert np.log2(errors[0] / errors[1]) >= 3.5
    assert np.log2(errors[1] / errors[2]) >= 3.5
    assert errors[2] < 1.1e-7
    assert np.abs(distance.value(0.6 * on_sphere(8000))).max() < 1e-6 * h


def test_ten_reinitialisations_leave_the_surface_in_place() -> None:
    lattice = implicit.Lattice.around(*BOX, cells=48)
    field: implicit.Field = WAVY
    for _ in range(10):
        field = implicit.distance_field(field, lattice, band=8)
    assert np.abs(field.value(0.6 * on_sphere(2000))).max() < 1e-4 * lattice.spacing


def test_samples_that_do_not_fit_and_fields_without_a_surface_are_refused() -> None:
    lattice = implicit.Lattice.around(*BOX, cells=4)
    with pytest.raises(SettingsError, match="one value a node"):
        implicit.spline_grid(np.zeros((3, 3, 3)), lattice)
    with pytest.raises(SettingsError, match="not finite"):
        implicit.spline_grid(np.full(lattice.shape, np.nan), lattice)
    with pytest.raises(FitError, match="one sign"):
        implicit.distance_field(implicit.Sphere([9, 9, 9], 1.0), lattice)

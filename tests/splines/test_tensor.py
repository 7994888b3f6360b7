from __future__ import annotations

from math import comb

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from refusals import refused

from geofit.data.errors import FitError
from geofit.splines import bspline, sums, tensor
from geofit.splines.sums import COMPILED, Moments
from geofit.splines.tensor import CELLWISE, Factor, TensorSpace, band_times


def space_of(degree=3, multiplicity_u=1, u=(0, 1.5, 2, 4, 5), v=(-1, 0, 0.7, 3)):
    return TensorSpace(bspline.clamped_knots(u, degree, multiplicity_u), bspline.clamped_knots(v, degree), degree)


def dense(band):
    """The full symmetric matrix of a lower band."""
    size = band.shape[1]
    full = np.zeros((size, size))
    for k, row in enumerate(band):
        i = np.arange(size - k) if k < size else np.arange(0)
        full[i + k, i] = row[: size - k]
        full[i, i + k] = row[: size - k]
    return full


def scattered(space, n, seed=0):
    rng = np.random.default_rng(seed)
    low = (space.knots_u[0], space.knots_v[0])
    high = (space.knots_u[-1], space.knots_v[-1])
    plane = rng.uniform(low, high, (n, 2))
    plane[:4] = [(a, b) for a in (low[0], high[0]) for b in (low[1], high[1])]
    plane[4] = space.knots_u[len(space.knots_u) // 2], space.knots_v[len(space.knots_v) // 2]
    return plane, rng.normal(size=n), rng.uniform(0.2, 3, n)


def positive(size, width, seed=0):
    """A well-conditioned banded positive definite matrix."""
    rng = np.random.default_rng(seed)
    band = rng.normal(size=(width + 1, size))
    for k in range(1, width + 1):
        band[k, max(size - k, 0) :] = 0
    band[0] = 2 * (width + 1) + rng.uniform(0, 3, size)
    return band


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_the_collocation_matrix_is_the_product_of_two_bases(degree):
    space = space_of(degree)
    plane, _, _ = scattered(space, 50)
    bu = bspline.collocation(space.knots_u, degree, plane[:, 0])
    bv = bspline.collocation(space.knots_v, degree, plane[:, 1])
    wanted = np.einsum("na,nb->nab", bu, bv).reshape(50, space.size)
    np.testing.assert_allclose(space.matrix(plane).toarray(), wanted, atol=1e-15)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_normal_equations_equal_dense_numpy(degree):
    space = space_of(degree)
    plane, z, weight = scattered(space, 300)
    X = space.matrix(plane).toarray()
    band, right = space.normal_equations(plane, z, weight)
    np.testing.assert_allclose(dense(band), X.T @ (weight[:, None] * X), atol=1e-11)
    np.testing.assert_allclose(right, X.T @ (weight * z), atol=1e-11)


def test_several_columns_at_once_equal_one_by_one():
    space = space_of()
    plane, _, weight = scattered(space, 100)
    z = np.random.default_rng(1).normal(size=(100, 3))
    right = space.normal_equations(plane, z, weight)[1]
    assert right.shape == (space.size, 3)
    for k in range(3):
        np.testing.assert_allclose(right[:, k], space.normal_equations(plane, z[:, k], weight)[1], rtol=1e-12)


@pytest.mark.parametrize(("degree", "multiplicity"), [(1, 1), (2, 2), (3, 1), (3, [2, 3, 1])])
def test_cells_and_points_give_the_same_normal_equations(degree, multiplicity, monkeypatch):
    space = space_of(degree, multiplicity)
    plane, z, weight = scattered(space, 20_000)
    assert len(plane) >= CELLWISE * space.size
    by_cells = space.normal_equations(plane, z, weight)
    monkeypatch.setattr(tensor, "CELLWISE", len(plane))
    by_points = space.normal_equations(plane, z, weight)
    for cells, points in zip(by_cells, by_points, strict=True):
        np.testing.assert_allclose(cells, points, atol=1e-11 * np.abs(points).max())


def integral(space, control, order):
    """The energy by Gauss quadrature on every cell, from derivatives of the basis."""
    nodes, weights = leggauss(space.degree + 1)

    def rule(knots):
        breaks = np.unique(knots)
        half = np.diff(breaks) / 2
        x = (breaks[:-1] + half)[:, None] + half[:, None] * nodes
        return x.ravel(), (half[:, None] * weights).ravel()

    (u, wu), (v, wv) = rule(space.knots_u), rule(space.knots_v)
    net, total = control.reshape(space.shape), 0.0
    for k in range(order + 1):
        z = (
            bspline.collocation(space.knots_u, space.degree, u, order - k)
            @ net
            @ bspline.collocation(space.knots_v, space.degree, v, k).T
        )
        total += comb(order, k) * wu @ z**2 @ wv
    return total


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_energy_equals_quadrature(degree, order):
    if order > degree:
        return
    space = space_of(degree)
    control = np.random.default_rng(7).normal(size=space.size)
    found = control @ band_times(space.energy(order), control)
    assert found == pytest.approx(integral(space, control, order), rel=1e-10)


@pytest.mark.parametrize("order", [2, 3])
def test_the_energy_does_not_change_when_the_axes_turn(order):
    """Its derivatives of that order are constant, so that the same square counts for every direction."""
    space = space_of(u=np.linspace(-1, 1, 4), v=np.linspace(-1, 1, 4))
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 12)] * 2), axis=-1).reshape(-1, 2)

    def energy(cubic):
        control = np.linalg.lstsq(space.matrix(grid).toarray(), cubic(*grid.T), rcond=None)[0]
        return control @ band_times(space.energy(order), control)

    def cubic_form(x, y):
        return 2 * x**3 - x**2 * y + 0.5 * x * y**2 + 3 * y**3

    def square(x, y):
        return 2 * x**2 - x * y + 0.5 * y**2

    form = cubic_form if order == 3 else square
    energies = []
    for angle in np.radians([0, 17, 45, 90, 200]):
        c, s = np.cos(angle), np.sin(angle)
        energies.append(energy(lambda x, y, c=c, s=s: form(c * x - s * y, s * x + c * y)))
    assert energies[0] > 1
    np.testing.assert_allclose(energies, energies[0], rtol=1e-9)


def test_the_energy_leaves_a_plane_free():
    space = space_of()
    u, v = bspline.greville(space.knots_u, 3), bspline.greville(space.knots_v, 3)
    plane = (3 + 2 * u[:, None] - v[None, :]).ravel()
    for order in (2, 3):
        band = space.energy(order)
        assert abs(plane @ band_times(band, plane)) < 1e-14 * np.abs(band).max() * (plane @ plane)
    assert plane @ band_times(space.energy(1), plane) == pytest.approx(5 * 5 * 4, rel=1e-12)


def test_factor_solves_and_knows_the_determinant():
    band = positive(40, 7)
    right = np.random.default_rng(2).normal(size=(40, 2))
    full = dense(band)
    factor = Factor(band.copy())
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(full, right), rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(factor.solve(right[:, 0]), np.linalg.solve(full, right[:, 0]), rtol=1e-10, atol=1e-14)
    assert factor.logdet == pytest.approx(np.linalg.slogdet(full)[1], rel=1e-12)


def test_factor_bears_scales_ten_orders_apart():
    scale = 10.0 ** np.random.default_rng(3).uniform(-5, 5, 30)
    band = positive(30, 4)
    for k in range(5):
        band[k, : 30 - k] *= scale[: 30 - k] * scale[k:]
    wanted = np.random.default_rng(4).normal(size=30) / scale
    found = Factor(band.copy()).solve(dense(band) @ wanted)
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


def test_factor_leaves_its_argument_as_it_is():
    band = positive(10, 3)
    before = band.copy()
    Factor(band)
    np.testing.assert_array_equal(band, before)


def test_an_indefinite_matrix_is_a_fit_error():
    band = np.array([[1.0, 1.0, 1.0], [2.0, 0.0, 0.0]])
    with refused(FitError, "splines.system-not-positive"):
        Factor(band)


def test_a_control_point_that_nothing_holds_is_a_fit_error():
    band = positive(5, 1)
    band[:, 2] = 0
    with refused(FitError, "splines.control-points-without-data", count=1):
        Factor(band)


def test_too_few_points_without_energy_are_a_fit_error():
    space = space_of()
    plane, z, weight = scattered(space, 5)
    with pytest.raises(FitError):
        Factor(space.normal_equations(plane, z, weight)[0])


@pytest.mark.parametrize("shape", [(40,), (40, 3)])
def test_band_times_equals_the_dense_product(shape):
    band = positive(40, 6)
    x = np.random.default_rng(5).normal(size=shape)
    np.testing.assert_allclose(band_times(band, x), dense(band) @ x, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("n", [2_000, COMPILED])
def test_moments_of_one_mesh_serve_all_spaces_on_its_lines(degree, turned, n):
    rng, lines_u, lines_v = np.random.default_rng(4), np.linspace(0, 10, 13), np.linspace(0, 6, 9)
    plane, z, weight = rng.uniform(0, (10, 6), (n, 2)), rng.normal(size=n), rng.uniform(0.5, 2, n)
    moments = Moments.of(lines_u, lines_v, degree, plane, z, weight)
    for some_u, some_v in ((slice(None), slice(None)), ([0, 1, 5, 12], [0, 3, 4, 8]), ([0, 12], slice(None))):
        knots = (bspline.clamped_knots(lines[some], degree) for lines, some in ((lines_u, some_u), (lines_v, some_v)))
        space = TensorSpace(*knots, degree)
        assert moments.serve(space.knots_u, space.knots_v)
        expected = space.equations_of(*space.rows(plane), z, weight)
        if turned:
            space = space.turned
            expected = space.equations_of(*space.rows(plane[:, ::-1]), z, weight)
        found = space.equations((moments.turned if turned else moments).on(space.knots_u, space.knots_v))
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-10)
    assert not moments.serve(bspline.clamped_knots([0, 5.1, 10], degree), bspline.clamped_knots(lines_v, degree))
    assert not moments.serve(bspline.clamped_knots(lines_u[:-1], degree), bspline.clamped_knots(lines_v, degree))


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("apart", [1, 10**9])
def test_compiled_sums_equal_plain_ones_also_of_places_beyond_the_mesh(degree, apart, monkeypatch):
    monkeypatch.setattr(sums, "APART", apart)
    n, lines_u = 3 * COMPILED, np.array([0.0, 0.5, 3.0, 3.1, 10.0])
    rng, lines_v = np.random.default_rng(5), np.array([-2.0, 0.0, 5.0])
    plane = np.asfortranarray(rng.uniform((-0.5, -2.5), (10.5, 5.5), (n, 2)))
    plane[:4] = [(0, -2), (10, 5), (3, 0), (3.1, 5)]
    given = lines_u, lines_v, degree, plane, rng.normal(size=n), np.broadcast_to(4.0, n)
    compiled = Moments.of(*given)
    monkeypatch.setattr(sums, "COMPILED", n + 1)
    plain = Moments.of(*given)
    np.testing.assert_allclose(compiled.weights, plain.weights, atol=1e-8)
    np.testing.assert_allclose(compiled.heights, plain.heights, atol=1e-8)
    assert compiled.weights[..., 0, 0].sum() == pytest.approx(4 * n)


def test_a_mesh_may_reach_beyond_a_space_where_no_points_lie():
    rng, lines = np.random.default_rng(4), np.linspace(-4, 16, 21)
    plane, z, weight = rng.uniform(0, 10, (2_000, 2)), rng.normal(size=2_000), np.ones(2_000)
    moments = Moments.of(lines, lines, 3, plane, z, weight)
    knots = bspline.clamped_knots([-1, 0, 2, 5, 9, 10, 12], 3), bspline.clamped_knots([0, 4, 10], 3)
    space = TensorSpace(*knots)
    assert moments.serve(*knots)
    expected = space.equations_of(*space.rows(plane), z, weight)
    for one, other in zip(space.equations(moments.on(*knots)), expected, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-10)


def test_a_turned_space_has_the_same_surfaces():
    space = space_of()
    plane, z, weight = scattered(space, 300)
    band, right = space.normal_equations(plane, z, weight)
    turned = space.turned
    there, other = turned.normal_equations(plane[:, ::-1], z, weight)
    swap = np.arange(space.size).reshape(space.shape).T.ravel()
    np.testing.assert_allclose(dense(there), dense(band)[np.ix_(swap, swap)], atol=1e-12)
    np.testing.assert_allclose(other, right[swap], atol=1e-12)

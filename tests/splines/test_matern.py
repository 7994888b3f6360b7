from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.special import gamma, kv

from geofit.splines import bspline
from geofit.splines.couplings import dyads
from geofit.splines.matern import MaternPrecision, metric, metric_slopes
from geofit.splines.tensor import TensorSpace, band_times


def space_of(length_u=6.0, length_v=5.0, span=0.5):
    return TensorSpace(
        bspline.clamped_knots(np.arange(0, length_u + 1e-9, span), 3),
        bspline.clamped_knots(np.arange(0, length_v + 1e-9, span), 3),
    )


def dense(band):
    size = band.shape[1]
    full = np.zeros((size, size))
    for k in range(len(band)):
        index = np.arange(size - k)
        full[index + k, index] = full[index, index + k] = band[k, : size - k]
    return full


@pytest.mark.parametrize("stretch", [(0.0, 0.0), (0.5, -0.2), (-1.0, 0.7)])
def test_metric_has_determinant_one_and_the_stated_eigenvalue(stretch):
    a, b, c = metric(stretch)
    assert a * c - b * b == pytest.approx(1)
    assert np.linalg.eigvalsh([[a, b], [b, c]])[1] == pytest.approx(np.exp(np.hypot(*stretch)))


@pytest.mark.parametrize("alpha", [1, 2, 3])
def test_without_a_stretch_the_terms_are_those_of_the_energies(alpha):
    space, kappa = space_of(), 0.7
    binomial = {1: (1, 1), 2: (1, 2, 1), 3: (1, 3, 3, 1)}[alpha]
    expected = sum(
        weight * kappa ** (2 * (alpha - order)) * space.energy(order) for order, weight in enumerate(binomial)
    )
    np.testing.assert_allclose(MaternPrecision(space, alpha).band(kappa), expected, atol=1e-9)


@pytest.mark.parametrize("alpha", [2, 3])
def test_a_stretch_against_numerical_integration(alpha):
    """On a polynomial, which the space holds exactly, all derivatives are known."""
    space, kappa, stretch = space_of(2.0, 1.5), 0.6, (0.4, 0.3)
    a, b, c = metric(stretch)
    grid = np.stack(np.meshgrid(np.linspace(0, 2, 20), np.linspace(0, 1.5, 20)), axis=-1).reshape(-1, 2)
    u, v = grid.T
    net = np.linalg.lstsq(space.matrix(grid).toarray(), u**3 * v - 2 * u * v**2 + v**3, rcond=None)[0]

    def density(v, u):
        h = np.array([[a, b], [b, c]])
        f = u**3 * v - 2 * u * v**2 + v**3
        first = np.array([3 * u**2 * v - 2 * v**2, u**3 - 4 * u * v + 3 * v**2])
        mixed = 3 * u**2 - 4 * v
        second = np.array([[6 * u * v, mixed], [mixed, -4 * u + 6 * v]])
        third = np.zeros((2, 2, 2))
        third[0, 0, 0], third[1, 1, 1] = 6 * v, 6.0
        third[0, 0, 1] = third[0, 1, 0] = third[1, 0, 0] = 6 * u
        third[0, 1, 1] = third[1, 0, 1] = third[1, 1, 0] = -4.0
        e = [
            f * f,
            first @ h @ first,
            np.einsum("ij,kl,ik,jl", second, second, h, h),
            np.einsum("ijk,lmn,il,jm,kn", third, third, h, h, h),
        ]
        weights = {2: (1, 2, 1), 3: (1, 3, 3, 1)}[alpha]
        return sum(w * kappa ** (2 * (alpha - m)) * e[m] for m, w in enumerate(weights))

    expected = dblquad(density, 0, 2, 0, 1.5)[0]
    assert net @ band_times(MaternPrecision(space, alpha).band(kappa, stretch), net) == pytest.approx(
        expected, rel=1e-6
    )


@pytest.mark.parametrize("stretch", [(0.0, 0.0), (0.8, 0.5)])
def test_the_precision_is_positive_definite(stretch):
    for alpha in (1, 2, 3, 6):
        assert np.linalg.eigvalsh(dense(MaternPrecision(space_of(), alpha).band(0.5, stretch)))[0] > 0


@pytest.mark.parametrize("alpha", [2, 3, 6])
def test_its_inverse_is_the_matern_covariance(alpha):
    """Whittle's covariance of variance 1 / (4 pi nu kappa^(2 nu)), far from the edges of the space."""
    space, kappa, nu = space_of(10.0, 10.0, 0.25), 1.5, alpha - 1
    at = np.column_stack([5 + np.array([0.0, 0.5, 1.0, 2.0]), np.full(4, 5.0)])
    rows = space.matrix(at).toarray()
    found = rows[0] @ np.linalg.solve(dense(MaternPrecision(space, alpha).band(kappa)), rows.T)
    t = kappa * np.array([1e-9, 0.5, 1.0, 2.0])
    shape = 2 ** (1 - nu) / gamma(nu) * t**nu * kv(nu, t)
    assert found == pytest.approx(shape / (4 * np.pi * nu * kappa ** (2 * nu)), rel=0.05)


@pytest.mark.parametrize("alpha", [1, 2, 3, 6])
def test_the_determinant_and_the_product_with_planes_are_those_of_the_matrix(alpha):
    space, kappa, stretch = space_of(4.0, 3.0), 0.9, (0.2, -0.1)
    precision = MaternPrecision(space, alpha)
    matrix = dense(precision.band(kappa, stretch))
    assert precision.logdet(kappa, stretch) == pytest.approx(np.linalg.slogdet(matrix)[1], rel=1e-9)
    u, v = (bspline.greville(knots, 3) for knots in (space.knots_u, space.knots_v))
    planes = np.stack([np.ones(space.shape), *np.meshgrid(u, v, indexing="ij")], axis=-1).reshape(-1, 3)
    size = np.abs(matrix) @ np.abs(planes)
    np.testing.assert_allclose((precision.times_planes(kappa, stretch) - matrix @ planes) / size, 0, atol=1e-12)


def test_a_form_applied_twice_is_the_product_of_dense_matrices():
    space, kappa, stretch = space_of(3.0, 4.0), 1.1, (-0.2, 0.1)
    form = dense(MaternPrecision(space, 3).band(kappa, stretch))
    at = np.stack(np.meshgrid(np.arange(0.005, 3, 0.01), np.arange(0.005, 4, 0.01), indexing="ij"), axis=-1)
    masses = 1e-4 * space.matrix(at.reshape(-1, 2)).sum(axis=0)
    expected = form @ (form / masses[:, None])
    found = dense(MaternPrecision(space, 6).band(kappa, stretch))
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


def central(function, place, step=1e-5):
    """Return the derivatives of a function of a place by central differences."""
    moved = step * np.eye(len(place))
    return np.array([(function(place + by) - function(place - by)) / (2 * step) for by in moved])


@pytest.mark.parametrize("stretch", [(0.0, 0.0), (1e-5, 0.0), (0.3, -0.2), (-1.0, 0.7)])
def test_slopes_of_the_metric_against_central_differences(stretch):
    expected = central(lambda place: np.array(metric((place[0], place[1]))), np.array(stretch))
    np.testing.assert_allclose(metric_slopes(stretch), expected, atol=1e-8)


@pytest.mark.parametrize("alpha", [1, 2, 3, 6])
def test_slopes_of_traces_and_of_the_determinant_against_central_differences(alpha):
    space, place = space_of(4.0, 3.0), np.array([np.log(0.9), 0.2, -0.1])
    precision = MaternPrecision(space, alpha)
    net = np.random.default_rng(4).normal(size=(*space.shape, 2))

    def trace(place):
        band = precision.band(np.exp(place[0]), (place[1], place[2]))
        return float((net.reshape(-1, 2) * band_times(band, net.reshape(-1, 2))).sum())

    found = precision.trace_slopes(np.exp(place[0]), (place[1], place[2]), dyads(net, precision.reach))
    np.testing.assert_allclose(found, central(trace, place), rtol=1e-5)
    found = precision.logdet_slopes(np.exp(place[0]), (place[1], place[2]))
    expected = central(lambda at: precision.logdet(np.exp(at[0]), (at[1], at[2])), place)
    np.testing.assert_allclose(found, expected, rtol=1e-5)


@pytest.mark.parametrize("alpha", [1, 2, 3, 6])
def test_slopes_of_products_and_solutions_against_the_band(alpha):
    space, place = space_of(4.0, 3.0), np.array([np.log(0.9), 0.2, -0.1])
    precision, net = MaternPrecision(space, alpha), np.random.default_rng(5).normal(size=(space.size, 2))
    at = np.exp(place[0]), (place[1], place[2])
    expected = central(lambda one: band_times(precision.band(np.exp(one[0]), (one[1], one[2])), net[:, 0]), place)
    found = precision.times_slopes(*at, net[:, 0])
    np.testing.assert_allclose(found, expected.T, atol=1e-6 * np.abs(expected).max())
    np.testing.assert_allclose(precision.solve(*at, band_times(precision.band(*at), net)), net, atol=1e-5)

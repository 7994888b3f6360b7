from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import BSpline

from geofit.splines import bspline

# No deadline: the first example pays for imports. Derandomized: the same run every time.
examples = settings(deadline=None, derandomize=True, max_examples=60)


@st.composite
def knot_vectors(draw, degrees=(1, 2, 3, 4), finer=False):
    """A clamped knot vector with inner knots of any multiplicity up to the degree."""
    degree = draw(st.sampled_from(degrees))
    gaps = draw(st.lists(st.floats(0.05, 20), min_size=1, max_size=8))
    start = draw(st.floats(-50, 50))
    breaks = start + np.concatenate([[0.0], np.cumsum(gaps)])
    times = draw(st.lists(st.integers(1, degree), min_size=len(gaps) - 1, max_size=len(gaps) - 1))
    knots = bspline.clamped_knots(breaks, degree, times or 1)
    if not finer:
        return knots, degree
    more = draw(st.lists(st.floats(0.01, 0.99), max_size=6))
    new = breaks[0] + np.array(more) * (breaks[-1] - breaks[0])
    again = draw(st.lists(st.sampled_from(breaks.tolist()), max_size=3))
    fine = np.sort(np.concatenate([knots, new, [x for x in again if breaks[0] < x < breaks[-1]]]))
    values, counts = np.unique(fine, return_counts=True)
    counts[1:-1] = np.minimum(counts[1:-1], degree)
    return knots, np.repeat(values, counts), degree


def places(knots, n=41):
    """Places inside and at the ends; half open spans make a place at a full knot one-sided, as in scipy."""
    return np.linspace(knots[0], knots[-1], n)


def reference(knots, degree, x, derivative=0):
    """scipy's basis functions, one by one."""
    count = len(knots) - degree - 1
    return np.stack([BSpline(knots, row, degree)(x, nu=derivative) for row in np.eye(count)], axis=1)


@examples
@given(knot_vectors(), st.integers(0, 5))
def test_values_and_derivatives_equal_scipy(case, derivative):
    knots, degree = case
    x = places(knots)
    if derivative <= degree:
        wanted = reference(knots, degree, x, derivative)
    else:
        wanted = np.zeros((len(x), len(knots) - degree - 1))
    found = bspline.collocation(knots, degree, x, derivative)
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-11 * max(1.0, np.abs(wanted).max()))


@examples
@given(knot_vectors(degrees=(1, 2, 3, 5)))
def test_the_design_matrix_equals_scipy(case):
    knots, degree = case
    x = places(knots)
    wanted = BSpline.design_matrix(x, knots, degree).toarray()
    np.testing.assert_allclose(bspline.collocation(knots, degree, x), wanted, atol=1e-12)


@examples
@given(knot_vectors())
def test_the_basis_is_a_partition_of_unity_and_not_negative(case):
    knots, degree = case
    first, values = bspline.basis(knots, degree, places(knots))
    np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-13)
    assert values.min() >= -1e-15
    assert first.min() >= 0
    assert first.max() + degree < len(knots) - degree - 1
    for derivative in range(1, degree + 1):
        slopes = bspline.basis(knots, degree, places(knots), derivative)[1]
        np.testing.assert_allclose(slopes.sum(axis=1), 0, atol=1e-12 * np.abs(slopes).max())


@examples
@given(knot_vectors())
def test_greville_abscissae_reproduce_x(case):
    knots, degree = case
    x = places(knots)
    found = bspline.collocation(knots, degree, x) @ bspline.greville(knots, degree)
    np.testing.assert_allclose(found, x, atol=1e-12 * np.abs(knots).max())


def test_outside_the_knots_the_polynomial_goes_on():
    knots = bspline.clamped_knots([0, 1, 2, 4], 3)
    rng = np.random.default_rng(0)
    control = rng.normal(size=len(knots) - 4)
    x = np.array([-0.7, 4.9])
    wanted = BSpline(knots, control, 3, extrapolate=True)(x)
    np.testing.assert_allclose(bspline.collocation(knots, 3, x) @ control, wanted, rtol=1e-12)


def test_the_last_span_holds_its_right_end():
    knots = bspline.clamped_knots([0, 1, 2], 2)
    assert bspline.spans(knots, 2, np.array([0.0, 0.99, 1.0, 2.0])).tolist() == [2, 2, 3, 3]


def test_clamped_knots_repeat_each_inner_break_as_asked():
    assert bspline.clamped_knots([0, 1, 2, 3], 2, [2, 1]).tolist() == [0, 0, 0, 1, 1, 2, 3, 3, 3]


@settings(examples, max_examples=15)
@given(knot_vectors(degrees=(1, 2, 3)), st.integers(0, 3))
def test_the_energy_is_the_integral_of_the_squared_derivative(case, order):
    knots, degree = case
    if order > degree:
        return
    control = np.random.default_rng(len(knots)).normal(size=len(knots) - degree - 1)
    spline = BSpline(knots, control, degree)
    breaks = np.unique(knots)
    # Just inside each span: at a full knot the derivative has two values.
    wanted = sum(
        quad(lambda t: float(spline(t, nu=order)) ** 2, low, high, epsabs=0, epsrel=1e-10)[0]
        for low, high in zip(breaks[:-1], np.nextafter(breaks[1:], -np.inf), strict=True)
    )
    found = control @ bspline.energy_matrix(knots, degree, order) @ control
    assert found == pytest.approx(wanted, rel=1e-9)


def test_the_energy_of_order_m_leaves_polynomials_below_m_free():
    knots = bspline.clamped_knots([0, 1, 3, 4, 7], 3)
    x = np.linspace(0, 7, 50)
    for order in (1, 2, 3):
        energy = bspline.energy_matrix(knots, 3, order)
        assert np.linalg.matrix_rank(energy, tol=1e-9) == len(energy) - order
        for power in range(order):
            control = np.linalg.lstsq(bspline.collocation(knots, 3, x), x**power, rcond=None)[0]
            assert abs(control @ energy @ control) < 1e-13 * np.abs(energy).max() * (control @ control)


@examples
@given(knot_vectors(finer=True))
def test_knot_insertion_keeps_the_curve(case):
    coarse, fine, degree = case
    control = np.random.default_rng(len(fine)).normal(size=len(coarse) - degree - 1)
    finer = bspline.insertion_matrix(coarse, fine, degree) @ control
    x = places(coarse)
    before = bspline.collocation(coarse, degree, x) @ control
    np.testing.assert_allclose(bspline.collocation(fine, degree, x) @ finer, before, atol=1e-11)


@examples
@given(knot_vectors(finer=True))
def test_inserted_control_points_are_averages(case):
    coarse, fine, degree = case
    matrix = bspline.insertion_matrix(coarse, fine, degree)
    assert matrix.min() >= -1e-14
    np.testing.assert_allclose(matrix.sum(axis=1), 1, atol=1e-12)


def test_inserting_nothing_changes_nothing():
    knots = bspline.clamped_knots([0, 1, 2, 5], 3)
    np.testing.assert_array_equal(bspline.insertion_matrix(knots, knots, 3), np.eye(6))


@pytest.mark.parametrize("even", [True, False])
def test_intervals_are_those_of_a_search_however_many_places(even):
    rng = np.random.default_rng(3)
    for count in (2, 3, 30):
        breaks = np.linspace(-1.7, 33.3, count) if even else np.sort(rng.uniform(-5, 90, count))
        ends = np.concatenate([breaks, np.nextafter(breaks, np.inf), np.nextafter(breaks, -np.inf)])
        for x in (ends, np.concatenate([np.tile(ends, 50), rng.uniform(-10, 100, 100_000)])):
            wanted = np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, count - 2)
            np.testing.assert_array_equal(bspline.intervals(breaks, x), wanted)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_diagonals_of_gram_matrices_are_those_of_products_of_the_basis(degree):
    knots = bspline.clamped_knots([0, 0.4, 1.0, 1.3, 2.1, 3.0], degree, [1, 2, 1, 1] if degree > 1 else 1)
    diagonals = bspline.gram_diagonals(knots, degree)
    count = len(knots) - degree - 1
    nodes, weights = np.polynomial.legendre.leggauss(8)
    ends = np.unique(knots)
    x = np.concatenate([(a + b) / 2 + (b - a) / 2 * nodes for a, b in pairwise(ends)])
    w = np.concatenate([(b - a) / 2 * weights for a, b in pairwise(ends)])
    rows = [bspline.collocation(knots, degree, x, order) for order in range(degree + 1)]
    for r in range(degree + 1):
        for s in range(degree + 1):
            gram = np.zeros((count, count))
            for below, diagonal in enumerate(diagonals[r, s], -degree):
                for j in range(max(-below, 0), count - max(below, 0)):
                    gram[j + below, j] = diagonal[j]
            np.testing.assert_allclose(gram, rows[r].T @ (w[:, None] * rows[s]), atol=1e-9)

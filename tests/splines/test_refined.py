"""A space that is finer in one rectangle, against one tensor space that has all of its knots everywhere."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.fitting.assemble import flattened, with_knots
from geofit.splines import bspline
from geofit.splines.refined import RefinedSpace, abscissae, finest, from_abscissae, neighbours, padded
from geofit.splines.tensor import TensorSpace

OUTER = np.array([0.0, 0.8, 2.0, 3.0, 4.1, 5.0, 6.5, 8.0])
#: Rectangles inside the surface, at two of its edges, and all of it.
RECTANGLES = [(2.0, 5.0, 3.0, 6.0), (0.0, 4.1, 3.0, 9.0), (0.0, 8.0, 0.0, 9.0)]


def refined(rectangle, degree=3):
    outer = TensorSpace(bspline.clamped_knots(OUTER, degree), bspline.clamped_knots(np.arange(10.0), degree), degree)
    fine = []
    for breaks, low, high in ((OUTER, *rectangle[:2]), (np.arange(10.0), *rectangle[2:])):
        own = breaks[(breaks >= low) & (breaks <= high)]
        fine.append(bspline.clamped_knots(np.union1d(own, own[:-1] + np.diff(own) / 3), degree))
    return RefinedSpace(outer, TensorSpace(fine[0], fine[1], degree))


def case(rectangle, degree=3, columns=()):
    space = refined(rectangle, degree)
    rng = np.random.default_rng(3)
    return space, rng.normal(size=(space.size, *columns)), rng.uniform((0, 0), (8, 9), (400, 2))


@pytest.mark.parametrize("columns", [(), (3,)])
@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("rectangle", RECTANGLES)
def test_it_is_a_part_of_the_tensor_space_with_all_knots(rectangle, degree, columns):
    space, coefficients, plane = case(rectangle, degree, columns)
    whole, same = flattened(space, coefficients)
    np.testing.assert_allclose(space.matrix(plane) @ coefficients, whole.matrix(plane) @ same, atol=1e-12)
    assert space.size < whole.size or rectangle == RECTANGLES[-1]
    assert space.rectangle == rectangle


@pytest.mark.parametrize("rectangle", RECTANGLES[:2])
def test_beyond_the_rectangle_only_the_coarse_functions_act(rectangle):
    space, _, plane = case(rectangle)
    u0, u1, v0, v1 = rectangle
    beyond = (plane[:, 0] < u0) | (plane[:, 0] > u1) | (plane[:, 1] < v0) | (plane[:, 1] > v1)
    assert space.fine_matrix(plane[beyond]).nnz == 0
    assert (np.diff(space.fine_matrix(plane[~beyond]).indptr) > 0).any()


def test_across_the_edges_the_surface_keeps_two_derivatives():
    space, coefficients, _ = case(RECTANGLES[0])
    step = 1e-3
    for place, way in (((2.0, 4.3), (1, 0)), ((5.0, 4.3), (1, 0)), ((3.3, 3.0), (0, 1)), ((3.3, 6.0), (0, 1))):
        along = np.array(place) + step * np.arange(-3, 4)[:, None] * np.array(way)
        z = space.fine_matrix(along) @ coefficients[space.outer.size :]
        # A function with two derivatives that are zero at the edge grows from there with the cube of the distance.
        assert np.abs(z).max() < 1e3 * (3 * step) ** 3


def test_a_function_acts_in_its_support_alone():
    space, _, plane = case(RECTANGLES[1])
    columns = space.matrix(plane).tocsc()
    for index in range(0, space.size, 7):
        u0, u1, v0, v1 = space.support(index)
        acting = np.zeros(len(plane), bool)
        acting[columns[:, [index]].nonzero()[0]] = True
        inside = (plane[:, 0] > u0) & (plane[:, 0] < u1) & (plane[:, 1] > v0) & (plane[:, 1] < v1)
        np.testing.assert_array_equal(acting, inside)


@pytest.mark.parametrize("rectangle", RECTANGLES)
def test_a_linear_function_is_its_values_at_the_abscissae(rectangle):
    space, _, plane = case(rectangle)
    found = from_abscissae(space, lambda at: 3 + at @ (2.0, -5.0))
    np.testing.assert_allclose(space.matrix(plane) @ found, 3 + plane @ (2.0, -5.0), atol=1e-12)
    of_outer = padded(space, 3 + abscissae(space.outer) @ (2.0, -5.0))
    np.testing.assert_allclose(found, of_outer, atol=1e-12)
    np.testing.assert_array_equal(np.flatnonzero(finest(space)), np.arange(space.outer.size, space.size))


def test_neighbours_stand_next_to_each_other_on_their_own_level():
    space, _, _ = case(RECTANGLES[0])
    some = np.zeros(space.size, bool)
    some[[3 * space.outer.shape[1] + 4, space.outer.size + len(space.inner) // 2]] = True
    found = neighbours(space, some)
    assert found[: space.outer.size].sum() == 9
    assert found[space.outer.size :].sum() == 9
    assert (found & some).sum() == 2


def test_knots_outside_the_rectangle_leave_the_surface_as_it_is():
    space, coefficients, plane = case(RECTANGLES[0])
    more, same = with_knots(space, coefficients, {0.4: 1, 7.0: 1}, {8.5: 1})
    np.testing.assert_allclose(more.matrix(plane) @ same, space.matrix(plane) @ coefficients, atol=1e-12)
    assert more.fine is space.fine

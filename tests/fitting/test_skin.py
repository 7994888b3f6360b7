from __future__ import annotations

import tracemalloc
from itertools import pairwise

import numpy as np
import pytest
from refusals import refused, with_code
from truth import EASTING, NORTHING, paper_arrangement

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.errors import FitError
from geofit.fitting.knots import neighbour_pairs
from geofit.fitting.skin import (
    DAMPING,
    minimum_norm_correction,
    refine_knots,
    regularized_correction,
    ruled,
    section_lines,
)
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace


def space_of(breaks_u=None, breaks_v=None, degree=3):
    u = np.arange(7.0) if breaks_u is None else breaks_u
    v = np.arange(6.0) if breaks_v is None else breaks_v
    return TensorSpace(bspline.clamped_knots(u, degree), bspline.clamped_knots(v, degree), degree)


def spread(n, seed=0):
    """Places no nearer than 0.35 to each other, and what is missing there."""
    rng = np.random.default_rng(seed)
    plane = []
    while len(plane) < n:
        place = rng.uniform((0, 0), (6, 5))
        if all(np.hypot(*(place - p)) > 0.35 for p in plane):
            plane.append(place)
    return np.array(plane), rng.normal(size=n)


@pytest.mark.parametrize("n", [1, 5, 30])
def test_the_least_change_is_exact_and_the_smallest(n):
    space = space_of()
    plane, misfit = spread(n)
    matrix = space.matrix(plane)
    change = minimum_norm_correction(matrix, misfit)
    np.testing.assert_allclose(matrix @ change, misfit, atol=1e-12)
    np.testing.assert_allclose(change, np.linalg.pinv(matrix.toarray()) @ misfit, atol=1e-9)


def test_coordinates_change_column_by_column():
    plane, _ = spread(10)
    matrix = space_of().matrix(plane)
    misfit = np.random.default_rng(1).normal(size=(10, 3))
    change = minimum_norm_correction(matrix, misfit)
    for k in range(3):
        np.testing.assert_allclose(change[:, k], minimum_norm_correction(matrix, misfit[:, k]), atol=1e-12)


def test_frozen_control_points_do_not_move():
    space = space_of()
    plane, misfit = spread(15)
    free = np.random.default_rng(2).uniform(size=space.size) < 0.8
    matrix = space.matrix(plane)
    change = minimum_norm_correction(matrix, misfit, free)
    assert (change[~free] == 0).all()
    np.testing.assert_allclose(matrix @ change, misfit, atol=1e-11)
    wanted = np.linalg.pinv(matrix.toarray()[:, free]) @ misfit
    np.testing.assert_allclose(change[free], wanted, atol=1e-8)
    assert (regularized_correction(matrix, misfit, free)[~free] == 0).all()


@pytest.mark.parametrize("case", ["contradiction", "crowd", "frozen"])
def test_points_that_cannot_all_be_met_are_a_fit_error(case):
    space = space_of()
    plane, misfit, free = np.array([[3.0, 2], [3, 2]]), np.array([0.0, 1.0]), None
    if case == "crowd":
        plane = np.random.default_rng(0).uniform(2, 3, (40, 2))
        misfit = np.random.default_rng(1).normal(size=40)
    elif case == "frozen":
        free = np.zeros(space.size, bool)
    with refused(FitError, "fitting.core-not-interpolable"):
        minimum_norm_correction(space.matrix(plane), misfit, free)


def test_a_damped_change_takes_most_of_a_misfit_and_leaves_contradictions():
    space = space_of()
    plane, misfit = spread(12)
    matrix, free = space.matrix(plane), np.ones(space.size, bool)
    left = misfit - matrix @ regularized_correction(matrix, misfit, free)
    assert np.abs(left).max() < 0.4 * np.abs(misfit).max()
    twice = space.matrix(np.array([[3.0, 2], [3.0001, 2]]))
    change = regularized_correction(twice, np.array([-1.0, 1.0]), free)
    assert np.abs(change).max() < 0.1


@pytest.mark.parametrize("count", [20, 2000])
def test_few_points_and_many_are_damped_alike(count):
    space, rng = space_of(), np.random.default_rng(3)
    plane = rng.uniform((0, 0), (6, 5), (count, 2))
    misfit, free = rng.normal(size=(len(plane), 2)), rng.uniform(size=space.size) < 0.8
    matrix = space.matrix(plane)
    dense = matrix.toarray() * free
    damping = DAMPING * (matrix.toarray() ** 2).sum(axis=1).max()
    wanted = dense.T @ np.linalg.solve(dense @ dense.T + damping * np.eye(len(plane)), misfit)
    np.testing.assert_allclose(regularized_correction(matrix, misfit, free), wanted, atol=1e-8)


def test_nothing_is_corrected_where_no_control_point_is_free():
    space = space_of()
    plane, misfit = spread(5)
    assert not regularized_correction(space.matrix(plane), misfit, np.zeros(space.size, bool)).any()


def test_memory_does_not_grow_with_the_square_of_points_in_a_crowd():
    space, rng = space_of(), np.random.default_rng(4)
    matrix = space.matrix(rng.uniform(2, 3, (20_000, 2)))
    tracemalloc.start()
    regularized_correction(matrix, rng.normal(size=20_000), np.ones(space.size, bool))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50e6


def change_between(breaks_u, breaks_v, plane, misfit):
    return np.abs(np.linalg.pinv(space_of(breaks_u, breaks_v).matrix(plane).toarray(), rcond=1e-13) @ misfit).max()


def test_separate_lowers_the_strain_of_close_neighbours():
    plane, misfit = spread(20)
    plane = np.concatenate([plane, plane[:1] + np.array((0.0, 0.02))])
    misfit = np.append(misfit, misfit[0] + 1.0)
    u, v = np.arange(7.0), np.arange(6.0)
    found = refine_knots(u, v, plane, neighbour_pairs(plane), misfit, space_of, lambda shape: True, 20, 1.0)
    new_u, new_v = found.breaks
    assert found.strain <= 1
    assert np.isin(u, new_u).all()
    assert np.isin(v, new_v).all()
    assert len(new_v) > len(v)
    before, after = change_between(u, v, plane, misfit), change_between(new_u, new_v, plane, misfit)
    assert after < 0.3 * before


def test_separate_leaves_calm_knots_and_minds_the_cap():
    plane, misfit = spread(8)
    u, v = np.arange(7.0), np.arange(6.0)
    calm = refine_knots(u, v, plane, neighbour_pairs(plane), misfit, space_of, lambda shape: True, 20, 1.0).breaks
    np.testing.assert_array_equal(calm[0], u)
    np.testing.assert_array_equal(calm[1], v)
    plane = np.concatenate([plane, plane[:1] + np.array((0.0, 0.001))])
    misfit = np.append(misfit, misfit[0] + 1.0)
    for most in (60, 100, 150):
        new_u, new_v = refine_knots(
            u,
            v,
            plane,
            neighbour_pairs(plane),
            misfit,
            space_of,
            lambda shape, most=most: shape[0] * shape[1] <= most,
            50,
            1.0,
        ).breaks
        assert space_of(new_u, new_v).size <= max(most, space_of(u, v).size)


def test_where_the_cap_allows_few_knots_they_go_to_the_tightest_pair():
    plane, misfit = spread(20)
    close = plane[[0, 0, 7]] + np.array([(0.0, 0.01), (0.0, 0.02), (0.3, 0.0)])
    plane, misfit = np.concatenate([plane, close]), np.append(misfit, misfit[[0, 0, 7]] + (1.0, -1.0, 0.5))
    u, v = np.arange(7.0), np.arange(6.0)
    pairs = neighbour_pairs(plane)
    most = space_of(u, v).shape[0] * (space_of(u, v).shape[1] + 1)
    free = refine_knots(u, v, plane, pairs, misfit, space_of, lambda shape: True, 1, 1.0).breaks
    capped = refine_knots(
        u, v, plane, pairs, misfit, space_of, lambda shape: shape[0] * shape[1] <= most, 1, 1.0
    ).breaks
    assert len(free[0]) + len(free[1]) > len(u) + len(v) + 1, "without a cap more would be laid"
    (added,) = np.setdiff1d(capped[1], v)
    assert abs(added - plane[0, 1]) < 0.03
    np.testing.assert_array_equal(capped[0], u)


def test_neighbours_too_steep_for_relief_get_one_break_and_others_as_many_as_they_need():
    plane, misfit = spread(20)
    plane = np.concatenate([plane, plane[:1] + np.array((0.0, 1e-4))])
    misfit = np.append(misfit, misfit[0] + 1.0)
    u, v = np.arange(7.0), np.arange(6.0)
    pairs = neighbour_pairs(plane)
    close = {}
    for unit in (1.0, 1e6):
        found = refine_knots(u, v, plane, pairs, misfit, space_of, lambda shape: True, 50, unit).breaks[1]
        close[unit] = np.abs(np.setdiff1d(found, v) - plane[0, 1]) < 0.01
    assert close[1.0].sum() == 1
    assert close[1e6].sum() > 1


def test_ruled_reproduces_a_ruled_surface():
    """Section curves at lines of full multiplicity; between them the surface is straight."""
    lines, p = np.array([0.0, 1.0, 2.5, 4.0]), 3
    knots_u = bspline.clamped_knots(lines, p, p)
    space = TensorSpace(knots_u, bspline.clamped_knots(np.arange(6.0), p), p)
    curves = np.random.default_rng(0).normal(size=(len(lines), space.shape[1]))
    spread_matrix = ruled(space, lines, np.arange(space.shape[0]))
    net = spread_matrix @ curves.ravel()
    u, v = np.random.default_rng(1).uniform((0, 0), (4, 5), (300, 2)).T
    basis = bspline.collocation(space.knots_v, p, v)
    wanted = np.array([np.interp(a, lines, curves @ b) for a, b in zip(u, basis, strict=True)])
    np.testing.assert_allclose(space.matrix(np.column_stack([u, v])) @ net, wanted, atol=1e-12)


@pytest.mark.parametrize("seam", ["tangent", "position"])
def test_a_core_linear_across_is_straight_between_its_sections(seam):
    truth = paper_arrangement(2)
    surface = fit_horizon(truth.points, FitSettings(across="linear", seam=seam), truth.boundary)
    core = next(patch for patch in surface.patches if patch.name == "core")
    assert core.degree[0] == 1
    sections = truth.points.xyz[truth.points.section != "", 0] - surface.origin[0]
    lines = np.unique(core.knots_u)
    assert np.abs(sections[:, None] - lines).min(axis=1).max() < 1e-6
    v = np.linspace(*core.domain[2:], 50)
    for low, high in pairwise(lines):
        u = np.linspace(low, high, 7)
        xyz = core.evaluate(u[:, None], v[None, :])
        assert np.abs(np.diff(xyz, 2, axis=0)).max() < 1e-8
    np.testing.assert_allclose(np.abs(surface.accuracy.residuals[surface.core]), 0, atol=1e-6)


def test_a_core_cubic_across_is_nearer_to_a_gentle_horizon():
    truth = paper_arrangement(3)
    at = truth.places(3000, core=True)
    error = {}
    for across in ("cubic", "linear"):
        surface = fit_horizon(truth.points, FitSettings(across=across), truth.boundary)
        error[across] = np.sqrt(np.mean((surface.elevation(*at.T) - truth.height(*at.T)) ** 2))
    assert error["cubic"] < 0.7 * error["linear"]


def test_linear_without_sections_is_cubic_and_told():
    rng = np.random.default_rng(0)
    plan = rng.uniform(0, 500, (60, 2)) + np.array((EASTING, NORTHING))
    points = PointSet(np.column_stack([plan, 500 + 0.1 * (plan[:, 0] - EASTING)]))
    surface = fit_horizon(points, FitSettings(across="linear", core="all"))
    assert surface.patches[0].degree == (3, 3)
    assert with_code(surface.accuracy.notes, "fitting.ruled-core-without-sections").severity == "warning"


def test_section_lines_are_the_mean_u_of_straight_sections():
    v = np.linspace(0, 10, 8)
    plane = np.concatenate([np.column_stack([np.full(8, u), v]) for u in (4.0, 1.0, 2.0)])
    lines = section_lines(plane, np.repeat(["C", "A", "B"], 8), 0.5)
    assert lines.straight
    np.testing.assert_allclose(lines.u, [1, 2, 4])


def test_many_sections_are_as_many_lines_and_those_that_coincide_are_one():
    u = np.append(np.linspace(0, 27, 60), [9.0, 9.01])
    plane = np.column_stack([np.repeat(u, 4), np.tile(np.linspace(0, 10, 4), len(u))])
    lines = section_lines(plane, np.repeat([f"S{k:02d}" for k in range(len(u))], 4), 13.5)
    assert lines.straight
    assert len(lines.u) == 60


def test_forty_five_sections_are_met():
    rng = np.random.default_rng(45)
    x = np.repeat(np.linspace(0, 1600, 45), 12)
    y = np.sort(rng.uniform(0, 1000, (45, 12)), axis=1).ravel()
    z = 500 + 20 * np.sin(x / 150) * np.cos(y / 130)
    names = np.repeat([f"S{k:02d}" for k in range(45)], 12)
    points = PointSet(np.column_stack([x + EASTING, y + NORTHING, z]), section=names, kind="section")
    surface = fit_horizon(points, FitSettings(core="all"))
    assert np.abs(surface.distance(points.xyz)).max() < 1e-6
    between = rng.uniform((20, 50), (1580, 950), (2000, 2))
    truth = 500 + 20 * np.sin(between[:, 0] / 150) * np.cos(between[:, 1] / 130)
    found = surface.elevation(between[:, 0] + EASTING, between[:, 1] + NORTHING)
    assert np.sqrt(np.mean((found - truth) ** 2)) < 0.3


def test_a_section_that_strays_gets_no_line():
    v = np.linspace(0, 10, 8)
    plane = np.concatenate(
        [np.column_stack([np.full(8, u), v]) for u in (1.0, 2.0)] + [np.column_stack([4 + np.sin(v), v])]
    )
    lines = section_lines(plane, np.repeat(["A", "B", "C"], 8), 0.5)
    np.testing.assert_allclose(lines.u, [1, 2])


@pytest.mark.parametrize("names", [[""] * 16, ["A"] * 16])
def test_fewer_than_two_sections_are_no_lines(names):
    plane = np.column_stack([np.repeat([1.0, 1.0], 8), np.tile(np.linspace(0, 10, 8), 2)])
    lines = section_lines(plane, np.array(names), 0.5)
    assert not lines.straight
    assert len(lines.u) == 0


def test_sections_through_one_place_are_no_lines_beside_each_other():
    plane = np.concatenate([np.outer(np.linspace(-1, 1, 8), [np.sin(a), np.cos(a)]) for a in (0.02, 0.3, 0.01)])
    lines = section_lines(plane, np.repeat(["A", "B", "C"], 8), 1.0)
    assert not lines.straight
    assert len(lines.u) <= 1

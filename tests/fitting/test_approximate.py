from __future__ import annotations

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from geofit.fitting.approximate import approximate, fixed_by_core, solved_beside
from geofit.splines import bspline
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace

CORE = (3.0, 5.0, 2.0, 6.0)


@pytest.fixture(autouse=True)
def _one_thread():
    """As fit_horizon does: on small banded systems threads wait for each other."""
    with threadpool_limits(limits=1):
        yield


def space_of(spans_u=8, spans_v=8):
    return TensorSpace(
        bspline.clamped_knots(np.linspace(0, 8, spans_u + 1), 3),
        bspline.clamped_knots(np.linspace(0, 8, spans_v + 1), 3),
    )


def wave(plane):
    return 5 * np.sin(plane[:, 0] / 2) * np.cos(plane[:, 1] / 3)


def scattered(n, seed=0):
    plane = np.random.default_rng(seed).uniform(0, 8, (n, 2))
    return plane[~((plane >= (3, 2)) & (plane <= (5, 6))).all(axis=1)]


def run(space, plane, height, tolerance=0.05, rounds=20, core=CORE, start=None, smoothing=1e-3):
    frozen = fixed_by_core(space, core).ravel() if core else np.zeros(space.size, bool)
    start = np.random.default_rng(5).normal(size=(space.size, *height.shape[1:])) if start is None else start
    energy = smoothing * MaternPrecision(space, 3).band(0.5)
    beside = solved_beside(space, energy, start, frozen, plane, height, np.ones(len(plane)))
    return approximate(space, beside, frozen, plane, height, tolerance, tolerance, rounds), start, frozen


def test_borrowed_control_points_are_those_that_act_in_the_core():
    space = space_of()
    inside = np.stack(np.meshgrid(np.linspace(3.001, 4.999, 60), np.linspace(2.001, 5.999, 60)), axis=-1).reshape(-1, 2)
    acting = (np.abs(space.matrix(inside).toarray()).max(axis=0) > 0).reshape(space.shape)
    np.testing.assert_array_equal(fixed_by_core(space, CORE), acting)


def test_a_full_knot_at_the_seam_lends_the_edge_row_alone():
    knots = bspline.clamped_knots(np.arange(9.0), 3, [1, 1, 3, 1, 3, 1, 1])
    space = TensorSpace(knots, bspline.clamped_knots(np.arange(9.0), 3))
    rows = np.flatnonzero(fixed_by_core(space, (3.0, 5.0, 0.0, 8.0)).any(axis=1))
    greville = bspline.greville(space.knots_u, 3)[rows]
    assert greville[0] == pytest.approx(3)
    assert greville[-1] == pytest.approx(5)


@pytest.mark.parametrize("columns", [None, 3])
def test_borrowed_control_points_stay_bit_for_bit(columns):
    space, plane = space_of(), scattered(80)
    height = wave(plane) if columns is None else np.column_stack([plane, wave(plane)])
    result, start, frozen = run(space, plane, height)
    assert frozen.any()
    assert not frozen.all()
    np.testing.assert_array_equal(result.coefficients[frozen], start[frozen])
    assert (result.coefficients[~frozen] != start[~frozen]).any()


@pytest.mark.parametrize("core", [None, CORE])
def test_every_point_comes_within_a_tolerance_that_can_be_held(core):
    space, plane = space_of(16, 16), scattered(60, seed=1)
    # The core fixes nothing more than three spans away; nearer to it, some points may be out of reach.
    plane = plane[~((plane > (1.5, 0.5)) & (plane < (6.5, 7.5))).all(axis=1)]
    grid = np.stack(np.meshgrid(np.linspace(0, 8, 40), np.linspace(0, 8, 40)), axis=-1).reshape(-1, 2)
    start = np.linalg.lstsq(space.matrix(grid).toarray(), wave(grid), rcond=None)[0]
    height = wave(plane) + np.random.default_rng(2).normal(0, 0.3, len(plane))
    result, _, _ = run(space, plane, height, core=core, start=start, smoothing=1.0)
    assert result.rounds > 0
    assert result.misfit.max() <= 0.05
    np.testing.assert_allclose(result.misfit, np.abs(height - space.matrix(plane) @ result.coefficients), atol=1e-12)


def test_points_within_the_tolerance_are_not_pulled():
    space, plane = space_of(), scattered(60)
    result, _, _ = run(space, plane, 3 + 2 * plane[:, 0], core=None)
    assert result.rounds == 0
    # The hold on the (here senseless) start is weak, not nothing.
    assert result.misfit.max() < 0.05


def test_without_rounds_points_outside_the_tolerance_stay_there():
    space, plane = space_of(), scattered(60)
    height = wave(plane) + np.random.default_rng(2).normal(0, 1, len(plane))
    result, _, _ = run(space, plane, height, rounds=0, smoothing=10.0)
    assert result.rounds == 0
    assert result.misfit.max() > 0.05


def test_a_contradiction_is_left_and_throws_nothing_off():
    space, plane = space_of(), scattered(60)
    plane = np.concatenate([plane, [[1.0, 1.0], [1.0001, 1.0]]])
    height = wave(plane)
    height[-1] += 3.0
    result, _, _ = run(space, plane, height, core=None)
    assert result.misfit[-2:].max() > 1.0
    assert result.misfit[-2:].sum() == pytest.approx(3.0, abs=0.1)
    assert np.abs(result.coefficients).max() < 30


def test_the_interpolated_truth_is_near_between_the_points():
    space, plane = space_of(), scattered(200)
    result, _, _ = run(space, plane, wave(plane), core=None, smoothing=1e-6)
    at = np.random.default_rng(8).uniform(0.5, 7.5, (500, 2))
    at = at[~((at >= (2.5, 1.5)) & (at <= (5.5, 6.5))).all(axis=1)]
    assert np.abs(space.matrix(at) @ result.coefficients - wave(at)).max() < 0.2


def test_neighbours_that_contradict_each_other_are_let_go_unless_every_point_is_to_be_met():
    space = space_of()
    plane = np.array([[1.5, 1.5], [1.6, 1.55], [6.5, 6.5]])
    height, frozen = np.array([4.0, -4.0, 2.0]), np.zeros(space.size, bool)
    found = {
        strict: approximate(space, np.zeros(space.size), frozen, plane, height, 0.05, 0.05, 200, strict)
        for strict in (False, True)
    }
    assert found[False].released.tolist() == [True, True, False]
    assert found[False].misfit == pytest.approx([4, 4, 0.0], abs=0.05)
    assert np.abs(found[False].coefficients).max() < 10
    assert not found[True].released.any()
    assert found[True].misfit.max() < 3
    assert np.abs(found[True].coefficients).max() > 20

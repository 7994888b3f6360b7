"""Which data contradict each other: those whose nearest points do, not holes far apart over rough ground."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.fitting.contradiction import contradict, near_noise, neighbours_within, off_neighbours, torn_points

N = 120
UNSTATED = np.full(N, np.nan)


def places(seed, side):
    return np.random.default_rng(seed).uniform(0, side, (N, 2))


def scatter(seed):
    return np.random.default_rng(100 + seed).normal(0, 3.0, N)


@pytest.mark.parametrize("seed", range(5))
def test_scatter_is_a_contradiction_where_a_surface_through_it_would_be_steep(seed):
    assert contradict(places(seed, 40.0), scatter(seed), 3.0, UNSTATED)
    assert not contradict(places(seed, 2000.0), scatter(seed), 3.0, UNSTATED)


def test_relief_that_near_points_share_is_no_contradiction():
    plane = places(0, 40.0)
    steep = 20.0 * np.sin(plane[:, 0] / 4.0)
    assert near_noise(plane, steep) < 0.5 * steep.std()
    assert not contradict(plane, steep, float(steep.std()), UNSTATED)


def test_accuracies_that_most_points_state_decide():
    plane, misfit = places(1, 40.0), scatter(1)
    accurate = np.where(np.arange(N) < 70, 0.05, np.nan)
    assert not contradict(plane, misfit, 3.0, accurate)
    assert contradict(plane, misfit, 3.0, np.where(np.arange(N) < 50, 0.05, np.nan))
    assert contradict(plane, misfit, 3.0, np.full(N, 2.0))


@pytest.mark.parametrize("columns", [(), (3,)])
def test_points_at_one_place_contradict_each_other(columns):
    misfit = np.random.default_rng(0).normal(0, 3.0, (N, *columns))
    assert contradict(np.zeros((N, 2)), misfit, 3.0, UNSTATED)


PAIRS = np.array([[0, 1], [1, 2], [2, 3]])
LINE = np.column_stack([10.0 * np.arange(4), np.zeros(4)])


def test_of_two_that_ask_for_a_cliff_the_more_doubtful_one_is_let_go():
    misfit = np.array([0.0, 2.0, 30.0, 1.0])
    loose = np.ones(4, bool)
    assert torn_points(LINE, misfit, PAIRS, loose, 1.0, lambda: misfit).tolist() == [False, False, True, False]
    assert not torn_points(LINE, misfit, PAIRS, loose, 3.0, lambda: misfit).any()
    assert not torn_points(LINE, misfit, PAIRS, loose, 1.0, lambda: misfit, 15.0).any(), "a miss of 15 m is excused"
    three = np.repeat(misfit[:, None], 3, axis=1)
    assert torn_points(LINE, three, PAIRS, loose, 1.0, lambda: misfit).tolist() == [False, False, True, False]


def test_who_is_doubtful_is_asked_only_where_two_ask_for_a_cliff():
    misfit, asked = np.array([0.0, 2.0, 30.0, 1.0]), []

    def doubt():
        asked.append(True)
        return misfit

    torn_points(LINE, misfit, PAIRS, np.ones(4, bool), 3.0, doubt)
    assert not asked
    torn_points(LINE, misfit, PAIRS, np.ones(4, bool), 1.0, doubt)
    assert asked


def test_only_loose_points_are_let_go():
    misfit = np.array([0.0, 2.0, 30.0, 1.0])
    loose = np.array([True, True, False, True])
    torn = torn_points(LINE, misfit, PAIRS, loose, 1.0, lambda: misfit)
    assert torn.tolist() == [False, True, False, True]


@pytest.mark.parametrize("columns", [1, 3])
def test_off_neighbours_leaves_the_nearest_out(columns):
    plane = places(3, 500.0)
    twin = np.vstack([plane, plane[5] + (0.3, 0.2)])
    value = twin @ np.array([0.2, -0.1])
    value[N] += 40.0
    off = off_neighbours(twin, np.repeat(value[:, None], columns, axis=1))
    assert off[N] == pytest.approx(40.0 * np.sqrt(columns), rel=1e-3)
    assert off[5] < 0.5


@pytest.mark.parametrize("n", [2, 3, 5])
def test_few_points_and_points_in_line_have_a_doubt(n):
    plane = np.column_stack([10.0 * np.arange(n), np.zeros(n)])
    assert np.isfinite(off_neighbours(plane, np.arange(n, dtype=float))).all()


def test_neighbours_within_reach_are_each_pair_once():
    plane = places(6, 100.0)
    apart = np.linalg.norm(plane[:, None] - plane, axis=2)
    expected = np.argwhere(np.triu(apart < 8.0, 1))
    assert neighbours_within(plane, 8.0).tolist() == expected.tolist()
    assert neighbours_within(plane, 0.0).shape == (0, 2)
    assert len(neighbours_within(np.random.default_rng(0).uniform(0, 1, (5_000, 2)), 10.0)) < 8 * 5_000

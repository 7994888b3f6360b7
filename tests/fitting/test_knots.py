from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geofit.fitting.knots import graded_breaks, neighbour_pairs, pair_sizes, some_breaks

NONE = np.empty((0, 3))


@st.composite
def requests(draw):
    """Required breaks and places of finer spans, as a core's points ask for them."""
    length = draw(st.floats(1, 50))
    inner = draw(st.lists(st.floats(0.02, 0.98), max_size=5))
    required = np.array([0, *(length * x for x in inner), length])
    largest = draw(st.floats(0.3, 3))
    sizes = []
    for _ in range(draw(st.integers(0, 5))):
        low = draw(st.floats(0, 0.9)) * length
        size = draw(st.floats(0.02, 1)) * largest
        sizes.append((low, min(low + draw(st.floats(0.5, 3)) * size, length), size))
    return required, largest, np.array(sizes).reshape(-1, 3)


@settings(deadline=None, derandomize=True, max_examples=80)
@given(requests())
def test_required_breaks_stand_and_spans_obey_the_sizes(request):
    required, largest, sizes = request
    breaks = graded_breaks(required, largest, sizes)
    assert (np.diff(breaks) > 0).all()
    assert np.isin(required, breaks).all()
    assert breaks[0] == required.min()
    assert breaks[-1] == required.max()
    spans = np.diff(breaks)
    assert spans.max() <= largest * (1 + 1e-6)
    for low, high, size in sizes:
        inside = (breaks[:-1] >= low) & (breaks[1:] <= high)
        # The size is known on 4,000 samples.
        assert spans[inside].max(initial=0) <= size * 1.02 + 2 * np.ptp(required) / 4000


@settings(deadline=None, derandomize=True, max_examples=60)
@given(requests())
def test_spans_grow_gradually(request):
    required, largest, sizes = request
    breaks = graded_breaks([0, required[-1]], largest, sizes)
    spans = np.diff(breaks)
    ratio = spans[1:] / spans[:-1]
    if len(ratio):
        # A size that grows by half a metre a metre gives spans that grow by exp(1/2) at most.
        assert np.maximum(ratio, 1 / ratio).max() <= np.exp(0.5) * 1.05


def test_without_wishes_the_spans_are_even():
    np.testing.assert_allclose(graded_breaks([0, 10], 3.0, NONE), [0, 2.5, 5, 7.5, 10], atol=1e-9)


def test_a_span_that_fits_is_not_halved():
    np.testing.assert_allclose(graded_breaks([0, 4, 10], 2.0, NONE), np.arange(0, 11, 2), atol=1e-9)


def test_neighbours_of_a_grid_are_beside_each_other():
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij"), axis=-1).reshape(-1, 2)
    pairs = neighbour_pairs(grid)
    gap = np.linalg.norm(grid[pairs[:, 0]] - grid[pairs[:, 1]], axis=1)
    assert gap.max() <= np.sqrt(2) + 1e-9
    assert (gap < 1.01).sum() == 3 * 3 + 4 * 2
    assert len(np.unique(pairs, axis=0)) == len(pairs)
    assert (pairs[:, 0] < pairs[:, 1]).all()


@pytest.mark.parametrize("n", [2, 3, 10])
def test_collinear_points_have_the_next_as_neighbour(n):
    t = np.random.default_rng(0).permutation(np.linspace(0, 9, n))
    pairs = neighbour_pairs(np.column_stack([t, 2 * t]))
    assert len(pairs) == n - 1
    np.testing.assert_allclose(np.abs(t[pairs[:, 0]] - t[pairs[:, 1]]), 9 / (n - 1))


def test_a_pair_speaks_for_the_direction_in_which_it_is_farther_apart():
    plane = np.array([[0.0, 0], [0.5, 2], [10, 1]])
    pairs = np.array([[0, 1], [0, 2]])
    np.testing.assert_allclose(pair_sizes(plane, pairs, 0, 2.0), [[0, 10, 20]])
    np.testing.assert_allclose(pair_sizes(plane, pairs, 1, 2.0), [[0, 2, 4]])


@given(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=40), st.floats(0.05, 0.8))
@settings(max_examples=60, deadline=None)
def test_some_breaks_are_as_few_as_leave_no_longer_span_than_there_was(spans, least):
    breaks = np.concatenate([[0.0], np.cumsum(spans)])
    some = some_breaks(breaks, least)
    assert set(some) <= set(breaks)
    assert some[0] == breaks[0]
    assert some[-1] == breaks[-1]
    assert np.diff(some).max() <= max(least, np.diff(breaks).max()) + 1e-12
    assert (some[2:] - some[:-2] > least).all()

"""Memory of a fit from arrays: at most twice that of the coordinates, whatever the number of points."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from truth import EASTING, NORTHING, hills

from geofit import FitSettings, PointSet, fit_horizon
from geofit.checks import check
from geofit.data import long_arrays
from geofit.data.labels import Labels
from geofit.fitting import conflicts
from geofit.fitting.conflicts import near_pairs

FEW, MANY = 400_000, 1_400_000


@pytest.fixture
def small_blocks(monkeypatch):
    """Make blocks as short, against the number of points, as they are for 1e7 points."""
    monkeypatch.setattr(long_arrays, "BLOCK", 1 << 16)
    monkeypatch.setattr("geofit.fitting.field.BLOCK", 1 << 16)
    monkeypatch.setattr(conflicts, "SLAB", 1 << 16)
    monkeypatch.setattr(check, "STEP", 1 << 15)


def taken(n: int, settings: FitSettings) -> int:
    """Return the bytes that a fit of n points takes at its peak, those of the points not counted."""
    rng, height = np.random.default_rng(3), hills(3)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + 2000, NORTHING + 1500), (n, 2))
    points = PointSet(np.column_stack([xy, height(*xy.T) + rng.normal(0, 0.05, n)]))
    tracemalloc.start()
    try:
        fit = fit_horizon(points, settings)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert fit.accuracy.conflicts
    assert fit.accuracy.passed
    return peak


@pytest.mark.parametrize("core", ["none", "auto"])
def test_a_point_takes_at_most_twice_the_memory_of_its_coordinates(small_blocks, core):
    settings = FitSettings(core=core, max_control_points=300)
    # The cells of the field and the lattices of the checks do not grow with the points.
    assert taken(MANY, settings) - taken(FEW, settings) <= 2 * 24 * (MANY - FEW)


def test_one_word_for_all_points_stays_one_when_some_are_picked():
    n = 1_000_000
    labels, some = Labels.same("T2", n), np.arange(n) != 7
    tracemalloc.start()
    try:
        picked = labels[some], labels[5:-5]
        held = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    assert held < n / 100
    assert [len(part) for part in picked] == [n - 1, n - 10]
    assert {word for part in picked for word in part.words()[:10].tolist()} == {"T2"}


@pytest.mark.parametrize("seed", range(4))
def test_pairs_are_the_same_slab_by_slab(monkeypatch, seed):
    rng = np.random.default_rng(seed)
    place = rng.uniform(0, (3000.0, 700.0), (40_000, 2))
    place[:200] = place[200:400] + rng.normal(0, 0.3, (200, 2))
    whole = near_pairs(place, 1.0)
    monkeypatch.setattr(conflicts, "SLAB", 1_000)
    found = near_pairs(place, 1.0)
    assert len(found) > 200
    assert np.array_equal(found, np.unique(whole, axis=0))


def test_every_so_many_rows_of_a_long_array_take_no_more_than_themselves():
    block = long_arrays.BLOCK
    rows = long_arrays.LongArray((40 * block,), lambda start, stop: np.arange(start, stop, dtype=float))
    tracemalloc.start()
    try:
        found = rows[3 : 39 * block : 1000]
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert np.array_equal(found, np.arange(3, 39 * block, 1000))
    # Views of the blocks would keep all forty of them.
    assert peak < 4 * 8 * block

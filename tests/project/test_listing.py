"""All points of a horizon with what the surface says of them, excluded rows too."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.points import PointSet
from geofit.fitting.pipeline import fit_horizon
from geofit.project.listing import listing
from geofit.project.provenance import Row, find_rows, matched, turns, without_rows


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(4)
    xy = rng.uniform(0, 400, (60, 2))
    z = 100 + 0.1 * xy[:, 0] + 5 * np.sin(xy[:, 1] / 90)
    # Lines of two files; each tenth line gave two points.
    row = np.arange(60) // 2 * 2 + 2
    row[::10] += 1000
    return PointSet(np.column_stack([xy, z]), row=row, file=np.where(np.arange(60) < 30, "a.csv", "b.csv"))


def test_turns_are_those_of_rows(points):
    assert turns(points).tolist() == [Row.of(points, i).turn for i in range(len(points))]


def test_rows_are_found_where_they_are(points):
    rows = [Row.of(points, i) for i in (3, 17, 44)]
    assert find_rows(points, rows).tolist() == [3, 17, 44]
    assert find_rows(points, [Row("c.csv", 2), *rows[:1]]).tolist() == [3]


@pytest.mark.parametrize("seed", range(4))
def test_what_was_left_out_leaves_the_others_in_their_places(points, seed):
    out = np.sort(np.random.default_rng(seed).choice(60, 9, replace=False))
    rest = without_rows(points, [Row.of(points, i) for i in out])
    assert matched(rest, points).tolist() == np.delete(np.arange(60), out).tolist()


def test_excluded_points_keep_their_places_and_show_what_the_surface_misses(points):
    rows = [Row.of(points, i) for i in (3, 17)]
    surface = fit_horizon(without_rows(points, rows))
    found = listing(points, frozenset(rows), surface)
    assert np.flatnonzero(found.excluded).tolist() == [3, 17]
    assert found.place[[3, 17]].tolist() == [-1, -1]
    np.testing.assert_allclose(found.residual[[3, 17]], surface.distance(points.xyz[[3, 17]]))
    kept = ~found.excluded
    np.testing.assert_array_equal(found.residual[kept], surface.accuracy.residuals)
    assert found.rows([17]) == (rows[1],)
    assert found.index(rows[1]) == 17


def test_a_surface_of_other_data_is_listed_by_its_own_points(points):
    surface = fit_horizon(points.with_(xyz=points.xyz + 0.5))
    assert listing(points, frozenset(), surface).points is surface.points

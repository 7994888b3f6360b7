from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from refusals import refused, with_code
from scipy.spatial import KDTree
from scipy.spatial.distance import pdist

from geofit import BodyData, PointSet, fit_body, fit_horizon
from geofit.data.errors import FitError
from geofit.fitting.conflicts import near_pairs, resolve_conflicts


def settled(xyz, distance=0.01, **columns):
    points = PointSet(np.asarray(xyz, float), **columns)
    return resolve_conflicts(points, points.xyz[:, :2], points.xyz[:, 2], distance)


def test_points_apart_are_all_kept():
    kept, conflicts = settled([[0, 0, 1], [0.02, 0, 2], [5, 5, 3]])
    assert kept.all()
    assert conflicts == ()


def test_a_duplicate_gives_way_to_the_first_and_is_listed():
    kept, conflicts = settled([[0, 0, 1], [5, 5, 3], [0, 0, 1]], row=[2, 3, 4], hole=["B1", "B2", "B3"])
    assert kept.tolist() == [True, True, False]
    assert len(conflicts) == 1
    assert (conflicts[0].kept, conflicts[0].dropped, conflicts[0].difference) == (0, 2, 0.0)
    assert conflicts[0].text.code == "fitting.conflict-repeated"
    assert str(conflicts[0].text) == "point B3, row 4 repeats point B1, row 2"


def test_accuracy_settles_before_the_kind_of_source():
    xyz = [[0, 0, 100.0], [0, 0, 103.0]]
    kept, conflicts = settled(xyz, kind=["borehole", "section"], accuracy=[1.0, 0.2])
    assert kept.tolist() == [False, True]
    assert conflicts[0].difference == -3.0
    assert conflicts[0].text.code == "fitting.conflict-of-elevation"
    assert conflicts[0].text.severity == "warning"
    assert conflicts[0].text.params["difference"] == -3.0
    assert conflicts[0].text.params["reason"].code == "fitting.conflict-kept-by-accuracy"


def test_a_stated_accuracy_goes_before_none():
    kept, _ = settled([[0, 0, 1], [0, 0, 2]], kind=["borehole", "section"], accuracy=[np.nan, 5.0])
    assert kept.tolist() == [False, True]


@pytest.mark.parametrize(
    ("better", "worse"),
    [
        ("borehole", "section"),
        ("borehole", "adit"),
        ("adit", "outcrop"),
        ("outcrop", "map"),
        ("map", "section"),
        ("section", "geophysics"),
        ("borehole", "a word nobody knows"),
        ("a word nobody knows", "geophysics"),
    ],
)
def test_the_source_nearer_to_the_rock_is_kept_where_no_accuracy_settles_it(better, worse):
    for accuracy in (np.nan, 0.3):
        for kinds in ([better, worse], [worse, better]):
            kept, conflicts = settled([[0, 0, 1], [0, 0, 2]], kind=kinds, accuracy=accuracy)
            assert kept.tolist() == [kind == better for kind in kinds]
            assert len(conflicts) == 1


def test_the_reason_is_the_one_that_settled_it():
    _, conflicts = settled([[0, 0, 1], [0, 0, 2]], kind=["borehole", "section"], accuracy=0.3)
    assert conflicts[0].text.params["reason"].code == "fitting.conflict-kept-by-source"


def test_the_first_of_equals_is_kept():
    kept, _ = settled([[0, 0, 1], [0, 0, 2], [0, 0, 3]])
    assert kept.tolist() == [True, False, False]


def test_in_a_chain_the_middle_gives_way_only_to_a_better_one():
    """A - B - C, each 0.8 of the distance from the next: A and C are not conflict."""
    xyz = [[0, 0, 1], [0.008, 0, 2], [0.016, 0, 3]]
    kept, conflicts = settled(xyz, accuracy=[0.1, 0.2, 0.3])
    assert kept.tolist() == [True, False, True]
    assert [(c.kept, c.dropped) for c in conflicts] == [(0, 1)]
    kept, conflicts = settled(xyz, accuracy=[0.2, 0.1, 0.3])
    assert kept.tolist() == [False, True, False]
    assert {(c.kept, c.dropped) for c in conflicts} == {(1, 0), (1, 2)}
    kept, conflicts = settled(xyz, accuracy=[0.2, 0.3, 0.1])
    assert kept.tolist() == [True, False, True]
    assert [c.dropped for c in conflicts] == [1]


def test_three_at_one_place_are_listed_against_the_one_that_is_kept():
    kept, conflicts = settled([[0, 0, 1], [0, 0, 5], [0, 0, 2]], accuracy=[0.5, 0.1, 0.9])
    assert kept.tolist() == [False, True, False]
    assert {(c.kept, c.dropped, c.difference) for c in conflicts} == {(1, 0, -4.0), (1, 2, -3.0)}


@settings(deadline=None, derandomize=True, max_examples=150)
@given(
    hnp.arrays(np.int64, st.tuples(st.integers(1, 25), st.just(3)), elements=st.integers(0, 12)),
    st.integers(0, 2**31),
)
def test_kept_points_are_apart_and_each_other_one_is_listed_once(grid, seed):
    rng = np.random.default_rng(seed)
    n = len(grid)
    xyz = grid * (0.004, 0.004, 1.0) + (5e5, 3.1e6, 0)
    kept, conflicts = settled(
        xyz,
        kind=rng.choice(["borehole", "section", "map"], n),
        accuracy=rng.choice([np.nan, 0.1, 0.2], n),
    )
    # A hair's breadth: coordinates of 3.1e6 m carry 5e-10 m.
    assert pdist(xyz[kept, :2]).min(initial=np.inf) > 0.01 - 1e-8
    assert sorted(c.dropped for c in conflicts) == np.flatnonzero(~kept).tolist()
    for c in conflicts:
        assert kept[c.kept]
        assert np.hypot(*(xyz[c.kept] - xyz[c.dropped])[:2]) <= 0.01 + 1e-8
        assert c.difference == xyz[c.dropped, 2] - xyz[c.kept, 2]


@pytest.mark.parametrize(("n", "size", "columns"), [(3000, 20.0, 2), (3000, 20.0, 3), (700, 0.3, 2), (50, 0.05, 2)])
def test_pairs_are_those_of_a_tree(n, size, columns):
    place = np.random.default_rng(n).uniform(0, size, (n, columns)) + np.array([3e6, 5e5, 100.0])[:columns]
    for distance in (0.01, 0.3):
        wanted = KDTree(place).query_pairs(distance, output_type="ndarray")
        found = near_pairs(place, distance)
        assert {tuple(pair) for pair in found.tolist()} == {tuple(pair) for pair in wanted.tolist()}
        assert len(found) == len(wanted)


def test_places_in_one_line_are_paired_across_the_borders_of_strips():
    place = np.column_stack([np.zeros(500), np.arange(500) * 0.009])
    assert len(near_pairs(place, 0.01)) == 499


def test_points_lost_to_the_distance_are_no_secret():
    """A model of 100 mm, in metres: most of its points lie within the 10 mm of coincident ones."""
    xyz = np.random.default_rng(0).uniform(0, 0.1, (200, 3))
    fit = fit_horizon(PointSet(xyz))
    note = with_code(fit.accuracy.notes, "fitting.places-lost")
    lost = len(fit.accuracy.conflicts)
    assert note.severity == "warning"
    assert (note.params["count"], note.params["total"], lost > 100) == (lost, 200, True)
    metres = fit_horizon(PointSet(np.vstack([1000 * xyz, 1000 * xyz[:5]])))
    assert len(metres.accuracy.conflicts) == 5
    assert "fitting.places-lost" not in [one.code for one in metres.accuracy.notes]


def test_contacts_that_all_coincide_are_no_body():
    unit = np.random.default_rng(0).normal(size=(30, 3))
    with refused(FitError, "bodies.contacts-all-coincide", count=30):
        fit_body(BodyData(contacts=1e-8 * unit, normals=unit))

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from refusals import refused

import geofit
from geofit import PointSet
from geofit.data.errors import GeofitError, PointsError
from geofit.data.points import look_like_degrees

XYZ = [[0.0, 0.0, 1.0], [5.0, 0.0, 2.0], [5.0, 5.0, 3.0]]


def three(**columns):
    return PointSet(XYZ, **columns)


def test_only_the_coordinates_are_required():
    points = three()
    assert len(points) == 3
    assert points.xyz.dtype == np.float64
    assert points.kind.tolist() == ["point"] * 3
    assert points.hole.tolist() == points.section.tolist() == points.file.tolist() == [""] * 3
    assert np.isnan(points.accuracy).all()
    assert points.row.tolist() == [0, 0, 0]


def test_one_value_stands_for_all():
    points = three(kind="adit", accuracy=0.2, file="a.csv")
    assert points.kind.tolist() == ["adit"] * 3
    assert points.accuracy.tolist() == [0.2] * 3
    assert points.file.tolist() == ["a.csv"] * 3


@pytest.mark.parametrize("empty", [[], np.empty((0, 3)), np.empty((0, 2))])
def test_no_points_are_a_set_too(empty):
    assert len(PointSet(empty)) == 0
    assert PointSet(empty).xyz.shape == (0, 3)


@pytest.mark.parametrize(
    ("xyz", "code", "params"),
    [
        ([[0, 0]], "data.coordinates-wrong-shape", {"name": "xyz", "shape": (1, 2)}),
        ([1, 2, 3], "data.coordinates-wrong-shape", {"name": "xyz", "shape": (3,)}),
        (np.zeros((2, 3, 3)), "data.coordinates-wrong-shape", {"name": "xyz", "shape": (2, 3, 3)}),
        ([["a", 0, 0]], "data.coordinates-not-numbers", {"name": "xyz"}),
        ([[0, 0, 0], [0, 0]], "data.coordinates-not-numbers", {"name": "xyz"}),
        (np.ones((3, 3)) + 1j, "data.coordinates-not-numbers", {"name": "xyz"}),
        (
            np.ma.masked_equal([[0, 0, 1], [1, 1, -99999]], -99999),
            "data.points-not-finite",
            {"count": 1, "total": 2, "index": 1},
        ),
        (
            [[0, 0, 0], [1, np.nan, 2], [np.nan] * 3],
            "data.points-not-finite",
            {"count": 2, "total": 3, "index": 1},
        ),
        (
            [[np.inf, 0, 0]],
            "data.points-not-finite",
            {"count": 1, "total": 1, "index": 0, "place": [np.inf, 0, 0]},
        ),
    ],
)
def test_coordinates_that_are_no_points_are_named(xyz, code, params):
    with refused(PointsError, code, **params):
        PointSet(xyz)


@pytest.mark.parametrize(
    ("column", "code", "params"),
    [
        ({"kind": ["a", "b"]}, "data.wrong-shape", {"name": "kind", "shape": (2,), "n": 3}),
        ({"hole": [["a", "b", "c"]]}, "data.wrong-shape", {"name": "hole", "shape": (1, 3), "n": 3}),
        ({"accuracy": ["fine", "", ""]}, "data.cannot-read", {"name": "accuracy", "type": "float64"}),
        ({"accuracy": [0.1, -0.3, 0.2]}, "data.accuracy-not-positive", {"index": 1, "value": -0.3}),
        ({"accuracy": 0.0}, "data.accuracy-not-positive", {"index": 0, "value": 0.0}),
        ({"row": ["x", 2, 3]}, "data.cannot-read", {"name": "row", "type": "int64"}),
    ],
)
def test_a_column_that_does_not_fit_is_named(column, code, params):
    with refused(PointsError, code, **params):
        three(**column)


def test_errors_are_geofit_errors_and_value_errors():
    assert issubclass(PointsError, GeofitError)
    assert issubclass(PointsError, ValueError)


def test_nan_stands_for_an_accuracy_that_is_not_stated():
    points = three(accuracy=[np.nan, 0.5, np.nan])
    assert np.isnan(points.accuracy[[0, 2]]).all()


class Frame:
    """What a table of pandas or polars has of what is asked for."""

    def __init__(self, **columns):
        self.columns, self._of = list(columns), columns

    def __getitem__(self, name):
        return self._of[name]

    def __array__(self, dtype=None, copy=None):
        return np.array(list(self._of.values()), dtype=dtype).T


@pytest.mark.parametrize("order", ["xyz", "zyx", "yXZ"])
def test_a_table_is_read_by_the_names_of_its_columns(order):
    """The columns z, x, y had been taken for easting, northing and elevation."""
    columns = {name: np.array(XYZ)[:, "xyz".index(name.lower())] for name in order}
    structured = np.zeros(3, [(name, "f4") for name in order])
    for name, values in columns.items():
        structured[name] = values
    for table in (Frame(**columns), Frame(**columns, horizon=["T1", "T1", "T2"]), structured):
        np.testing.assert_array_equal(PointSet(table).xyz, XYZ)
    assert PointSet(Frame(a=[0.0, 1.0], b=[2.0, 3.0], c=[4.0, 5.0])).xyz.tolist() == [[0, 2, 4], [1, 3, 5]]
    with refused(PointsError, "data.coordinates-not-numbers"):
        PointSet(Frame(x=["a"], y=[1.0], z=[2.0]))


def test_a_masked_accuracy_is_not_stated():
    points = three(accuracy=np.ma.masked_less([-1.0, 0.5, 0.2], 0))
    np.testing.assert_array_equal(points.accuracy, [np.nan, 0.5, 0.2])


def test_points_cannot_be_changed():
    points = three(kind=["borehole", "adit", "map"])
    with pytest.raises(dataclasses.FrozenInstanceError):
        points.xyz = np.zeros((3, 3))
    for name in ("xyz", "kind", "hole", "section", "accuracy", "row", "file"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(points, name)[0] = getattr(points, name)[1]


def test_the_callers_arrays_stay_his_own():
    xyz, row = np.array(XYZ), np.array([1, 2, 3])
    points = PointSet(xyz, row=row)
    xyz[0, 0], row[0] = 99, 99
    assert points.xyz[0, 0] == 0
    assert points.row[0] == 1
    assert xyz.flags.writeable
    assert row.flags.writeable


@pytest.mark.parametrize(
    ("index", "rows"),
    [
        (np.array([True, False, True]), [2, 4]),
        ([2, 0], [4, 2]),
        (slice(1, None), [3, 4]),
        (1, [3]),
        (-1, [4]),
        (np.zeros(3, bool), []),
    ],
)
def test_a_part_keeps_all_columns(index, rows):
    points = three(kind=["a", "b", "c"], hole=["H1", "H2", "H3"], accuracy=[0.1, np.nan, 0.3], row=[2, 3, 4])
    part = points[index]
    assert part.row.tolist() == rows
    assert part.xyz.shape == (len(rows), 3)
    assert part.hole.tolist() == [f"H{row - 1}" for row in rows]
    np.testing.assert_array_equal(part.xyz, points.xyz[np.array(rows, int) - 2])


def test_sets_are_joined_in_order_with_the_longest_words():
    first, second = PointSet(XYZ[:1], hole="B1"), PointSet(XYZ[1:], hole="a longer name", accuracy=0.5)
    joined = PointSet.concatenate([first, second])
    assert joined.hole.tolist() == ["B1", "a longer name", "a longer name"]
    np.testing.assert_array_equal(joined.xyz, XYZ)
    np.testing.assert_array_equal(joined.accuracy, [np.nan, 0.5, 0.5])
    assert len(PointSet.concatenate([])) == 0


@settings(deadline=None, derandomize=True)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(0, 20), st.just(3)), elements=st.floats(-1e8, 1e8)), st.integers(0, 20)
)
def test_cutting_and_joining_gives_the_same_points(xyz, cut):
    points = PointSet(xyz, row=np.arange(len(xyz)) + 1)
    again = PointSet.concatenate([points[:cut], points[cut:]])
    np.testing.assert_array_equal(again.xyz, points.xyz)
    np.testing.assert_array_equal(again.row, points.row)


def test_with_replaces_columns_and_checks_them():
    points = three(hole="B1")
    higher = points.with_(xyz=points.xyz + np.array([0, 0, 10]))
    assert higher.hole.tolist() == ["B1"] * 3
    assert higher.xyz[0, 2] == 11
    with refused(PointsError, "data.points-not-finite", count=3, total=3):
        points.with_(xyz=points.xyz * np.nan)


@pytest.mark.parametrize(
    ("columns", "code", "params", "text"),
    [
        (
            {"kind": "borehole", "hole": "ZK12", "file": "holes.csv", "row": 7},
            "data.point-in-file",
            {"file": "holes.csv", "row": 7},
            "borehole ZK12, holes.csv row 7",
        ),
        ({"kind": "section", "section": "S3", "row": 9}, "data.point-in-row", {"row": 9}, "section S3, row 9"),
        (
            {"kind": "adit", "hole": "PD1", "section": "S3"},
            "data.point-kind-name",
            {"kind": "adit", "name": "PD1"},
            "adit PD1",
        ),
        ({}, "data.point-kind", {"kind": "point"}, "point"),
    ],
)
def test_a_point_is_described_as_a_person_would_look_it_up(columns, code, params, text):
    found = three(**columns).describe(1)
    assert found.code == code
    assert params.items() <= found.params.items()
    assert str(found) == text


def geographic(n=12, seed=0, extent=0.02, middle=(110.123, 30.456), relief=40.0):
    rng = np.random.default_rng(seed)
    plan = np.array(middle) + extent * rng.uniform(-0.5, 0.5, (n, 2))
    return np.column_stack([plan, 700 + relief * rng.uniform(size=n)])


@pytest.mark.parametrize("middle", [(110.1, 30.4), (-70.2, -33.4), (0.01, 51.5), (178.5, -16.2), (25.0, 0.02)])
@pytest.mark.parametrize("extent", [0.002, 0.05, 1.5])
def test_longitude_and_latitude_are_known_by_their_values(middle, extent):
    xyz = geographic(extent=extent, middle=middle)
    assert look_like_degrees(xyz)
    assert look_like_degrees(xyz[:, [1, 0, 2]]), "latitude first, as most maps of the web have it"


@pytest.mark.parametrize(
    "xyz",
    [
        np.random.default_rng(1).uniform(0, 80, (30, 3)),  # a local grid
        geographic(relief=0.1),  # level
        np.round(geographic(extent=3.0), 3),  # to the millimetre
        geographic() + np.array([500000, 3100000, 0]),
        geographic()[:2],
        np.zeros((5, 3)),
        np.array([[100.0, 50.0, z] for z in range(9)]),  # a vertical hole in a local grid
    ],
)
def test_metres_are_not_taken_for_degrees(xyz):
    assert not look_like_degrees(xyz)


def test_a_fit_refuses_degrees_and_names_the_remedy():
    with pytest.raises(PointsError, match=r"look like longitude and latitude .*--crs EPSG"):
        geofit.fit_horizon(PointSet(geographic()))


@pytest.mark.parametrize(
    ("kind", "origin"),
    [
        (np.float32, (500_000.4, 3_100_000.7, 0.0)),
        (">f4", (500_000.4, 3_100_000.7, 0.0)),
        (np.float16, (500.4, 310, 0)),
    ],
)
def test_coordinates_that_single_precision_rounds_by_centimetres_are_warned_of(kind, origin):
    """They had lost up to 0.12 m at a northing of 3,100,000 m without a word."""
    places = (np.array(XYZ) + origin).astype(kind)
    with pytest.warns(UserWarning, match="single precision"):
        PointSet(places)
    with pytest.warns(UserWarning, match="contacts: single precision"):
        geofit.BodyData(places)


def test_columns_of_a_table_in_single_precision_are_warned_of():
    table = np.zeros(3, [("x", "f4"), ("y", "f8"), ("z", "f4")])
    table["x"] = [500_000.37, 500_100.81, 500_200.13]
    with pytest.warns(UserWarning, match=r"to 0\.0312 m"):
        PointSet(table)


def test_single_precision_near_the_origin_is_no_reason_for_a_warning():
    assert PointSet(np.array(XYZ, np.float32) + np.float32(1000.3)).xyz.dtype == np.float64

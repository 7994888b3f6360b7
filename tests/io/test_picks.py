"""Bare pick files, boundaries and grids."""

from __future__ import annotations

import json

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io import axes, read_boundary, read_ground, read_points


def test_one_horizon_is_named_as_its_file(write):
    picks = read_points(write("x,y,z\n1,2,3\n4,5,6\n", "top.csv"))
    assert list(picks.horizons) == ["top"]
    np.testing.assert_array_equal(picks.horizons["top"].xyz, [[1, 2, 3], [4, 5, 6]])
    assert picks.horizons["top"].row.tolist() == [2, 3]


def test_many_horizons_with_stated_columns(write):
    path = write("E;N;H;what;line\n1,5;2;3;A;S1\n4;5;6;B;S2\n7;8;9;A;S1\n")
    picks = read_points(path, x="E", y="N", z="H", surface="what", section="line", sep=";", decimal=",")
    assert {name: len(points) for name, points in picks.horizons.items()} == {"A": 2, "B": 1}
    assert picks.horizons["A"].section.tolist() == ["S1", "S1"]
    assert picks.horizons["A"].xyz[0, 0] == 1.5


@pytest.mark.parametrize("z", ["12.5 m", "12.5m", '"1,012.5"', "1'012.5 m"])
def test_numbers_with_a_unit_or_thousands(write, z):
    picks = read_points(write("x,y,z\n" + "".join(f"{i},{i * i},{z}\n" for i in range(4))))
    expected = 1012.5 if "012" in z else 12.5
    np.testing.assert_array_equal(picks.horizons["table"].xyz[:, 2], [expected] * 4)


@pytest.mark.parametrize(
    ("header", "cell", "z"), [("z", "12 ft", None), ("z [ft]", "12 m", None), ("z [ft]", "12 ft", 12)]
)
def test_unit_of_a_cell_is_that_of_its_column(write, header, cell, z):
    picks = read_points(write(f"x,y,{header}\n1,2,10\n3,5,{cell}\n6,6,11\n"))
    found = [issue for issue in picks.issues if issue.reason.code == "io.cell-not-a-number"]
    assert [(one.row, one.value) for one in found] == ([(3, cell)] if z is None else [])
    if z:
        np.testing.assert_allclose(picks.horizons["table"].xyz[1, 2], z * 0.3048)


def test_order_of_rows_is_kept_with_odd_rows_among_them(write):
    rows = [f"{i},{i * i},{i}" for i in range(40)]
    rows[7] = '7,"49",7'
    rows[20] = "20,400,20,"
    rows[30] = "30,900"
    points = read_points(write("x,y,z\n" + "\n".join(rows) + "\n"))
    xyz = points.horizons["table"].xyz
    np.testing.assert_array_equal(xyz[:, 0], [i for i in range(40) if i != 30])
    np.testing.assert_array_equal(xyz[:, 1], xyz[:, 0] ** 2)
    assert (points.counts[0].read, points.counts[0].used, points.counts[0].listed) == (40, 39, 1)


def test_one_swapped_row_is_listed_without_a_boundary(write):
    rows = [f"{500000 + 10 * i},{3100000 + 7 * i},5" for i in range(20)]
    rows[11] = "3100077,500110,5"
    picks = read_points(write("x,y,z\n" + "\n".join(rows)))
    (issue,) = [issue for issue in picks.issues if issue.severity == "error"]
    assert (issue.row, issue.column) == (13, "x")
    assert "exchanged" in str(issue.reason)


def test_large_coordinates_are_not_taken_for_swapped(write):
    rows = [f"{32412665.15 + 900 * i},{5778285.3 + 800 * (i % 7)},-2250" for i in range(20)]
    assert read_points(write("x,y,z\n" + "\n".join(rows))).counts[0].used == 20


def test_two_points_at_one_place(write):
    picks = read_points(write("x,y,z\n1,2,3\n4,5,6\n1,2,3\n4,5,7\n"))
    found = {issue.row: issue.severity for issue in picks.issues if "Horizon" in str(issue.reason)}
    assert found == {4: "note", 5: "warning"}
    assert picks.counts[0].used == 4


def test_boundary_from_geojson_and_table_are_equal(write):
    ring = [[0, 0], [1000, 0], [1000, 900], [0, 900], [0, 0]]
    polygon = {"type": "Polygon", "coordinates": [ring]}
    collection = {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": polygon}]}
    table = write("x;y\n" + "".join(f"{x};{y}\n" for x, y in ring))
    expected = np.array(ring[:4], dtype=float)
    np.testing.assert_array_equal(read_boundary(table), expected)
    np.testing.assert_array_equal(read_boundary(write(json.dumps(polygon), "b.json")), expected)
    np.testing.assert_array_equal(read_boundary(write(json.dumps(collection), "b.geojson")), expected)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[1]",
        "{",
        '{"type": "Point", "coordinates": [1, 2]}',
        '{"type": "Polygon", "coordinates": [["a"]]}',
        '{"type": "Polygon", "coordinates": [[[0,0],[1,1],[1,0],[0,1]]]}',
        '{"type": "Polygon", "coordinates": []}',
    ],
)
def test_broken_geojson_is_a_clear_error(write, text):
    with pytest.raises(InputError, match=r"b\.geojson"):
        read_boundary(write(text, "b.geojson"))


def test_grid_runs_from_south_to_north(write):
    head = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n"
    ground = read_ground(write(head + "1 2 3\n4 5 -9999\n", "g.asc"))
    np.testing.assert_array_equal(ground.x, [105, 115, 125])
    np.testing.assert_array_equal(ground.y, [205, 215])
    np.testing.assert_array_equal(ground.z, [[4, 5, np.nan], [1, 2, 3]])
    np.testing.assert_allclose(ground.elevation([110, 110], [205, 210]), [4.5, 3.0])


def test_grid_by_cell_centres(write):
    head = "NCOLS 2\nNROWS 2\nXLLCENTER 100\nYLLCENTER 200\nDX 10\nDY 5\n"
    ground = read_ground(write(head + "1 2\n3 4\n", "g.asc"))
    assert (ground.x.tolist(), ground.y.tolist()) == ([100, 110], [200, 205])


DEGREES = "LONGITUDE,LATITUDE,z\n117.10,28.20,100\n117.12,28.21,120\n117.13,28.25,130\n117.15,28.22,111\n"


@pytest.mark.parametrize("columns", [{}, {"x": "LONGITUDE", "y": "LATITUDE", "z": "z"}, {"x": 1, "y": 2}])
def test_longitude_and_latitude_are_refused_with_the_remedy(tmp_path, columns):
    (tmp_path / "p.csv").write_text(DEGREES)
    with pytest.raises(InputError, match=r"easting and northing in metres are needed.*--crs"):
        read_points(tmp_path / "p.csv", **columns)


@pytest.mark.parametrize("columns", [{}, {"x": "LONGITUDE", "y": "LATITUDE", "z": "z"}])
def test_longitude_and_latitude_are_projected_to_the_grid_that_is_named(tmp_path, columns):
    pyproj = pytest.importorskip("pyproj", reason="projecting needs the extra gis")
    (tmp_path / "p.csv").write_text(DEGREES)
    points = read_points(tmp_path / "p.csv", **columns, crs="EPSG:32650").horizons["p"]
    known = pyproj.Transformer.from_crs(4326, 32650, always_xy=True).transform(117.10, 28.20)
    np.testing.assert_allclose(points.xyz[0], [*known, 100.0], atol=1e-6)


@pytest.mark.parametrize("seed", range(40))
def test_places_spread_out_have_none_far_from_their_middle(seed):
    """The quick answer of check_axes is that of the medians, whatever the places look like."""
    rng = np.random.default_rng(seed)
    x, y = rng.normal(0, 10.0 ** rng.uniform(-2, 4), 400) ** rng.integers(1, 4), rng.uniform(0, 100, 400)
    x[: rng.integers(0, 300)] *= 10.0 ** rng.uniform(-3, 3)
    if axes.spread_out(x, y):
        away = np.hypot(x - np.median(x), y - np.median(y))
        reach = 20 * np.median(away) + 1
        assert np.abs(x - np.median(x)).max() <= reach
        assert np.abs(y - np.median(y)).max() <= reach
    crowded = np.where(np.arange(400) < 300, x / np.abs(x).max(), 1e6 * x)
    assert axes.spread_out(rng.uniform(0, 1, 400), y)
    assert not axes.spread_out(crowded, np.zeros(400))


def test_names_that_differ_in_case_only_are_one_horizon(write):
    found = read_points(write("horizon,x,y,z\nT2,0,0,1\nt2 ,5,0,2\nT1,0,5,3\n T2,9,9,4\n"))
    assert {name: len(points) for name, points in found.horizons.items()} == {"T2": 3, "T1": 1}
    assert [
        issue.reason.params["names"] for issue in found.issues if issue.reason.code == "io.horizon-names-merged"
    ] == ["t2 = T2"]


@pytest.mark.parametrize(("x", "y"), [(900000, 3100500), (0, 3100500), (500050, 3900000)])
def test_a_place_far_from_all_others_is_warned_of(write, x, y):
    rng = np.random.default_rng(1)
    rows = [f"{500000 + a:.1f},{3100000 + b:.1f},10" for a, b in rng.uniform(0, 900, (30, 2))]
    found = read_points(write("\n".join(["x,y,z", *rows, f"{x},{y},10"]) + "\n"))
    (far,) = [issue for issue in found.issues if issue.reason.code == "io.row-far-from-others"]
    assert (far.row, far.severity) == (32, "warning")
    assert far.reason.params["distance"] == pytest.approx(
        np.hypot(max(500000 - x, x - 500900, 0), max(3100000 - y, y - 3100900, 0)), abs=100
    )
    assert len(next(iter(found.horizons.values()))) == 31


def test_a_thin_rim_around_a_dense_core_is_not_far(write):
    rng = np.random.default_rng(2)
    core, rim = rng.uniform(-40, 40, (80, 2)), rng.uniform(-2500, 2500, (25, 2))
    rows = [f"{500000 + a:.1f},{3100000 + b:.1f},10" for a, b in np.concatenate([core, rim])]
    found = read_points(write("\n".join(["x,y,z", *rows]) + "\n"))
    assert "io.row-far-from-others" not in [issue.reason.code for issue in found.issues]


def test_placeholders_exchanged_and_far_places_do_not_hide_each_other(write):
    """300 real places: (0, 0) and exchanged ones are not used, those 100 km or a continent away are warned of."""
    rng = np.random.default_rng(2)
    xy = np.array([500000.0, 3100000.0]) + rng.uniform(0, 3000, (300, 2))
    angle = rng.uniform(0, 2 * np.pi, 10)
    far = xy[:10] + 1e5 * np.column_stack((np.cos(angle), np.sin(angle)))
    every = {"near": xy, "zero": np.zeros((40, 2)), "exchanged": xy[:9, ::-1], "far": far,
             "same": np.full((30, 2), 9999999.0)}  # fmt: skip
    kinds = np.repeat(list(every), [len(part) for part in every.values()])
    places = np.concatenate(list(every.values()))
    order = rng.permutation(len(places))
    rows = [f"{x:.2f},{y:.2f},{z}" for z, (x, y) in enumerate(places[order])]
    found = read_points(write("\n".join(["x,y,z", *rows]) + "\n"))
    listed = {}
    for issue in found.issues:
        if issue.row:
            listed.setdefault(issue.reason.code, set()).add(kinds[order][issue.row - 2])
            assert issue.severity == ("warning" if issue.reason.code.endswith(("others", "differ")) else "error")
    assert listed.pop("io.horizon-elevations-differ") == {"same"}
    assert listed == {
        "io.row-at-placeholder": {"zero"},
        "io.row-axes-exchanged": {"exchanged"},
        "io.row-far-from-others": {"far", "same"},
    }
    told = [issue.reason for issue in found.issues if issue.reason.code == "io.row-far-from-others"]
    assert len(told) == 40
    assert max(reason.params["extent"] for reason in told) < 4300
    assert [len(points) for points in found.horizons.values()] == [340]


@pytest.mark.parametrize("others", [[(500000, 3100000)], [(500000 + i, 3100000 + i * i) for i in range(6)]])
def test_a_placeholder_among_few(write, others):
    text = "x,y,z\n" + "".join(f"{x},{y},1\n" for x, y in (*others, (0, 0)))
    found = read_points(write(text))
    assert [len(points) for points in found.horizons.values()] == [len(others)]


@pytest.mark.parametrize("others", [[(800, 0)], [(300 * i, 500) for i in range(6)], [(0, 7)] * 9])
def test_the_origin_of_a_local_grid_is_a_place(write, others):
    text = "x,y,z\n" + "".join(f"{x},{y},1\n" for x, y in (*others, (0, 0)))
    (points,) = read_points(write(text)).horizons.values()
    assert len(points) == len(others) + 1


def test_two_sites_are_no_strays(write):
    """A twelfth of the places, 80 km away, are another site."""
    rng = np.random.default_rng(3)
    xy = np.concatenate((rng.uniform(0, 2000, (220, 2)), 80000 + rng.uniform(0, 2000, (20, 2))))
    found = read_points(write("x,y,z\n" + "".join(f"{x:.1f},{y:.1f},5\n" for x, y in xy)))
    assert "io.row-far-from-others" not in [issue.reason.code for issue in found.issues]

"""Workbooks, AGS, LAS, GOCAD, map formats and grids, each against another writer or a text made by its rules."""

from __future__ import annotations

import datetime
import struct

import numpy as np
import pytest

from geofit.data.errors import InputError, MissingDependencyError
from geofit.io import read_boreholes, read_boundary, read_ground, read_points
from geofit.io.formats import read_any_table, table_names
from geofit.io.journal import Journal
from geofit.io.source import Source

AGS4 = """"GROUP","PROJ"
"HEADING","PROJ_ID","PROJ_NAME"
"UNIT","",""
"TYPE","X","X"
"DATA","1","A ""quoted"" site"

"GROUP","LOCA"
"HEADING","LOCA_ID","LOCA_NATE","LOCA_NATN","LOCA_GL","LOCA_FDEP"
"UNIT","","m","m","m","m"
"TYPE","ID","2DP","2DP","2DP","2DP"
"DATA","B1","500100.00","3100100.00","110.00","50.00"
"DATA","B2","500200.00","3100100.00","111.00","60.00"

"GROUP","GEOL"
"HEADING","LOCA_ID","GEOL_TOP","GEOL_BASE","GEOL_DESC","GEOL_LEG","GEOL_GEOL"
"UNIT","","m","m","","",""
"TYPE","ID","2DP","2DP","X","PA","PA"
"DATA","B1","0.00","12.00","Clay, firm","101","Q"
"DATA","B1","12.00","50.00","Granite","801","G"
"DATA","B2","0.00","20.00","Clay","101","Q"
"NOISE","B2","20.00"
"DATA","B2","20.00","60.00","Granite","801","G","x"
"""

AGS3 = """"**PROJ"
"*PROJ_ID"
"<UNITS>"
"1"

"**HOLE"
"*HOLE_ID","*HOLE_NATE","*HOLE_NATN",
"*HOLE_GL","*HOLE_FDEP","*HOLE_INCL"
"<UNITS>","m","m","m","m","deg"
"B1","500100","3100100","110","50","90"
"<CONT>","","","","51",""

"**GEOL"
"*HOLE_ID","*GEOL_TOP","*GEOL_BASE","*GEOL_DESC","*GEOL_GEOL"
"<UNITS>","m","m","",""
"B1","0","12","Soft to fi",""
"<CONT>","","","rm CLAY","Q"
"B1","12","50","GRANITE","G"
"""


def test_days_of_a_sheet_are_days_without_an_hour(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (
        ["hole", "x", "y", "z"],
        [datetime.datetime(2024, 3, 5), 0, 0, 1],
        [datetime.date(2024, 3, 6), 5, 0, 2],
        [datetime.datetime(2024, 3, 7, 8, 30), 0, 5, 3],
    ):
        book.active.append(row)
    book.save(tmp_path / "days.xlsx")
    holes = next(iter(read_points(tmp_path / "days.xlsx").horizons.values())).hole.tolist()
    assert holes == ["2024-03-05", "2024-03-06", "2024-03-07T08:30:00"]


def test_ags4_against_the_ags_package(write):
    theirs = pytest.importorskip("python_ags4.AGS4")
    path = write(AGS4.replace('"NOISE","B2","20.00"\n', "").replace('"G","x"', '"G"'), "a.ags")
    expected, _ = theirs.AGS4_to_dict(str(path))
    table = read_any_table(Source(path=path, table="GEOL"), Journal())
    for name, cells in zip(table.header, table.columns, strict=True):
        assert list(cells) == expected["GEOL"][name][2:]


def test_ags4_holes_and_lines(write):
    path = write(AGS4, "a.ags")
    assert table_names(Source(path=path)) == ("PROJ", "LOCA", "GEOL")
    holes = read_boreholes(path, intervals=[path])
    assert [hole.name for hole in holes.holes] == ["B1", "B2"]
    assert holes.logs[0].code.tolist() == ["Q", "G", "Q"]
    assert holes.logs[0].row.tolist() == [18, 19, 20]
    assert [(c.file, c.read, c.used, c.listed) for c in holes.counts] == [
        ("a.ags [LOCA]", 2, 2, 0),
        ("a.ags [GEOL]", 5, 3, 2),
    ]
    assert {issue.row for issue in holes.issues if issue.severity == "error"} == {21, 22}


def test_ags3_headers_over_two_lines_units_and_continuations(write):
    path = write(AGS3, "a.ags", "cp1252")
    holes = read_boreholes(path, intervals=[path])
    assert holes.ends == {"B1": 50.0}
    np.testing.assert_allclose(holes.holes[0].xyz[-1], [500100, 3100100, 60], atol=1e-9)
    assert [(c.read, c.used) for c in holes.counts] == [(1, 1), (2, 2)]
    table = read_any_table(Source(path=path, table="GEOL"), Journal())
    assert table.columns[3] == ("Soft to firm CLAY", "GRANITE")
    assert table.columns[4] == ("Q", "G")
    (issue,) = [issue for issue in holes.issues if "<CONT>" in str(issue.reason)]
    assert (issue.row, issue.value) == (11, "51")


@pytest.mark.parametrize(("text", "words"), [("a,b\n1,2\n", "no AGS group"), (AGS4, "no group 'CORE'")])
def test_ags_that_is_none(write, text, words):
    with pytest.raises(InputError, match=words):
        read_any_table(Source(path=write(text, "a.ags"), table="CORE"), Journal())


def test_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["Dam site"])
    for row in (
        ["x", "y", "z", "层位"],
        ["m", "m", "ft", "-"],
        [1.5, 2, 10, "T2"],
        [4, 5, 20.0, "T2"],
        [6, 7, "?", "T1"],
    ):
        book.active.append(row)
    book.create_sheet("notes").append(["nothing", "else"])
    book.save(tmp_path / "picks.xlsx")
    with pytest.raises(InputError, match="2 tables: Sheet, notes"):
        read_points(tmp_path / "picks.xlsx")
    table = read_any_table(Source(path=tmp_path / "picks.xlsx", table="Sheet"), Journal())
    assert table.lines.tolist() == [4, 5, 6]
    book.remove(book["notes"])
    book.save(tmp_path / "picks.xlsx")
    picks = read_points(tmp_path / "picks.xlsx")
    np.testing.assert_allclose(picks.horizons["T2"].xyz, [[1.5, 2, 3.048], [4, 5, 6.096]])
    assert (picks.counts[0].read, picks.counts[0].used) == (3, 2)


def test_damaged_workbook(write):
    pytest.importorskip("openpyxl")
    with pytest.raises(InputError, match="workbook cannot be read"):
        read_points(write(b"PK\x03\x04 and no more", "a.xlsx"))


LAS = """~VERSION
VERS. 2.0 :
WRAP. NO :
~WELL
STRT.FT 0 :
STOP.FT 30 :
STEP.FT 10 :
NULL. -999.25 :
WELL. W-1 : well
XCOORD.M 500100 :
YCOORD.M 3100100 :
EKB.FT 100 :
~CURVE
DEPT.FT : depth
GR.API : gamma
FACIES. : code
~ASCII
0 50 1
10 60 1
20 70 2
30 -999.25 2
"""


def test_las_samples_are_intervals(write):
    pytest.importorskip("lasio")
    path = write(LAS, "w.las")
    log = Source(path=path, table="CURVES", columns={"code": "FACIES"})
    holes = read_boreholes(Source(path=path), intervals=[log])
    np.testing.assert_allclose(holes.holes[0].xyz[0], [500100, 3100100, 30.48])
    np.testing.assert_allclose(holes.logs[0].base, [3.048, 6.096, 9.144, 12.192])
    assert holes.logs[0].code.tolist() == ["1", "1", "2", "2"]
    assert [(c.read, c.used, c.listed) for c in holes.counts] == [(1, 1, 0), (4, 4, 0)]


def test_a_las_file_that_runs_upwards_is_the_same_log(write):
    pytest.importorskip("lasio")
    head, _, body = LAS.partition("~ASCII\n")
    upwards = head.replace("STRT.FT 0", "STRT.FT 30").replace("STOP.FT 30", "STOP.FT 0").replace("FT 10", "FT -10")
    found = []
    for text in (LAS, upwards + "~ASCII\n" + "\n".join(reversed(body.splitlines())) + "\n"):
        path = write(text, "w.las")
        log = Source(path=path, table="CURVES", columns={"code": "FACIES"})
        found.append(read_boreholes(Source(path=path), intervals=[log]))
    down, up = found
    for one, other in ((down.logs[0].top, up.logs[0].top), (down.logs[0].base, up.logs[0].base)):
        np.testing.assert_allclose(one, other)
    assert down.logs[0].code.tolist() == up.logs[0].code.tolist()
    np.testing.assert_allclose([down.ends["W-1"], up.ends["W-1"]], 12.192)


def test_gocad_objects_and_depths(write):
    text = (
        "GOCAD TSurf 1\nHEADER {\nname: T2 top\n}\nGOCAD_ORIGINAL_COORDINATE_SYSTEM\nZPOSITIVE Depth\n"
        "END_ORIGINAL_COORDINATE_SYSTEM\nTFACE\nVRTX 1 10 20 30\nPVRTX 2 11 21 -31 0.5\nVRTX 3 1\nTRGL 1 2 3\nEND\n"
        "GOCAD VSet 1\nHEADER {\nname: B\n}\nVRTX 1 1 2 3\nEND\n"
    )
    picks = read_points(write(text, "a.ts"))
    np.testing.assert_array_equal(picks.horizons["T2 top"].xyz, [[10, 20, -30], [11, 21, 31]])
    np.testing.assert_array_equal(picks.horizons["B"].xyz, [[1, 2, 3]])
    assert (picks.counts[0].read, picks.counts[0].listed) == (4, 1)
    with pytest.raises(InputError, match="does not start with GOCAD"):
        read_points(write("x,y,z\n1,2,3\n", "b.vs"))


def write_map(path, shapes, crs, **fields):
    pyogrio = pytest.importorskip("pyogrio")
    shapely = pytest.importorskip("shapely")
    pyogrio.raw.write(
        path,
        shapely.to_wkb(np.array(shapes, dtype=object), output_dimension=3),
        [np.array(values, dtype=object) for values in fields.values()],
        list(fields),
        geometry_type=shapes[0].geom_type if not shapes[0].has_z else f"{shapes[0].geom_type} Z",
        crs=crs,
    )


@pytest.mark.parametrize("ending", ["gpkg", "shp"])
def test_map_points_and_lines(tmp_path, ending):
    from shapely import LineString, Point

    write_map(tmp_path / f"p.{ending}", [Point(1, 2, 3), Point(4, 5, 6)], "EPSG:32650", horizon=["A", "B"])
    picks = read_points(tmp_path / f"p.{ending}")
    np.testing.assert_array_equal(picks.horizons["B"].xyz, [[4, 5, 6]])
    line = LineString([(0, 0, 1), (1, 0, 2), (1, 1, 3)])
    write_map(tmp_path / f"l.{ending}", [line], "EPSG:32650", horizon=["A"])
    lines = read_points(tmp_path / f"l.{ending}")
    assert lines.horizons["A"].row.tolist() == [1, 1, 1]
    assert any("EPSG:32650" in str(issue.reason) for issue in lines.issues)


def test_boundary_from_a_map(tmp_path):
    from shapely import Polygon

    square = Polygon([(0, 0), (900, 0), (900, 900), (0, 900)])
    write_map(tmp_path / "b.gpkg", [square], "EPSG:32650")
    assert {tuple(corner) for corner in read_boundary(tmp_path / "b.gpkg")} == {(0, 0), (900, 0), (900, 900), (0, 900)}
    holed = Polygon(square.exterior, [[(100, 100), (200, 100), (200, 200)]])
    write_map(tmp_path / "h.gpkg", [holed], "EPSG:32650")
    with pytest.raises(InputError, match="several lines or rings"):
        read_boundary(tmp_path / "h.gpkg")


def test_degrees_are_refused_or_projected(tmp_path, write):
    pyproj = pytest.importorskip("pyproj")
    from shapely import Point

    write_map(tmp_path / "p.gpkg", [Point(117.1, 28.2, 30)], "EPSG:4326", horizon=["A"])
    with pytest.raises(InputError, match="longitude and latitude"):
        read_points(tmp_path / "p.gpkg")
    from geofit.io.horizons import HorizonNames
    from geofit.io.picks import load_picks

    east, north = pyproj.Transformer.from_crs(4326, 32650, always_xy=True).transform(117.1, 28.2)
    table = write("horizon,lon,lat,z\nA,117.1,28.2,30\n")
    for path in (tmp_path / "p.gpkg", table):
        found = load_picks(Source(path=path, target="EPSG:32650"), HorizonNames(), Journal())
        np.testing.assert_allclose(found["A"].xyz, [[east, north, 30]], rtol=0, atol=1e-6)
    with pytest.raises(InputError, match="not a projected system in metres"):
        load_picks(Source(path=table, target="EPSG:4979"), HorizonNames(), Journal())


Z = np.array([[1.0, 2.0, 3.0], [4.0, np.nan, 6.0]])


def surfer(form):
    """A grid of x 0 to 20, y 100 to 110 by the formats' published layouts."""
    filled = np.where(np.isnan(Z), 1.70141e38, Z)
    if form == "6 ascii":
        rows = "\n".join(" ".join(f"{value:g}" for value in row) for row in filled)
        return f"DSAA\n3 2\n0 20\n100 110\n1 6\n{rows}\n".encode()
    if form == "6 binary":
        return struct.pack("<4shhdddddd", b"DSBB", 3, 2, 0, 20, 100, 110, 1, 6) + filled.astype("<f4").tobytes()
    grid = struct.pack("<iidddddddd", 2, 3, 0, 100, 10, 10, 1, 6, 0, 1.70141e38)
    return (
        struct.pack("<4sii", b"DSRB", 4, 1)
        + struct.pack("<4si", b"GRID", len(grid))
        + grid
        + struct.pack("<4si", b"DATA", 48)
        + filled.astype("<f8").tobytes()
    )


@pytest.mark.parametrize("form", ["6 ascii", "6 binary", "7"])
def test_surfer_grids(write, form):
    ground = read_ground(write(surfer(form), "g.grd"))
    np.testing.assert_array_equal(ground.x, [0, 10, 20])
    np.testing.assert_array_equal(ground.y, [100, 110])
    np.testing.assert_array_equal(ground.z, Z)


@pytest.mark.parametrize("form", ["6 ascii", "6 binary", "7"])
def test_cut_surfer_grids(write, form):
    with pytest.raises(InputError):
        read_ground(write(surfer(form)[:-9], "g.grd"))


def test_surfer_and_geotiff_agree_with_gdal(tmp_path, write):
    rasterio = pytest.importorskip("rasterio")
    path = write(surfer("6 binary"), "g.grd")
    with rasterio.open(path) as raster:
        theirs = raster.read(1)[::-1]
        place = raster.transform
        west, north = place.c + 0.5 * place.a, place.f + 0.5 * place.e
    ground = read_ground(path)
    assert (west, north) == (ground.x[0], ground.y[-1])
    known = ~np.isnan(ground.z)
    np.testing.assert_array_equal(ground.z[known], theirs[known])
    place = rasterio.Affine(10, 0, -5, 0, -10, 115)
    with rasterio.open(
        tmp_path / "g.tif", "w", driver="GTiff", height=2, width=3, count=1, dtype="float64",
        transform=place, crs="EPSG:32650", nodata=-9999,
    ) as raster:  # fmt: skip
        raster.write(np.nan_to_num(Z[::-1], nan=-9999), 1)
    tiff = read_ground(tmp_path / "g.tif")
    np.testing.assert_array_equal(tiff.z, Z)
    np.testing.assert_array_equal(tiff.x, ground.x)
    np.testing.assert_array_equal(tiff.y, ground.y)
    with pytest.raises(InputError, match="in EPSG:32650, the site in EPSG:32651"):
        read_ground(Source(path=tmp_path / "g.tif", target="EPSG:32651"))


@pytest.mark.parametrize(("name", "extra"), [("a.xlsx", "xlsx"), ("a.las", "las"), ("a.gpkg", "gis")])
def test_absent_packages_give_the_install_line(write, monkeypatch, name, extra):
    def absent(module):
        raise ImportError(f"No module named '{module}'")

    monkeypatch.setattr("geofit.io.extra.import_module", absent)
    with pytest.raises(MissingDependencyError, match=rf"pip install \"geofit-geology\[{extra}\]\""):
        read_any_table(Source(path=write(LAS, name), table="CURVES"), Journal())

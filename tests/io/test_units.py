"""Feet at the door: stated, marked in headers or the unit of the site; converted once, exactly, and listed."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.boreholes import read_boreholes
from geofit.io.clouds import open_cloud
from geofit.io.picks import read_points
from geofit.io.site_file import read_site
from geofit.io.units import METRES, unit_marked

FOOT, SURVEY = 0.3048, 1200 / 3937
#: A state-plane place in California, US survey feet: the two feet differ by 4 m there.
EAST, NORTH = 6_150_000.25, 2_090_000.5


@pytest.mark.parametrize(
    ("header", "metres"),
    [
        ("Depth (ft)", FOOT), ("depth_ft", FOOT), ("DEPTH [Feet]", FOOT), ("Depth, ft", FOOT), ("depth ft.", FOOT),
        ("Depth (ft bgl)", FOOT), ("Depth (ft. AMSL)", FOOT), ("depth（英尺）", FOOT), ("Depth (foot)", FOOT),
        ("Depth (US ft)", SURVEY), ("Depth (ftUS)", SURVEY), ("depth_ft_us", SURVEY),
        ("Depth (US Survey Feet)", SURVEY),
        ("depth_us_ft", SURVEY), ("Depth (survey ft)", SURVEY), ("Depth (ft-us)", SURVEY),
        ("Depth (m)", 1.0), ("depth", 1.0), ("Depth (m bgl)", 1.0), ("Depth (raw)", 1.0),
    ],
)  # fmt: skip
def test_headers_that_mark_feet(tmp_path, header, metres):
    from geofit.io.columns import COLLAR
    from geofit.io.journal import Journal
    from geofit.io.rows import read_rows
    from geofit.io.source import Source

    path = tmp_path / "collar.csv"
    path.write_text(f'hole,x,y,z,"{header}"\nB1,1,2,3,400\n', encoding="utf-8")
    journal = Journal()
    rows = read_rows(Source(path=path), COLLAR, journal)
    assert rows.numbers("depth").tolist() == [400 * metres]
    assert rows.numbers("x").tolist() == [1.0], "a column that is not marked stays in metres"
    listed = [issue for issue in journal.issues if issue.reason.code == "io.unit-converted"]
    assert len(listed) == (metres != 1.0)


def write_site(folder, metres, head="", unit=""):
    """Write one site with lengths in some unit: what is ``metres`` long has ``1 / metres`` of them."""
    folder.mkdir()

    def n(*values):
        return ",".join(repr(float(value) / metres) for value in values)

    corners = np.array([[500_000, 3_100_000], [500_900, 3_100_000], [500_900, 3_100_900], [500_000, 3_100_900]])
    mark = f" ({unit})" if unit else ""
    (folder / "area.csv").write_text(f"x{mark},y{mark}\n" + "".join(f"{n(*xy)}\n" for xy in corners))
    rng = np.random.default_rng(7)
    collar, survey, log = [f"hole,x{mark},y{mark},z{mark},depth{mark}"], [f"hole,depth{mark},azimuth,dip"], []
    log = [f"hole,from{mark},to{mark},code"]
    for k, (x, y) in enumerate(rng.uniform(50, 850, (12, 2)) + corners[0]):
        collar.append(f"B{k},{n(x, y, 1500 + k, 120)}")
        survey.append(f"B{k},{n(0)},{30 * k},{80 + k % 5}")
        log += [f"B{k},{n(0, 20 + k)},Q", f"B{k},{n(20 + k, 120)},T2"]
    for name, lines in (("collar", collar), ("survey", survey), ("lith", log)):
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    (folder / "picks.csv").write_text(
        f"x{mark},y{mark},z{mark},horizon\n"
        + "".join(f"{n(x, y, 1400)},F\n" for x, y in rng.uniform(50, 850, (9, 2)) + corners[0])
    )
    (folder / "ground.asc").write_text(
        "ncols 4\nnrows 4\n" + "".join(f"{key} {n(value)}\n" for key, value in
        (("xllcorner", 499_000), ("yllcorner", 3_099_000), ("cellsize", 1000)))
        + "\n".join(" ".join([n(1500)] * 4) for _ in range(4)) + "\n"
    )  # fmt: skip
    grid = f'ground = {{ file = "ground.asc", unit = "{unit}" }}\n' if unit else 'ground = "ground.asc"\n'
    (folder / "site.toml").write_text(
        f'boundary = "area.csv"\n{grid}\n[site]\n{head}\n[boreholes]\ncollar = "collar.csv"\nsurvey = "survey.csv"\n'
        'intervals = ["lith.csv"]\ndip = "down-positive"\n\n[picks]\nfile = "picks.csv"\n\n'
        '[[horizon]]\nname = "base of Q"\nbase = "Q"\n\n[[horizon]]\nname = "F"\n'
    )
    return read_site(folder / "site.toml")


@pytest.mark.parametrize(("unit", "metres"), [("ft", FOOT), ("ft-us", SURVEY)])
def test_a_site_in_feet_is_the_site_in_metres(tmp_path, unit, metres):
    right = write_site(tmp_path / "metres", 1.0)
    for found in (
        write_site(tmp_path / "stated", metres, head=f'unit = "{unit}"'),
        write_site(tmp_path / "marked", metres, unit=unit),
    ):
        assert set(found.horizons) == {"base of Q", "F"}
        for name, points in right.horizons.items():
            assert np.abs(found.horizons[name].xyz - points.xyz).max() < 1e-8
        assert np.abs(found.boundary - right.boundary).max() < 1e-8
        for one, other in zip(found.holes, right.holes, strict=True):
            assert np.abs(one.xyz - other.xyz).max() < 1e-8
            assert np.abs(one.depth - other.depth).max() < 1e-8
        assert np.abs(found.ground.z - right.ground.z).max() < 1e-9
        assert np.abs(found.ground.x - right.ground.x).max() < 1e-8
        # What was done to the data is on record, for every file.
        codes = ("io.unit-converted", "io.stated-unit-converted")
        assert {issue.file for issue in found.issues if issue.reason.code in codes} == set(found.inputs) - {"site.toml"}
        assert all(f"{metres:.10g} m" in str(one.reason) for one in found.issues if one.reason.code in codes)
    assert not [issue for issue in right.issues if "converted" in issue.reason.code]


def test_both_feet_are_exact_at_a_state_plane_place(tmp_path):
    (tmp_path / "p.csv").write_text(f"x,y,z\n{EAST!r},{NORTH!r},100\n1,2,3\n5,5,5\n")
    for unit, metres in (("ft", FOOT), ("ft-us", SURVEY), ("US survey feet", SURVEY)):
        first = read_points(tmp_path / "p.csv", unit=unit).horizons["p"].xyz[0]
        assert first.tolist() == [EAST * metres, NORTH * metres, 100 * metres]
    assert METRES["ft-us"] == 1200 / 3937
    assert abs(NORTH * (SURVEY - FOOT)) > 1.2


def test_a_mark_goes_before_the_unit_of_the_site_and_a_statement_before_the_mark(tmp_path):
    (tmp_path / "p.csv").write_text("x (m),y,z (ft)\n100,200,300\n5,6,7\n5,9,8\n")
    (tmp_path / "site.toml").write_text('[site]\nunit = "ft-us"\n[picks]\nfile = "p.csv"\nhorizon = "T"\n')
    assert read_site(tmp_path / "site.toml").horizons["T"].xyz[0].tolist() == [100, 200 * SURVEY, 300 * FOOT]
    (tmp_path / "site.toml").write_text('[site]\nunit = "ft-us"\n[picks]\nfile = "p.csv"\nhorizon = "T"\nunit = "m"\n')
    assert read_site(tmp_path / "site.toml").horizons["T"].xyz[0].tolist() == [100, 200, 300]
    (tmp_path / "site.toml").write_text('[site]\nunit = "furlong"\n[picks]\nfile = "p.csv"\nhorizon = "T"\n')
    with pytest.raises(InputError, match="furlong"):
        read_site(tmp_path / "site.toml")


def test_a_grid_in_feet_is_projected_once(tmp_path):
    pytest.importorskip("pyproj", reason="projecting needs the extra 'gis'")
    xyz = []
    for header in ("x,y,z (m)", "x (ft-us),y (ft-us),z (m)"):
        (tmp_path / "p.csv").write_text(f"{header}\n{EAST},{NORTH},3\n{EAST + 9},{NORTH},4\n{EAST},{NORTH + 9},5\n")
        (tmp_path / "site.toml").write_text(
            '[site]\ncrs = "EPSG:32610"\n[picks]\nfile = "p.csv"\nhorizon = "T"\ncrs = "EPSG:2227"\n'
        )
        xyz.append(read_site(tmp_path / "site.toml").horizons["T"].xyz)
    assert np.abs(xyz[0] - xyz[1]).max() < 1e-6
    assert abs(xyz[0][1, 0] - xyz[0][0, 0] - 9 * SURVEY) < 0.01


def test_clouds_in_feet(tmp_path):
    rng = np.random.default_rng(1)
    feet = rng.uniform(0, 1000, (50, 3))
    (tmp_path / "c.csv").write_text(
        "x_ft,y_ft,z_ft\n" + "".join(",".join(map(repr, row)) + "\n" for row in feet.tolist())
    )
    assert np.concatenate(list(open_cloud(tmp_path / "c.csv").chunks())) == pytest.approx(feet * FOOT)
    pyarrow = pytest.importorskip("pyarrow", reason="Parquet needs the extra 'scale'")
    from pyarrow import parquet

    parquet.write_table(
        pyarrow.table({"x_ft": feet[:, 0], "y_ft": feet[:, 1], "z": feet[:, 2]}), tmp_path / "c.parquet"
    )
    cloud = open_cloud(tmp_path / "c.parquet")
    assert np.concatenate(list(cloud.chunks())) == pytest.approx(feet * [FOOT, FOOT, 1])
    assert [str(issue.reason) for issue in cloud.issues] == [
        "Lengths in feet, converted to metres (1 ft = 0.3048 m): x, y"
    ]
    stated = open_cloud(tmp_path / "c.parquet", unit="ft-us")
    assert np.concatenate(list(stated.chunks())) == pytest.approx(feet * SURVEY)
    with pytest.raises(InputError, match="furlong"):
        open_cloud(tmp_path / "c.parquet", unit="furlong")


@pytest.mark.parametrize(
    "row", [",(ftUS),(ftUS),(ft),(ft)", "ID,ftUS,US survey feet,ft,[ft]", "-,us-ft,ftUS,ft bgl,ft"]
)
def test_a_row_of_units_with_an_unknown_cell_is_one(tmp_path, row):
    body = "".join(f"T2,{EAST + 30 * k * k},{NORTH + 370 * k},{700 + k},1\n" for k in range(6))
    (tmp_path / "p.csv").write_text(f"horizon,x,y,z (NAVD88),accuracy\n{row}\n{body}")
    (tmp_path / "site.toml").write_text('[picks]\nfile = "p.csv"\n')
    site = read_site(tmp_path / "site.toml")
    np.testing.assert_allclose(site.horizons["T2"].xyz[0], [EAST * SURVEY, NORTH * SURVEY, 700 * FOOT])
    assert not [issue for issue in site.issues if issue.severity == "error"]


def test_an_unknown_unit_of_a_length_is_warned_of(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z\nm,m,fathoms\n1,2,3\n4,6,5\n9,7,7\n")
    (tmp_path / "site.toml").write_text('[picks]\nfile = "p.csv"\nhorizon = "T"\n')
    (issue,) = [issue for issue in read_site(tmp_path / "site.toml").issues if issue.severity == "warning"]
    assert (issue.reason.code, issue.column) == ("io.unit-of-column-unknown", "z")


def test_a_row_of_units_may_name_that_of_angles(tmp_path):
    (tmp_path / "c.csv").write_text("hole,x,y,z,depth\nB1,0,0,0,40\n")
    (tmp_path / "s.csv").write_text("hole,depth,azimuth,dip\n,m,gon,gon\nB1,0,100,50\nB1,40,100,50\n")
    paths = read_boreholes(tmp_path / "c.csv", tmp_path / "s.csv").paths
    np.testing.assert_allclose(paths["B1"].xyz[-1], [np.cos(np.pi / 4) * 40, 0, -np.sin(np.pi / 4) * 40], atol=1e-9)


def test_marks_that_are_no_unit_of_length():
    assert [unit_marked(mark) for mark in ("deg", "", "-", "kg", "ratio", "%")] == [None] * 6


@pytest.mark.parametrize("crs", [None, "EPSG:31468"])
def test_a_raster_that_states_feet_of_elevation_is_in_metres_whatever_its_system(crs, tmp_path):
    """Without a coordinate system the mark was ignored; with one, the note called it the unit of the system."""
    rasterio = pytest.importorskip("rasterio", reason="rasters need the extra gis")
    from geofit.io import Source
    from geofit.io.grid import load_ground
    from geofit.io.journal import Journal

    place = rasterio.Affine(100, 0, 4_500_000, 0, -100, 3_100_300)
    with rasterio.open(
        tmp_path / "a.tif", "w", driver="GTiff", height=2, width=2, count=1, dtype="float64", crs=crs, transform=place
    ) as raster:
        raster.write(np.full((2, 2), 1000.0), 1)
        raster.units = ("ft",)
    journal = Journal()
    ground = load_ground(Source(path=tmp_path / "a.tif"), journal)
    assert ground.z == pytest.approx(np.full((2, 2), 304.8))
    assert ground.x[0] == 4_500_050
    codes = [issue.reason.code for issue in journal.issues]
    assert "io.band-unit-converted" in codes
    assert "io.crs-unit-converted" not in codes

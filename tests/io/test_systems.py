"""Coordinate systems that files state themselves, and their units; marks for no data in grids."""

from __future__ import annotations

import json

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io import read_boundary, read_ground, read_site
from geofit.io.source import Source
from geofit.project.importing import import_files

FOOT = 1200 / 3937
#: New York Long Island in US survey feet, and two zones of one projection in metres.
FEET, METRES, NEXT_ZONE = "EPSG:2263", "EPSG:32618", "EPSG:32619"
EAST, NORTH = 980_000.0, 190_000.0


def write_points(path, xyz, crs):
    pyogrio = pytest.importorskip("pyogrio")
    shapely = pytest.importorskip("shapely")
    shapes = np.array([shapely.Point(*place) for place in xyz], dtype=object)
    pyogrio.raw.write(
        path, shapely.to_wkb(shapes, output_dimension=3), [np.array(["T2"] * len(shapes), dtype=object)], ["horizon"],
        geometry_type="Point Z", crs=crs,
    )  # fmt: skip


def write_raster(path, z, crs=None, nodata=None, unit=None, west=EAST, north=NORTH, **kept):
    rasterio = pytest.importorskip("rasterio")
    z = np.asarray(z)
    with rasterio.open(
        path, "w", driver="GTiff", height=z.shape[0], width=z.shape[1], count=1, dtype=z.dtype, crs=crs, nodata=nodata,
        transform=rasterio.Affine(10, 0, west, 0, -10, north),
    ) as raster:  # fmt: skip
        raster.write(z, 1)
        if unit:
            raster.units = (unit,)
        for key, value in kept.items():
            setattr(raster, key, (value,))
    return path


PLACES = [(EAST + 100 * k, NORTH + k * k, 100.0 + k) for k in range(5)]


@pytest.fixture
def site(tmp_path):
    """Return a function that reads a site of files in the folder of the test."""

    def read(text):
        (tmp_path / "site.toml").write_text(text, encoding="utf-8")
        return read_site(tmp_path / "site.toml")

    return read


def codes(issues, severity="warning"):
    return [issue.reason.code for issue in issues if issue.severity == severity]


@pytest.mark.parametrize(
    ("crs", "unit", "plan", "up", "listed"),
    [
        (FEET, "", FOOT, 1.0, ["io.crs-unit-converted"]),
        ("EPSG:2263+6360", "", FOOT, FOOT, []),
        (FEET, 'unit = "ft-us"', FOOT, FOOT, []),
        (METRES, "", 1.0, 1.0, []),
    ],
)
def test_a_map_counts_in_the_unit_of_its_system(site, tmp_path, crs, unit, plan, up, listed):
    pytest.importorskip("pyproj")
    write_points(tmp_path / "p.gpkg", PLACES, crs)
    found = site(f'[picks]\nfile = "p.gpkg"\n{unit}\n')
    np.testing.assert_allclose(found.horizons["T2"].xyz, np.array(PLACES) * (plan, plan, up), rtol=1e-12)
    assert codes(found.issues) == listed


def test_the_unit_of_a_system_goes_before_that_of_the_site(site, tmp_path):
    pytest.importorskip("pyproj")
    write_points(tmp_path / "p.gpkg", PLACES, METRES)
    found = site('[site]\nunit = "ft"\n[picks]\nfile = "p.gpkg"\n')
    np.testing.assert_allclose(found.horizons["T2"].xyz, np.array(PLACES) * (1, 1, 0.3048))


def test_a_map_of_a_site_in_feet_stays_in_its_place(site, tmp_path):
    pytest.importorskip("pyproj")
    write_points(tmp_path / "p.gpkg", PLACES, FEET)
    found = site(f'[site]\ncrs = "{FEET}"\n[picks]\nfile = "p.gpkg"\nunit = "ft-us"\n')
    np.testing.assert_allclose(found.horizons["T2"].xyz, FOOT * np.array(PLACES), rtol=1e-12)


@pytest.mark.parametrize(("mark", "up", "listed"), [(None, 1.0, 1), ("US survey foot", FOOT, 0), ("metre", 1.0, 0)])
def test_a_raster_counts_in_the_units_that_it_states(site, tmp_path, mark, up, listed):
    pytest.importorskip("pyproj")
    write_raster(tmp_path / "g.tif", np.full((3, 4), 200.0), FEET, unit=mark)
    found = site('[[grids]]\nfile = "g.tif"\nhorizon = "T2"\n')
    xyz = found.horizons["T2"].xyz
    np.testing.assert_allclose(xyz[0], [FOOT * (EAST + 5), FOOT * (NORTH - 5), up * 200], rtol=1e-12)
    assert codes(found.issues).count("io.crs-unit-converted") == listed


@pytest.mark.parametrize("second", ["map", "raster"])
def test_files_of_two_zones_are_warned_of_unless_the_site_names_its_own(site, tmp_path, second):
    pytest.importorskip("pyproj")
    west, south = 580_000.0, 4_500_000.0
    places = np.array([(west + 100 * k, south + k * k, 100.0 + k) for k in range(5)])
    write_points(tmp_path / "a.gpkg", places, METRES)
    write_points(tmp_path / "b.gpkg", places + np.array([0, 50, 0]), NEXT_ZONE)
    write_raster(tmp_path / "b.tif", np.full((3, 3), 5.0), NEXT_ZONE, west=west, north=south)
    files = '[[picks]]\nfile = "a.gpkg"\n'
    files += '[[picks]]\nfile = "b.gpkg"\n' if second == "map" else '[[grids]]\nfile = "b.tif"\nhorizon = "T2"\n'
    (mixed,) = [issue for issue in site(files).issues if issue.reason.code == "io.systems-mixed"]
    assert (mixed.severity, mixed.file) == ("warning", "b.gpkg [b]" if second == "map" else "b.tif")
    if second == "map":
        stated = site(f'[site]\ncrs = "{METRES}"\n{files}')
        assert "io.systems-mixed" not in codes(stated.issues)
        assert np.ptp(stated.horizons["T2"].xyz[:, 0]) > 400_000
    write_points(tmp_path / "b.gpkg", places + np.array([0, 50, 0]), METRES)
    write_raster(tmp_path / "b.tif", np.full((3, 3), 5.0), METRES, west=west, north=south)
    assert "io.systems-mixed" not in codes(site(files).issues)


@pytest.mark.parametrize(("crs", "code"), [("EPSG:99999", "io.crs-unknown"), ("EPSG:4326", "io.target-not-projected")])
def test_a_site_of_an_unknown_system_or_of_degrees_is_refused(site, tmp_path, crs, code):
    pytest.importorskip("pyproj")
    (tmp_path / "p.csv").write_text("horizon,x,y,z\n" + "".join(f"T2,{x},{y},{z}\n" for x, y, z in PLACES))
    with pytest.raises(InputError) as wrong:
        site(f'[site]\ncrs = "{crs}"\n[picks]\nfile = "p.csv"\n')
    assert wrong.value.code == code
    with pytest.raises(InputError) as wrong:
        import_files([tmp_path / "p.csv"], tmp_path / "new.toml", crs=crs)
    assert wrong.value.code == code
    assert not (tmp_path / "new.toml").exists()


# GeoJSON


SQUARE = np.array([[0.0, 0.0], [900.0, 0.0], [900.0, 800.0], [0.0, 800.0]]) + np.array([EAST, NORTH])


def write_area(path, crs=None):
    polygon = {"type": "Polygon", "coordinates": [[*SQUARE.tolist(), SQUARE[0].tolist()]]}
    if crs:
        polygon["crs"] = {"type": "name", "properties": {"name": crs}}
    path.write_text(json.dumps(polygon), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("crs", "unit", "metres"),
    [(None, None, 1.0), (None, "ft", 0.3048), ("urn:ogc:def:crs:EPSG::2263", None, FOOT), (METRES, None, 1.0)],
)
def test_an_area_of_geojson_counts_in_its_unit(tmp_path, crs, unit, metres):
    pytest.importorskip("pyproj")
    area = read_boundary(Source(path=write_area(tmp_path / "b.geojson", crs), unit=unit))
    np.testing.assert_allclose(area, metres * SQUARE, rtol=1e-12)


@pytest.mark.parametrize("target", ["", METRES])
def test_geojson_in_metres_is_imported(tmp_path, target):
    pytest.importorskip("pyogrio")
    (tmp_path / "p.csv").write_text("horizon,x,y,z\n" + "".join(f"T2,{x},{y},{z}\n" for x, y, z in PLACES))
    found = import_files(
        [tmp_path / "p.csv", write_area(tmp_path / "b.geojson")], tmp_path / "site.toml", crs=target
    )  # fmt: skip
    assert not codes(found.issues, "error")
    assert found.site.boundary is not None
    assert {tuple(corner) for corner in found.site.boundary.tolist()} == set(map(tuple, SQUARE.tolist()))


# Marks for no data


@pytest.mark.parametrize("huge", [-3.4028234663852886e38, 3.4028234663852886e38, 1e30, -1e32])
def test_huge_nodes_have_no_data(tmp_path, huge):
    z = np.array([[1.0, 2.0], [3.0, huge]], dtype=np.float32)
    rows = "\n".join(" ".join(f"{value:.9g}" for value in row) for row in z)
    head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    (tmp_path / "g.asc").write_text(head + rows)
    (tmp_path / "g.grd").write_text("DSAA\n2 2\n0 10\n0 10\n1 6\n" + rows)
    for path in (write_raster(tmp_path / "g.tif", z), tmp_path / "g.asc", tmp_path / "g.grd"):
        found = read_ground(path).z
        assert (np.isnan(found).sum(), np.nanmax(found)) == (1, 3.0)


@pytest.mark.parametrize(("mark", "nodata", "warned"), [(-32768, None, 1), (-32767, None, 1), (-32768, -32768, 0)])
def test_nodes_that_may_have_no_data_are_warned_of(site, tmp_path, mark, nodata, warned):
    write_raster(tmp_path / "g.tif", np.array([[1, 2], [3, mark]], dtype=np.int16), nodata=nodata)
    found = site('[[grids]]\nfile = "g.tif"\nhorizon = "T2"\n')
    assert codes(found.issues).count("io.nodes-look-blank") == warned
    assert len(found.horizons["T2"]) == (4 if warned else 3)


def test_scale_and_offset_of_a_raster_are_applied(tmp_path):
    z = np.array([[1000, 2000], [3000, -9999]], dtype=np.int16)
    path = write_raster(tmp_path / "g.tif", z, nodata=-9999, scales=0.1, offsets=50.0)
    np.testing.assert_allclose(read_ground(path).z, [[350, np.nan], [150, 250]])

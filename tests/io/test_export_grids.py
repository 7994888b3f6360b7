"""Grids read back by rasterio (GDAL) and by the own reader."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.site import Ground
from geofit.io.export.grids import write_esri, write_geotiff, write_surfer
from geofit.io.grid import read_ground

WRITERS = {"a.asc": write_esri, "a.grd": write_surfer, "a.tif": write_geotiff}


def sample(rows=7, columns=5, step=2.5):
    x, y = 500000 + step * np.arange(columns), 3100000 + step * np.arange(rows)
    z = 400 + np.random.default_rng(1).normal(0, 30, (rows, columns))
    z[0, 0] = z[3, 4] = np.nan
    return Ground(x, y, z)


@pytest.mark.parametrize("name", WRITERS)
def test_gdal_reads_the_same_values_at_the_same_places(name, tmp_path):
    rasterio = pytest.importorskip("rasterio")
    grid = sample()
    WRITERS[name](grid, tmp_path / name)
    with rasterio.open(tmp_path / name) as file:
        z = file.read(1, masked=True).filled(np.nan)[::-1]
        placed = file.transform
        assert (placed.c, placed.f) == pytest.approx((grid.x[0] - 1.25, grid.y[-1] + 1.25), abs=1e-6)
        assert (placed.a, placed.e) == pytest.approx((2.5, -2.5), abs=1e-9)
    if name == "a.grd":
        z = np.where(z > 1e38, np.nan, z)
    assert np.array_equal(np.isnan(z), np.isnan(grid.z))
    assert np.nanmax(np.abs(z - grid.z)) <= (0 if name == "a.tif" else 6e-5)


def test_geotiff_carries_the_coordinate_system(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    write_geotiff(sample(), tmp_path / "a.tif", "EPSG:32648")
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.crs.to_epsg() == 32648
        assert np.isnan(file.nodata)
    with pytest.raises(InputError, match="coordinate system is unknown"):
        write_geotiff(sample(), tmp_path / "b.tif", "EPSG:0")
    assert not (tmp_path / "b.tif").exists()


values = st.one_of(st.floats(-9000, 9000), st.just(np.nan))


@pytest.mark.parametrize("name", ["any.asc", "any.grd"])
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    shape=st.tuples(st.integers(2, 6), st.integers(2, 6)),
    start=st.tuples(st.integers(-(10**7), 10**7), st.integers(-(10**7), 10**7)),
    step=st.integers(1, 10**6).map(lambda n: n / 1000),
    data=st.data(),
)
def test_any_text_grid_comes_back_through_the_own_reader(name, shape, start, step, data, tmp_path):
    rows, columns = shape
    z = np.array(data.draw(st.lists(values, min_size=rows * columns, max_size=rows * columns))).reshape(shape)
    if not np.isfinite(z).any():
        z[0, 0] = 1.0
    grid = Ground(start[0] + step * np.arange(columns), start[1] + step * np.arange(rows), z)
    WRITERS[name.replace("any", "a")](grid, tmp_path / name)
    back = read_ground(tmp_path / name)
    assert np.abs(back.x - grid.x).max() < 1e-6
    assert np.abs(back.y - grid.y).max() < 1e-6
    assert np.array_equal(np.isnan(back.z), np.isnan(z))
    assert np.nanmax(np.abs(back.z - z)) <= 5.1e-5


@pytest.mark.parametrize("name", WRITERS)
def test_same_grid_same_bytes_and_no_other_file(name, tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    for folder in ("one", "two"):
        WRITERS[name](sample(), tmp_path / folder / name)
        assert [p.name for p in (tmp_path / folder).iterdir()] == [name]
    assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


@pytest.mark.parametrize("name", WRITERS)
def test_an_empty_grid_is_refused(name, tmp_path):
    grid = sample()
    with pytest.raises(InputError, match="No cell"):
        WRITERS[name](Ground(grid.x, grid.y, np.full_like(grid.z, np.nan)), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_cells_that_are_not_square_are_refused(tmp_path):
    grid = sample()
    with pytest.raises(InputError, match="square"):
        write_esri(Ground(grid.x, grid.y * 2, grid.z), tmp_path / "a.asc")


def test_without_rasterio_the_install_line_is_told(monkeypatch, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "rasterio", None)
    with pytest.raises(MissingDependencyError, match=r"pip install \"geofit-geology\[gis\]\""):
        write_geotiff(sample(), tmp_path / "a.tif")

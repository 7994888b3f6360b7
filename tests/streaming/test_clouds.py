"""A cloud that is streamed: the surface, the figures and the files are those of points held in memory."""

from __future__ import annotations

import json

import numpy as np
import pytest
from truth import EASTING, NORTHING, hills

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data import long_arrays
from geofit.data.errors import Cancelled, FitError, InputError, PointsError
from geofit.data.long_arrays import LongArray, without
from geofit.fitting import density
from geofit.fitting.conflicts import resolve_conflicts
from geofit.io import clouds
from geofit.io.clouds import is_cloud, open_cloud
from geofit.prediction.examine import examine
from geofit.project.cloud_run import run_cloud
from geofit.streaming import coincident as strips
from geofit.streaming import residuals
from geofit.streaming.fit import fit_cloud
from geofit.streaming.residuals import measure
from geofit.streaming.spool import spooled

N = 30_000


def cloud(n=N, seed=0, noise=0.05, size=(900.0, 600.0)):
    rng, height = np.random.default_rng(seed), hills(seed)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + size[0], NORTHING + size[1]), (n, 2))
    return np.round(np.column_stack([xy, height(*xy.T) + rng.normal(0, noise, n)]), 4)


@pytest.fixture
def small_blocks(monkeypatch):
    """Make blocks, strips and parts so small that some thousand points fill several."""
    from geofit.data import long_arrays

    monkeypatch.setattr(long_arrays, "BLOCK", 7_001)
    monkeypatch.setattr("geofit.fitting.field.BLOCK", 7_001)
    monkeypatch.setattr(density, "CLOUD", 1_000)
    monkeypatch.setattr("geofit.fitting.periphery.CLOUD", 1_000)
    monkeypatch.setattr(strips, "STRIP", 4_000)
    monkeypatch.setattr(residuals, "PART", 8_000)
    monkeypatch.setattr(residuals, "STEP", 3_000)
    monkeypatch.setattr(clouds, "CHUNK", 5_000)
    monkeypatch.setattr(clouds, "PIECE", 100_000)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("bounded", [False, True])
def test_the_surface_and_its_figures_are_those_of_points_in_memory(small_blocks, tmp_path, seed, bounded):
    xyz = cloud(seed=seed)
    xyz[5] = xyz[20_000] + (0.003, 0.002, 0.4)
    xyz[29_000] = xyz[20_000] + (0.0, 0.001, -0.1)
    around = np.array([[-50, -20], [800, -300], [1100, 650], [200, 900]])
    corners = np.add(around, (EASTING, NORTHING)) if bounded else None
    settings = FitSettings(epsilon=0.2)
    whole = fit_horizon(PointSet(xyz), settings, corners)
    spool = spooled((xyz[k : k + 3_000] for k in range(0, N, 3_000)), tmp_path, "a")
    fit = fit_cloud(spool.xyz(), settings, corners)
    assert len(fit.coincident) == len(whole.accuracy.conflicts) > 0
    assert np.array_equal(fit.surface.origin, whole.origin)
    for one, other in zip(fit.surface.patches, whole.patches, strict=True):
        assert np.abs(one.control - other.control).max() < 1e-9
        assert np.array_equal(one.knots_u, other.knots_u)
    found = measure(spool, fit.surface, 0.1, 0.2, fit.field.noise, workers=1)
    assert found.sigma == pytest.approx(whole.accuracy.sigma, abs=1e-9)
    assert found.mean == pytest.approx(whole.accuracy.mean, abs=1e-9)
    assert found.residuals.worst[:, 0].astype(int).tolist() == list(whole.accuracy.worst)
    assert found.residuals.over[0] == whole.accuracy.over["interior_tolerance"].count
    assert found.residuals.histogram.sum() == found.residuals.cells[..., 0].sum() == N
    held = measure(xyz, fit.surface, 0.1, 0.2, fit.field.noise)
    assert held.sigma == found.sigma
    assert held.residuals.worst.tobytes() == found.residuals.worst.tobytes()


@pytest.mark.parametrize("seed", range(4))
def test_coincident_points_give_way_as_in_memory(small_blocks, tmp_path, seed):
    rng = np.random.default_rng(seed)
    plane = np.round(rng.uniform(0, (60, 40), (20_000, 2)), 2)
    points = PointSet(np.column_stack([plane, rng.normal(size=len(plane))]))
    for distance in (0.01, 0.0301, 0.2):
        kept, _ = resolve_conflicts(points, plane, points.xyz[:, 2], distance)
        assert strips.coincident(plane, distance, tmp_path).tolist() == np.flatnonzero(~kept).tolist()


def test_rows_without_some_are_read_in_any_slices():
    rng = np.random.default_rng(0)
    rows = np.arange(1000.0)
    gone = np.sort(rng.choice(1000, 300, replace=False))
    left, expected = without(rows, gone), np.delete(rows, gone)
    assert len(left) == 700
    for start, stop in ((0, 700), (0, 1), (699, 900), (13, 444), (400, 400)):
        assert left[start:stop].tolist() == expected[start:stop].tolist()


def write(path, xyz):
    match path.suffix:
        case ".csv":
            np.savetxt(path, xyz, "%.4f", delimiter=",", header="x,y,z", comments="")
        case ".parquet":
            pa = pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra scale)")
            from pyarrow import parquet

            table = pa.table(dict(zip(("Easting", "Northing", "Elevation"), xyz.T, strict=True)))
            parquet.write_table(table, path, row_group_size=7_000)
        case _:
            laspy = pytest.importorskip("laspy", reason="laspy is not installed (extra scale)")
            pytest.importorskip("lazrs", reason="lazrs is not installed (extra scale)")
            header = laspy.LasHeader(point_format=0, version="1.2")
            header.offsets, header.scales = np.floor(xyz.min(axis=0)), [1e-4] * 3
            data = laspy.LasData(header)
            data.x, data.y, data.z = xyz.T
            data.write(path)
    return path


@pytest.mark.parametrize("name", ["c.csv", "c.parquet", "c.las", "c.laz"])
def test_every_format_gives_the_points_in_order(small_blocks, tmp_path, name):
    xyz = cloud(12_000)
    found = open_cloud(write(tmp_path / name, xyz))
    assert is_cloud(found.path) == (name != "c.csv")
    parts = list(found.chunks())
    assert len(parts) > 1
    assert np.abs(np.concatenate(parts) - xyz).max() < 1e-8
    assert found.total in (None, len(xyz))


def test_a_run_leaves_its_files_and_goes_on_after_a_stop(small_blocks, tmp_path):
    xyz = cloud(26_000)
    source = write(tmp_path / "scan.csv", xyz)
    lines = source.read_text().split("\n")
    lines[9_000] = "1,2,?"
    source.write_text("\n".join(lines))
    whole = run_cloud(open_cloud(source), tmp_path / "whole", workers=1)
    stages: list[str] = []

    def until(limit):
        def listen(stage, fraction):
            stages.append(str(stage))
            return fraction < limit

        return listen

    out = tmp_path / "stopped"
    for limit in (0.2, 0.5, 0.7):
        with pytest.raises(Cancelled):
            run_cloud(open_cloud(source), out, progress=until(limit), workers=1)
    assert not (out / "scan.step").exists()
    measured = sorted(path.name for path in (out / "scan_distances").glob("*.json"))
    assert measured
    before = {name: (out / "scan_distances" / name).stat().st_mtime_ns for name in measured}
    again = run_cloud(open_cloud(source), out, workers=1)
    assert {name: (out / "scan_distances" / name).stat().st_mtime_ns for name in measured} == before
    assert again.accuracy.sigma == whole.accuracy.sigma
    for name in ("scan.step", "scan_deviations.csv", "scan_worst.csv", "scan_import_issues.csv"):
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    figures = json.loads((out / "scan.json").read_text(encoding="utf-8"))
    assert figures["n"] == 25_999
    assert not (out / "scan_state").exists()
    assert "residuals" in stages


def test_distances_of_every_point_are_written(small_blocks, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed (extra scale)")
    xyz = cloud(20_000)
    done = run_cloud(open_cloud(write(tmp_path / "scan.parquet", xyz)), tmp_path, workers=2)
    parts = [path for path in done.files if path.suffix == ".parquet"]
    table = parquet.read_table([str(path) for path in parts])
    assert table.column("point").to_pylist() == list(range(len(xyz)))
    expected = done.fit.surface.distance(xyz)
    assert np.abs(table.column("distance").to_numpy() - expected).max() < 1e-12


def test_bad_rows_of_a_streamed_table_are_listed_with_their_lines(small_blocks, tmp_path):
    lines = [
        "# scanner 7",
        "E;N;H;name",
        *(f"{1000 + i % 90},5;{2000 + i // 90},25;{i % 7},0;T1" for i in range(9_000)),
    ]
    for k in (100, 4_000, 8_999):
        lines[k] = "12,5;x;3;T1"
    lines[5_000] = "1;2;3;T1;too;many"
    path = tmp_path / "t.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    found = open_cloud(path, {"x": "E", "y": "N", "z": "H"})
    points = np.concatenate(list(found.chunks()))
    assert len(points) == found.used == 8_996
    assert found.read == 9_000
    assert [issue.row for issue in found.issues if issue.severity == "error"] == [101, 4_001, 5_001, 9_000]


def test_a_streamed_table_of_several_horizons_needs_a_name(small_blocks, tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("x,y,z,horizon\n" + "".join(f"{i % 70},{i // 70},{i % 5},{'AB'[i % 2]}\n" for i in range(9_000)))
    with pytest.raises(InputError) as error:
        list(open_cloud(path).chunks())
    assert error.value.code == "io.cloud-of-several-horizons"
    points = np.concatenate(list(open_cloud(path, horizon="B").chunks()))
    assert len(points) == 4_500


def test_errors_say_what_is_wrong(tmp_path):
    with pytest.raises(PointsError):
        fit_cloud(np.zeros((3, 3)))
    bad = cloud(500)
    bad[77, 2] = np.nan
    with pytest.raises(PointsError, match="77"):
        fit_cloud(bad)
    with pytest.raises(FitError):
        fit_cloud(cloud(500), FitSettings(frame="sections"))
    broken = tmp_path / "b.laz"
    broken.write_bytes(b"LASF" + b"\0" * 50)
    pytest.importorskip("laspy", reason="laspy is not installed (extra scale)")
    with pytest.raises(InputError):
        open_cloud(broken)


def test_a_steep_cloud_is_fitted_over_its_best_plane(small_blocks):
    xyz = cloud(25_000, noise=0.02)
    turned = np.column_stack([xyz[:, 2] - 500, xyz[:, 1] - NORTHING, 2 * (xyz[:, 0] - EASTING)])
    fit, whole = fit_cloud(turned), fit_horizon(PointSet(turned))
    assert fit.surface.frame == whole.frame == "best-plane"
    assert np.abs(fit.surface.distance(turned) - whole.accuracy.residuals).max() < 1e-9


def test_arrays_that_are_made_when_read_cost_no_memory():
    made = []

    def read(start, stop):
        made.append(stop - start)
        return cloud(5_000)[start:stop]

    assert fit_cloud(LongArray((5_000, 3), read)).n == 5_000
    assert len(made) > 3


def test_every_so_many_rows_of_a_long_array_are_those_of_the_array(monkeypatch):
    monkeypatch.setattr(long_arrays, "BLOCK", 7)
    whole = np.arange(60.0).reshape(30, 2)
    rows = LongArray(whole.shape, lambda start, stop: whole[start:stop])
    for step in (1, 2, 3, 5, 11, 40):
        for start in (0, 4):
            np.testing.assert_array_equal(rows[start:29:step], whole[start:29:step])
            np.testing.assert_array_equal(rows[:, ::-1][start::step], whole[:, ::-1][start::step])


def test_a_cloud_in_memory_is_examined_and_can_have_a_core(monkeypatch):
    monkeypatch.setattr("geofit.fitting.periphery.CLOUD", 1_000)
    xyz = cloud(5_000)
    found = examine(fit_horizon(PointSet(xyz)))
    assert found.left_out[0].groups == 5_000
    assert found.left_out[0].rms < 0.2
    low = xyz[:, :2].min(axis=0) + 200.0
    core = tuple((float(low[0] + a), float(low[1] + b)) for a, b in ((0, 0), (60, 0), (60, 60), (0, 60)))
    drawn = fit_horizon(PointSet(xyz), FitSettings(core=core))
    assert drawn.core.any()
    assert np.abs(drawn.accuracy.residuals[drawn.core]).max() < 1e-6


def test_dips_are_compared_with_the_surface_of_a_cloud(tmp_path, monkeypatch, capsys):
    from geofit.cli.main import main

    rng = np.random.default_rng(4)
    xy = rng.uniform(0, 400, (3000, 2))

    def plane(x, y):
        return 100 + 0.3 * x - 0.1 * y

    z = plane(*xy.T) + rng.normal(0, 0.02, len(xy))
    rows = (f"{x:.3f},{y:.3f},{h:.4f}\n" for (x, y), h in zip(xy, z, strict=True))
    (tmp_path / "scan.csv").write_text("x,y,z\n" + "".join(rows))
    dip, azimuth = np.degrees(np.arctan(np.hypot(0.3, 0.1))), np.degrees(np.arctan2(-0.3, 0.1)) % 360
    places = rng.uniform(50, 350, (6, 2))
    steep = [dip] * 5 + [dip + 45]
    (tmp_path / "dips.csv").write_text(
        "x,y,z,dip,azimuth\n"
        + "".join(
            f"{x:.2f},{y:.2f},{plane(x, y):.2f},{d:.2f},{azimuth:.2f}\n"
            for (x, y), d in zip(places, steep, strict=True)
        )
    )
    arguments = [
        "fit",
        tmp_path / "scan.csv",
        "--stream",
        "--out",
        tmp_path / "o",
        "--orientations",
        tmp_path / "dips.csv",
    ]
    monkeypatch.setattr("sys.argv", ["geofit", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert "dip" in capsys.readouterr().err
    found = json.loads((tmp_path / "o" / "scan.json").read_text("utf-8"))["dips"]
    angles = [one["angle"] for one in found["measured"]]
    assert max(angles[:5]) < 1.5
    assert angles[5] == pytest.approx(45, abs=1.5)
    assert found["check"]["passed"] is False
    assert found["check"]["value"] == pytest.approx(angles[5])

    # Dips as data of the fit need the points in the memory; that is refused, not ignored.
    monkeypatch.setattr("sys.argv", ["geofit", *map(str, arguments), "--dips", "fit"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert "--dips is not for clouds" in capsys.readouterr().err

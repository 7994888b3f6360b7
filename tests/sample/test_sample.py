"""The sample site: its files against its truth, read by the ordinary readers."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import geofit
from geofit.sample import __main__ as command
from geofit.sample import horizon_truth, write_site
from geofit.sample.observations import NOISE
from geofit.sample.paths import borehole_path, crossings, polyline_path
from geofit.sample.truth import (
    BOUNDARY,
    CORE,
    HORIZONS,
    FoldTruth,
    MapTruth,
    PlaneTruth,
    ground,
    in_study_area,
    to_map,
    to_site,
)

Floats = NDArray[np.float64]

COMMITTED = Path(__file__).parents[2] / "sample_data"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, int]]:
    folder = tmp_path_factory.mktemp("sample")
    return folder, write_site(folder)


@pytest.fixture(scope="module")
def site(written: tuple[Path, dict[str, int]]) -> geofit.Site:
    return geofit.io.read_site(written[0] / "site.toml")


def _files(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_committed_folder_is_what_the_generator_writes(written: tuple[Path, dict[str, int]]) -> None:
    new, old = _files(written[0]), _files(COMMITTED)
    assert sorted(new) == sorted(old), "Run python -m geofit.sample sample_data, and remove what it does not write."
    different = [name for name in new if new[name] != old[name]]
    assert not different, "Run python -m geofit.sample sample_data and commit it."
    assert sum(map(len, old.values())) < 2e6


def test_every_row_is_used_and_every_horizon_has_its_points(
    written: tuple[Path, dict[str, int]], site: geofit.Site
) -> None:
    assert {name: len(points) for name, points in site.horizons.items()} == written[1]
    assert tuple(site.horizons) == HORIZONS
    assert len(site.horizons["T2-T1"]) == 597
    assert all(60 <= n <= 400 for name, n in written[1].items() if name != "T2-T1")
    assert not [issue for issue in site.issues if issue.severity == "error"]
    for count in site.counts:
        assert count.listed == 0, count
        assert count.read == count.used, count
    assert {"C1.dxf", "C8.csv", "风化.csv"} <= {Path(count.file).name for count in site.counts}
    assert len(site.sections) == 11
    assert sum(hole.kind == "borehole" for hole in site.holes) == 60
    assert sum(hole.kind == "adit" for hole in site.holes) == 4


@pytest.mark.parametrize("name", HORIZONS)
def test_imported_points_lie_on_the_truth_within_their_noise(site: geofit.Site, name: str) -> None:
    points = site.horizons[name]
    noise = np.array([NOISE[kind] for kind in points.kind])
    error = horizon_truth(name).offset(points.xyz)
    assert np.abs(error / noise).max() < 4.0
    # There is noise, and no source is off as a whole (collar, dip sign, half a cell of the ground grid).
    for kind in np.unique(points.kind):
        of_kind = error[points.kind == kind]
        if len(of_kind) > 25:
            assert 0.5 * NOISE[kind] < of_kind.std() < 1.3 * NOISE[kind]
            assert abs(of_kind.mean()) < 4 * NOISE[kind] / np.sqrt(len(of_kind))
    assert np.allclose(points.accuracy, np.where(noise > 0.05, 0.1, 0.03))


def test_the_597_points_are_a_dense_core_and_a_sparse_periphery_west_and_east(site: geofit.Site) -> None:
    points = site.horizons["T2-T1"]
    s, t = to_site(points.xyz[:, 0], points.xyz[:, 1])
    core = (s > CORE[0] - 8) & (s < CORE[1] + 8)
    assert core.sum() == 440
    assert set(points.kind[core]) == {"section", "borehole"}
    assert set(points.kind[~core]) == {"borehole", "outcrop", "geophysics"}
    assert (~core & (s < CORE[0])).sum() > 60
    assert (~core & (s > CORE[1])).sum() > 50
    assert t[core].min() < -600 < 600 < t[core].max()
    spacing = cKDTree(points.xyz[:, :2]).query(points.xyz[:, :2], k=5)[0][:, 4]
    assert np.median(spacing[core]) < 0.6 * np.median(spacing[~core])


@pytest.mark.parametrize("name", HORIZONS)
def test_no_two_points_contradict_each_other(site: geofit.Site, name: str) -> None:
    xyz = site.horizons[name].xyz
    size = 2 if name in ("T3-T2", "T2-T1", "W") else 3
    nearest = cKDTree(xyz[:, :size]).query(xyz[:, :size], k=2)[0][:, 1]
    assert nearest.min() > 5.0
    assert in_study_area(xyz[:, 0], xyz[:, 1]).all()


def test_horizons_are_in_geological_order() -> None:
    x, y = horizon_truth("T2-T1").places(20_000)[:, :2].T
    truths = [horizon_truth(name) for name in ("T3-T2", "T2-T1", "W")]
    upper, lower, limit = (truth.height(x, y) for truth in truths if isinstance(truth, MapTruth))
    assert (upper - lower).min() > 40.0
    assert (ground(x, y) - limit).min() > 10.0
    assert horizon_truth("T2-T1").offset(horizon_truth("M1").places(5000)).max() < -20.0
    assert np.abs(horizon_truth("F1").offset(horizon_truth("M1").places(5000))).min() > 30.0


def test_holes_start_on_the_ground_and_their_logs_tile_them(
    written: tuple[Path, dict[str, int]], site: geofit.Site
) -> None:
    folder = written[0]
    with (folder / "collar.csv").open(encoding="utf-8-sig") as stream:
        collars = {row["孔号"]: row for row in csv.DictReader(stream)}
    assert site.ground is not None
    for row in collars.values():
        x, y, z = (float(row[key]) for key in ("坐标X", "坐标Y", "孔口高程"))
        assert z == pytest.approx(float(site.ground.elevation(np.array(x), np.array(y))), abs=0.006)
    for file, encoding, sep, names in (
        ("lithology.csv", "utf-8", ",", ("hole_id", "from", "to")),
        ("风化.csv", "gb18030", ",", ("孔号", "起始深度", "终止深度")),
        ("structures.csv", "utf-8", ";", ("hole_id", "from", "to")),
    ):
        end: dict[str, float] = {}
        with (folder / file).open(encoding=encoding) as stream:
            for row in csv.DictReader(stream, delimiter=sep):
                hole, top, base = row[names[0]], *(float(row[name].replace(",", ".")) for name in names[1:])
                assert top == end.get(hole, 0.0)
                assert base > top
                end[hole] = base
        assert end == {hole: float(row["孔深"]) for hole, row in collars.items()}


def test_the_files_are_as_varied_as_real_ones(written: tuple[Path, dict[str, int]]) -> None:
    files = _files(written[0])
    assert files["collar.csv"].startswith("\ufeff孔号".encode())
    with pytest.raises(UnicodeDecodeError):
        files["风化.csv"].decode("utf-8")
    assert files["风化.csv"].decode("gb18030").startswith("孔号")
    assert b";" in files["structures.csv"]
    assert b"." not in files["structures.csv"]
    stations = [line.split(",") for line in files["survey.csv"].decode().splitlines()[1:]]
    dips = {hole: [float(row[3]) for row in stations if row[0] == hole] for hole in {row[0] for row in stations}}
    assert sum(60 < d[0] < 70 for d in dips.values()) == 8
    assert sum(len(set(d)) > 2 for d in dips.values()) >= 15
    assert len(dips) < 60


def test_some_holes_pierce_the_fold_twice(site: geofit.Site) -> None:
    points = site.horizons["M1"]
    holes, times = np.unique(points.hole[points.kind == "borehole"], return_counts=True)
    assert (times == 2).sum() >= 4, dict(zip(holes, times, strict=True))


def test_the_fold_is_no_height_over_any_plane() -> None:
    fold = horizon_truth("M1")
    assert isinstance(fold, FoldTruth)
    for s in np.linspace(CORE[0], CORE[1], 8):
        xyz = fold.point(np.array(s), np.linspace(-1, 1, 400))
        _, t = to_site(xyz[:, 0], xyz[:, 1])
        angle = np.unwrap(np.arctan2(np.diff(xyz[:, 2]), np.diff(t)))
        assert np.ptp(angle) > np.radians(200.0)


def test_the_fault_is_a_height_over_its_best_plane_only() -> None:
    fault = horizon_truth("F1")
    assert isinstance(fault, PlaneTruth)
    xyz = fault.places(4000)
    _, _, axes = np.linalg.svd(xyz - xyz.mean(axis=0), full_matrices=False)
    dip = np.degrees(np.arccos(abs(axes[2, 2])))
    assert 65.0 < dip < 80.0
    u, v, _ = fault.local(xyz).T
    step = 1e-3
    across_u = fault.point(u + step, v) - fault.point(u - step, v)
    across_v = fault.point(u, v + step) - fault.point(u, v - step)
    normal = np.cross(across_u, across_v)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert normal[:, 2].min() < 0 < normal[:, 2].max()
    assert np.degrees(np.arccos(np.abs(normal @ axes[2]))).max() < 25.0


@pytest.mark.parametrize("name", HORIZONS)
def test_places_lie_on_the_truth_in_the_study_area(name: str) -> None:
    truth = horizon_truth(name)
    for core in (False, True):
        xyz = truth.places(3000, core=core)
        assert xyz.shape == (3000, 3)
        assert np.abs(truth.offset(xyz)).max() < 1e-6
        assert in_study_area(xyz[:, 0], xyz[:, 1]).all()
        assert (xyz[:, 2] < ground(xyz[:, 0], xyz[:, 1])).all()
        assert np.array_equal(xyz, truth.places(3000, core=core))
    s, _ = to_site(xyz[:, 0], xyz[:, 1])
    assert CORE[0] - 1e-6 <= s.min() < CORE[0] + 20
    assert CORE[1] - 20 < s.max() <= CORE[1] + 1e-6


def test_the_folds_distance_is_that_of_a_point_moved_along_the_normal() -> None:
    fold = horizon_truth("M1")
    assert isinstance(fold, FoldTruth)
    rng = np.random.default_rng(5)
    s, p = rng.uniform(820, 1180, 500), rng.uniform(-0.9, 0.9, 500)
    along = fold.point(s + 1e-3, p) - fold.point(s - 1e-3, p)
    around = fold.point(s, p + 1e-6) - fold.point(s, p - 1e-6)
    normal = np.cross(along, around)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    offset = fold.offset(fold.point(s, p) + 0.5 * normal)
    assert np.abs(np.abs(offset) - 0.5).max() < 1e-3
    assert abs(np.sign(offset).sum()) == len(offset)


def test_minimum_curvature_follows_a_circle() -> None:
    radius = 400.0
    turned = np.array([0.0, 20.0, 45.0, 70.0])
    stations = np.column_stack([radius * np.radians(turned), np.full(4, 30.0), 90.0 - turned])
    path = borehole_path(np.array([5e5, 3.1e6, 1500.0]), stations)
    depth = np.linspace(0.0, stations[-1, 0], 60)
    angle = depth / radius
    away, down = radius * (1 - np.cos(angle)), radius * np.sin(angle)
    expected = np.column_stack([5e5 + away * 0.5, 3.1e6 + away * np.sqrt(0.75), 1500.0 - down])
    assert np.abs(path(depth) - expected).max() < 1e-6


def test_crossings_are_found_in_order_and_no_jump_is_taken_for_one() -> None:
    path = polyline_path(np.array([[0.0, 0, 0], [100.0, 0, 0]]))
    assert crossings(path, 100.0, lambda xyz: (xyz[:, 0] - 20.3) * (xyz[:, 0] - 71.8) / 100) == pytest.approx(
        [20.3, 71.8], abs=1e-8
    )
    assert crossings(path, 100.0, lambda xyz: np.where(xyz[:, 0] < 50.1, -1.0, 1.0)) == []


def test_site_axes_go_there_and_back() -> None:
    s, t = np.array([0.0, 1000.0, 1990.0]), np.array([-600.0, 0.0, 500.0])
    assert np.allclose(to_site(*to_map(s, t)), (s, t), atol=1e-8)
    assert 4.9e5 < BOUNDARY[:, 0].min() < 5.1e5
    assert 3.09e6 < BOUNDARY[:, 1].min() < 3.11e6
    assert np.ptp(BOUNDARY, axis=0) == pytest.approx((2000.0, 1600.0), rel=0.1)


def test_an_unknown_horizon_is_named_with_the_known_ones() -> None:
    with pytest.raises(geofit.GeofitError, match=r"no horizon 'T9'.*T2-T1"):
        horizon_truth("T9")


def test_the_command_writes_the_site(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["python -m geofit.sample", str(tmp_path / "new")])
    command.main()
    assert _files(tmp_path / "new") == _files(COMMITTED)
    assert "T2-T1   597 points" in capsys.readouterr().out

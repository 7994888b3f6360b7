"""The scripts in benchmarks/ import, and their pure functions are right. Nothing is timed here."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from geofit import FitSettings, HorizonFit, PointSet
from geofit.splines.bspline import clamped_knots
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.fixture
def load(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setattr(sys, "path", [*sys.path])
    before = set(sys.modules)
    yield importlib.import_module
    for name in set(sys.modules) - before:
        if name.split(".")[0] in {"real", "field", "fit", "distance", "realdata", "peers", "drawing"}:
            del sys.modules[name]


def plane(x, y):
    return 3.0 + 0.2 * x - 0.1 * y


def scattered(n=60, seed=1):
    xy = np.random.default_rng(seed).uniform(0, 100, (n, 2))
    return np.column_stack([xy, plane(*xy.T)])


@pytest.mark.parametrize("name", ["distance", "field", "fit", "real"])
def test_script_imports_and_can_be_run(load, name):
    assert callable(load(name).main)


def test_holes_and_places_stay_together_in_a_fold(load):
    score = load("realdata.score")
    xyz = np.column_stack([np.repeat(np.arange(40.0), 2), np.zeros(80), np.arange(80.0)])
    places = score.folds(PointSet(xyz))
    assert (places[::2] == places[1::2]).all()
    assert sorted(np.bincount(places)) == [8] * 10
    holes = score.folds(PointSet(scattered(), hole=np.repeat(np.arange(20), 3).astype(str)))
    assert (holes.reshape(20, 3) == holes.reshape(20, 3)[:, :1]).all()
    assert (score.folds(PointSet(xyz)) == places).all()


def test_peers_reproduce_a_plane_and_repeated_places_do_no_harm(load):
    score = load("realdata.score")
    xyz = scattered()
    repeated = np.concatenate([xyz, xyz[:5] + np.array([0, 0, 2.0]), xyz[:5] - np.array([0, 0, 2.0])])
    places = np.array([[40.0, 50.0], [61.0, 33.0], [500.0, 500.0]])
    expected = plane(*places.T)
    assert score.thin_plate(repeated, places) == pytest.approx(expected, abs=1e-6)
    line = score.linear(repeated, places)
    assert line[:2] == pytest.approx(expected[:2], abs=1e-9)
    assert np.isnan(line[2])


def test_score_tells_bias_from_spread(load):
    score = load("realdata.score")
    assert score.score(np.array([3.0, 5.0])) == score.Score(pytest.approx(np.sqrt(17.0)), pytest.approx(1.0))
    assert np.isnan(score.score(np.array([])).rms)


def test_all_three_tools_are_compared_at_the_same_points(load):
    score = load("realdata.score")
    given, left_out = PointSet(scattered()), PointSet([[50, 50, plane(50, 50) + 1], [100, 100, plane(100, 100)]])
    errors = score.left_out_errors(given, left_out, FitSettings())
    assert (errors.left_out, errors.common, errors.defined) == (2, 1, 2)
    assert errors.line.rms == pytest.approx(1.0, abs=1e-9)
    assert errors.plate.rms == pytest.approx(1.0, abs=1e-6)
    assert errors.ours.rms == pytest.approx(1.0, abs=1e-3)
    assert errors.ours_all.rms == pytest.approx(np.sqrt(0.5), abs=1e-3)


def figures(load, ours, plate, ours_all=None, plate_all=None):
    score = load("realdata.score")
    values = (ours, plate, plate, ours_all or ours, plate_all or plate)
    return score.Errors(10, 9, 10, *(score.Score(v, v) for v in values))


@pytest.mark.parametrize(
    ("field", "stiffer", "softer", "words"),
    [
        (2.0, 5.0, 5.0, "bringing each point within its tolerance (or onto the core) costs it"),
        (3.0, 5.0, 5.0, "costs part of it; the regional field alone misses by 3.00 m"),
        (4.0, 2.5, 5.0, "smooths too little for these points: the regional field with ten times"),
        (4.0, 5.0, 2.5, "smooths too much for these points: the regional field with a tenth"),
        (4.0, 5.0, 4.5, "no smoothing helps"),
    ],
)
def test_the_reason_follows_from_the_trial(load, field, stiffer, softer, words):
    why = load("realdata.why")
    trial = why.Trial(*(figures(load, error, 2.0) for error in (field, stiffer, softer)), "smooth", "map")
    assert words in why.why(figures(load, 4.0, 2.0), trial)


def test_a_loss_beyond_the_hull_alone_is_told_as_such(load):
    why = load("realdata.why")
    errors = figures(load, 2.0, 2.0, 4.0, 2.0)
    assert why.worse(errors) == (False, True)
    trial = why.Trial(errors, errors, errors, "smooth", "map")
    assert why.why(errors, trial).startswith("only beyond the hull")


def test_the_page_names_a_set_that_failed(load):
    page = load("realdata.page")
    row = page.Row("Set: top", 7, FitSettings(), None, figures(load, 1.0, 1.0), None, "The points lie on one line.")
    text = page.markdown([row], [("Set", "all points")])
    assert "| Set: top | 7 | – | – | 0.5 | 0.1 | ERROR |" in str(text)
    assert "- **Set: top, 0.5 / 0.1 m**: The points lie on one line." in str(text)


def test_the_page_does_not_hold_seconds_that_change(load):
    page = load("realdata.page")
    texts = []
    for seconds in (0.4, 1.3):
        fitted = page.Fitted(5, 2, 0.1, "PASS", 70, seconds, ())
        row = page.Row("Set", 7, FitSettings(), fitted, figures(load, 1.0, 1.0), None)
        assert page.fit_cells(row, exact_seconds=True)[-1] == f"{seconds:.1f}"
        texts.append(page.markdown([row], []))
    assert texts[0] == texts[1]


def test_reference_p_spline_reproduces_a_plane(load):
    pspline = load("peers.pspline")
    spline = pspline.PSpline((0, 100, 0, 100), 8, 1e-3).fit(scattered(400))
    x, y = scattered(50, seed=2)[:, :2].T
    assert spline.elevation(x, y) == pytest.approx(plane(x, y), abs=1e-6)


def test_the_dense_process_finds_range_and_noise_of_its_own_field(load):
    gp = load("peers.gp")
    rng = np.random.default_rng(0)
    plane = rng.uniform(0, 10, (300, 2))
    true = gp.Process("Matérn 3/2", 1.5, 0.01, 1, 0.0)
    covariance = true.covariance(plane, plane) + 0.01 * np.eye(300)
    z = np.linalg.cholesky(covariance) @ rng.normal(size=300) + plane @ (0.3, -0.2)
    found = gp.fit_process(plane, z, "Matérn 3/2", 1)
    assert found.reach == pytest.approx(1.5, rel=0.5)
    assert found.nugget == pytest.approx(0.01, rel=0.8)
    mean, sd = found.predict(plane[:250], z[:250], plane[250:])
    assert 0.8 <= np.mean(np.abs(mean - z[250:]) <= 1.645 * sd) <= 1.0
    assert np.std(mean - z[250:]) < 0.5 * np.std(z[250:])


def test_the_dense_process_leaves_groups_out_as_if_they_had_never_been_there(load):
    gp = load("peers.gp")
    rng = np.random.default_rng(4)
    plane = rng.uniform(0, 10, (40, 2))
    z = np.sin(plane[:, 0]) + 0.2 * plane[:, 1] + rng.normal(0, 0.1, 40)
    process = gp.Process("Matérn 3/2", 3.0, 0.05, 1, 0.0)
    groups = [np.array([0, 1, 2]), np.array([7])]
    error, sd = process.left_out(plane, z, groups)
    for group in groups:
        rest = np.setdiff1d(np.arange(40), group)
        mean, alone = process.predict(plane[rest], z[rest], plane[group])
        assert error[group] == pytest.approx(z[group] - mean, abs=1e-9)
        # The sill is that of all points: one factor for the whole group, near 1.
        assert np.ptp(sd[group] / alone) < 1e-9
        assert 0.8 < (sd[group] / alone)[0] < 1.25
    assert np.isnan(error[3:7]).all()


def test_the_score_of_a_normal_distribution_is_its_definition(load):
    """The integral of (F(x) - 1 for x >= z)^2 over x."""
    crps = load("realdata.crps")
    x = np.linspace(-30, 30, 600_001)
    for error, sd in ((0.0, 1.0), (1.3, 0.5), (-4.0, 2.0)):
        share = np.exp(-0.5 * ((x - 0.0) / sd) ** 2).cumsum()
        share /= share[-1]
        assert crps.score_of(np.array([error]), np.array([sd])) == pytest.approx(
            float(((share - (x >= error)) ** 2).sum() * (x[1] - x[0])), rel=1e-3
        )
    assert np.isnan(crps.score_of(np.array([np.nan]), np.array([1.0])))


def test_sites_of_the_field_are_reproducible_and_lie_in_their_area(load):
    field = load("field")
    for seed in (0, 3, 6, 9):
        one, again = field.site(seed), field.site(seed)
        assert (one.points.xyz == again.points.xyz).all()
        x0, x1, y0, y1 = one.core
        x, y = one.points.xyz[one.points.section != "", :2].T
        assert ((x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)).all()
        assert np.std(one.points.xyz[:, 2] - one.height(*one.points.xyz[:, :2].T)) < 0.4


def test_smallest_size_within_a_limit(load):
    fit = load("fit")
    assert fit.smallest(lambda n: 1 / n, 0.1, range(2, 50, 4)) == 10
    assert fit.smallest(lambda n: abs(n - 21), 0.001, range(2, 50, 4)) == 22


def test_time_of_a_fit_leaves_out_the_check(load):
    fit = load("fit")
    knots = clamped_knots([0, 1], 1)
    patch = Patch("core", (1, 1), knots, knots, np.zeros((2, 2, 3)))
    surface = HorizonFit(PatchSurface((patch,), np.zeros(3)), PointSet(np.zeros((3, 3))))
    seconds = {"conflicts": 1.0, "field": 2.0, "check": 4.0, "adjust": 8.0}
    assert fit.fit_seconds(surface.with_(diagnostics={"seconds": seconds})) == 3.0


def test_without_data_real_says_so_and_exits_with_2(tmp_path):
    import os

    environment = os.environ | {"GEOFIT_DATA": str(tmp_path / "nowhere")}
    run = subprocess.run(
        [sys.executable, FOLDER / "real.py"], env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 2
    assert "GEOFIT_DATA" in run.stderr
    assert "Traceback" not in run.stderr


def test_the_section_on_drawing_takes_the_place_of_the_last_one(load):
    drawing = load("drawing")
    view = {"moving": 9e3, "frame": 25, "rate": 30, "still": 8e5, "rest": 0.4, "pick": 2, "slowest pick": 5}
    view |= {"first surface": 3, "surface": 1, "slowest surface": 3, "same": 5}
    frames = {f"{name} {key}": value for name in ("all", "near") for key, value in view.items()}
    frames |= {"shown": 1.5, "before": 800, "after": 840, "drawn": 1200, "input": 229, "load": 1}
    triangles = {"count": 1e6, "cpu": 0.5, "tolerance": 0.01, "error": 0.009}
    found = {
        "triangles": {"waves": triangles, "rough": triangles, "outline": triangles},
        "frames": {"even": frames, "stations": {**frames, "near frame": 40}},
        "opened": {
            "1000": {"before": 500, "after": 600, "peak": 600, "points": 1_000},
            "1049576": {"before": 500, "after": 700, "peak": 710, "points": 1_049_576},
        },
    }
    text = drawing.section(found, 10_000_000)
    told = " ".join(text.split())
    assert "at most 40 ms of CPU time: at least 25 frames/s" in told
    assert "5 of 5" in told
    assert "takes 200 MB in the window" in told
    assert ": 100 bytes for each point" in told
    page = drawing.with_section("# Scale\n\nText.\n", text)
    assert drawing.with_section(page, text) == page
    assert drawing.drawing_section(page).rstrip() == text.rstrip()
    assert drawing.with_section("# Scale\n\nText.\n", "") == "# Scale\n\nText.\n"


@pytest.mark.parametrize("kind", ["even", "stations"])
def test_made_clouds_lie_on_the_outcrop(load, kind):
    drawing = load("drawing")
    local = drawing.scan(20_000, kind) - drawing.ORIGIN
    assert np.abs(local[:, :2]).max() <= drawing.HALF
    assert np.std(local[:, 2] - 40 * np.sin(local[:, 0] / 240) * np.cos(local[:, 1] / 300)) == pytest.approx(
        0.5, rel=0.1
    )
    cells = np.histogram2d(local[:, 0], local[:, 1], bins=20)[0]
    assert (cells.max() > 20 * cells.mean()) == (kind == "stations")

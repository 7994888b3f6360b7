"""The files beside the report, and its pictures, of a horizon that is made by hand."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from results import ORIGIN, horizon, patch

import geofit
from geofit import FitSettings, PointSet
from geofit.checks.storage import equal_accuracy
from geofit.data.files import file_stems, replacing
from geofit.data.languages import EN, ZH
from geofit.data.site import Hole
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report import fonts, plots, scene
from geofit.report.pictures import DOTS, TYPE, WIDTH, Pictures, draw_pictures, draw_site, write_picture
from geofit.report.result import HorizonResult
from geofit.report.schema import horizon_document, write_json
from geofit.report.style import bands, drawing
from geofit.report.tables import write_issues, write_residuals
from geofit.report.view import choose_view, rims
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface


@pytest.fixture(scope="module")
def result() -> HorizonResult:
    return horizon()


@pytest.fixture(scope="module")
def pictures(result) -> Pictures:
    return draw_pictures(result)


def test_json_has_the_promised_keys_and_the_known_figures(result, tmp_path):
    write_json(horizon_document(result), tmp_path / "a.json")
    data = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    promised = {
        "horizon", "n_points", "n_used", "n_core", "n_periphery", "epsilon", "sigma", "max_abs", "verdict",
        "core", "periphery", "seams", "patches", "checks", "conflicts", "rejected", "read_back", "storage", "seconds",
        "inputs", "settings", "versions", "schema_version", "kind",
    }  # fmt: skip
    assert promised <= set(data)
    assert (data["n_points"], data["n_used"], data["n_core"], data["n_periphery"]) == (200, 199, 120, 80)
    d = result.accuracy.residuals
    assert data["sigma"] == pytest.approx(np.sqrt((d**2).sum() / 199), rel=1e-12)
    assert data["periphery"]["share_within_interior_tolerance"] == pytest.approx((np.abs(d[120:]) <= 0.1).mean())
    assert (data["core"]["n"], data["core"]["max_abs"]) == (120, 0.0)
    assert data["seams"][1] == {"first": "core", "second": "east", "gap": 2e-10, "angle": 0.0003}
    assert data["patches"][0] == {"name": "core", "degree": [3, 3], "control": [11, 11]}
    assert data["read_back"]["valid"] is True
    assert data["read_back"]["free_edges"] == 8
    assert data["storage"]["control_points"] == 363
    assert [(one["file"], one["sha256"]) for one in data["inputs"]] == [("picks.csv", "ab" * 32)]
    assert data["rejected"][0]["row"] == 7
    assert data["settings"]["epsilon"] == 0.5
    assert data["versions"]["geofit"] == geofit.__version__


def test_json_holds_no_nan(result):
    text = json.dumps(horizon_document(result), allow_nan=False)
    assert "NaN" not in str(text)


def test_every_point_has_its_line_in_the_residual_table(result, tmp_path):
    write_residuals(result, tmp_path / "r.csv")
    with (tmp_path / "r.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 200
    assert list(rows[0])[:11] == [
        "file", "row", "kind", "hole", "section", "x", "y", "z", "residual_m", "patch", "exact",
    ]  # fmt: skip
    d = np.array([float(row["residual_m"]) for row in rows])
    assert d == pytest.approx(result.accuracy.residuals, abs=1e-9)
    assert [row["exact"] for row in rows].count("yes") == 120
    assert [int(row["row"]) for row in rows if row["used"] == "no"] == [133]
    assert float(rows[0]["x"]) == pytest.approx(result.surface.points.xyz[0, 0], abs=1e-4)


def test_issues_are_listed_errors_first(result, tmp_path):
    write_issues(result.site.issues[::-1], tmp_path / "i.csv")
    with (tmp_path / "i.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["severity"] for row in rows] == ["error", "note"]
    assert (rows[0]["row"], rows[0]["column"], rows[0]["value"]) == ("7", "z", "abc")


@pytest.mark.skipif(not scene.opengl_found(), reason="no OpenGL library on this machine")
def test_the_picture_in_space_holds_the_whole_surface_and_no_margin(pictures):
    image = pictures.scene.image
    drawn = (image < 250).any(axis=2)
    # A parallelogram seen from a corner touches each side of its box, and leaves the corners white.
    assert all(edge.any() for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]))
    assert not any(drawn[row, column] for row in (0, -1) for column in (0, -1))
    assert 0.35 < drawn.mean() < 0.7
    assert image.shape[1] > 1000
    assert pictures.scene.limits == pytest.approx((1461, 1574), abs=1.5)


def test_a_point_far_away_costs_no_picture(result):
    rng = np.random.default_rng(1)
    xy = rng.uniform(0, 1000, (60, 2))
    xyz = np.column_stack([xy, 5 * np.sin(xy[:, 0] / 200)]) + ORIGIN
    far = np.concatenate([xyz, [[0.5, 0.7, ORIGIN[2]]]])
    boundary = np.array([[0, 0], [1000, 0], [1000, 1000], [0, 1000]]) + ORIGIN[:2]
    surface = geofit.fit_horizon(PointSet(far), FitSettings(), boundary).ended_at(boundary)
    drawn = scene.horizon_scene(replace(result, surface=surface))
    assert drawn.omitted == 1
    assert drawn.image.shape[1] > 1000
    assert drawn.caption.params["count"] == 1


@pytest.mark.skipif(not scene.opengl_found(), reason="no OpenGL library on this machine")
def test_elevations_in_feet_or_with_a_wrong_sign_do_not_make_the_pictures_columns(result):
    """The surface was a speck between them, and the labels below a picture 100 pixels wide lay on each other."""
    surface = result.surface
    xyz = surface.points.xyz.copy()
    xyz[::40, 2] *= -1
    wrong = replace(surface, points=surface.points.with_(xyz=xyz))
    drawn = scene.horizon_scene(replace(result, surface=wrong))
    assert drawn.omitted == len(xyz[::40])
    assert drawn.image.shape == scene.horizon_scene(result).image.shape
    assert not scene.horizon_scene(result).omitted
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    names = [("A", high[2] + 20), ("B", high[2] + 40), ("C", -high[2])]
    depth = np.array([0.0, 50])
    holes = [Hole(name, "borehole", depth, np.column_stack([np.tile(low[:2], (2, 1)), z - depth])) for name, z in names]
    assert scene.site_scene([surface], ["#23506b"], holes).omitted == 1
    assert not scene.site_scene([surface], ["#23506b"], holes[:2]).omitted


@pytest.mark.skipif(not scene.opengl_found(), reason="no OpenGL library on this machine")
def test_a_tall_picture_is_not_cut_off(result):
    """Points high above a flat surface took its lower corner out of the picture."""
    surface = result.surface
    xyz = surface.points.xyz.copy()
    width = np.ptp(xyz[:, :2], axis=0).max()
    xyz[:2, :2] = xyz[:, :2].max(axis=0)
    xyz[:2, 2] += 0.9 * width / scene.horizon_scene(result).raised
    tall = scene.horizon_scene(replace(result, surface=replace(surface, points=surface.points.with_(xyz=xyz))))
    assert not tall.omitted
    for places in (xyz, *rims(surface).values()):
        at = tall.pixels(places)
        assert at.min() > -2
        assert (at < np.array(tall.image.shape[1::-1]) + 2).all()


def test_a_picture_that_fails_costs_itself_alone(result, monkeypatch):
    monkeypatch.setattr(scene, "horizon_scene", lambda *given: [][0])
    pictures = draw_pictures(result)
    assert pictures.scene is None
    assert pictures.missing.code == "data.unforeseen-error"
    assert len(pictures.images) >= 3


def test_bands_are_the_tolerances_and_hold_every_residual_once():
    rows = bands(FitSettings(epsilon=0.5))
    assert [(b.low, b.high) for b in rows] == [(0, 0.01), (0.01, 0.1), (0.1, 0.5), (0.5, np.inf)]
    d = np.array([-0.6, -0.5, -0.2, 0.0, 0.00999, 0.01, 0.1, 3])
    assert (np.sum([b.holds(d) for b in rows], axis=0) == 1).all()
    assert [b.high for b in bands(FitSettings(epsilon=0.1))] == [0.01, 0.1, np.inf]


def test_histogram_without_approximated_points_says_why():
    from dataclasses import replace

    from matplotlib.figure import Figure

    result = horizon()
    whole = replace(result, surface=result.surface.with_(core=np.ones(200, bool)))
    axes = Figure().subplots()
    plots.histogram(axes, whole)
    assert "interpolated exactly" in axes.texts[0].get_text()


def test_steep_surfaces_are_seen_across_their_strike():
    # A plane that strikes towards 60 degrees and dips 75 degrees.
    azimuth, dip = np.radians(60), np.radians(75)
    strike = np.array([np.sin(azimuth), np.cos(azimuth), 0])
    down = np.array([np.cos(azimuth) * np.cos(dip), -np.sin(azimuth) * np.cos(dip), -np.sin(dip)])
    u = bspline.clamped_knots([0, 400], 1)
    control = np.stack([np.stack([strike * a + down * b for b in (0, 300)]) for a in (0, 400)])
    steep = Patch("core", (1, 1), u, bspline.clamped_knots([0, 300], 1), control)
    surface = HorizonFit(PatchSurface((steep,), ORIGIN), PointSet(control.reshape(-1, 3) + ORIGIN))
    view = choose_view(surface)
    assert "060°" in str(view.labels[0])
    assert "75°" in str(view.labels[0])
    drawn = view.of(surface.points.xyz)
    assert np.ptp(drawn[:, 0]) == pytest.approx(400)
    assert drawn[:, 1] == pytest.approx(surface.points.xyz[:, 2])
    assert choose_view(horizon().surface).caption == "plan"


def test_tin_and_grid_of_equal_accuracy():
    # A plane needs its corners only; a wave ten times as exact about ten times the points.
    flat = HorizonFit(PatchSurface((patch("core", 0, 800, 0, 600, lambda x, y: 0.1 * x + 0 * y),), ORIGIN))
    assert equal_accuracy(flat, 0.1).tin_points <= 12
    wave = flat.with_(patches=(patch("core", 0, 800, 0, 600),))
    coarse, fine = equal_accuracy(wave, 0.5), equal_accuracy(wave, 0.05)
    assert 5 < fine.tin_points / coarse.tin_points < 20
    assert 5 < fine.grid_points / coarse.grid_points < 20


def test_font_message_only_where_it_is_needed(monkeypatch):
    monkeypatch.setattr(fonts, "chinese_family", lambda: None)
    assert fonts.missing_font(["T3/T2", "ΔØ°"]) is None
    assert "强风化" in str(fonts.missing_font(["T3", "强风化"]))
    monkeypatch.setattr(fonts, "chinese_family", lambda: "SimSun")
    assert fonts.missing_font(["强风化"]) is None


def test_file_names_are_safe_and_no_two_alike():
    names = ["T3/T2", "T3\\T2", "t3_t2", "强风化 下限", "..", "con", "a" * 300]
    stems = file_stems(names)
    assert list(stems) == names
    assert len({stem.casefold() for stem in stems.values()}) == len(names)
    assert not any(re.search(r'[/\\:*?"<>|\s]|^\.|^con$', stem) for stem in stems.values())
    assert stems["强风化 下限"] == "强风化_下限"


def test_an_interrupted_write_leaves_the_old_file(tmp_path: Path):
    path = tmp_path / "a.json"
    path.write_text("old", encoding="utf-8")

    def interrupted() -> None:
        with replacing(path) as part:
            part.write_text("half", encoding="utf-8")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_without_opengl_the_pictures_say_what_to_install(result, monkeypatch, tmp_path):
    monkeypatch.setattr(scene, "opengl_found", lambda: False)
    pictures = draw_pictures(result)
    assert pictures.scene is None
    assert "libegl1" in str(pictures.missing)
    assert set(pictures.images) == {"plan/T3/T2", "deviation/T3/T2", "residuals/T3/T2"}
    write_picture(result, pictures, tmp_path / "r.png")
    assert (tmp_path / "r.png").stat().st_size > 10_000
    assert draw_site([result]).images == {}


@pytest.mark.parametrize("wide", [60, 300, 900])
@pytest.mark.parametrize("t", [EN, ZH], ids=["en", "zh"])
def test_the_words_below_a_picture_in_space_have_room_however_narrow_it_is(wide, t):
    image, limits = np.full((600, wide, 3), 90, np.uint8), (1450.0, 1590.0)
    view = scene.Scene(image, 12, limits, np.zeros(3), np.ones(3), np.eye(2, 4), omitted=128)
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, 3.7), dpi=DOTS)
        axes = figure.add_axes((0.0, 0.19, 1.0, 0.81), anchor="NW")
        plots.space(axes, view, t)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        words = axes.texts[0].get_window_extent()
        (scale,) = axes.child_axes
        below = [label.get_window_extent() for label in scale.get_xticklabels()]
        assert words.x1 <= figure.bbox.x1 + 0.5
        assert scale.get_tightbbox(canvas.get_renderer()).x1 < words.x0
        assert all(left.x1 < right.x0 for left, right in pairwise(below))

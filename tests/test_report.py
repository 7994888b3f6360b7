"""The reports of a horizon that is made by hand, so that every figure in them is known."""

from __future__ import annotations

import csv
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import geofit
from geofit import FitSettings, PointSet, Site, bspline
from geofit.accuracy import Accuracy, Check, Conflict, Group, ReadBack, Seam
from geofit.files import file_stems, replacing
from geofit.report import fonts, plots, scene
from geofit.report.html import metres, write_report, write_site_report
from geofit.report.pictures import Pictures, draw, write_picture, write_site_picture
from geofit.report.result import HorizonResult, horizon_data, write_json
from geofit.report.style import bands
from geofit.report.tables import write_issues, write_residuals
from geofit.report.view import choose_view
from geofit.site import Hole, ImportIssue, Section, TableCount
from geofit.storage import equal_accuracy
from geofit.surface import HorizonSurface, Partition, Patch

ORIGIN = np.array([500_000.0, 3_100_000.0, 1500.0])


def height(x, y):
    return 0.04 * x - 0.02 * y + 12 * np.sin(x / 260) * np.cos(y / 310)


def patch(name: str, x0: float, x1: float, y0: float, y1: float, shape=height) -> Patch:
    u, v = bspline.clamped_knots(np.linspace(x0, x1, 9), 3), bspline.clamped_knots(np.linspace(y0, y1, 9), 3)
    x, y = np.meshgrid(bspline.greville(u, 3), bspline.greville(v, 3), indexing="ij")
    return Patch(name, (3, 3), u, v, np.stack([x, y, shape(x, y)], axis=2))


def group(d) -> Group:
    sigma = float(np.sqrt((d**2).sum() / (len(d) - 1))) if len(d) > 1 else 0.0
    return Group(len(d), sigma, float(np.abs(d).max()), float(d.mean()))


def horizon(name: str = "T3/T2", epsilon: float = 0.5, chinese: bool = False) -> HorizonResult:
    """Three patches, 120 core points without residual, 80 peripheral ones with known residuals."""
    patches = (
        patch("core", 0, 800, -600, 600),
        patch("west", -700, 0, -600, 600),
        patch("east", 800, 1500, -600, 600),
    )
    rng = np.random.default_rng(5)
    xy = np.concatenate([rng.uniform((0, -590), (800, 590), (120, 2)), rng.uniform((-690, -590), (0, 590), (80, 2))])
    xy[160:, 0] += 1500
    d = np.concatenate([np.zeros(120), rng.normal(0, 0.15, 80)])
    d[150] = 0.62
    kind = np.where(np.arange(200) < 120, "section", np.where(np.arange(200) < 170, "borehole", "outcrop"))
    points = PointSet(
        np.column_stack([xy, height(*xy.T) + d]) + ORIGIN,
        kind=kind,
        hole=np.where(kind == "borehole", [f"ZK{i}" for i in range(200)], ""),
        section=np.where(kind == "section", [f"S{i // 12 + 1}" for i in range(200)], ""),
        row=np.arange(200) + 2,
        file="剖面.csv" if chinese else "picks.csv",
    )
    core = np.arange(200) < 120
    where = np.array([p.name for p in patches])[np.select([core, np.arange(200) < 160], [0, 1], 2)]
    total = group(d)
    accuracy = Accuracy(
        n=200,
        sigma=total.sigma,
        epsilon=epsilon,
        passed=total.sigma < epsilon,
        max_abs=total.max_abs,
        mean=total.mean,
        residuals=d,
        patch=where,
        by_patch={w: group(d[where == w]) for w in ("core", "west", "east")},
        by_kind={k: group(d[kind == k]) for k in ("section", "borehole", "outcrop")},
        by_hole={},
        by_section={f"S{i + 1}": group(d[i * 12 : i * 12 + 12]) for i in range(10)},
        over={
            "interior tolerance 0.1 m": int((np.abs(d) > 0.1).sum()),
            "epsilon": int((np.abs(d) > epsilon).sum()),
        },
        worst=tuple(np.argsort(-np.abs(d), kind="stable")[:20].tolist()),
        seams=(Seam("core", "west", 0.0, 0.0002), Seam("core", "east", 2e-10, 0.0003)),
        checks=(
            Check("folds", True, 0.0, 0.0, "", "no normal points downwards"),
            Check("ground", None, float("nan"), float("nan"), "m", "no ground surface was given"),
        ),
        conflicts=(Conflict(130, 131, 0.8, "the borehole is more exact than the section"),),
    )
    corners = ((0.0, -600.0), (800.0, -600.0), (800.0, 600.0), (0.0, 600.0))
    surface = HorizonSurface(
        patches=patches,
        origin=ORIGIN,
        points=points,
        settings=FitSettings(epsilon=epsilon),
        name=name,
        partition=Partition(tuple((x + ORIGIN[0], y + ORIGIN[1]) for x, y in corners), 120, 80, "Dense in the middle."),
        core=core,
        accuracy=accuracy,
        fit={"smoothing": 0.0123, "frame": "map", "iterations": 3},
    )
    boundary = np.array([[-700.0, -600], [1500, -600], [1500, 600], [-700, 600]]) + ORIGIN[:2]
    site = Site(
        name="坝址" if chinese else "Dam site",
        horizons={name: points},
        boundary=boundary,
        holes=(Hole("ZK1", "borehole", np.array([0.0, 80]), np.add(ORIGIN, [[0.0, 0, 90], [10, 0, 10]])),),
        sections=(Section("S1", boundary[:2]),),
        issues=(
            ImportIssue("picks.csv", 7, "z", "abc", "error", "no number", "write metres"),
            ImportIssue("picks.csv", 0, "", "", "note", "separator ';' was guessed"),
        ),
        counts=(TableCount("picks.csv", 201, 200, 1),),
        crs="CGCS2000 / 3-degree 105E",
        inputs={"picks.csv": "ab" * 32},
    )
    back = ReadBack(
        f"{name}.step", "cd" * 32, 3, total.sigma, 3e-9, total.max_abs, accuracy.seams, True, 8, 8, 1e-7,
        False,
        (Check("free edges", True, 8, 8, "", "all on the outline"),),
    )  # fmt: skip
    return HorizonResult(surface, site, back, equal_accuracy(surface, 0.1), 123_456, {"fit": 0.5, "pictures": 1.25})


@pytest.fixture(scope="module")
def result() -> HorizonResult:
    return horizon()


@pytest.fixture(scope="module")
def pictures(result) -> Pictures:
    return draw(result)


class _Page(HTMLParser):
    """Collects the text, checks that tags close, and lists what the page would load."""

    VOID = frozenset({"meta", "img", "br", "link", "hr"})

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loads: list[str] = []
        self.words: list[str] = []
        self.feed(page)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        if tag not in self.VOID:
            self.open.append(tag)
        self.loads += [value for key, value in attrs if key in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


def test_json_has_the_promised_keys_and_the_known_figures(result, tmp_path):
    write_json(result, tmp_path / "a.json")
    data = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    promised = {
        "horizon", "n_points", "n_used", "n_core", "n_periphery", "epsilon", "sigma", "max_abs", "verdict",
        "core", "periphery", "seams", "patches", "checks", "conflicts", "rejected", "read_back", "storage", "seconds",
        "inputs", "settings", "version",
    }  # fmt: skip
    assert promised <= set(data)
    assert (data["n_points"], data["n_used"], data["n_core"], data["n_periphery"]) == (200, 199, 120, 80)
    d = result.accuracy.residuals
    assert data["sigma"] == pytest.approx(np.sqrt((d**2).sum() / 199), rel=1e-12)
    assert data["periphery"]["share_within_interior_tolerance"] == pytest.approx((np.abs(d[120:]) <= 0.1).mean())
    assert data["core"] == {"n": 120, "max_abs": 0.0}
    assert data["seams"][1] == {"a": "core", "b": "east", "max_gap": 2e-10, "max_angle_deg": 0.0003}
    assert data["patches"][0] == {"name": "core", "degree": [3, 3], "n_control": 121}
    assert data["read_back"]["valid"] is True
    assert data["read_back"]["free_edges"] == 8
    assert data["storage"]["control_points"] == 363
    assert data["inputs"] == [{"file": "picks.csv", "sha256": "ab" * 32}]
    assert data["rejected"][0]["row"] == 7
    assert data["settings"]["epsilon"] == 0.5
    assert data["version"] == geofit.__version__


def test_json_holds_no_nan(result):
    text = json.dumps(horizon_data(result), allow_nan=False)
    assert "NaN" not in text


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


def test_report_is_one_sound_file_that_loads_nothing(result, pictures, tmp_path):
    write_report(result, pictures, tmp_path / "r.html")
    page = _Page((tmp_path / "r.html").read_text(encoding="utf-8"))
    assert all(address.startswith("data:") for address in page.loads)
    assert "PASS" in page.text
    assert "is below the control error ε = 0.5 m" in page.text
    assert "picks.csv" in page.text
    assert "ab" * 32 in page.text
    assert "the borehole is more exact than the section" in page.text
    worst = result.surface.points.row[150]
    assert f"picks.csv {worst} borehole ZK150" in page.text
    assert not re.search(r"\b(nan|None|inf)\b", page.text)


def test_a_failing_horizon_says_so_in_words(pictures, tmp_path):
    failing = horizon(epsilon=0.05)
    assert not failing.sound
    write_report(failing, pictures, tmp_path / "r.html")
    text = _Page((tmp_path / "r.html").read_text(encoding="utf-8")).text
    assert "FAIL" in text
    assert "is not below the control error ε = 0.05 m" in text


def test_names_from_files_cannot_break_the_page(pictures, tmp_path):
    write_report(horizon(name="<script>alert(1)</script>"), pictures, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_without_opengl_the_report_says_what_to_install(result, monkeypatch, tmp_path):
    monkeypatch.setattr(scene, "_opengl", lambda: False)
    pictures = draw(result)
    assert pictures.scene is None
    write_report(result, pictures, tmp_path / "r.html")
    assert "libegl1" in (tmp_path / "r.html").read_text(encoding="utf-8")
    write_picture(result, pictures, tmp_path / "r.png")
    assert (tmp_path / "r.png").stat().st_size > 10_000
    assert "libegl1" in write_site_picture([result], tmp_path / "site.png")
    assert not (tmp_path / "site.png").exists()


@pytest.mark.skipif(not scene._opengl(), reason="no OpenGL library on this machine")
def test_the_picture_in_space_holds_the_whole_surface_and_no_margin(pictures):
    image = pictures.scene.image
    drawn = (image < 250).any(axis=2)
    # A parallelogram seen from a corner touches each side of its box, and leaves the corners white.
    assert all(edge.any() for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]))
    assert not any(drawn[row, column] for row in (0, -1) for column in (0, -1))
    assert 0.35 < drawn.mean() < 0.7
    assert image.shape[1] > 1000
    assert pictures.scene.limits == pytest.approx((1461, 1574), abs=1.5)


def test_site_page_links_every_report(result, tmp_path):
    other = horizon(name="强风化", chinese=True)
    stems = file_stems([result.name, other.name])
    write_site_report([result, other], stems, tmp_path / "report.html", picture=None)
    page = _Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert page.loads == ["T3_T2_report.html", "T3_T2.step", "强风化_report.html", "强风化.step"]


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
    surface = HorizonSurface(patches=(steep,), origin=ORIGIN, points=PointSet(control.reshape(-1, 3) + ORIGIN))
    view = choose_view(surface)
    assert "060°" in view.labels[0]
    assert "75°" in view.labels[0]
    drawn = view.of(surface.points.xyz)
    assert np.ptp(drawn[:, 0]) == pytest.approx(400)
    assert drawn[:, 1] == pytest.approx(surface.points.xyz[:, 2])
    assert choose_view(horizon().surface).caption == "plan"


def test_tin_and_grid_of_equal_accuracy():
    # A plane needs its corners only; a wave ten times as exact about ten times the points.
    flat = HorizonSurface(
        patches=(patch("core", 0, 800, 0, 600, lambda x, y: 0.1 * x + 0 * y),),
        origin=ORIGIN,
        points=PointSet([]),
    )
    assert equal_accuracy(flat, 0.1).tin_points <= 12
    wave = flat.with_(patches=(patch("core", 0, 800, 0, 600),))
    coarse, fine = equal_accuracy(wave, 0.5), equal_accuracy(wave, 0.05)
    assert 5 < fine.tin_points / coarse.tin_points < 20
    assert 5 < fine.grid_points / coarse.grid_points < 20


def test_font_message_only_where_it_is_needed(monkeypatch):
    monkeypatch.setattr(fonts, "_chinese", lambda: None)
    assert fonts.missing_font(["T3/T2", "ΔØ°"]) is None
    assert "强风化" in fonts.missing_font(["T3", "强风化"])
    monkeypatch.setattr(fonts, "_chinese", lambda: "SimSun")
    assert fonts.missing_font(["强风化"]) is None


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.1234, 3, "0.123"),
        (-0.5, 1, "−0.5"),
        (3e-9, 6, "3e-9"),
        (-3e-9, 6, "−3e-9"),
        (0.0, 2, "0"),
        (None, 3, "–"),
    ],
)
def test_metres_for_people(value, digits, text):
    assert metres(value, digits) == text


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

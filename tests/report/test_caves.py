"""The report of a survey of passages: its tables say what the survey is, its drawings are to scale."""

from __future__ import annotations

import io
import json
import re

import numpy as np
import pytest

from geofit.cli.main import main
from geofit.data.languages import EN
from geofit.io.centreline import read_centreline
from geofit.io.meshes import read_stl
from geofit.io.survex import read_survex
from geofit.project.cave_report import write_cave_report
from geofit.project.cave_run import measure_passages, write_passages
from geofit.report import fonts
from geofit.report.cave_chapter import CaveFindings, cave_chapter
from geofit.report.cave_drawings import cave_sheet, draw_cave
from geofit.report.document import CheckMark, Facts, Heading, Paragraph, ReportTable

NO_FONT = fonts.chinese_family() is None
#: Pixels of a millimetre in the drawings.
DOTS = 200 / 25.4


class Level:
    """A horizon at one elevation."""

    def __init__(self, height):
        self.height = height

    def elevation(self, x, y):
        return np.full(np.broadcast(x, y).shape, float(self.height))


def table(chapter, heading):
    """Return the first table below a heading."""
    blocks = list(chapter.blocks)
    start = next(k for k, block in enumerate(blocks) if isinstance(block, Heading) and block.text == heading)
    return next(block for block in blocks[start:] if isinstance(block, ReportTable))


def text_of(chapter):
    return " ".join(block.text for block in chapter.blocks if isinstance(block, Heading | Paragraph))


def found(run, **changes):
    return CaveFindings(
        "cave", run.body, run.volume, run.spacing, run.triangles.volume, run.strata, run.clearance, **changes
    )


def test_the_files_of_the_passages_have_their_volume(tmp_path):
    path = tmp_path / "cave.csv"
    rows = ("1,500000,5400000,-20,3,3,2,2", "2,500030,5400000,-25,3,3,2,2", "3,500060,5400020,-30,4,3,2,2")
    path.write_text("\n".join(["station,x,y,z,left,right,up,down", *rows]))
    write_passages(measure_passages(read_centreline(path)), tmp_path / "o")
    figures = json.loads((tmp_path / "o" / "cave.json").read_text(encoding="utf-8"))
    written = read_stl(tmp_path / "o" / "cave.stl")
    assert written.volume == pytest.approx(figures["volume"]["volume"], rel=0.01)
    assert figures["mesh_volume"] == pytest.approx(written.volume, rel=1e-5)
    assert len(written.triangles) < 50_000
    # Triangles whose spacing was given are as wished, and what they enclose is stated.
    coarse = measure_passages(read_centreline(path), spacing=1.5)
    assert coarse.spacing == 1.5
    assert coarse.triangles.volume < 0.97 * coarse.volume.volume
    assert f"{coarse.triangles.volume:.0f}" in words_of(cave_chapter(found(coarse), EN), "Settings")


def words_of(chapter, heading):
    return " ".join(cell for row in table(chapter, heading).rows for cell in row).replace("\N{NO-BREAK SPACE}", "")


@pytest.fixture
def blunder(tmp_path):
    """A square of four shots, the last one 4 m too long, and a second square that closes; walls of one are missing."""
    path = tmp_path / "loop.svx"
    path.write_text(
        "*begin loop\n*fix a 0 0 100\n*data normal from to tape compass clino\n"
        "a b 10 90 0\nb c 10 0 0\nc d 10 270 0\nd a 14 180 0\n"
        "b e 10 90 0\ne f 10 0 0\nf c 10 270 0\n"
        "*data passage station left right up down\na 1 1 1 1\nb 1 1 1 1\nc 1 1 1 1\ne 1 1 1 1\nf 1 1 1 1\n*end loop\n",
        encoding="utf-8",
    )
    run = measure_passages(read_survex(path), horizons={"T2": Level(100.5), "T1": Level(99.5)})
    return write_passages(run, tmp_path / "o")


def test_loops_are_listed_with_their_misclosure_and_the_one_with_a_blunder_is_named(blunder):
    rows = table(cave_chapter(found(blunder), EN), "Loop closure").rows
    assert len(rows) == 2
    for row, loop in zip(rows, blunder.adjusted.loops, strict=True):
        assert row[1] == "4"
        assert float(row[2]) == pytest.approx(loop.length, abs=0.05)
        assert float(row[3]) == pytest.approx(loop.distance, abs=0.005)
        assert isinstance(row[-1], CheckMark)
        assert row[-1].passed is (not loop.suspicious)
    assert [row[-1].passed for row in rows] == [False, True]
    assert float(rows[0][3]) == pytest.approx(4.0)


def test_figures_of_volume_strata_and_missing_walls_are_those_of_the_run(blunder):
    chapter = cave_chapter(found(blunder), EN)
    volume = {row[0]: float(row[1].split("\N{NO-BREAK SPACE}")[0]) for row in table(chapter, "Volume").rows}
    assert volume["volume"] == pytest.approx(blunder.volume.volume, rel=1e-3)
    assert volume["standard deviation"] == pytest.approx(blunder.volume.sigma, rel=1e-3)
    parts = [volume[f"part of it from {name}"] for name in ("measured walls", "missing walls", "shot lengths")]
    assert np.sqrt(np.square(parts).sum()) == pytest.approx(blunder.volume.sigma, rel=1e-3)
    strata = table(chapter, "Strata").rows
    assert [row[0] for row in strata[:3]] == ["above T2", "T2 to T1", "below T1"]
    assert sum(float(row[2]) for row in strata[:3]) == pytest.approx(blunder.volume.volume, abs=2)
    missing = table(chapter, "Missing walls").rows
    assert [row[0] for row in missing] == ["loop.d"]
    assert all(float(cell) == pytest.approx(1.0, abs=0.01) for cell in missing[0][1:])
    facts = next(block for block in chapter.blocks if isinstance(block, Facts))
    assert {label: value for label, value, _ in facts.items}["Missing walls"] == "4"


def test_a_line_without_a_loop_and_one_of_coordinates_say_that_nothing_checks_them(tmp_path):
    (tmp_path / "line.svx").write_text("*data normal from to tape compass clino\na b 10 90 0\nb c 10 45 0\n", "utf-8")
    run = write_passages(measure_passages(read_survex(tmp_path / "line.svx"), radius=1), tmp_path / "o")
    assert "nothing checks its shots" in text_of(cave_chapter(found(run), EN))
    rows = "".join(f"T,{n},{20 * n},0,100,2\n" for n in range(4))
    (tmp_path / "tube.csv").write_text("line,station,x,y,z,radius\n" + rows, "utf-8")
    run = write_passages(measure_passages(read_centreline(tmp_path / "tube.csv")), tmp_path / "o")
    text = text_of(cave_chapter(found(run), EN))
    assert "no loop checks them" in text
    assert "Every wall was measured" in text


def test_an_excavation_that_meets_a_passage_is_a_warning(tmp_path):
    def line(name, z):
        rows = "".join(f"{name},{n},{20 * n},{0 if name == 'T' else 10 * n - 20},{z},2\n" for n in range(5))
        (tmp_path / f"{name}.csv").write_text("line,station,x,y,z,radius\n" + rows, "utf-8")
        return read_centreline(tmp_path / f"{name}.csv")

    for z, meets in ((100, True), (120, False)):
        run = write_passages(measure_passages(line("T", 100), excavation=line("G", z)), tmp_path / "o")
        chapter = cave_chapter(found(run), EN)
        assert ("meets a passage" in text_of(chapter)) is meets
        assert table(chapter, "Planned excavation").rows[0][1].startswith("−" if meets else "16")


@pytest.mark.parametrize("azimuth", [0.0, 30.0, 90.0, 137.0])
@pytest.mark.parametrize("reach", [37.0, 260.0, 4100.0])
def test_drawings_are_to_scale_and_the_section_is_along_the_passage(tmp_path, azimuth, reach):
    """A straight tube of known length, 8 m wide: its outline is measured in the pictures."""
    from PIL import Image

    way, radius = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))]), reach / 40
    rows = "".join(
        f"T,{n},{500_000 + s * way[0]:.6f},{3_100_000 + s * way[1]:.6f},{1000 + 0.1 * s:.6f},{radius}\n"
        for n, s in enumerate(np.linspace(0, reach, 6))
    )
    (tmp_path / "tube.csv").write_text("line,station,x,y,z,radius\n" + rows, "utf-8")
    run = write_passages(measure_passages(read_centreline(tmp_path / "tube.csv")), tmp_path / "o")
    sheet = cave_sheet(run.triangles, run.adjusted.xyz)
    assert sheet.azimuth == pytest.approx(azimuth % 180, abs=1e-3)
    images = draw_cave(found(run), sheet, run.triangles)
    size = {}
    for what in ("plan", "section"):
        pixels = np.asarray(Image.open(io.BytesIO(images[f"cave/{what}/cave"])).convert("RGB")).astype(int)
        assert pixels.shape[1] == pytest.approx(174 * DOTS, abs=2)
        # The fill of the passages; names and lines over it do not reach its ends. The legend is below the frame.
        tint = (np.abs(pixels - (0xCD, 0xDB, 0xE6)).sum(axis=2) < 12)[: pixels.shape[0] - int(15 * DOTS)]
        lines, columns = np.flatnonzero(tint.any(axis=1)), np.flatnonzero(tint.any(axis=0))
        size[what] = np.array([np.ptp(columns), np.ptp(lines)]) / DOTS * sheet.scale / 1000
    near = 1.5 * sheet.scale / 1000  # the rim of the outline, and the spacing of the triangles
    ends = 2 * radius
    assert size["plan"] == pytest.approx(reach * np.abs(way) + ends, abs=near + 0.1 * radius)
    assert size["section"] == pytest.approx([reach + ends, 0.1 * reach + ends], abs=near + 0.1 * radius)


@pytest.mark.parametrize(
    "code", ["en", pytest.param("zh", marks=pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters"))]
)
def test_the_command_writes_the_report_in_both_languages(blunder, tmp_path, code, monkeypatch, capsys):
    arguments = ["geofit", "cave", str(tmp_path / "loop.svx"), "--out", str(tmp_path / "r"), "--report", "--lang", code]
    monkeypatch.setattr("sys.argv", arguments)
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert "loop_report.pdf" in capsys.readouterr().err
    assert (tmp_path / "r" / "loop_report.pdf").read_bytes().startswith(b"%PDF-")
    page = (tmp_path / "r" / "loop_report.html").read_text("utf-8").replace("\N{NO-BREAK SPACE}", " ")
    for word in ("Loop closure", "Missing walls") if code == "en" else ("环线闭合", "缺测洞壁", "纵剖面"):
        assert word in page
    assert page.count("data:image/png") >= 2
    assert re.search(r"1:\d", page)


def test_the_same_run_gives_the_same_report(blunder, tmp_path):
    first, second = (write_cave_report(blunder, tmp_path / name, EN, date="2026-01-02")[0] for name in "ab")
    assert first.read_bytes() == second.read_bytes()


def test_shots_without_a_correction_are_named_above_the_drawings(tmp_path):
    """A cave that is turned by its declination must not look like one that is not."""
    path = tmp_path / "turned.svx"
    path.write_text("*declination auto 36 12 800\n1 2 10 86 0\n2 3 10 86 0\n", encoding="utf-8")
    run = measure_passages(read_survex(path), radius=1.0, spacing=0.5)
    chapter = cave_chapter(found(run, uncorrected=run.uncorrected), EN)
    facts, warning = chapter.blocks[:2]
    assert isinstance(facts, Facts)
    assert isinstance(warning, Paragraph)
    assert warning.style == "warning"
    assert warning.text.startswith("2 shots are used without the correction by *declination: their directions")

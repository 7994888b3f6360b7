"""Chapters of bodies and rock volumes: every figure of the findings is in the pages, in both languages."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from results import horizon

import geofit
from geofit.data.languages import EN, ZH, sentence
from geofit.data.messages import message
from geofit.data.stale import StaleCause
from geofit.pores.representative import RepresentativeVolume, representative_volume
from geofit.pores.volume import RockVolume
from geofit.project.body_run import run_body
from geofit.project.pores_run import run_pores
from geofit.project.single_reports import body_findings, write_body_report, write_pores_report
from geofit.report import fonts
from geofit.report.body_chapter import BodyFindings, body_chapter, body_row
from geofit.report.chapters import document
from geofit.report.document import CheckMark, Facts, Heading, Paragraph, Picture, ReportTable
from geofit.report.gather import accuracy_report
from geofit.report.pores_chapter import settling_sentence
from geofit.report.style import PASS

NO_FONT = fonts.chinese_family() is None
SEMI = np.array([60.0, 45.0, 30.0])
CENTRE = np.array([500_000.0, 3_100_000.0, 900.0])


def ellipsoid(seed: int) -> geofit.BodyData:
    """Contacts on an ellipsoid of known volume, samples inside and outside, by holes."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(160, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    hole = np.array([f"H{int(a) % 12}" for a in np.degrees(np.arctan2(way[:, 1], way[:, 0])) // 30 + 12])
    # Not exactly an ellipsoid: of that the fit would leave nothing in doubt, and no hole to suggest.
    rough = 1 + 0.01 * rng.normal(size=(160, 1))
    return geofit.BodyData(
        contacts=rough * way * SEMI + CENTRE, inside=way * SEMI * 0.6 + CENTRE, outside=way * SEMI * 1.5 + CENTRE,
        hole=hole, inside_hole=hole, outside_hole=hole, inside_length=1.0, outside_length=1.0,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return run_body(ellipsoid(4), tmp_path_factory.mktemp("body"), name="ORE")


def words(chapter) -> str:
    """Everything that a chapter says, on one line."""
    said = []
    for block in chapter.blocks:
        match block:
            case Paragraph() | Heading():
                said.append(block.text)
            case Facts():
                said += [" ".join(item) for item in block.items]
            case ReportTable():
                said += [column.title for column in block.columns]
                said += [" ".join(cell if isinstance(cell, str) else cell.text for cell in row) for row in block.rows]
            case Picture():
                said.append(block.caption)
    return re.sub(r"\s+", " ", " ".join(said))


class Level:
    """A horizon through the middle of the body."""

    frame = "map"

    def elevation(self, x, y):
        return np.full(np.broadcast(x, y).shape, CENTRE[2])


def test_a_body_has_verdict_volumes_strata_sections_and_holes_in_its_chapter(run):
    found, images = body_findings(run, {"T2": Level()})
    chapter = body_chapter(found, EN)
    text = words(chapter).replace("\N{NO-BREAK SPACE}", " ")
    assert chapter.verdict.word == found.verdict.word == run.verdict.word
    assert str(run.verdict.away.text) in text
    truth = 4 / 3 * np.pi * SEMI.prod()
    assert found.volumes.best == pytest.approx(truth, rel=0.03)
    for value in (found.volumes.best, found.volumes.p10, found.volumes.p50, found.volumes.p90):
        assert f"{value:,.0f}".replace(",", " ") in text
    halves = [part.volumes.best for part in found.strata]
    assert sum(halves) == pytest.approx(found.volumes.best, rel=1e-3)
    assert [part.volumes.best / truth for part in found.strata] == pytest.approx([0.5, 0.5], abs=0.03)
    assert "above T2" in text
    assert "below T2" in text
    assert set(found.left_out.methods) == {"body", "linear RBF", "indicator kriging"}
    for score in found.left_out.methods.values():
        assert f"{score.misclassified:.2f}" in text
    assert len(found.suggested) == 3
    assert all(f"{one.hole.collar[0]:.2f}" in text for one in found.suggested)
    assert not found.missing
    assert set(images) >= {"body/section/ORE"}
    names = [block.text for block in chapter.blocks if isinstance(block, Heading)]
    assert {"Volume", "Violations", "Checks of the body", "One hole left out at a time"} <= set(names)


def test_the_volume_in_the_file_is_written_as_elsewhere_and_its_limit_is_one(run):
    found, _ = body_findings(run)
    tables = [b for b in body_chapter(found, EN).blocks if isinstance(b, ReportTable)]
    (row,) = (row for table in tables for row in table.rows if row[0] == "volume")
    (check,) = (one for one in found.read_back.checks if one.name == "volume")
    assert check.value <= check.limit < 0.05 * found.volumes.best
    detail = row[4].replace("\N{NO-BREAK SPACE}", " ")
    assert f"{found.read_back.volume:,.0f} m³".replace(",", " ") in detail
    assert "m3" not in detail
    assert "e+" not in " ".join(cell for cell in row if isinstance(cell, str))


def test_what_was_not_examined_and_a_failed_check_are_said(run):
    found, _ = body_findings(run)
    assert found.strata == ()
    bare = replace(found, left_out=None, suggested=(), read_back=None, pictures=())
    text = words(body_chapter(bare, EN))
    assert "Not examined: what the body predicts" in text
    assert "No holes are suggested." in text
    unexamined = body_chapter(replace(bare, suggested=None), EN).blocks
    (at,) = (k for k, block in enumerate(unexamined) if block == Heading("Suggested boreholes"))
    assert unexamined[at + 1] == Paragraph("Not examined.")
    assert BodyFindings(run.body, run.volumes).suggested is None
    broken = replace(run.body.accuracy.checks[0], passed=False)
    body = run.body.with_accuracy(replace(run.body.accuracy, checks=(broken,)))
    chapter = body_chapter(replace(bare, body=body), EN)
    assert "Checks: 0 of 1 checks pass; failed: sides" in words(chapter)
    marks = [cell for b in chapter.blocks if isinstance(b, ReportTable) for row in b.rows for cell in row]
    assert any(isinstance(cell, CheckMark) and cell.passed is False for cell in marks)


@pytest.mark.parametrize("t", [EN, ZH], ids=lambda t: t.code)
def test_what_limits_the_use_of_a_body_is_a_warning_in_its_chapter(run, t):
    def warnings(findings):
        blocks = body_chapter(findings, t).blocks
        return [block.text for block in blocks if isinstance(block, Paragraph) and block.style == "warning"]

    bare = BodyFindings(run.body, run.volumes)
    assert warnings(bare) == []
    few = message("test.few", "Contacts: {count}", count=8).with_severity("warning")
    accuracy = replace(run.body.accuracy, notes=(message("test.active", "6 samples are active"), few))
    assert warnings(replace(bare, body=run.body.with_accuracy(accuracy))) == [sentence(few, t)]


@pytest.mark.parametrize("t", [EN, ZH], ids=lambda t: t.code)
def test_the_summary_of_a_site_states_the_verdict_of_its_bodies(run, t):
    found = BodyFindings(run.body, run.volumes)
    chapter = body_chapter(found, t)
    report = accuracy_report([horizon()], date="2026-11-21")
    summary = document(report, t, bodies=[chapter], body_rows=[body_row(found, t)]).chapters[1]
    horizons, bodies = (block for block in summary.blocks[:3] if isinstance(block, ReportTable))
    assert [len(table.columns) for table in (horizons, bodies)] == [len(bodies.rows[0])] * 2
    (row,) = bodies.rows
    assert row[:2] == ("ORE", chapter.verdict)
    assert row[5] == str(run.accuracy.n)
    assert row[6].word.removeprefix("! ") in chapter.blocks[0].text, "the checks that failed"


@pytest.mark.parametrize("t", [EN, ZH], ids=lambda t: t.code)
def test_the_chapter_of_a_stale_body_says_what_changed_and_does_not_pass_without_a_warning(run, t):
    bare = BodyFindings(run.body, run.volumes)
    stale = replace(bare, stale=(StaleCause("source", "lens.csv", "0123456789abcdef", "fedcba9876543210"),))
    chapter = body_chapter(stale, t)
    assert chapter.verdict.word == body_chapter(bare, t).verdict.word + (" (stale)" if t is EN else "（已过时）")
    assert chapter.verdict.passed is None
    warning, table = chapter.blocks[:2]
    assert (warning.style, "ORE" in warning.text) == ("warning", True)
    assert table.rows[0][0] == ("Data in lens.csv" if t is EN else "lens.csv 中的数据")
    assert [row[2] for row in table.rows] == ["0123456789abcdef", "fedcba9876543210"]


@pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters on this machine")
def test_the_report_of_a_body_is_written_in_chinese(run, tmp_path):
    pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
    html, pdf = write_body_report(run, tmp_path, ZH, date="2026-01-02")
    assert (html.name, pdf.name) == ("ORE_report.html", "ORE_report.pdf")
    pages = pdfium.PdfDocument(pdf)
    text = "".join(pages[i].get_textpage().get_text_range() for i in range(len(pages))).replace(" ", "")
    pages.close()
    for word in ("地质体检验报告", "留一钻孔检验", "建议钻孔", "批准", "审定", "校核", "编制", "违反编录的部分"):
        assert word in text, word
    assert PASS in html.read_text(encoding="utf-8")


def tubes() -> RockVolume:
    """Two straight tubes along axis 0, one closed pore: porosity and percolation are known."""
    rock = np.ones((24, 24, 24), bool)
    rock[:, 4:8, 4:8] = False
    rock[:, 14:20, 14:20] = False
    rock[10:13, 20:23, 2:5] = False
    return RockVolume(~rock, pore=[True], voxel=5e-6)


def test_the_representative_volume_ends_at_the_sample_and_its_mean_keeps_to_the_porosity():
    volume = tubes()
    found = representative_volume(volume)
    assert found.edge[-1] == pytest.approx(24 * 5e-6)
    assert (found.lowest[-1], found.highest[-1]) == pytest.approx((volume.porosity, volume.porosity))
    assert found.count[-1] == 1
    fills = [k for k, edge in enumerate((found.edge / 5e-6).round().astype(int)) if 24 % edge == 0]
    assert len(fills) >= 3
    for k in fills:  # cubes that fill the sample without a rest
        assert found.mean[k] == pytest.approx(volume.porosity, rel=1e-12)
        assert found.lowest[k] <= found.mean[k] <= found.highest[k]
    edge = int((found.edge[0] / 5e-6).round())
    literal = [
        volume.pore[i : i + edge, j : j + edge, k : k + edge].mean()
        for i in range(0, 24 - edge + 1, edge)
        for j in range(0, 24 - edge + 1, edge)
        for k in range(0, 24 - edge + 1, edge)
    ]
    assert (found.lowest[0], found.highest[0]) == pytest.approx((min(literal), max(literal)))


@pytest.mark.parametrize(
    "t", [EN, pytest.param(ZH, marks=pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters"))]
)
def test_the_report_of_a_rock_volume_has_its_table_sizes_and_percolation(t, tmp_path):
    run = run_pores(tubes(), tmp_path, "tubes")
    html, pdf = write_pores_report(run, "tubes", tmp_path, t, date="2026-01-02")
    assert pdf.read_bytes().startswith(b"%PDF-")
    page = html.read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    before = run.table.before
    assert f"{100 * before.connectivity.porosity:.1f} %" in page
    assert f"{100 * run.table.after.connectivity.porosity:.1f} %" in page
    assert f"{before.kozeny / 9.869233e-16:.4g}" in page
    word, not_word = ("✓ percolates", "✗ does not percolate") if t is EN else ("✓ 贯通", "✗ 不贯通")
    assert page.count(word) == 3
    assert page.count(not_word) == 6
    assert page.count("data:image/png") >= 3


@pytest.mark.parametrize(
    ("low", "high", "edge"),
    [
        # Alike by chance at 0.2 mm: larger cubes differ again, and one of 0.4 mm is far from the sample.
        ((0.0, 0.199, 0.1, 0.19, 0.2), (0.6, 0.201, 0.3, 0.21, 0.2), "0.4"),
        ((0.0, 0.199, 0.195, 0.15, 0.2), (0.6, 0.201, 0.205, 0.15, 0.2), None),
        # Alike, but all of them less porous than the sample with its rim.
        ((0.0, 0.15, 0.15, 0.15, 0.2), (0.6, 0.16, 0.16, 0.16, 0.2), None),
    ],
)
def test_cubes_are_representative_only_if_no_larger_one_contradicts(low, high, edge):
    low, high = np.array(low), np.array(high)
    settling = RepresentativeVolume(
        np.array([1e-4, 2e-4, 3e-4, 4e-4, 9e-4]), low, (low + high) / 2, high, np.array([729, 64, 27, 8, 1])
    )
    text = settling_sentence(settling, 0.2, EN)
    assert (f"edge of {edge} mm" in text) if edge else ("No cube" in text)

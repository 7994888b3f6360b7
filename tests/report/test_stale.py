"""A report on a stale surface: what has changed since the fit is on the cover, at the verdict and in the JSON."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from results import horizon

from geofit.data.languages import EN, ZH
from geofit.data.stale import StaleCause
from geofit.report.accuracy_report import SectionSheet
from geofit.report.chapters import document
from geofit.report.document import Paragraph, VerdictMark
from geofit.report.gather import accuracy_report
from geofit.report.html import write_html
from geofit.report.schema import report_document

THEN, NOW = "ab" * 32, "cd" * 32
CAUSES = (
    StaleCause("data", "", "0123456789abcdef", "fedcba9876543210"),
    StaleCause("file", "picks.csv", THEN, NOW),
    StaleCause("file", "more.csv", None, NOW),
    StaleCause("setting", "smoothing", "auto", 0.25),
    StaleCause("excluded", "", (), ("picks.csv:5",)),
)


@pytest.fixture(scope="module")
def report():
    return accuracy_report([replace(horizon(), stale=CAUSES), horizon(name="T2/T1")], date="2026-11-21")


@pytest.mark.parametrize("t", [EN, ZH], ids=lambda t: t.code)
def test_cover_summary_and_chapter_name_the_stale_surface_alone(report, t):
    cover, *chapters = document(report, t).chapters
    (warning,) = [block for block in cover.blocks if isinstance(block, Paragraph) and block.style == "warning"]
    assert "T3/T2" in warning.text
    assert "T2/T1" not in warning.text
    stale = "(stale)" if t is EN else "（已过时）"
    (row, other) = chapters[0].blocks[1].rows
    assert isinstance(row[1], VerdictMark)
    assert row[1].word.endswith(stale)
    assert row[1].passed is None
    assert stale not in other[1].word
    (badge,) = [chapter.verdict for chapter in chapters if "T3/T2" in chapter.title]
    assert badge == row[1]


def test_the_html_shows_the_hashes_and_values_of_the_fit_and_of_now(report, tmp_path):
    write_html(document(report, EN), {}, tmp_path / "report.html")
    words = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", (tmp_path / "report.html").read_text(encoding="utf-8")))
    assert f"picks.csv, SHA-256 at the fit {THEN} now {NOW}" in words
    assert f"more.csv, SHA-256 at the fit – now {NOW}" in words
    assert re.search(r"Smoothing\S* at the fit Automatic now 0\.25", words)
    assert "Excluded points at the fit – now picks.csv:5" in words
    assert "Fit again" in words


def test_the_json_lists_the_causes_of_the_stale_surface(report):
    first, second = report_document(report)["horizons"]
    assert first["stale"][1] == {"kind": "file", "name": "picks.csv", "fitted": THEN, "now": NOW}
    assert first["stale"][3] == {"kind": "setting", "name": "smoothing", "fitted": "auto", "now": 0.25}
    assert second["stale"] == []


def test_the_limits_of_use_except_the_stale_surface(report):
    summary = document(report, EN).chapters[1]
    assert any(isinstance(one, Paragraph) and "earlier data or settings): T3/T2" in one.text for one in summary.blocks)


def test_every_section_of_the_report_names_the_stale_surface(report):
    with_section = replace(report, sections=(SectionSheet("A", (0, 0), (9, 0), 9, 0, 5, 100, 1, False, False, "s"),))
    (chapter,) = [one for one in document(with_section, EN).chapters if one.title == "Geological sections"]
    warnings = [one.text for one in chapter.blocks if isinstance(one, Paragraph) and one.style == "warning"]
    assert ["earlier data or settings): T3/T2." in text for text in warnings] == [True]


def test_a_failed_verdict_stays_failed():
    report = accuracy_report([replace(horizon(epsilon=0.05), stale=CAUSES)], date="2026-11-21")
    (badge,) = [chapter.verdict for chapter in document(report, EN).chapters if chapter.verdict]
    assert badge == VerdictMark(False, "FAIL (stale)")

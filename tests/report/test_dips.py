"""Measured dips in the report: each figure of the document from the plain data, in both languages."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from results import ORIGIN, height, horizon

from geofit.data.languages import EN, ZH
from geofit.data.site import Orientations
from geofit.report.dip_blocks import dip_blocks
from geofit.report.document import Paragraph, Picture, ReportTable
from geofit.report.gather import accuracy_report, horizon_report
from geofit.report.pictures import draw_pictures
from geofit.report.schema import report_document


def measured(name, n=25):
    rng = np.random.default_rng(8)
    x, y = rng.uniform(-500, 1300, n), rng.uniform(-500, 500, n)
    gx = 0.04 + 12 / 260 * np.cos(x / 260) * np.cos(y / 310)
    gy = -0.02 - 12 / 310 * np.sin(x / 260) * np.sin(y / 310)
    azimuth, dip = np.degrees(np.arctan2(-gx, -gy)) % 360, np.degrees(np.arctan(np.hypot(gx, gy)))
    dip[3] += 50
    xyz = np.column_stack([x, y, height(x, y)]) + ORIGIN
    return Orientations(xyz, azimuth, dip, np.array([name] * n), np.array(["dips.csv"] * n), np.arange(n) + 2)


@pytest.fixture(scope="module")
def result():
    plain = horizon()
    return replace(plain, site=replace(plain.site, orientations=measured(plain.name)))


def test_the_plain_data_hold_every_dip_and_its_angle(result):
    lines = horizon_report(result).dips
    assert len(lines) == 25
    assert lines[3].angle == pytest.approx(50, abs=1.0)
    assert max(line.angle for k, line in enumerate(lines) if k != 3) < 1.0
    assert lines[3].file == "dips.csv"
    assert lines[3].row == 5
    written = report_document(accuracy_report([result], date="2026-01-01"))["horizons"][0]["dips"]
    assert [one["angle"] for one in written] == [line.angle for line in lines]


@pytest.mark.parametrize("t", [EN, ZH], ids=["en", "zh"])
def test_the_chapter_shows_the_net_and_the_worst_first(result, t):
    report = horizon_report(result)
    blocks = dip_blocks(report, t)
    table = next(block for block in blocks if isinstance(block, ReportTable))
    assert len(table.rows) == 20
    assert float(table.rows[0][4]) == pytest.approx(50, abs=1.0)
    picture = next(block for block in blocks if isinstance(block, Picture))
    assert draw_pictures(result, t).images[picture.name].startswith(b"\x89PNG")
    assert any("5" in block.text for block in blocks if isinstance(block, Paragraph) and block.style == "quiet")


def test_the_chapter_says_whether_the_fit_used_them(result):
    report = horizon_report(result)
    used = replace(report, settings={**report.settings, "dips": "fit", "dip_accuracy": 4.0})
    said = [next(b.text for b in dip_blocks(one, EN) if isinstance(b, Paragraph)) for one in (report, used)]
    assert "did not use them" in said[0]
    assert "accuracy of 4°" in said[1]


def test_no_dips_no_chapter():
    assert dip_blocks(horizon_report(horizon()), EN) == []

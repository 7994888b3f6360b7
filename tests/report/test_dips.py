"""Measured dips in the report: each figure of the document from the plain data, in both languages."""

from __future__ import annotations

import json
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


def test_blocks_of_a_faulted_horizon_list_the_dips_within_them(tmp_path):
    import faulted

    from geofit.project.run import run_horizons

    rng = np.random.default_rng(5)
    xy = rng.uniform(60, 940, (40, 2)) + faulted.ORIGIN
    step = 1.0
    z = faulted.truth(*xy.T)
    west = faulted.off(*xy.T, z) > 0
    clear = np.abs(faulted.off(*xy.T, z)) > 15
    gx, gy = (
        (faulted.HEIGHT(xy[:, 0] + dx, xy[:, 1] + dy) - faulted.HEIGHT(xy[:, 0] - dx, xy[:, 1] - dy)) / (2 * step)
        for dx, dy in ((step, 0), (0, step))
    )
    azimuth, dip = np.degrees(np.arctan2(-gx, -gy)) % 360, np.degrees(np.arctan(np.hypot(gx, gy)))
    n = len(xy)
    every = Orientations(
        np.column_stack([xy, z]), azimuth, dip, np.array(["T2"] * n), np.array(["dips.csv"] * n), np.arange(n) + 2
    )
    site = replace(faulted.faulted_site(), orientations=every)
    run = run_horizons(site, tmp_path, ("T2", "F1"), date="2026-01-01")
    written = {one["horizon"]: one for one in json.loads((tmp_path / "report.json").read_text("utf-8"))["horizons"]}
    blocks = {name: one for name, one in written.items() if name.startswith("T2")}
    assert len(blocks) == 2, "the fault parts the horizon"
    rows = [{line["row"] for line in one["dips"]} for one in blocks.values()]
    assert not rows[0] & rows[1]
    assert rows[0] | rows[1] >= set((np.flatnonzero(clear) + 2).tolist())
    sides = [{int(row) - 2 for row in one} & set(np.flatnonzero(clear).tolist()) for one in rows]
    assert all(len(set(west[sorted(side)].tolist())) == 1 for side in sides), "no dip is in the block of the other side"
    assert np.median([line["angle"] for one in blocks.values() for line in one["dips"]]) < 3.0
    for result in run.results:
        if result.name.startswith("T2"):
            assert any(isinstance(block, ReportTable) for block in dip_blocks(horizon_report(result), EN))
    assert not written["F1"]["dips"]


def test_no_dips_no_chapter():
    assert dip_blocks(horizon_report(horizon()), EN) == []

"""Contour plans on paper: to scale, with an interval that is asked for, as PDF, SVG and DXF."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import ezdxf
import numpy as np
import pypdfium2
import pytest
from matplotlib.figure import Figure

import geofit
from geofit.data.errors import SettingsError
from geofit.data.languages import EN, ZH, translate
from geofit.data.stale import StaleCause, stale_warning
from geofit.io.site_file import read_site
from geofit.project.plan_sheet import PlanOrder, write_plan_sheet
from geofit.report import plan_pages
from geofit.report.contour_plan import draw_map, map_corners
from geofit.report.paper import PAPERS, SheetTitle
from geofit.report.plan_pages import plan_scale, write_plan_pdf, write_plan_svg
from geofit.report.result import HorizonResult

NAME = "T3-T2"
BLOCK = SheetTitle("Contour plan", "Upper dam", "D-18", "N. N.", "2026-11-22")


@cache
def result():
    site = read_site(Path(__file__).parents[2] / "sample_data" / "site.toml")
    surface = geofit.fit_horizon(site.horizons[NAME], site.settings[NAME], boundary=site.boundary, name=NAME)
    return HorizonResult(surface, site)


@pytest.mark.parametrize("language", [EN, ZH], ids=["en", "zh"])
def test_the_page_has_its_size_its_scale_and_the_names_of_the_holes(tmp_path, language):
    scale = write_plan_pdf([result()], BLOCK, tmp_path / "p.pdf", language=language)
    pdf = pypdfium2.PdfDocument(tmp_path / "p.pdf")
    (page,) = pdf
    words = page.get_textpage().get_text_range()
    size = np.array(page.get_size()) * 25.4 / 72
    pdf.close()
    assert size == pytest.approx(PAPERS["A3"], abs=0.1)
    assert f"1:{scale}" in words
    assert NAME in words
    assert "D-18" in words
    assert sum(hole.name in words for hole in result().site.holes) > 20


@pytest.mark.parametrize("interval", [2.0, 5.0, 10.0])
def test_no_name_of_a_hole_covers_an_elevation_or_another_name(interval):
    axes = Figure(figsize=(5.5, 5.5), dpi=200).add_axes((0.1, 0.1, 0.85, 0.85))
    low, high = map_corners(result())
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    draw_map(axes, result(), interval, 119.0)
    holes = {hole.name for hole in result().site.holes}
    boxes = [(text.get_text(), text.get_window_extent()) for text in axes.texts]
    assert sum(name in holes for name, _ in boxes) > 20
    assert any(name.isdigit() for name, _ in boxes)
    named = [(name, box) for name, box in boxes if name in holes]
    assert not [
        (name, text) for name, box in named for text, other in boxes if other is not box and box.overlaps(other)
    ]


def test_a_metre_is_a_thousand_millimetres_over_the_scale(monkeypatch, tmp_path):
    drawn = {}

    def note(axes, given, interval, wide, t, unit, grid):
        box = axes.get_position()
        figure = axes.get_figure()
        drawn["mm"] = np.array([box.width, box.height]) * figure.get_size_inches() * 25.4
        drawn["interval"] = interval

    monkeypatch.setattr(plan_pages, "draw_map", note)
    scale = write_plan_pdf([result()], BLOCK, tmp_path / "p.pdf", interval=2.5, paper="A1")
    low, high = map_corners(result())
    assert drawn["mm"] == pytest.approx(1000 * (high - low) / scale)
    assert drawn["interval"] == 2.5


def test_a_larger_paper_has_a_larger_scale_and_one_too_large_is_refused(tmp_path):
    small, large = (plan_scale([result()], paper) for paper in ("A4", "A0"))
    assert large < small
    with pytest.raises(SettingsError) as caught:
        plan_scale([result()], "A4", 500)
    assert caught.value.message.code == "report.plan-scale-too-large"
    with pytest.raises(SettingsError):
        write_plan_svg([result()], BLOCK, tmp_path / "p.svg", interval=0.0)


def test_the_dxf_has_contours_at_their_elevations_and_every_hole(tmp_path):
    order = PlanOrder((NAME,), BLOCK, tmp_path / "plan", 5.0, ("pdf", "svg", "dxf"))
    _, files = write_plan_sheet(result().site, {NAME: result().surface}, order)
    assert [file.name for file in files] == ["plan.pdf", "plan.svg", "plan.dxf"]
    space = ezdxf.readfile(tmp_path / "plan.dxf").modelspace()
    lines = [one for one in space.query("LWPOLYLINE") if one.dxf.layer.startswith(NAME)]
    elevations = {one.dxf.elevation for one in lines}
    assert elevations
    assert all(value % 5 == 0 for value in elevations)
    assert {one.dxf.elevation for one in lines if one.dxf.layer.endswith("_heavy")} == {
        value for value in elevations if value % 25 == 0
    }
    line = lines[0]
    x, y = np.array([(x, y) for x, y, *_ in line.get_points()]).T
    z = result().surface.elevation(x, y)
    assert np.nanmax(np.abs(z - line.dxf.elevation)) < 0.01
    written = {text.dxf.text for text in space.query("TEXT")}
    assert {hole.name for hole in result().site.holes} <= written
    assert "Contour plan" in written


@pytest.mark.parametrize("language", [EN, ZH], ids=["en", "zh"])
def test_the_plan_of_a_stale_surface_warns_on_the_sheet_and_in_the_drawing(tmp_path, language):
    order = PlanOrder((NAME,), BLOCK, tmp_path / "plan", 10.0, ("pdf", "dxf"), language=language.code[:2])
    stale = {NAME: (StaleCause("data", "", "0123456789abcdef", "fedcba9876543210"),)}
    write_plan_sheet(result().site, {NAME: result().surface}, order, stale)
    pdf = pypdfium2.PdfDocument(tmp_path / "plan.pdf")
    words = pdf[0].get_textpage().get_text_range()
    pdf.close()
    text = translate(stale_warning([NAME]), language)
    assert text in words
    written = {one.dxf.text for one in ezdxf.readfile(tmp_path / "plan.dxf").modelspace().query("TEXT")}
    assert text in written


def test_the_same_plan_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        order = PlanOrder((NAME,), BLOCK, tmp_path / folder / "plan", None, ("pdf", "svg", "dxf"))
        write_plan_sheet(result().site, {NAME: result().surface}, order)
    for form in ("pdf", "svg", "dxf"):
        assert (tmp_path / "a" / f"plan.{form}").read_bytes() == (tmp_path / "b" / f"plan.{form}").read_bytes()

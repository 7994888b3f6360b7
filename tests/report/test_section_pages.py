"""The section sheet: true to its scale, the same bytes twice, words in two languages, and read by other programs."""

from __future__ import annotations

import re
from dataclasses import replace

import ezdxf
import numpy as np
import pypdfium2
import pytest

from geofit.data.errors import SettingsError
from geofit.data.languages import EN, ZH
from geofit.io.export.section_dxf import write_sheet_dxf
from geofit.prediction.section_bands import SectionBand
from geofit.report import section_pages
from geofit.report.furniture import scale_text
from geofit.report.paper import PAPERS, SCALES, SheetTitle
from geofit.report.section_pages import (
    fitting_scale,
    lithology_style,
    write_sheet_pdf,
    write_sheet_svg,
)
from geofit.report.style import drawing
from geofit.site.section_view import HoleTrack, Interval, SectionView, Trace

BLOCK = SheetTitle("Geological section", "Upper dam", "D-17", "N. N.", "2026-11-22")


def view(name="A", length=400.0, rise=60.0):
    x = np.linspace(0, length, 41)
    z = 100 + rise * np.sin(x / 90)
    half = len(x) // 2
    line = np.column_stack([x, z])[: half + 1]
    half_width = np.array([0.0, 2.0])
    band = SectionBand(line - half_width, line + half_width)
    low = (Trace(x[: half + 1], z[: half + 1], True, band), Trace(x[half:], z[half:], False))
    track = np.array([[0.25 * length, 140.0], [0.25 * length + 3, 60.0]])
    hole = HoleTrack("ZK1", track, 3.0, (Interval("clay", track, "a.csv"), Interval("岩", track, "b.csv")))
    line = np.array([[5e5, 3e6], [5e5 + length, 3e6]])
    ground = np.column_stack([x, np.full(41, 170.0)])
    points = {"low": np.column_stack([x[::5], z[::5]])}
    return SectionView(name, line, np.array([0.0, length]), 20.0, {"low": low}, ground, (hole,), points)


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize("length", [80.0, 400.0, 3300.0])
@pytest.mark.parametrize("exaggeration", [1.0, 2.0])
def test_a_drawing_is_as_long_as_its_scale_says(tmp_path, paper, length, exaggeration):
    shown = view(length=length)
    scale = fitting_scale([shown], paper, exaggeration)
    figure = section_pages.sheet_page([shown], shown, 1, BLOCK, paper, scale, exaggeration, EN)
    box, (wide, high) = figure.axes[0].get_position(), PAPERS[paper]
    assert box.width * wide == pytest.approx(1000 * length / scale)
    low, top = figure.axes[0].get_ylim()
    assert box.height * high == pytest.approx(1000 * exaggeration * (top - low) / scale)
    assert box.x0 * wide >= section_pages.EDGE + section_pages.LEFT - 1e-6
    assert box.x1 * wide <= wide - section_pages.EDGE - section_pages.LEGEND
    larger = [one for one in SCALES if one < scale]
    if larger:
        with pytest.raises(SettingsError, match=scale_text(scale)):
            write_sheet_pdf(
                [shown], BLOCK, tmp_path / "x.pdf", paper=paper, scale=larger[-1], exaggeration=exaggeration
            )


@pytest.mark.parametrize("language", [EN, ZH], ids=["en", "zh"])
def test_the_pdf_has_a_page_a_section_of_its_paper_with_the_title_block(tmp_path, language):
    views = [view("0+000"), view("0+100", 300.0)]
    scale = write_sheet_pdf(views, BLOCK, tmp_path / "s.pdf", language=language)
    pdf = pypdfium2.PdfDocument(tmp_path / "s.pdf")
    assert len(pdf) == 2
    words = []
    for page in pdf:
        assert [round(side / 72 * 25.4) for side in page.get_size()] == [420, 297]
        words.append(page.get_textpage().get_text_range())
    pdf.close()
    for word in (
        "Geological section · 0+000",
        "Upper dam",
        "D-17",
        "N. N.",
        "2026-11-22",
        f"1:{scale}",
        "1 / 2",
        "ZK1",
    ):
        assert word in words[0], word
    assert ("above ground" in words[0]) == (language is EN)
    assert "2 / 2" in words[1]


@pytest.mark.parametrize("language", [EN, ZH], ids=["en", "zh"])
def test_a_sheet_names_the_surfaces_on_it_that_are_older_than_their_data(tmp_path, language):
    views = [replace(view("0+000"), stale=("low", "透镜体")), view("0+100")]
    write_sheet_pdf(views, BLOCK, tmp_path / "s.pdf", language=language)
    pdf = pypdfium2.PdfDocument(tmp_path / "s.pdf")
    first, second = (page.get_textpage().get_text_range() for page in pdf)
    pdf.close()
    word = "Stale" if language is EN else "已过时"
    assert word in first
    assert "low" in first
    assert "透镜体" in first
    assert word not in second
    write_sheet_dxf(views, "Section", tmp_path / "s.dxf", language=language)
    space = ezdxf.readfile(tmp_path / "s.dxf").modelspace()
    (warning,) = [text.dxf.text for text in space.query("TEXT") if word in text.dxf.text]
    assert "透镜体" in warning


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize("language", [EN, ZH], ids=["en", "zh"])
def test_the_warning_of_many_stale_surfaces_stays_within_the_frame(paper, language):
    names = tuple(f"base of the weathered zone {k}" for k in range(60))
    shown = replace(view(), stale=names)
    scale = fitting_scale([shown], paper)
    word = "Stale" if language is EN else "已过时"
    with drawing(8.0):
        figure = section_pages.sheet_page([shown], shown, 1, BLOCK, paper, scale, 1.0, language)
        (warning,) = [text for text in figure.texts if word in text.get_text()]
        box = warning.get_window_extent().transformed(figure.transFigure.inverted())
    wide = PAPERS[paper][0]
    assert box.x1 * wide < wide - section_pages.EDGE
    assert names[0] in warning.get_text()
    assert names[-1] not in warning.get_text()


def test_the_same_sheet_is_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        write_sheet_pdf([view()], BLOCK, tmp_path / f"{name}.pdf")
        write_sheet_svg([view()], BLOCK, tmp_path / f"{name}.svg")
        write_sheet_dxf([view()], BLOCK.title, tmp_path / f"{name}.dxf")
    for end in ("pdf", "svg", "dxf"):
        assert (tmp_path / f"a.{end}").read_bytes() == (tmp_path / f"b.{end}").read_bytes(), end


def test_several_sections_are_several_svg_files_of_the_paper_size(tmp_path):
    files = write_sheet_svg([view("0+000"), view("0+100")], BLOCK, tmp_path / "s.svg", paper="A4")
    assert [file.name for file in files] == ["s_0_000.svg", "s_0_100.svg"]
    head = files[0].read_text("utf-8")[:900]
    width = float(re.search(r'width="([\d.]+)pt"', head)[1])
    assert width / 72 * 25.4 == pytest.approx(297, abs=0.5)


def test_every_code_has_a_colour_and_a_pattern_of_its_own():
    codes = [f"c{k:02d}" for k in range(40)]
    assert len(set(lithology_style(codes).values())) == 40
    assert lithology_style(codes[::-1]) == lithology_style(codes)


def test_cad_reads_horizons_holes_and_lithology_on_layers_of_their_own(tmp_path):
    write_sheet_dxf([view("0+000"), view("0+100")], "Section", tmp_path / "s.dxf")
    document = ezdxf.readfile(tmp_path / "s.dxf")
    assert not document.audit().errors
    assert document.units == ezdxf.units.M
    layers = {layer.dxf.name for layer in document.layers}
    assert {"low", "low_inferred", "low_band", "low_points", "LITH_clay", "LITH_岩", "GROUND", "HOLES"} <= layers
    space = document.modelspace()
    solid = list(space.query('LWPOLYLINE[layer=="low"]'))
    assert len(solid) == 2
    first = np.array([point[:2] for point in solid[0].get_points()])
    trace = view().traces["low"][0]
    np.testing.assert_allclose(first[:, 0], trace.distance)
    np.testing.assert_allclose(np.diff(first[:, 1]), np.diff(trace.z), atol=1e-9)
    dashed = space.query('LWPOLYLINE[layer=="low_inferred"]').first
    assert dashed.dxf.linetype == "DASHED_SECTION"
    assert len(space.query("HATCH")) == 4
    second = np.array([point[:2] for point in solid[1].get_points()])
    assert second[:, 1].max() < first[:, 1].min(), "one below the other"


@pytest.mark.parametrize("wrong", [{"paper": "A9"}, {"exaggeration": 0.0}])
def test_a_sheet_that_cannot_be_is_refused(tmp_path, wrong):
    with pytest.raises(SettingsError, match="A sheet needs"):
        write_sheet_pdf([view()], BLOCK, tmp_path / "s.pdf", **wrong)
    assert not list(tmp_path.iterdir())

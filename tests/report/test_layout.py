"""The report as a reviewer reads it: title block, contents, drawings to scale, no near-empty page, no torn table."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import numpy as np
import pytest
from fpdf import FPDF
from matplotlib.backends.backend_agg import FigureCanvasAgg
from results import examined, horizon

from geofit.data.errors import MissingDependencyError
from geofit.data.languages import EN, ZH
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Ground, Hole, Section, Site
from geofit.data.title_block import Revision, TitleBlock
from geofit.fitting.pipeline import fit_horizon
from geofit.report import fonts, scene
from geofit.report.chapters import document
from geofit.report.document import (
    Chapter,
    Column,
    Heading,
    Paragraph,
    Picture,
    ReportDocument,
    ReportTable,
    Signatures,
)
from geofit.report.furniture import exaggeration_for, scale_for, scale_text
from geofit.report.gather import accuracy_report
from geofit.report.html import write_html
from geofit.report.interventions import interventions
from geofit.report.length_axis import upright
from geofit.report.pdf import write_pdf
from geofit.report.pdf_table import FEWEST, LaidTable, page_ends
from geofit.report.pdf_text import Pen, Typesetter
from geofit.report.pictures import draw_pictures, draw_sections, draw_site
from geofit.report.profile import Profile, along_polyline, profiles, report_sections
from geofit.report.scene import network_scene
from geofit.report.section_sheet import draw_section, section_sheet
from geofit.report.style import horizon_colours
from geofit.report.view import cut_edges, rims

pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
Image = pytest.importorskip("PIL.Image", reason="Pillow comes with fpdf2")

NO_FONT = fonts.chinese_family() is None
TITLE = TitleBlock(
    project="HB-2026", client="River Company", document="GEO-012", status="for review", author="Li Wen",
    checker="Zhang", revisions=(Revision("A", "2026-01-02", "First issue", "Li Wen"), Revision("B", "2026-03-04")),
)  # fmt: skip


def with_surroundings(result):
    """The same horizon on a site with a title, a ground 40 m above it, and two section lines."""
    origin = np.array([500_000.0, 3_100_000.0])
    x, y = np.linspace(-800, 1600, 25) + origin[0], np.linspace(-700, 700, 15) + origin[1]
    ground = Ground(x, y, np.full((15, 25), 1560.0))
    lines = (
        Section("A", np.add(origin, [[-600.0, 0.0], [1400.0, 0.0]])),
        Section("B", np.add(origin, [[300.0, -550.0], [300.0, 550.0]])),
    )
    return replace(result, site=replace(result.site, title=TITLE, ground=ground, sections=lines))


@pytest.fixture(scope="module")
def results():
    made = [with_surroundings(examined(horizon())), with_surroundings(horizon(name="T2/T1", epsilon=0.05))]
    sections = report_sections(made[0].site, [one.surface.points for one in made])
    return [replace(one, profiles=profiles(one.surface, one.prediction, sections)) for one in made], sections


@pytest.fixture(scope="module")
def report(results):
    return accuracy_report(results[0], [], sections=results[1], date="2026-11-21")


@pytest.fixture(scope="module")
def images(results):
    made, sections = results
    found = {**draw_site(made).images, **draw_sections(made, sections)}
    for one in made:
        found |= draw_pictures(one).images
    return found


def _pages(path):
    pdf = pdfium.PdfDocument(path)
    texts = [re.sub(r"\s+", " ", pdf[i].get_textpage().get_text_range()) for i in range(len(pdf))]
    pictures = [np.asarray(pdf[i].render(scale=0.5).to_pil().convert("L")) for i in range(len(pdf))]
    pdf.close()
    return texts, pictures


@pytest.fixture(scope="module")
def pages(report, images, tmp_path_factory):
    path = tmp_path_factory.mktemp("layout") / "r.pdf"
    write_pdf(document(report, EN), images, path)
    return _pages(path)


def test_the_title_block_stands_on_the_cover_and_in_the_running_head(pages):
    texts, _ = pages
    for word in ("HB-2026", "River Company", "GEO-012", "for review", "Li Wen", "Zhang", "First issue", "2026-03-04"):
        assert word in texts[0], word
    assert all("GEO-012 · Rev. B" in text for text in texts[1:])


def test_long_names_of_the_title_block_are_whole_and_stay_in_their_cells(report, images, tmp_path):
    client, author = "Heishui River Hydropower Development and Investment Company", "Li Wen, Zhang San and Wang Wu"
    long = replace(report, title=replace(TITLE, client=client, author=author))
    write_pdf(document(long, EN), images, tmp_path / "r.pdf")
    pdf = pdfium.PdfDocument(tmp_path / "r.pdf")
    text = pdf[0].get_textpage()
    for words, right in ((client, 192.0), (author, 192.0)):
        assert words in re.sub(r"\s+", " ", text.get_text_range())
        place = text.search(words).get_next()
        boxes = [text.get_charbox(place[0] + k) for k in range(place[1])]
        assert max(box[2] for box in boxes) < right / 25.4 * 72
    # The second time as who prepared it: left of the line beside the signature.
    found, last = text.search(author), None
    while (place := found.get_next()) is not None:
        last = place
    first = 18 + 26 + (174 - 26) / 3
    assert max(text.get_charbox(last[0] + k)[2] for k in range(last[1])) < first / 25.4 * 72
    pdf.close()


def test_the_signatures_stay_on_the_cover_however_many_revisions_there_are(report, images, tmp_path):
    revisions = tuple(Revision(chr(65 + k), f"2026-01-{k + 1:02d}", "Change", "Li Wen") for k in range(8))
    long = replace(report, title=replace(TITLE, revisions=revisions))
    write_pdf(document(long, EN), images, tmp_path / "r.pdf")
    texts, _ = _pages(tmp_path / "r.pdf")
    assert "Approved" in texts[0]
    assert "Contents" in texts[1]


def test_the_contents_name_the_page_on_which_each_chapter_begins(pages, report):
    texts, _ = pages
    chapters = [chapter.title for chapter in document(report, EN).chapters[1:]]
    assert "Contents" in texts[1]
    for title in chapters:
        page = int(re.search(re.escape(title) + r" (\d+)", texts[1])[1])
        assert title in texts[page - 1]
    assert f"{len(texts)} / {len(texts)}" in texts[-1]


def test_no_page_is_nearly_empty(pages):
    _, pictures = pages
    for i, page in enumerate(pictures[1:-1], 2):
        tall = page.shape[0]
        body = page[int(0.075 * tall) : int(0.945 * tall)]
        rows = np.flatnonzero((body < 200).any(axis=1))
        assert rows.size
        assert rows[-1] / len(body) > 0.33, f"page {i} ends at {rows[-1] / len(body):.0%}"


def test_a_drawing_keeps_its_scale_on_paper(results, report, images):
    _, sections = results
    (plan,) = [
        b for c in document(report, EN).chapters for b in c.blocks if isinstance(b, Picture) and b.name == "plan/T3/T2"
    ]
    assert plan.to_scale
    assert f"scale {scale_text(report.horizons[0].plan.scale)}" in plan.caption
    for sheet, section in zip(report.sections, sections, strict=True):
        picture = np.asarray(Image.open(io.BytesIO(images[sheet.picture])).convert("L"))
        assert picture.shape[1] == round(174 / 25.4 * 200)
        # The frame of the drawing: its sides are the longest dark columns.
        dark = np.flatnonzero((picture < 170).sum(axis=0) > 0.3 * picture.shape[0])
        wide = (dark[-1] - dark[0]) / 200 * 25.4
        length = float(np.linalg.norm(section.line[-1] - section.line[0]))
        assert wide == pytest.approx(length * 1000 / sheet.scale, abs=0.6)
        tall = (sheet.high - sheet.low) * 1000 / sheet.scale * sheet.exaggeration
        assert 20 < tall < 151


def test_sections_hold_the_line_its_band_and_what_lies_above_the_ground(results):
    made, sections = results
    (line,) = made[0].profiles["A"]
    assert (line.line[0, 0], line.line[-1, 0]) == pytest.approx((0.0, 2000.0), abs=1e-6)
    xy = np.column_stack([499_400.0 + line.line[:, 0], np.full(len(line.line), 3_100_000.0)])
    np.testing.assert_allclose(made[0].surface.elevation(*xy.T), line.line[:, 1], atol=1e-6)
    assert line.band is None  # nothing stands behind a surface that was made by hand
    s, off = along_polyline(sections[0].line, np.array([[500_000.0, 3_100_030.0], [499_300.0, 3_100_000.0]]))
    assert (s.tolist(), off.tolist()) == ([600.0, 0.0], [30.0, 100.0])


def test_a_site_without_sections_is_cut_along_and_across():
    result = horizon()
    site = replace(result.site, sections=())
    first, second = report_sections(site, [result.surface.points])
    ways = [one.line[1] - one.line[0] for one in (first, second)]
    assert abs(ways[0] @ ways[1]) < 1e-6 * np.hypot(*ways[0]) * np.hypot(*ways[1])
    assert np.hypot(*ways[0]) > np.hypot(*ways[1])
    assert (first.name, second.name) == ("A", "B")
    named = replace(site, horizons={"A": result.surface.points})
    assert [one.name for one in report_sections(named, [result.surface.points])] == ["B", "C"]


@pytest.mark.parametrize(("length", "room"), [(1500.0, 150.0), (87.3, 150.0), (12_345.0, 146.0), (0.4, 100.0)])
def test_a_scale_is_a_usual_one_that_fits(length, room):
    scale = scale_for(length, room)
    assert length * 1000 / scale <= room * (1 + 1e-9) or scale == 1
    assert re.fullmatch(r"(1|2|25|5)0*", str(scale))
    assert exaggeration_for(0.01 * length, scale, room) in (1, 2, 5, 10)


class _Ruler:
    """Every character is a millimetre wide."""

    def width(self, text, pen):
        return float(len(text))

    def lines(self, text, room, pen):
        return [text]


@pytest.mark.parametrize("room", [20.0, 60.0, 100.0, 180.0, 250.0])
@pytest.mark.parametrize("count", [1, 3, 5, 11, 23, 24, 45, 46, 47, 100, 300])
def test_no_table_is_torn_by_a_row_or_two(count, room):
    table = ReportTable((Column("a"), Column("b", "number")), tuple((f"r{k}", str(k)) for k in range(count)))
    laid = LaidTable(table, 170.0, _Ruler())
    ends = page_ends(laid, room, 250.0)
    turned, ends = ends[0] == 0, [end for end in ends if end]
    assert ends[-1] == count
    parts = np.diff([0, *ends])
    assert (parts > 0).all()
    heights = [laid.head_height + sum(laid.heights[a:b]) for a, b in zip([0, *ends], ends, strict=False)]
    assert heights[0] <= (250.0 if turned else room)
    assert max(heights) <= 250.0
    if len(parts) > 1:
        assert parts.min() >= FEWEST


@pytest.mark.parametrize(("rows", "pages"), [(32, 1), (34, 1), (38, 1), (60, 2)])
def test_a_few_lines_do_not_take_a_page_of_their_own(rows, pages, tmp_path):
    columns = (Column("a"), Column("b", "number"))
    table = ReportTable(columns, tuple((f"r{k}", str(k)) for k in range(rows)))
    tail = (Heading("Tail"), ReportTable(columns, (("last", "1"), ("row", "2"))))
    chapters = (Chapter("Cover", ()), Chapter("Text", (table, *tail)))
    write_pdf(ReportDocument("R", "S", "R", "2026-01-02", "en", "geofit", chapters), {}, tmp_path / "r.pdf")
    texts, _ = _pages(tmp_path / "r.pdf")
    assert len(texts) == 1 + pages
    assert "last" in texts[-1]


def test_a_heading_stands_on_the_page_of_its_table_wherever_it_falls(tmp_path):
    columns = (Column("a"), Column("b", "number"))

    def chapter(k):
        lines = tuple(Paragraph(f"line {i}", "quiet") for i in range(k % 6))
        filler = ReportTable(columns, tuple((f"r{i}", str(i)) for i in range(14 + k // 6)))
        table = ReportTable(columns, tuple((f"first {k}." if i == 0 else f"t{i}", str(i)) for i in range(10)))
        return Chapter(f"Chapter {k}", (*lines, filler, Heading(f"Tail {k}.", 3), table))

    chapters = (Chapter("Cover", ()), *map(chapter, range(84)))
    write_pdf(ReportDocument("R", "S", "R", "2026-01-02", "en", "geofit", chapters), {}, tmp_path / "r.pdf")
    texts, _ = _pages(tmp_path / "r.pdf")
    torn = [k for k in range(84) for text in texts if (f"Tail {k}." in text) != (f"first {k}." in text)]
    assert not torn


def test_the_contents_list_a_heading_although_an_annex_has_one_of_the_same_name(tmp_path):
    chapters = (
        Chapter("Cover", ()),
        Chapter("Text", (Heading("Checks"),)),
        Chapter("Annex", (Heading("Checks"),), listed=False),
    )
    pages = ReportDocument("R", "S", "R", "2026-01-02", "en", "geofit", chapters, contents="Contents")
    write_pdf(pages, {}, tmp_path / "r.pdf")
    texts, _ = _pages(tmp_path / "r.pdf")
    assert texts[1].count("Checks") == 1


def test_two_lines_about_the_site_share_their_page_with_the_interventions(report, tmp_path):
    whole = document(report, EN)
    site, others = (one for one in whole.chapters if one.title.startswith(("The site as", "Excluded")))
    chapters = (whole.chapters[0], replace(site, follows=False), others)
    write_pdf(replace(whole, chapters=chapters, contents=""), {}, tmp_path / "r.pdf")
    texts, _ = _pages(tmp_path / "r.pdf")
    assert "Order of the horizons" in texts[1]
    assert "No point was left out by hand" in texts[1]


@pytest.mark.parametrize(("seen", "nothing"), [((), False), (("T2",), True), (("T2", "T3"), True)])
def test_outliers_and_holes_that_were_not_looked_for_are_not_reported_as_none(seen, nothing):
    made = [examined(one) if one.name in seen else one for one in (horizon(name="T2"), horizon(name="T3"))]
    report = accuracy_report(made, [])
    clean = [
        replace(one, prediction=replace(one.prediction, outliers=(), suggestions=())) if one.prediction else one
        for one in report.horizons
    ]
    words = [
        block.text
        for block in interventions(replace(report, horizons=tuple(clean)), EN).blocks
        if isinstance(block, Paragraph)
    ]
    missing = [name for name in ("T2", "T3") if name not in seen]
    assert words.count(f"Not examined: {', '.join(missing)}.") == (2 if missing else 0)
    assert ("None." in words) == ("No holes are suggested." in words) == nothing


def test_the_legend_of_a_section_names_the_kinds_of_holes_that_are_drawn():
    near, far = ([[x, 0.0, 1500.0], [x, 0.0, 1400.0]] for x in (500.0, 9000.0))
    depth = np.array([0.0, 100.0])
    holes = (Hole("ZK1", "borehole", depth, np.array(near)), Hole("PD1", "adit", depth, np.array(far)))
    section = Section("L", np.array([[0.0, 0.0], [1000.0, 0.0]]))
    ground = Ground(np.array([0.0, 1000.0]), np.array([-10.0, 10.0]), np.full((2, 2), 1500.0))
    site = Site("dam", {}, ground=ground, holes=holes)
    figure = draw_section(section_sheet(section, site, {}, "L"), section, site, {}, {})
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "borehole" in words
    assert "adit" not in words


def test_a_horizon_keeps_its_colour_in_a_report_of_some_horizons():
    section = Section("L", np.array([[0.0, 0.0], [1000.0, 0.0]]))
    none = PointSet(np.zeros((0, 3)))
    ground = Ground(np.array([0.0, 1000.0]), np.array([-10.0, 10.0]), np.full((2, 2), 1500.0))
    site = Site("dam", {"upper": none, "lower": none}, ground=ground)
    cut = {"lower": [Profile("lower", np.array([[0.0, 1400.0], [1000.0, 1410.0]]))]}
    figure = draw_section(section_sheet(section, site, cut, "L"), section, site, cut, {})
    assert horizon_colours(site.horizons)["lower"] in [line.get_color() for line in figure.axes[0].lines]


def test_blocks_of_a_horizon_have_its_colour_in_a_section():
    section = Section("L", np.array([[0.0, 0.0], [1000.0, 0.0]]))
    none = PointSet(np.zeros((0, 3)))
    site = Site("dam", {"upper": none, "lower": none}, blocks={"upper (A)": "upper", "upper (B)": "upper"})
    lines = {"upper (A)": ((0.0, 1400.0), (400.0, 1405.0)), "upper (B)": ((400.0, 1380.0), (1000.0, 1390.0))}
    cut = {name: [Profile(name, np.array(line))] for name, line in lines.items()}
    figure = draw_section(section_sheet(section, site, cut, "L"), section, site, cut, {})
    shown = [line.get_color() for line in figure.axes[0].lines]
    assert shown.count(horizon_colours(site.horizons)["upper"]) == 4, "each line above the ground and below it"
    assert horizon_colours(site.horizons)["lower"] not in shown


def test_a_horizon_has_its_colour_in_the_picture_of_a_report_of_some_horizons(monkeypatch):
    drawn = []

    def refuse(surfaces, colours, holes):
        drawn.append(list(colours))
        raise MissingDependencyError(message("test.text", "no display"))

    monkeypatch.setattr(scene, "site_scene", refuse)
    of = horizon(name="lower")
    site = replace(of.site, horizons=dict.fromkeys(("upper", "lower"), of.surface.points))
    draw_site([replace(of, site=site)])
    block = replace(of.surface, name="lower (A)")
    draw_site([replace(of, site=site, surface=block, horizon="lower")])
    assert drawn == [[horizon_colours(site.horizons)["lower"]]] * 2


def test_names_of_holes_at_the_ends_of_a_section_keep_clear_of_those_of_the_ends():
    depth = np.array([0.0, 100.0])
    tops = ((4.0, "REX-16-086"), (500.0, "B1"), (990.0, "CA37_5_PLUS_1A"))
    holes = tuple(Hole(name, "borehole", depth, np.array([[x, 0, 1530.0], [x, 0, 1400.0]])) for x, name in tops)
    section = Section("L", np.array([[0.0, 0.0], [1000.0, 0.0]]))
    ground = Ground(np.array([0.0, 1000.0]), np.array([-10.0, 10.0]), np.array([[1300.0, 1500.0]] * 2))
    site = Site("dam", {}, ground=ground, holes=holes)
    figure = draw_section(section_sheet(section, site, {}, "L"), section, site, {}, {})
    (axes,) = figure.axes
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = {text.get_text().split(" ")[0]: text.get_window_extent(renderer) for text in axes.texts}
    ends = [boxes[name] for name in ("L", "L′")]
    assert not any(boxes[name].overlaps(end) for _, name in tops for end in ends)
    assert all(box.y1 <= figure.bbox.y1 for box in boxes.values()), "the names are on the sheet"
    (top,) = {round(axes.transData.transform((0, high))[1]) for high in axes.get_ylim()[1:]}
    collars = [line for line in axes.lines if line.get_marker() == "v"]
    assert all(axes.transData.transform(line.get_xydata())[0, 1] <= top for line in collars), "no collar floats above"


@pytest.fixture
def chinese_type():
    """A typesetter with the fonts of a Chinese report, whose files are closed at the end."""
    pdf, found = FPDF(), fonts.pdf_fonts(chinese=True)
    for family, font in (("text", found.regular), ("signs", found.signs)):
        pdf.add_font(family, "", font.path, collection_font_number=font.index)
    yield Typesetter(pdf)
    for font in pdf.fonts.values():
        font.close()


@pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters")
def test_chinese_lines_hold_units_to_numbers_and_end_with_two_characters(chinese_type):
    type_, pen = chinese_type, Pen(8.0)
    text = "留出误差 2.061 m = 4.1 ε（留一分块法）；90 % 预测带含 90 %（留一钻孔），最大高差，m"
    for room in np.arange(20.0, 80.0, 0.7):
        lines = type_.lines(text, room, pen)
        assert "".join(lines).replace(" ", "") == text.replace(" ", "")
        assert all(type_.width(line, pen) <= room for line in lines)
        assert not [line for line in lines if re.match(r"[%mε]", line)]
    for room in np.arange(12.0, 30.0, 0.7):
        last = type_.lines("二十五项检查中二十五项合格", room, pen)[-1]
        assert len(last) > 1


def test_a_network_is_drawn_whole_with_the_box_of_its_sample():
    size = np.array([1.0, 1.0, 1.0])
    scene = network_scene(np.array([[0.5, 0.5, 0.2], [0.5, 0.5, 0.8]]), np.array([0.3, 0.1]), np.array([[0, 1]]), size)
    corners = np.array([[x, y, z, 1.0] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    flat = corners @ scene.to_pixels.T
    assert (flat > -1).all()
    assert (flat < np.array(scene.image.shape[1::-1]) + 1).all()


@pytest.mark.parametrize("places", [(0.0, 100.0), (3.0, 50.0, 97.0)])
def test_numbers_along_a_vertical_axis_end_with_it(places):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(3, 2), dpi=200)
    canvas, axes = FigureCanvasAgg(figure), figure.add_axes((0.2, 0.05, 0.7, 0.93))
    axes.set_ylim(7_822_000.0, 7_822_100.0)
    axes.set_yticks([7_822_000.0 + place for place in places], [f"7 822 {place:03.0f}" for place in places])
    upright(axes)
    canvas.draw()
    frame = axes.get_window_extent()
    boxes = [label.get_window_extent() for label in axes.get_yticklabels()]
    assert all(frame.y0 - 2 <= box.y0 and box.y1 <= frame.y1 + 2 for box in boxes)
    assert all(box.height > box.width for box in boxes)


@pytest.mark.parametrize(
    "t", [EN, pytest.param(ZH, marks=pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters"))]
)
def test_each_language_has_its_usual_signatures_and_punctuation(report, images, t, tmp_path):
    pages = document(report, t)
    (signed,) = [block for block in pages.chapters[0].blocks if isinstance(block, Signatures)]
    roles = [role for role, _ in signed.roles]
    assert roles == (["Prepared", "Checked", "Approved"] if t is EN else ["批准", "审定", "审查", "校核", "编制"])
    assert dict(signed.roles)["Prepared" if t is EN else "编制"] == "Li Wen"
    write_html(pages, images, tmp_path / "r.html")
    page = re.sub(r"<style>.*?</style>", "", (tmp_path / "r.html").read_text(encoding="utf-8"), flags=re.S)
    text = re.sub(r"<[^>]+>|base64,[^\"]+", "\n", page)
    assert not re.findall(r"[\u4e00-\u9fff] ?[,;:](?= |[\u4e00-\u9fff])", text)


def test_a_section_that_cuts_no_horizon_is_as_high_as_its_ground():
    ground = Ground(np.array([0.0, 200.0]), np.array([0.0, 200.0]), np.array([[1480.0, 1500.0], [1490.0, 1510.0]]))
    section = Section("L", np.array([[10.0, 10.0], [190.0, 190.0]]))
    sheet = section_sheet(section, Site("dam", {}, ground=ground), {}, "section-L")
    assert sheet.low > 1470
    assert sheet.high < 1520


def test_a_steep_surface_that_the_study_area_cuts_has_a_closed_rim():
    """The rim was open where the area ends it: the picture showed lines above and below, and none at the ends."""
    x, z = (part.ravel() for part in np.meshgrid(np.linspace(0, 300, 13), np.linspace(0, 100, 6)))
    points = PointSet(np.column_stack([x, 0.2 * z + 0.5 * np.sin(x / 60), z]))
    area = np.array([[60.0, -50], [240, -50], [240, 90], [60, 90]])
    fit = fit_horizon(points, FitSettings(frame="best-plane"), area, name="F")
    assert len(fit.patches) == 1
    (name,) = rims(fit)
    lines = cut_edges(fit, name)
    assert sorted(round(float(line[:, 0].mean())) for line in lines) == [60, 240]
    for line in lines:
        assert np.ptp(line[:, 0]) < 1e-6
        assert (line[:, 2].min(), line[:, 2].max()) == pytest.approx((0, 100), abs=2)
    whole = fit_horizon(points, FitSettings(frame="best-plane"), name="F")
    assert not cut_edges(whole, name)

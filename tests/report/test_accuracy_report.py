"""The accuracy report: every headline figure in HTML and PDF against the JSON, in both languages."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from results import examined, horizon

from geofit.data.errors import MissingDependencyError
from geofit.data.languages import EN, ZH
from geofit.data.messages import message
from geofit.data.site import TableCount
from geofit.report import fonts
from geofit.report.accuracy_report import AccuracyReport
from geofit.report.chapters import document
from geofit.report.digits import metres
from geofit.report.gather import accuracy_report, inputs_of, today
from geofit.report.html import write_html
from geofit.report.pdf import write_pdf
from geofit.report.pictures import draw_pictures, draw_site
from geofit.report.schema import report_document, to_json, write_json
from geofit.site.order import Order
from geofit.site.overlap import HorizonCrossing

pdfium = pytest.importorskip("pypdfium2", reason="PDFium reads the PDF back; it comes with the extra 'test'")
pypdf = pytest.importorskip("pypdf", reason="pypdf reads the PDF's fonts; it comes with the extra 'test'")

DATE = "2026-11-21"
NO_FONT = fonts.chinese_family() is None
LANGUAGES = (
    EN,
    pytest.param(ZH, marks=pytest.mark.skipif(NO_FONT, reason="no font with Chinese characters on this machine")),
)


def order() -> Order:
    """Two horizons that cross once."""
    crossing = HorizonCrossing(
        area=532.0, volume=1_234_567.0, x=500_123.4, y=3_100_456.7, depth=1.234, lines=(), in_air=0.0
    )
    places = ((500_123.4, 3_100_456.7), (500_900.0, 3_100_000.0))
    return Order("T3/T2", "T2/T1", 2e5, -1.234, 11.5, 30.0, *places, (crossing,))


@pytest.fixture(scope="module")
def results():
    return [examined(horizon()), horizon(name="T2/T1", epsilon=0.05)]


@pytest.fixture(scope="module")
def report(results) -> AccuracyReport:
    return accuracy_report(results, [order()], failures={"T9": "1 point given"}, date=DATE)


@pytest.fixture(scope="module")
def images(results):
    found = dict(draw_site(results).images)
    for result in results:
        found |= draw_pictures(result).images
    return found


@pytest.fixture(scope="module", params=LANGUAGES, ids=lambda t: t.code)
def written(request, report, images, tmp_path_factory):
    """Folder with the report in a language."""
    folder = tmp_path_factory.mktemp(request.param.code)
    pages = document(report, request.param)
    write_json(report_document(report), folder / "report.json")
    write_html(pages, images, folder / "report.html")
    write_pdf(pages, images, folder / "report.pdf")
    return folder, request.param


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
        return _plain(" ".join(self.words))


def _plain(text: str) -> str:
    return re.sub(r"\s+", " ", text)


def _pages(path: Path) -> list[str]:
    """Text of each page by PDFium; pypdf takes the two-byte codes of a CFF font with its own CMap for single ones."""
    pdf = pdfium.PdfDocument(path)
    try:
        return [_plain(pdf[i].get_textpage().get_text_range()) for i in range(len(pdf))]
    finally:
        pdf.close()


def _pdf(path: Path) -> str:
    return " ".join(_pages(path))


def _numbers(text: str) -> list[float]:
    """Every number of a text, as a person reads it: also with groups of three joined; the minus sign understood."""
    text = str(text).replace("−", "-")
    joined = re.sub(r"(?<=\d) (?=\d{3}(?!\d))", "", text)
    return [float(found) for one in (text, joined) for found in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", one)]


def _holds(numbers: list[float], value: float) -> bool:
    """Whether a figure stands in a text with at least three significant digits, or to the millimetre."""
    room = max(0.00501 * 10.0 ** -max(0, -_exponent(value)), 0.00051) if value else 0.0
    return any(abs(number - value) <= min(room, 0.006 * abs(value)) for number in numbers)


def _exponent(value: float) -> int:
    return int(f"{abs(value):e}".split("e")[1])


def test_the_json_names_every_horizon_and_holds_no_nan(report):
    text = to_json(report_document(report))
    assert [one["horizon"] for one in json.loads(text)["horizons"]] == [one.name for one in report.horizons]
    assert json.loads(text)["horizons"][0]["verdict"] == "WARNING"
    assert "NaN" not in text


def test_every_headline_figure_of_the_json_stands_in_html_and_pdf(written):
    folder, t = written
    data = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    pages = {
        "HTML": _Page((folder / "report.html").read_text(encoding="utf-8")).text,
        "PDF": _pdf(folder / "report.pdf"),
    }
    for form, text in pages.items():
        numbers = _numbers(text)
        for h in data["horizons"]:
            figures = {key: h[key] for key in ("sigma", "epsilon", "max_abs", "mean", "n_points", "n_core")}
            figures["periphery sigma"] = h["periphery"]["sigma"]
            figures |= {f"worst {i}": p["residual"] for i, p in enumerate(h["worst"])}
            figures |= {f"row {i}": p["row"] for i, p in enumerate(h["worst"])}
            figures |= {f"{g['by']} {g['name']}": g["sigma"] for g in h["groups"] if g["sigma"] > 1e-9}
            figures |= {f"seam {i}": s["angle"] for i, s in enumerate(h["seams"])}
            if h["prediction"]:
                for scheme in h["prediction"]["left_out"]:
                    figures |= {f"{scheme['scheme']} {k}": scheme[k] for k in ("rms", "bias", "max_abs", "points")}
                    figures |= dict(scheme["references"])
                    figures[scheme["scheme"] + " inside"] = 100 * scheme["inside"]
                figures |= {k: h["prediction"][k] for k in ("factor", "sd_mean", "sd_max")}
                for i, hole in enumerate(h["prediction"]["suggestions"]):
                    figures |= {f"hole {i} {k}": hole[k] for k in ("x", "y", "sd", "mean_after", "max_after")}
                figures |= {f"outlier {k}": h["prediction"]["outliers"][0][k] for k in ("error", "sd", "ratio")}
            absent = [name for name, value in figures.items() if not _holds(numbers, value)]
            assert not absent, f"{form} {t.code} {h['horizon']}: {absent}"
        pair = data["orders"][0]
        for key in ("minimum", "mean", "crossing_area", "crossing_volume"):
            assert _holds(numbers, pair[key]), f"{form}: {key}"
        for inputs in data["inputs"]:
            assert inputs["sha256"] in str(text).replace(" ", "")


def test_the_verdict_stands_in_words_behind_the_horizon(written):
    folder, t = written
    warning, failed = ("WARNING", "FAIL") if t is EN else ("警告", "不合格")
    for text in (_Page((folder / "report.html").read_text(encoding="utf-8")).text, _pdf(folder / "report.pdf")):
        assert re.search(rf"T3/T2 ! {warning} 0\.\d+ 0\.5 ", text)
        assert re.search(rf"T2/T1 ✗ {failed} 0\.\d+ 0\.05 ", text)
        assert "picks.csv" in str(text)
        assert "CGCS2000 / 3-degree 105E" in str(text)
        assert DATE in str(text)
        assert "T9" in str(text)


def test_the_report_is_told_in_its_language(written):
    folder, t = written
    text = _pdf(folder / "report.pdf")
    words = {
        "en": ["Prepared", "Approved", "one hole at a time", "borehole", "0 of 90 places folded", "control error"],
        "zh": [
            "编制",
            "校核",
            "审定",
            "留一钻孔法",
            "中误差",
            "控制误差",
            "拼接缝",
            "钻孔",
            "90 处中有 0 处折叠",
            "建议孔位",
        ],
    }[t.code]
    assert [
        word for word in words if word not in str(text) and word.replace(" ", "") not in str(text).replace(" ", "")
    ] == []
    assert ("passed" in str(text)) == (t is EN)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert f'<html lang="{"en" if t is EN else "zh-CN"}">' in page


def test_html_is_one_sound_file_that_loads_nothing(written):
    folder, _ = written
    page = _Page((folder / "report.html").read_text(encoding="utf-8"))
    assert all(address.startswith(("data:image/png;base64,", "#part")) for address in page.loads)
    assert sum(address.startswith("data:") for address in page.loads) >= 7
    assert not re.search(r"\b(nan|None|inf)\b", page.text)


def test_every_font_of_the_pdf_is_embedded(written):
    folder, _ = written
    fonts_found = 0
    for page in pypdf.PdfReader(folder / "report.pdf").pages:
        for font in page["/Resources"]["/Font"].values():
            font = font.get_object()
            assert font["/Subtype"] == "/Type0"
            descriptor = font["/DescendantFonts"][0].get_object()["/FontDescriptor"].get_object()
            assert {"/FontFile", "/FontFile2", "/FontFile3"} & set(descriptor), descriptor
            fonts_found += 1
    assert fonts_found


def test_pages_are_a4_numbered_and_end_with_the_last(written):
    folder, _ = written
    pages = pypdf.PdfReader(folder / "report.pdf").pages
    texts = _pages(folder / "report.pdf")
    for i, (page, text) in enumerate(zip(pages, texts, strict=True), 1):
        assert [round(float(v) / 72 * 25.4) for v in page.mediabox[2:]] == [210, 297]
        assert f"{i} / {len(pages)}" in str(text)


def test_same_report_same_date_same_bytes(report, images, tmp_path):
    images = {name: images[name] for name in ("plan/T3/T2", "residuals/T3/T2")}
    report = replace(report, horizons=report.horizons[:1])
    for name in ("a", "b"):
        write_pdf(document(report, EN), images, tmp_path / f"{name}.pdf")
        write_html(document(report, EN), images, tmp_path / f"{name}.html")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    write_pdf(document(replace(report, date="2026-11-22"), EN), images, tmp_path / "c.pdf")
    assert (tmp_path / "a.pdf").read_bytes() != (tmp_path / "c.pdf").read_bytes()


def test_the_date_is_that_of_the_build_where_it_is_set(results, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert today() == "2023-11-14"
    assert accuracy_report(results).date == "2023-11-14"
    assert accuracy_report(results, date=DATE).date == DATE


def test_what_was_not_examined_is_said(tmp_path):
    bare = accuracy_report([replace(horizon(), read_back=None)], date=DATE)
    write_html(document(bare, EN, missing_picture="no OpenGL here"), {}, tmp_path / "r.html")
    text = _Page((tmp_path / "r.html").read_text(encoding="utf-8")).text
    assert "Not examined: whether horizons cross" in str(text)
    assert "Not examined: the prediction error" in str(text)
    assert "Not examined: no STEP file was written" in str(text)
    assert "no OpenGL here" in str(text)
    write_pdf(document(bare, EN), {}, tmp_path / "r.pdf")
    assert "Not examined: no STEP file was written" in _pdf(tmp_path / "r.pdf")


def test_a_pass_with_a_failed_check_says_so(tmp_path):
    result = horizon()
    broken = replace(result.accuracy.checks[0], passed=False, places=((500_001.0, 3_100_002.0, 1503.0),))
    accuracy = replace(result.accuracy, checks=(broken,))
    report = accuracy_report([replace(result, surface=result.surface.with_(accuracy=accuracy))], date=DATE)
    assert not report.horizons[0].sound
    write_html(document(report, EN), {}, tmp_path / "r.html")
    text = _Page((tmp_path / "r.html").read_text(encoding="utf-8")).text
    assert report.horizons[0].verdict == "WARNING"
    assert text.count("! WARNING") >= 2, "on the first page and in the chapter"
    said = str(report.horizons[0].lamps[1].text)
    assert said.endswith("failed: normals")
    assert text.count(said) == 2
    assert "Worst at (500001.00, 3100002.00, 1503.00) m" in str(text)


def test_names_from_files_cannot_break_the_page(tmp_path):
    report = accuracy_report([horizon(name="<script>alert(1)</script>")], date=DATE)
    write_html(document(report, EN), {}, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_long_names_and_many_rows_stay_on_the_page(tmp_path):
    result = horizon()
    points = result.surface.points.with_(file="a" * 90 + "/" + "剖面" * 30 + ".csv")
    report = accuracy_report([replace(result, surface=result.surface.with_(points=points))], date=DATE)
    row = report.horizons[0].conflicts[0]
    report = replace(
        report, horizons=(replace(report.horizons[0], conflicts=(replace(row, text=message("x", "x" * 3000)),) * 60),)
    )
    write_pdf(document(report, EN), {}, tmp_path / "r.pdf")
    pdf = pdfium.PdfDocument(tmp_path / "r.pdf")
    wide, edge = 210 / 25.4 * 72, 15 / 25.4 * 72
    for i in range(len(pdf)):
        page = pdf[i].get_textpage()
        for k in range(page.count_rects()):
            left, bottom, right, top = page.get_rect(k)
            assert edge <= left <= right <= wide - edge, page.get_text_bounded(left, bottom, right, top)
    pdf.close()


def test_without_a_chinese_font_english_works_and_chinese_refuses(report, monkeypatch, tmp_path):
    monkeypatch.setattr(fonts, "chinese_family", lambda: None)
    fonts.pdf_fonts.cache_clear()
    try:
        write_pdf(document(report, EN), {}, tmp_path / "en.pdf")
        assert "σ = " in _pdf(tmp_path / "en.pdf")
        with pytest.raises(MissingDependencyError, match="fonts-noto-cjk"):
            write_pdf(document(report, ZH), {}, tmp_path / "zh.pdf")
        assert not (tmp_path / "zh.pdf").exists()
    finally:
        fonts.pdf_fonts.cache_clear()


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (4.2e-4, "0.000420"),
        (0.17, "0.170"),
        (0.03011, "0.0301"),
        (-12.34567, "−12.346"),
        (4.2e-6, "4.20e-6"),
        (-4.2e-6, "−4.20e-6"),
        (0.0, "0"),
        (1e-14, "< 1e-9"),
        (None, "–"),
        (float("nan"), "–"),
        (123456.789, "123 456.789"),
    ],
)
def test_metres_have_three_digits_and_never_less_than_a_millimetre(value, text):
    assert metres(value).replace("\N{NO-BREAK SPACE}", " ") == text


def test_rows_of_a_file_that_is_read_for_two_purposes_are_added():
    """Of a drawing with adits and their contacts the report had the rows of the last reading alone."""
    result = horizon()
    counts = (*result.site.counts, TableCount("picks.csv", 10, 7, 3), TableCount("map.dxf", 4, 4, 0))
    files = {file.file: file for file in inputs_of(replace(result.site, counts=counts))}
    assert [files["picks.csv"].read, files["picks.csv"].used, files["picks.csv"].listed] == [211, 207, 4]
    assert files["picks.csv"].sha256 == "ab" * 32
    assert [files["map.dxf"].read, files["map.dxf"].sha256] == [4, ""]

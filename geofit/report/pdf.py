"""The accuracy report as PDF: A4, every font embedded, the same bytes for the same report."""

from __future__ import annotations

import datetime
import io
import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from fpdf import FPDF

from geofit.data.files import replacing
from geofit.report.document import (
    Block,
    Chapter,
    Document,
    Facts,
    Heading,
    Paragraph,
    Picture,
    Signatures,
    Table,
    Verdict,
)
from geofit.report.fonts import pdf_fonts
from geofit.report.pdf_table import draw_table, least_height, rgb
from geofit.report.style import FAIL, INK, LINE, MUTED, PASS, WARNING

__all__ = ["write_pdf"]

#: Left and right, top, bottom, mm: the left has room for a binding.
SIDE, TOP, BOTTOM = 18.0, 24.0, 20.0
BODY, QUIET, SMALL = 8.6, 7.6, 7.0
LEADING = 1.45
#: No picture is higher than this, mm: two fit on a page.
HIGHEST = 104.0
_POINT = 25.4 / 72


def write_pdf(document: Document, images: Mapping[str, bytes], path: Path) -> None:
    """Write a document as PDF.

    Parameters
    ----------
    document : Document
        Laid out by :func:`geofit.report.chapters.document`.
    images : mapping of str to bytes
        PNG by the names that the document uses.
    path : Path
        The file.

    Raises
    ------
    MissingDependencyError
        If the document is in Chinese and the machine has no font for it.
    """
    pdf = _Pages(document)
    for i, chapter in enumerate(document.chapters):
        pdf.chapter(chapter, images, cover=i == 0)
    with replacing(path) as part:
        part.write_bytes(bytes(pdf.output()))


class _Pages(FPDF):
    """A4 pages with a running head and numbers."""

    def __init__(self, document: Document) -> None:
        super().__init__(format="A4")
        # Each font that is asked for a character it lacks would say so, though the next one has it.
        logging.getLogger("fpdf").setLevel(logging.ERROR)
        logging.getLogger("fontTools").setLevel(logging.ERROR)
        self.document, self.running = document, ""
        fonts = pdf_fonts(chinese=document.language.startswith("zh"))
        for family, style, font in (
            ("text", "", fonts.regular),
            ("text", "B", fonts.bold),
            ("signs", "", fonts.signs),
            ("signs", "B", fonts.signs_bold),
            ("mono", "", fonts.mono),
        ):
            self.add_font(family, style, font.path, collection_font_number=font.index)
        self.set_fallback_fonts(["signs"], exact_match=False)
        self.set_margins(SIDE, TOP, SIDE)
        self.set_auto_page_break(True, BOTTOM)
        self.c_margin = 0.0
        moment = datetime.datetime.fromisoformat(document.date).replace(tzinfo=datetime.UTC)
        self.set_creation_date(moment)
        self.set_title(f"{document.title} – {document.subject}")
        self.set_subject(document.subject)
        self.set_creator(document.footer.split(" · ")[0])
        self.set_lang(document.language)

    def header(self) -> None:
        """Site and chapter above a line; the cover has its own head."""
        if self.page == 1:
            return
        self._type(SMALL, MUTED)
        self.set_xy(SIDE, 12)
        self.cell(self.epw / 2, 4, self._fitting(self.document.site, self.epw / 2))
        self.cell(self.epw / 2, 4, self._fitting(self.running, self.epw / 2), align="R")
        self._rule(17.5)
        self.set_xy(SIDE, TOP)

    def footer(self) -> None:
        """Program and date; page of pages."""
        self._rule(self.h - 14.5)
        self._type(SMALL, MUTED)
        self.set_xy(SIDE, self.h - 13)
        self.cell(self.epw / 2, 4, self.document.footer)
        self.set_x(self.w - SIDE - self.get_string_width("00 / 00"))
        self.cell(0, 4, f"{self.page_no()} / {{nb}}")

    def chapter(self, chapter: Chapter, images: Mapping[str, bytes], *, cover: bool) -> None:
        """Begin a page and fill it."""
        self.running = chapter.title
        self.add_page()
        self.start_section(chapter.title)
        if cover:
            self._cover(chapter)
        else:
            self._title(chapter.title, chapter.verdict)
        for i, block in enumerate(chapter.blocks):
            if isinstance(block, Heading) and self.will_page_break(_least(self, chapter.blocks[i:], images)):
                self.add_page()
            self._block(block, images)

    def _cover(self, chapter: Chapter) -> None:
        self.set_xy(SIDE, 16)
        self._type(10, MUTED)
        self.multi_cell(self.epw, 5, self.document.subject, align="L", new_x="LMARGIN", new_y="NEXT")
        self._type(21, INK, "B")
        self.multi_cell(self.epw, 10, self.document.title, align="L", new_x="LMARGIN", new_y="NEXT")
        self._rule(self.y + 1)
        self.ln(4)

    def _title(self, text: str, verdict: Verdict | None) -> None:
        top = self.y
        self._type(15, INK, "B")
        self.multi_cell(self.epw - 36, 8, text, align="L", new_x="LMARGIN", new_y="NEXT")
        after = self.y
        if verdict is not None:
            word = verdict.text
            shade = WARNING if verdict.passed is None else FAIL
            self._type(11, "#ffffff" if verdict.passed else shade, "B")
            wide = self.get_string_width(word) + 8
            self.set_xy(self.w - SIDE - wide, top)
            self.set_fill_color(*rgb(PASS))
            self.set_draw_color(*rgb(shade))
            self.set_line_width(0.9)
            self.rect(self.x, top, wide, 8, style="F" if verdict.passed else "D")
            self.cell(wide, 8, word, align="C")
        self.set_xy(SIDE, after + 1.5)

    def _block(self, block: Block, images: Mapping[str, bytes]) -> None:
        if isinstance(block, Heading):
            self.ln(3.5 if block.level == 2 else 2)
            self._type(11.5 if block.level == 2 else 9, INK, "B")
            if block.level == 2:
                self.start_section(block.text, level=1)
            self.multi_cell(self.epw, 5.5, block.text, align="L", new_x="LMARGIN", new_y="NEXT")
            self.ln(1)
        elif isinstance(block, Paragraph):
            self._paragraph(block)
        elif isinstance(block, Table):
            draw_table(self, block)
            self.ln(2.5)
        elif isinstance(block, Facts):
            self._facts(block)
        elif isinstance(block, Picture):
            self._picture(block, images)
        else:
            self._signatures(block)

    def _paragraph(self, block: Paragraph) -> None:
        size = QUIET if block.style == "quiet" else BODY
        self._type(size, MUTED if block.style == "quiet" else INK)
        height = size * _POINT * LEADING
        indent = 4.0 if block.style == "warning" else 0.0
        lines = self._lines(block.text, self.epw - indent)
        if self.will_page_break(height * min(len(lines), 3)):
            self.add_page()
        if block.style == "warning" and not self.will_page_break(height * len(lines)):
            self.set_fill_color(*rgb(WARNING))
            self.rect(SIDE, self.y, 1.2, height * len(lines), style="F")
        self.set_x(SIDE + indent)
        self.multi_cell(self.epw - indent, height, block.text, align="L", new_x="LMARGIN", new_y="NEXT")
        self.ln(1.8)

    def _facts(self, block: Facts) -> None:
        gap = 3.0
        wide = (self.epw - gap * (len(block.items) - 1)) / len(block.items)
        self._type(6.4, MUTED)
        below = max(len(self._lines(small, wide)) for _, _, small in block.items)
        above = max(len(self._lines(label, wide)) for label, _, _ in block.items)
        height = 1.2 + 3 * above + 5.5 + 3 * below
        if self.will_page_break(height + 2):
            self.add_page()
        top = self.y
        for i, (label, value, small) in enumerate(block.items):
            left = SIDE + i * (wide + gap)
            self.set_draw_color(*rgb(INK))
            self.set_line_width(0.35)
            self.line(left, top, left + wide, top)
            self._type(6.4, MUTED)
            self._text(left, top + 1.2, wide, 3, label)
            self._type(10.5, INK, "B")
            while self.get_string_width(value) > wide and self.font_size_pt > 6:
                self.set_font_size(self.font_size_pt - 0.5)
            self._text(left, top + 1.2 + 3 * above, wide, 5.5, value)
            self._type(6.4, MUTED)
            self._text(left, top + 6.7 + 3 * above, wide, 3, small)
        self.set_xy(SIDE, top + height + 2.5)

    def _picture(self, block: Picture, images: Mapping[str, bytes]) -> None:
        data = images.get(block.name)
        if data is None:
            return
        wide, tall = _size(data, self.epw)
        self._type(QUIET, MUTED)
        line = QUIET * _POINT * LEADING
        caption = len(self._lines(block.caption, self.epw)) * line
        if self.will_page_break(tall + caption + 3):
            self.add_page()
        self.image(io.BytesIO(data), SIDE, self.y, wide, tall, alt_text=block.caption)
        self.set_xy(SIDE, self.y + tall + 1.8)
        self._type(QUIET, MUTED)
        self.multi_cell(self.epw, line, block.caption, align="L", new_x="LMARGIN", new_y="NEXT")
        self.ln(3)

    def _signatures(self, block: Signatures) -> None:
        first, height = 26.0, 10.0
        wide = (self.epw - first) / (len(block.columns) - 1)
        self.set_draw_color(*rgb(MUTED))
        self.set_line_width(0.2)
        self._type(QUIET, MUTED)
        self.c_margin = 1.5
        for i, title in enumerate(block.columns):
            self.cell(first if i == 0 else wide, 5, title)
        self.ln(5)
        for role in block.roles:
            self._type(BODY, INK)
            self.cell(first, height, role, border=1)
            for _ in block.columns[1:]:
                self.cell(wide, height, "", border=1)
            self.ln(height)
        self.c_margin = 0.0

    def _type(self, size: float, colour: str, style: str = "") -> None:
        self.set_font("text", style=style, size=size)
        self.set_text_color(*rgb(colour))

    def _text(self, x: float, y: float, wide: float, line: float, text: str) -> None:
        self.set_xy(x, y)
        self.multi_cell(wide, line, text, align="L", padding=0)

    def _lines(self, text: str, wide: float) -> list[str]:
        lines = self.multi_cell(wide, 3, text, align="L", dry_run=True, output="LINES")
        assert isinstance(lines, list)
        return lines

    def _fitting(self, text: str, wide: float) -> str:
        """Cut a text that is too long for its place."""
        if self.get_string_width(text) <= wide - 3:
            return text
        while text and self.get_string_width(text + "…") > wide - 3:
            text = text[:-1]
        return text + "…"

    def _rule(self, y: float) -> None:
        self.set_draw_color(*rgb(LINE))
        self.set_line_width(0.25)
        self.line(SIDE, y, self.w - SIDE, y)


def _size(data: bytes, room: float) -> tuple[float, float]:
    """Return width and height of a picture on the page, mm: the whole width unless it would be too high."""
    wide, tall = (int.from_bytes(data[k : k + 4], "big") for k in (16, 20))
    scale = min(room / wide, HIGHEST / tall)
    return wide * scale, tall * scale


def _least(pdf: _Pages, blocks: Sequence[Block], images: Mapping[str, bytes]) -> float:
    """Return what must stand on the page with a heading: itself and the beginning of what follows, mm."""
    height = 0.0
    for block in blocks:
        if isinstance(block, Heading):
            height += 11
        elif isinstance(block, Picture):
            return height + (_size(images[block.name], pdf.epw)[1] + 8 if block.name in images else 0)
        elif isinstance(block, Table):
            return height + least_height(block)
        elif isinstance(block, Facts):
            height += 20
        elif isinstance(block, Signatures):
            return height + 5 + 10 * len(block.roles)
        else:
            height += 10
    return height

"""The accuracy report as PDF: A4, every font embedded, the same bytes for the same report."""

from __future__ import annotations

import datetime
import io
import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from fpdf import FPDF
from fpdf.fonts import TTFFont
from fpdf.outline import OutlineSection

from geofit.data.files import replacing
from geofit.report.document import (
    Block,
    Chapter,
    Facts,
    Fields,
    Heading,
    Paragraph,
    Picture,
    ReportDocument,
    ReportTable,
    Signatures,
    VerdictMark,
)
from geofit.report.fonts import pdf_fonts
from geofit.report.pdf_table import draw_table, table_height, table_start
from geofit.report.pdf_text import POINT, Pen, Typesetter
from geofit.report.style import FAIL, LINE, MUTED, PASS, TEXT, WARNING, rgb

__all__ = ["write_pdf"]

#: Left and right, top, bottom, mm: the left has room for a binding.
SIDE, TOP, BOTTOM = 18.0, 24.0, 20.0
BODY, QUIET, SMALL, TINY = 8.6, 7.6, 7.0, 6.4
LEADING = 1.45
#: Type is made no smaller than this so that a text fits, points.
LEAST = 6.0
#: Letters of headings by their level, and room above them, mm.
HEADS = {2: Pen(11.5, TEXT, bold=True), 3: Pen(9, TEXT, bold=True)}
ABOVE_HEADING = {2: 3.5, 3: 2.0}
#: No picture is higher than this, mm: two fit on a page. One to scale may be higher.
HIGHEST = 104.0
#: A last page with less than this on it, mm, is saved if these shares of the usual room between rows leave it empty.
SPARSE = 45.0
TIGHTER = (0.8, 0.6)
#: Heights of a line of the title block and of a signature, and the least of the picture on the cover, mm.
FIELD, SIGNED, LOWEST_COVER = 8.6, 9.0, 40.0
#: Dots an inch of pictures to scale.
DOTS = 200.0
#: A chapter that follows on begins on a page if so much of it is left, mm.
LEAST_START = 90.0


def write_pdf(document: ReportDocument, images: Mapping[str, bytes], path: Path) -> None:
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
    pdf = _laid(document, images, 1.0)
    if len(pdf.pages) > 1 and pdf.y - TOP < SPARSE:
        for share in TIGHTER:
            other = _laid(document, images, share)
            if len(other.pages) < len(pdf.pages):
                pdf.drop()
                pdf = other
                break
            other.drop()
    pdf.number()
    with replacing(path) as part:
        part.write_bytes(bytes(pdf.output()))


def _laid(document: ReportDocument, images: Mapping[str, bytes], share: float) -> _Pages:
    """Return the pages of a document with a share of the usual room between the rows of tables."""
    pdf = _Pages(document, share)
    for i, chapter in enumerate(document.chapters):
        pdf.chapter(chapter, images, cover=i == 0)
        if i == 0 and document.contents:
            pdf.contents(document.chapters[1].title)
    return pdf


class _Pages(FPDF):
    """A4 pages with a running head and numbers, with a ``share`` of the usual room between the rows of tables."""

    def __init__(self, document: ReportDocument, share: float) -> None:
        super().__init__(format="A4")
        # Each font that is asked for a character it lacks would report it, though the next one has it.
        logging.getLogger("fpdf").setLevel(logging.ERROR)
        logging.getLogger("fontTools").setLevel(logging.ERROR)
        self.document, self.running, self.share, self.highest = document, "", share, HIGHEST
        fonts = pdf_fonts(chinese=document.language.startswith("zh"))
        for family, style, font in (
            ("text", "", fonts.regular),
            ("text", "B", fonts.bold),
            ("signs", "", fonts.signs),
            ("signs", "B", fonts.signs_bold),
            ("mono", "", fonts.mono),
        ):
            self.add_font(family, style, font.path, collection_font_number=font.index)
        self.type = Typesetter(self)
        self.set_margins(SIDE, TOP, SIDE)
        self.set_auto_page_break(False, BOTTOM)
        self.c_margin = 0.0
        moment = datetime.datetime.fromisoformat(document.date).replace(tzinfo=datetime.UTC)
        self.set_creation_date(moment)
        self.set_title(f"{document.title} – {document.subject}")
        self.set_subject(document.subject)
        self.set_creator(document.footer.split(" · ")[0])
        self.set_lang(document.language)

    @property
    def foot(self) -> float:
        """Where the page ends, mm."""
        return float(self.h - BOTTOM)

    @property
    def empty_page(self) -> float:
        """Height of an empty page, mm."""
        return self.foot - TOP

    def header(self) -> None:
        """Document and chapter above a line; the cover has its own head."""
        if self.page == 1:
            return
        pen, half = Pen(SMALL, MUTED), self.epw / 2 - 2
        left = " · ".join(part for part in (self.document.site, self.document.reference) if part)
        self.type.draw(SIDE, 14, self.type.cut(left, half, pen), pen)
        self.type.draw(SIDE + half + 4, 14, self.type.cut(self.running, half, pen), pen, half, "right")
        self._rule(17.5)
        self.set_xy(SIDE, TOP)

    def footer(self) -> None:
        """Program and date; :meth:`number` adds the page."""
        self._rule(self.h - 14.5)
        self.type.draw(SIDE, self.h - 11, self.document.footer, Pen(SMALL, MUTED))

    def drop(self) -> None:
        """Close the files of the fonts, as writing the pages would."""
        for font in self.fonts.values():
            if isinstance(font, TTFFont):
                font.close()

    def number(self) -> None:
        """Write page of pages at the foot of each page, when their number is known."""
        last = len(self.pages)
        pen = Pen(SMALL, MUTED)
        for page in range(1, last + 1):
            self.page = page
            self.current_font_is_set_on_page = False
            self.type.draw(SIDE, self.h - 11, f"{page} / {last}", pen, self.epw, "right")
        self.page = last

    def chapter(self, chapter: Chapter, images: Mapping[str, bytes], *, cover: bool) -> None:
        """Begin a chapter and fill its pages."""
        self.running = chapter.title
        if cover or not chapter.follows or self.foot - self.y < LEAST_START:
            self.add_page()
        else:
            self.ln(6)
        if cover:
            self._cover()
            self.highest = self._room_for_picture(chapter)
        else:
            self.start_section(chapter.title)
            self._title(chapter.title, chapter.verdict)
        for i, block in enumerate(chapter.blocks):
            if isinstance(block, Heading) and self._least(chapter.blocks[i:], images) > self.foot - self.y:
                self.add_page()
            self._block(block, images)
        self.highest = HIGHEST

    def _room_for_picture(self, cover: Chapter) -> float:
        """Return how high the picture of the cover may be, so that the signatures stay on the first page, mm."""
        height = 14.0
        for block in cover.blocks:
            if isinstance(block, Fields):
                height += FIELD * ((len(block.items) + 1) // 2) + 2.5
            elif isinstance(block, ReportTable):
                height += table_height(block, self.epw, self.type, self.share) + 2.5
            elif isinstance(block, Signatures):
                height += 5 + SIGNED * len(block.roles)
            elif not isinstance(block, Picture):
                height += 9
        return min(max(self.foot - self.y - height, LOWEST_COVER), HIGHEST)

    def contents(self, following: str) -> None:
        """Keep a page for the list of chapters, which is drawn when their pages are known."""
        self.running = self.document.contents
        self.add_page()
        self._title(self.document.contents, None)
        self.running = following
        self.insert_toc_placeholder(_draw_contents, reset_page_indices=False)
        # The page that the placeholder has begun is the next chapter's.
        self._begun = True

    def add_page(self, *args: object, **kwargs: object) -> None:
        """Begin a page, unless an empty one is there."""
        if getattr(self, "_begun", False):
            self._begun = False
            return
        super().add_page(*args, **kwargs)  # type: ignore[arg-type]

    def _cover(self) -> None:
        self.set_xy(SIDE, 16)
        for text, pen, height in (
            (self.document.subject, Pen(10.5, MUTED), 5.5),
            (self.document.title, Pen(22, TEXT, bold=True), 10.5),
        ):
            self._lines(text, pen, height)
        self._rule(self.y + 1)
        self.set_xy(SIDE, self.y + 5)

    def _title(self, text: str, verdict: VerdictMark | None) -> None:
        top = self.y
        pen = Pen(15, TEXT, bold=True)
        for k, line in enumerate(self.type.lines(text, self.epw - 36, pen)):
            self.type.draw(SIDE, top + 8 * k + 4, line, pen)
            self.set_y(top + 8 * (k + 1))
        if verdict is not None:
            shade = WARNING if verdict.passed is None else FAIL
            mark = Pen(11, "#ffffff" if verdict.passed else shade, bold=True)
            wide = self.type.width(verdict.text, mark) + 8
            self.set_fill_color(*rgb(PASS))
            self.set_draw_color(*rgb(shade))
            self.set_line_width(0.9)
            self.rect(self.w - SIDE - wide, top, wide, 8, style="F" if verdict.passed else "D")
            self.type.draw(self.w - SIDE - wide, top + 4, verdict.text, mark, wide, "centre")
        self.set_xy(SIDE, self.y + 2)

    def _block(self, block: Block, images: Mapping[str, bytes]) -> None:
        if isinstance(block, Heading):
            self._heading(block)
        elif isinstance(block, Paragraph):
            self._paragraph(block)
        elif isinstance(block, ReportTable):
            draw_table(self, self.type, block, lambda: self.foot, self.add_page, self.empty_page, self.share)
            self.set_y(self.y + 2.5)
        elif isinstance(block, Facts):
            self._facts(block)
        elif isinstance(block, Fields):
            self._fields(block)
        elif isinstance(block, Picture):
            self._picture(block, images)
        else:
            self._signatures(block)

    def _heading(self, block: Heading) -> None:
        if self.y > TOP + 12:
            self.set_y(self.y + ABOVE_HEADING[block.level])
        if block.level == 2:
            self.start_section(block.text, level=1)
        self._lines(block.text, HEADS[block.level], 5.5)
        self.set_y(self.y + 1)

    def _lines(self, text: str, pen: Pen, height: float, indent: float = 0.0) -> None:
        """Draw a text over the page's width, line by line."""
        for line in self.type.lines(text, self.epw - indent, pen):
            if self.y + height > self.foot:
                self.add_page()
            self.type.draw(SIDE + indent, self.y + height / 2, line, pen)
            self.set_xy(SIDE, self.y + height)

    def _paragraph(self, block: Paragraph) -> None:
        pen = Pen(QUIET, MUTED) if block.style == "quiet" else Pen(BODY)
        height = pen.size * POINT * LEADING
        indent = 4.0 if block.style == "warning" else 0.0
        lines = len(self.type.lines(block.text, self.epw - indent, pen))
        # No line stands alone at the foot or at the head of a page.
        if self.y + height * min(lines, 3) > self.foot or (lines <= 4 and self.y + height * lines > self.foot):
            self.add_page()
        if block.style == "warning" and self.y + height * lines <= self.foot:
            self.set_fill_color(*rgb(WARNING))
            self.rect(SIDE, self.y, 1.2, height * lines, style="F")
        self._lines(block.text, pen, height, indent)
        self.set_y(self.y + 1.8)

    def _facts(self, block: Facts) -> None:
        gap, small = 3.0, Pen(TINY, MUTED)
        wide = (self.epw - gap * (len(block.items) - 1)) / len(block.items)
        above = [self.type.lines(label, wide, small) for label, _, _ in block.items]
        below = [self.type.lines(text, wide, small) if text else [] for _, _, text in block.items]
        high = max(map(len, above))
        height = 1.2 + 3 * high + 5.5 + 3 * max(map(len, below))
        if self.y + height + 2 > self.foot:
            self.add_page()
        top = self.y
        for i, (_, value, _) in enumerate(block.items):
            left = SIDE + i * (wide + gap)
            self.set_draw_color(*rgb(TEXT))
            self.set_line_width(0.35)
            self.line(left, top, left + wide, top)
            pen = self._fitting(value, Pen(10.5, TEXT, bold=True), wide)
            self.type.draw(left, top + 1.2 + 3 * high + 2.75, value, pen)
            for lines, start in ((above[i], 1.2), (below[i], 6.7 + 3 * high)):
                for k, line in enumerate(lines):
                    self.type.draw(left, top + start + 3 * (k + 0.5), line, small)
        self.set_xy(SIDE, top + height + 2.5)

    def _fitting(self, text: str, pen: Pen, room: float) -> Pen:
        """Return a pen no larger than the given one with which a text fits into a room (mm), if any is legible."""
        while self.type.width(text, pen) > room and pen.size > LEAST:
            pen = Pen(pen.size - 0.5, pen.colour, bold=pen.bold, family=pen.family)
        return pen

    def _fields(self, block: Fields) -> None:
        """Draw the title block: two fields a row, label above value."""
        wide, height, value = self.epw / 2, FIELD, Pen(BODY + 0.6, TEXT, bold=True)
        self.set_draw_color(*rgb(MUTED))
        self.set_line_width(0.2)
        for i, (label, text) in enumerate(block.items):
            x = SIDE + (i % 2) * wide
            if i % 2 == 0 and self.y + height > self.foot:
                self.add_page()
            self.rect(x, self.y, wide, height)
            if i % 2 == 0 and i + 1 == len(block.items):
                self.rect(x + wide, self.y, wide, height)
            self.type.draw(x + 1.5, self.y + 2.2, label, Pen(TINY, MUTED))
            pen = self._fitting(text, value, wide - 3)
            self.type.draw(x + 1.5, self.y + 5.9, self.type.cut(text, wide - 3, pen), pen)
            if i % 2 == 1 or i + 1 == len(block.items):
                self.set_y(self.y + height)
        self.set_y(self.y + 2.5)

    def _picture(self, block: Picture, images: Mapping[str, bytes]) -> None:
        data = images.get(block.name)
        if data is None:
            return
        wide, tall = self._picture_size(block, data)
        if self.y + tall + self._caption(block) + 3 > self.foot:
            self.add_page()
        self.image(io.BytesIO(data), SIDE, self.y, wide, tall, alt_text=block.caption)
        self.set_xy(SIDE, self.y + tall + 1.8)
        self._lines(block.caption, Pen(QUIET, MUTED), QUIET * POINT * LEADING)
        self.set_y(self.y + 3)

    def _picture_size(self, block: Picture, data: bytes) -> tuple[float, float]:
        """Return width and height of a picture on the page, mm: the whole width unless it would be too high."""
        wide, tall = (int.from_bytes(data[k : k + 4], "big") for k in (16, 20))
        if block.to_scale:
            return wide / DOTS * 25.4, tall / DOTS * 25.4
        scale = min(self.epw / wide, self.highest / tall)
        return wide * scale, tall * scale

    def _caption(self, block: Picture) -> float:
        return len(self.type.lines(block.caption, self.epw, Pen(QUIET))) * QUIET * POINT * LEADING

    def _signatures(self, block: Signatures) -> None:
        first, height = 26.0, SIGNED
        wide = (self.epw - first) / (len(block.columns) - 1)
        if self.y + 5 + height * len(block.roles) > self.foot:
            self.add_page()
        self.set_draw_color(*rgb(MUTED))
        self.set_line_width(0.2)
        places = [SIDE, *(SIDE + first + k * wide for k in range(len(block.columns) - 1))]
        for x, title in zip(places, block.columns, strict=True):
            self.type.draw(x + 1.5, self.y + 2.5, title, Pen(QUIET, MUTED))
        self.set_y(self.y + 5)
        for role, name in block.roles:
            for k, x in enumerate(places):
                self.rect(x, self.y, first if k == 0 else wide, height)
                words, room = ((role, first), (name, wide))[k] if k < 2 else ("", wide)
                pen = self._fitting(words, Pen(BODY), room - 3)
                self.type.draw(x + 1.5, self.y + height / 2, self.type.cut(words, room - 3, pen), pen)
            self.set_y(self.y + height)

    def _rule(self, y: float) -> None:
        self.set_draw_color(*rgb(LINE))
        self.set_line_width(0.25)
        self.line(SIDE, y, self.w - SIDE, y)

    def _least(self, blocks: Sequence[Block], images: Mapping[str, bytes]) -> float:
        """Return what must stand on the page with a heading: itself and the beginning of what follows, mm."""
        height = 0.0
        for block in blocks:
            if isinstance(block, Heading):
                height += (
                    ABOVE_HEADING[block.level]
                    + 5.5 * len(self.type.lines(block.text, self.epw, HEADS[block.level]))
                    + 1
                )
            elif isinstance(block, Picture):
                if block.name in images:
                    height += self._picture_size(block, images[block.name])[1] + self._caption(block) + 3
                return height
            elif isinstance(block, ReportTable):
                return height + table_start(block, self.epw, self.type, self.empty_page, self.share)
            elif isinstance(block, Signatures):
                return height + 5 + SIGNED * len(block.roles)
            elif isinstance(block, Facts | Fields):
                height += 20
            else:
                pen = Pen(QUIET) if block.style == "quiet" else Pen(BODY)
                height += pen.size * POINT * LEADING * len(self.type.lines(block.text, self.epw, pen)) + 1.8
                if height > 40:
                    return height
        return height


#: Height of a line of the contents by its level, mm.
_ENTRIES = (6.2, 3.75)


def _draw_contents(pdf: FPDF, outline: list[OutlineSection]) -> None:
    """List chapters, and as many of their headings as there is room for, with their pages."""
    assert isinstance(pdf, _Pages)
    y, room = TOP + 12.0, pdf.foot - TOP - 14.0
    in_full = {chapter.title for chapter in pdf.document.chapters if chapter.listed}
    entries, chapter = [], ""
    for one in outline:
        chapter = one.name if one.level == 0 else chapter
        if one.level == 0 or chapter in in_full:
            entries.append(one)
    if sum(_ENTRIES[one.level] for one in entries) > room:
        entries = [one for one in outline if one.level == 0]
    for one in entries:
        main = one.level == 0
        pen = Pen(BODY + 0.4, TEXT, bold=True) if main else Pen(QUIET, MUTED)
        y += _ENTRIES[one.level]
        if y > pdf.foot:
            break
        x = SIDE + (0 if main else 5)
        name = pdf.type.cut(one.name, pdf.epw - 20, pen)
        pdf.type.draw(x, y, name, pen)
        number = str(one.page_number)
        pdf.type.draw(pdf.w - SIDE - 12, y, number, pen, 12, "right")
        begin, end = x + pdf.type.width(name, pen) + 2, pdf.w - SIDE - pdf.type.width(number, pen) - 2
        pdf.set_draw_color(*rgb(LINE))
        pdf.set_line_width(0.2)
        pdf.line(begin, y + 1.0, end, y + 1.0)
        link = pdf.add_link(page=one.page_number)
        pdf.link(x, y - 1.8, pdf.epw - (x - SIDE), 3.6, link)

"""Tables of a PDF: columns as wide as they need, heads repeated on every page."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from fpdf import FPDF, FontFace
from fpdf.enums import CellBordersLayout, VAlign

from geofit.report.document import Cell, Column, Mark, Table, Verdict
from geofit.report.style import FAIL, INK, MUTED, PASS, WARNING

__all__ = ["draw_table", "least_height", "plain_text", "rgb"]

SIZE, HASH_SIZE = 7.4, 5.2
LINE = 3.9
#: Room left and right, and above and below, of the text of a cell, mm.
PADDING = (0.9, 1.1)
#: What a wide column gets at least, and a text column at most unless there is room, mm.
NARROWEST, WIDEST = 17.0, 44.0
#: A table without a wide column gives each column at most this much more than it needs, mm.
AIRIEST = 9.0
#: So many rows stand together at the foot of a page, or none.
FEWEST, HEAD_LINES = 4, 3
#: A longer cell would not fit on a page.
LONGEST = 700


def plain_text(cell: Cell) -> str:
    """Return what a cell says."""
    text = cell if isinstance(cell, str) else cell.text
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue of #rrggbb."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def draw_table(pdf: FPDF, table: Table) -> None:
    """Draw a table from where the page stands, over the whole width if a column wraps."""
    pdf.set_font("text", size=SIZE)
    pdf.set_draw_color(*rgb("#c3cad2"))
    pdf.set_fill_color(255, 255, 255)
    pdf.set_line_width(0.15)
    aligns = tuple("RIGHT" if column.kind == "number" else "LEFT" for column in table.columns)
    head = FontFace(emphasis="BOLD", color=rgb(MUTED), size_pt=SIZE)
    widths = _widths(pdf, table)
    if pdf.will_page_break(least_height(table)):
        pdf.add_page()
    with pdf.table(
        align="LEFT",
        width=min(sum(widths), pdf.epw),
        borders_layout="HORIZONTAL_LINES",
        col_widths=widths,
        headings_style=head,
        line_height=LINE,
        padding=(PADDING[1], PADDING[0], PADDING[1], PADDING[0]),
        text_align=aligns,
        v_align=VAlign.T,
        repeat_headings=1,
    ) as drawn:
        row = drawn.row()
        for column in table.columns:
            row.cell(_title(column), v_align=VAlign.B)
        for cells in table.rows:
            row = drawn.row()
            for column, cell in zip(table.columns, cells, strict=True):
                if isinstance(cell, Verdict):
                    row.cell(plain_text(cell), style=_badge(cell), align="CENTER", border=CellBordersLayout.ALL)
                else:
                    row.cell(plain_text(cell), style=_style(column, cell))


def least_height(table: Table) -> float:
    """Return the height of the head and of the rows that stand together with it, mm."""
    rows = min(len(table.rows), FEWEST)
    return rows * (LINE + 2 * PADDING[1]) + HEAD_LINES * LINE + 2 * PADDING[1]


def _title(column: Column) -> str:
    """Return the title with its unit held to the word before."""
    return column.title.replace(", ", ",\N{NO-BREAK SPACE}")


def _badge(verdict: Verdict) -> FontFace:
    if verdict.passed:
        return FontFace(emphasis="BOLD", color=(255, 255, 255), fill_color=rgb(PASS))
    if verdict.passed is None:
        return FontFace(emphasis="BOLD", color=rgb(WARNING), fill_color=(255, 255, 255))
    return FontFace(emphasis="BOLD", color=rgb(FAIL), fill_color=(255, 255, 255))


def _style(column: Column, cell: Cell) -> FontFace:
    if isinstance(cell, Mark):
        colour = {True: PASS, False: FAIL, None: MUTED}[cell.passed]
        return FontFace(color=rgb(colour), emphasis="BOLD" if cell.passed is False else None)
    if column.kind == "hash":
        return FontFace(family="mono", size_pt=HASH_SIZE, color=rgb(INK))
    return FontFace(color=rgb(INK))


def _widths(pdf: FPDF, table: Table) -> tuple[float, ...]:
    """Share the page's width: numbers and words get what they need, wide columns the rest."""
    need = [_need(pdf, i, table) for i in range(len(table.columns))]
    wide = [i for i, column in enumerate(table.columns) if column.kind == "wide"]
    room = float(pdf.epw)
    fixed = sum(width for i, (_, width) in enumerate(need) if i not in wide)
    if wide and room - fixed >= NARROWEST * len(wide):
        rest = _shared(room - fixed, [need[i] for i in wide])
        widths = [width for _, width in need]
        for i, width in zip(wide, rest, strict=True):
            widths[i] = width
        return tuple(widths)
    if not wide and fixed <= room:
        # Numbers too far apart are hard to follow along the row.
        spare = min((room - fixed) / len(need), AIRIEST)
        return tuple(width + spare for _, width in need)
    return tuple(_shared(room, need))


def _shared(room: float, need: Sequence[tuple[float, float]]) -> list[float]:
    """Give each column its least width, then what it would like, in proportion."""
    least, natural = [a for a, _ in need], [b for _, b in need]
    if sum(least) >= room:
        return [room * a / sum(least) for a in least]
    if sum(natural) >= room:
        part = (room - sum(least)) / max(sum(natural) - sum(least), 1e-9)
        return [a + part * (b - a) for a, b in need]
    return [b + (room - sum(natural)) * b / sum(natural) for b in natural]


def _need(pdf: FPDF, index: int, table: Table) -> tuple[float, float]:
    """Return the least and the natural width of a column, mm."""
    column = table.columns[index]
    cells = [plain_text(row[index]) for row in table.rows]
    spare = 2 * PADDING[0] + 0.6
    if column.kind == "hash":
        pdf.set_font("mono", size=HASH_SIZE)
        width = max((pdf.get_string_width(text) for text in cells), default=0.0) + spare
        pdf.set_font("text", size=SIZE)
        return width, width
    pdf.set_font("text", style="B", size=SIZE)
    head = max(pdf.get_string_width(word) for word in _words(_title(column))) + spare
    bold = any(isinstance(row[index], Mark | Verdict) for row in table.rows)
    pdf.set_font("text", style="B" if bold else "", size=SIZE)
    natural = max((pdf.get_string_width(text) for text in cells), default=0.0) + spare
    longest = max((pdf.get_string_width(word) for text in cells for word in _words(text)), default=0.0) + spare
    pdf.set_font("text", size=SIZE)
    if column.kind == "wide":
        return max(head, min(longest, WIDEST), NARROWEST), max(natural, head)
    if column.kind == "text":
        return max(head, min(longest, WIDEST)), max(head, min(natural, WIDEST))
    return max(head, natural), max(head, natural)


def _words(text: str) -> list[str]:
    """Part a text where it may break: at spaces, and a Chinese word of more than eight characters in the middle."""
    words = []
    for word in text.split(" "):
        chinese = any(unicodedata.east_asian_width(c) in "WF" for c in word)
        middle = (len(word) + 1) // 2
        words += [word[:middle], word[middle:]] if chinese and len(word) > 8 else [word]
    return words or [""]

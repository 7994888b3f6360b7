"""Tables of a PDF: columns as wide as they need, heads repeated, never a row or two alone on a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from fpdf import FPDF

from geofit.report.document import Cell, CheckMark, Column, ReportTable, VerdictMark
from geofit.report.pdf_text import Pen, Typesetter
from geofit.report.style import FAIL, MUTED, PASS, WARNING, rgb

__all__ = ["draw_table", "plain_text", "table_height", "table_start"]

SIZE, HASH_SIZE = 7.4, 5.2
LINE = 3.9
#: Room left and right, and above and below, of the text of a cell, mm; above and below in a dense table.
PADDING, DENSE = (0.9, 1.1), 0.45
#: What a wide column gets at least, and a text column at most unless there is room, mm.
NARROWEST, WIDEST = 17.0, 44.0
#: A table without a wide column gives each column at most this much more than it needs, mm.
AIRIEST = 9.0
#: So many rows stand together at the foot and at the head of a page, or none; a table up to this share of a page is
#: not parted.
FEWEST, WHOLE = 4, 1 / 3
#: A longer cell would not fit on a page.
LONGEST = 700
RULE = "#c3cad2"


def plain_text(cell: Cell) -> str:
    """Return what a cell says."""
    text = cell if isinstance(cell, str) else cell.text
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


class LaidTable:
    """A table whose cells are broken into lines: widths of the columns, lines and height of each row.

    ``share`` of the usual room is above and below the text of a cell.
    """

    def __init__(self, table: ReportTable, room: float, type_: Typesetter, share: float = 1.0) -> None:
        self.table = table
        self.widths = _widths(table, room, type_)
        inner = [width - 2 * PADDING[0] for width in self.widths]
        self.head = [
            type_.lines(_title(column), wide, _HEAD) for column, wide in zip(table.columns, inner, strict=True)
        ]
        self.rows = [
            [
                type_.lines(plain_text(cell), wide, _pen(column, cell))
                for column, cell, wide in zip(table.columns, cells, inner, strict=True)
            ]
            for cells in table.rows
        ]
        self.padding = DENSE if table.dense else share * PADDING[1]
        self.head_height = _height(self.head, self.padding)
        self.heights = [_height(row, self.padding) for row in self.rows]


def table_height(table: ReportTable, room: float, type_: Typesetter, share: float = 1.0) -> float:
    """Return the height of a table over a width, mm; ``share`` is that of :class:`LaidTable`."""
    laid = LaidTable(table, room, type_, share)
    return laid.head_height + sum(laid.heights)


def table_start(table: ReportTable, room: float, type_: Typesetter, page: float, share: float = 1.0) -> float:
    """Return what of a table is never parted from its head, mm: all of a short one, else the first rows."""
    laid = LaidTable(table, room, type_, share)
    total = laid.head_height + sum(laid.heights)
    return total if total <= WHOLE * page else laid.head_height + sum(laid.heights[:FEWEST])


def draw_table(
    pdf: FPDF, type_: Typesetter, table: ReportTable, bottom: Callable[[], float], turn: Callable[[], None],
    page: float, share: float = 1.0,
) -> None:  # fmt: skip
    """Draw a table from where the page stands.

    Parameters
    ----------
    pdf : FPDF
        At the place where the table begins.
    type_ : Typesetter
        Draws the words.
    table : Table
        The table.
    bottom : callable
        Returns where the page ends, mm.
    turn : callable
        Begins a new page.
    page : float
        Height of an empty page, mm.
    share : float
        That of :class:`LaidTable`.
    """
    laid = LaidTable(table, pdf.epw, type_, share)
    first = 0
    for last in page_ends(laid, bottom() - pdf.y, page):
        if last == 0 or first > 0:
            turn()
        if last > first or not laid.rows:
            _draw_part(pdf, type_, laid, first, last)
        first = last


def page_ends(laid: LaidTable, room: float, page: float) -> list[int]:
    """Return the rows at which pages end; a leading 0 turns the page before the first row."""
    total = laid.head_height + sum(laid.heights)
    if total <= room:
        return [len(laid.rows)]
    ends: list[int] = []
    if total <= WHOLE * page or _fitting(laid, 0, room) < min(FEWEST, len(laid.rows)):
        ends, room = [0], page
    first = 0
    while first < len(laid.rows):
        last = max(_fitting(laid, first, room), first + 1)
        left = len(laid.rows) - last
        if 0 < left < FEWEST and last - first > 2 * FEWEST:
            last = len(laid.rows) - FEWEST
        ends.append(last)
        first, room = last, page
    return ends or [0]


def _fitting(laid: LaidTable, first: int, room: float) -> int:
    height, last = laid.head_height, first
    while last < len(laid.rows) and height + laid.heights[last] <= room:
        height += laid.heights[last]
        last += 1
    return last


def _draw_part(pdf: FPDF, type_: Typesetter, laid: LaidTable, first: int, last: int) -> None:
    x, y = pdf.l_margin, pdf.y
    pdf.set_draw_color(*rgb(RULE))
    pdf.set_line_width(0.15)
    columns = laid.table.columns
    _draw_row(type_, x, y, laid, laid.head, [_HEAD] * len(columns), laid.head_height, foot=True)
    y += laid.head_height
    right = x + sum(laid.widths)
    pdf.line(x, y, right, y)
    for k in range(first, last):
        cells, height = laid.table.rows[k], laid.heights[k]
        for i, cell in enumerate(cells):
            if isinstance(cell, VerdictMark):
                _badge(pdf, cell, x + sum(laid.widths[:i]), y, laid.widths[i], height)
        pens = [_pen(column, cell) for column, cell in zip(columns, cells, strict=True)]
        _draw_row(type_, x, y, laid, laid.rows[k], pens, height)
        y += height
        pdf.set_draw_color(*rgb(RULE))
        pdf.set_line_width(0.15)
        pdf.line(x, y, right, y)
    pdf.set_xy(x, y)


def _draw_row(
    type_: Typesetter, x: float, y: float, laid: LaidTable, row: Sequence[Sequence[str]], pens: Sequence[Pen],
    height: float, *, foot: bool = False,
) -> None:  # fmt: skip
    for column, lines, wide, pen in zip(laid.table.columns, row, laid.widths, pens, strict=True):
        top = y + (height - len(lines) * LINE - laid.padding if foot else laid.padding)
        align = "right" if column.kind == "number" else "left"
        for k, line in enumerate(lines):
            type_.draw(x + PADDING[0], top + (k + 0.5) * LINE, line, pen, wide - 2 * PADDING[0], align)  # type: ignore[arg-type]
        x += wide


def _badge(pdf: FPDF, verdict: VerdictMark, x: float, y: float, wide: float, height: float) -> None:
    pdf.set_fill_color(*rgb(PASS))
    pdf.set_draw_color(*rgb(WARNING if verdict.passed is None else FAIL))
    pdf.set_line_width(0.4)
    pdf.rect(x + 0.2, y + 0.5, wide - 0.8, height - 1.0, style="F" if verdict.passed else "D")


def _height(row: Sequence[Sequence[str]], padding: float) -> float:
    return max((len(lines) for lines in row), default=1) * LINE + 2 * padding


def _title(column: Column) -> str:
    """Return the title with its unit held to the word before."""
    return column.title.replace(", ", ",\N{NO-BREAK SPACE}")


_HEAD = Pen(SIZE, MUTED, bold=True)
_PLAIN = Pen(SIZE)
_HASH = Pen(HASH_SIZE, family="mono")
_BADGES = {
    True: Pen(SIZE, "#ffffff", bold=True),
    False: Pen(SIZE, FAIL, bold=True),
    None: Pen(SIZE, WARNING, bold=True),
}
_MARKS = {True: Pen(SIZE, PASS), False: Pen(SIZE, FAIL, bold=True), None: Pen(SIZE, MUTED)}


def _pen(column: Column, cell: Cell) -> Pen:
    if isinstance(cell, VerdictMark):
        return _BADGES[cell.passed]
    if isinstance(cell, CheckMark):
        return _MARKS[cell.passed]
    return _HASH if column.kind == "hash" else _PLAIN


def _widths(table: ReportTable, room: float, type_: Typesetter) -> tuple[float, ...]:
    """Share the page's width: numbers and words get what they need, wide columns the rest."""
    need = [_need(i, table, type_) for i in range(len(table.columns))]
    wide = [i for i, column in enumerate(table.columns) if column.kind == "wide"]
    fixed = sum(width for i, (_, width) in enumerate(need) if i not in wide)
    if wide and room - fixed >= NARROWEST * len(wide):
        left = room - fixed - sum(need[i][1] for i in wide)
        if left > 0:
            # No column stands far from the next one because a wide one has more room than words.
            return tuple(width + min(left / len(need), AIRIEST) for _, width in need)
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


def _need(index: int, table: ReportTable, type_: Typesetter) -> tuple[float, float]:
    """Return the least and the natural width of a column, mm."""
    column = table.columns[index]
    cells = [(plain_text(row[index]), _pen(column, row[index])) for row in table.rows]
    spare = 2 * PADDING[0] + 0.6
    natural = max((type_.width(text, pen) for text, pen in cells), default=0.0) + spare
    if column.kind == "hash":
        return natural, natural
    head = max(type_.width(word, _HEAD) for word in _words(_title(column))) + spare
    longest = max((type_.width(word, pen) for text, pen in cells for word in _words(text)), default=0.0) + spare
    if any(isinstance(row[index], VerdictMark) for row in table.rows):
        return max(head, natural + 2), max(head, natural + 2)
    if column.kind == "wide":
        return max(head, min(longest, WIDEST), NARROWEST), max(natural, head)
    if column.kind == "text":
        return max(head, min(longest, WIDEST)), max(head, min(natural, WIDEST))
    return max(head, natural), max(head, natural)


def _words(text: str) -> list[str]:
    """Part a text where a column may break it: at spaces, and a Chinese word of more than eight characters."""
    words: list[str] = []
    for word in text.split(" "):
        middle = (len(word) + 1) // 2
        chinese = any(ord(a) > 0x2E80 for a, _ in pairwise(word + " "))
        words += [word[:middle], word[middle:]] if chinese and len(word) > 8 else [word]
    return words or [""]

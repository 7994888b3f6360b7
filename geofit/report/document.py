"""What a page is made of, with no knowledge of HTML or PDF: headings, tables, pictures, marks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = [
    "Block",
    "Cell",
    "Chapter",
    "CheckMark",
    "Column",
    "Facts",
    "Fields",
    "Heading",
    "Paragraph",
    "Picture",
    "ReportDocument",
    "ReportTable",
    "Signatures",
    "VerdictMark",
]


@dataclass(frozen=True)
class CheckMark:
    """A word with a shape that a black-and-white print keeps: ✓ for True, ✗ for False, none for None."""

    passed: bool | None
    word: str

    @property
    def text(self) -> str:
        """The word behind its sign."""
        return {True: "✓ ", False: "✗ ", None: ""}[self.passed] + self.word


@dataclass(frozen=True)
class VerdictMark:
    """PASS, FAIL or WARNING as a badge: filled for True, a heavy frame for False, a plain frame for None."""

    passed: bool | None
    word: str

    @property
    def text(self) -> str:
        """The word behind its sign."""
        return {True: "✓ ", False: "✗ ", None: "! "}[self.passed] + self.word


Cell = str | CheckMark | VerdictMark


@dataclass(frozen=True)
class Column:
    """A column of a table: numbers stand right; ``wide`` columns take the room that is left, and wrap."""

    title: str
    kind: Literal["text", "number", "wide", "hash"] = "text"


@dataclass(frozen=True)
class Heading:
    """A heading inside a chapter: level 2 or 3."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """Running text; "quiet" stands back, "warning" must be seen."""

    text: str
    style: Literal["plain", "quiet", "warning"] = "plain"


@dataclass(frozen=True)
class ReportTable:
    """A table; a row has a cell for each column. A ``dense`` one, of an annex, has less room between its rows."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    dense: bool = False


@dataclass(frozen=True)
class Facts:
    """Key figures side by side: label, value, and a small line below."""

    items: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Fields:
    """The title block: labels with what stands behind them, in ruled lines; an empty value is a line to fill in."""

    items: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Picture:
    """A picture by its name, and what it shows; one ``to_scale`` keeps its width of 174 mm on paper."""

    name: str
    caption: str
    to_scale: bool = False


@dataclass(frozen=True)
class Signatures:
    """Lines to be filled in by hand: a row for each role, with the name where it is known."""

    columns: tuple[str, ...]
    roles: tuple[tuple[str, str], ...]


Block = Heading | Paragraph | ReportTable | Facts | Fields | Picture | Signatures


@dataclass(frozen=True)
class Chapter:
    """A part of the document; ``verdict`` is next to its title.

    A chapter begins on a new page unless it ``follows`` on: then it begins where there is room for a good part of it.
    The contents leave out the headings inside a chapter that is not ``listed`` in full.
    """

    title: str
    blocks: tuple[Block, ...]
    verdict: VerdictMark | None = None
    follows: bool = False
    listed: bool = True


@dataclass(frozen=True)
class ReportDocument:
    """A whole report in one language: the first chapter is the cover, ``contents`` titles the list of the others.

    ``reference`` is in the running head: document number and revision.
    """

    title: str
    subject: str
    site: str
    date: str
    language: str
    footer: str
    chapters: tuple[Chapter, ...]
    contents: str = ""
    reference: str = ""

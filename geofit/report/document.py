"""What a page is made of, with no knowledge of HTML or PDF: headings, tables, pictures, marks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = [
    "Block",
    "Cell",
    "Chapter",
    "Column",
    "Document",
    "Facts",
    "Heading",
    "Mark",
    "Paragraph",
    "Picture",
    "Signatures",
    "Table",
    "Verdict",
]


@dataclass(frozen=True)
class Mark:
    """A word with a shape that a black-and-white print keeps: ✓ for True, ✗ for False, none for None."""

    passed: bool | None
    word: str

    @property
    def text(self) -> str:
        """The word behind its sign."""
        return {True: "✓ ", False: "✗ ", None: ""}[self.passed] + self.word


@dataclass(frozen=True)
class Verdict:
    """PASS, FAIL or WARNING as a badge: filled for True, a heavy frame for False, a plain frame for None."""

    passed: bool | None
    word: str

    @property
    def text(self) -> str:
        """The word behind its sign."""
        return {True: "✓ ", False: "✗ ", None: "! "}[self.passed] + self.word


Cell = str | Mark | Verdict


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
class Table:
    """A table; a row has a cell for each column."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True)
class Facts:
    """Key figures side by side: label, value, and a small line below."""

    items: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Picture:
    """A picture by its name, and what it shows."""

    name: str
    caption: str


@dataclass(frozen=True)
class Signatures:
    """Empty lines to be filled in by hand: a row for each role, a column for each thing to write."""

    columns: tuple[str, ...]
    roles: tuple[str, ...]


Block = Heading | Paragraph | Table | Facts | Picture | Signatures


@dataclass(frozen=True)
class Chapter:
    """A part that begins on a new page; ``verdict`` stands beside its title."""

    title: str
    blocks: tuple[Block, ...]
    verdict: Verdict | None = None


@dataclass(frozen=True)
class Document:
    """A whole report in one language: the first chapter is the cover."""

    title: str
    subject: str
    site: str
    date: str
    language: str
    footer: str
    chapters: tuple[Chapter, ...]

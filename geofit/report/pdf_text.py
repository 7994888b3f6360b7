"""Text of a PDF: measured and broken into lines once, drawn glyph by glyph where the text's font lacks one."""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from itertools import groupby
from typing import Literal

from fpdf import FPDF
from fpdf.fonts import TTFFont

from geofit.report.style import TEXT, rgb

__all__ = ["POINT", "Pen", "Typesetter"]

Align = Literal["left", "right", "centre"]

#: Millimetres of a point.
POINT = 25.4 / 72
#: Characters that begin no line, and that end none: Chinese and Latin punctuation.
NO_START = frozenset("，。；：、？！）】》」』”’%‰…·,.;:?!)]}′°")
NO_END = frozenset("（【《「『“‘([{")
#: Ends of a line in a word too long for it: in paths, after these.
BREAKS = frozenset("/\\_-|,;")
#: What stays with the number or the comma before it.
UNITS = frozenset(("%", "‰", "m", "mm", "km", "µm", "m²", "m³", "mD", "kB", "ε", "°"))
#: Share of the size from the middle of a line down to the foot of its letters.
DROP = 0.35


@lru_cache(maxsize=512)
class Pen:
    """How a text looks: size in points, colour, weight, family."""

    __slots__ = ("bold", "colour", "family", "size")

    def __init__(self, size: float, colour: str = TEXT, *, bold: bool = False, family: str = "text") -> None:
        self.size, self.colour, self.bold, self.family = size, colour, bold, family


class Typesetter:
    """Measures, breaks and draws text on the pages of a PDF with the fonts "text", "signs" and "mono".

    Parameters
    ----------
    pdf : FPDF
        Its fonts "text" and "signs" have a bold weight.
    """

    def __init__(self, pdf: FPDF) -> None:
        self._pdf = pdf
        self._widths: dict[tuple[str, bool, str], tuple[float, str]] = {}

    def width(self, text: str, pen: Pen) -> float:
        """Return the width of a text, mm."""
        return sum(self._glyph(c, pen)[0] for c in text) * pen.size

    def lines(self, text: str, room: float, pen: Pen) -> list[str]:
        """Break a text into lines no wider than ``room``, mm: at spaces, and between Chinese characters."""
        done: list[str] = []
        for part in text.split("\n"):
            line, wide, last = "", 0.0, ""
            pieces = _pieces(part)
            for k, piece in enumerate(pieces):
                width = self.width(piece, pen)
                if line and wide + self.width(piece.rstrip(" "), pen) > room:
                    # No Chinese character stands alone in the last line.
                    if k == len(pieces) - 1 and _alone(piece) and _alone(last) and last != line:
                        line, piece = line.removesuffix(last), last + piece
                    done.append(line.rstrip(" "))
                    line, wide = "", 0.0
                while width > room and self.width(piece.rstrip(" "), pen) > room:
                    head = self._fitting(piece, room, pen)
                    done.append(head)
                    piece = piece[len(head) :]
                    width = self.width(piece, pen)
                line, wide, last = line + piece, wide + width, piece
            done.append(line.rstrip(" "))
        return done

    def cut(self, text: str, room: float, pen: Pen) -> str:
        """Return a text on one line, its end replaced by "…" where it is too long."""
        if self.width(text, pen) <= room:
            return text
        while text and self.width(text + "…", pen) > room:
            text = text[:-1]
        return text + "…"

    def draw(self, x: float, y: float, text: str, pen: Pen, room: float = 0.0, align: Align = "left") -> None:
        """Draw a line of text; ``y`` is the middle of the line, mm; it is aligned in ``room`` from ``x`` on."""
        if not text:
            return
        if align != "left":
            spare = room - self.width(text, pen)
            x += spare if align == "right" else spare / 2
        pdf, foot = self._pdf, y + DROP * pen.size * POINT
        pdf.set_text_color(*rgb(pen.colour))
        for family, run in groupby(text, key=lambda c: self._glyph(c, pen)[1]):
            word = "".join(run)
            pdf.set_font(family, "B" if pen.bold and family != "mono" else "", pen.size)
            pdf.text(x, foot, word)
            x += self.width(word, pen)

    def _fitting(self, piece: str, room: float, pen: Pen) -> str:
        """Return the beginning of a word that fits: up to a sign that may end a line, if there is one."""
        wide, most = 0.0, 0
        for c in piece:
            wide += self._glyph(c, pen)[0] * pen.size
            if wide > room:
                break
            most += 1
        most = max(most, 1)
        nice = max((k + 1 for k in range(most // 2, most) if piece[k] in BREAKS), default=most)
        return piece[:nice]

    def _glyph(self, c: str, pen: Pen) -> tuple[float, str]:
        """Return the width of a character at one point, mm, and the family that has it."""
        key = (pen.family, pen.bold, c)
        found = self._widths.get(key)
        if found is None:
            family = pen.family
            style = "B" if pen.bold and family != "mono" else ""
            font = self._pdf.fonts[family + style]
            if isinstance(font, TTFFont) and ord(c) not in font.cmap:
                family, style = "signs", "B" if pen.bold else ""
            self._pdf.set_font(family, style, 100)
            found = self._widths[key] = (self._pdf.get_string_width(c) / 100, family)
        return found


def _pieces(text: str) -> list[str]:
    """Part a text where a line may end."""
    if not text:
        return [""]
    pieces: list[str] = []
    word = ""
    for c, following in zip(text, text[1:] + " ", strict=True):
        word += c
        wide = _wide(c) or _wide(following)
        if (c == " " and following != " ") or (
            wide and c != " " and following != " " and following not in NO_START and c not in NO_END
        ):
            pieces.append(word)
            word = ""
    return _with_units([*pieces, word] if word else pieces)


def _with_units(pieces: list[str]) -> list[str]:
    """Join a unit with the number or the comma before it."""
    joined: list[str] = []
    for piece in pieces:
        before = joined[-1] if joined else ""
        number = before.endswith(" ") and before[-2:-1].isdigit()
        if (number or before.endswith("，")) and piece.rstrip(" ,.;:)，。；：）") in UNITS:
            joined[-1] += piece
        else:
            joined.append(piece)
    return joined


def _alone(piece: str) -> bool:
    """Whether a piece is one Chinese character, with its punctuation."""
    return sum(_wide(c) and c not in NO_START and c not in NO_END for c in piece) == 1 and " " not in piece


@lru_cache(maxsize=4096)
def _wide(c: str) -> bool:
    return unicodedata.east_asian_width(c) in "WF"

"""Fonts for pictures and PDF: one that has the Chinese characters of names, where the machine has one."""

from __future__ import annotations

import unicodedata
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from geofit.data.errors import MissingDependencyError
from geofit.data.messages import Message, message

__all__ = ["NO_CHINESE_FONT", "FontFile", "PdfFonts", "families", "missing_font", "pdf_fonts"]

#: Fonts with Chinese characters on Windows, macOS and Linux, the calmer first.
CHINESE = (
    "Noto Sans CJK SC", "Noto Sans SC", "Source Han Sans SC", "Source Han Sans CN", "Microsoft YaHei",
    "PingFang SC",
    "Hiragino Sans GB", "Heiti SC", "STHeiti", "Noto Sans CJK JP", "WenQuanYi Micro Hei", "WenQuanYi Zen Hei",
    "SimHei", "SimSun", "Droid Sans Fallback", "Arial Unicode MS", "Noto Serif CJK SC", "AR PL UMing CN",
)  # fmt: skip
_INSTALL = message(
    "report.install-font",
    "Install one (Debian and Ubuntu: apt-get install fonts-noto-cjk; Windows has Microsoft YaHei among its optional "
    "features) and run again.",
)
NO_CHINESE_FONT = message(
    "report.chinese-font-missing",
    "A Chinese report needs a font with Chinese characters, and this machine has none. {install}",
    install=_INSTALL,
)


@lru_cache(maxsize=1)
def _chinese() -> str | None:
    from matplotlib import font_manager

    # The list is kept in matplotlib's cache; a font installed since then is found among the files.
    known = {entry.name for entry in font_manager.fontManager.ttflist}
    if known.isdisjoint(CHINESE):
        for path in font_manager.findSystemFonts():
            if path not in {entry.fname for entry in font_manager.fontManager.ttflist}:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    try:
                        font_manager.fontManager.addfont(path)
                    except (OSError, RuntimeError, ValueError):
                        continue
        known = {entry.name for entry in font_manager.fontManager.ttflist}
    return next((name for name in CHINESE if name in known), None)


def families() -> list[str]:
    """Return the font families for matplotlib, in the order in which a character is looked for: as in the PDF."""
    chinese = _chinese()
    return [*([chinese] if chinese else []), "DejaVu Sans"]


def missing_font(texts: Iterable[str]) -> Message | None:
    """Say what to install if a text has Chinese characters and no font has them; None if all is well."""
    wide = next((t for t in texts if any(unicodedata.east_asian_width(c) in "WF" for c in t)), None)
    if wide is None or _chinese() is not None:
        return None
    return message(
        "report.characters-missing",
        "No font on this machine has the characters of '{text}': pictures and PDF show boxes in their place. {install} "
        "Tables and text of the HTML and the JSON are complete.",
        text=wide,
        install=_INSTALL,
    )


@dataclass(frozen=True)
class FontFile:
    """A font in a file; ``index`` counts the fonts of a collection."""

    path: str
    index: int = 0


@dataclass(frozen=True)
class PdfFonts:
    """The fonts that a PDF embeds; ``signs`` has what the text font may lack (✗, Greek), ``mono`` is for hashes."""

    regular: FontFile
    bold: FontFile
    signs: FontFile
    signs_bold: FontFile
    mono: FontFile


@lru_cache(maxsize=2)
def pdf_fonts(chinese: bool) -> PdfFonts:
    """Return the fonts for a PDF: the Chinese font where there is one, else what matplotlib brings.

    Raises
    ------
    MissingDependencyError
        If ``chinese`` characters are needed and no font has them.
    """
    signs, signs_bold = _shipped("DejaVu Sans", "normal"), _shipped("DejaVu Sans", "bold")
    mono = _shipped("DejaVu Sans Mono", "normal")
    family = _chinese()
    if family is None:
        if chinese:
            raise MissingDependencyError(NO_CHINESE_FONT)
        return PdfFonts(signs, signs_bold, signs, signs_bold, mono)
    faces = _faces(family)
    regular = min(faces, key=lambda face: abs(face[0] - 400))[1]
    bold = min(faces, key=lambda face: abs(face[0] - 700))[1]
    return PdfFonts(regular, bold, signs, signs_bold, mono)


def _shipped(family: str, weight: str) -> FontFile:
    """Return a font of matplotlib's own."""
    from matplotlib import cbook

    name = family.replace(" ", "") + {"normal": "", "bold": "-Bold"}[weight]
    return FontFile(str(cbook._get_data_path("fonts", "ttf", f"{name}.ttf")))


def _faces(family: str) -> list[tuple[int, FontFile]]:
    """Return the weights of an upright family and their files."""
    from matplotlib import font_manager

    entries = [e for e in font_manager.fontManager.ttflist if e.name == family and e.style == "normal"]
    return [(int(e.weight), FontFile(e.fname, _index(e, family))) for e in entries if isinstance(e.weight, int)]


def _index(entry: Any, family: str) -> int:
    """Return which font of a collection an entry is; matplotlib before 3.11 knows the first one only."""
    index = getattr(entry, "index", None)
    if index is not None:
        return int(index)
    if not entry.fname.casefold().endswith((".ttc", ".otc")):
        return 0
    from fontTools.ttLib import TTCollection

    names = [font["name"].getDebugName(1) for font in TTCollection(entry.fname, lazy=True).fonts]
    return names.index(family) if family in names else 0

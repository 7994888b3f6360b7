"""Fonts for the pictures: one that has the Chinese characters of names, where the machine has one."""

from __future__ import annotations

import unicodedata
import warnings
from collections.abc import Iterable
from functools import lru_cache

__all__ = ["families", "missing_font"]

#: Fonts with Chinese characters on Windows, macOS and Linux, the calmer first.
CHINESE = (
    "Noto Sans CJK SC", "Noto Sans SC", "Source Han Sans SC", "Source Han Sans CN", "Microsoft YaHei",
    "PingFang SC",
    "Hiragino Sans GB", "Heiti SC", "STHeiti", "Noto Sans CJK JP", "WenQuanYi Micro Hei", "WenQuanYi Zen Hei",
    "SimHei", "SimSun", "Droid Sans Fallback", "Arial Unicode MS", "Noto Serif CJK SC", "AR PL UMing CN",
)  # fmt: skip


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
    """Return the font families for matplotlib, in the order in which a character is looked for."""
    chinese = _chinese()
    return ["DejaVu Sans", *([chinese] if chinese else [])]


def missing_font(texts: Iterable[str]) -> str | None:
    """Say what to install if a text has Chinese characters and no font has them; None if all is well."""
    wide = next((t for t in texts if any(unicodedata.east_asian_width(c) in "WF" for c in t)), None)
    if wide is None or _chinese() is not None:
        return None
    return (
        f"No font on this machine has the characters of '{wide}': the pictures show boxes in their place. "
        "Install one (Debian and Ubuntu: apt-get install fonts-noto-cjk) and run again. "
        "Tables and text are complete."
    )

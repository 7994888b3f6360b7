"""Long names where there is little room: cut in the middle, or broken where a word is too long for a panel."""

from __future__ import annotations

import re

__all__ = ["breakable", "shortened"]

#: A longer word may be broken, at one of these signs or after so many letters.
LONGEST, SIGNS = 24, r"[_\-./\\:]"
_GAP = "\N{ZERO WIDTH SPACE}"


def shortened(name: str, most: int = 28) -> str:
    """Return a name with no more letters than that: its beginning and its end.

    Examples
    --------
    >>> shortened("T2-T1"), shortened("base_of_the_weathered_granodiorite_1987", 15)
    ('T2-T1', 'base_of…te_1987')
    """
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}…{name[-half:]}"


def breakable(text: str) -> str:
    """Return a text whose long words a label can break: a label is never narrower than its longest word.

    Examples
    --------
    >>> breakable("Fit of T2-T1") == "Fit of T2-T1", len(breakable("x" * 50)) - 50
    (True, 2)
    """

    def parted(found: re.Match[str]) -> str:
        return re.sub(rf"({SIGNS}|[^_\-./\\:]{{{LONGEST}}})(?=.)", rf"\1{_GAP}", found[0])

    return re.sub(rf"\S{{{LONGEST + 1},}}", parted, text)

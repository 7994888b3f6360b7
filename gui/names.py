"""Names as widgets show them: long ones in narrow panels, and signs that Qt takes for something else."""

from __future__ import annotations

import re

__all__ = ["breakable", "literal"]

#: A longer word may be broken, at one of these signs or after so many letters.
LONGEST, SIGNS = 24, r"[_\-./\\:]"
_GAP = "\N{ZERO WIDTH SPACE}"


def breakable(text: str) -> str:
    """Return a text whose long words a label can break: a label is never narrower than its longest word.

    Examples
    --------
    >>> breakable("Fit of T2-T1") == "Fit of T2-T1", len(breakable("x" * 50)) - 50
    (True, 2)
    """

    def split_word(found: re.Match[str]) -> str:
        return re.sub(rf"({SIGNS}|[^_\-./\\:]{{{LONGEST}}})(?=.)", rf"\1{_GAP}", found[0])

    return re.sub(rf"\S{{{LONGEST + 1},}}", split_word, text)


def literal(text: str) -> str:
    """Return a text that menus and buttons show as it is: a single & would underline the next letter.

    Examples
    --------
    >>> literal("T2 & T3")
    'T2 && T3'
    """
    return text.replace("&", "&&")

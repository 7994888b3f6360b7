"""How numbers are written where people read them: the digits of a length, the groups of a large number."""

from __future__ import annotations

import math

__all__ = ["GAP", "in_groups", "rounded_metres"]

#: Keeps the groups of thousands on one line.
GAP = "\N{NO-BREAK SPACE}"
#: Below this, metres, powers of ten are shorter than zeros.
SMALL = 1e-4


def rounded_metres(value: float) -> str:
    """Write a length in metres: three significant digits, and never less than a millimetre.

    Examples
    --------
    >>> [rounded_metres(value) for value in (0.000423, 0.1699, -12.34567, 5970.1234, 4.2e-6, 0.0)]
    ['0.000423', '0.170', '-12.346', '5970.123', '4.20e-6', '0']
    """
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if abs(value) < SMALL:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{value:.{max(3, 2 - math.floor(math.log10(abs(value))))}f}"


def in_groups(text: str) -> str:
    """Part the digits of a decimal number before its point in threes, from five digits on; its sign stays.

    Examples
    --------
    >>> in_groups("9999"), in_groups("437189.0").split(), in_groups("−15000").split()
    ('9999', ['437', '189.0'], ['−15', '000'])
    """
    whole, point, rest = text.partition(".")
    digits = whole.lstrip("−-")
    if len(digits) <= 4:
        return text
    first = len(digits) % 3
    groups = [digits[:first], *(digits[k : k + 3] for k in range(first, len(digits), 3))]
    return whole[: len(whole) - len(digits)] + GAP.join(filter(None, groups)) + point + rest

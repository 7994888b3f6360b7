"""How many digits a length has where people read it."""

from __future__ import annotations

import math

__all__ = ["rounded_metres"]

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

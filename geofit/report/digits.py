"""Numbers as people read them: one place that decides how many digits a figure has."""

from __future__ import annotations

import math

from geofit.data.rounding import GAP, in_groups, rounded_metres

__all__ = [
    "area",
    "count",
    "degrees",
    "equals",
    "figure",
    "given",
    "kilobytes",
    "length",
    "measured",
    "metres",
    "place",
    "share",
    "tick",
    "typeset",
    "volume",
]

#: A figure that is not there.
NOTHING = "–"
#: Below this a distance is the rounding of the computer, not a property of a surface; metres or degrees.
NOISE = 1e-9
_UNITS = {"m": "m", "deg": "°", "degrees": "°", "m2": "m²", "m3": "m³", "1": "", "": ""}


def metres(value: float | None) -> str:
    """Write metres: three significant digits, and never less than a millimetre.

    Examples
    --------
    >>> metres(0.000423), metres(0.1699), metres(-12.34567), metres(4.2e-6), metres(0.0)
    ('0.000423', '0.170', '−12.346', '4.20e-6', '0')
    >>> metres(3e-14).split(), metres(None), metres(float("nan"))
    (['<', '1e-9'], '–', '–')
    """
    if value is None or not math.isfinite(value):
        return NOTHING
    if value == 0:
        return "0"
    sign = "−" if value < 0 else ""
    size = abs(value)
    if size < NOISE:
        return f"<{GAP}1e-9"
    return sign + (rounded_metres(size) if size < 1 else in_groups(rounded_metres(size)))


def length(value: float | None) -> str:
    """Write metres with their unit; a dash alone for nothing.

    Examples
    --------
    >>> length(0.25).split(), length(None)
    (['0.250', 'm'], '–')
    """
    text = metres(value)
    return text if text == NOTHING else f"{text}{GAP}m"


def equals(value: float | None) -> str:
    """Write metres behind the sign that stands between a symbol and its value.

    Examples
    --------
    >>> equals(0.0301).split(), equals(3e-14).split()
    (['=', '0.0301', 'm'], ['<', '1e-9', 'm'])
    """
    text = length(value)
    return text if text.startswith("<") else f"={GAP}{text}"


def degrees(value: float | None) -> str:
    """Write degrees, with the digits of metres.

    Examples
    --------
    >>> degrees(0.1)
    '0.100'
    """
    return metres(value)


def place(value: float | None) -> str:
    """Write a map coordinate or an elevation to the centimetre, metres.

    Examples
    --------
    >>> place(3_100_012.346)
    '3100012.35'
    """
    return NOTHING if value is None or not math.isfinite(value) else f"{value:.2f}".replace("-", "−")


def tick(value: float) -> str:
    """Write a round number of an axis or a contour, with the groups of :func:`count`.

    Examples
    --------
    >>> tick(-8900.0), tick(0.25), tick(3_100_500.0).split()
    ('−8900', '0.25', ['3', '100', '500'])
    """
    return typeset(f"{round(value, 6) + 0.0:.10g}")


def given(value: float) -> str:
    """Write a number that a person chose, a tolerance for one, as it was chosen.

    Examples
    --------
    >>> given(0.5), given(0.01)
    ('0.5', '0.01')
    """
    return f"{value:g}"


def count(value: float | None) -> str:
    """Write a whole number, or a large area or volume, in groups of three.

    Examples
    --------
    >>> count(1234567).split(), count(None)
    (['1', '234', '567'], '–')
    """
    return NOTHING if value is None or not math.isfinite(value) else typeset(f"{value:.0f}")


def figure(value: float) -> str:
    """Write a number with four significant digits or all before the point.

    Examples
    --------
    >>> figure(44983.2).split(), figure(-0.123456)
    (['44', '983'], '−0.1235')
    """
    return count(value) if abs(value) >= 1000 else f"{value:.4g}".replace("-", "−")


def volume(value: float | None) -> str:
    """Write cubic metres with the digits of :func:`figure`.

    Examples
    --------
    >>> volume(1234567.8).split(), volume(12.3456).split()
    (['1', '234', '568', 'm³'], ['12.35', 'm³'])
    """
    return _measure(value, "m³")


def area(value: float | None) -> str:
    """Write square metres as :func:`volume` writes cubic ones."""
    return _measure(value, "m²")


def _measure(value: float | None, unit: str) -> str:
    if value is None or not math.isfinite(value):
        return NOTHING
    return f"{figure(value)}{GAP}{unit}"


def share(value: float | None) -> str:
    """Write a part of one as per cent.

    Examples
    --------
    >>> share(0.9021).split()
    ['90.2', '%']
    """
    return NOTHING if value is None or not math.isfinite(value) else f"{100 * value:.1f}{GAP}%".replace("-", "−")


def kilobytes(value: float) -> str:
    """Write bytes as kilobytes."""
    return f"{count(value / 1024)}{GAP}kB"


def measured(value: float | None, unit: str) -> str:
    """Write what a check measured with its unit: lengths and angles as metres(), areas and volumes as volume().

    Examples
    --------
    >>> measured(3.0, ""), measured(0.25, "deg").split(), measured(437189.0, "m3").split()
    ('3', ['0.250', '°'], ['437', '189', 'm³'])
    """
    if value is None or not math.isfinite(value):
        return NOTHING
    if unit in ("m", "deg", "°"):
        return f"{metres(value)}{GAP}{_UNITS.get(unit, unit)}"
    if unit in ("m2", "m3"):
        return _measure(value, _UNITS[unit])
    text = count(value) if float(value).is_integer() else f"{value:.3g}".replace("-", "−")
    return f"{text}{GAP}{_UNITS.get(unit, unit)}".rstrip(GAP)


def typeset(text: str) -> str:
    """Write a plain decimal number with a minus sign, and its digits before the point in threes, from five on.

    Examples
    --------
    >>> typeset("-12.50"), typeset("437189.0").split()
    ('−12.50', ['437', '189.0'])
    """
    return in_groups(text.replace("-", "−"))

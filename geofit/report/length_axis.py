"""Axes of drawings: round numbers in the unit of the drawing, those of maps along the vertical axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.report.digits import tick

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

__all__ = ["number_axis", "upright"]

#: Width of a digit as a share of its size.
DIGIT = 0.55


def number_axis(axis: Axis, unit: LengthUnit, most: int) -> None:
    """Put about ``most`` round numbers of a unit on an axis of metres."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    per = LENGTH_UNITS[unit]
    low, high = axis.get_view_interval()
    places = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(low / per, high / per)
    axis.set_major_locator(FixedLocator([place * per for place in places if low <= place * per <= high]))
    axis.set_major_formatter(FuncFormatter(lambda metres, _: tick(metres / per)))


def upright(axes: Axes) -> None:
    """Write the numbers of the vertical axis along it, and none beyond its ends, where the page may be cut."""
    low, high = axes.get_ylim()
    tall = axes.get_window_extent().height / axes.figure.dpi * 72
    for label, value in zip(axes.get_yticklabels(), axes.get_yticks(), strict=True):
        half = DIGIT * float(label.get_fontsize()) * len(label.get_text()) / 2
        place = (value - low) / (high - low) * tall
        label.set(rotation=90, va="bottom" if place < half else "top" if place > tall - half else "center")

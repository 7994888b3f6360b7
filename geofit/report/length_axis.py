"""Axes in metres whose numbers are in the unit of a drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geofit.data.lengths import LENGTH_UNITS, LengthUnit

if TYPE_CHECKING:
    from matplotlib.axis import Axis

__all__ = ["number_axis"]


def number_axis(axis: Axis, unit: LengthUnit, most: int) -> None:
    """Put about ``most`` round numbers of a unit on an axis of metres."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    per = LENGTH_UNITS[unit]
    low, high = axis.get_view_interval()
    places = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(low / per, high / per)
    axis.set_major_locator(FixedLocator([place * per for place in places if low <= place * per <= high]))
    axis.set_major_formatter(
        FuncFormatter(lambda metres, _: f"{round(metres / per, 6):,.10g}".replace(",", "\N{NO-BREAK SPACE}"))
    )

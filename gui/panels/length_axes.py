"""Axes of metres whose numbers are in the unit that is shown."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from geofit.gui.lengths import in_title, metres_shown

__all__ = ["LengthLocator", "number_lengths"]


class LengthLocator(MaxNLocator):
    """Round numbers on an axis of metres, in the unit that is shown."""

    def tick_values(self, vmin: float, vmax: float) -> list[float]:
        """Return the places of the ticks, metres."""
        per = metres_shown()
        return [float(value) * per for value in super().tick_values(vmin / per, vmax / per)]


def number_lengths(axes: Axes) -> None:
    """Write the numbers of the axes that are metres, by their labels (", m"), in the unit that is shown."""
    for axis in (axes.xaxis, axes.yaxis):
        title = in_title(axis.get_label_text())
        if title == axis.get_label_text():
            continue
        axis.set_label_text(title)
        axis.set_major_locator(LengthLocator(nbins=6, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda metres, _: f"{round(metres / metres_shown(), 6):.10g}"))

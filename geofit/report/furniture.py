"""What a drawing to scale carries: its scale, a bar that measures it, and an arrow to the north."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geofit.data.lengths import LENGTH_UNITS, LengthUnit, unit_mark
from geofit.data.rounding import in_groups
from geofit.report.style import MUTED, PAPER, TEXT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["exaggeration_for", "north_arrow", "scale_bar", "scale_for", "scale_text"]

#: Denominators of the scales of engineering drawings, times powers of ten.
STEPS = (1.0, 2.0, 2.5, 5.0)
#: Heights of a section are drawn so many times larger, the least that reaches SHALLOWEST mm.
EXAGGERATIONS = (1, 2, 5, 10)
SHALLOWEST = 30.0


def scale_for(length: float, room: float) -> int:
    """Return the denominator of the largest usual scale at which a length (m) fits into a room (mm).

    Examples
    --------
    >>> scale_for(1500.0, 150.0), scale_for(420.0, 150.0)
    (10000, 5000)
    """
    least = max(length, 1e-6) * 1000.0 / room * (1 - 1e-9)
    power = 10.0 ** math.floor(math.log10(least))
    return max(round(next(step * power for step in (*STEPS, 10.0) if step * power >= least)), 1)


def exaggeration_for(relief: float, scale: int, most: float) -> int:
    """Return how many times heights are raised: the least that makes a relief (m) tall enough, within ``most`` mm."""
    millimetres = relief * 1000.0 / scale
    fitting = [times for times in EXAGGERATIONS if millimetres * times <= most] or [1]
    return next((times for times in fitting if millimetres * times >= SHALLOWEST), fitting[-1])


def scale_text(scale: int) -> str:
    """Return a scale as it is printed.

    Examples
    --------
    >>> scale_text(10000).split()
    ['1:10', '000']
    """
    return f"1:{in_groups(str(scale))}"


def scale_bar(axes: Axes, scale: int, x: float, y: float, unit: LengthUnit = "m") -> None:
    """Draw a bar of four parts, about 40 mm long; ``x`` and ``y`` are millimetres from the axes' lower left corner."""
    per = LENGTH_UNITS[unit]
    part = _round(10.0 * scale / 1000.0 / per)
    wide = part * per * 1000.0 / scale
    for k in range(4):
        colour = TEXT if k % 2 == 0 else PAPER
        _box(axes, x + k * wide, y, wide, 1.3, colour)
    for k in (0, 1, 2, 4):
        words = f"{part * k:g}" + (f"\N{NO-BREAK SPACE}{unit_mark(unit)}" if k == 4 else "")
        _word(axes, x + k * wide, y + 2.0, words)


def north_arrow(axes: Axes, x: float, y: float, word: str) -> None:
    """Draw an arrow to grid north, 11 mm tall; ``x`` and ``y`` (mm) are its foot from the axes' lower left corner."""
    from matplotlib.patches import Polygon

    for side, colour in ((-1, TEXT), (1, PAPER)):
        corners = [(x, y + 11), (x + side * 2.6, y), (x, y + 2.4)]
        axes.add_patch(
            Polygon(corners, closed=True, fc=colour, ec=TEXT, lw=0.6, transform=_millimetres(axes), zorder=9,
                    clip_on=False)
        )  # fmt: skip
    _word(axes, x, y + 12.0, word, size=8.0, weight="bold", colour=TEXT)


def _round(length: float) -> float:
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (*STEPS, 10.0) if step * power <= length * (1 + 1e-9))


def _millimetres(axes: Axes) -> Any:
    """Return a transformation from millimetres about the lower left corner of the axes."""
    from matplotlib.transforms import Affine2D

    box, figure = axes.get_position(), axes.get_figure(root=True)
    assert figure is not None
    wide, tall = figure.get_size_inches()
    return Affine2D().scale(1 / 25.4).translate(box.x0 * wide, box.y0 * tall) + figure.dpi_scale_trans


def _box(axes: Axes, x: float, y: float, wide: float, tall: float, colour: str) -> None:
    from matplotlib.patches import Rectangle

    box = Rectangle(
        (x, y), wide, tall, fc=colour, ec=TEXT, lw=0.6, transform=_millimetres(axes), clip_on=False, zorder=9
    )
    axes.add_patch(box)


def _word(
    axes: Axes, x: float, y: float, text: str, size: float = 6.5, weight: str = "normal", colour: str = MUTED
) -> None:
    axes.text(
        x, y, text, size=size, weight=weight, color=colour, ha="center", va="bottom", transform=_millimetres(axes),
        zorder=9, clip_on=False,
    )  # fmt: skip

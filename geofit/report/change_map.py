"""The map of what moved: the difference of a horizon between two states, and the contacts found since."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geofit.data.languages import EN, Language
from geofit.report.plots import legend, map_axes
from geofit.report.style import FAIL, MUTED, PASS, TEXT
from geofit.site.states import Comparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["change_map", "levels_for"]

#: Blue where the horizon fell, white where it stayed, orange where it rose: distinct for colour-blind readers, too.
BELOW, STAYED, ABOVE = ("#08335a", "#2a7fbd", "#a9d0ea"), "#f5f4f0", ("#f6c894", "#d5701a", "#742603")
#: Metres of a map whose difference is nowhere known.
_NONE = 1.0
#: Limits of the colours, in epsilons; the last one grows with the largest difference.
STEPS = (1.0, 2.0, 4.0)


def levels_for(comparison: Comparison) -> list[float]:
    """Return the limits of the colours, metres: symmetric, and within one epsilon nothing has moved."""
    change = comparison.change
    most = max(abs(change.most), abs(change.least)) if change.area else _NONE
    outer = [step * change.epsilon for step in STEPS]
    outer.append(max(most * 1.0001, 2 * outer[-1]))
    return [*(-value for value in reversed(outer)), *outer]


def _words(low: float, high: float, epsilon: float, t: Language) -> str:
    """Return the words for one colour."""
    if low < 0 < high:
        return t("within ± {limit:g} m", limit=epsilon)
    if low > 0:
        return t("higher by {low:.3g} to {high:.3g} m", low=low, high=high)
    return t("lower by {low:.3g} to {high:.3g} m", low=-high, high=-low)


def change_map(axes: Axes, comparison: Comparison, t: Language = EN, stayed: str = STAYED) -> None:
    """Draw where a horizon rose and fell, what moved by more than epsilon in a line, and the new contacts."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    change, levels = comparison.change, levels_for(comparison)
    colours = ListedColormap([*BELOW, stayed, *ABOVE])
    norm = BoundaryNorm(levels, colours.N)
    grid = change.difference
    if change.area:
        z = np.ma.masked_invalid(grid.z)
        step = (grid.x[1] - grid.x[0]) / 2
        around = (grid.x[0] - step, grid.x[-1] + step, grid.y[0] - step, grid.y[-1] + step)
        axes.imshow(z, cmap=colours, norm=norm, extent=around, origin="lower", interpolation="nearest", zorder=0)
        lines = [value for value in levels if abs(abs(value) - change.epsilon) < 1e-12]
        if np.nanmax(np.abs(grid.z)) > change.epsilon:
            axes.contour(grid.x, grid.y, z, levels=lines, colors=TEXT, linewidths=0.6, linestyles="solid", zorder=1)
        for k in reversed(range(colours.N)):
            low, high = levels[k], levels[k + 1]
            if ((z >= low) & (z < high)).any():
                axes.fill([], [], color=colours(k), lw=0.4, ec=MUTED, label=_words(low, high, change.epsilon, t))
    for inside, marker, colour, word in (
        (True, "o", PASS, t("new, inside the band")),
        (False, "X", FAIL, t("new, outside the band")),
        (None, "s", MUTED, t("new, no band there")),
    ):
        xy = np.array([(one.x, one.y) for one in comparison.test.contacts if one.inside is inside])
        if len(xy):
            axes.scatter(xy[:, 0], xy[:, 1], s=26, marker=marker, color=colour, lw=0.7, edgecolor="white", zorder=3,
                         label=f"{word} ({len(xy)})")  # fmt: skip
    axes.set_title(t("Later minus earlier elevation"))
    map_axes(axes, t("Easting, m"), t("Northing, m"))
    legend(axes)

"""Colours, bands and type of the pictures: one place, so that every picture looks like its neighbour."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.settings import FitSettings
from geofit.data.site import COLOURS
from geofit.report.fonts import families

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "HORIZONS",
    "KIND_STYLE",
    "LINE",
    "MUTED",
    "PAPER",
    "TEXT",
    "Band",
    "bands",
    "clauses_in_lines",
    "drawing",
    "horizon_colours",
    "kind_style",
    "legend_columns",
    "quiet_axes",
    "rgb",
    "shortened",
]  # fmt: skip

TEXT, MUTED, LINE, PAPER = "#1c2733", "#5d6b7a", "#d4dae1", "#ffffff"
CORE, PASS, FAIL, QUIET, WARNING = "#0b5c8a", "#1b6e3c", "#a3271c", "#8795a3", "#b2611b"

#: Marker and colour of each kind of source; shapes differ, so that a black-and-white print still tells.
KIND_STYLE = {
    "borehole": ("o", "#0b5c8a"),
    "adit": ("s", "#7a4d9a"),
    "section": (".", "#3a4652"),
    "outcrop": ("^", "#b2611b"),
    "geophysics": ("D", "#2b7a78"),
    "map": ("v", "#8c6d1f"),
    "point": (".", "#3a4652"),
}
_OTHER = ("P", "#6b6b6b")

#: Colours of the horizons in turn. All stand out from white paper and from a dark window alike, so that a horizon has
#: the very same colour in both; the first five can be distinguished by colour-blind readers too.
HORIZONS = COLOURS

#: Deviations: near zero, then three steps below and three above the surface. What is farther off stands out more: on
#: white it is darker, on a dark ground brighter.
_NEAR = ("#8f8f8a", "#8d8d88")
_BELOW = (("#90c4e6", "#2a7fbd", "#08335a"), ("#2c69a8", "#55aef2", "#cdecff"))
_ABOVE = (("#f4b97f", "#d5701a", "#742603"), ("#95521a", "#f08d2a", "#ffe09a"))


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue of #rrggbb, 0 to 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def kind_style(kind: str) -> tuple[str, str]:
    """Return marker and colour of a kind of source."""
    return KIND_STYLE.get(kind, _OTHER)


def horizon_colours(names: Iterable[str], blocks: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return the colour of each horizon by its place in the site's order; the one place that decides it.

    ``blocks`` names the horizon of each fault block: its blocks have its colour, and those below keep theirs.

    Examples
    --------
    >>> before = horizon_colours(["T3-T2", "W"])
    >>> after = horizon_colours(["T3-T2 (A)", "T3-T2 (B)", "W", "F1"], {"T3-T2 (A)": "T3-T2", "T3-T2 (B)": "T3-T2"})
    >>> after["T3-T2 (A)"] == after["T3-T2 (B)"] == before["T3-T2"], after["W"] == before["W"]
    (True, True)
    """
    whole = {name: (blocks or {}).get(name, name) for name in names}
    place = {name: k for k, name in enumerate(dict.fromkeys(whole.values()))}
    return {name: HORIZONS[place[of] % len(HORIZONS)] for name, of in whole.items()}


def shortened(name: str, most: int = 28) -> str:
    """Return a name with no more letters than that, for a legend: its beginning and its end.

    Examples
    --------
    >>> shortened("T2-T1"), shortened("base_of_the_weathered_granodiorite_1987", 15)
    ('T2-T1', 'base_of…te_1987')
    """
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}…{name[-half:]}"


def legend_columns(labels: Iterable[str], room: float, size: float, most: int) -> int:
    """Return how many columns of a legend fit into a room (mm) with type of a size (points), ``most`` at most.

    Examples
    --------
    >>> [legend_columns([name], 155.0, 6.5, 5) for name in ("T1", "x" * 28, "风化" * 14)]
    [5, 3, 1]
    """
    widest = max((text_width(label, size) for label in labels), default=text_width(" ", size))
    return int(min(max(room / (widest + 9.0), 1), most))


def text_width(text: str, size: float) -> float:
    """Return about how wide a text is (mm) in type of a size (points); Chinese letters are twice as wide.

    Examples
    --------
    >>> round(text_width("T1", 10.0), 2), round(text_width("风化", 10.0), 2)
    (3.88, 7.76)
    """
    return 0.55 * size * 0.3528 * sum(1 + (ord(letter) > 0x2E80) for letter in text)


def clauses_in_lines(text: str, size: float, room: float) -> list[str]:
    """Break a text between its clauses and names into lines of about ``room`` mm at most, in type of a size (points).

    Examples
    --------
    >>> clauses_in_lines("one; two, three", 10.0, 20.0)
    ['one; two,', 'three']
    """
    lines = [""]
    for clause in re.split(r"(?<=[;,] )|(?<=[；，、])", text):
        if lines[-1] and text_width(lines[-1] + clause.rstrip(), size) > room:
            lines.append("")
        lines[-1] += clause
    return [line.rstrip() for line in lines]


@dataclass(frozen=True)
class Band:
    """A band of |d|: from ``low`` (included) to ``high`` metres; ``area`` of its marker in points squared."""

    low: float
    high: float
    label: str
    below: str
    above: str
    area: float

    def holds(self, d: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which residuals fall into the band."""
        return np.asarray((np.abs(d) >= self.low) & (np.abs(d) < self.high))


def bands(settings: FitSettings, *, dark: bool = False) -> tuple[Band, ...]:
    """Return the bands of a deviation map: bounded by the three tolerances, not by the data.

    Blue lies below the surface, orange above; larger, and darker (on a ``dark`` ground brighter), is further off.
    """
    limits = sorted({settings.boundary_tolerance, settings.interior_tolerance, settings.epsilon})
    edges = [0.0, *limits, np.inf]
    shades = -len(edges) + 2
    blues, oranges = ((_NEAR[dark], *steps[dark][shades:]) for steps in (_BELOW, _ABOVE))
    areas = (14.0, *(22.0, 44.0, 90.0)[shades:])
    made = []
    for i, (low, high) in enumerate(pairwise(edges)):
        label = f"|d| < {high:g} m" if i == 0 else f"{low:g} – {high:g} m" if np.isfinite(high) else f"≥ {low:g} m"
        made.append(Band(low, high, label, blues[i], oranges[i], areas[i]))
    return tuple(made)


@contextmanager
def drawing(size: float = 9.0) -> Iterator[None]:
    """Hold matplotlib's settings for one picture, type in points; a missing glyph is reported once, by the caller."""
    import matplotlib as mpl

    # The names that matplotlib's types allow change with its release.
    settings: dict[Any, Any] = {
        "font.family": families(),
        "font.size": size,
        "text.color": TEXT,
        "axes.edgecolor": LINE,
        "axes.labelcolor": MUTED,
        "axes.linewidth": 0.8,
        "axes.titlesize": size + 1,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.titlepad": 8.0,
        # Given, so that nothing is measured for it: no axis has its numbers above.
        "axes.titley": 1.0,
        "axes.unicode_minus": True,
        "xtick.color": MUTED,
        "ytick.color": MUTED,
        "xtick.labelsize": size - 1,
        "ytick.labelsize": size - 1,
        "legend.frameon": False,
        "legend.fontsize": size - 1,
        "figure.facecolor": PAPER,
        "savefig.facecolor": PAPER,
    }
    with mpl.rc_context(settings), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        yield


def quiet_axes(axes: Axes) -> None:
    """Leave only the axes that carry numbers."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(length=3, width=0.8)

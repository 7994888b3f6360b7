"""Measured dips on a stereonet: Schmidt's net, lower hemisphere, poles or traces of the planes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import EN, Language
from geofit.geometry.attitudes import great_circle, mean_plane, poles
from geofit.report.style import FAIL, LINE, MUTED, PAPER, TEXT, quiet_axes
from geofit.site.dips import LIMIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["StereonetContent", "angles", "stereonet"]

Floats = NDArray[np.float64]

#: Degrees between the circles and spokes of the net.
GRID = 30
#: Measurements whose traces are drawn; more are a black disc.
TRACES = 60
#: Width of the bars of angles, degrees.
STEP = 2.5
#: A mean of fewer planes than these says nothing.
LEAST = 3


@dataclass(frozen=True, eq=False)
class StereonetContent:
    """What a stereonet shows: n measured planes (degrees), a colour each, and planes of surfaces to compare them with.

    ``surface`` holds azimuth and dip of the surface at each measurement, nan where it has none; ``chosen`` is the
    number of the plane that stands out.
    """

    azimuth: Floats
    dip: Floats
    colours: Sequence[str]
    surface: tuple[Floats, Floats] | None = None
    chosen: int | None = None
    traces: bool = False


def stereonet(axes: Axes, net: StereonetContent, t: Language = EN) -> None:
    """Draw the net, the poles of the measured planes, the surface's own as rings, and the mean plane's trace."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(-1.16, 1.16)
    axes.set_ylim(-1.16, 1.16)
    _grid(axes, t)
    if net.traces:
        for k in range(min(len(net.dip), TRACES)):
            x, y = great_circle(float(net.azimuth[k]), float(net.dip[k])).T
            axes.plot(x, y, color=net.colours[k], lw=0.8, zorder=3)
    if net.surface is not None:
        known = np.isfinite(net.surface[1])
        x, y = poles(net.surface[0][known], net.surface[1][known]).T
        axes.plot(
            x, y, "o", color=MUTED, mfc="none", ms=6.5, mew=1.0, zorder=4, label=t("surface at the same places"), ls=""
        )
    places = poles(net.azimuth, net.dip)
    for colour in dict.fromkeys(net.colours):
        x, y = places[[one == colour for one in net.colours]].T
        axes.plot(x, y, "o", color=colour, mec=PAPER, mew=0.5, ms=5.0, zorder=5, ls="")
    if len(net.dip) >= LEAST:
        azimuth, dip, _ = mean_plane(net.azimuth, net.dip)
        x, y = great_circle(azimuth, dip).T
        axes.plot(x, y, color=TEXT, lw=1.2, ls="dashed", zorder=4)
    if net.chosen is not None:
        k = net.chosen
        x, y = great_circle(float(net.azimuth[k]), float(net.dip[k])).T
        axes.plot(x, y, color=TEXT, lw=1.8, zorder=6)
        axes.plot(*places[k : k + 1].T, "o", color=TEXT, mfc="none", ms=11, mew=1.8, zorder=7, ls="")


def angles(axes: Axes, angle: Floats, t: Language = EN) -> None:
    """Draw how many of the measured planes lie how far from the surface, (n,) degrees, with the limit of the check."""
    from matplotlib.ticker import MaxNLocator

    axes.set_title(t("Angle between measured plane and surface"))
    widest = max(float(angle.max()) * 1.04, LIMIT * 1.1)
    edges = np.arange(0.0, widest + STEP, STEP)
    axes.bar(edges[:-1], np.histogram(angle, edges)[0], STEP, align="edge", color="#8fa9bd", edgecolor=PAPER, lw=0.5)
    axes.axvline(LIMIT, color=FAIL, lw=1.1, label=t("limit of the check {limit:g}°", limit=LIMIT))
    axes.set_xlim(0, widest)
    axes.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    axes.set_xlabel(t("angle, °"))
    axes.set_ylabel(t("dips"))
    axes.grid(axis="y", color=LINE, lw=0.6)
    axes.set_axisbelow(True)
    quiet_axes(axes)
    axes.legend(loc="upper right")


def _grid(axes: Axes, t: Language) -> None:
    turn = np.linspace(0, 2 * np.pi, 181)
    for dip in range(GRID, 90, GRID):
        radius = np.sqrt(2) * np.sin(np.radians(dip) / 2)
        axes.plot(radius * np.cos(turn), radius * np.sin(turn), color=LINE, lw=0.6, zorder=1)
    for azimuth in range(0, 180, GRID):
        x, y = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
        axes.plot([-x, x], [-y, y], color=LINE, lw=0.6, zorder=1)
    axes.plot(np.cos(turn), np.sin(turn), color=MUTED, lw=1.1, zorder=2)
    for azimuth, word in ((0, t("N")), (90, t("E")), (180, t("S")), (270, t("W"))):
        x, y = 1.08 * np.sin(np.radians(azimuth)), 1.08 * np.cos(np.radians(azimuth))
        axes.text(x, y, word, ha="center", va="center", color=MUTED)

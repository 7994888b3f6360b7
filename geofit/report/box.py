"""The axes of a picture in space: three edges of the box around it, with coordinates, in the type of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import Language
from geofit.report.digits import tick
from geofit.report.style import LINE, MUTED, TEXT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from geofit.report.scene import Scene

__all__ = ["draw_boxed"]

Floats = NDArray[np.float64]

#: Length of a tick and distance of its label, points.
TICK, LABEL = 4.0, 11.0
#: Type of coordinates, points; and brightness from which a picture is paper.
SIZE, PAPER = 6.2, 252


def draw_boxed(axes: Axes, scene: Scene, t: Language) -> None:
    """Show a picture in space, seen from the south-west, in a box that carries the coordinates."""
    # The box is seen behind what is drawn: the paper of the picture is taken away.
    paper = np.where(scene.image.min(axis=2) >= PAPER, 0, 255).astype(np.uint8)
    axes.imshow(np.dstack([scene.image, paper]), interpolation="antialiased", zorder=2)
    axes.set_axis_off()
    low, high = scene.low, scene.high
    far = [
        ((low[0], high[1], low[2]), (high[0], high[1], low[2])),
        ((high[0], low[1], low[2]), (high[0], high[1], low[2])),
        ((high[0], high[1], low[2]), (high[0], high[1], high[2])),
        ((low[0], high[1], low[2]), (low[0], high[1], high[2])),
        ((low[0], high[1], high[2]), (high[0], high[1], high[2])),
        ((high[0], low[1], high[2]), (high[0], high[1], high[2])),
        ((high[0], low[1], low[2]), (high[0], low[1], high[2])),
    ]
    for ends in far:
        axes.plot(*scene.pixels(np.array(ends)).T, color=LINE, lw=0.6, zorder=1, clip_on=False)
    _edge(axes, scene, 0, (low[1], low[2]), t("Easting, m"))
    _edge(axes, scene, 1, (low[0], low[2]), t("Northing, m"))
    _edge(axes, scene, 2, (low[0], high[1]), t("Elevation, m"))


def _edge(axes: Axes, scene: Scene, k: int, at: tuple[float, float], title: str) -> None:
    """Draw the edge of the box along axis ``k`` with about four round coordinates; the others are ``at``."""
    from matplotlib.ticker import MaxNLocator

    low, high = float(scene.low[k]), float(scene.high[k])
    ticks = [v for v in MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= v <= high]
    flat = scene.pixels(_along(k, [low, high], at))
    way = flat[1] - flat[0]
    outward = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
    middle = np.array(scene.image.shape[1::-1]) / 2
    if (flat.mean(axis=0) - middle) @ outward < 0:
        outward = -outward
    axes.plot(*flat.T, color=MUTED, lw=0.7, zorder=3, clip_on=False)
    # Rows of a picture run down, offsets in points up.
    step = np.array([outward[0], -outward[1]])
    side = "right" if step[0] < -0.5 else "left" if step[0] > 0.5 else "center"
    for value, place in zip(ticks, scene.pixels(_along(k, ticks, at)), strict=True):
        text = tick(value)
        line = {"arrowstyle": "-", "color": MUTED, "lw": 0.6, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", place, xytext=tuple(step * TICK), textcoords="offset points", annotation_clip=False,
                      arrowprops=line)  # fmt: skip
        axes.annotate(text, place, xytext=tuple(step * (LABEL - 4)), textcoords="offset points", size=SIZE,
                      color=MUTED, ha=side, va="center" if abs(step[1]) < 0.5 else "top",
                      annotation_clip=False)  # fmt: skip
    angle = float(np.degrees(np.arctan2(-way[1], way[0])))
    angle = (angle + 90) % 180 - 90
    reach = LABEL + (14, 32, 26)[k]
    axes.annotate(title, flat.mean(axis=0), xytext=tuple(step * reach), textcoords="offset points", size=SIZE + 0.6,
                  color=TEXT, ha="center", va="center", rotation=angle, annotation_clip=False)  # fmt: skip


def _along(k: int, values: list[float], at: tuple[float, float]) -> Floats:
    xyz = np.empty((len(values), 3))
    others = [i for i in range(3) if i != k]
    xyz[:, k] = values
    xyz[:, others] = at
    return xyz

"""The map of the standard deviation, with the places where a hole would lower it most."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import EN, Language
from geofit.data.prediction import Uncertainty
from geofit.geometry.frame import FrameKind
from geofit.report.plots import legend, map_axes
from geofit.report.result import HorizonResult
from geofit.report.style import FAIL, MUTED, TEXT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Text

__all__ = ["uncertainty_map"]

#: Size of the cross at a suggested hole, points.
_CROSS = 6.0

Floats = NDArray[np.float64]


def uncertainty_map(axes: Axes, result: HorizonResult, t: Language = EN) -> None:
    """Draw the standard deviation of a horizon in shades and lines, its points, and the suggested holes.

    Raises
    ------
    ValueError
        If the standard deviation was not examined.
    """
    found = result.prediction
    if found is None or found.uncertainty is None:
        raise ValueError(f"The standard deviation of horizon '{result.name}' was not examined.")
    labels = _shades(axes, found.uncertainty, t)
    frame = found.uncertainty.frame
    points = _flat(result, result.surface.points.xyz, frame)
    axes.plot(*points.T, ".", ms=2.2, color=TEXT, alpha=0.6, label=t("data points"), zorder=3)
    places = _flat(result, np.array([(s.x, s.y, s.z) for s in found.suggestions]).reshape(-1, 3), frame)
    _places(axes, places, labels, t)
    axes.set_title(t("Standard deviation of the surface"))
    along, up = {
        "map": (t("Easting, m"), t("Northing, m")),
        "best-plane": (t("Along the strike, m"), t("Up the dip, m")),
        "sections": (t("Across the sections, m"), t("Along the sections, m")),
    }[frame]
    map_axes(axes, along, up)
    legend(axes)


def _flat(result: HorizonResult, xyz: Floats, frame: FrameKind) -> Floats:
    """Return plan coordinates, those in the best plane of a steep surface, or a folded one's parameters, (n, 2)."""
    model = result.surface.model
    if frame == "map" or model is None:
        return np.asarray(xyz[:, :2])
    if frame == "best-plane":
        return model.problem.parametrization.frame.to_local(xyz)[:, :2]
    foot = result.surface.project(xyz)
    return np.column_stack([foot.u, foot.v])


def _shades(axes: Axes, field: Uncertainty, t: Language) -> list[Text]:
    """Draw the shades and the lines; return the labels of the lines."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.ticker import MaxNLocator

    # White to dark in one hue: a black-and-white print keeps the order.
    colours = LinearSegmentedColormap.from_list("doubt", ["#f7f8f6", "#d9d3c0", "#b99a6b", "#7d5a35"])
    sd = np.ma.masked_invalid(field.sd)
    top = float(sd.max()) if sd.count() else 1.0
    levels = MaxNLocator(6).tick_values(0.0, max(top, 1e-9))
    shades = axes.contourf(field.x, field.y, sd, levels=list(levels), cmap=colours, zorder=0)
    lines = axes.contour(field.x, field.y, sd, levels=list(levels), colors="#8a7a5c", linewidths=0.5, zorder=1)
    labels = axes.clabel(lines, fmt="%g", fontsize=6, colors=MUTED)
    scale = axes.inset_axes((1.03, 0.0, 0.035, 0.55))
    bar = axes.figure.colorbar(shades, cax=scale)
    bar.outline.set_visible(False)
    scale.tick_params(length=0, pad=2)
    scale.set_title(t("m"), fontsize=7.5, fontweight="normal", color=MUTED, pad=4)
    return list(labels)


def _places(axes: Axes, places: Floats, labels: list[Text], t: Language) -> None:
    from matplotlib.patheffects import withStroke

    from geofit.report.evading import EvadingWord

    if not len(places):
        return
    axes.plot(*places.T, "x", ms=_CROSS, mew=1.6, color=FAIL, label=t("suggested hole"), zorder=4)
    texts = list(labels)
    for i, (x, y) in enumerate(places.tolist(), 1):
        number = EvadingWord(
            axes, str(i), (x, y), texts, places, _CROSS, size=7.5, weight="bold", color=FAIL,
            path_effects=[withStroke(linewidth=2, foreground="white")], zorder=5,
        )  # fmt: skip
        texts.append(number)

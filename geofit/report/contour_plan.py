"""Contour plans to scale: elevation of one horizon, with north arrow, scale bar, holes and study area."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import EN, Language
from geofit.data.lengths import LENGTH_UNITS, LengthUnit, unit_mark
from geofit.report.accuracy_report import PlanSheet
from geofit.report.digits import tick
from geofit.report.furniture import north_arrow, scale_bar, scale_for, scale_text
from geofit.report.length_axis import number_axis, upright
from geofit.report.result import HorizonResult
from geofit.report.style import CORE, LINE, MUTED, PAPER, TEXT, drawing, kind_style
from geofit.report.view import rims
from geofit.sampling.contours import contours, interval_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.transforms import Bbox

__all__ = ["draw_contour_plan", "draw_map", "map_corners", "map_handles", "plan_caption", "plan_sheet"]

Floats = NDArray[np.float64]

#: Width of the sheet and of its drawing, margins, and most and least height of the drawing, mm.
SHEET, DRAWING, LEFT, BELOW, ABOVE, TALLEST, LOWEST = 174.0, 140.0, 19.0, 24.5, 3.0, 165.0, 48.0
#: Every so many contours one is heavy and labelled.
HEAVY = 5
#: Triangles under the contours, metres; vertices of the contours are exact.
COARSE = 0.5
MM = 1 / 25.4


def plan_sheet(result: HorizonResult, unit: LengthUnit = "m") -> PlanSheet | None:
    """Choose scale and interval (metres, round in ``unit``) of a contour plan.

    None for a folded surface, of which contours would cross.
    """
    if result.surface.frame == "sections":
        return None
    low, high = map_corners(result)
    wide, tall = high - low
    z = np.concatenate([rim[:, 2] for rim in rims(result.surface).values()] or [result.surface.points.xyz[:, 2]])
    scale = max(scale_for(float(wide), DRAWING), scale_for(float(tall), TALLEST))
    per = LENGTH_UNITS[unit]
    return PlanSheet(scale, interval_for(float(z.min()) / per, float(z.max()) / per) * per)


def draw_contour_plan(sheet: PlanSheet, result: HorizonResult, t: Language = EN) -> Figure:
    """Draw the contour plan of a horizon, 174 mm wide, at the scale of its sheet."""
    from matplotlib.figure import Figure

    low, high = map_corners(result)
    # A narrow strip still has room for the arrow and the labels of its axis.
    short = np.array([0.0, max(LOWEST * sheet.scale / 1000 - (high - low)[1], 0.0) / 2])
    low, high = low - short, high + short
    wide, tall = ((high - low) * 1000 / sheet.scale).tolist()
    height = ABOVE + tall + BELOW
    with drawing(7.5):
        figure = Figure(figsize=(SHEET * MM, height * MM), dpi=200)
        axes = figure.add_axes((LEFT / SHEET, BELOW / height, wide / SHEET, tall / height))
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        draw_map(axes, result, sheet.interval, wide, t)
        north_arrow(axes, wide + 8.0, tall - 17.0, t("N"))
        scale_bar(axes, sheet.scale, max(wide - 44.0, 0.0), -13.5)
        height = figure.get_size_inches()[1] / MM
        figure.legend(
            handles=map_handles(result, t), loc="lower left", bbox_to_anchor=(LEFT / SHEET, 1.0 / height), ncols=5,
            fontsize=6.5, handlelength=1.8, columnspacing=1.4, borderaxespad=0, handletextpad=0.5,
        )  # fmt: skip
    return figure


def draw_map(
    axes: Axes,
    result: HorizonResult,
    interval: float,
    wide: float,
    t: Language = EN,
    unit: LengthUnit = "m",
    grid: LengthUnit | None = None,
) -> None:
    """Draw contours, study area, core, section lines, holes with names and points; the axes are ``wide`` mm wide.

    ``interval`` is in metres, as everything but the numbers that are written: heights in ``unit``, eastings and
    northings in that of the ``grid``.
    """
    _contours(axes, result, interval, unit)
    _base_map(axes, result, wide)
    _points(axes, result)
    _frame(axes, t, grid or unit)


def plan_caption(name: str, sheet: PlanSheet, t: Language) -> str:
    """Return scale and contour interval."""
    return t(
        "Contour plan of {name}, scale {scale} on A4 at 100 %; elevations in metres, interval {interval:g} m.",
        name=name,
        interval=sheet.interval,
        scale=scale_text(sheet.scale),
    )


def map_corners(result: HorizonResult) -> tuple[Floats, Floats]:
    """Return the corners of the sheet's frame, metres."""
    parts = [result.surface.points.xyz[:, :2]]
    if result.surface.outline is not None:
        parts.append(result.surface.outline)
    else:
        parts += [rim[:, :2] for rim in rims(result.surface).values()]
    xy = np.concatenate(parts)
    low, high = xy.min(axis=0), xy.max(axis=0)
    room = 0.04 * float((high - low).max())
    return low - room, high + room


def _contours(axes: Axes, result: HorizonResult, step: float, unit: LengthUnit) -> None:
    surface = result.surface
    labelled: list[Floats] = []
    reach = float(np.ptp(axes.get_xlim()))
    for one in contours(surface.surface, step, mesh=surface.triangulate(COARSE)):
        heavy = round(one.elevation / step) % HEAVY == 0
        axes.plot(*one.line.T, color="#7a5a2f" if heavy else "#b89b72", lw=1.0 if heavy else 0.55, zorder=2)
        if heavy:
            _label(axes, one.line, tick(one.elevation / LENGTH_UNITS[unit]), labelled, reach)


def _label(axes: Axes, line: Floats, text: str, labelled: list[Floats], reach: float) -> None:
    """Write an elevation along its contour, where no other label is near."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    if length[-1] < 0.07 * reach:
        return
    for share in (0.5, 0.3, 0.7):
        place = np.array([np.interp(share * length[-1], length, line[:, k]) for k in (0, 1)])
        if all(np.hypot(*(place - other)) > 0.09 * reach for other in labelled):
            break
    else:
        return
    labelled.append(place)
    k = int(np.clip(np.searchsorted(length, share * length[-1]), 1, len(line) - 1))
    a, b = max(k - 2, 0), min(k + 1, len(line) - 1)
    angle = float(np.degrees(np.arctan2(line[b, 1] - line[a, 1], line[b, 0] - line[a, 0])))
    angle = (angle + 90) % 180 - 90
    axes.text(
        place[0], place[1], text, size=6.2, color="#5b4220", rotation=angle, ha="center", va="center", zorder=4,
        bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 0.6},
    )  # fmt: skip


def _base_map(axes: Axes, result: HorizonResult, wide: float) -> None:
    """Draw the study area, the core, section lines with their names, and holes with theirs where there is room."""
    surface, site = result.surface, result.site
    if site.boundary is not None:
        ring = np.concatenate([site.boundary, site.boundary[:1]])
        axes.plot(*ring.T, color=MUTED, lw=0.9, ls=(0, (6, 3)), zorder=1)
    if surface.partition is not None and surface.partition.corners is not None:
        ring = np.asarray([*surface.partition.corners, surface.partition.corners[0]])
        axes.plot(*ring.T, color=CORE, lw=1.1, zorder=3)
    for section in site.sections:
        axes.plot(*section.line.T, color="#9aa7b4", lw=0.5, ls=(0, (8, 2, 1, 2)), zorder=1)
        start = section.line[0]
        axes.text(start[0], start[1], section.name, size=5.6, color=MUTED, ha="center", va="center", zorder=5,
                  clip_on=True, bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 0.4})  # fmt: skip
    taken = [text.get_window_extent() for text in axes.texts]
    named: list[Floats] = []
    room = np.array([0.062, 0.03]) * float(np.ptp(axes.get_xlim())) * 146.0 / max(wide, 1.0)
    for hole in site.holes:
        axes.plot(*hole.xyz[:1, :2].T, "o", ms=2.6, mfc="none", mec=MUTED, mew=0.6, zorder=3)
        collar = hole.xyz[0, :2]
        if all((np.abs(collar - other) > room).any() for other in named) and _named(axes, hole.name, collar, taken):
            named.append(collar)


def _named(axes: Axes, name: str, collar: Floats, taken: list[Bbox]) -> bool:
    """Write a name at the first side of its hole where it lies in the frame and covers no other text, if there is one.

    Its box is appended to those that are ``taken``, pixels.
    """
    frame = axes.get_window_extent()
    for right, up in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        text = axes.annotate(
            name, (collar[0], collar[1]), xytext=(2.2 * right, 1.6 * up), textcoords="offset points", size=4.8,
            ha="left" if right > 0 else "right", va="baseline" if up > 0 else "top", color=MUTED, zorder=4,
            annotation_clip=True,
        )  # fmt: skip
        box = text.get_window_extent()
        inside = frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
        if inside and not box.count_overlaps(taken):
            taken.append(box)
            return True
        text.remove()
    return False


def _points(axes: Axes, result: HorizonResult) -> None:
    points = result.surface.points
    for kind in sorted(set(points.kind.tolist())):
        of = points.kind == kind
        marker, colour = kind_style(kind)
        x, y = points.xyz[of, :2].T
        axes.scatter(x, y, s=3 if marker == "." else 6, marker=marker, color=colour, lw=0, zorder=3, rasterized=True)


def _frame(axes: Axes, t: Language, unit: LengthUnit) -> None:
    """Draw the frame with a grid of round coordinates."""
    wide, tall = axes.get_window_extent().size
    for axis, extent in ((axes.xaxis, wide), (axes.yaxis, tall)):
        number_axis(axis, unit, max(int(extent / 200 * 25.4 / 22), 1))
    axes.grid(color=LINE, lw=0.35, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2.5, width=0.6, labelsize=6.2)
    upright(axes)
    for spine in axes.spines.values():
        spine.set(color=TEXT, linewidth=0.8)
    axes.set_xlabel(t("Easting, {unit}", unit=unit_mark(unit)), fontsize=7, labelpad=2)
    axes.set_ylabel(t("Northing, {unit}", unit=unit_mark(unit)), fontsize=7, labelpad=2)


def map_handles(result: HorizonResult, t: Language) -> list[Line2D]:
    """Return the entries of the legend."""
    from matplotlib.lines import Line2D

    from geofit.data.languages import translate

    handles = [Line2D([], [], color="#7a5a2f", lw=1.0, label=t("contour, every fifth heavy"))]
    if result.surface.partition is not None and result.surface.partition.corners is not None:
        handles.append(Line2D([], [], color=CORE, lw=1.1, label=t("edge of the core")))
    if result.site.boundary is not None:
        handles.append(Line2D([], [], color=MUTED, lw=0.9, ls=(0, (6, 3)), label=t("study area")))
    if result.site.sections:
        handles.append(Line2D([], [], color="#9aa7b4", lw=0.6, ls=(0, (8, 2, 1, 2)), label=t("section line")))
    for kind in sorted(set(result.surface.points.kind.tolist())):
        marker, colour = kind_style(kind)
        handles.append(Line2D([], [], color=colour, lw=0, marker=marker, ms=3, label=translate(kind, t)))
    return handles

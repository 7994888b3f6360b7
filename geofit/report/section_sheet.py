"""Geological sections to scale: ground, horizons with their 90 % bands, holes, scale and exaggeration stated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import EN, Language, together, translate
from geofit.data.points import PointSet
from geofit.data.site import Ground, Section, Site
from geofit.report.accuracy_report import SectionSheet
from geofit.report.digits import tick
from geofit.report.furniture import exaggeration_for, scale_bar, scale_for, scale_text
from geofit.report.profile import THICKNESS, Profile, along_polyline
from geofit.report.style import (
    LINE,
    MUTED,
    PAPER,
    TEXT,
    drawing,
    horizon_colours,
    kind_style,
    legend_columns,
    shortened,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_section", "section_caption", "section_sheet"]

Floats = NDArray[np.float64]

#: Width of the sheet, of its drawing, margin on the left, and most height of the drawing, mm.
SHEET, DRAWING, LEFT, TALLEST = 174.0, 150.0, 15.0, 150.0
#: Room above the drawing and below it, mm: for names of ends and short names of holes; for axis, bar and legend.
ABOVE, BELOW = 13.0, 27.0
#: Size of the names of holes, and gaps below and above them, points; height of the names of the ends above the drawing.
NAME, GAP, ENDS = 5.6, 4.0, 20.0
#: Millimetres in a point.
POINT = 25.4 / 72
GROUND = "#6b5a3e"
#: Bands wider than the relief of all horizons are cut at so many times it.
WIDEST_BAND = 0.6
MM = 1 / 25.4


def section_sheet(section: Section, site: Site, cut: Mapping[str, Sequence[Profile]], picture: str) -> SectionSheet:
    """Choose scale and exaggeration of a sheet.

    Parameters
    ----------
    section : Section
        The line.
    site : Site
        Its ground belongs to the sheet.
    cut : mapping of str to sequence of Profile
        What the section cuts of each horizon.
    picture : str
        Name under which the report finds the drawing.
    """
    lines = [line for of in cut.values() for line in of]
    length = float(np.linalg.norm(np.diff(section.line, axis=0), axis=1).sum())
    ground = np.empty(0) if site.ground is None else _ground_line(section, site.ground, length)[1]
    ground = ground[np.isfinite(ground)]
    # A section that cuts no horizon shows the ground alone.
    z = np.concatenate([line.line[:, 1] for line in lines] or [ground if len(ground) else np.zeros(1)])
    low, high = float(z.min()), float(z.max())
    reach = WIDEST_BAND * max(high - low, 0.02 * length)
    bands = [line.band for line in lines if line.band is not None]
    for band in bands:
        low = min(low, max(float(band.lower[:, 1].min()), float(z.min()) - reach))
        high = max(high, min(float(band.upper[:, 1].max()), float(z.max()) + reach))
    if len(ground):
        low, high = min(low, float(ground.min())), max(high, float(ground.max()))
    room = max(0.04 * (high - low), 0.003 * length)
    low, high = low - room, high + room
    scale = scale_for(length, DRAWING)
    start, end = ((float(x), float(y)) for x, y in (section.line[0], section.line[-1]))
    raised = exaggeration_for(high - low, scale, TALLEST)
    return SectionSheet(
        section.name, start, end, length, low, high, scale, raised, bool(bands), bool(len(ground)), picture
    )  # fmt: skip


def draw_section(
    sheet: SectionSheet, section: Section, site: Site, cut: Mapping[str, Sequence[Profile]],
    points: Mapping[str, PointSet], t: Language = EN,
) -> Figure:  # fmt: skip
    """Draw a section sheet, 174 mm wide.

    Parameters
    ----------
    sheet : SectionSheet
        Its scale and exaggeration.
    section : Section
        The line.
    site : Site
        Ground and holes.
    cut : mapping of str to sequence of Profile
        What the section cuts of each horizon.
    points : mapping of str to PointSet
        Points of each horizon; those near the section are drawn.
    t : Language
        That of the words.
    """
    from matplotlib.figure import Figure

    length, low, high = sheet.length, sheet.low, sheet.high
    wide, tall = length * 1000 / sheet.scale, (high - low) * 1000 / sheet.scale * sheet.exaggeration
    near = max(THICKNESS * length, 1.0)
    with drawing(7.5):
        ends = max(ENDS, GAP + _longest_name(section, site, near) + GAP)
        height = ABOVE + (ends - ENDS) * POINT + tall + BELOW
        figure = Figure(figsize=(SHEET * MM, height * MM), dpi=200)
        axes = figure.add_axes((LEFT / SHEET, BELOW / height, wide / SHEET, tall / height))
        axes.set_xlim(0, length)
        axes.set_ylim(low, high)
        colours = horizon_colours([*site.horizons, *cut], site.blocks)
        ground = _ground(axes, section, site.ground, length)
        for name, lines in cut.items():
            for line in lines:
                _profile(axes, line, colours[name], ground)
        kinds = _holes(axes, section, site, near, (low, high))
        for name, found in points.items():
            _contacts(axes, section, found, near, colours[name])
        _frame(axes, section, length, ends, t)
        scale_bar(axes, sheet.scale, wide - 44.0, -13.5)
        _legend(figure, cut, colours, kinds, near, t, ground=ground is not None)
    return figure


def section_caption(sheet: SectionSheet, t: Language) -> str:
    """Return scale, exaggeration and what the signs mean."""
    times, scale = sheet.exaggeration, scale_text(sheet.scale)
    if times == 1:
        text = t(
            "Section {name}, scale {scale} on A4 at 100 %; heights are not exaggerated.", name=sheet.name, scale=scale
        )
    else:
        text = t(
            "Section {name}, scale {scale} on A4 at 100 %; vertical exaggeration {times} ×, heights {vertical}.",
            name=sheet.name,
            scale=scale,
            times=times,
            vertical=scale_text(round(sheet.scale / times)),
        )
    band = t("Tinted: 90 % band of the contact that a new hole would find.") if sheet.banded else ""
    return together([text, band, t("Dashed: above the ground.") if sheet.grounded else ""], t)


def _ground_line(section: Section, ground: Ground, length: float) -> tuple[Floats, Floats]:
    corners = section.line
    bends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    s = np.unique(np.concatenate([np.linspace(0, length, 400), bends]))
    z = ground.elevation(np.interp(s, bends, corners[:, 0]), np.interp(s, bends, corners[:, 1]))
    return s, z


def _ground(axes: Axes, section: Section, ground: Ground | None, length: float) -> tuple[Floats, Floats] | None:
    if ground is None:
        return None
    s, z = _ground_line(section, ground, length)
    axes.plot(s, z, color=GROUND, lw=1.3, zorder=5)
    axes.fill_between(s, z, axes.get_ylim()[0], color="#f4f1ea", lw=0, zorder=0)
    return s, z


def _profile(axes: Axes, profile: Profile, colour: str, ground: tuple[Floats, Floats] | None) -> None:
    """Draw the band, and the line: whole below the ground, dashed above it."""
    if profile.band is not None:
        axes.fill(*profile.band.outline.T, facecolor=colour, alpha=0.2, edgecolor="none", zorder=2)
    s, z = profile.line.T
    above = np.zeros(len(s), bool) if ground is None else z > np.interp(s, *ground) + 1e-6
    for part, style in ((above, (0, (4, 2.5))), (~above, "solid")):
        # A part goes on to the next vertex, so that there is no gap where it changes.
        shown = part | np.append(part[1:], False) & ~part
        axes.plot(np.where(shown, s, np.nan), np.where(shown, z, np.nan), color=colour, lw=1.5, ls=style, zorder=4)


def _holes(axes: Axes, section: Section, site: Site, near: float, limits: tuple[float, float]) -> set[str]:
    """Draw the holes near the section, projected onto it, with their names above; return their kinds."""
    named: list[float] = []
    kinds: set[str] = set()
    low, high = limits
    length = axes.get_xlim()[1]
    for hole in sorted(site.holes, key=lambda one: float(along_polyline(section.line, one.xyz[:1, :2])[0][0])):
        s, off = along_polyline(section.line, hole.xyz[:, :2])
        if off[0] > near:
            continue
        z = hole.xyz[:, 2]
        within = (z >= low) & (z <= high)
        if not within.any():
            continue
        kinds.add(hole.kind)
        axes.plot(s, z, color=kind_style(hole.kind)[1], lw=0.9, zorder=3)
        if z[0] <= high:
            axes.plot(s[:1], z[:1], marker="v", ms=3.2, color=kind_style(hole.kind)[1], lw=0, zorder=6, clip_on=False)
        if all(abs(s[0] - other) > 0.028 * length for other in named):
            named.append(float(s[0]))
            axes.annotate(
                hole.name, (s[0], min(max(z[0], low), high)), xytext=(0, GAP), textcoords="offset points", rotation=90,
                size=NAME, color=TEXT, ha="center", va="bottom", zorder=7, annotation_clip=False,
            )  # fmt: skip
    return kinds


def _longest_name(section: Section, site: Site, near: float) -> float:
    """Return the length of the longest name of a hole near the section, in points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    names = {hole.name for hole in site.holes if along_polyline(section.line, hole.xyz[:1, :2])[1][0] <= near}
    font = FontProperties()
    return max((float(TextPath((0, 0), name, size=NAME, prop=font).get_extents().x1) for name in names), default=0.0)


def _contacts(axes: Axes, section: Section, points: PointSet, near: float, colour: str) -> None:
    s, off = along_polyline(section.line, points.xyz[:, :2])
    of = off <= near
    axes.plot(s[of], points.xyz[of, 2], "o", ms=2.6, mfc=PAPER, mec=colour, mew=0.8, zorder=6)


def _frame(axes: Axes, section: Section, length: float, above: float, t: Language) -> None:
    """Draw the axes, and name both ends, ``above`` points above, with the direction in which the section runs."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    axes.xaxis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))
    axes.grid(axis="y", color=LINE, lw=0.5, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2.5, width=0.6, labelsize=6.5)
    axes.spines["top"].set_visible(False)
    for side in ("left", "right", "bottom"):
        axes.spines[side].set(color=MUTED, linewidth=0.7)
    axes.set_xlabel(t("Distance along the section, m"), fontsize=7, labelpad=2)
    axes.set_ylabel(t("Elevation, m"), fontsize=7, labelpad=2)
    way = section.line[-1] - section.line[0]
    azimuth = float(np.degrees(np.arctan2(way[0], way[1]))) % 360
    ends = ((0.0, section.name, (azimuth + 180) % 360, "left"), (length, section.name + "′", azimuth, "right"))
    top = axes.get_ylim()[1]
    for x, name, bearing, ha in ends:
        axes.annotate(
            f"{name}  {bearing:03.0f}°", (x, top), xytext=(0, above), textcoords="offset points", size=8, weight="bold",
            color=TEXT, ha=ha, va="bottom", annotation_clip=False,
        )  # fmt: skip


def _legend(
    figure: Figure, cut: Mapping[str, Sequence[Profile]], colours: Mapping[str, str], kinds: set[str],
    near: float, t: Language, *, ground: bool,
) -> None:  # fmt: skip
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=colours[name], lw=1.8, label=shortened(name)) for name, lines in cut.items() if lines
    ]
    if ground:
        handles.append(Line2D([], [], color=GROUND, lw=1.3, label=t("ground surface")))
    handles.append(Line2D([], [], color=MUTED, lw=0, marker="o", ms=3, mfc=PAPER, mec=MUTED,
                          label=t("contacts and holes within {distance:.0f} m", distance=float(near))))  # fmt: skip
    for hole_kind in sorted(kinds):
        handles.append(Line2D([], [], color=kind_style(hole_kind)[1], lw=0.9, label=translate(hole_kind, t)))
    height = figure.get_size_inches()[1] / MM
    ncols = legend_columns([str(one.get_label()) for one in handles], SHEET - LEFT, 6.5, 5)
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(LEFT / SHEET, 1.0 / height), ncols=ncols, fontsize=6.5,
        handlelength=1.8, columnspacing=1.4, borderaxespad=0, handletextpad=0.5,
    )  # fmt: skip

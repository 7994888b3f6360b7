"""A section sheet: sections to scale on pages of a standard size, with a frame, a legend and a title block."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geofit.data.errors import SettingsError
from geofit.data.languages import EN, Language
from geofit.data.lengths import LengthUnit, unit_mark
from geofit.data.messages import message
from geofit.report.length_axis import number_axis
from geofit.report.paper import (
    BLOCK,
    EDGE,
    PAPERS,
    SheetTitle,
    drawing_scale,
    framed_page,
    save_pdf,
    save_svg,
    scales_of,
)
from geofit.report.style import LINE, MUTED, TEXT, horizon_colours, kind_style
from geofit.site.section_view import HoleTrack, SectionView, lithologies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["fitting_scale", "lithology_style", "write_sheet_pdf", "write_sheet_svg"]

#: Millimetres: room for the numbers at the left and below, legend.
LEFT, BELOW, LEGEND = 20.0, 14.0, 44.0
#: Width of a hole's column of lithology, millimetres.
COLUMN = 2.2
GROUND = "#6b7d3a"
DASHES, BAND = (0, (5.0, 3.0)), (0, (2.5, 2.0))
#: How strongly the inside of a body is filled.
TINT = 0.22
_SOILS = ("#e8d9a0", "#c9b18a", "#b7c9a8", "#9fb6c4", "#d3a6a0", "#a9a1c6", "#dcc3d8", "#8fb3a2", "#d9cbb6", "#b2b2b2")
_HATCHES = ("", "....", "////", "\\\\\\\\", "xxxx", "----", "++++", "oo", "||||", "**")


def lithology_style(codes: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return the colour and the pattern of each code: the same for the same list of codes.

    Examples
    --------
    >>> lithology_style(["clay", "sand"])["sand"]
    ('#c9b18a', '....')
    """
    return {
        code: (_SOILS[k % len(_SOILS)], _HATCHES[(k + k // len(_SOILS)) % len(_HATCHES)])
        for k, code in enumerate(sorted(codes))
    }


def fitting_scale(views: Sequence[SectionView], paper: str, exaggeration: float = 1.0, unit: LengthUnit = "m") -> int:
    """Return the largest of the usual scales of a unit at which every section fits the paper.

    Raises
    ------
    SettingsError
        If none does.
    """
    wide, high = _room(paper)
    for scale in scales_of(unit):
        sizes = [_size(view, scale, exaggeration) for view in views]
        if all(across <= wide and up <= high for across, up in sizes):
            return scale
    raise SettingsError(
        message(
            "report.section-without-scale",
            "No scale up to 1:{scale} fits the sections on {paper}. Choose larger paper or shorter sections.",
            scale=scales_of(unit)[-1],
            paper=paper,
        )
    )


def write_sheet_pdf(
    views: Sequence[SectionView],
    block: SheetTitle,
    path: str | PathLike[str],
    *,
    paper: str = "A3",
    scale: int | None = None,
    exaggeration: float = 1.0,
    language: Language = EN,
) -> int:
    """Write sections to scale as PDF, one page each; return the scale, 1 : so many.

    Parameters
    ----------
    views : sequence of SectionView
        At least one.
    block : SheetTitle
        What the title block says.
    path : path
        The file.
    paper : str
        One of :data:`geofit.report.paper.PAPERS`.
    scale : int, optional
        1 : so many; None: the largest at which all fit.
    exaggeration : float
        Elevations are drawn so many times higher; the title block reports it.
    language : Language
        That of the words.

    Raises
    ------
    SettingsError
        If a section does not fit the paper at the scale.
    """
    chosen = _checked(views, paper, scale, exaggeration, block.unit)
    save_pdf(_pages(views, block, paper, chosen, exaggeration, language), block.title, path)
    return chosen


def write_sheet_svg(
    views: Sequence[SectionView],
    block: SheetTitle,
    path: str | PathLike[str],
    *,
    paper: str = "A3",
    scale: int | None = None,
    exaggeration: float = 1.0,
    language: Language = EN,
) -> tuple[Path, ...]:
    """Write sections to scale as SVG, one file each; several get the names of their sections. Return the files.

    Parameters and errors are those of :func:`write_sheet_pdf`.
    """
    chosen = _checked(views, paper, scale, exaggeration, block.unit)
    pages = _pages(views, block, paper, chosen, exaggeration, language)
    return save_svg(pages, [view.name for view in views], path)


def _pages(
    views: Sequence[SectionView], block: SheetTitle, paper: str, scale: int, exaggeration: float, t: Language
) -> list[Callable[[], Figure]]:
    return [
        partial(sheet_page, views, view, number, block, paper, scale, exaggeration, t)
        for number, view in enumerate(views, 1)
    ]


def _checked(views: Sequence[SectionView], paper: str, scale: int | None, exaggeration: float, unit: LengthUnit) -> int:
    if paper not in PAPERS or not exaggeration > 0 or not views:
        raise SettingsError(
            message(
                "report.sheet-settings-unusable",
                "A sheet needs a section, paper of {papers}, and an exaggeration above 0; given: {paper}, {factor:g}.",
                papers=", ".join(PAPERS),
                paper=paper,
                factor=exaggeration,
            )
        )
    least = fitting_scale(views, paper, exaggeration, unit)
    if scale is not None and scale < least:
        raise SettingsError(
            message(
                "report.section-scale-too-large",
                "At 1:{scale} the sections are larger than {paper}. Choose 1:{least}, larger paper, or shorter "
                "sections.",
                scale=scale,
                paper=paper,
                least=least,
            )
        )
    return least if scale is None else scale


def _room(paper: str) -> tuple[float, float]:
    wide, high = PAPERS[paper]
    return wide - 2 * EDGE - LEFT - LEGEND - 4, high - 2 * EDGE - BLOCK - BELOW - 22


def _limits(view: SectionView) -> tuple[float, float]:
    """Return elevations of the drawing: what is shown, and a margin."""
    low, high = view.levels
    room = max(0.04 * (high - low), 0.5)
    return low - room, high + room


def _size(view: SectionView, scale: int, exaggeration: float) -> tuple[float, float]:
    low, high = _limits(view)
    return 1000 * view.length / scale, 1000 * exaggeration * (high - low) / scale


def sheet_page(
    views: Sequence[SectionView],
    view: SectionView,
    number: int,
    block: SheetTitle,
    paper: str,
    scale: int,
    exaggeration: float,
    t: Language,
) -> Figure:
    (x0, y0), (x1, y1) = view.line[[0, -1]]
    line = t(
        "from ({x0:.1f}, {y0:.1f}) to ({x1:.1f}, {y1:.1f}), {length:.0f} {unit}; "
        "holes and points within {half:g} {unit}",
        x0=block.on_grid(x0), y0=block.on_grid(y0), x1=block.on_grid(x1), y1=block.on_grid(y1),
        length=block.shown(view.length), half=round(block.shown(view.thickness / 2), 2), unit=unit_mark(block.unit),
    )  # fmt: skip
    true = t("true to scale") if exaggeration == 1 else t("elevations {factor:g} times higher", factor=exaggeration)
    wide, high = PAPERS[paper]
    figure = framed_page(
        paper, block, view.name, line, f"{drawing_scale(scale, block.unit)} · {true}", (number, len(views)), t,
        view.stale,
    )  # fmt: skip
    room_wide, room_high = _room(paper)
    across, up = _size(view, scale, exaggeration)
    bottom = EDGE + BLOCK + BELOW + max((room_high - up) / 2, 0)
    left = EDGE + LEFT + max((room_wide - across) / 2, 0)
    axes = figure.add_axes((left / wide, bottom / high, across / wide, up / high))
    colours = horizon_colours([*view.points, *view.traces], view.blocks)
    styles = lithology_style(lithologies(list(views)))
    _draw(axes, view, colours, styles, scale, t)
    _number(axes, block.unit, up, t)
    _legend(figure, axes, view, styles, (wide, high), t)
    return figure


def _draw(
    axes: Axes,
    view: SectionView,
    colours: Mapping[str, str],
    styles: Mapping[str, tuple[str, str]],
    scale: int,
    t: Language,
) -> None:
    axes.set_xlim(0, view.length)
    axes.set_ylim(*_limits(view))
    for bend in view.bends[1:-1]:
        axes.axvline(bend, color=LINE, lw=0.8, zorder=0)
    if len(view.ground):
        axes.plot(*view.ground.T, color=GROUND, lw=1.2, label=t("ground"), zorder=3)
    banded = False
    for name, traces in view.traces.items():
        solid = any(one.supported for one in traces)
        named = False
        for one in traces:
            first = not named and one.supported == solid
            named |= first
            axes.plot(
                one.distance, one.z, color=colours[name], lw=1.4 if one.supported else 1.0,
                ls="-" if one.supported else DASHES, label=name if first else None, zorder=5,
            )  # fmt: skip
            if one.band is not None and one.supported:
                axes.fill(
                    *one.band.outline.T, color=colours[name], alpha=0.18, lw=0,
                    label=None if banded else t("90 % band of a new hole"), zorder=1,
                )  # fmt: skip
                banded = True
    _bodies(axes, view, t)
    half = COLUMN * scale / 2000
    for hole in view.holes:
        _column(axes, hole, half, styles)
    for name, places in view.points.items():
        if len(places):
            marker = kind_style("borehole")[0]
            entry = None if view.traces.get(name) else t("points of {name}", name=name)
            axes.plot(
                *places.T, ls="none", marker=marker, ms=2.6, color=colours[name], mec="white", mew=0.3, label=entry,
                zorder=6,
            )  # fmt: skip


def _number(axes: Axes, unit: LengthUnit, tall: float, t: Language) -> None:
    """Write the axes in the unit of the drawing, which is ``tall`` mm high."""
    number_axis(axes.xaxis, unit, 10)
    number_axis(axes.yaxis, unit, min(max(int(tall / 10), 2), 8))
    axes.set_xlabel(t("Distance along the section, {unit}", unit=unit_mark(unit)))
    axes.set_ylabel(t("Elevation, {unit}", unit=unit_mark(unit)))
    axes.yaxis.grid(True, color=LINE, lw=0.5)
    axes.set_axisbelow(True)


def _bodies(axes: Axes, view: SectionView, t: Language) -> None:
    """Draw bodies: their inside tinted, their outline whole, and dashed the lines between which it lies."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    for body in view.bodies:
        whole = Outline.make_compound_path(*(Outline(np.vstack([ring, ring[:1]]), closed=True) for ring in body.rings))
        name = t("body {name}", name=body.name)
        tint = to_rgba(body.colour, TINT)
        axes.add_patch(PathPatch(whole, fc=tint, ec=body.colour, lw=1.4, zorder=1.5, label=name))
        # Again above the columns of the holes.
        axes.add_patch(PathPatch(whole, fill=False, ec=body.colour, lw=1.4, zorder=5.2))
        for line in body.band:
            axes.plot(*line.T, color=body.colour, lw=0.8, ls=BAND, zorder=5.1)


def _column(axes: Axes, hole: HoleTrack, half: float, styles: Mapping[str, tuple[str, str]]) -> None:
    """Draw a hole with a column for each of its interval tables side by side, its name over the collar.

    A name that would cross the upper edge of the drawing is above it.
    """
    from matplotlib.patches import Polygon

    axes.plot(*hole.track.T, color=TEXT, lw=0.6, zorder=4)
    tables = list(dict.fromkeys(interval.table for interval in hole.intervals))
    for interval in hole.intervals:
        colour, hatch = styles[interval.code]
        left, right = (np.array([2 * half * (tables.index(interval.table) + k), 0.0]) for k in (0, 1))
        outline = np.concatenate([interval.track + left, interval.track[::-1] + right])
        axes.add_patch(Polygon(outline, fc=colour, ec=TEXT, lw=0.3, hatch=hatch, zorder=4))
    top = hole.track[hole.track[:, 1].argmax()]
    name = axes.annotate(
        hole.name, top, xytext=(0, 3), textcoords="offset points", ha="center", va="bottom", rotation=90, size=6,
        color=TEXT, zorder=7, annotation_clip=False,
    )  # fmt: skip
    if name.get_window_extent().y1 > axes.bbox.y1:
        name.xy = (top[0], axes.get_ylim()[1])


def _legend(
    figure: Figure,
    axes: Axes,
    view: SectionView,
    styles: Mapping[str, tuple[str, str]],
    paper: tuple[float, float],
    t: Language,
) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    wide, high = paper
    handles, labels = axes.get_legend_handles_labels()
    if any(not one.supported for traces in view.traces.values() for one in traces):
        handles.append(Line2D([], [], color=MUTED, lw=1.0, ls=DASHES))
        labels.append(t("above ground or\nbeyond the data"))
    if any(body.band for body in view.bodies):
        handles.append(Line2D([], [], color=MUTED, lw=0.8, ls=BAND))
        labels.append(t("surface of a body\nlies here with 80 % chance"))
    here = {one.code for hole in view.holes for one in hole.intervals}
    for code, (colour, hatch) in styles.items():
        if code in here:
            handles.append(Patch(fc=colour, ec=TEXT, lw=0.3, hatch=hatch))
            labels.append(code)
    corner = ((wide - EDGE - LEGEND) / wide, (high - EDGE - 14) / high)
    legend = figure.legend(handles, labels, loc="upper left", bbox_to_anchor=corner, fontsize=6.5, borderaxespad=0)
    for text in legend.get_texts():
        text.set_linespacing(1.5)  # Chinese letters are as high as their line

"""Contour plans on paper: a horizon to scale with frame and title block, as PDF and SVG."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.errors import SettingsError
from geofit.data.languages import EN, Language
from geofit.data.lengths import LengthUnit
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown
from geofit.report.contour_plan import draw_map, map_corners, map_handles, plan_sheet
from geofit.report.furniture import north_arrow, scale_bar
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
from geofit.report.result import HorizonResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["interval_of", "plan_scale", "write_plan_pdf", "write_plan_svg"]

#: Millimetres: room for the numbers at the left and below the map, for the legend at the right, and above the map.
LEFT, BELOW, LEGEND, ABOVE = 16.0, 20.0, 54.0, 20.0


def plan_scale(results: Sequence[HorizonResult], paper: str, scale: int | None = None, unit: LengthUnit = "m") -> int:
    """Return the scale of plans, 1 : so many: the one asked for, or the largest at which every plan fits the paper.

    Raises
    ------
    SettingsError
        If a plan does not fit at the scale, or at none; or if a surface is folded over, so that contours would cross.
    """
    folded = [result.name for result in results if plan_sheet(result) is None]
    if folded or not results or paper not in PAPERS:
        raise SettingsError(
            message(
                "report.plan-settings-unusable",
                "A plan needs paper of {papers} and a surface that is not folded over; given: {paper}, {name}.",
                papers=", ".join(PAPERS), paper=paper, name=folded[0] if folded else "-",
            )
        )  # fmt: skip
    wide, high = PAPERS[paper]
    room = (wide - 2 * EDGE - LEFT - LEGEND, high - 2 * EDGE - BLOCK - BELOW - ABOVE)
    sizes = [1000 * (high_corner - low) for low, high_corner in map(map_corners, results)]
    fitting = [s for s in scales_of(unit) if all(x / s <= room[0] and y / s <= room[1] for x, y in sizes)]
    if not fitting:
        raise SettingsError(
            message(
                "report.plan-without-scale",
                "No scale up to 1:{scale} fits the plan on {paper}. Choose larger paper.",
                scale=scales_of(unit)[-1],
                paper=paper,
            )
        )
    if scale is not None and scale < fitting[0]:
        raise SettingsError(
            message(
                "report.plan-scale-too-large",
                "At 1:{scale} the plan is larger than {paper}. Choose 1:{least} or larger paper.",
                scale=scale, paper=paper, least=fitting[0],
            )
        )  # fmt: skip
    return scale or fitting[0]


def interval_of(result: HorizonResult, interval: float | None, unit: LengthUnit = "m") -> float:
    """Return metres between contours: those asked for, or 1, 2 or 5 times a power of ten of a unit by the relief.

    Raises
    ------
    SettingsError
        If the interval is not above 0.
    """
    if interval is None:
        sheet = plan_sheet(result, unit)
        assert sheet is not None
        return sheet.interval
    if not is_finite(interval) or interval <= 0:
        raise SettingsError(
            message("data.contour-interval-not-positive", "The contour interval is {step}; give metres above 0.",
                    step=shown(interval))
        )  # fmt: skip
    return interval


def write_plan_pdf(
    results: Sequence[HorizonResult],
    block: SheetTitle,
    path: str | PathLike[str],
    *,
    interval: float | None = None,
    paper: str = "A3",
    scale: int | None = None,
    language: Language = EN,
) -> int:
    """Write contour plans to scale as PDF, one page each; return the scale, 1 : so many.

    Parameters
    ----------
    results : sequence of HorizonResult
        Surfaces with their site: study area, sections, holes.
    block : SheetTitle
        What the title block says.
    path : path
        The file.
    interval : float, optional
        Metres between contours; None: chosen by the relief of each surface.
    paper : str
        One of :data:`geofit.report.paper.PAPERS`.
    scale : int, optional
        1 : so many; None: the largest at which all fit.
    language : Language
        That of the words.

    Raises
    ------
    SettingsError
        As :func:`plan_scale` and :func:`interval_of`.
    """
    chosen = plan_scale(results, paper, scale, block.unit)
    save_pdf(_pages(results, block, interval, paper, chosen, language), block.title, path)
    return chosen


def write_plan_svg(
    results: Sequence[HorizonResult],
    block: SheetTitle,
    path: str | PathLike[str],
    *,
    interval: float | None = None,
    paper: str = "A3",
    scale: int | None = None,
    language: Language = EN,
) -> tuple[Path, ...]:
    """Write contour plans as SVG, one file each; several get their horizons' names. Return the files.

    Parameters and errors are those of :func:`write_plan_pdf`.
    """
    chosen = plan_scale(results, paper, scale, block.unit)
    pages = _pages(results, block, interval, paper, chosen, language)
    return save_svg(pages, [result.name for result in results], path)


def _pages(
    results: Sequence[HorizonResult], block: SheetTitle, interval: float | None, paper: str, scale: int, t: Language
) -> list[Callable[[], Figure]]:
    steps = [interval_of(result, interval, block.unit) for result in results]
    return [
        partial(_page, result, step, block, paper, scale, (number, len(results)), t)
        for number, (result, step) in enumerate(zip(results, steps, strict=True), 1)
    ]


def _page(
    result: HorizonResult, interval: float, block: SheetTitle, paper: str, scale: int, sheet: tuple[int, int],
    t: Language,
) -> Figure:  # fmt: skip
    wide, high = PAPERS[paper]
    if block.unit == "m":
        line = t("elevations in metres, contours every {interval:g} m, each fifth heavy", interval=interval)
    else:
        every = block.shown(interval)
        line = t("elevations in feet, contours every {interval:g} ft, each fifth heavy", interval=every)
    if result.site.crs:
        line = t("{first}; {second}", first=line, second=result.site.crs)
    stale = [result.name] if result.stale else []
    figure = framed_page(paper, block, result.name, line, drawing_scale(scale, block.unit), sheet, t, stale)
    low, top = map_corners(result)
    across, up = (1000 * (top - low) / scale).tolist()
    left = EDGE + LEFT + (wide - 2 * EDGE - LEFT - LEGEND - across) / 2
    bottom = EDGE + BLOCK + BELOW + (high - 2 * EDGE - BLOCK - BELOW - ABOVE - up) / 2
    axes = figure.add_axes((left / wide, bottom / high, across / wide, up / high))
    axes.set_xlim(low[0], top[0])
    axes.set_ylim(low[1], top[1])
    draw_map(axes, result, interval, across, t, block.unit, block.grid)
    column = wide - EDGE - LEGEND + 4
    north_arrow(axes, column + 4 - left, high - EDGE - 32 - bottom, t("N"))
    scale_bar(axes, scale, column - left, high - EDGE - 44 - bottom, block.unit)
    figure.legend(
        handles=map_handles(result, t), loc="upper left", bbox_to_anchor=(column / wide, (high - EDGE - 52) / high),
        fontsize=6.5, handlelength=1.8, borderaxespad=0, handletextpad=0.5,
    )  # fmt: skip
    return figure

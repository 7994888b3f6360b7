"""The work of a contour plan: contours drawn to scale and written; without Qt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from geofit.data.languages import language as language_of
from geofit.data.languages import translate
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.data.stale import StaleCause, stale_warning
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.section_sheet import SheetForm
from geofit.report.paper import SheetTitle
from geofit.report.plan_pages import interval_of, plan_scale, write_plan_pdf, write_plan_svg
from geofit.report.result import HorizonResult
from geofit.sampling.contours import contours

__all__ = ["PlanOrder", "write_plan_sheet"]


@dataclass(frozen=True)
class PlanOrder:
    """What is wanted of a plan.

    ``horizons`` names them; ``interval`` is metres between contours, None: chosen by the relief; ``path`` the files but
    for their endings, ``forms`` which of "pdf", "svg" and "dxf"; ``paper`` one of :data:`geofit.report.paper.PAPERS`,
    ``scale`` 1 : so many, None: the largest that fits; ``language`` "en" or "zh".
    """

    horizons: tuple[str, ...]
    block: SheetTitle
    path: Path
    interval: float | None = None
    forms: tuple[SheetForm, ...] = ("pdf",)
    paper: str = "A3"
    scale: int | None = None
    language: str = "en"


def write_plan_sheet(
    site: Site,
    surfaces: Mapping[str, HorizonFit],
    order: PlanOrder,
    stale: Mapping[str, tuple[StaleCause, ...]] | None = None,
    *,
    progress: Progress | None = None,
) -> tuple[int, tuple[Path, ...]]:
    """Draw the plans and write them; return the scale, 1 : so many, and the files.

    ``stale`` has what has changed since the surfaces were fitted: their sheets warn of it.

    Raises
    ------
    SettingsError
        If a plan does not fit the paper at the scale, the interval is not above 0, or a surface is folded over.
    Cancelled
        If ``progress`` returned False.
    """
    results = [HorizonResult(surfaces[name], site, stale=(stale or {}).get(name, ())) for name in order.horizons]
    unit = order.block.unit
    scale = plan_scale(results, order.paper, order.scale, unit)
    t, files = language_of(order.language), []
    for k, form in enumerate(order.forms):
        tell(progress, "drawing", k / len(order.forms))
        path = order.path.with_name(f"{order.path.name}.{form}")
        if form == "dxf":
            from geofit.io.export.plan_dxf import write_plan_dxf

            steps = {result.name: interval_of(result, order.interval, unit) for result in results}
            lines = {result.name: contours(result.surface.surface, steps[result.name]) for result in results}
            # A drawing has one unit: where it is the foot, that of the grid.
            drawn = unit if unit == "m" or order.block.grid is None else order.block.grid
            old = [result.name for result in results if result.stale]
            note = translate(stale_warning(old), t) if old else ""
            write_plan_dxf(lines, steps, site, order.block.title, path, unit=drawn, note=note)
            files.append(path)
        elif form == "svg":
            files += write_plan_svg(results, order.block, path, interval=order.interval, paper=order.paper, scale=scale,
                                    language=t)  # fmt: skip
        else:
            write_plan_pdf(results, order.block, path, interval=order.interval, paper=order.paper, scale=scale,
                           language=t)  # fmt: skip
            files.append(path)
    tell(progress, "done", 1.0)
    return scale, tuple(files)

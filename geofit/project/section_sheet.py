"""The work of a section sheet: sections of a site cut, drawn to scale and written; without Qt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import language as language_of
from geofit.data.prediction import Uncertainty
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report.paper import SheetTitle
from geofit.report.section_pages import fitting_scale, write_sheet_pdf, write_sheet_svg
from geofit.site.section_view import TOLERANCE, SectionView, section_view

__all__ = ["SheetForm", "SheetOrder", "write_section_sheet"]

Floats = NDArray[np.float64]
SheetForm = Literal["pdf", "svg", "dxf"]


@dataclass(frozen=True, eq=False)
class SheetOrder:
    """What is wanted of a sheet.

    Parameters
    ----------
    lines : mapping of str to (k, 2) array
        Lines in plan by the names of the sections, map coordinates, metres.
    thickness : float
        Holes and points within half of this to each side are shown, metres.
    block : SheetTitle
        What the title block says.
    path : Path
        The files, but for their endings.
    forms : tuple of {"pdf", "svg", "dxf"}
        Which files.
    paper : str
        One of :data:`geofit.report.paper.PAPERS`.
    scale : int or None
        1 : so many; None: the largest that fits.
    exaggeration : float
        Elevations are drawn so many times higher.
    language : str
        "en" or "zh".
    """

    lines: Mapping[str, Floats]
    thickness: float
    block: SheetTitle
    path: Path
    forms: tuple[SheetForm, ...] = ("pdf",)
    paper: str = "A3"
    scale: int | None = None
    exaggeration: float = 1.0
    language: str = "en"


def write_section_sheet(
    site: Site,
    surfaces: Mapping[str, HorizonFit],
    uncertainty: Mapping[str, Uncertainty],
    order: SheetOrder,
    *,
    progress: Progress | None = None,
) -> tuple[int, tuple[Path, ...]]:
    """Cut the sections and write the sheet; return its scale, 1 : so many, and the files.

    Raises
    ------
    SettingsError
        If a section does not fit the paper at the scale.
    Cancelled
        If ``progress`` returned False.
    """
    meshes = {}
    for k, (name, surface) in enumerate(surfaces.items()):
        tell(progress, "triangles", 0.5 * k / len(surfaces))
        meshes[name] = surface.triangulate(TOLERANCE)
    views: list[SectionView] = []
    for k, (name, line) in enumerate(order.lines.items()):
        tell(progress, "sections", 0.5 + 0.3 * k / len(order.lines))
        found = section_view(site, surfaces, line, order.thickness, name=name, uncertainty=uncertainty, meshes=meshes)
        views.append(found)
    tell(progress, "drawing", 0.8)
    files: list[Path] = []
    scale = order.scale or fitting_scale(views, order.paper, order.exaggeration)
    for form in order.forms:
        path = order.path.with_name(f"{order.path.name}.{form}")
        if form == "dxf":
            from geofit.io.export.section_dxf import write_sheet_dxf

            write_sheet_dxf(views, order.block.title, path, exaggeration=order.exaggeration)
            files.append(path)
        elif form == "svg":
            files += write_sheet_svg(
                views, order.block, path, paper=order.paper, scale=scale, exaggeration=order.exaggeration,
                language=language_of(order.language),
            )  # fmt: skip
        else:
            write_sheet_pdf(
                views, order.block, path, paper=order.paper, scale=scale, exaggeration=order.exaggeration,
                language=language_of(order.language),
            )  # fmt: skip
            files.append(path)
    tell(progress, "done", 1.0)
    return scale, tuple(files)

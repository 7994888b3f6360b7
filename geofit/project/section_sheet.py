"""The work of a section sheet: sections of a site cut, drawn to scale and written; without Qt."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import language as language_of
from geofit.data.prediction import Uncertainty
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.staleness import dated_body
from geofit.report.paper import SheetTitle
from geofit.report.section_pages import fitting_scale, write_sheet_pdf, write_sheet_svg
from geofit.site.section_view import TOLERANCE, BodyTrace, SectionView, section_view

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit
    from geofit.implicit.mesh import TriangleMesh
    from geofit.project.document import Document

__all__ = ["SheetBody", "SheetForm", "SheetOrder", "sheet_bodies", "write_section_sheet"]

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


@dataclass(frozen=True, eq=False)
class SheetBody:
    """A body for a sheet: triangles in map coordinates, its colour, and the body if it was fitted to data.

    ``stale``: it is older than its data.
    """

    mesh: TriangleMesh
    colour: str
    fitted: BodyFit | None = None
    stale: bool = False


def sheet_bodies(document: Document) -> dict[str, SheetBody]:
    """Return the bodies of a document that are shown."""
    from geofit.implicit.mesh import TriangleMesh

    found = {}
    for name, record in document.state.bodies.items():
        result = dated_body(document, name)
        if result is not None and record.style.visible:
            mesh = TriangleMesh(result.mesh.vertices + result.body.origin, result.mesh.triangles)
            found[name] = SheetBody(mesh, record.style.colour, result.fitted, bool(result.stale))
    return found


def write_section_sheet(
    site: Site,
    surfaces: Mapping[str, HorizonFit],
    uncertainty: Mapping[str, Uncertainty],
    order: SheetOrder,
    bodies: Mapping[str, SheetBody] | None = None,
    stale: Collection[str] = (),
    *,
    progress: Progress | None = None,
) -> tuple[int, tuple[Path, ...]]:
    """Cut the sections and write the sheet; return its scale, 1 : so many, and the files.

    ``bodies`` are drawn by name with the band of their surface; each sheet names those that are stale, and those of the
    surfaces that ``stale`` names. Points are drawn of the horizons of ``surfaces``, of all if there are none.

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
        traces = tuple(_body(called, one, found.line) for called, one in (bodies or {}).items())
        shown = tuple(trace for trace in traces if trace.rings)
        old = [name for name, lines in found.traces.items() if lines and name in stale]
        old += [trace.name for trace in shown if bodies and bodies[trace.name].stale]
        points = {name: of if name in surfaces or not surfaces else of[:0] for name, of in found.points.items()}
        views.append(replace(found, points=points, bodies=shown, stale=tuple(old)))
    tell(progress, "drawing", 0.8)
    files: list[Path] = []
    scale = order.scale or fitting_scale(views, order.paper, order.exaggeration, order.block.unit)
    for form in order.forms:
        path = order.path.with_name(f"{order.path.name}.{form}")
        if form == "dxf":
            from geofit.io.export.section_dxf import write_sheet_dxf

            write_sheet_dxf(
                views, order.block.title, path, exaggeration=order.exaggeration, unit=order.block.unit,
                language=language_of(order.language),
            )  # fmt: skip
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


def _body(name: str, body: SheetBody, line: Floats) -> BodyTrace:
    """Cut a body along a section; the band only where the section meets it."""
    from geofit.bodies.section import chance_lines, outline_rings

    rings = outline_rings(body.mesh, line)
    band = chance_lines(body.fitted, line) if rings and body.fitted is not None else ()
    return BodyTrace(name, body.colour, rings, band)

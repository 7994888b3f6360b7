"""Reports of one body or one rock volume, and the findings that a site's report takes in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from geofit.data.errors import SettingsError
from geofit.data.guard import guarded
from geofit.data.languages import EN, Language, language
from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.data.stale import StaleCause
from geofit.data.title_block import TitleBlock

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit
    from geofit.bodies.simulate import BodyVolumes
    from geofit.bodies.strata import StratumVolume
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.data.site import Site
    from geofit.project.body_run import BodyRun
    from geofit.project.pores_run import PoresRun
    from geofit.project.step_files import Signed
    from geofit.report.body_chapter import BodyFindings
    from geofit.report.document import Cell, Chapter, ReportDocument

__all__ = [
    "BodyPart",
    "body_findings",
    "body_part",
    "reaching",
    "write_body_part",
    "write_body_report",
    "write_document",
    "write_pores_report",
]

T = TypeVar("T")

#: Holes that are suggested.
SUGGESTED = 3


def body_findings(
    run: BodyRun, horizons: Mapping[str, Any] | None = None, t: Language = EN, progress: Progress | None = None
) -> tuple[BodyFindings, dict[str, bytes]]:
    """Examine a body for its chapter: strata, holes left out, suggested boreholes, pictures.

    Parameters
    ----------
    run : BodyRun
        The body, its volumes and its STEP file.
    horizons : mapping of str to surface, optional
        Those between which its volume is divided.
    t : Language
        That of the pictures.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    BodyFindings
        What could not be examined is named in ``missing``.
    dict of str to bytes
        Pictures as PNG by their names in the report.
    """
    return _findings(run.body, run.volumes, run.read_back, horizons, t, progress)


def _findings(
    body: BodyFit,
    volumes: BodyVolumes,
    read_back: SolidReadBack | None,
    horizons: Mapping[str, Any] | None,
    t: Language,
    progress: Progress | None = None,
) -> tuple[BodyFindings, dict[str, bytes]]:
    from geofit.bodies.crossval import leave_one_hole_out
    from geofit.bodies.drilling import suggest_body_holes
    from geofit.bodies.strata import strata_table
    from geofit.report.body_chapter import BodyFindings
    from geofit.report.body_pictures import draw_body

    missing: list[Message] = []

    def tried(work: Callable[[], T], instead: T, what: Message) -> T:
        def failed(reason: Message) -> None:
            missing.append(
                message("project.not-examined", "{what} could not be examined: {reason}", what=what, reason=reason)
            )

        return guarded(work, instead, failed)

    tell(progress, "strata", 0.0)
    strata: tuple[StratumVolume, ...] = ()
    if horizons:
        over = reaching(body, horizons)
        if over:
            strata = tried(
                lambda: strata_table(body, over), strata, message("project.task-strata", "the volume in each stratum")
            )
    tell(progress, "holes left out", 0.2)
    left_out = tried(
        lambda: leave_one_hole_out(body), None, message("project.task-left-out", "the error at holes left out")
    )
    tell(progress, "suggested boreholes", 0.7)
    suggested = tried(
        lambda: suggest_body_holes(body, SUGGESTED), None, message("project.task-suggested", "where to drill next")
    )
    tell(progress, "pictures", 0.8)
    images, no_space = draw_body(body, t)
    if no_space:
        missing.append(no_space)
    pictures = tuple(what for what in ("view", "section") if f"body/{what}/{body.name}" in images)
    found = BodyFindings(body, volumes, read_back, strata, left_out, suggested, pictures, tuple(missing))
    return found, images


@dataclass(frozen=True)
class BodyPart:
    """What a body leaves to the report of its site: a chapter, pictures, whether its sigma is below epsilon.

    ``row`` is its verdict for the summary; ``stale``: it is older than its data.
    """

    name: str
    chapter: Chapter
    row: tuple[Cell, ...]
    images: Mapping[str, bytes]
    passed: bool
    stale: bool = False


def body_part(
    body: BodyFit,
    volumes: BodyVolumes,
    read_back: SolidReadBack | None,
    horizons: Mapping[str, Any],
    t: Language,
    progress: Progress | None = None,
    stale: tuple[StaleCause, ...] = (),
) -> BodyPart | Message:
    """Lay out the chapter of a body that was fitted already; or return why that failed."""
    from geofit.report.body_chapter import body_chapter, body_row

    def part() -> BodyPart:
        found, images = _findings(body, volumes, read_back, horizons, t, progress)
        found = replace(found, stale=stale)
        chapter, row = body_chapter(found, t), body_row(found, t)
        return BodyPart(body.name, chapter, row, images, found.accuracy.passed, bool(stale))

    failed: list[Message] = []
    made = guarded(part, None, failed.append)
    return failed[0] if made is None else made


def write_body_part(
    site: Site, code: str, name: str, stem: Path, horizons: Mapping[str, Any], language_code: str,
    signed: Signed | None = None,
) -> BodyPart | Message:  # fmt: skip
    """Fit a body to the intervals of a code, write its files, and lay out its chapter; or return why that failed."""
    failed: list[Message] = []
    made = guarded(lambda: _body_part(site, code, name, stem, horizons, language_code, signed), None, failed.append)
    return failed[0] if made is None else made


def _body_part(
    site: Site, code: str, name: str, stem: Path, horizons: Mapping[str, Any], language_code: str,
    signed: Signed | None,
) -> BodyPart:  # fmt: skip
    from geofit.project.body_run import run_body
    from geofit.report.body_chapter import body_chapter, body_row

    t = language(language_code)
    run = run_body(site, stem.parent, codes=code, name=name, signed=signed, stem=stem.name)
    found, images = body_findings(run, horizons, t)
    return BodyPart(name, body_chapter(found, t), body_row(found, t), images, run.accuracy.passed)


def reaching(body: BodyFit, horizons: Mapping[str, Any]) -> dict[str, Any]:
    """Return the horizons that reach all over a body: only those can divide its volume."""
    import numpy as np

    xyz = body.overview.vertices + body.origin
    return {
        name: surface
        for name, surface in horizons.items()
        if surface.frame == "map" and np.isfinite(surface.elevation(xyz[:, 0], xyz[:, 1])).all()
    }


def write_body_report(
    run: BodyRun, out: Path, t: Language = EN, *, title: TitleBlock | None = None, date: str = "",
    progress: Progress | None = None,
) -> tuple[Path, Path]:  # fmt: skip
    """Write the report of a body as ``NAME_report.html`` and ``NAME_report.pdf``; return both files.

    Raises
    ------
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    """
    from geofit.report.body_chapter import body_chapter, body_picture
    from geofit.report.single import single_document

    found, images = body_findings(run, None, t, progress)
    # The view stands on the cover.
    chapter = body_chapter(replace(found, pictures=tuple(what for what in found.pictures if what != "view")), t)
    view, subject = body_picture("view", run.body.name), t("Report of a geological body")
    picture = view if view in images else ""
    document = single_document(run.body.name, subject, chapter, picture, t, title=title, date=date)
    return write_document(document, images, out, run.body.name)


def write_pores_report(
    run: PoresRun, name: str, out: Path, t: Language = EN, *, title: TitleBlock | None = None, date: str = ""
) -> tuple[Path, Path]:
    """Write the report of a rock volume as ``NAME_report.html`` and ``NAME_report.pdf``; return both files.

    Raises
    ------
    SettingsError
        If the volume was read slab by slab: it has no surface.
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    """
    from geofit.pores.representative import representative_volume
    from geofit.pores.volume import RockVolume
    from geofit.report.pores_chapter import PoresFindings, pores_chapter, pores_picture
    from geofit.report.pores_pictures import draw_pores
    from geofit.report.single import single_document

    if run.balls is None or run.surface is None or run.table is None or not isinstance(run.volume, RockVolume):
        raise SettingsError(
            message(
                "project.pores-report-needs-memory",
                "The report of a rock volume shows its surface, which needs all voxels at once. Leave out --slabs, or "
                "--report.",
            )
        )
    settling = representative_volume(run.volume)
    found = PoresFindings(name, run.volume, len(run.balls), run.network, run.table, settling, run.surface_note)
    images = draw_pores(found, run.surface.triangulate(), t)
    what = tuple(drawn for picture in images if (drawn := picture.split("/")[1]) != "surface")
    chapter = pores_chapter(replace(found, pictures=what), t)
    view = pores_picture("surface", name)
    document = single_document(
        name, t("Report of a rock volume"), chapter, view if view in images else "", t, title=title, date=date
    )
    return write_document(document, images, out, name)


def write_document(document: ReportDocument, images: Mapping[str, bytes], out: Path, name: str) -> tuple[Path, Path]:
    """Write a report as ``NAME_report.html`` and ``NAME_report.pdf``; return both files."""
    from geofit.data.files import file_stems
    from geofit.report.html import write_html
    from geofit.report.pdf import write_pdf

    stem = out / f"{file_stems([name])[name]}_report"
    html, pdf = stem.with_name(f"{stem.name}.html"), stem.with_name(f"{stem.name}.pdf")
    write_html(document, images, html)
    write_pdf(document, images, pdf)
    return html, pdf

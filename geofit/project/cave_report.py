"""The report of a survey of passages."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.languages import EN, Language
from geofit.data.title_block import TitleBlock

if TYPE_CHECKING:
    from geofit.project.cave_run import CaveRun

__all__ = ["write_cave_report"]


def write_cave_report(
    run: CaveRun, out: Path, t: Language = EN, *, title: TitleBlock | None = None, date: str = ""
) -> tuple[Path, Path]:
    """Write the report of a survey as ``NAME_report.html`` and ``NAME_report.pdf``; return both files.

    Parameters
    ----------
    run : CaveRun
        Passages, volume, strata and excavation.
    out : Path
        Folder for the files; created if missing.
    t : Language
        That of the words.
    title : TitleBlock, optional
        What the title block says.
    date : str
        ISO 8601; empty: today.

    Raises
    ------
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    """
    from geofit.data.files import file_stems, folder_for
    from geofit.project.single_reports import write_document
    from geofit.report.cave_chapter import CaveFindings, cave_chapter, cave_picture
    from geofit.report.cave_drawings import cave_sheet, draw_cave
    from geofit.report.single import single_document

    name = Path(run.adjusted.survey.name).stem
    sheet = cave_sheet(run.triangles, run.adjusted.xyz)
    found = CaveFindings(
        name, run.body, run.volume, run.spacing, run.triangles.volume, run.strata, run.clearance, sheet.scale,
        sheet.azimuth, ("plan", "section"), file_stems([name])[name], run.uncorrected,
    )  # fmt: skip
    images = draw_cave(found, sheet, run.triangles, t)
    view = cave_picture("view", name)
    document = single_document(
        name, t("Report of a survey of passages"), cave_chapter(found, t), view if view in images else "", t,
        title=title, date=date,
    )  # fmt: skip
    return write_document(document, images, folder_for(out), name)

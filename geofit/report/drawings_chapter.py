"""The chapter of the geological sections: each to scale, with its caption."""

from __future__ import annotations

from geofit.data.languages import Language
from geofit.report.accuracy_report import AccuracyReport
from geofit.report.document import Block, Chapter, Heading, Paragraph, Picture
from geofit.report.section_sheet import section_caption

__all__ = ["sections_chapter"]


def sections_chapter(report: AccuracyReport, t: Language) -> Chapter | None:
    """Lay out the geological sections; None where the report has none."""
    if not report.sections:
        return None
    blocks: list[Block] = [
        Paragraph(
            t(
                "Each section is drawn to scale along its line in plan. Nearby holes and contacts are projected onto "
                "it; the bearings give the direction of its ends."
            ),
            "quiet",
        )
    ]
    for sheet in report.sections:
        blocks.append(Heading(t("Section {name} – {name}′", name=sheet.name)))
        blocks.append(Picture(sheet.picture, section_caption(sheet, t), to_scale=True))
    return Chapter(t("Geological sections"), tuple(blocks))

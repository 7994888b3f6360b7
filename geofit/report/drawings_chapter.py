"""The chapter of the geological sections: each to scale, with its caption."""

from __future__ import annotations

from geofit.data.languages import Language, translate
from geofit.data.stale import stale_warning
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
    stale = [horizon.name for horizon in report.horizons if horizon.stale]
    for sheet in report.sections:
        blocks.append(Heading(t("Section {name} – {name}′", name=sheet.name)))
        if stale:
            blocks.append(Paragraph(translate(stale_warning(stale), t), "warning"))
        blocks.append(Picture(sheet.picture, section_caption(sheet, t), to_scale=True))
    return Chapter(t("Geological sections"), tuple(blocks))

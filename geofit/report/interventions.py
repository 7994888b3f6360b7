"""What a person did and should look at, in one place: points left out, manual edits, outliers, suggested boreholes."""

from __future__ import annotations

from geofit.data.languages import Language, sentence, translate
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, HorizonReport, PredictionReport
from geofit.report.document import Block, Cell, Chapter, Column, Heading, Paragraph, ReportTable
from geofit.report.point_table import point_cells, point_columns

__all__ = ["interventions"]

#: Rows of a list of one horizon; the JSON holds all of them.
LONGEST = 30


def interventions(report: AccuracyReport, t: Language) -> Chapter:
    """Lay out what was left out, edited, doubted and suggested, horizon by horizon."""
    blocks: list[Block] = []
    unknown = [h.name for h in report.horizons if h.prediction is None]
    for title, nothing, of in (
        (t("Excluded points"), t("No point was left out by hand."), _excluded),
        (t("Coincident points"), t("No point coincides with another one."), _conflicts),
        (t("Manual edits"), t("No surface was changed by hand."), _edits),
        (t("Outliers"), t("None."), _outliers),
        (t("Suggested boreholes"), t("No holes are suggested."), _suggestions),
    ):
        found = [(h.name, more) for h in report.horizons if (more := of(h, t))]
        # Only leaving holes out reveals outliers and where holes are needed.
        missing = unknown if of in (_outliers, _suggestions) else []
        blocks.append(Heading(title))
        if not found and len(missing) < len(report.horizons):
            blocks.append(Paragraph(nothing))
        for name, more in found:
            blocks += [Heading(name, 3), *more]
        if missing:
            blocks.append(Paragraph(t("Not examined: {names}.", names=", ".join(missing))))
    return Chapter(t("Excluded points, edits and suggestions"), tuple(blocks), follows=True)


def _excluded(h: HorizonReport, t: Language) -> list[Block]:
    if not h.excluded:
        return []
    rows = tuple(point_cells(p, t) for p in h.excluded[:LONGEST])
    return [ReportTable(point_columns(t), rows), *_more(len(h.excluded), t)]


def _edits(h: HorizonReport, t: Language) -> list[Block]:
    return [Paragraph(f"{i}. {sentence(edit, t)}") for i, edit in enumerate(h.edits, 1)]


def _conflicts(h: HorizonReport, t: Language) -> list[Block]:
    if not h.conflicts:
        return []
    columns = (
        Column(t("Kept"), "wide"),
        Column(t("Dropped"), "wide"),
        Column(t("Difference, m"), "number"),
        Column(t("Why"), "wide"),
    )
    rows = tuple(
        (translate(c.kept, t), translate(c.dropped, t), digits.metres(c.difference), translate(c.text, t))
        for c in h.conflicts[:LONGEST]
    )
    return [ReportTable(columns, rows), *_more(len(h.conflicts), t)]


def _outliers(h: HorizonReport, t: Language) -> list[Block]:
    if h.prediction is None or not h.prediction.outliers:
        return []
    columns = (
        *point_columns(t),
        Column(t("Left-out error, m"), "number"),
        Column(t("Standard deviation, m"), "number"),
        Column(t("Ratio"), "number"),
    )
    found = h.prediction.outliers
    rows = tuple(
        (*point_cells(o.point, t), digits.metres(o.error), digits.metres(o.sd), f"{o.ratio:.1f}".replace("-", "−"))
        for o in found[:LONGEST]
    )
    text = t("Points that their neighbours contradict. They were used all the same: check them.")
    return [Paragraph(text, "quiet"), ReportTable(columns, rows), *_more(len(found), t)]


def _suggestions(h: HorizonReport, t: Language) -> list[Block]:
    off = h.prediction
    if off is None or not off.suggestions:
        return []
    columns = (
        Column(t("No."), "number"),
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("z, m"), "number"),
        Column(t("Standard deviation there, m"), "number"),
        Column(t("Mean afterwards, m"), "number"),
        Column(t("Largest afterwards, m"), "number"),
        Column(t("Mean lower by"), "number"),
    )
    return [ReportTable(columns, tuple(_suggestion(i, off, t) for i in range(len(off.suggestions))))]


def _suggestion(i: int, off: PredictionReport, t: Language) -> tuple[Cell, ...]:
    s = off.suggestions[i]
    return (
        str(i + 1),
        *(digits.place(value) for value in (s.x, s.y, s.z)),
        *(digits.metres(value) for value in (s.sd, s.mean_after, s.max_after)),
        digits.share(1 - s.mean_after / off.sd_mean) if off.sd_mean else "–",
    )


def _more(total: int, t: Language) -> list[Block]:
    if total <= LONGEST:
        return []
    return [Paragraph(t("{file} lists {count} more.", count=total - LONGEST, file="report.json"), "quiet")]

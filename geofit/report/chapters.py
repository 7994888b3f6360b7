"""The accuracy report as pages in a language: cover, summary, sections, a chapter for each horizon, annexes."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import Message
from geofit.data.stale import stale_warning
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, HorizonReport
from geofit.report.annex import horizon_annex, inputs_annex
from geofit.report.chapter_head import lamp_mark, verdict_badge
from geofit.report.cover import cover, reference
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    Column,
    Heading,
    Paragraph,
    Picture,
    ReportDocument,
    ReportTable,
)
from geofit.report.drawings_chapter import sections_chapter
from geofit.report.horizon_chapter import horizon_chapter
from geofit.report.interventions import interventions
from geofit.report.limits import away_from_data, limits_of_use
from geofit.report.structure_blocks import structure_blocks

__all__ = ["document"]


def document(
    report: AccuracyReport,
    t: Language,
    *,
    missing_picture: Message | None = None,
    warning: Message | None = None,
    bodies: Sequence[Chapter] = (),
    body_rows: Sequence[tuple[Cell, ...]] = (),
    stale_bodies: Sequence[str] = (),
    notes: Sequence[Message] = (),
) -> ReportDocument:
    """Lay an accuracy report out as chapters.

    Parameters
    ----------
    report : AccuracyReport
        What to say.
    t : Language
        In which language.
    missing_picture : Message or None
        Why there are no pictures in space; empty if there are.
    warning : str
        Something the reader must know about the report itself, a missing font for one.
    bodies : sequence of Chapter
        Chapters of bodies, which follow those of the horizons.
    body_rows : sequence of tuple
        Their verdicts for the summary (:func:`geofit.report.body_chapter.body_row`).
    stale_bodies : sequence of str
        Which bodies are older than their data.
    notes : sequence of Message
        What else the reader must know about the files of the run.
    """
    site = report.site or t("Site")
    title = report.title
    version = "geofit " + report.versions["geofit"]
    facts = ((t("Coordinate system"), report.crs or t("not stated")), (t("Program"), version))
    picture = Paragraph(translate(missing_picture, t), "warning") if missing_picture else Picture(report.picture, "")
    stale = [*(horizon.name for horizon in report.horizons if horizon.stale), *stale_bodies]
    warnings = [*([warning] if warning else []), *([stale_warning(stale)] if stale else [])]
    drawings = sections_chapter(report, t)
    chapters = [
        cover(title, facts, picture, report.date, t, warnings),
        _summary(report, body_rows, notes, stale, t),
        *([drawings] if drawings else []),
        *(horizon_chapter(horizon, t, missing_picture) for horizon in report.horizons),
        *bodies,
        Chapter(t("The site as a whole"), structure_blocks(report, t), follows=True),
        interventions(report, t),
        inputs_annex(report, t),
        horizon_annex(report, t),
    ]
    return ReportDocument(
        title=site,
        subject=t("Accuracy report of the geological surfaces"),
        site=site,
        date=report.date,
        language=t.html,
        footer=f"{version} · {report.date}",
        chapters=tuple(chapters),
        contents=t("Contents"),
        reference=reference(title, t),
    )


def _summary(
    report: AccuracyReport,
    body_rows: Sequence[tuple[Cell, ...]],
    notes: Sequence[Message],
    stale: Sequence[str],
    t: Language,
) -> Chapter:
    blocks: list[Block] = [
        Heading(t("Verdict")),
        _verdicts(t("Horizon"), [_verdict_row(horizon, t) for horizon in report.horizons], t),
    ]
    if body_rows:
        blocks.append(_verdicts(t("Body"), body_rows, t))
    blocks.append(
        Paragraph(
            t(
                "σ = √(Σ d² / (n − 1)) over all n points; d is the orthogonal distance from a point to the surface, "
                "positive above it. FAIL: σ is not below the control error ε. WARNING: it is, but a check fails, or "
                "the surface is worse away from its data: the left-out error, the root mean square of what it misses "
                "where holes, sections or blocks are left out (the worst of them), is above ε or cannot be estimated, "
                "the 90 % band contains too few of these points, a point is farther than ε off its neighbours, or a "
                "source is systematically offset. PASS: none of these."
            ),
            "quiet",
        )
    )
    for name, reason in report.failures.items():
        blocks.append(Paragraph(t("{name} could not be fitted: {reason}", name=name, reason=reason), "warning"))
    blocks += [Paragraph(sentence(note, t), "warning") for note in notes]
    blocks += [*away_from_data(report, t), *limits_of_use(report, stale, t)]
    return Chapter(t("Summary"), tuple(blocks))


def _verdicts(what: str, rows: Sequence[tuple[Cell, ...]], t: Language) -> ReportTable:
    """Return the table of the verdicts; ``what`` titles the names."""
    columns = (
        Column(what),
        Column(t("Verdict")),
        Column(t("σ, m"), "number"),
        Column(t("ε, m"), "number"),
        Column(t("Largest |d|, m"), "number"),
        Column(t("Points"), "number"),
        Column(t("Checks"), "wide"),
        Column(t("Away from the data"), "wide"),
    )
    return ReportTable(columns, tuple(rows))


def _verdict_row(horizon: HorizonReport, t: Language) -> tuple[Cell, ...]:
    _, checks, away = (lamp_mark(lamp, t) for lamp in horizon.lamps)
    return (
        horizon.name,
        verdict_badge(horizon.verdict, t, stale=bool(horizon.stale)),
        digits.metres(horizon.sigma),
        digits.given(horizon.epsilon),
        digits.metres(horizon.max_abs),
        digits.count(horizon.n_points),
        checks,
        away,
    )

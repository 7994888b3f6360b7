"""The accuracy report as pages in a language: cover, the site as a whole, a chapter for each horizon."""

from __future__ import annotations

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import Message
from geofit.data.verdict import Lamp
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, HorizonReport
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    Column,
    Document,
    Heading,
    Mark,
    Paragraph,
    Picture,
    Signatures,
    Table,
)
from geofit.report.horizon_chapter import horizon_chapter, verdict_badge
from geofit.report.structure_blocks import structure_blocks

__all__ = ["document"]

#: Rows of a list in the document; the JSON and the CSV hold all of them.
LONGEST = 40


def document(
    report: AccuracyReport, t: Language, *, missing_picture: Message | None = None, warning: Message | None = None
) -> Document:
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
    """
    site = report.site or t("Site")
    whole = Chapter(t("The site as a whole"), (*structure_blocks(report, t), *_inputs(report, t)))
    chapters = [_cover(report, t, missing_picture, warning), whole]
    chapters += [horizon_chapter(horizon, t, missing_picture) for horizon in report.horizons]
    return Document(
        title=site,
        subject=t("Accuracy report of the geological surfaces"),
        site=site,
        date=report.date,
        language=t.html,
        footer=f"geofit {dict(report.versions)['geofit']} · {report.date}",
        chapters=tuple(chapters),
    )


def _cover(report: AccuracyReport, t: Language, missing_picture: Message | None, warning: Message | None) -> Chapter:
    blocks: list[Block] = []
    facts = [t("Coordinate system: {crs}", crs=report.crs or t("not stated")), t("Date: {date}", date=report.date)]
    facts.append("geofit " + dict(report.versions)["geofit"])
    blocks.append(Paragraph(" · ".join(facts), "quiet"))
    if warning:
        blocks.append(Paragraph(translate(warning, t), "warning"))
    blocks.append(Heading(t("Verdict")))
    columns = (
        Column(t("Horizon")),
        Column(t("Verdict")),
        Column(t("σ, m"), "number"),
        Column(t("ε, m"), "number"),
        Column(t("Largest |d|, m"), "number"),
        Column(t("Points"), "number"),
        Column(t("Checks"), "wide"),
        Column(t("Away from the data"), "wide"),
    )
    blocks.append(Table(columns, tuple(_verdict_row(horizon, t) for horizon in report.horizons)))
    blocks.append(
        Paragraph(
            t(
                "σ = √(Σ d² / (n − 1)) over all n points; d is the orthogonal distance from a point to the surface, "
                "positive above it. FAIL: σ is not below the control error ε. WARNING: it is, but a check fails, or "
                "the surface is worse away from its data: the left-out error, the root mean square of what it misses "
                "where holes, sections or blocks are left out (the worst of them), is above ε, or the 90 % band "
                "contains too few of these points. PASS: none of this."
            ),
            "quiet",
        )
    )
    for name, reason in report.failures:
        blocks.append(Paragraph(t("{name} could not be fitted: {reason}", name=name, reason=reason), "warning"))
    if missing_picture:
        blocks.append(Paragraph(translate(missing_picture, t), "warning"))
    else:
        blocks.append(Picture(report.picture, t("All horizons and holes.")))
    blocks.append(Heading(t("Signatures")))
    blocks.append(
        Signatures(
            ("", t("Name"), t("Signature"), t("Date")),
            (t("Prepared"), t("Checked"), t("Approved")),
        )
    )
    return Chapter(t("Accuracy report"), tuple(blocks))


def _verdict_row(horizon: HorizonReport, t: Language) -> tuple[Cell, ...]:
    _, checks, away = (_mark(lamp, t) for lamp in horizon.lamps)
    return (
        horizon.name,
        verdict_badge(horizon, t),
        digits.metres(horizon.sigma),
        digits.given(horizon.epsilon),
        digits.metres(horizon.max_abs),
        digits.count(horizon.n),
        checks,
        away,
    )


def _mark(lamp: Lamp, t: Language) -> Mark:
    text = translate(lamp.text, t)
    return Mark({"pass": True, "fail": False}.get(lamp.level), f"! {text}" if lamp.level == "warning" else text)


def _inputs(report: AccuracyReport, t: Language) -> list[Block]:
    counts = dict(report.issues)
    blocks: list[Block] = [
        Heading(t("Files")),
        Paragraph(t("Rows read = rows used + rows listed. SHA-256 tells whether a file is the one that was read.")),
        Table(
            (
                Column(t("File"), "wide"),
                Column(t("Rows read"), "number"),
                Column(t("Used"), "number"),
                Column(t("Listed"), "number"),
                Column("SHA-256", "hash"),
            ),
            tuple(
                (f.file, digits.count(f.read), digits.count(f.used), digits.count(f.listed), f.sha256 or "–")
                for f in report.inputs
            ),
        ),
        Heading(t("Rejected rows and warnings")),
        Paragraph(
            t(
                "Rows not used: {errors}; warnings: {warnings}; notes on how files were understood: {notes}. "
                "import_issues.csv lists all of them.",
                errors=counts["error"],
                warnings=counts["warning"],
                notes=counts["note"],
            )
        ),
    ]
    if report.rejected:
        rows = tuple(
            (
                Mark(False, t("not used")) if r.severity == "error" else Mark(None, t("warning")),
                r.file,
                str(r.row) if r.row else "–",
                r.column or "–",
                r.value or "–",
                f"{sentence(r.reason, t)} {translate(r.remedy, t)}".strip(),
            )
            for r in report.rejected[:LONGEST]
        )
        columns = (
            Column(t("What")),
            Column(t("File"), "wide"),
            Column(t("Row"), "number"),
            Column(t("Column")),
            Column(t("Value")),
            Column(t("Reason and remedy"), "wide"),
        )
        blocks.append(Table(columns, rows))
        blocks += more(len(report.rejected), LONGEST, "import_issues.csv", t)
    blocks.append(Heading(t("Versions")))
    blocks.append(Table((Column(t("Program")), Column(t("Version"))), report.versions))
    blocks.append(
        Paragraph(
            t(
                "Method: Li, Miao, Liu, Wang (2011), interpolation–approximation fitting of complex geological "
                "surfaces; checks and errors off the data as geofit documents them."
            ),
            "quiet",
        )
    )
    return blocks


def more(total: int, shown: int, where: str, t: Language) -> list[Block]:
    """Say that a table is longer than what is shown, and where the rest stands; nothing if it is not."""
    if total <= shown:
        return []
    return [Paragraph(t("{count} more stand in {file}.", count=total - shown, file=where), "quiet")]

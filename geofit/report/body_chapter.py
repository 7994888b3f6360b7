"""The chapter of one body: verdict, violations, volumes, strata, sections, holes left out, holes to drill."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import Message, message
from geofit.data.stale import StaleCause
from geofit.data.verdict import Verdict as Judged
from geofit.data.verdict import verdict_of
from geofit.report import digits
from geofit.report.chapter_head import lamp_mark, lamps_paragraph, verdict_badge
from geofit.report.checks_table import check_table
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    CheckMark,
    Column,
    Facts,
    Heading,
    Paragraph,
    Picture,
    ReportTable,
)
from geofit.report.gather import check_lines
from geofit.report.stale_blocks import stale_blocks

if TYPE_CHECKING:
    from geofit.bodies.accuracy import BodyAccuracy
    from geofit.bodies.body import BodyFit
    from geofit.bodies.crossval import CrossValidation
    from geofit.bodies.drilling import SuggestedHole
    from geofit.bodies.simulate import BodyVolumes
    from geofit.bodies.strata import StratumVolume
    from geofit.cad.solid_read_back import SolidReadBack

__all__ = ["BodyFindings", "body_chapter", "body_picture", "body_row"]

#: Rows of a list; the JSON holds all of them.
LONGEST = 20
#: What each method of the comparison is called.
_METHODS = {
    "body": message("report.method-body", "this body"),
    "linear RBF": message("report.method-rbf", "linear RBF"),
    "indicator kriging": message("report.method-indicator", "indicator kriging"),
}


@dataclass(frozen=True, eq=False)
class BodyFindings:
    """Everything that a chapter says of a body; None: not examined, ``missing`` states why.

    ``pictures`` are what was drawn: "view", "section-0" and so on. ``stale`` lists what has changed since the fit.
    """

    body: BodyFit
    volumes: BodyVolumes
    read_back: SolidReadBack | None = None
    strata: tuple[StratumVolume, ...] = ()
    left_out: CrossValidation | None = None
    suggested: tuple[SuggestedHole, ...] | None = None
    pictures: tuple[str, ...] = ()
    missing: tuple[Message, ...] = field(default=())
    stale: tuple[StaleCause, ...] = ()

    @property
    def accuracy(self) -> BodyAccuracy:
        """The verdict of the body."""
        if self.body.accuracy is None:
            raise ValueError(f"body '{self.body.name}' has not been checked; fit_body() does that.")
        return self.body.accuracy

    @property
    def verdict(self) -> Judged:
        """The verdict of the body with its three lamps."""
        return verdict_of(self.accuracy, None if self.left_out is None else self.left_out.left_out)


def body_picture(what: str, name: str) -> str:
    """Return the name by which a report speaks of a picture of a body."""
    return f"body/{what}/{name}"


def body_row(found: BodyFindings, t: Language) -> tuple[Cell, ...]:
    """Return the body's row of the summary's verdicts."""
    a = found.accuracy
    _, checks, away = (lamp_mark(lamp, t) for lamp in found.verdict.lamps)
    return (
        found.body.name,
        verdict_badge(found.verdict.word, t, stale=bool(found.stale)),
        digits.metres(a.sigma),
        digits.given(a.epsilon),
        digits.metres(a.max_abs),
        digits.count(a.n),
        checks,
        away,
    )


def body_chapter(found: BodyFindings, t: Language) -> Chapter:
    """Lay out everything about one body."""
    a, name = found.accuracy, found.body.name
    blocks = [*stale_blocks(name, found.stale, t), lamps_paragraph(found.verdict.lamps, t), _facts(found, t)]
    blocks += [Paragraph(sentence(text, t), "warning") for text in (*a.warnings, *found.missing)]
    blocks += _pictures(found, t)
    blocks += [*_volumes(found, t), *_logged(a, t), *_checks(found, t), *_left_out(found, t), *_holes(found, t)]
    blocks += _issues(found, t)
    badge = verdict_badge(found.verdict.word, t, stale=bool(found.stale))
    return Chapter(t("Body {name}", name=name), tuple(blocks), badge)


def _facts(found: BodyFindings, t: Language) -> Facts:
    a, v, body = found.accuracy, found.volumes, found.body
    mesh = body.overview
    far = t("beyond {distance} m from data", distance=digits.given(round(a.far_distance, 1)))
    return Facts(
        (
            (t("σ over all contacts"), digits.length(a.sigma), f"ε = {digits.given(a.epsilon)} m"),
            (t("Largest |d|"), digits.length(a.max_abs), t("{count} contacts", count=digits.count(a.n))),
            (t("Volume"), digits.volume(v.best), t("P10 to P90: {share}", share=_spread(found))),
            (t("Surface"), digits.area(body.size.area), t("components: {count}", count=mesh.components)),
            (t("Euler number"), digits.count(mesh.euler), t("2 for each part without a tunnel")),
            (t("Far from data"), digits.share(a.far_share), far),
        )
    )


def _spread(found: BodyFindings) -> str:
    v = found.volumes
    return digits.share((v.p90 - v.p10) / v.best) if v.best else "–"


def _pictures(found: BodyFindings, t: Language) -> list[Block]:
    name = found.body.name
    blocks: list[Block] = []
    if "view" in found.pictures:
        blocks.append(Heading(t("The body")))
        blocks.append(Picture(body_picture("view", name), t("Dots: contacts. Seen from the south-west.")))
    sections = [what for what in found.pictures if what.startswith("section")]
    if sections:
        blocks.append(Heading(t("Sections through the body")))
        caption = t(
            "Thick line: the fitted surface. Shades: probability of lying inside, 10 %, 50 % and 90 %. Filled dots: "
            "samples inside, open dots: outside, within the thickness stated."
        )
        blocks += [
            Picture(body_picture(what, name), caption if i + 1 == len(sections) else "")
            for i, what in enumerate(sections)
        ]
    return blocks


def _volumes(found: BodyFindings, t: Language) -> list[Block]:
    """Lay out the volumes of the body and of its part in each stratum."""
    head = (
        Column(t("Part")),
        Column(t("Fitted, m³"), "number"),
        Column("P10, m³", "number"),
        Column("P50, m³", "number"),
        Column("P90, m³", "number"),
        Column(t("Standard deviation, m³"), "number"),
    )
    rows = [(t("whole body"), *_percentiles(found.volumes))]
    rows += [(translate(part.name, t), *_percentiles(part.volumes)) for part in found.strata]
    text = t(
        "Percentiles are over conditional simulations that honour every contact and sample: in 10 % of them the volume "
        "is below P10, in 90 % below P90. The numerical error of the fitted volume is at most {error} m³.",
        error=digits.count(math.ceil(found.volumes.error)),
    )
    return [Heading(t("Volume")), ReportTable(head, tuple(rows)), Paragraph(text, "quiet")]


def _percentiles(v: BodyVolumes) -> tuple[str, ...]:
    return tuple(digits.count(value) for value in (v.best, v.p10, v.p50, v.p90, v.sd))


def _logged(a: BodyAccuracy, t: Language) -> list[Block]:
    head = (Column(t("Compared with the log")), Column(t("Length, m"), "number"), Column(t("Share"), "number"))
    logged = a.logged_length
    rows = tuple(
        (word, digits.place(length), digits.share(length / logged) if logged else "–")
        for word, length in (
            (t("logged in all"), logged),
            (t("logged inside, lies outside"), a.missed_length),
            (t("logged outside, lies inside"), a.excess_length),
        )
    )
    sides = t("Samples on the wrong side: {count}.", count=a.wrong_side)
    return [Heading(t("Violations"), 3), ReportTable(head, rows), Paragraph(sides)]


def _checks(found: BodyFindings, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Checks of the body")), check_table(check_lines(found.accuracy.checks), t)]
    back = found.read_back
    if back is None:
        return blocks
    text = t("{file} was read back by OpenCASCADE and measured again.", file=Path(back.file).name)
    facts = (
        (t("Solids"), digits.count(back.solids), _validity(back, t)),
        (t("Faces"), digits.count(back.faces), translate(back.grade, t)),
        (t("Volume in the file"), digits.volume(back.volume), ""),
        (t("Largest distance from the body"), digits.length(back.deviation), ""),
        (t("Edge tolerance"), digits.length(back.edge_tolerance), ""),
    )
    blocks += [Heading(t("The STEP file, read back")), Paragraph(text), Facts(facts)]
    return [*blocks, check_table(check_lines(back.checks), t)]


def _validity(back: SolidReadBack, t: Language) -> str:
    """Return whether the solids are valid; of triangles OpenCASCADE's check says nothing."""
    if back.grade != "nurbs":
        return t("not applicable")
    return t("valid") if back.brep_valid else t("NOT VALID")


def _left_out(found: BodyFindings, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("One hole left out at a time"))]
    if found.left_out is None:
        return [*blocks, Paragraph(t("Not examined: what the body predicts along holes that it has not seen."))]
    head = (
        Column(t("Method"), "wide"),
        Column(t("Holes"), "number"),
        Column(t("Wrong side, m"), "number"),
        Column(t("Share of log"), "number"),
        Column(t("Median error of a contact, m"), "number"),
        Column(t("Contacts missed"), "number"),
    )
    rows = tuple(
        (
            translate(_METHODS.get(name, name), t),
            digits.count(len(score.holes)),
            digits.place(score.misclassified),
            digits.share(score.misclassified / score.logged) if score.logged else "–",
            digits.metres(score.contact_error),
            digits.count(score.missed),
        )
        for name, score in found.left_out.methods.items()
    )
    blocks.append(ReportTable(head, rows))
    worst = found.left_out.methods.get("body")
    if worst is not None:
        blocks += _worst_holes(worst.holes, t)
    if found.left_out.skipped:
        names = ", ".join(found.left_out.skipped)
        blocks.append(Paragraph(t("No body can be fitted without these holes: {names}.", names=names), "quiet"))
    return blocks


def _worst_holes(holes: Sequence[object], t: Language) -> list[Block]:
    from geofit.bodies.crossval import HoleScore

    scores = [hole for hole in holes if isinstance(hole, HoleScore) and hole.misclassified > 0]
    scores.sort(key=lambda hole: -hole.misclassified)
    if not scores:
        return []
    head = (Column(t("Hole")), Column(t("Wrong side, m"), "number"), Column(t("Logged, m"), "number"))
    rows = tuple((one.hole, digits.place(one.misclassified), digits.place(one.logged)) for one in scores[:5])
    return [Heading(t("Holes that are predicted worst"), 3), ReportTable(head, rows)]


def _holes(found: BodyFindings, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Suggested boreholes"))]
    if not found.suggested:
        return [*blocks, Paragraph(t("Not examined.") if found.suggested is None else t("No holes are suggested."))]
    head = (
        Column(t("No."), "number"),
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("z, m"), "number"),
        Column(t("Azimuth / dip, °"), "number"),
        Column(t("Meets the body"), "number"),
        Column(t("Entry, m (P10–P90)"), "number"),
        Column(t("Exit, m (P10–P90)"), "number"),
        Column(t("Standard deviation of the volume, m³"), "number"),
    )
    rows = []
    for i, one in enumerate(found.suggested, 1):
        hole = one.hole
        rows.append(
            (
                str(i),
                *(digits.place(float(value)) for value in hole.collar),
                f"{one.azimuth:.0f} / {one.dip:.0f}",
                digits.share(hole.probability),
                *(_band(band) for band in (hole.entry, hole.exit)),
                f"{digits.count(one.sd_before)} → {digits.count(one.sd_after)}",
            )
        )
    return [*blocks, ReportTable(head, tuple(rows))]


def _band(band: object) -> str:
    from geofit.bodies.planned import PercentileBand

    return f"{band.p50:.1f} ({band.p10:.1f}–{band.p90:.1f})" if isinstance(band, PercentileBand) else "–"


def _issues(found: BodyFindings, t: Language) -> list[Block]:
    issues = found.body.issues
    if not issues:
        return []
    rows: list[tuple[Cell, ...]] = [
        (CheckMark(None, t("used")) if one.used else CheckMark(False, t("not used")), sentence(one.text, t))
        for one in issues[:LONGEST]
    ]
    blocks: list[Block] = [
        Heading(t("Data to look at")),
        ReportTable((Column(t("What")), Column(t("Finding"), "wide")), tuple(rows)),
    ]
    if len(issues) > LONGEST:
        text = t("{file} lists {count} more.", count=len(issues) - LONGEST, file=f"{found.body.name}.json")
        blocks.append(Paragraph(text, "quiet"))
    return blocks

"""What a report says of a horizon whose data have changed: what moved, and whether the earlier band held."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.languages import Language, sentence
from geofit.data.messages import Message, message
from geofit.report import digits
from geofit.report.accuracy_report import ChangeReport
from geofit.report.document import Block, Cell, CheckMark, Column, Facts, Heading, Paragraph, Picture, ReportTable
from geofit.site.new_contacts import BlindTest

__all__ = ["change_blocks", "contact_rows"]

#: Contacts that a report lists.
MOST_ROWS = 40
_HEADER = (
    message("report.hole", "Hole"), message("report.heading-kind", "Kind"), message("report.easting", "Easting, m"),
    message("report.northing", "Northing, m"), message("report.heading-found", "Observed, m"),
    message("report.heading-predicted", "Predicted, m"), message("report.heading-low", "90 % low, m"),
    message("report.heading-high", "90 % high, m"), message("report.heading-residual", "Residual, m"),
    message("report.heading-inside", "Inside"),
)  # fmt: skip


def contact_rows(test: BlindTest) -> tuple[Sequence[Message], list[tuple[str, ...]]]:
    """Return the head and the rows of the table of new contacts, as a CSV file has them."""
    return _HEADER, [
        (
            one.group, one.kind, *(f"{value:.3f}" for value in (one.x, one.y, one.z)),
            *("" if value != value else f"{value:.3f}" for value in (one.predicted, one.low, one.high, one.residual)),
            "" if one.inside is None else str(int(one.inside)),
        )
        for one in test.contacts
    ]  # fmt: skip


def change_blocks(change: ChangeReport | None, picture: str, t: Language) -> list[Block]:
    """Lay out what moved since the earlier data; nothing where there are none."""
    if change is None:
        return []
    moved = t("beyond {limit} m", limit=digits.given(change.epsilon))
    facts = Facts(
        (
            (t("Mean"), digits.length(change.mean), t("rms {value}", value=digits.length(change.rms))),
            (t("Largest"), digits.length(change.largest), digits.place(change.x) + " / " + digits.place(change.y)),
            (t("Area that moved"), digits.share(change.share), moved),
            (t("New contacts"), digits.count(len(change.contacts)), t("{count} with a band", count=change.judged)),
            (t("Inside the earlier band"), digits.share(change.inside), t("90 % expected")),
            (t("RMS of their residuals"), digits.length(change.residual_rms), t("before they were known")),
        )
    )
    blocks: list[Block] = [
        Heading(t("What moved since the earlier data")),
        Paragraph(sentence(change.text, t), "plain"),
        Paragraph(sentence(change.verdict, t), "warning" if change.too_narrow else "plain"),
        facts,
        Picture(
            picture,
            t(
                "Later minus earlier elevation; the line bounds what moved by more than {epsilon} m. Each new contact "
                "is compared with the earlier surface, which did not know it.",
                epsilon=digits.given(change.epsilon),
            ),
        ),
    ]
    if change.areas:
        columns = tuple(
            Column(word, "number")
            for word in (t("Area"), t("Easting, m"), t("Northing, m"), t("Largest, m"), t("Mean, m"))
        )
        rows = tuple(
            (digits.area(one.area), digits.place(one.x), digits.place(one.y), digits.metres(one.most),
             digits.metres(one.mean))
            for one in change.areas
        )  # fmt: skip
        blocks += [Heading(t("Where it moved"), 3), ReportTable(columns, rows)]
    if change.contacts:
        blocks += [Heading(t("New contacts, before they were known"), 3), _contacts(change, t)]
        if len(change.contacts) > MOST_ROWS:
            more = t("{count} more are not listed; the JSON has them.", count=len(change.contacts) - MOST_ROWS)
            blocks.append(Paragraph(more, "quiet"))
    return blocks


def _contacts(change: ChangeReport, t: Language) -> ReportTable:
    columns = (
        Column(t("Hole")), Column(t("Observed, m"), "number"), Column(t("Predicted, m"), "number"),
        Column(t("90 % band, m"), "number"), Column(t("Residual, m"), "number"), Column(t("Inside")),
    )  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    # Those that were missed come first.
    for one in sorted(change.contacts, key=lambda one: (one.inside is not False, one.group))[:MOST_ROWS]:
        band = "–" if one.low is None else f"{digits.metres(one.low)} … {digits.metres(one.high)}"
        mark = "–" if one.inside is None else CheckMark(one.inside, t("yes") if one.inside else t("no"))
        rows.append((one.group, digits.metres(one.z), digits.metres(one.predicted), band, digits.metres(one.residual),
                     mark))  # fmt: skip
    return ReportTable(columns, tuple(rows))

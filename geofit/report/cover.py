"""The cover of a report: what it is about, title block, picture, revisions, signatures."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.languages import Language, translate
from geofit.data.messages import Message, message
from geofit.data.title_block import TitleBlock
from geofit.report.document import Block, Chapter, Column, Fields, Heading, Paragraph, Picture, ReportTable, Signatures

__all__ = ["cover", "reference"]

#: Who signs, by language: English reports from the author up, Chinese ones from the approval down.
_ROLES = {
    "en": (
        (message("report.prepared", "Prepared"), "author"),
        (message("data.checked", "Checked"), "checker"),
        (message("report.approved", "Approved"), "approver"),
    ),
    "zh": (
        (message("report.authorised", "Authorised"), ""),
        (message("report.approved", "Approved"), "approver"),
        (message("report.reviewed", "Reviewed"), ""),
        (message("data.checked", "Checked"), "checker"),
        (message("report.prepared", "Prepared"), "author"),
    ),
}
#: States of a document that are translated; any other word is printed as it is.
_STATES = {
    "draft": message("report.draft", "draft"),
    "for review": message("report.for-review", "for review"),
    "for approval": message("report.for-approval", "for approval"),
    "issued": message("report.issued", "issued"),
    "superseded": message("report.superseded", "superseded"),
}


def cover(
    title: TitleBlock, facts: tuple[tuple[str, str], ...], picture: Picture | Paragraph | None, date: str, t: Language,
    warnings: Sequence[Message] = (),
) -> Chapter:  # fmt: skip
    """Lay out the cover.

    Parameters
    ----------
    title : TitleBlock
        What is in the title block.
    facts : tuple of (label, value)
        What else does: coordinate system, program.
    picture : Picture, Paragraph or None
        The picture, or why there is none.
    date : str
        Of the report, ISO 8601.
    t : Language
        That of the words.
    warnings : sequence of Message
        What the reader must know about the report itself.
    """
    blocks: list[Block] = [Paragraph(translate(warning, t), "warning") for warning in warnings]
    if picture is not None:
        blocks.append(picture)
    state = translate(_STATES.get(title.status.casefold(), title.status), t)
    blocks.append(
        Fields(
            (
                (t("Project number"), title.project),
                (t("Client"), title.client),
                (t("Document number"), title.document),
                (t("Issued by"), title.organisation),
                (t("Revision"), title.revision),
                (t("Status"), state),
                (t("Date"), date),
                (t("Author"), title.author),
                *facts,
            )
        )
    )
    if title.revisions:
        blocks += [Heading(t("Revisions"), 3), _revisions(title, t)]
    columns = ("", t("Name"), t("Signature"), t("Date"))
    roles = tuple((translate(word, t), getattr(title, of) if of else "") for word, of in _ROLES[t.code])
    blocks += [Heading(t("Signatures"), 3), Signatures(columns, roles)]
    return Chapter(t("Cover"), tuple(blocks))


def reference(title: TitleBlock, t: Language) -> str:
    """Return document number and revision for the head of the pages; empty where there is none."""
    parts = [title.document]
    if title.revision:
        parts.append(t("Rev. {mark}", mark=title.revision))
    return " · ".join(part for part in parts if part)


def _revisions(title: TitleBlock, t: Language) -> ReportTable:
    columns = (Column(t("Rev.")), Column(t("Date")), Column(t("Change"), "wide"), Column(t("By")))
    rows = tuple((one.mark, one.date or "–", one.text or "–", one.author or "–") for one in title.revisions)
    return ReportTable(columns, rows)

"""A report of one body or one rock volume: a cover and its chapter, of the same document class as a site's."""

from __future__ import annotations

from geofit.data.languages import Language
from geofit.data.messages import Message
from geofit.data.title_block import TitleBlock
from geofit.report.cover import cover, reference
from geofit.report.document import Chapter, Picture, ReportDocument
from geofit.report.gather import today, versions

__all__ = ["single_document"]


def single_document(
    name: str, subject: str, chapter: Chapter, picture: str, t: Language, *, title: TitleBlock | None = None,
    date: str = "", warning: Message | None = None,
) -> ReportDocument:  # fmt: skip
    """Lay out a report with one chapter.

    Parameters
    ----------
    name : str
        What it is about, in large type.
    subject : str
        What kind of report it is.
    chapter : Chapter
        The chapter.
    picture : str
        Name of the picture on the cover.
    t : Language
        That of the words.
    title : TitleBlock, optional
        What the title block says.
    date : str
        ISO 8601; empty: :func:`geofit.report.gather.today`.
    warning : Message, optional
        Something the reader must know about the report itself.
    """
    block, day = title or TitleBlock(), date or today()
    version = "geofit " + versions()["geofit"]
    facts = ((t("Program"), version),)
    front = cover(block, facts, Picture(picture, "") if picture else None, day, t, [warning] if warning else [])
    return ReportDocument(
        name, subject, name, day, t.html, f"{version} · {day}", (front, chapter), reference=reference(block, t)
    )

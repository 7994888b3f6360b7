"""What a report says of itself: project, client, document, status, signatures and revisions."""

from __future__ import annotations

from dataclasses import dataclass

from geofit.data.given import keywords_known

__all__ = ["Revision", "TitleBlock"]


@keywords_known
@dataclass(frozen=True)
class Revision:
    """An issue of a document.

    Parameters
    ----------
    mark : str
        Letter or number: "A", "0".
    date : str
        Day of issue, ISO 8601.
    text : str
        What changed.
    author : str
        Who made it.
    """

    mark: str
    date: str = ""
    text: str = ""
    author: str = ""


@keywords_known
@dataclass(frozen=True)
class TitleBlock:
    """What stands on the cover of a report; an empty entry is printed as a line to fill in, or left out.

    Parameters
    ----------
    project : str
        Project number.
    client : str
        Client.
    organisation : str
        Who issues the report.
    document : str
        Document number.
    status : str
        "draft", "for review", "for approval", "issued", or any other word.
    author, checker, approver : str
        Names under which the signatures stand.
    revisions : tuple of Revision
        History of the document, oldest first.

    Examples
    --------
    >>> TitleBlock(project="HB-2026", revisions=(Revision("A"), Revision("B"))).revision
    'B'
    """

    project: str = ""
    client: str = ""
    organisation: str = ""
    document: str = ""
    status: str = ""
    author: str = ""
    checker: str = ""
    approver: str = ""
    revisions: tuple[Revision, ...] = ()

    @property
    def revision(self) -> str:
        """Mark of the latest revision, empty if there is none."""
        return self.revisions[-1].mark if self.revisions else ""

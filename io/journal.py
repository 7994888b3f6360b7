"""What readers find while they read: issues, row counts, hashes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal

from geofit.data.errors import GeofitError
from geofit.data.messages import EMPTY, Message, folded, message
from geofit.data.site import ImportIssue, TableCount
from geofit.io.source import Source

__all__ = ["MOST", "Journal"]

Severity = Literal["error", "warning", "note"]

#: Findings of one kind, of one column of one file, that are listed one by one.
MOST = 10_000


@dataclass
class Journal:
    """One list for all files of one reading; handed down to every reader, which appends to it.

    ``found`` holds what was listed; of findings that are alike but for their row the first :data:`MOST`.
    ``refused`` gives file and row of each collar that was not used, by the name of its hole; ``systems`` the
    coordinate systems that files state, each with the first such file.
    """

    found: list[ImportIssue] = field(default_factory=list)
    counts: list[TableCount] = field(default_factory=list)
    inputs: dict[str, str] = field(default_factory=dict)
    refused: dict[str, tuple[Message | str, ...]] = field(default_factory=dict)
    systems: dict[str, str] = field(default_factory=dict)
    _alike: dict[tuple[Severity, str, str, str], tuple[int, int, Message]] = field(default_factory=dict)

    def read(self, source: Source) -> bytes:
        """Return the bytes of a file and keep their SHA-256."""
        data = source.read()
        self.inputs[source.name] = hashlib.sha256(data).hexdigest()
        return data

    def add(
        self,
        severity: Severity,
        file: str,
        reason: Message,
        remedy: Message = EMPTY,
        *,
        row: int = 0,
        column: str = "",
        value: str = "",
    ) -> None:
        """List one finding; beyond :data:`MOST` that are alike it is counted, with the last row."""
        alike = (severity, file, reason.code, column)
        count, *_ = self._alike.get(alike, (0, row, reason))
        self._alike[alike] = (count + 1, row, reason)
        if count < MOST:
            self.found.append(ImportIssue(file, row, folded(column), folded(value), severity, reason, remedy))

    @contextmanager
    def handed_over(self) -> Iterator[None]:
        """Give an error of the block what was found before it: the rows that were not used may be its reason."""
        try:
            yield
        except GeofitError as error:
            error.issues = error.issues or tuple(self.issues)
            raise

    def take(self, issues: Iterable[ImportIssue]) -> None:
        """List what another journal found."""
        self.found += issues

    @property
    def issues(self) -> list[ImportIssue]:
        """Everything that was found, the counted findings as one each."""
        more = [
            ImportIssue(
                file,
                row,
                folded(column),
                "",
                severity,
                message(
                    "io.more-alike",
                    "{count} more of this kind, the last in this row: {reason}",
                    count=count - MOST,
                    reason=reason,
                ),
            )
            for (severity, file, _, column), (count, row, reason) in self._alike.items()
            if count > MOST
        ]
        return self.found + more

    def count(self, file: str, read: int, listed: int) -> None:
        """Keep the rows of one file: those that are not listed are used."""
        self.counts.append(TableCount(file, read, read - listed, listed))

"""What readers find while they read: issues, row counts, hashes."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Literal

from geofit.data.messages import EMPTY, Message
from geofit.data.site import ImportIssue, TableCount
from geofit.io.source import Source

__all__ = ["Journal"]

Severity = Literal["error", "warning", "note"]


@dataclass
class Journal:
    """One list for all files of one reading; handed down to every reader, which appends to it.

    ``refused`` gives file and row of each collar that was not used, by the name of its hole.
    """

    issues: list[ImportIssue] = field(default_factory=list)
    counts: list[TableCount] = field(default_factory=list)
    inputs: dict[str, str] = field(default_factory=dict)
    refused: dict[str, tuple[Message | str, ...]] = field(default_factory=dict)

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
        """List one finding."""
        self.issues.append(ImportIssue(file, row, column, value, severity, reason, remedy))

    def count(self, file: str, read: int, listed: int) -> None:
        """Keep the rows of one file: those that are not listed are used."""
        self.counts.append(TableCount(file, read, read - listed, listed))

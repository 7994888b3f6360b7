"""Mappings of columns that were used before, by the header that they are for: next time nothing need be said again."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.gui.wizard.draft import Draft
from geofit.io.mapping import ColumnMapping

__all__ = ["Memory"]

#: Layouts that are kept, the latest first.
KEPT = 200


class Memory:
    """A file of headers with their mappings; one that cannot be read counts as empty."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def recall(self) -> tuple[tuple[tuple[str, ...], ColumnMapping], ...]:
        """Return the headers with their mappings, the latest first."""
        try:
            entries = json.loads(self._path.read_text(encoding="utf-8"))
            return tuple((tuple(entry["header"]), ColumnMapping(**entry["mapping"])) for entry in entries)
        except (OSError, ValueError, KeyError, TypeError, InputError):
            return ()

    def keep(self, drafts: Iterable[Draft]) -> None:
        """Remember how tables with columns were mapped."""
        new = [(draft.preview.header, draft.mapping) for draft in drafts if draft.named_kind and draft.preview.header]
        headers = {header for header, _ in new}
        entries = [*new, *(one for one in self.recall() if one[0] not in headers)][:KEPT]
        self._path.parent.mkdir(parents=True, exist_ok=True)
        data = [{"header": list(header), "mapping": asdict(mapping)} for header, mapping in entries]
        with replacing(self._path) as part:
            part.write_text(json.dumps(data, ensure_ascii=False, indent=1), encoding="utf-8")

"""What a report says of a surface or a body that was fitted to earlier data or settings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geofit.data.languages import Language, translate
from geofit.data.stale import StaleCause, stale_warning
from geofit.report.annex import setting_value
from geofit.report.digits import count
from geofit.report.document import Block, Column, Paragraph, ReportTable

__all__ = ["stale_blocks"]

#: Rows or faults that a cell names; of more it gives the number.
MOST = 4


def stale_blocks(name: str, stale: Sequence[StaleCause], t: Language) -> list[Block]:
    """Lay out the warning and what has changed since the fit; nothing where nothing has."""
    if not stale:
        return []
    columns = (Column(t("Changed since the fit"), "wide"), Column(""), Column(t("Value"), "hash"))
    rows = tuple(
        row
        for one in stale
        for row in (
            (translate(one.text, t), t("at the fit"), _value(one, one.fitted, t)),
            ("", t("now"), _value(one, one.now, t)),
        )
    )
    return [Paragraph(translate(stale_warning([name]), t), "warning"), ReportTable(columns, rows)]


def _value(cause: StaleCause, value: Any, t: Language) -> str:
    if cause.kind == "setting":
        return setting_value(cause.name, value, t)
    if isinstance(value, tuple):
        return (", ".join(value) if len(value) <= MOST else count(len(value))) or "–"
    return value or "–"

"""What a report says of a surface that was fitted to earlier data or settings."""

from __future__ import annotations

from typing import Any

from geofit.data.languages import Language, translate
from geofit.data.setting_texts import SETTINGS
from geofit.data.stale import StaleCause, stale_warning
from geofit.report.accuracy_report import HorizonReport
from geofit.report.annex import setting_value
from geofit.report.digits import count
from geofit.report.document import Block, Column, Paragraph, ReportTable

__all__ = ["stale_blocks"]

#: Rows or faults that a cell names; of more it gives the number.
MOST = 4


def stale_blocks(h: HorizonReport, t: Language) -> list[Block]:
    """Lay out the warning and what has changed since the fit; nothing where the surface is not stale."""
    if not h.stale:
        return []
    columns = (Column(t("Changed since the fit"), "wide"), Column(""), Column(t("Value"), "hash"))
    rows = tuple(
        row
        for one in h.stale
        for row in (
            (_what(one, t), t("at the fit"), _value(one, one.fitted, t)),
            ("", t("now"), _value(one, one.now, t)),
        )
    )
    return [Paragraph(translate(stale_warning([h.name]), t), "warning"), ReportTable(columns, rows)]


def _what(cause: StaleCause, t: Language) -> str:
    match cause.kind:
        case "data":
            return t("Data of the horizon: points, study area, ground, dips")
        case "file":
            return f"{cause.name}, SHA-256"
        case "setting":
            return translate(SETTINGS[cause.name].with_unit(), t)
        case "excluded":
            return t("Excluded points")
        case "faults":
            return t("Faults that cut the horizon")


def _value(cause: StaleCause, value: Any, t: Language) -> str:
    if cause.kind == "setting":
        return setting_value(cause.name, value, t)
    if isinstance(value, tuple):
        return (", ".join(value) if len(value) <= MOST else count(len(value))) or "–"
    return value or "–"

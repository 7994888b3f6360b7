"""Checks as a table: question, answer, value, limit, and where it is worst."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.languages import Language, sentence, together, translate
from geofit.report import digits
from geofit.report.accuracy_report import CheckLine
from geofit.report.document import CheckMark, Column, ReportTable

__all__ = ["check_table"]

#: Of the places where a check fails, so many are named.
MOST_PLACES = 3


def check_table(checks: Sequence[CheckLine], t: Language) -> ReportTable:
    """Lay out checks of a surface, a body or a file."""
    columns = (
        Column(t("Check")),
        Column(t("Result")),
        Column(t("Value"), "number"),
        Column(t("Limit"), "number"),
        Column(t("Detail"), "wide"),
    )
    words = {True: t("passed"), False: t("failed"), None: t("not applicable")}
    rows = tuple(
        (
            translate(c.name, t),
            CheckMark(c.passed, words[c.passed]),
            digits.measured(c.value, translate(c.unit, t)),
            digits.measured(c.limit, translate(c.unit, t)),
            _detail(c, t),
        )
        for c in checks
    )
    return ReportTable(columns, rows)


def _detail(check: CheckLine, t: Language) -> str:
    """Return what a check says, and, where it fails, the worst places."""
    text = sentence(check.text, t)
    if check.passed is not False or not check.places:
        return text
    places = "; ".join(f"({', '.join(digits.place(value) for value in p)})" for p in check.places[:MOST_PLACES])
    worst = t("Worst at {places} m.", places=places)
    return together([text, worst], t)

"""Residuals by kind of source, section, hole and patch."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from geofit.data.languages import Language, translate
from geofit.data.messages import message
from geofit.report import digits
from geofit.report.accuracy_report import GroupLine, HorizonReport
from geofit.report.document import Block, Cell, Column, Heading, Paragraph, ReportTable

__all__ = ["doubled", "group_blocks"]

#: Holes and sections beyond this number are in the JSON only, the largest residual first here.
LONGEST_GROUPS = 20
#: Longer tables of groups are set in two halves side by side.
LONGEST_SINGLE = 6
_GROUPS = {
    "kind": (message("report.by-kind", "By kind of source"), message("report.kind", "Kind of source")),
    "section": (message("report.by-section", "By section"), message("report.section", "Section")),
    "hole": (message("report.by-hole", "By hole"), message("report.hole", "Hole")),
    "patch": (message("report.by-patch", "By patch"), message("report.patch", "Patch")),
}


def group_blocks(h: HorizonReport, by_what: Sequence[str], t: Language) -> list[Block]:
    """Lay out the residuals of the parts that are named: "kind", "section", "hole", "patch"."""
    blocks: list[Block] = []
    for by in by_what:
        title, word = _GROUPS[by]
        rows = [group for group in h.groups if group.by == by]
        if not rows:
            continue
        shown = rows
        if len(rows) > LONGEST_GROUPS:
            shown = sorted(rows, key=lambda group: -group.max_abs)[:LONGEST_GROUPS]
        columns = (
            Column(translate(word, t)),
            Column(t("Points"), "number"),
            Column(t("σ, m"), "number"),
            Column(t("Largest |d|, m"), "number"),
            Column(t("Mean d, m"), "number"),
        )
        table = ReportTable(columns, tuple(_group_row(group, t) for group in shown))
        blocks += [Heading(translate(title, t), 3), doubled(table) if len(shown) > LONGEST_SINGLE else table]
        if len(rows) > LONGEST_GROUPS:
            text = t(
                "The {shown} with the largest residuals; report.json lists {count} more.",
                shown=LONGEST_GROUPS,
                count=len(rows) - LONGEST_GROUPS,
            )
            blocks.append(Paragraph(text, "quiet"))
    return blocks


def doubled(table: ReportTable) -> ReportTable:
    """Put the second half of a long, narrow table beside its first."""
    half = (len(table.rows) + 1) // 2
    empty = ("",) * len(table.columns)
    rows = zip_longest(table.rows[:half], table.rows[half:], fillvalue=empty)
    return ReportTable((*table.columns, Column(""), *table.columns), tuple((*a, "", *b) for a, b in rows))


def _group_row(group: GroupLine, t: Language) -> tuple[Cell, ...]:
    name = translate(group.name, t) if group.by in ("kind", "patch") else group.name
    figures = (digits.metres(value) for value in (group.sigma, group.max_abs, group.mean))
    return (name, digits.count(group.n), *figures)

"""The columns by which a table names which data point is meant, and where it was read."""

from __future__ import annotations

from geofit.data.languages import Language, translate
from geofit.report import digits
from geofit.report.accuracy_report import PointLine
from geofit.report.document import Cell, Column

__all__ = ["point_cells", "point_columns"]


def point_columns(t: Language) -> tuple[Column, ...]:
    """Return the columns that say which data point is meant."""
    return (
        Column(t("File"), "wide"),
        Column(t("Row"), "number"),
        Column(t("Kind")),
        Column(t("Hole or section")),
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("z, m"), "number"),
    )


def point_cells(p: PointLine, t: Language) -> tuple[Cell, ...]:
    """Return the cells of :func:`point_columns`."""
    place = (digits.place(value) for value in (p.x, p.y, p.z))
    return (p.file or "–", str(p.row or "–"), translate(p.kind, t), p.source or "–", *place)

"""What a report says of the dips measured on a horizon: a stereonet, and the surface at each place."""

from __future__ import annotations

from geofit.data.languages import Language
from geofit.report import digits
from geofit.report.accuracy_report import DipLine, HorizonReport
from geofit.report.document import Block, Cell, Column, Heading, Paragraph, Picture, ReportTable

__all__ = ["dip_blocks"]

#: Dips that the document lists, the largest angles first; the JSON holds all of them.
MOST_ROWS = 20


def dip_blocks(h: HorizonReport, t: Language) -> list[Block]:
    """Lay out the measured dips of a horizon; nothing where none were measured."""
    if not h.dips:
        return []
    use = (
        t("They are data of the fit, with an accuracy of {accuracy:g}°.", accuracy=h.settings["dip_accuracy"])
        if h.settings["dips"] == "fit"
        else t("They were compared with the surface; the fit did not use them.")
    )
    caption = t(
        "Poles of the measured planes (dots) and of the surface at the same places (rings); dashed: mean plane. "
        "Equal-area projection, lower hemisphere, north at the top."
    )
    columns = (
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("Measured"), "number"),
        Column(t("Surface"), "number"),
        Column(t("Angle, °"), "number"),
        Column(t("File, row"), "wide"),
    )
    worst = sorted(h.dips, key=lambda one: -one.angle)[:MOST_ROWS]
    blocks: list[Block] = [
        Heading(t("Measured dips")),
        Paragraph(t("{count} dips were measured on this horizon.", count=len(h.dips)) + " " + use),
        Picture(h.pictures["dips"], caption),
        ReportTable(columns, tuple(_row(one) for one in worst)),
    ]
    if len(h.dips) > MOST_ROWS:
        more = t("{count} more are not listed; the JSON has them.", count=len(h.dips) - MOST_ROWS)
        blocks.append(Paragraph(more, "quiet"))
    return blocks


def _row(one: DipLine) -> tuple[Cell, ...]:
    return (
        digits.place(one.x),
        digits.place(one.y),
        f"{one.azimuth:03.0f} / {one.dip:02.0f}",
        f"{one.surface_azimuth:03.0f} / {one.surface_dip:02.0f}",
        f"{one.angle:.1f}",
        f"{one.file}, {one.row}",
    )

"""How the horizons of a site lie to each other: their order, what the separation left, and what faults displace."""

from __future__ import annotations

from geofit.data.languages import Language, sentence, translate
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, FaultCutLine, OrderLine
from geofit.report.document import Block, Cell, CheckMark, Column, Heading, Paragraph, ReportTable

__all__ = ["structure_blocks"]

#: Places along a fault that the document shows; the JSON holds all of them.
SHOWN = 11


def structure_blocks(report: AccuracyReport, t: Language) -> tuple[Block, ...]:
    """Lay out order, contradictions and faults of a site."""
    return (*_order(report, t), *_contradictions(report, t), *_faults(report, t))


def _order(report: AccuracyReport, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Order of the horizons"))]
    if report.orders is None:
        blocks.append(Paragraph(t("Not examined: whether horizons cross and how thick the beds between them are.")))
    elif not report.orders:
        blocks.append(Paragraph(t("Nothing to examine: the site states no order of its horizons.")))
    else:
        columns = (
            Column(t("Upper horizon")),
            Column(t("Lower horizon")),
            Column(t("Result")),
            Column(t("Least thickness, m"), "number"),
            Column(t("Mean thickness, m"), "number"),
            Column(t("Crossing area, m²"), "number"),
            Column(t("Crossing volume, m³"), "number"),
            Column(t("Deepest at x, y, m"), "number"),
        )
        blocks.append(
            Paragraph(
                t(
                    "Thickness is measured vertically from the upper horizon down to the lower one. Below zero they "
                    "cross: the area and the volume say how much."
                ),
                "quiet",
            )
        )
        blocks.append(ReportTable(columns, tuple(_order_row(order, t) for order in report.orders)))
        blocks += [Paragraph(sentence(order.text, t), "quiet") for order in report.orders]
    return blocks


def _order_row(order: OrderLine, t: Language) -> tuple[Cell, ...]:
    words = {True: t("passed"), False: t("failed"), None: t("not applicable")}
    where = "–" if order.deepest is None else f"{digits.place(order.deepest[0])}, {digits.place(order.deepest[1])}"
    return (
        order.upper,
        order.lower,
        CheckMark(order.passed, words[order.passed]),
        digits.metres(order.minimum),
        digits.metres(order.mean),
        digits.count(order.crossing_area),
        digits.count(order.crossing_volume),
        where,
    )


def _contradictions(report: AccuracyReport, t: Language) -> list[Block]:
    """List what stayed crossed after the horizons were separated; nothing if they were not, or all are apart."""
    if not report.contradictions:
        return []
    columns = (
        Column(t("Upper horizon")),
        Column(t("Lower horizon")),
        Column(t("Missing, m"), "number"),
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("Exact point of the upper horizon"), "wide"),
        Column(t("Exact point of the lower horizon"), "wide"),
    )
    rows = tuple(
        (
            c.upper,
            c.lower,
            digits.metres(c.lack),
            digits.place(c.x),
            digits.place(c.y),
            translate(c.above, t) or "–",
            translate(c.below, t) or "–",
        )
        for c in report.contradictions
    )
    text = t(
        "The horizons were separated as far as their exact points allow. Here these points "
        "contradict each other: check their rows."
    )
    return [
        Heading(t("Crossings that remain because of exact points"), 3),
        Paragraph(text, "warning"),
        ReportTable(columns, rows),
    ]


def _faults(report: AccuracyReport, t: Language) -> list[Block]:
    if not report.cuts:
        return []
    columns = (
        Column(t("Fault")),
        Column(t("Horizon")),
        Column(t("Upthrown block")),
        Column(t("Downthrown block")),
        Column(t("Length, m"), "number"),
        Column(t("Least throw, m"), "number"),
        Column(t("Mean throw, m"), "number"),
        Column(t("Largest throw, m"), "number"),
    )
    rows = tuple(
        (
            c.fault,
            c.horizon,
            c.up,
            c.down,
            digits.place(c.length),
            digits.metres(c.throw_min),
            digits.metres(c.throw_mean),
            digits.metres(c.throw_max),
        )
        for c in report.cuts
    )
    text = t(
        "Each block is a surface of its own that ends at the fault. Throw is the vertical "
        "distance between the blocks midway between their ends, negative where the fault's "
        "sense is reversed; heave is the horizontal one, negative where they overlap."
    )
    blocks: list[Block] = [Heading(t("Faults")), Paragraph(text, "quiet"), ReportTable(columns, rows)]
    for cut in report.cuts:
        blocks += [Heading(f"{cut.fault} – {cut.horizon}: {cut.up} / {cut.down}", 3), _along(cut, t)]
    return blocks


def _along(cut: FaultCutLine, t: Language) -> ReportTable:
    """Lay out throw and heave at places spread evenly along the trace, both ends included."""
    columns = (
        Column(t("Along the fault, m"), "number"),
        Column(t("x, m"), "number"),
        Column(t("y, m"), "number"),
        Column(t("z, m"), "number"),
        Column(t("Throw, m"), "number"),
        Column(t("Heave, m"), "number"),
    )
    last = len(cut.places) - 1
    chosen = dict.fromkeys(round(k * last / (SHOWN - 1)) for k in range(SHOWN))
    rows = tuple(
        (
            digits.place(p.distance),
            digits.place(p.x),
            digits.place(p.y),
            digits.place(p.z),
            digits.metres(p.throw),
            digits.metres(p.heave),
        )
        for p in (cut.places[k] for k in chosen)
    )
    return ReportTable(columns, rows)

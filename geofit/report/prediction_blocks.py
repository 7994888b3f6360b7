"""What a report says about the surface away from its data: cross-validation, uncertainty, holes to drill."""

from __future__ import annotations

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import gravest_first, message
from geofit.data.verdict import LEAST_INSIDE
from geofit.report import digits
from geofit.report.accuracy_report import HorizonReport, LeftOutLine, PredictionReport
from geofit.report.document import Block, Cell, CheckMark, Column, Facts, Heading, Paragraph, Picture, ReportTable

__all__ = ["prediction_blocks"]

_SCHEMES = {
    "hole": message("report.scheme-holes", "one hole at a time"),
    "section": message("report.scheme-sections", "one section at a time"),
    "block": message("report.scheme-blocks", "one block at a time"),
}
#: Methods beside ours, in the order of their columns.
_REFERENCES = ("thin plate", "kriging")


def prediction_blocks(h: HorizonReport, t: Language) -> list[Block]:
    """Lay out the prediction error, or say that it was not examined."""
    off = h.prediction
    blocks: list[Block] = [Heading(t("Prediction error"))]
    if off is None:
        return [*blocks, Paragraph(t("Not examined: the prediction error away from the data."))]
    blocks.append(
        Paragraph(
            t(
                "Each group of points is left out in turn and predicted from all others; geofit, thin plate spline and "
                "kriging have the same groups. At least 85 % of the left-out points should lie inside the 90 % band."
            )
        )
    )
    blocks += _left_out(off, t)
    blocks += [
        Paragraph(sentence(note, t), "quiet" if note.severity == "info" else "warning")
        for note in gravest_first(off.notes)
    ]
    blocks += _uncertainty(h, off, t)
    return blocks


def _left_out(off: PredictionReport, t: Language) -> list[Block]:
    if not off.left_out:
        return [Paragraph(t("Cross-validation was not possible."))]
    columns = (
        Column(t("Left out"), "wide"),
        Column(t("Groups"), "number"),
        Column(t("Points"), "number"),
        Column(t("geofit, m"), "number"),
        Column(t("Thin plate, m"), "number"),
        Column(t("Kriging, m"), "number"),
        Column(t("Bias, m"), "number"),
        Column(t("Largest, m"), "number"),
        Column(t("In the 90 % band"), "number"),
        Column(t("Calibration")),
    )
    return [
        Heading(t("Cross-validation and calibration"), 3),
        ReportTable(columns, tuple(_scheme_row(scheme, t) for scheme in off.left_out)),
        Paragraph(t("Errors are root mean squares; the least of the three methods is marked *."), "quiet"),
    ]


def _scheme_row(scheme: LeftOutLine, t: Language) -> tuple[Cell, ...]:
    references = dict(scheme.references)
    errors = [scheme.rms, *(references.get(name) for name in _REFERENCES)]
    known = [error for error in errors if error is not None]
    least = min(known, default=None)
    cells = [digits.metres(e) + (" *" if e is not None and e == least and len(known) > 1 else "") for e in errors]
    if scheme.inside is None:
        calibrated = CheckMark(None, t("not examined"))
    else:
        good = round(scheme.inside, 2) >= LEAST_INSIDE
        calibrated = CheckMark(True, t("passes")) if good else CheckMark(None, "! " + t("below {share}", share="85 %"))
    return (
        translate(_SCHEMES.get(scheme.scheme, scheme.scheme), t),
        digits.count(scheme.groups),
        digits.count(scheme.points),
        *cells,
        digits.metres(scheme.bias),
        digits.metres(scheme.max_abs),
        digits.share(scheme.inside),
        calibrated,
    )


def _uncertainty(h: HorizonReport, off: PredictionReport, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Standard deviation and where to drill next"), 3)]
    name = h.pictures.get("uncertainty")
    if off.sd_mean is None or off.sd_max is None or name is None:
        blocks.append(Paragraph(t("The standard deviation was not examined.")))
    else:
        held = t("calibrates the standard deviation to the left-out errors")
        factor = "–" if off.factor is None else f"× {off.factor:.2f}"
        facts = (
            (t("Mean standard deviation"), digits.length(off.sd_mean), ""),
            (t("Largest standard deviation"), digits.length(off.sd_max), ""),
            (t("Calibration factor"), factor, held),
        )
        caption = t("Standard deviation of the surface. Numbered crosses: suggested holes, in the order of their use.")
        blocks += [Facts(facts), Picture(name, caption)]
    return blocks

"""What a report may be used for, and what not: derived from what was found, in plain words."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.languages import Language, translate
from geofit.data.stale import stale_warning
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, HorizonReport, PredictionReport
from geofit.report.document import Block, Column, Heading, Paragraph, ReportTable

__all__ = ["away_from_data", "limits_of_use"]

#: Names in a sentence; more are counted.
MOST = 6
#: Half of the 90 % band of a normal law, in standard deviations.
HALF = 1.6448536269514722


def away_from_data(report: AccuracyReport, t: Language) -> list[Block]:
    """Lay out, a row a horizon, what to expect where there is no hole; nothing where nothing was examined."""
    known = [(h.name, h.prediction) for h in report.horizons if h.prediction is not None]
    if not known:
        return []
    columns = (
        Column(t("Horizon")),
        Column(t("90 % band, mean, m"), "number"),
        Column(t("90 % band, largest, m"), "number"),
        Column(t("Holes left out: in the band"), "number"),
        Column(t("Suggested boreholes"), "number"),
        Column(t("Outliers"), "number"),
    )
    rows = tuple((name, *_expected(off)) for name, off in known)
    text = t("± half the width of the 90 % band of the surface over the study area; a dash means that it is unknown.")
    return [Heading(t("Away from the data")), ReportTable(columns, rows), Paragraph(text, "quiet")]


def _expected(off: PredictionReport) -> tuple[str, ...]:
    bands = [None if sd is None else HALF * sd for sd in (off.sd_mean, off.sd_max)]
    inside = next((one.inside for one in off.left_out if one.scheme == "hole"), None)
    return (
        *("–" if band is None else f"± {digits.metres(band)}" for band in bands),
        digits.share(inside),
        digits.count(len(off.suggestions)),
        digits.count(len(off.outliers)),
    )


def limits_of_use(report: AccuracyReport, stale: Sequence[str], t: Language) -> list[Block]:
    """Lay out the limits of use of a site's surfaces; ``stale`` names surfaces and bodies older than their data."""
    crs = report.crs or t("not stated")
    sentences = [
        t("Elevations and coordinates are metres in the coordinate system: {crs}.", crs=crs),
        t(
            "The verdict says how well a surface meets its data. Away from the data, use the left-out error and the "
            "90 % band, never σ."
        ),
    ]
    errors = [(h, *_left_out(h)) for h in report.horizons]
    wide: dict[bool, list[str]] = {True: [], False: []}
    for h, scheme, error in errors:
        if error is not None and error > h.epsilon:
            wide[scheme == "hole"].append(t("{name} ({error})", name=h.name, error=digits.length(error)))
    if wide[True]:
        names = _names(wide[True], t)
        sentences.append(t("Between boreholes the typical error exceeds the control error for: {names}.", names=names))
    if wide[False]:
        names = _names(wide[False], t)
        sentences.append(t("Away from the data the typical error exceeds the control error for: {names}.", names=names))
    unknown = [h.name for h, _, error in errors if error is None]
    if unknown:
        sentences.append(t("The error away from the data is unknown for: {names}.", names=_names(unknown, t)))
    if any(check.name == "above ground" and check.value for h in report.horizons for check in h.checks):
        sentences.append(t("Where a surface lies above the ground, the rock has been eroded or excavated."))
    if report.issues.get("error"):
        sentences.append(
            t("{count} rows of the input were not used; they are listed in the annex.", count=report.issues["error"])
        )
    sentences.append(
        t(
            "The report applies to the input files with the checksums in the annex and to the settings listed there; "
            "with other data, fit again."
        )
    )
    if stale:
        sentences.append(translate(stale_warning(stale), t))
    return [Heading(t("Limits of use")), *(Paragraph(f"{i}. {text}") for i, text in enumerate(sentences, 1))]


def _left_out(horizon: HorizonReport) -> tuple[str, float | None]:
    """Return what was left out, and the error there (m): holes, or, without any, the worst of sections and blocks."""
    schemes = () if horizon.prediction is None else horizon.prediction.left_out
    chosen = [one for one in schemes if one.scheme == "hole"] or sorted(schemes, key=lambda one: -one.rms)
    return (chosen[0].scheme, chosen[0].rms) if chosen else ("", None)


def _names(names: list[str], t: Language) -> str:
    shown = names[:MOST]
    text = shown[0]
    for name in shown[1:]:
        text = t("{first}, {second}", first=text, second=name)
    more = len(names) - len(shown)
    return text if not more else t("{names} and {count} more", names=text, count=more)

"""The annex: input files with checksums, rejected rows, programs, and the long tables of every horizon."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import zip_longest
from typing import Any

from geofit.data.languages import Language, sentence, together, translate
from geofit.data.messages import message
from geofit.data.setting_texts import SETTINGS
from geofit.report import digits
from geofit.report.accuracy_report import AccuracyReport, HorizonReport
from geofit.report.checks_table import check_table
from geofit.report.document import Block, Chapter, CheckMark, Column, Heading, Paragraph, ReportTable
from geofit.report.group_tables import doubled, group_blocks
from geofit.report.point_table import point_cells, point_columns

__all__ = ["horizon_annex", "inputs_annex", "setting_value"]

#: Rows of a list in the document; the JSON and the CSV hold all of them.
LONGEST = 40
_FIT = {
    "control_points": message("data.control-points", "Control points"),
    "energy": message("report.bending-energy", "Bending energy"),
    "iterations": message("report.iterations", "Iterations"),
    "order": message("report.derivative-energy", "Derivative in the energy"),
    "noise": message("report.noise", "Noise, m"),
    "spacing": message("report.spacing", "Spacing, m"),
    "noise_limit": message("report.noise-limit", "Largest noise that a point may have, m"),
    "by_hand": message("report.manual-edits", "Manual edits"),
}


def inputs_annex(report: AccuracyReport, t: Language) -> Chapter:
    """Lay out files, rejected rows and programs."""
    return Chapter(t("Annex A: input files and programs"), _dense(_inputs(report, t)), follows=True, listed=False)


def horizon_annex(report: AccuracyReport, t: Language) -> Chapter:
    """Lay out the long tables of every horizon."""
    blocks: list[Block] = []
    for h in report.horizons:
        blocks.append(Heading(t("Horizon {name}", name=h.name)))
        blocks += [*_made(h, t), *group_blocks(h, ("section", "hole", "patch"), t), *_worst(h, t), *_seams(h, t)]
        blocks += _read_back(h, t)
    return Chapter(t("Annex B: tables of the horizons"), _dense(blocks), follows=True, listed=False)


def _dense(blocks: Iterable[Block]) -> tuple[Block, ...]:
    return tuple(replace(block, dense=True) if isinstance(block, ReportTable) else block for block in blocks)


def more(total: int, shown: int, where: str, t: Language) -> list[Block]:
    """Say that a table is longer than what is shown, and where the rest stands; nothing if it is not."""
    if total <= shown:
        return []
    return [Paragraph(t("{file} lists {count} more.", count=total - shown, file=where), "quiet")]


def _inputs(report: AccuracyReport, t: Language) -> list[Block]:
    counts = report.issues
    blocks: list[Block] = [
        Heading(t("Files")),
        Paragraph(t("Rows read = rows used + rows listed. SHA-256 shows whether a file is the one that was read.")),
        ReportTable(
            (
                Column(t("File"), "wide"),
                Column(t("Rows read"), "number"),
                Column(t("Used"), "number"),
                Column(t("Listed"), "number"),
                Column("SHA-256", "hash"),
            ),
            tuple(
                (f.file, digits.count(f.read), digits.count(f.used), digits.count(f.listed), f.sha256 or "–")
                for f in report.inputs
            ),
        ),
        *_fitted_to_others(report, t),
        Heading(t("Rejected rows and warnings")),
        Paragraph(
            t(
                "Rows not used: {errors}; warnings: {warnings}; notes on how files were understood: {notes}. "
                "import_issues.csv lists all of them.",
                errors=counts["error"],
                warnings=counts["warning"],
                notes=counts["note"],
            )
        ),
    ]
    if report.rejected:
        rows = tuple(
            (
                CheckMark(False, t("not used")) if r.severity == "error" else CheckMark(None, t("warning")),
                r.file,
                str(r.row) if r.row else "–",
                r.column or "–",
                r.value or "–",
                together([sentence(r.reason, t), translate(r.remedy, t)], t),
            )
            for r in report.rejected[:LONGEST]
        )
        columns = (
            Column(t("What")),
            Column(t("File"), "wide"),
            Column(t("Row"), "number"),
            Column(t("Column")),
            Column(t("Value")),
            Column(t("Reason and remedy"), "wide"),
        )
        blocks.append(ReportTable(columns, rows))
        blocks += more(len(report.rejected), LONGEST, "import_issues.csv", t)
    blocks.append(Heading(t("Versions")))
    blocks.append(ReportTable((Column(t("Program")), Column(t("Version"))), tuple(report.versions.items())))
    blocks.append(
        Paragraph(
            t(
                "Method: Li, Miao, Liu, Wang (2011), interpolation–approximation fitting of complex "
                "geological surfaces; checks and prediction errors as documented by geofit."
            ),
            "quiet",
        )
    )
    return blocks


def _fitted_to_others(report: AccuracyReport, t: Language) -> list[Block]:
    """Name the horizons that the listed files are not the data of."""
    names = ", ".join(h.name for h in report.horizons if any(one.kind == "data" for one in h.stale))
    text = t(
        "This table lists the current files. These horizons were fitted to earlier data (see their chapters): {names}",
        names=names,
    )
    return [Paragraph(text, "warning")] if names else []


def _worst(h: HorizonReport, t: Language) -> list[Block]:
    columns = (*point_columns(t), Column(t("Patch")), Column(t("d, m"), "number"))
    rows = tuple((*point_cells(p, t), translate(p.patch, t), digits.metres(p.residual)) for p in h.worst)
    return [Heading(t("The {count} largest residuals", count=len(h.worst)), 3), ReportTable(columns, rows)]


def _seams(h: HorizonReport, t: Language) -> list[Block]:
    return [Heading(t("Seams"), 3), _seam_table(h, t) if h.seams else Paragraph(t("One patch: no seams."))]


def _seam_table(h: HorizonReport, t: Language) -> ReportTable:
    """Lay out the seams of the surface, and beside them what the reader found in the file."""
    seams = {(s.first, s.second): s for s in h.seams}
    back = {(s.first, s.second): s for s in (h.read_back.seams if h.read_back else ())}
    columns = (
        Column(t("Seam")),
        Column(t("Largest gap, m"), "number"),
        Column(t("Largest angle, °"), "number"),
        Column(t("Gap in the file, m"), "number"),
        Column(t("Angle in the file, °"), "number"),
    )
    rows = []
    for a, b in dict.fromkeys([*seams, *(pair for pair in back if pair[::-1] not in seams)]):
        found = (seams.get((a, b)), back.get((a, b)) or back.get((b, a)))
        figures = [value for seam in found for value in ((seam.gap, seam.angle) if seam else (None, None))]
        rows.append((f"{translate(a, t)} – {translate(b, t)}", *(digits.metres(value) for value in figures)))
    return ReportTable(columns, tuple(rows))


def _read_back(h: HorizonReport, t: Language) -> list[Block]:
    back = h.read_back
    if back is None:
        return []
    blocks: list[Block] = [Heading(t("Checks of the STEP file, read back"), 3)]
    if back.checks:
        blocks.append(check_table(back.checks, t))
    return [*blocks, Paragraph(f"{back.file}: SHA-256 {back.sha256}", "quiet")]


def _label(key: str, t: Language) -> str:
    return translate(SETTINGS[key].with_unit() if key in SETTINGS else _FIT[key], t)


def setting_value(key: str, value: Any, t: Language) -> str:
    """Return the value of a setting in words; a word may mean something else under another key."""
    choices = SETTINGS[key].choices if key in SETTINGS else {}
    if isinstance(value, (str, bool, type(None))) and value in choices:
        return translate(choices[value], t)
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple):
        return "; ".join(f"{x:.2f} {y:.2f}" for x, y in value)
    return translate(str(value), t)


def _made(h: HorizonReport, t: Language) -> list[Block]:
    settings = [(_label(key, t), setting_value(key, value, t)) for key, value in h.settings.items()]
    figures = [
        (_label(key, t), setting_value(key, value, t)) for key, value in h.fit.items() if key in _FIT or key in SETTINGS
    ]
    patches = tuple(
        (
            translate(p.name, t),
            f"{p.degree[0]} × {p.degree[1]}",
            f"{p.control[0]} × {p.control[1]} = {digits.count(p.control[0] * p.control[1])}",
        )
        for p in h.patches
    )
    blocks: list[Block] = [
        Heading(t("Settings and figures of the fit"), 3),
        ReportTable(
            (
                Column(t("Setting")),
                Column(t("Value"), "wide"),
                Column(t("Figure of the fit")),
                Column(t("Value"), "wide"),
            ),
            tuple((*a, *b) for a, b in zip_longest(settings, figures, fillvalue=("", ""))),
        ),
    ]
    storage = h.storage
    if storage.tin_points and storage.tolerance:
        grid = digits.count(storage.grid_points) if storage.grid_points else t("more than 12 000")
        text = t(
            "To stay within {tolerance} m of this surface, a TIN needs {tin} points, a square grid {grid}; the surface "
            "has {control} control points.",
            tolerance=digits.given(storage.tolerance),
            tin=digits.count(storage.tin_points),
            grid=grid,
            control=digits.count(storage.control_points),
        )
        blocks.append(Paragraph(text))
    table = ReportTable(
        (Column(t("Patch")), Column(t("Degree"), "number"), Column(t("Control points"), "number")), patches
    )
    return [*blocks, doubled(table) if len(patches) > 2 else table]

"""The chapter of one horizon: how far the surface lies from its data, and what holds and what does not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from typing import Literal

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import Message, gravest_first, message
from geofit.report import digits
from geofit.report.accuracy_report import CheckLine, FileCheck, GroupLine, HorizonReport
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    Column,
    Facts,
    Heading,
    Mark,
    Paragraph,
    Picture,
    Table,
    Verdict,
)
from geofit.report.off_data_blocks import off_data_blocks
from geofit.report.point_table import point_cells, point_columns

__all__ = ["horizon_chapter"]

#: Holes and sections beyond this number are in the JSON only, the largest residual first here.
LONGEST_GROUPS = 20
#: Of the places where a check does not hold, so many are named.
MOST_PLACES = 3
#: Longer tables of groups stand in two halves side by side.
LONGEST_SINGLE = 6
_GROUPS = {
    "kind": (message("report.by-kind", "By kind of source"), message("report.kind", "Kind of source")),
    "section": (message("report.by-section", "By section"), message("report.section", "Section")),
    "hole": (message("report.by-hole", "By hole"), message("report.hole", "Hole")),
    "patch": (message("report.by-patch", "By patch"), message("report.patch", "Patch")),
}
_SETTINGS = {
    "epsilon": message("report.control-error", "Control error ε, m"),
    "interior_tolerance": message("report.interior-tolerance", "Interior tolerance, m"),
    "boundary_tolerance": message("report.boundary-tolerance", "Boundary tolerance, m"),
    "across": message("report.interpolation-across-sections", "Interpolation across the sections"),
    "seam": message("report.seams", "Seams"),
    "core": message("report.core", "Core"),
    "frame": message("report.frame", "Frame"),
    "smoothing": message("report.smoothing", "Smoothing"),
    "robust": message("report.outliers-take-no-part", "Outliers take no part"),
    "strict": message("report.strict", "Every point is met where knots allow"),
    "max_iterations": message("report.max-iterations", "Most iterations"),
    "max_control_points": message("report.max-control-points", "Most control points"),
    "conflict_distance": message("report.conflict-distance", "Conflict distance, m"),
}
_FIT = {
    "control_points": message("report.control-points", "Control points"),
    "energy": message("report.bending-energy", "Bending energy"),
    "smoothing": message("report.smoothing", "Smoothing"),
    "iterations": message("report.iterations", "Iterations"),
    "frame": message("report.frame", "Frame"),
    "order": message("report.derivative-energy", "Derivative in the energy"),
    "across": message("report.interpolation-across-sections", "Interpolation across the sections"),
    "noise": message("report.noise", "Noise, m"),
    "spacing": message("report.spacing", "Spacing, m"),
    "rounds": message("report.rounds", "Rounds"),
}


def horizon_chapter(h: HorizonReport, t: Language, missing_picture: Message | None = None) -> Chapter:
    """Lay out everything about one horizon."""
    blocks: list[Block] = [
        Paragraph(_sentence(h, t)),
        _facts(h, t),
        *_notes(h, t),
        *_pictures(h, t, missing_picture),
        *_deviations(h, t),
        *_groups(h, t),
        *_worst(h, t),
        *_checked(h, t),
        *_read_back(h.read_back, t),
        *off_data_blocks(h, t),
        *_conflicts(h, t),
        *_made(h, t),
    ]
    passed = h.verdict == "PASS"
    return Chapter(t("Horizon {name}", name=h.name), tuple(blocks), Verdict(passed, t("PASS") if passed else t("FAIL")))


def _sentence(h: HorizonReport, t: Language) -> str:
    sigma, epsilon = digits.equals(h.sigma), digits.given(h.epsilon)
    if h.verdict != "PASS" and h.sigma < h.epsilon:
        return t("The surface runs far beyond the elevations of its data: see below.")
    if h.verdict != "PASS":
        return t("σ {sigma} is not below the control error ε = {epsilon} m.", sigma=sigma, epsilon=epsilon)
    text = t("σ {sigma} is below the control error ε = {epsilon} m.", sigma=sigma, epsilon=epsilon)
    if not h.sound:
        text += " " + t("But a check does not hold: see below.")
    return text


def _facts(h: HorizonReport, t: Language) -> Facts:
    share, limit = digits.share(h.within_interior), digits.given(h.tolerances[1])
    within = t("{share} within {limit} m", share=share, limit=limit) if h.n_periphery else t("no points")
    points = t("{core} core, {periphery} periphery", core=digits.count(h.n_core), periphery=digits.count(h.n_periphery))
    return Facts(
        (
            (t("σ over all points"), digits.length(h.sigma), f"ε = {digits.given(h.epsilon)} m"),
            (t("Largest |d|"), digits.length(h.max_abs), t("mean d {mean}", mean=digits.length(h.mean))),
            (t("Points"), digits.count(h.n), points),
            (t("Core, largest |d|"), digits.length(h.core_max_abs), t("interpolated")),
            (t("Periphery, σ"), digits.length(h.periphery_sigma), within),
            (t("Control points"), digits.count(h.control_points), t("patches: {count}", count=len(h.patches))),
        )
    )


def _notes(h: HorizonReport, t: Language) -> list[Block]:
    core: list[Block] = []
    if h.reason:
        core = [Paragraph(sentence(t("Core: {reason}", reason=h.reason), t), _style(h.reason))]
    return [*core, *(Paragraph(sentence(note, t), _style(note)) for note in gravest_first(h.notes))]


def _style(note: Message) -> Literal["plain", "warning"]:
    return "plain" if note.severity == "info" else "warning"


def _pictures(h: HorizonReport, t: Language, missing_picture: Message | None) -> list[Block]:
    pictures = dict(h.pictures)
    blocks: list[Block] = [Heading(t("The surface"))]
    if missing_picture:
        blocks.append(Paragraph(translate(missing_picture, t), "warning"))
    else:
        caption = t("Dots: data points. Thick line: edge of the core. Thin lines: contours.")
        blocks.append(Picture(pictures["view"], caption))
    caption = t("Site plan: points by kind of source, holes, core, patches of the periphery, study area.")
    blocks.append(Picture(pictures["plan"], caption))
    return blocks


def _deviations(h: HorizonReport, t: Language) -> list[Block]:
    pictures = dict(h.pictures)
    boundary, interior, control = (digits.given(value) for value in h.tolerances)
    rows = tuple(
        (_bound(name, over.limit, t), digits.count(over.count), digits.share(over.count / max(h.n, 1)))
        for name, over in h.over
    )
    bands = t(
        "Bands end at the tolerances of this fit: boundary {boundary} m, interior {interior} m, control error "
        "{control} m. Triangles point to where the point lies: ▲ above the surface, ▼ below.",
        boundary=boundary,
        interior=interior,
        control=control,
    )
    return [
        Heading(t("Residuals at the data")),
        Picture(pictures["deviation"], bands),
        Picture(
            pictures["residuals"],
            t("Left: residuals of the points that are not interpolated. Right: the same against a normal law."),
        ),
        Table((Column(t("Points beyond")), Column(t("Count"), "number"), Column(t("Share"), "number")), rows),
    ]


def _bound(name: str, limit: float, t: Language) -> str:
    """Return a tolerance with its value and unit."""
    if name == "epsilon":
        return t("control error ε {value:g} m", value=limit)
    return t("interior tolerance {value:g} m", value=limit)


def _groups(h: HorizonReport, t: Language) -> list[Block]:
    blocks: list[Block] = []
    for by, (title, word) in _GROUPS.items():
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
        table = Table(columns, tuple(_group_row(group, t) for group in shown))
        blocks += [Heading(translate(title, t), 3), _doubled(table) if len(shown) > LONGEST_SINGLE else table]
        if len(rows) > LONGEST_GROUPS:
            text = t(
                "The {shown} with the largest residuals; {count} more stand in report.json.",
                shown=LONGEST_GROUPS,
                count=len(rows) - LONGEST_GROUPS,
            )
            blocks.append(Paragraph(text, "quiet"))
    return blocks


def _doubled(table: Table) -> Table:
    """Put the second half of a long, narrow table beside its first."""
    half = (len(table.rows) + 1) // 2
    empty = ("",) * len(table.columns)
    rows = zip_longest(table.rows[:half], table.rows[half:], fillvalue=empty)
    return Table((*table.columns, Column(""), *table.columns), tuple((*a, "", *b) for a, b in rows))


def _group_row(group: GroupLine, t: Language) -> tuple[Cell, ...]:
    name = translate(group.name, t) if group.by in ("kind", "patch") else group.name
    figures = (digits.metres(value) for value in (group.sigma, group.max_abs, group.mean))
    return (name, digits.count(group.n), *figures)


def _worst(h: HorizonReport, t: Language) -> list[Block]:
    columns = (*point_columns(t), Column(t("Patch")), Column(t("d, m"), "number"))
    rows = tuple((*point_cells(p, t), translate(p.patch, t), digits.metres(p.residual)) for p in h.worst)
    return [Heading(t("The {count} largest residuals", count=len(h.worst)), 3), Table(columns, rows)]


def _checked(h: HorizonReport, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Checks of the surface"))]
    blocks.append(_check_table(h.checks, t) if h.checks else Paragraph(t("Not examined.")))
    blocks.append(Heading(t("Seams"), 3))
    blocks.append(_seam_table(h, t) if h.seams else Paragraph(t("One patch: no seams.")))
    return blocks


def _check_table(checks: Sequence[CheckLine], t: Language) -> Table:
    columns = (
        Column(t("Question")),
        Column(t("Answer")),
        Column(t("Value"), "number"),
        Column(t("Limit"), "number"),
        Column(t("Detail"), "wide"),
    )
    words = {True: t("holds"), False: t("does not hold"), None: t("not applicable")}
    rows = tuple(
        (
            translate(c.name, t),
            Mark(c.passed, words[c.passed]),
            digits.measured(c.value, translate(c.unit, t)),
            digits.measured(c.limit, translate(c.unit, t)),
            _detail(c, t),
        )
        for c in checks
    )
    return Table(columns, rows)


def _detail(check: CheckLine, t: Language) -> str:
    """Return what a check says, and, where it does not hold, the worst places."""
    text = sentence(check.text, t)
    if check.passed is not False or not check.places:
        return text
    places = "; ".join(f"({', '.join(digits.place(value) for value in p)})" for p in check.places[:MOST_PLACES])
    worst = t("Worst at {places} m.", places=places)
    return f"{text} {worst}"


def _seam_table(h: HorizonReport, t: Language) -> Table:
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
    return Table(columns, tuple(rows))


def _read_back(back: FileCheck | None, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("The STEP file, read back"))]
    if back is None:
        return [*blocks, Paragraph(t("Not examined: no STEP file was written."))]
    valid = t("valid") if back.valid else t("NOT VALID")
    crossing = t("FOUND") if back.self_intersects else t("none")
    free = t("{count} on the outline", count=back.outline_edges)
    facts = (
        (t("Faces"), digits.count(back.faces), valid),
        ("σ", digits.length(back.sigma), t("largest |d| {value}", value=digits.length(back.max_abs))),
        (t("Core, largest |d|"), digits.length(back.core_max_abs), t("by projection")),
        (t("Free edges"), digits.count(back.free_edges), free),
        (t("Edge tolerance"), digits.length(back.edge_tolerance), ""),
        (t("Self-intersection"), crossing, digits.size(back.bytes) if back.bytes else ""),
    )
    blocks += [
        Paragraph(t("{file} was read back by OpenCASCADE and measured again.", file=back.file)),
        Facts(facts),
    ]
    if back.checks:
        blocks.append(_check_table(back.checks, t))
    blocks.append(Paragraph(f"SHA-256 {back.sha256}", "quiet"))
    return blocks


def _conflicts(h: HorizonReport, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Points that contradict each other"))]
    if not h.conflicts:
        return [*blocks, Paragraph(t("None."))]
    columns = (
        Column(t("Kept"), "wide"),
        Column(t("Gave way"), "wide"),
        Column(t("Difference, m"), "number"),
        Column(t("Why"), "wide"),
    )
    rows = tuple(
        (translate(c.kept, t), translate(c.dropped, t), digits.metres(c.difference), translate(c.text, t))
        for c in h.conflicts
    )
    return [*blocks, Table(columns, rows)]


def _value(key: str, value: str, t: Language) -> str:
    """Return the value of a setting; a map is a kind of source, too, and is another word then."""
    return t("the map") if (key, value) == ("frame", "map") else translate(value, t)


def _made(h: HorizonReport, t: Language) -> list[Block]:
    settings = [(translate(_SETTINGS.get(key, key), t), _value(key, value, t)) for key, value in h.settings]
    figures = [(translate(_FIT.get(key, key), t), _value(key, value, t)) for key, value in h.fit]
    patches = tuple(
        (
            translate(p.name, t),
            f"{p.degree[0]} × {p.degree[1]}",
            f"{p.control[0]} × {p.control[1]} = {digits.count(p.control[0] * p.control[1])}",
        )
        for p in h.patches
    )
    blocks: list[Block] = [
        Heading(t("How it was made")),
        Table(
            (
                Column(t("Setting")),
                Column(t("Value"), "wide"),
                Column(t("Figure of the fit")),
                Column(t("Value"), "wide"),
            ),
            tuple((*a, *b) for a, b in zip_longest(settings, figures, fillvalue=("", ""))),
        ),
    ]
    if h.tin_points and h.equal_accuracy:
        grid = digits.count(h.grid_points) if h.grid_points else t("more than 12 000")
        text = t(
            "To stay within {tolerance} m of this surface, a TIN needs {tin} points, a square grid {grid}; the surface "
            "has {control} control points.",
            tolerance=digits.given(h.equal_accuracy),
            tin=digits.count(h.tin_points),
            grid=grid,
            control=digits.count(h.control_points),
        )
        blocks.append(Paragraph(text))
    table = Table((Column(t("Patch")), Column(t("Degree"), "number"), Column(t("Control points"), "number")), patches)
    return [*blocks, _doubled(table) if len(patches) > 2 else table]

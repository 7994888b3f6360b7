"""The chapter of one horizon: how far the surface lies from its data, and what holds and what does not."""

from __future__ import annotations

from typing import Literal

from geofit.data.languages import Language, sentence, together, translate
from geofit.data.messages import Message, gravest_first
from geofit.report import digits
from geofit.report.accuracy_report import FileCheck, HorizonReport
from geofit.report.change_blocks import change_blocks
from geofit.report.chapter_head import lamps_paragraph, verdict_badge
from geofit.report.checks_table import check_table
from geofit.report.contour_plan import plan_caption
from geofit.report.dip_blocks import dip_blocks
from geofit.report.document import (
    Block,
    Chapter,
    Column,
    Facts,
    Heading,
    Paragraph,
    Picture,
    ReportTable,
)
from geofit.report.group_tables import group_blocks
from geofit.report.prediction_blocks import prediction_blocks
from geofit.report.stale_blocks import stale_blocks

__all__ = ["horizon_chapter"]


def horizon_chapter(h: HorizonReport, t: Language, missing_picture: Message | None = None) -> Chapter:
    """Lay out everything about one horizon."""
    blocks: list[Block] = [
        *stale_blocks(h.name, h.stale, t),
        lamps_paragraph(h.lamps, t),
        _facts(h, t),
        *_notes(h, t),
        *_plan(h, t),
        *group_blocks(h, ("kind",), t),
        *_view(h, t, missing_picture),
        *_deviations(h, t),
        *_checked(h, t),
        *dip_blocks(h, t),
        *_read_back(h.read_back, t),
        *prediction_blocks(h, t),
        *change_blocks(h.change, h.pictures.get("change", ""), t),
    ]
    return Chapter(t("Horizon {name}", name=h.name), tuple(blocks), verdict_badge(h.verdict, t, stale=bool(h.stale)))


def _facts(h: HorizonReport, t: Language) -> Facts:
    share, limit = (
        digits.share(h.periphery.share_within_interior_tolerance),
        digits.given(h.settings["interior_tolerance"]),
    )
    within = t("{share} within {limit} m", share=share, limit=limit) if h.n_periphery else t("no points")
    points = t("{core} core, {periphery} periphery", core=digits.count(h.n_core), periphery=digits.count(h.n_periphery))
    return Facts(
        (
            (t("σ over all points"), digits.length(h.sigma), f"ε = {digits.given(h.epsilon)} m"),
            (t("Largest |d|"), digits.length(h.max_abs), t("mean d {mean}", mean=digits.length(h.mean))),
            (t("Points"), digits.count(h.n_points), points),
            (t("Core, largest |d|"), digits.length(h.core.max_abs), t("interpolated")),
            (t("Periphery, σ"), digits.length(h.periphery.sigma), within),
            (t("Control points"), digits.count(h.storage.control_points), t("patches: {count}", count=len(h.patches))),
        )
    )


def _notes(h: HorizonReport, t: Language) -> list[Block]:
    core: list[Block] = []
    if h.reason:
        core = [Paragraph(sentence(t("Core: {reason}", reason=h.reason), t), _style(h.reason))]
    return [*core, *(Paragraph(sentence(note, t), _style(note)) for note in gravest_first(h.notes))]


def _style(note: Message) -> Literal["plain", "warning"]:
    return "plain" if note.severity == "info" else "warning"


def _plan(h: HorizonReport, t: Language) -> list[Block]:
    """Lay out the contour plan; of a folded surface, whose contours would cross, the site plan."""
    name = h.pictures["plan"]
    if h.plan is not None:
        return [Heading(t("The surface")), Picture(name, plan_caption(h.name, h.plan, t), to_scale=True)]
    folded = t("The surface is folded over: its contours in plan would cross. See the geological sections.")
    caption = t("Site plan: points by kind of source, holes, core, patches of the periphery, study area.")
    return [Heading(t("The surface")), Paragraph(folded, "quiet"), Picture(name, caption)]


def _view(h: HorizonReport, t: Language, missing_picture: Message | None) -> list[Block]:
    if missing_picture:
        return [Paragraph(translate(missing_picture, t), "warning")]
    caption = t("Dots: data points. Thick line: edge of the core. Thin lines: contours.")
    return [Picture(h.pictures["view"], caption)]


def _deviations(h: HorizonReport, t: Language) -> list[Block]:
    pictures = h.pictures
    boundary, interior, control = (
        digits.given(h.settings[key]) for key in ("boundary_tolerance", "interior_tolerance", "epsilon")
    )
    rows = tuple(
        (_bound(name, over.limit, t), digits.count(over.count), digits.share(over.count / max(h.n_points, 1)))
        for name, over in h.over.items()
    )
    bands = t(
        "Bands end at the tolerances of this fit: boundary {boundary} m, interior {interior} m, control error "
        "{control} m. Triangles point to where the point lies: ▲ above the surface, ▼ below.",
        boundary=boundary,
        interior=interior,
        control=control,
    )
    law = t("Left: residuals of the points that are not interpolated. Right: their normal probability plot.")
    return [
        Heading(t("Residuals at the data")),
        Picture(pictures["deviation"], bands),
        ReportTable((Column(t("Points beyond")), Column(t("Count"), "number"), Column(t("Share"), "number")), rows),
        *([Picture(pictures["residuals"], law)] if "residuals" in pictures else []),
    ]


def _bound(name: str, limit: float, t: Language) -> str:
    """Return a tolerance with its value and unit."""
    if name == "epsilon":
        return t("control error ε {value:g} m", value=limit)
    return t("interior tolerance {value:g} m", value=limit)


def _checked(h: HorizonReport, t: Language) -> list[Block]:
    found = check_table(h.checks, t) if h.checks else Paragraph(t("Not examined."))
    return [Heading(t("Checks of the surface")), found]


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
        (t("Self-intersection"), crossing, digits.kilobytes(back.bytes) if back.bytes else ""),
    )
    text = t("{file} was read back by OpenCASCADE and measured again.", file=back.file)
    failed = [check for check in back.checks if check.passed is False]
    held = sum(check.passed is True for check in back.checks)
    verdict = (
        t("{count} of its checks failed.", count=len(failed))
        if failed
        else t("All {count} checks of the file passed.", count=held)
    )
    blocks += [Paragraph(together([text, verdict if back.checks else ""], t)), Facts(facts)]
    return [*blocks, check_table(failed, t)] if failed else blocks

"""The chapter of a survey of passages: drawings, loop closure, volume, strata, excavation, missing walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geofit.data.languages import Language, sentence, translate
from geofit.report import digits
from geofit.report.annex import more
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    CheckMark,
    Column,
    Facts,
    Heading,
    Paragraph,
    Picture,
    ReportTable,
)
from geofit.report.furniture import scale_text

if TYPE_CHECKING:
    from geofit.caves.body import PassageBody
    from geofit.caves.clearance import Clearance
    from geofit.caves.strata import Stratum
    from geofit.caves.uncertainty import VolumeEstimate
    from geofit.data.messages import Message

__all__ = ["CaveFindings", "cave_chapter", "cave_picture"]

#: Rows of a table at most; the tables beside the report have all.
LONGEST = 60
#: Stations that name a loop.
NAMED = 6
_GAP = "\N{NO-BREAK SPACE}"


@dataclass(frozen=True, eq=False)
class CaveFindings:
    """Everything that a chapter says of passages.

    ``spacing`` is that of their triangles, metres, and ``mesh_volume`` the volume within them; ``scale`` that of the
    drawings, one to so many; ``azimuth`` that of the plane of the long section, degrees; ``pictures`` those that were
    drawn; ``stem`` the name of the tables; ``uncorrected`` warns of shots without a correction.
    """

    name: str
    body: PassageBody
    volume: VolumeEstimate
    spacing: float
    mesh_volume: float
    strata: tuple[Stratum, ...] = ()
    clearance: Clearance | None = None
    scale: int = 0
    azimuth: float = 0.0
    pictures: tuple[str, ...] = ()
    stem: str = ""
    uncorrected: tuple[Message, ...] = ()


def cave_picture(what: str, name: str) -> str:
    """Return the name by which a report speaks of a drawing of passages."""
    return f"cave/{what}/{name}"


def cave_chapter(found: CaveFindings, t: Language) -> Chapter:
    """Lay out everything about one survey."""
    warnings = [Paragraph(sentence(one, t), "warning") for one in found.uncorrected]
    blocks: list[Block] = [_facts(found, t), *warnings, *_drawings(found, t), *_loops(found, t), *_volume(found, t)]
    blocks += [*_strata(found, t), *_clearance(found, t), *_data(found, t), *_method(found, t)]
    blocks += _walls(found, t)  # last, for its table can fill pages
    return Chapter(t("Passages of {name}", name=found.name), tuple(blocks))


def _facts(found: CaveFindings, t: Language) -> Facts:
    adjusted = found.body.adjusted
    survey, sections = adjusted.survey, found.body.sections
    used = np.unique([survey.start[sections.shot], survey.end[sections.shot]])
    tall = float(np.ptp(adjusted.xyz[used, 2]))
    loops = adjusted.loops
    checked = sum(loop.suspicious for loop in loops)
    return Facts(
        (
            (t("Surveyed length"), f"{digits.count(survey.length)}{_GAP}m", t("shots that count")),
            (t("Stations"), digits.count(len(survey.stations)), t("{count} shots", count=len(survey.start))),
            (t("Vertical extent"), f"{tall:.1f}{_GAP}m", t("lowest to highest station")),
            (t("Volume"), digits.volume(found.volume.volume), f"±{_GAP}{digits.volume(found.volume.sigma)}"),
            (t("Loops"), str(len(loops)), t("{count} to be checked", count=checked)),
            (
                t("Missing walls"),
                digits.count(len(sections.filled)),
                t(
                    "of {count}",
                    count=digits.count(4 * len({*survey.start[sections.shot], *survey.end[sections.shot]})),
                ),
            ),
        )
    )


def _drawings(found: CaveFindings, t: Language) -> list[Block]:
    scale = scale_text(found.scale)
    captions = {
        "plan": t("Plan of the passages, scale {scale} on A4 at 100 %.", scale=scale),
        "section": t(
            "Long section: the passages projected onto a vertical plane, from azimuth {back}° (left) to {azimuth}° "
            "(right); scale {scale} on A4 at 100 %, heights not exaggerated.",
            azimuth=f"{found.azimuth:03.0f}",
            back=f"{found.azimuth + 180:03.0f}",
            scale=scale,
        ),
    }
    shown = [what for what in captions if what in found.pictures]
    drawn = [Picture(cave_picture(what, found.name), captions[what], to_scale=True) for what in shown]
    return [Heading(t("Plan and long section")), *drawn] if drawn else []


def _loops(found: CaveFindings, t: Language) -> list[Block]:
    adjusted = found.body.adjusted
    loops = adjusted.loops
    blocks: list[Block] = [Heading(t("Loop closure"))]
    if not loops and len(adjusted.anchors) == len(adjusted.survey.stations):
        return [*blocks, Paragraph(t("Stations were given by coordinates; no loop checks them."))]
    if not loops:
        text = t("The survey has no loop: nothing checks its shots, and a blunder would stay unseen.")
        return [*blocks, Paragraph(text, "warning")]
    columns = (
        Column(t("Loop"), "wide"),
        Column(t("Shots"), "number"),
        Column(t("Length, m"), "number"),
        Column(t("Misclosure, m"), "number"),
        Column(t("East, north, up, m"), "number"),
        Column(t("Share, %"), "number"),
        Column(t("Expected, m"), "number"),
        Column(t("Result")),
    )
    rows: list[tuple[Cell, ...]] = []
    for loop in loops[:LONGEST]:
        mark = CheckMark(False, t("to be checked")) if loop.suspicious else CheckMark(True, t("closes"))
        names = list(loop.stations[:NAMED]) + ["…"] * (len(loop.stations) > NAMED)
        parts = " ".join(f"{value:.2f}".replace("-", "−") for value in loop.misclosure)
        figures = (f"{loop.length:.1f}", f"{loop.distance:.2f}", parts, f"{loop.percent:.2f}", f"{loop.expected:.2f}")
        rows.append((" ".join(names), str(len(loop.stations)), *figures, mark))
    text = t(
        "Misclosures are spread over the shots by least squares. The expected one is the standard deviation from the "
        "errors of tape, compass and clinometer; check a loop for a blunder if its misclosure exceeds three times that."
    )
    return [
        *blocks,
        Paragraph(text),
        ReportTable(columns, tuple(rows)),
        *more(len(loops), LONGEST, f"{found.stem}_loops.csv", t),
    ]


def _volume(found: CaveFindings, t: Language) -> list[Block]:
    v = found.volume
    rows = (
        (t("volume"), digits.volume(v.volume)),
        (t("standard deviation"), digits.volume(v.sigma)),
        (t("part of it from measured walls"), digits.volume(v.walls)),
        (t("part of it from missing walls"), digits.volume(v.missing)),
        (t("part of it from shot lengths"), digits.volume(v.survey)),
        ("P10", digits.volume(v.p10)),
        ("P90", digits.volume(v.p90)),
    )
    text = t(
        "Overlapping passages count once. The true volume is below P10 with a probability of 10 %, and below P90 "
        "with 90 %."
    )
    blocks: list[Block] = [Heading(t("Volume")), ReportTable((Column(t("Figure")), Column(t("Value"), "number")), rows)]
    blocks.append(Paragraph(text, "quiet"))
    thin = found.body.thinner_than(found.spacing)
    if thin:
        some = ", ".join(f"{a}–{b}" for a, b in thin[:NAMED]) + (", …" if len(thin) > NAMED else "")
        text = t(
            "{count} shots are thinner than the spacing of the triangles, {spacing}; the files of the surface may lose "
            "parts of them: {shots}. The volume has them.",
            count=len(thin),
            spacing=digits.length(found.spacing),
            shots=some,
        )
        blocks.append(Paragraph(text, "quiet"))
    return blocks


def _strata(found: CaveFindings, t: Language) -> list[Block]:
    if not found.strata:
        return []
    length, volume = (sum(getattr(part, what) for part in found.strata) for what in ("length", "volume"))
    columns = (Column(t("Stratum")), Column(t("Length, m"), "number"), Column(t("Volume, m³"), "number"))
    rows = [
        (_stratum(part.top, part.base, part.known, t), f"{part.length:.1f}", digits.count(part.volume))
        for part in found.strata
        if part.known or part.volume > 0 or part.length > 0
    ]
    rows.append((t("sum"), f"{length:.1f}", digits.count(volume)))
    return [Heading(t("Strata")), ReportTable(columns, tuple(rows))]


def _stratum(top: str, base: str, known: bool, t: Language) -> str:
    if not known:
        return t("where a horizon has no height")
    if top and base:
        return t("{top} to {base}", top=top, base=base)
    return t("above {horizon}", horizon=base) if base else t("below {horizon}", horizon=top)


def _clearance(found: CaveFindings, t: Language) -> list[Block]:
    away = found.clearance
    if away is None:
        return []
    n = away.nearest
    rows = (
        (t("least distance to a wall"), f"{digits.length(away.least)} ±{_GAP}{digits.length(float(away.sigma[n]))}"),
        (t("point of the excavation"), ", ".join(digits.place(value) for value in away.points[n])),
        (t("point of the wall"), ", ".join(digits.place(value) for value in away.wall[n])),
        (t("nearest station"), away.station[n]),
    )
    blocks: list[Block] = [
        Heading(t("Planned excavation")),
        ReportTable((Column(t("Figure")), Column(t("Value"), "number")), rows),
    ]
    if away.least < 0:
        blocks.append(Paragraph(t("The excavation meets a passage."), "warning"))
    return blocks


def _walls(found: CaveFindings, t: Language) -> list[Block]:
    filled = found.body.sections.filled
    blocks: list[Block] = [Heading(t("Missing walls"))]
    if not filled:
        return [*blocks, Paragraph(t("Every wall was measured."))]
    by_station: dict[str, dict[str, float]] = {}
    for wall in filled:
        by_station.setdefault(wall.station, {})[wall.wall] = wall.distance
    columns = (
        Column(t("Station")),
        Column(t("Left, m"), "number"),
        Column(t("Right, m"), "number"),
        Column(t("Up, m"), "number"),
        Column(t("Down, m"), "number"),
    )
    rows = tuple(
        (station, *(f"{walls[wall]:.2f}" if wall in walls else "" for wall in ("left", "right", "up", "down")))
        for station, walls in list(by_station.items())[:LONGEST]
    )
    text = t(
        "These walls were not measured. They are interpolated along the passages between measured ones, and count in "
        "the volume with an error of their own. An empty cell was measured."
    )
    return [
        *blocks,
        Paragraph(text),
        ReportTable(columns, rows, dense=True),
        *more(len(by_station), LONGEST, f"{found.stem}_filled_walls.csv", t),
    ]


def _data(found: CaveFindings, t: Language) -> list[Block]:
    survey = found.body.adjusted.survey
    if not (survey.counts or survey.issues):
        return []
    blocks: list[Block] = [Heading(t("Files"))]
    if survey.counts:
        head = (
            Column(t("File"), "wide"),
            Column(t("Rows read"), "number"),
            Column(t("Used"), "number"),
            Column(t("Listed"), "number"),
        )
        read = tuple(
            (c.file, digits.count(c.read), digits.count(c.used), digits.count(c.listed)) for c in survey.counts
        )
        blocks.append(ReportTable(head, read))
    if survey.issues:
        marks = {"error": CheckMark(False, t("not used")), "warning": CheckMark(None, t("warning"))}
        rows: tuple[tuple[Cell, ...], ...] = tuple(
            (
                marks.get(one.severity, CheckMark(None, t("note"))),
                str(one.row) if one.row else "–",
                one.value or "–",
                sentence(one.reason, t) + (" " + translate(one.remedy, t) if one.remedy else ""),
            )
            for one in survey.issues[:LONGEST]
        )
        columns = (
            Column(t("What")),
            Column(t("Row"), "number"),
            Column(t("Value")),
            Column(t("Reason and remedy"), "wide"),
        )
        blocks.append(ReportTable(columns, rows))
        if len(survey.issues) > LONGEST:
            text = t("{count} more were listed when the file was read.", count=len(survey.issues) - LONGEST)
            blocks.append(Paragraph(text, "quiet"))
    return blocks


def _method(found: CaveFindings, t: Language) -> list[Block]:
    rows = (
        (
            t("cross-sections"),
            t("four quarter ellipses through left, right, upper and lower wall, tapered between stations"),
        ),
        (t("radius of the smooth union at junctions"), digits.length(found.body.blend)),
        (t("spacing of the triangles"), digits.length(found.spacing)),
        (t("volume of the triangles"), digits.volume(found.mesh_volume)),
    )
    return [Heading(t("Settings")), ReportTable((Column(t("Setting")), Column(t("Value"), "wide")), rows)]

"""The chapter of a rock volume: before and after, sizes of pores and throats, representative volume, percolation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import Language, sentence, translate
from geofit.data.messages import message
from geofit.report import digits
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

if TYPE_CHECKING:
    from geofit.data.messages import Message
    from geofit.pores.network import PoreNetwork
    from geofit.pores.representative import RepresentativeVolume
    from geofit.pores.table import BeforeAfter, PoreFigures
    from geofit.pores.volume import RockVolume

__all__ = ["PoresFindings", "pores_chapter", "pores_picture", "settling_sentence"]

#: Square metres of a millidarcy.
MILLIDARCY = 9.869233e-16
#: Values that are code, in words.
_VALUES = {
    "merge-tree": message("report.value-merge-tree", "merge tree"),
    "paper": message("report.value-paper", "hierarchy of the article"),
    "open": message("report.value-open", "pores go on beyond the border"),
    "closed": message("report.value-closed", "the border is rock"),
}
#: Percentiles of sizes that the table shows.
SHARES = (10, 50, 90)


@dataclass(frozen=True, eq=False)
class PoresFindings:
    """Everything that a chapter says of a rock volume; ``balls`` counts its maximal balls.

    ``surface_note`` says by how much the volume within the triangles differs from that of the voxels, if it is much.
    """

    name: str
    volume: RockVolume
    balls: int
    network: PoreNetwork
    table: BeforeAfter
    settling: RepresentativeVolume
    surface_note: Message | None = None
    pictures: tuple[str, ...] = ()


def pores_picture(what: str, name: str) -> str:
    """Return the name by which a report speaks of a picture of a rock volume."""
    return f"pores/{what}/{name}"


def pores_chapter(found: PoresFindings, t: Language) -> Chapter:
    """Lay out everything about one rock volume."""
    blocks: list[Block] = [_facts(found, t), *_views(found, t), *_table(found, t)]
    blocks += [*_percolation(found, t), *_sizes(found, t), *_settling(found, t), *_made(found, t)]
    return Chapter(t("Rock volume {name}", name=found.name), tuple(blocks))


def _facts(found: PoresFindings, t: Language) -> Facts:
    network, volume = found.network, found.volume
    size = " × ".join(f"{edge * 1e3:.3g}" for edge in volume.size)
    mean = f"{network.coordination.mean():.2f}" if len(network.pores) else "–"
    voxels = " × ".join(str(count) for count in volume.shape)
    return Facts(
        (
            (t("Sample"), f"{size}\N{NO-BREAK SPACE}mm", t("{voxels} voxels", voxels=voxels)),
            (t("Porosity"), digits.share(volume.porosity), ""),
            (t("Maximal balls"), digits.count(found.balls), t("their union is the pore space")),
            (t("Pores"), digits.count(len(network.pores)), t("{count} left out", count=len(network.dropped))),
            (t("Throats"), digits.count(len(network.throats)), ""),
            (t("Mean coordination"), mean, t("throats of a pore")),
        )
    )


def _views(found: PoresFindings, t: Language) -> list[Block]:
    captions = {
        "slices": t("Slices through the middle of the sample: pores dark, rock light."),
        "surface": t("The rebuilt surface of the pores."),
        "network": t(
            "The network: a ball for each pore, 0.6 times its size, coloured by its radius; lines are throats."
        ),
    }
    shown = [Picture(pores_picture(what, found.name), captions[what]) for what in captions if what in found.pictures]
    return [Heading(t("The pore space")), *shown] if shown else []


def _table(found: PoresFindings, t: Language) -> list[Block]:
    before, after = (_column(figures, t) for figures in (found.table.before, found.table.after))
    head = (
        Column(t("Figure")),
        Column(t("Voxels"), "number"),
        Column(t("Rebuilt"), "number"),
        Column(t("Relative change"), "number"),
    )
    porosity, inside = found.volume.porosity, found.table.triangles
    rows = [(name, shown, after[name][0], _change(value, after[name][1])) for name, (shown, value) in before.items()]
    within = t("porosity by the triangles of the surface"), "–", digits.share(inside), _change(porosity, inside)
    rows.insert(1, within)
    counted = t(
        "Rebuilt: of the voxels whose middle lies within the smooth surface. The files of the surface have its "
        "triangles; the porosity by the volume within them has a row of its own."
    )
    note = t(
        "Kozeny's permeability is an upper bound: it ignores how the pores are connected. At the same grain size, its "
        "ratio after to before is {ratio}. Pores that no face of the sample reaches, {dropped} of the sample, are left "
        "out of the network; the smooth surface changes the porosity of the rest by {smoothing} percentage points.",
        ratio=f"{found.table.kozeny_ratio:.3f}",
        dropped=digits.share(found.table.dropped),
        smoothing=f"{100 * found.table.smoothing:+.1f}".replace("-", "−"),
    )
    warning = () if found.surface_note is None else (Paragraph(sentence(found.surface_note, t), "warning"),)
    notes = (Paragraph(counted, "quiet"), Paragraph(note, "quiet"))
    return [Heading(t("Before and after")), *warning, ReportTable(head, tuple(rows)), *notes]


def _column(figures: PoreFigures, t: Language) -> dict[str, tuple[str, float | None]]:
    """Return each figure as it is shown, and as a number where a change has a meaning."""
    c = figures.connectivity
    rows: dict[str, tuple[str, float | None]] = {
        t("porosity"): (digits.share(c.porosity), c.porosity),
        t("connected porosity"): (digits.share(c.connected), c.connected),
    }
    for axis, phi in enumerate(c.percolating):
        rows[t("percolating porosity along axis {axis}", axis=axis)] = (digits.share(phi), phi)
    rows[t("specific surface, 1/mm")] = (f"{figures.specific_surface / 1e3:.2f}", figures.specific_surface)
    rows[t("grain diameter, mm")] = (f"{figures.grain_diameter * 1e3:.4f}", figures.grain_diameter)
    rows[t("Euler number")] = (digits.count(c.euler), None)
    rows[t("Kozeny permeability, mD")] = (_darcy(figures.kozeny), figures.kozeny)
    for word, found in ((t("network"), figures.network), (t("Laplace"), figures.laplace)):
        if found is not None:
            for axis, k in enumerate(found.square_metres):
                name = t("{method} permeability along axis {axis}, mD", method=word, axis=axis)
                rows[name] = (_darcy(k), k)
    return rows


def _darcy(square_metres: float) -> str:
    return digits.figure(square_metres / MILLIDARCY) if np.isfinite(square_metres) else "–"


def _change(before: float | None, after: float | None) -> str:
    if before is None or after is None or not before or not np.isfinite([before, after]).all():
        return "–"
    return f"{100 * (after / before - 1):+.1f}\N{NO-BREAK SPACE}%".replace("-", "−")


def _percolation(found: PoresFindings, t: Language) -> list[Block]:
    head = (Column(t("Axis")), Column(t("Voxels")), Column(t("Network")), Column(t("Rebuilt")))
    words = {True: t("percolates"), False: t("does not percolate")}
    before, after = found.table.before.connectivity.percolates, found.table.after.connectivity.percolates
    columns = (before, found.network.percolates, after)
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (str(axis), *(CheckMark(along[axis], words[along[axis]]) for along in columns)) for axis in range(3)
    )
    c = found.table.before.connectivity
    text = t(
        "Parts of the pore space: {parts} connected by faces of voxels, {corners} by faces, edges or corners.",
        parts=digits.count(c.parts),
        corners=digits.count(c.parts26),
    )
    permeability = found.table.before.network
    notes = permeability.messages if permeability is not None else ()
    return [
        Heading(t("Percolation")),
        ReportTable(head, rows),
        Paragraph(text),
        *(Paragraph(sentence(note, t), "quiet") for note in notes),
    ]


def _sizes(found: PoresFindings, t: Language) -> list[Block]:
    network = found.network
    blocks: list[Block] = [Heading(t("Sizes of pores and throats"))]
    if "sizes" in found.pictures:
        caption = t("Radii of the largest balls in pores and throats, by number and, of pores, by volume.")
        blocks.append(Picture(pores_picture("sizes", found.name), caption))
    head = (
        Column(t("Radius, µm")),
        Column(t("Count"), "number"),
        Column(t("Least"), "number"),
        *(Column(f"P{share}", "number") for share in SHARES),
        Column(t("Largest"), "number"),
        Column(t("Mean"), "number"),
    )
    unit = network.unit * 1e6
    rows = tuple(
        (word, *_spread(np.asarray(radius, float) * unit))
        for word, radius in ((t("pores"), network.pores.inscribed), (t("throats"), network.throats.inscribed))
    )
    return [*blocks, ReportTable(head, rows)]


def _spread(radius: NDArray[np.float64]) -> tuple[str, ...]:
    if not len(radius):
        return ("0", *("–",) * (len(SHARES) + 3))
    figures = (radius.min(), *np.percentile(radius, SHARES), radius.max(), radius.mean())
    return (digits.count(len(radius)), *(f"{value:.2f}" for value in figures))


def _settling(found: PoresFindings, t: Language) -> list[Block]:
    blocks: list[Block] = [Heading(t("Representative volume"))]
    if "settling" in found.pictures:
        caption = t("Porosity of cubes that fill the sample, by their edge: mean, lowest and highest.")
        blocks.append(Picture(pores_picture("settling", found.name), caption))
    if found.volume.porosity > 0:
        blocks.append(Paragraph(settling_sentence(found.settling, found.volume.porosity, t)))
    return blocks


def settling_sentence(settling: RepresentativeVolume, porosity: float, t: Language) -> str:
    """Say from which edge on all cubes of a sample are as porous as it is, within a tenth."""
    most = 0.1 * porosity
    far = np.maximum(settling.highest - porosity, porosity - settling.lowest)
    alike = (settling.highest - settling.lowest <= most) & (far <= most)
    # Of some size by chance; it counts if no larger cube contradicts it.
    lasting = np.logical_and.accumulate(alike[::-1])[::-1]
    settled = np.flatnonzero(lasting & (settling.count > 1))
    if not len(settled):
        return t("No cube smaller than the sample is representative: their porosities differ by more than 10 %.")
    edge = f"{settling.edge[settled[0]] * 1e3:.3g}"
    return t("From an edge of {edge} mm on, all cubes lie within 10 % of the porosity of the sample.", edge=edge)


def _made(found: PoresFindings, t: Language) -> list[Block]:
    names = {
        "r_min": t("smallest ball that makes a pore, voxels"),
        "tau": t("share of the radius at which pores separate"),
        "border": t("rule at the border of the sample"),
        "hierarchy": t("how pores are separated"),
    }
    rows = [(names[key], _setting(value, t)) for key, value in found.network.settings.items() if key in names]
    edges = " × ".join(f"{edge * 1e6:.4g}" for edge in found.volume.voxel)
    rows.append((t("voxel, µm"), edges))
    return [Heading(t("Settings")), ReportTable((Column(t("Setting")), Column(t("Value"))), tuple(rows))]


def _setting(value: object, t: Language) -> str:
    if isinstance(value, bool):
        return t("yes") if value else t("no")
    if isinstance(value, int | float):
        return f"{value:g}"
    return translate(_VALUES.get(str(value), str(value)), t)

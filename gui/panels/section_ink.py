"""The drawing of a section: traces, band, ground, holes and points, distance against elevation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from geofit.gui.panels.canvas import Ink
from geofit.gui.panels.curtain import Curtain, Traces
from geofit.offdata import Uncertainty
from geofit.report.section import COLOURS
from geofit.report.style import kind_style, quiet
from geofit.site import Ground, Site

__all__ = ["SectionData", "draw_section", "near_points"]

Floats = NDArray[np.float64]

#: Distance between the names of two holes, pixels at 100 dots an inch.
NAME = 14
#: Half width of a 90 % band in standard deviations.
NINETY = 1.6449
GROUND = "#6b7d3a"


@dataclass(frozen=True, eq=False)
class SectionData:
    """What a section shows; ``uncertainty`` by horizon gives the 90 % bands."""

    site: Site
    curtain: Curtain
    thickness: float
    traces: Traces = field(default_factory=dict)
    uncertainty: Mapping[str, Uncertainty] = field(default_factory=dict)

    def colour(self, name: str) -> str:
        """Return the colour of a horizon, the same wherever it stands."""
        names = list(self.site.horizons)
        return COLOURS[(names.index(name) if name in names else len(names)) % len(COLOURS)]


def near_points(data: SectionData, name: str) -> tuple[Floats, NDArray[np.int64]]:
    """Return (m, 2) distance and elevation of a horizon's points within the thickness, and their indices."""
    points = data.site.horizons[name]
    along, beside = data.curtain.project(points.xyz[:, :2])
    index = np.flatnonzero(beside <= data.thickness / 2)
    return np.column_stack([along[index], points.xyz[index, 2]]), index


def draw_section(axes: Axes, data: SectionData, ink: Ink, words: Mapping[str, str]) -> None:
    """Draw a section to scale; ``words`` holds the texts ground, band, distance and elevation."""
    for bend in data.curtain.starts[1:-1]:
        axes.axvline(bend, color=ink.line, lw=0.9, zorder=0)
    if data.site.ground is not None:
        distance, places = data.curtain.places()
        z = data.site.ground.elevation(places[:, 0], places[:, 1])
        axes.plot(distance, z, color=ink.of(GROUND), lw=1.3, label=words["ground"], zorder=2)
    banded = False
    for name, lines in data.traces.items():
        colour = ink.of(data.colour(name))
        for line in lines:
            label = name if line is lines[0] else None
            axes.plot(line.distance, line.xyz[:, 2], color=colour, lw=1.7, label=label, zorder=4)
            band = _band(line.xyz, data.uncertainty.get(name))
            if band is not None and (np.diff(line.distance) >= 0).all():
                axes.fill_between(
                    line.distance, line.xyz[:, 2] - band, line.xyz[:, 2] + band, color=colour, alpha=0.18, lw=0,
                    label=None if banded else words["band"], zorder=1,
                )  # fmt: skip
                banded = True
    _holes(axes, data, ink)
    for name in data.site.horizons:
        places, index = near_points(data, name)
        kinds = data.site.horizons[name].kind[index]
        for kind in sorted(set(kinds.tolist())):
            of = kinds == kind
            marker = kind_style(kind)[0]
            axes.plot(
                places[of, 0], places[of, 1], ls="none", marker=marker, ms=6 if marker == "." else 4.5,
                color=ink.of(data.colour(name)), mec=ink.paper, mew=0.5, zorder=5, rasterized=of.sum() > 5_000,
            )  # fmt: skip
    axes.set_xlabel(words["distance"], wrap=True)
    axes.set_ylabel(words["elevation"])
    axes.yaxis.grid(True, color=ink.line, lw=0.6)
    axes.set_axisbelow(True)
    quiet(axes)


def _band(xyz: Floats, uncertainty: Uncertainty | None) -> Floats | None:
    if uncertainty is None or uncertainty.frame != "map":
        return None
    # A grid of standard deviations is read as a grid of heights is.
    sd = Ground(uncertainty.x, uncertainty.y, uncertainty.sd).elevation(xyz[:, 0], xyz[:, 1])
    return np.asarray(NINETY * sd)


def _holes(axes: Axes, data: SectionData, ink: Ink) -> None:
    last = -np.inf
    shown = []
    for hole in data.site.holes:
        along, beside = data.curtain.project(hole.xyz[:, :2])
        near = beside <= data.thickness / 2
        if near.any():
            shown.append(
                (float(along[near][0]), hole, np.where(near, along, np.nan), np.where(near, hole.xyz[:, 2], np.nan))
            )
    room = data.curtain.length * NAME / max(axes.figure.bbox.width / axes.figure.dpi * 100 * 0.75, 1.0)
    for at, hole, along, z in sorted(shown, key=lambda one: one[0]):
        axes.plot(along, z, color=ink.muted, lw=1.1, zorder=3)
        top = float(np.nanmax(z))
        place = float(along[np.nanargmax(z)])
        axes.plot([place], [top], marker="_", color=ink.muted, ms=6, zorder=3)
        # Names that would stand on one another are left out; the 3D view has them all.
        if at - last >= room:
            last = at
            axes.annotate(
                hole.name, (place, top), xytext=(0, 3), textcoords="offset points", ha="center", va="bottom",
                rotation=90, size=7, color=ink.text, annotation_clip=True, zorder=6,
            )  # fmt: skip

"""The drawing of a section: traces, band, ground, holes and points, distance against elevation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation, Text
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from geofit.data.site import Site
from geofit.gui.panels.canvas import DOT, PlotColours
from geofit.gui.panels.curtain import Curtain, Traces
from geofit.gui.panels.section_scale import SectionExtent
from geofit.report.section_pages import lithology_style
from geofit.report.style import horizon_colours, kind_style, quiet_axes, shortened
from geofit.site.hole_logs import hole_intervals, log_files
from geofit.site.support import support_of

__all__ = ["TINT", "SectionData", "explain", "near_points", "paint_section", "seen_in", "thin_names"]

Floats = NDArray[np.float64]

#: Distance between the names of two holes, logical pixels; their letters, and those of the legend, in points.
NAME, LETTERS, LEGEND = 12, 7.0, 7.5
#: Free room between the legend and the edge, and the height of the line that tells the exaggeration, logical pixels.
FREE, NOTE = 8.0, 20.0
#: Height of a line of the legend, logical pixels.
ROW = 16.0
GROUND = "#6b7d3a"
#: Opacity of the 90 % bands, which must be seen on dark paper, too.
TINT = 0.3
#: Half width of a hole's column of lithology, as a share of the section's length.
COLUMN = 0.004
#: Where a surface is above the ground or beyond its data.
DASHES = (0, (4.0, 2.5))


@dataclass(frozen=True, eq=False)
class SectionData:
    """What a section shows.

    ``faded`` draws surfaces dashed above the ground and beyond the hull of their points.
    """

    site: Site
    curtain: Curtain
    thickness: float
    traces: Traces = field(default_factory=dict)
    faded: bool = False

    def colour(self, name: str) -> str:
        """Return the colour of a horizon, the same wherever it stands."""
        return horizon_colours([*self.site.horizons, *self.traces], self.site.blocks)[name]


class _Along(MaxNLocator):
    """Numbers of the distance, from end to end of the section only."""

    def __init__(self, length: float) -> None:
        super().__init__(steps=[1, 2, 2.5, 5, 10])
        self._length = length

    def __call__(self) -> list[float]:
        assert self.axis is not None
        low, high = sorted(self.axis.get_view_interval())
        ends = max(low, 0.0), min(high, self._length)
        if ends[0] >= ends[1]:
            return []
        share = (ends[1] - ends[0]) / (high - low)
        self.set_params(nbins=max(min(int(share * self.axis.get_tick_space()), 9), 1))
        return [float(value) for value in self.tick_values(*ends) if ends[0] <= value <= ends[1]]


def near_points(data: SectionData, name: str) -> tuple[Floats, NDArray[np.int64]]:
    """Return (m, 2) distance and elevation of a horizon's points within the thickness, and their indices."""
    points = data.site.horizons[name]
    along, beside = data.curtain.project(points.xyz[:, :2])
    index = np.flatnonzero(beside <= data.thickness / 2)
    return np.column_stack([along[index], points.xyz[index, 2]]), index


def paint_section(axes: Axes, data: SectionData, colours: PlotColours, words: Mapping[str, str]) -> None:
    """Draw a section to scale; ``words`` holds the texts ground, band and elevation."""
    for bend in data.curtain.starts[1:-1]:
        axes.axvline(bend, color=colours.line, lw=0.9, zorder=0)
    if data.site.ground is not None:
        distance, places = data.curtain.places()
        z = data.site.ground.elevation(places[:, 0], places[:, 1])
        axes.plot(distance, z, color=colours.of(GROUND), lw=1.3, label=words["ground"], zorder=2)
    banded = False
    for name, lines in data.traces.items():
        colour = data.colour(name)
        points = data.site.horizons.get(name)
        support = support_of(points.xyz, data.site.ground) if data.faded and points is not None else None
        named = False
        for line, band in lines:
            held = np.ones(len(line.distance), bool) if support is None else support.within(line.xyz)
            runs = _runs(held)
            solid_shown = any(solid for _, solid in runs)
            for run, solid in runs:
                first = not named and solid == solid_shown
                axes.plot(
                    line.distance[run], line.xyz[run, 2], color=colour, lw=1.7 if solid else 1.2,
                    ls="-" if solid else DASHES, alpha=1.0 if solid else 0.65, label=name if first else None, zorder=4,
                )  # fmt: skip
                named |= first
            if band is not None:
                axes.fill(
                    *band.outline.T, color=colour, alpha=TINT, lw=0, label=None if banded else words["band"], zorder=1
                )
                banded = True
    _holes(axes, data, colours)
    for name in data.site.horizons:
        places, index = near_points(data, name)
        kinds = data.site.horizons[name].kind[index]
        for kind in sorted(set(kinds.tolist())):
            of = kinds == kind
            marker = kind_style(kind)[0]
            axes.plot(
                places[of, 0], places[of, 1], ls="none", marker=marker, ms=6 if marker == "." else 4.5,
                color=data.colour(name), mec=colours.paper, mew=0.5, zorder=5, rasterized=of.sum() > 5_000,
            )  # fmt: skip
    axes.set_ylabel(words["elevation"])
    axes.xaxis.set_major_locator(_Along(data.curtain.length))
    axes.yaxis.grid(True, color=colours.line, lw=0.6)
    axes.set_axisbelow(True)
    quiet_axes(axes)


def _runs(held: NDArray[np.bool_]) -> list[tuple[slice, bool]]:
    """Return stretches of a line with whether they are supported; a stretch ends where the next begins."""
    ends = [0, *(np.flatnonzero(np.diff(held)) + 1).tolist(), len(held)]
    return [(slice(a, min(b + 1, len(held))), bool(held[a])) for a, b in pairwise(ends) if b > a]


def _holes(axes: Axes, data: SectionData, colours: PlotColours) -> None:
    """Draw the holes within the thickness: one line for all, as each costs as much as all."""
    tracks, heads = [np.full((1, 2), np.nan)], []
    for hole in data.site.holes:
        along, beside = data.curtain.project(hole.xyz[:, :2])
        near = beside <= data.thickness / 2
        if near.any():
            track = np.where(near[:, None], np.column_stack([along, hole.xyz[:, 2]]), np.nan)
            tracks += [track, tracks[0]]
            heads.append((hole.name, track[np.nanargmax(track[:, 1])]))
    if not heads:
        return
    _logged(axes, data, colours)
    axes.plot(*np.concatenate(tracks).T, color=colours.muted, lw=1.1, zorder=3)
    axes.plot(*np.array([head for _, head in heads]).T, ls="none", marker="_", color=colours.muted, ms=6, zorder=3)
    halo = withStroke(linewidth=2.5, foreground=colours.paper)
    for name, head in heads:
        axes.annotate(
            name, head, xytext=(0, 3), textcoords="offset points", ha="center", va="bottom", rotation=90,
            size=LETTERS, color=colours.text, annotation_clip=True, zorder=6, path_effects=[halo],
        )  # fmt: skip


def _logged(axes: Axes, data: SectionData, colours: PlotColours) -> None:
    """Draw the first interval table of the holes within the thickness as columns, each code with its pattern."""
    import matplotlib as mpl
    from matplotlib.patches import Polygon

    tables = log_files(data.site)
    if not tables:
        return
    every = {str(code) for campaign in data.site.boreholes for log in campaign.logs for code in np.unique(log.code)}
    styles = lithology_style(sorted(every))
    half, labelled = COLUMN * data.curtain.length, set[str]()
    for hole in data.site.holes:
        for one in hole_intervals(data.site, hole, tables[0]):
            along, beside = data.curtain.project(one.xyz[:, :2])
            near = beside <= data.thickness / 2
            if near.sum() < 2:
                continue
            track = np.column_stack([along[near], one.xyz[near, 2]])
            side = np.array([half, 0.0])
            outline = np.concatenate([track - side, track[::-1] + side])
            colour, hatch = styles[one.code]
            label = None if one.code in labelled else one.code
            labelled.add(one.code)
            with mpl.rc_context({"hatch.linewidth": 0.3}):
                made = Polygon(outline, fc=colour, ec=colours.muted, lw=0.4, hatch=hatch, label=label, zorder=2.5)
            axes.add_patch(made)


def seen_in(axes: Axes, curtain: Curtain) -> SectionExtent:
    """Return what a drawing has to show: all that is drawn, and the names over the holes."""
    low, high = (float(level) for level in axes.dataLim.intervaly)
    if not np.isfinite([low, high]).all():
        low, high = 0.0, 1.0
    if low == high:
        low, high = low - 1.0, high + 1.0
    names = _names(axes)
    if not names:
        return SectionExtent(curtain.length, low, high)
    letters = max(sum(1.0 if c >= "\u2e80" else 0.64 for c in name.get_text()) for name in names)
    return SectionExtent(
        curtain.length, low, high, max(float(name.xy[1]) for name in names), letters * LETTERS * DOT + 8
    )


def _names(axes: Axes) -> list[Annotation]:
    return [text for text in axes.texts if isinstance(text, Annotation)]


def thin_names(axes: Axes) -> None:
    """Hide names that would stand on one another; the 3D view has them all."""
    apart = NAME * axes.figure.dpi / 100
    last = -np.inf
    for text in sorted(_names(axes), key=lambda one: one.xy[0]):
        at = float(axes.transData.transform(text.xy)[0])
        text.set_visible(at - last >= apart)
        last = at if at - last >= apart else last


def explain(figure: Figure, colours: PlotColours, *, narrow: bool) -> tuple[Text, tuple[float, float, float, float]]:
    """Write the legend beside the drawing, or below where that is narrow, and the exaggeration above.

    Returns
    -------
    tuple
        The text that tells the exaggeration, still empty, and the room that is left: left, top, width and height in
        logical pixels.
    """
    for old in (*figure.legends, *figure.texts):
        old.remove()
    width, height = (100 * float(inches) for inches in figure.get_size_inches())
    handles, names = figure.axes[0].get_legend_handles_labels()
    labels = [shortened(name) for name in names]
    column = row = 0.0
    if handles:
        legend = figure.legend(
            handles, labels, labelcolor=colours.text, fontsize=LEGEND, borderpad=0, borderaxespad=0,
            loc="lower center" if narrow else "upper left",
            ncols=3 if narrow else 1 + (len(handles) * ROW > height - 2 * NOTE), handlelength=1.4, columnspacing=0.8,
        )  # fmt: skip
        box = legend.get_window_extent()
        column, row = (100 * float(side) / figure.dpi for side in (box.width, box.height))
    column = 0.0 if narrow else max(column, 88.0) + FREE
    if handles:
        at = (0.5, 4 / height) if narrow else (1 - column / width, 1 - (NOTE + 4) / height)
        legend.set_bbox_to_anchor(at, figure.transFigure)
    note = figure.text(
        1 - (FREE if narrow else column) / width, 1 - 4 / height, "", ha="right" if narrow else "left", va="top",
        size=8.0, weight="bold", color=colours.text,
    )  # fmt: skip
    top = NOTE if narrow else 0.0
    return note, (0.0, top, width - column, height - top - (row + 4 if narrow else 0.0))

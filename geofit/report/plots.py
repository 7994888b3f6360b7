"""The maps of a report: site plan and deviations. Matplotlib objects, no global state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.languages import EN, Language, translate
from geofit.data.site import Hole
from geofit.report.digits import tick
from geofit.report.histogram import histogram
from geofit.report.result import HorizonResult
from geofit.report.style import CORE, LINE, MUTED, TEXT, bands, kind_style, quiet_axes
from geofit.report.view import choose_view, cut_edges, rims, trimmed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from geofit.report.scene import Scene

__all__ = ["colour_scale", "deviation_map", "histogram", "legend", "map_axes", "map_shape", "site_plan", "space"]

Floats = NDArray[np.float64]

#: More points than this are drawn as a rasterised layer.
MANY = 5_000
#: Width and height of a hole's name as a share of the map: of names that would overlap the first is drawn.
LABEL = (0.11, 0.03)
#: How far below a picture in space its scale stands, as a share of the picture's height.
BELOW = 0.1
#: Width that the scale and the words below a picture in space need next to each other, inches.
WORDS = 5.0


def space(axes: Axes, scene: Scene, t: Language = EN) -> None:
    """Show the picture in space with the scale of its colours, and say from where it is seen."""
    axes.imshow(scene.image, interpolation="antialiased")
    axes.set_axis_off()
    # A narrow picture has less room below it than the words need: they go on beside it.
    tall, wide = scene.image.shape[:2]
    figure = axes.get_figure(root=True)
    assert figure is not None
    place, (across, up) = axes.get_position(original=True), figure.get_size_inches()
    room = place.width * across
    share = max(min(WORDS, room) / min(room, place.height * up * wide / tall), 1.0)
    colour_scale(axes, scene.limits, t("Elevation, m"), share)
    words = translate(scene.caption, t)
    axes.text(share, -BELOW, words, size=7.5, color=MUTED, ha="right", transform=axes.transAxes)


def colour_scale(axes: Axes, limits: tuple[float, float], title: str, share: float = 1.0) -> None:
    """Put the scale of the colours below a picture in space, where nothing is drawn.

    ``share`` is the room for it, as a share of the picture's width.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    from geofit.report.scene import elevation_colours

    scale = axes.inset_axes((0.02, -BELOW, 0.26 * share, 0.022))
    colours = ScalarMappable(Normalize(*limits), elevation_colours())
    bar = axes.figure.colorbar(colours, cax=scale, ticks=_ticks(*limits), orientation="horizontal")
    bar.outline.set_visible(False)
    scale.set_title(title, fontsize=7.5, fontweight="normal", color=MUTED, pad=3)
    scale.xaxis.set_major_formatter(lambda value, _: tick(value))
    scale.tick_params(length=0, pad=2)


def map_shape(result: HorizonResult, *, plan: bool) -> float:
    """Return height over width of a map of the horizon."""
    axes = np.eye(3)[:2] if plan else choose_view(result.surface).axes
    xyz = np.concatenate([*rims(result.surface).values(), result.surface.points.xyz])
    width, height = np.ptp(xyz @ axes.T, axis=0)
    return float(height / width) if width > 0 else float("inf")


def site_plan(axes: Axes, result: HorizonResult, t: Language = EN) -> None:
    """Draw what the horizon was fitted to: points by kind, core, patches, study area, section lines."""
    surface, site, core = result.surface, result.site, result.core
    xyz = surface.points.xyz
    for section in site.sections:
        axes.plot(*section.line.T, color=LINE, lw=0.9, zorder=1)
    if site.boundary is not None:
        _closed(axes, site.boundary, color=MUTED, lw=1.0, ls=(0, (6, 3)), label=t("study area"), zorder=2)
    for rim in rims(surface, steps=400).values():
        rim[trimmed(surface, rim[:, 0], rim[:, 1]) < -1e-6] = np.nan
        axes.plot(rim[:, 0], rim[:, 1], color=LINE, lw=0.8, zorder=1)
    if surface.partition is not None and surface.partition.corners is not None:
        corners = np.asarray(surface.partition.corners)
        axes.fill(*corners.T, facecolor=CORE, alpha=0.07, edgecolor="none", zorder=1)
        _closed(axes, corners, color=CORE, lw=1.6, label=t("core ({count} points)", count=int(core.sum())), zorder=3)
    _holes(axes, site.holes, t)
    for kind in sorted(set(surface.points.kind.tolist())):
        of = surface.points.kind == kind
        marker, colour = kind_style(kind)
        axes.scatter(
            xyz[of, 0], xyz[of, 1], s=9 if marker == "." else 16, marker=marker, color=colour, lw=0, zorder=4,
            label=f"{translate(kind, t)} ({int(of.sum())})", rasterized=len(xyz) > MANY,
        )  # fmt: skip
    axes.set_title(t("Site plan"))
    map_axes(axes, t("Easting, m"), t("Northing, m"))
    legend(axes)


def deviation_map(axes: Axes, result: HorizonResult, t: Language = EN) -> None:
    """Draw every residual in fixed tolerance bands: colour and marker tell the side, size the distance."""
    surface, a = result.surface, result.accuracy
    view = choose_view(surface)
    if view.caption == "plan":
        _contours(axes, result)
    if surface.outline is not None and view.caption == "plan":
        _closed(axes, surface.outline, color=MUTED, lw=1.0, ls=(0, (6, 3)), zorder=2)
    for name, rim in rims(surface, steps=400).items():
        rim[trimmed(surface, rim[:, 0], rim[:, 1]) < -1e-6] = np.nan
        heavy = name == "core"
        for line in (rim, *cut_edges(surface, name)):
            axes.plot(*view.of(line).T, color=CORE if heavy else LINE, lw=1.4 if heavy else 0.8, zorder=1 + heavy)
    place = view.of(surface.points.xyz)
    d = a.residuals
    for i, band in enumerate(bands(surface.settings)):
        of = band.holds(d)
        if i == 0:
            _residuals(axes, place[of], ".", band.below, band.area, f"{band.label} ({int(of.sum())})", 3)
            continue
        for side, marker, colour, word in (
            (d < 0, "v", band.below, t("below")),
            (d > 0, "^", band.above, t("above")),
        ):
            both = of & side
            _residuals(
                axes,
                place[both],
                marker,
                colour,
                band.area,
                f"{band.label} {word} ({int(both.sum())})",
                3 + i,
            )
    axes.set_title(t("Deviation of every point"))
    map_axes(axes, *(translate(label, t) for label in view.labels))
    legend(axes)


def _holes(axes: Axes, holes: Sequence[Hole], t: Language) -> None:
    """Draw where holes and adits run in plan, and their names where there is room for them."""
    named: list[Floats] = []
    room = np.ptp([hole.xyz[0, :2] for hole in holes], axis=0).max() if holes else 0.0
    for i, hole in enumerate(holes):
        label = t("holes and adits ({count})", count=len(holes)) if i == 0 else None
        axes.plot(hole.xyz[:, 0], hole.xyz[:, 1], color=MUTED, lw=0.7, zorder=2)
        axes.plot(*hole.xyz[0, :2], "o", ms=4.5, mfc="none", mec=MUTED, mew=0.7, ls="none", label=label, zorder=2)
        collar = hole.xyz[0, :2]
        if not any((np.abs(collar - other) < room * np.array(LABEL)).all() for other in named):
            named.append(collar)
            axes.annotate(
                hole.name, (collar[0], collar[1]), xytext=(3, 2), textcoords="offset points", size=4.8, color=MUTED,
                annotation_clip=True, zorder=3,
            )  # fmt: skip


def _residuals(axes: Axes, place: Floats, marker: str, colour: str, area: float, label: str, level: int) -> None:
    if len(place):
        axes.scatter(
            place[:, 0], place[:, 1], s=area, marker=marker, color=colour, lw=0.3, edgecolor="white", label=label,
            zorder=level, rasterized=len(place) > MANY,
        )  # fmt: skip


def _contours(axes: Axes, result: HorizonResult) -> None:
    """Draw the surface itself in light contour lines."""
    xyz = np.concatenate(list(rims(result.surface).values()))
    x = np.linspace(xyz[:, 0].min(), xyz[:, 0].max(), 140)
    y = np.linspace(xyz[:, 1].min(), xyz[:, 1].max(), 140)
    z = result.surface.elevation(x, y[:, None])
    z[trimmed(result.surface, *np.meshgrid(x, y)) < 0] = np.nan
    if not np.isfinite(z).any() or np.nanmax(z) - np.nanmin(z) < 1e-6:
        return
    from matplotlib.ticker import MaxNLocator

    levels = MaxNLocator(9, steps=[1, 2, 5, 10]).tick_values(np.nanmin(z), np.nanmax(z))
    lines = axes.contour(x, y, np.ma.masked_invalid(z), levels=levels, colors="#bcc6d0", linewidths=0.7, zorder=0)
    axes.clabel(lines, fmt=tick, fontsize=7, colors=MUTED)


def _ticks(low: float, high: float) -> list[float]:
    from matplotlib.ticker import MaxNLocator

    ticks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if low <= tick <= high]


def _closed(axes: Axes, corners: Floats, **style: object) -> None:
    ring = np.concatenate([corners, corners[:1]])
    axes.plot(ring[:, 0], ring[:, 1], **style)  # type: ignore[arg-type]


def map_axes(axes: Axes, xlabel: str, ylabel: str) -> None:
    """Give a map equal scales and round coordinates."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    axes.set_aspect("equal", adjustable="box", anchor="NW")
    # Contours would pin the limits to the surface's edge, and cut the markers on it.
    axes.use_sticky_edges = False
    axes.margins(0.03)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5))
        axis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    quiet_axes(axes)


def legend(axes: Axes) -> None:
    """Put the legend beside a map."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0, labelcolor=TEXT, handletextpad=0.5)

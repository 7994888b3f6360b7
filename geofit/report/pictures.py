"""The pictures of a run: those that the report holds, and those that are next to it as files."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit.data.files import replacing
from geofit.data.guard import guarded
from geofit.data.languages import EN, Language, together, translate
from geofit.data.messages import Message
from geofit.data.site import Section, Site
from geofit.report import digits, plots, scene
from geofit.report.box import draw_boxed
from geofit.report.change_map import change_map
from geofit.report.contour_plan import draw_contour_plan, plan_sheet
from geofit.report.gather import SITE_PICTURE, cut_of, picture_name, section_picture
from geofit.report.histogram import histogram, normal_plot
from geofit.report.result import HorizonResult
from geofit.report.section_sheet import draw_section, section_sheet
from geofit.report.stereonet import StereonetContent, angles, stereonet
from geofit.report.style import (
    CORE,
    FAIL,
    MUTED,
    PASS,
    TEXT,
    WARNING,
    clauses_in_lines,
    drawing,
    horizon_colours,
    legend_columns,
    shortened,
)
from geofit.report.uncertainty import uncertainty_map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geofit.report.scene import Scene
    from geofit.site.states import Comparison

__all__ = ["Pictures", "draw_change", "draw_pictures", "draw_sections", "draw_site", "png", "write_picture"]

#: Width of the report's pictures, inches: what an A4 page has between its margins; their dots an inch; height of the
#: picture of the cover, inches.
WIDTH, DOTS, COVER = 6.85, 200, 4.15
#: Side of a stereonet, inches.
NET = 3.0
#: Type of those pictures, points: that of the page around them.
TYPE = 8.0


@dataclass(frozen=True)
class Pictures:
    """Pictures as PNG by their names in the report, and the scene; ``missing`` states why there is none."""

    images: Mapping[str, bytes] = field(repr=False)
    scene: Scene | None
    missing: Message | None


def draw_pictures(result: HorizonResult, t: Language = EN) -> Pictures:
    """Draw all pictures of a horizon, with words in a language."""
    missing: list[Message] = []
    nothing: Scene | None = None
    view = guarded(lambda: scene.horizon_scene(result), nothing, missing.append)
    sheet = plan_sheet(result)
    flat = {
        "plan": _map(plots.site_plan, result, t, plots.map_shape(result, plan=True))
        if sheet is None
        else png(draw_contour_plan(sheet, result, t)),
        "deviation": _map(plots.deviation_map, result, t, plots.map_shape(result, plan=False)),
        "residuals": _residuals(result, t),
    }
    if view is not None:
        flat["view"] = _space(view, t)
    if result.prediction is not None and result.prediction.uncertainty is not None:
        field = result.prediction.uncertainty
        flat["uncertainty"] = _map(uncertainty_map, result, t, float(np.ptp(field.y) / np.ptp(field.x)))
    if result.dips:
        flat["dips"] = _dips(result, t)
    if result.change is not None:
        flat["change"] = draw_change(result.change, t)
    named = {picture_name(what, result.name): data for what, data in flat.items()}
    return Pictures(named, view, next(iter(missing), None))


def _dips(result: HorizonResult, t: Language) -> bytes:
    from matplotlib.figure import Figure

    found = np.array([(d.azimuth, d.dip, d.surface_azimuth, d.surface_dip) for d in result.dips]).T
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, NET), dpi=DOTS)
        colours = [CORE] * len(result.dips)
        net = figure.add_axes((0, 0, NET / WIDTH, 1))
        stereonet(net, StereonetContent(found[0], found[1], colours, (found[2], found[3])), t)
        angles(figure.add_axes((0.56, 0.17, 0.42, 0.7)), np.array([one.angle for one in result.dips]), t)
        return png(figure, margin=8)


def draw_change(comparison: Comparison, t: Language = EN) -> bytes:
    """Draw how a horizon moved between two states of its data, as PNG."""
    from matplotlib.figure import Figure

    grid = comparison.change.difference
    height = float(np.clip(4.3 * np.ptp(grid.y) / np.ptp(grid.x) + 0.87, 2.5, 5.1))
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, height), dpi=DOTS)
        change_map(figure.add_axes((0.115, 0.5 / height, 0.63, 1 - 0.82 / height)), comparison, t)
        return png(figure, margin=8)


def draw_site(results: Sequence[HorizonResult], t: Language = EN) -> Pictures:
    """Draw all horizons of a site with its holes."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch as Swatch

    missing: list[Message] = []
    nothing: Scene | None = None
    site, surfaces = _site(results), [result.surface for result in results]
    known = horizon_colours([*site.horizons, *(result.name for result in results)], site.blocks)
    colours = [known[result.name] for result in results]
    view = guarded(lambda: scene.site_scene(surfaces, colours, site.holes), nothing, missing.append)
    if view is None:
        return Pictures({}, None, missing[0])
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, COVER), dpi=DOTS)
        axes = figure.add_axes((0.085, 0.115, 0.83, 0.865))
        draw_boxed(axes, view, t)
        names = [shortened(result.name) for result in results]
        swatches = [Swatch(facecolor=c, label=name) for c, name in zip(colours, names, strict=True)]
        figure.legend(
            handles=swatches, loc="lower left", ncols=legend_columns(names, 25.4 * WIDTH, TYPE, 6), handlelength=1.2,
            borderaxespad=0, bbox_to_anchor=(0, 0.045), columnspacing=1.4,
        )  # fmt: skip
        figure.text(
            0, 0.004, together([t("All horizons and holes."), translate(view.caption, t)], t), size=7.5, color=MUTED
        )
        return Pictures({SITE_PICTURE: png(figure)}, view, None)


def draw_sections(results: Sequence[HorizonResult], sections: Sequence[Section], t: Language = EN) -> dict[str, bytes]:
    """Draw the geological sections of a report, by their names in it."""
    site, points = _site(results), {result.name: result.surface.points for result in results}
    drawn = {}
    for section in sections:
        cut, name = cut_of(results, section), section_picture(section)
        sheet = section_sheet(section, site, cut, name)
        drawn[name] = png(draw_section(sheet, section, site, cut, points, t))
    return drawn


def _site(results: Sequence[HorizonResult]) -> Site:
    """Return the site of results, which knows their fault blocks: its horizons may be whole."""
    site = results[0].site
    return replace(site, blocks={**site.blocks, **{r.name: r.horizon for r in results if r.horizon}})


def write_picture(result: HorizonResult, pictures: Pictures, path: Path, t: Language = EN) -> None:
    """Write the one picture that shows a horizon: in space, and its deviations."""
    from matplotlib.figure import Figure

    a, view, verdict = result.accuracy, pictures.scene, result.verdict
    *first, away = (translate(lamp.text, t) for lamp in verdict.lamps)
    # Names of checks and holes make both lines long.
    lines = [line for text in (" · ".join(first), away) for line in clauses_in_lines(text, 8.5, 160)]
    head = 0.99 + 0.17 * (len(lines) - 1)
    shape = plots.map_shape(result, plan=False)
    tall = 0.0 if view is None else view.image.shape[0] / view.image.shape[1]
    height = float(np.clip(max(4.6 * shape, 6.4 * tall * 1.1) + 1.9, 4.2, 8.5)) + head - 1.16
    with drawing():
        figure = Figure(figsize=(14.0, height), dpi=140)
        body = (height - head) / height
        left = figure.add_axes((0.025, 0.12, 0.46, body - 0.12), anchor="N")
        if view is None:
            left.text(0.5, 0.5, t("no OpenGL, no 3D picture"), ha="center", color=MUTED, transform=left.transAxes)
            left.set_axis_off()
        else:
            plots.space(left, view, t)
        foot = 0.6 / height
        right = figure.add_axes((0.555, foot, 0.32, body - foot - 0.3 / height))
        plots.deviation_map(right, result, t)
        top, second = 1 - 0.5 / height, 1 - 0.83 / height
        line = t(
            "{points} points, {core} in the core · σ {sigma} · largest |d| {largest}",
            points=a.n,
            core=int(result.core.sum()),
            sigma=digits.equals(a.sigma),
            largest=digits.equals(a.max_abs),
        )
        figure.text(0.025, top, result.name, size=17, weight="bold", color=TEXT)
        figure.text(0.025, second, line, color=MUTED, size=10)
        word = {"PASS": t("PASS"), "WARNING": t("WARNING"), "FAIL": t("FAIL")}[verdict.word]
        colour = {"PASS": PASS, "WARNING": WARNING, "FAIL": FAIL}[verdict.word]
        figure.text(0.555, top, word, size=17, weight="bold", color=colour)
        figure.text(0.555, second + 0.12 / height, "\n".join(lines), color=MUTED, size=8.5, va="top", linespacing=1.4)
        data = png(figure, margin=40)
    with replacing(path) as part:
        part.write_bytes(data)


def _map(
    plot: Callable[[Axes, HorizonResult, Language], None], result: HorizonResult, t: Language, shape: float
) -> bytes:
    """Draw a map: about 4.5 inches wide, its legend beside it."""
    from matplotlib.figure import Figure

    height = float(np.clip(4.3 * shape + 0.75, 2.4, 4.0))
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, height), dpi=DOTS)
        plot(figure.add_axes((0.115, 0.45 / height, 0.63, 1 - 0.7 / height)), result, t)
        return png(figure)


def _residuals(result: HorizonResult, t: Language) -> bytes:
    from matplotlib.figure import Figure

    height = 2.8
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, height), dpi=DOTS)
        bottom, tall = 1.0 / height, 1 - 1.25 / height
        histogram(figure.add_axes((0.075, bottom, 0.39, tall)), result, t)
        normal_plot(figure.add_axes((0.575, bottom, 0.415, tall)), result, t)
        return png(figure)


def _space(view: Scene, t: Language) -> bytes:
    from matplotlib.figure import Figure

    with drawing(TYPE):
        shape = view.image.shape[0] / view.image.shape[1]
        tall = min(WIDTH * shape, 3.0)
        height = tall * (1 + plots.BELOW) + 0.32
        figure = Figure(figsize=(WIDTH, height), dpi=DOTS)
        plots.space(figure.add_axes((0.0, 1 - tall / height, 1.0, tall / height), anchor="NW"), view, t)
        return png(figure)


def png(figure: Figure, margin: int = 0) -> bytes:
    """Return a figure as PNG: no transparency, no version of matplotlib, no white rows above and below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    drawn = np.flatnonzero(pixels.reshape(len(pixels), -1).min(axis=1) < 250)
    if drawn.size:
        pixels = pixels[max(drawn[0] - margin, 0) : drawn[-1] + 1 + margin]
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, format="PNG", compress_level=4)
    return stream.getvalue()

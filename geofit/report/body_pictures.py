"""The pictures of a body: in space, and in three sections through its middle with the probability of its extent."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import MissingDependencyError
from geofit.data.languages import EN, Language, together
from geofit.data.messages import Message
from geofit.report.body_chapter import body_picture
from geofit.report.box import draw_boxed
from geofit.report.pictures import DOTS, TYPE, WIDTH, png
from geofit.report.scene import mesh_scene
from geofit.report.style import LINE, MUTED, PAPER, TEXT, drawing, quiet_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from geofit.bodies.body import BodyFit

__all__ = ["draw_body"]

Floats = NDArray[np.float64]

#: Nodes along the longer side of a section, colour of a body, samples within this share of its size are shown.
NODES, COLOUR, THICKNESS = 90, "#b4582a", 0.05
#: Room for the label of an easting or northing below a section, inches.
LABEL = 0.55
#: Elevations of a section are raised by one of these, until it is this share as tall as wide.
RAISED, FLATTEST = (1, 2, 5, 10), 0.25
SHADES = ("#f6e3d8", "#e9bd9f", "#d58f62")


def draw_body(body: BodyFit, t: Language = EN) -> tuple[dict[str, bytes], Message | None]:
    """Draw a body; return pictures by their names in the report, and why there is none in space, if so."""
    drawn = {body_picture("section", body.name): _sections(body, t)}
    try:
        drawn[body_picture("view", body.name)] = _view(body, t)
    except MissingDependencyError as error:
        return drawn, error.message
    return drawn, None


def _view(body: BodyFit, t: Language) -> bytes:
    from matplotlib.figure import Figure

    mesh = body.overview
    scene = mesh_scene(mesh.vertices + body.origin, mesh.triangles, body.data.contacts, COLOUR)
    tall = float(np.clip(WIDTH * 0.83 * scene.image.shape[0] / scene.image.shape[1] / 0.86, 2.2, 4.1))
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, tall), dpi=DOTS)
        draw_boxed(figure.add_axes((0.085, 0.12, 0.83, 0.86)), scene, t)
        return png(figure)


def _sections(body: BodyFit, t: Language) -> bytes:
    """Draw the level plan through the middle, and beside it the sections along easting and northing."""
    from matplotlib.figure import Figure

    vertices = body.overview.vertices + body.origin
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    room = 0.12 * (high - low).max() * np.array([1.0, 1.0, 0.4])
    low, high = low - room, high + room
    middle = (low + high) / 2
    raised = next(n for n in RAISED if n * (high - low)[2] >= FLATTEST * (high - low)[:2].max() or n == RAISED[-1])
    names = (t("Easting, m"), t("Northing, m"), t("Elevation, m"))
    titles = (
        t("Section along northing at x = {value} m", value=f"{middle[0]:.0f}"),
        t("Section along easting at y = {value} m", value=f"{middle[1]:.0f}"),
        t("Plan at elevation {value} m", value=f"{middle[2]:.0f}"),
    )
    boxes = {2: (0.115, 0.13, 0.38, 0.79), 1: (0.615, 0.62, 0.375, 0.3), 0: (0.615, 0.13, 0.375, 0.3)}
    from matplotlib.ticker import MaxNLocator

    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, 3.9), dpi=DOTS)
        for across, along, up in ((2, 0, 1), (1, 0, 2), (0, 1, 2)):
            axes = figure.add_axes(boxes[across], anchor="NW")
            _section(axes, body, (across, along, up), low, high, middle)
            axes.set_aspect(raised if up == 2 else 1, adjustable="box")
            axes.apply_aspect()
            most = int(np.clip(axes.get_position().width * WIDTH / LABEL, 1, 3))
            axes.xaxis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10], min_n_ticks=1))
            axes.set_title(titles[across], size=8)
            axes.set_xlabel(names[along])
            axes.set_ylabel(names[up])
        thick = THICKNESS * float((high - low).max())
        words = [t("Samples within {distance} m of each section.", distance=f"{thick:.3g}")]
        words.append(t("Elevations of the sections × {times}.", times=raised) if raised > 1 else t("True scale."))
        figure.text(0.0, 0.01, together(words, t), size=7.5, color=MUTED)
        return png(figure)


def _section(axes: Axes, body: BodyFit, ways: tuple[int, int, int], low: Floats, high: Floats, middle: Floats) -> None:
    from matplotlib.ticker import MaxNLocator

    from geofit.bodies.posterior import BodyPosterior

    across, along, up = ways
    step = float((high - low)[[along, up]].max()) / NODES
    s, z = (np.arange(low[k], high[k] + step, step) for k in (along, up))
    places = np.empty((len(z), len(s), 3))
    places[..., along], places[..., up], places[..., across] = s, z[:, None], middle[across]
    flat = places.reshape(-1, 3)
    chance = BodyPosterior(body).probability(flat).reshape(places.shape[:2])
    value = body.value(flat).reshape(places.shape[:2])
    axes.contourf(s, z, chance, levels=[0.1, 0.5, 0.9, 1.0001], colors=SHADES, zorder=0)
    if value.min() < 0 < value.max():
        axes.contour(s, z, value, levels=[0.0], colors=COLOUR, linewidths=1.4, zorder=2)
    thick = THICKNESS * float((high - low).max())
    for xyz, face in ((body.data.inside, TEXT), (body.data.outside, PAPER), (body.data.contacts, COLOUR)):
        near = np.abs(xyz[:, across] - middle[across]) <= thick
        near &= ((xyz[:, [along, up]] >= low[[along, up]]) & (xyz[:, [along, up]] <= high[[along, up]])).all(axis=1)
        axes.plot(xyz[near, along], xyz[near, up], "o", ms=1.8, mfc=face, mec=TEXT, mew=0.3, zorder=3)
    axes.set_xlim(s[0], s[-1])
    axes.set_ylim(z[0], z[-1])
    axes.yaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.grid(color=LINE, lw=0.4, zorder=0)
    axes.set_axisbelow(True)
    quiet_axes(axes)

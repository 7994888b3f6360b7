"""A cave or an adit to scale: plan, long section projected onto the vertical plane of its longest reach, and a view."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import MissingDependencyError
from geofit.data.languages import EN, Language
from geofit.report.box import draw_boxed
from geofit.report.cave_chapter import CaveFindings, cave_picture
from geofit.report.digits import tick
from geofit.report.furniture import north_arrow, scale_bar, scale_for
from geofit.report.length_axis import upright
from geofit.report.pictures import DOTS, TYPE, WIDTH, png
from geofit.report.scene import mesh_scene
from geofit.report.style import FAIL, LINE, MUTED, PAPER, TEXT, WARNING, drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geofit.implicit.mesh import TriangleMesh

__all__ = ["CaveSheet", "cave_sheet", "draw_cave"]

Floats = NDArray[np.float64]

#: Width of a sheet, of its drawing and of the margins round it, least and most height of a drawing, mm.
SHEET, DRAWING, LEFT, BELOW, ABOVE, LOWEST, TALLEST = 174.0, 140.0, 19.0, 24.0, 3.0, 42.0, 150.0
#: Room round the passages, mm.
ROOM = 5.0
#: Room of a station's name, mm.
NAME = (11.0, 3.2)
PASSAGE, EXCAVATION, VIEW = "#cddbe6", "#7a4d9a", "#7d9db5"
MM = 1 / 25.4


@dataclass(frozen=True)
class CaveSheet:
    """Scale of both drawings, one to so many, and azimuth of the plane of the long section, degrees below 180."""

    scale: int
    azimuth: float

    @property
    def along(self) -> Floats:
        """Unit vector (2,) along the plane of the long section, east and north."""
        angle = np.radians(self.azimuth)
        return np.array([np.sin(angle), np.cos(angle)])


def cave_sheet(mesh: TriangleMesh, stations: Floats) -> CaveSheet:
    """Choose one scale for both drawings, and the plane of the long section: along the longest reach of stations."""
    xy = stations[:, :2] - stations[:, :2].mean(axis=0)
    # The largest eigenvalue's vector; of a round or vertical cave any direction is as good.
    east, north = np.linalg.eigh(xy.T @ xy)[1][:, -1]
    sheet = CaveSheet(1, float(np.degrees(np.arctan2(east, north)) % 180.0))
    spans = np.ptp(mesh.vertices, axis=0)
    reach = float(np.ptp(mesh.vertices[:, :2] @ sheet.along))
    rooms = ((spans[0], DRAWING), (spans[1], TALLEST), (reach, DRAWING), (spans[2], TALLEST))
    return CaveSheet(max(scale_for(float(span), room - 2 * ROOM) for span, room in rooms), sheet.azimuth)


def draw_cave(found: CaveFindings, sheet: CaveSheet, mesh: TriangleMesh, t: Language = EN) -> dict[str, bytes]:
    """Draw plan and long section, 174 mm wide, at the scale of the sheet, and the passages in space.

    Parameters
    ----------
    found : CaveFindings
        The passages.
    sheet : CaveSheet
        Scale and plane.
    mesh : TriangleMesh
        Their walls.
    t : Language
        That of the words.

    Returns
    -------
    dict of str to bytes
        PNG by the names in the report; no view where there is no OpenGL library.
    """
    start = float((mesh.vertices[:, :2] @ sheet.along).min())

    def plan(xyz: Floats) -> Floats:
        return xyz[:, :2]

    def section(xyz: Floats) -> Floats:
        return np.column_stack([xyz[:, :2] @ sheet.along - start, xyz[:, 2]])

    words = {"plan": (t("Easting, m"), t("Northing, m")), "section": (t("Along the section, m"), t("Elevation, m"))}
    with drawing(7.5):
        drawn = {
            what: png(_page(found, sheet, mesh, onto, words[what], t, north=what == "plan"))
            for what, onto in (("plan", plan), ("section", section))
        }
    # Without OpenGL the report has its drawings.
    with suppress(MissingDependencyError):
        drawn["view"] = _view(mesh, t)
    return {cave_picture(what, found.name): data for what, data in drawn.items()}


def _view(mesh: TriangleMesh, t: Language) -> bytes:
    from matplotlib.figure import Figure

    scene = mesh_scene(mesh.vertices, mesh.triangles, np.empty((0, 3)), VIEW)
    tall = float(np.clip(WIDTH * 0.83 * scene.image.shape[0] / scene.image.shape[1] / 0.86, 2.2, 4.1))
    with drawing(TYPE):
        figure = Figure(figsize=(WIDTH, tall), dpi=DOTS)
        draw_boxed(figure.add_axes((0.085, 0.12, 0.83, 0.86)), scene, t)
        return png(figure)


def _page(
    found: CaveFindings,
    sheet: CaveSheet,
    mesh: TriangleMesh,
    onto: Callable[[Floats], Floats],
    words: tuple[str, str],
    t: Language,
    *,
    north: bool,
) -> Figure:
    from matplotlib.figure import Figure

    flat = onto(mesh.vertices)
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = np.maximum(np.full(2, ROOM), (LOWEST - (high - low) * 1000 / sheet.scale) / 2)
    # A drawing is as wide as the sheet, or names and the scale bar would have no room.
    room[0] = (DRAWING - (high - low)[0] * 1000 / sheet.scale) / 2
    low, high = low - room * sheet.scale / 1000, high + room * sheet.scale / 1000
    wide, tall = ((high - low) * 1000 / sheet.scale).tolist()
    height = ABOVE + tall + BELOW
    figure = Figure(figsize=(SHEET * MM, height * MM), dpi=200)
    axes = figure.add_axes((LEFT / SHEET, BELOW / height, wide / SHEET, tall / height))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    _walls(axes, flat, mesh.triangles)
    _centre_lines(axes, found, onto)
    _names(axes, found, onto, sheet.scale)
    _frame(axes, words)
    if north:
        north_arrow(axes, wide + 7.0, tall - 17.0, t("N"))
    scale_bar(axes, sheet.scale, max(wide - 44.0, 0.0), -14.5)
    figure.legend(
        handles=_handles(found, t), loc="lower left", bbox_to_anchor=(LEFT / SHEET, 1.0 / height), ncols=5,
        fontsize=6.5, handlelength=1.8, columnspacing=1.4, borderaxespad=0, handletextpad=0.5,
    )  # fmt: skip
    return figure


def _walls(axes: Axes, flat: Floats, triangles: NDArray[np.int64]) -> None:
    """Fill the outline of the passages: wide dark triangles below, the same without edges above, leave a rim."""
    from matplotlib.collections import PolyCollection

    corners = flat[triangles]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    # The far side covers the same paper.
    near = corners[ax * by - ay * bx > 0]
    for colour, width, order in (("#5b7488", 1.1, 1.0), (PASSAGE, 0.25, 1.1)):
        axes.add_collection(
            PolyCollection(list(near), facecolors=colour, edgecolors=colour, lw=width, zorder=order, rasterized=True)
        )


def _centre_lines(axes: Axes, found: CaveFindings, onto: Callable[[Floats], Floats]) -> None:
    from matplotlib.collections import LineCollection

    adjusted = found.body.adjusted
    survey, flat = adjusted.survey, onto(adjusted.xyz)
    shots = found.body.sections.shot
    ends = np.stack([flat[survey.start[shots]], flat[survey.end[shots]]], axis=1)
    axes.add_collection(LineCollection(list(ends), colors=MUTED, lw=0.5, zorder=2))
    place = {name: flat[k] for k, name in enumerate(survey.stations)}
    pairs = [(survey.stations[a], survey.stations[b]) for a, b in zip(survey.start, survey.end, strict=True)]
    joined = {*pairs, *((b, a) for a, b in pairs)}
    for loop in adjusted.loops:
        if loop.suspicious:
            # Between two fixed stations no shot leads back to the first one.
            back = loop.stations[:1] if (loop.stations[-1], loop.stations[0]) in joined else ()
            line = np.array([place[name] for name in (*loop.stations, *back)])
            axes.plot(*line.T, color=FAIL, lw=1.0, zorder=2.5)
    used = np.unique([survey.start[shots], survey.end[shots]])
    axes.scatter(flat[used, 0], flat[used, 1], s=2.0, color=TEXT, lw=0, zorder=3)
    missing = sorted({wall.station for wall in found.body.sections.filled})
    if missing:
        x, y = np.array([place[name] for name in missing]).T
        axes.scatter(x, y, s=9, fc="none", ec=WARNING, lw=0.6, zorder=3)
    if found.clearance is not None:
        away = found.clearance
        x, y = onto(away.points).T
        axes.scatter(x, y, s=1.2, color=EXCAVATION, lw=0, zorder=2.8)
        nearest = np.array([away.points[away.nearest], away.wall[away.nearest]])
        axes.plot(*onto(nearest).T, color=EXCAVATION, lw=1.0, zorder=2.9)


def _names(axes: Axes, found: CaveFindings, onto: Callable[[Floats], Floats], scale: int) -> None:
    """Name the stations that have room: ends and junctions first, then the others in their order."""
    from matplotlib.patheffects import withStroke

    survey = found.body.adjusted.survey
    flat, shots = onto(found.body.adjusted.xyz), found.body.sections.shot
    degree = np.bincount(np.r_[survey.start[shots], survey.end[shots]], minlength=len(survey.stations))
    room = np.array(NAME) * scale / 1000
    named: list[Floats] = []
    halo = withStroke(linewidth=1.2, foreground=PAPER)
    for k in sorted(np.flatnonzero(degree).tolist(), key=lambda k: (degree[k] == 2, k)):
        if all((np.abs(flat[k] - other) > room).any() for other in named):
            named.append(flat[k])
            axes.annotate(survey.stations[k], (flat[k][0], flat[k][1]), xytext=(2.0, 1.6), textcoords="offset points",
                          size=4.8, color=TEXT, zorder=4, annotation_clip=True, path_effects=[halo])  # fmt: skip


def _frame(axes: Axes, words: tuple[str, str]) -> None:
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    wide, tall = axes.get_window_extent().size
    for axis, extent in ((axes.xaxis, wide), (axes.yaxis, tall)):
        axis.set_major_locator(MaxNLocator(max(int(extent / 200 * 25.4 / 22), 2), steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda value, _: tick(value)))
    axes.grid(color=LINE, lw=0.35, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2.5, width=0.6, labelsize=6.2)
    upright(axes)
    for spine in axes.spines.values():
        spine.set(color=TEXT, linewidth=0.8)
    axes.set_xlabel(words[0], fontsize=7, labelpad=2)
    axes.set_ylabel(words[1], fontsize=7, labelpad=2)


def _handles(found: CaveFindings, t: Language) -> list[object]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[object] = [
        Patch(fc=PASSAGE, ec="#5b7488", lw=0.8, label=t("passages")),
        Line2D([], [], color=MUTED, lw=0.6, marker="o", ms=1.6, mfc=TEXT, mec=TEXT, label=t("shots and stations")),
    ]
    if found.body.sections.filled:
        handles.append(
            Line2D([], [], lw=0, marker="o", ms=3, mfc=PAPER, mec=WARNING, mew=0.6, label=t("a wall is missing"))
        )
    if any(loop.suspicious for loop in found.body.adjusted.loops):
        handles.append(Line2D([], [], color=FAIL, lw=1.0, label=t("loop to be checked")))
    if found.clearance is not None:
        handles.append(Line2D([], [], color=EXCAVATION, lw=1.2, label=t("planned excavation")))
    return handles

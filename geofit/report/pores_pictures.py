"""The pictures of a rock volume: slices, surface, network, sizes, and the curve of the representative volume."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from geofit.data.errors import MissingDependencyError
from geofit.data.languages import EN, Language
from geofit.report.pictures import DOTS, TYPE, WIDTH, png
from geofit.report.plots import colour_scale
from geofit.report.pores_chapter import PoresFindings, pores_picture
from geofit.report.scene import mesh_scene, network_scene
from geofit.report.style import CORE, LINE, MUTED, WARNING, drawing, quiet_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from geofit.implicit.mesh import TriangleMesh
    from geofit.pores.representative import RepresentativeVolume

__all__ = ["draw_pores", "settling_curve"]

#: Bars of a histogram.
BARS = 30
#: Room for the scale of colours below a picture, inches.
SCALE = 0.5
COLOUR = "#5c8fb0"


def draw_pores(found: PoresFindings, mesh: TriangleMesh, t: Language = EN) -> dict[str, bytes]:
    """Draw a rock volume; ``mesh`` is the surface of its pores, metres from its low corner.

    Returns
    -------
    dict of str to bytes
        PNG by the names in the report; no pictures in space where there is no OpenGL library.
    """
    with drawing(TYPE):
        drawn = {"slices": png(_slices(found, t)), "settling": png(_settling(found, t))}
        if len(found.network.pores):
            drawn["sizes"] = png(_sizes(found, t))
        # Without OpenGL the report has its other pictures.
        with suppress(MissingDependencyError):
            drawn |= _in_space(found, mesh, t)
    return {pores_picture(what, found.name): data for what, data in drawn.items()}


def _slices(found: PoresFindings, t: Language) -> Figure:
    from matplotlib.figure import Figure

    pore, size = found.volume.pore, np.array(found.volume.size) * 1e3
    figure = Figure(figsize=(WIDTH, 2.5), dpi=DOTS)
    for axis in range(3):
        across, along = (k for k in range(3) if k != axis)
        axes = figure.add_axes((0.07 + axis * 0.325, 0.2, 0.25, 0.66))
        layer = np.take(pore, pore.shape[axis] // 2, axis=axis)
        axes.imshow(
            ~layer, cmap="gray", vmin=-0.25, vmax=1.15, interpolation="nearest", origin="lower",
            extent=(0, size[along], 0, size[across]),
        )  # fmt: skip
        axes.set_title(t("middle of axis {axis}", axis=axis), size=8)
        axes.set_xlabel(t("axis {axis}, mm", axis=along))
        axes.set_ylabel(t("axis {axis}, mm", axis=across))
        axes.locator_params(nbins=4)
        quiet_axes(axes)
    return figure


def _settling(found: PoresFindings, t: Language) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, 2.5), dpi=DOTS)
    axes = figure.add_axes((0.085, 0.2, 0.6, 0.74))
    settling_curve(axes, found.settling, found.volume.porosity, t)
    axes.grid(color=LINE, lw=0.5)
    axes.set_axisbelow(True)
    quiet_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(1.03, 1.0), borderaxespad=0)
    return figure


def settling_curve(axes: Axes, settling: RepresentativeVolume, porosity: float, t: Language = EN) -> None:
    """Draw the porosity of cubes by their edge: mean, lowest and highest, and that of the whole sample."""
    edge = settling.edge * 1e3
    low, high = 100 * settling.lowest, 100 * settling.highest
    axes.fill_between(edge, low, high, color=COLOUR, alpha=0.25, lw=0, label=t("all cubes"))
    axes.plot(edge, 100 * settling.mean, "o-", ms=3, color=CORE, lw=1.2, label=t("mean"))
    axes.axhline(100 * porosity, color=MUTED, lw=0.9, ls="dashed", label=t("whole sample"))
    axes.set_xlabel(t("Edge of the cubes, mm"))
    axes.set_ylabel(t("Porosity, %"))
    axes.set_ylim(bottom=0)


def _sizes(found: PoresFindings, t: Language) -> Figure:
    from matplotlib.figure import Figure

    network, unit = found.network, found.network.unit * 1e6
    figure = Figure(figsize=(WIDTH, 2.5), dpi=DOTS)
    pores, throats = network.pores.inscribed * unit, network.throats.inscribed * unit
    bins = np.linspace(
        0.0, float(max(pores.max(initial=0.0), throats.max(initial=0.0))) * 1.02 or 1.0, BARS + 1
    ).tolist()
    left = figure.add_axes((0.085, 0.2, 0.37, 0.66))
    for radius, colour, label in ((pores, COLOUR, t("pores")), (throats, WARNING, t("throats"))):
        if len(radius):
            left.hist(radius, bins, weights=np.full(len(radius), 100 / len(radius)), histtype="stepfilled", alpha=0.45,
                      color=colour, ec=colour, lw=1.0, label=label)  # fmt: skip
    left.set_title(t("By number"))
    left.set_ylabel(t("Share, %"))
    left.legend()
    right = figure.add_axes((0.6, 0.2, 0.37, 0.66))
    volume = network.pores.volume
    right.hist(pores, bins, weights=100 * volume / volume.sum(), histtype="stepfilled", alpha=0.45, color=COLOUR,
               ec=COLOUR, lw=1.0)  # fmt: skip
    right.set_title(t("Pores by volume"))
    right.set_ylabel(t("Share of the pore volume, %"))
    for axes in (left, right):
        axes.set_xlabel(t("Radius, µm"))
        axes.grid(axis="y", color=LINE, lw=0.5)
        axes.set_axisbelow(True)
        quiet_axes(axes)
    return figure


def _in_space(found: PoresFindings, mesh: TriangleMesh, t: Language) -> dict[str, bytes]:
    from matplotlib.figure import Figure

    # In millimetres: a picture is drawn with seven digits.
    size = np.array(found.volume.size) * 1e3
    scenes = {}
    if len(mesh.triangles):
        scenes["surface"] = mesh_scene(mesh.vertices * 1e3, mesh.triangles, np.empty((0, 3)), COLOUR)
    network = found.network
    if len(network.pores):
        scenes["network"] = network_scene(
            network.centre * 1e3, network.pores.inscribed * network.unit * 1e3, network.throats.pores, size
        )
    drawn = {}
    for what, scene in scenes.items():
        tall = min(WIDTH * scene.image.shape[0] / scene.image.shape[1], 3.3)
        below = SCALE if what == "network" else 0.0
        figure = Figure(figsize=(WIDTH, tall + below), dpi=DOTS)
        axes = figure.add_axes((0, below / (tall + below), 1, tall / (tall + below)))
        axes.imshow(scene.image, interpolation="antialiased")
        axes.set_axis_off()
        if below:
            low, high = scene.limits
            colour_scale(axes, (low * 1e3, high * 1e3), t("Radius, µm"))
        drawn[what] = png(figure)
    return drawn

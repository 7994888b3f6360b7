"""The picture of a section: what a vertical curtain cuts, drawn as geologists draw it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from geofit.data.files import replacing
from geofit.report.style import LINE, MUTED, TEXT, drawing, horizon_colours, quiet_axes
from geofit.sampling.cut import CutLine

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["write_section_picture"]

#: A section flatter than this is drawn higher, and reports it.
FLATTEST, HIGHEST = 1 / 6, 5.0


def write_section_picture(
    cuts: Mapping[str, Sequence[CutLine]],
    corners: NDArray[np.float64],
    path: str | PathLike[str],
) -> None:
    """Draw a section to scale; where it would be a thin strip, with elevations drawn up to 5 times higher.

    Parameters
    ----------
    cuts : mapping of str to sequence of CutLine
        Lines by horizon.
    corners : (k, 2) array
        The section's line in plan, map coordinates, metres.
    path : path
        The PNG.
    """
    from matplotlib.figure import Figure

    bends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    z = np.concatenate([line.xyz[:, 2] for lines in cuts.values() for line in lines] or [np.zeros(1)])
    low, high = float(z.min()), float(z.max())
    room = max(0.06 * (high - low), 0.005 * bends[-1])
    tall = high - low + 2 * room
    scale = _exaggeration(tall / bends[-1])
    width = 11.0
    inner = 0.86 * width * scale * tall / bends[-1]
    height = float(np.clip(inner, 1.4, 9.0)) + 1.9
    with drawing():
        figure = Figure(figsize=(width, height), dpi=150)
        axes = figure.add_axes((0.08, 0.95 / height, 0.86, 1 - 1.9 / height))
        for distance in bends[1:-1]:
            axes.axvline(distance, color=LINE, lw=0.9, zorder=0)
        colours = horizon_colours(cuts)
        for name, lines in cuts.items():
            for line in lines:
                axes.plot(
                    line.distance,
                    line.xyz[:, 2],
                    color=colours[name],
                    lw=1.6,
                    label=name if line is lines[0] else None,
                )
        axes.set_xlim(0, bends[-1])
        axes.set_ylim(low - room, high + room)
        axes.set_aspect(scale)
        axes.set_xlabel("Distance along the section, m")
        axes.set_ylabel("Elevation, m")
        axes.yaxis.grid(True, color=LINE, lw=0.6)
        quiet_axes(axes)
        if axes.lines:
            axes.legend(loc="upper left", bbox_to_anchor=(0, -0.55 / (height - 1.9)), ncols=6, borderaxespad=0)
        start, end = (f"({x:.1f}, {y:.1f})" for x, y in (corners[0], corners[-1]))
        figure.text(0.08, 1 - 0.4 / height, "Section", size=13, weight="bold", color=TEXT)
        words = "true to scale" if scale == 1 else f"elevations {scale:g} times higher"
        figure.text(0.08, 1 - 0.68 / height, f"{start} to {end} · {words}", size=8.5, color=MUTED)
        with replacing(path) as part:
            figure.savefig(part, format="png", metadata={"Software": None})


def _exaggeration(shape: float) -> float:
    """Return 1, 1.5, 2, 3 or 5: the least that makes the drawing no flatter than wanted."""
    return next((scale for scale in (1.0, 1.5, 2.0, 3.0) if shape * scale >= FLATTEST), HIGHEST)

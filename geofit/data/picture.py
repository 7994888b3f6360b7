"""Small pictures for notebooks: a plan of points and outlines as SVG, and a table, without a plotting library."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["LEVELS", "card", "deviation_colours", "plan_svg"]

Floats = NDArray[np.float64]

#: Longest side of a picture in pixels, and its margin.
SIDE, MARGIN = 240, 6
#: More points than these are thinned out evenly: a page with many fits stays light.
MOST = 1_500
#: Colours of points below the surface, near it, and above it, the farther the darker.
LEVELS = {-2: "#08335a", -1: "#2a7fbd", 0: "#8f8f8a", 1: "#d5701a", 2: "#742603"}


def deviation_colours(deviation: ArrayLike, near: float, far: float) -> NDArray[np.str_]:
    """Return the colour of each signed deviation (n,), metres: grey up to ``near``, dark beyond ``far``.

    Examples
    --------
    >>> deviation_colours([0.0, 0.2, -3.0], near=0.1, far=0.5).tolist()
    ['#8f8f8a', '#d5701a', '#08335a']
    """
    d = np.asarray(deviation, float)
    level = np.sign(d) * ((np.abs(d) > near).astype(int) + (np.abs(d) > far))
    return np.array([LEVELS[int(k)] for k in level], dtype=np.str_)


def plan_svg(
    groups: Iterable[tuple[ArrayLike, str | Sequence[str] | NDArray[np.str_]]],
    outlines: Iterable[ArrayLike] = (),
) -> str:
    """Draw points and outlines in plan.

    Parameters
    ----------
    groups : iterable of ((n, 2) array_like, colour or n colours)
        Points in map coordinates, metres.
    outlines : iterable of (k, 2) array_like
        Closed polygons.

    Returns
    -------
    str
        An ``<svg>`` element; empty without any place.
    """
    dots = [(np.asarray(xy, float).reshape(-1, 2), colour) for xy, colour in groups]
    lines = [np.asarray(line, float).reshape(-1, 2) for line in outlines]
    places = np.concatenate([xy for xy, _ in dots] + lines or [np.empty((0, 2))])
    if not len(places):
        return ""
    low, span = places.min(axis=0), np.ptp(places, axis=0)
    scale = SIDE / max(float(span.max()), 1e-9)
    width, height = np.ceil(span * scale + 2 * MARGIN).astype(int).tolist()

    def pixels(xy: Floats) -> Floats:
        moved = (xy - low) * scale + MARGIN
        return np.column_stack([moved[:, 0], height - moved[:, 1]])

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">']
    for line in lines:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in pixels(line))
        parts.append(f'<polygon points="{path}" fill="none" stroke="#5d6b7a"/>')
    for xy, colour in dots:
        some = np.unique(np.linspace(0, len(xy) - 1, min(len(xy), MOST)).round().astype(int))
        place, colours = pixels(xy[some]), np.broadcast_to(np.asarray(colour), len(xy))[some]
        for one in np.unique(colours):
            # Dots as very short lines with round ends: a tenth of the text of as many circles.
            path = "".join(f"M{x:.1f} {y:.1f}h.01" for x, y in place[colours == one])
            parts.append(f'<path d="{path}" stroke="{one}" stroke-width="3.6" stroke-linecap="round"/>')
    return "".join([*parts, "</svg>"])


def card(title: str, rows: Mapping[str, object], picture: str = "") -> str:
    """Return a title, a table of names and values, and a picture next to it as HTML; texts are escaped."""
    table = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(str(value))}</td></tr>'
        for name, value in rows.items()
    )
    return (
        f'<div style="display:flex;gap:1em;align-items:flex-start"><div><b>{escape(title)}</b>'
        f"<table>{table}</table></div>{picture}</div>"
    )

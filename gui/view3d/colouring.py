"""Colours of points and surfaces, and what they mean. Plain arrays: no Qt, no VTK."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.checks.check import ANGLE_LIMIT, GAP_LIMIT
from geofit.data.accuracy import Seam
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.gui.lengths import in_lengths, length_mark, shown_length
from geofit.gui.view3d.layers import Legend, Swatch
from geofit.report.style import FAIL, PASS, bands, kind_style, rgb

__all__ = ["SIZE", "PointColours", "Ramp", "legible_on", "plain_points", "points_by", "ramp", "seam_colours"]

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]

#: Colours of the ramps, from low to high: lightness runs one way in each.
RAMPS = {
    "elevation": ("#23506b", "#55877f", "#9dba8c", "#e2d9a4", "#f3e6c8"),
    "standard deviation": ("#f6f1e4", "#e9c79b", "#cf8a72", "#9c4a63", "#5b2150"),
    "dip": ("#eef3ee", "#b9d3bf", "#7fae9c", "#467f83", "#23506b"),
    "thickness": ("#f4efe0", "#cfdcbb", "#8fbfae", "#4f8fa6", "#2a5a8a"),
}
UNITS = {"elevation": "m", "standard deviation": "m", "dip": "°", "thickness": "m", "deviation": "m"}
STEPS = 256
#: Diameter of a point, logical pixels.
SIZE = 8.0


@dataclass(frozen=True, eq=False)
class Ramp:
    """Colours (k, 3) for values from ``low`` to ``high``; values outside have the ends' colours."""

    table: Bytes
    low: float
    high: float
    legend: Legend

    def of(self, values: Floats) -> Bytes:
        """Return the colour (n, 3) of each value; grey where it is nan."""
        return np.where(np.isfinite(values)[:, None], self.table[self.steps(values)], np.uint8(160))

    def steps(self, values: Floats) -> Bytes:
        """Return the place (n,) of each value in the table; 0 where it is nan."""
        share = values - self.low
        share *= STEPS / (self.high - self.low)
        np.nan_to_num(share, copy=False)
        return np.clip(share, 0, STEPS - 1, out=share).astype(np.uint8)


@dataclass(frozen=True, eq=False)
class PointColours:
    """A code (n,) for each point: its place among the ``shades`` (k, 3) and the ``sizes`` (k,) in pixels."""

    code: NDArray[np.integer]
    shades: Bytes
    sizes: Floats
    legend: Legend | None

    @property
    def colour(self) -> Bytes:
        """Colour of each point, (n, 3)."""
        return np.asarray(self.shades[self.code])

    @property
    def size(self) -> Floats:
        """Size of each point, (n,) pixels."""
        return np.asarray(self.sizes[self.code])


def legible_on(colour: str, dark: bool) -> str:
    """Return a colour that stands out from a dark background: the same hue, lighter where it is too dark."""
    if not dark:
        return colour
    h, light, s = colorsys.rgb_to_hls(*(c / 255 for c in rgb(colour)))
    r, g, b = colorsys.hls_to_rgb(h, max(light, 0.62), s)
    return f"#{round(255 * r):02x}{round(255 * g):02x}{round(255 * b):02x}"


def ramp(by: str, values: Floats, most: float | None = None) -> Ramp:
    """Return the colours for values (nan left out); the ends are at their least and largest.

    With ``most`` the upper end is there, and what is larger has its colour.
    """
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if by == "standard deviation":
        low = 0.0
    beyond = most is not None and high > most
    high = high if most is None else most
    high = max(high, low + 1e-3)
    stops = np.array([rgb(c) for c in RAMPS[by]], float)
    share = np.linspace(0, len(stops) - 1, STEPS)
    table = np.stack([np.interp(share, np.arange(len(stops)), stops[:, k]) for k in range(3)], axis=1)
    return Ramp(
        np.round(table).astype(np.uint8),
        low,
        high,
        length_legend(Legend(by, UNITS[by], (), RAMPS[by], low, high, beyond)),
    )


def plain_points(count: int, colour: str) -> PointColours:
    """Return one colour for all points."""
    return PointColours(
        np.broadcast_to(np.uint8(0), (count,)), np.array([rgb(colour)], np.uint8), np.array([SIZE]), None
    )


def points_by(
    by: str, points: PointSet, colour: str, residuals: Floats | None, settings: FitSettings, dark: bool
) -> PointColours:
    """Return the points' colours by "kind", "deviation" (fixed tolerance bands), "elevation", or one for all."""
    if by == "kind":
        labels = points.labels["kind"]
        shades = [legible_on(kind_style(kind)[1], dark) for kind in labels.table]
        used = np.bincount(labels.codes, minlength=len(shades)) > 0
        known = sorted((kind, shade) for kind, shade, there in zip(labels.table, shades, used, strict=True) if there)
        legend = Legend("kind", "", tuple(Swatch(shade, kind, False) for kind, shade in known))
        table = np.array([rgb(c) for c in shades], np.uint8).reshape(-1, 3)
        return PointColours(labels.codes, table, np.full(len(table), SIZE), legend)
    if by == "deviation" and residuals is not None and len(residuals) == len(points):
        return _by_bands(residuals, settings, dark)
    if by == "elevation":
        made = ramp("elevation", points.xyz[:, 2])
        return PointColours(made.steps(points.xyz[:, 2]), made.table, np.full(STEPS, SIZE), made.legend)
    return plain_points(len(points), colour)


def length_legend(legend: Legend) -> Legend:
    """Return a legend of metres in the unit that is shown."""
    if legend.unit != "m":
        return legend
    return replace(legend, unit=length_mark(), low=shown_length(legend.low), high=shown_length(legend.high))


def _by_bands(d: Floats, settings: FitSettings, dark: bool) -> PointColours:
    code = np.zeros(len(d), np.uint8)
    shades: list[tuple[int, int, int]] = []
    sizes: list[float] = []
    above: list[Swatch] = []
    below: list[Swatch] = []
    for k, band in enumerate(bands(settings, dark=dark)):
        for mask, shade in ((band.holds(d) & (d >= 0), band.above), (band.holds(d) & (d < 0), band.below)):
            code[mask] = len(shades)
            shades.append(rgb(shade))
            sizes.append(SIZE * (0.75 + 0.4 * k))
        label = in_lengths(band.label).removeprefix("|d| ").removesuffix(f" {length_mark()}")
        if k == 0:
            middle = Swatch(band.above, f"± {label.removeprefix('< ')}")
        else:
            above.insert(0, Swatch(band.above, f"+ {label}"))
            below.append(Swatch(band.below, f"− {label}"))
    legend = Legend("deviation", length_mark(), (*above, middle, *below))
    return PointColours(code, np.array(shades, np.uint8), np.array(sizes), legend)


def seam_colours(seams: Sequence[Seam], by: str, dark: bool) -> tuple[tuple[str, ...], Legend]:
    """Return the colour of each seam by its "gap" or "angle": below a tenth of the limit, below it, above it."""
    limit, unit = (GAP_LIMIT, "m") if by == "gap" else (ANGLE_LIMIT, "°")
    shades = tuple(legible_on(c, dark) for c in (PASS, "#c98a12", FAIL))
    values = [seam.gap if by == "gap" else seam.angle for seam in seams]
    chosen = tuple(shades[0 if v <= limit / 10 else 1 if v <= limit else 2] for v in values)
    words = (f"≤ {limit / 10:g}", f"≤ {limit:g}", f"> {limit:g}")
    return chosen, Legend(by, unit, tuple(Swatch(c, w) for c, w in zip(shades, words, strict=True)))

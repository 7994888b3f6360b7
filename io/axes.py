"""Exchanged axes: easting where northing belongs."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.rows import Rows

__all__ = ["Region", "check_axes", "grown_box", "place_in"]

Floats = NDArray[np.float64]

#: Bins along the longer side of all places; fewer than 20, so that rounding does no harm.
_BINS = 19
#: Places that are counted together.
_CHUNK = 1 << 16
#: Rows are strays beyond this many extents of the others, if they are no more than this share of all.
STRAY, STRAYS = 3.0, 0.05
#: (0, 0) is a placeholder where the places lie farther than this from it, metres.
ORIGIN = 1000.0

#: West, east, south, north of the place where points are expected, metres.
Region = tuple[float, float, float, float]


def grown_box(xy: Floats) -> Region:
    """Return the box of (n, 2) places, grown on every side by its own diagonal."""
    low, high = xy.min(axis=0), xy.max(axis=0)
    margin = max(float(np.hypot(*(high - low))), 1.0)
    return (low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin)


def place_in(xy: Floats, region: Region) -> Literal["inside", "exchanged", "off"]:
    """Say where the middle of (n, 2) places lies: inside a region, inside it with x and y exchanged, or off it."""
    x, y = xy.mean(axis=0)
    if _inside(x, y, region):
        return "inside"
    return "exchanged" if _inside(y, x, region) else "off"


def check_axes(rows: Rows, x: Floats, y: Floats, region: Region | None) -> None:
    """Reject rows at the placeholder (0, 0) or whose x and y look exchanged, and warn of rows far off.

    A row looks exchanged when it lies outside ``region`` and would lie inside with x and y swapped. Without a
    region the rows themselves make one: 20 median distances around their median; of the rows outside it, the
    few that lie more than three extents of the others away from them are warned of.

    Raises
    ------
    InputError
        If most rows of the file look exchanged.
    """
    used = int(rows.ok.sum())
    if used == 0:
        return
    _reject_placeholders(rows, x, y, region)
    used = int(rows.ok.sum())
    known = region is not None
    box = region if region is not None else _crowd(x, y) if used == len(rows) else _crowd(x[rows.ok], y[rows.ok])
    if box is None:
        return
    far = np.flatnonzero(~_inside(x, y, box) & rows.ok)
    exchanged = _inside(y[far], x[far], box)
    swapped, off = far[exchanged], far[~exchanged]
    if known and 2 * len(swapped) > used:
        i = int(swapped[0])
        raise InputError(
            message(
                "io.axes-exchanged",
                "x and y appear to be exchanged: {count} of {total} rows lie far outside the study "
                "area, and inside it with x and y swapped, the first at x = {x:.15g}, y = {y:.15g}",
                count=len(swapped),
                total=used,
                x=x[i],
                y=y[i],
            ),
            message(
                "io.exchange-columns",
                "x is the easting, y the northing; exchange the columns "
                "(in many Chinese tables X is the northing and Y the easting).",
            ),
            file=rows.file,
            row=int(rows.line[i]),
            column=rows.table.header[rows.columns["x"]],
        )
    for i in swapped.tolist():
        rows.reject(
            i,
            "x",
            message("io.row-axes-exchanged", "x and y appear to be exchanged in this row"),
            message("io.x-is-easting", "x is the easting, y the northing."),
        )
    if not known:
        _warn_of_strays(rows, x, y, off, box)
    elif off.size:
        i = int(off[0])
        rows.warn(
            i,
            "x",
            message(
                "io.rows-far-outside",
                "Rows far outside the study area: {count}, the first at x = {x:.15g}, y = {y:.15g}",
                count=off.size,
                x=x[i],
                y=y[i],
            ),
            message("io.check-coordinates", "Check the coordinates and the boundary."),
        )


def _reject_placeholders(rows: Rows, x: Floats, y: Floats, region: Region | None) -> None:
    """Reject rows at (0, 0) where the other places are nowhere near: programs write it for a place that is unknown."""
    zero = (x == 0) & (y == 0) & rows.ok
    others = rows.ok & ~zero
    if not (zero.any() and others.any()):
        return
    box = region or _crowd(x[others], y[others]) or grown_box(np.column_stack((x[others], y[others])))
    if _Box(*box).away(0.0, 0.0) <= ORIGIN:
        return
    for i in np.flatnonzero(zero).tolist():
        rows.reject(
            i,
            "x",
            message("io.row-at-placeholder", "x = 0, y = 0 marks a place that is unknown: the others are far from it"),
            message("io.complete-coordinates", "Complete its coordinates, or remove the row."),
        )


def _warn_of_strays(rows: Rows, x: Floats, y: Floats, off: NDArray[np.intp], box: Region) -> None:
    """Warn of the few rows that lie several times the extent of all others away from them."""
    if not off.size:
        return
    middle = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    off = off[np.argsort(np.hypot(x[off] - middle[0], y[off] - middle[1]), kind="stable")]
    groups: list[list[int]] = [[]]
    around = _Box.of(x, y, _inside(x, y, box) & rows.ok)
    for i in off.tolist():
        # Outwards from the crowd: a thin rim widens the extent step by step, a gap begins another group.
        if around.away(x[i], y[i]) > STRAY * around.extent:
            groups.append([])
        groups[-1].append(i)
        around = around.with_place(x[i], y[i])
    few = max(1, int(STRAYS * rows.ok.sum()))
    strays = [i for group in groups[1:] if len({(x[i], y[i]) for i in group}) <= few for i in group]
    others = rows.ok.copy()
    others[strays] = False
    around = _Box.of(x, y, others)
    for i in strays:
        rows.warn(
            i,
            "x",
            message(
                "io.row-far-from-others",
                "x = {x:.15g}, y = {y:.15g} lies {distance:.0f} m from the other rows, which cover {extent:.0f} m",
                x=x[i],
                y=y[i],
                distance=around.away(x[i], y[i]),
                extent=around.extent,
            ),
            message("io.check-stray-coordinates", "Check its coordinates, or remove the row."),
        )


class _Box(NamedTuple):
    """What places cover: west, east, south, north."""

    west: float
    east: float
    south: float
    north: float

    @classmethod
    def of(cls, x: Floats, y: Floats, mask: NDArray[np.bool_]) -> _Box:
        return cls(x[mask].min(), x[mask].max(), y[mask].min(), y[mask].max())

    @property
    def extent(self) -> float:
        return max(float(np.hypot(self.east - self.west, self.north - self.south)), 1.0)

    def away(self, x: float, y: float) -> float:
        return float(np.hypot(max(self.west - x, x - self.east, 0.0), max(self.south - y, y - self.north, 0.0)))

    def with_place(self, x: float, y: float) -> _Box:
        return _Box(min(self.west, x), max(self.east, x), min(self.south, y), max(self.north, y))


def _crowd(x: Floats, y: Floats) -> Region | None:
    if x.size < 4 or spread_out(x, y):
        return None
    cx, cy = float(np.median(x)), float(np.median(y))
    away = x - cx
    np.hypot(away, y - cy, out=away)
    reach = 20.0 * float(np.median(away, overwrite_input=True)) + 1.0
    return (cx - reach, cx + reach, cy - reach, cy + reach)


def spread_out(x: Floats, y: Floats) -> bool:
    """Return whether places are so evenly spread that none can be far off, whatever their middle.

    Where no band of width 2 w across the longer side L = 20 w holds half of them, the median distance from any place is
    above w, and nobody is 20 of these from there. Bands are counted on bins of width w, of which each lies in three.
    """
    longer = max(x, y, key=np.ptp)
    low, length = float(longer.min()), float(np.ptp(longer))
    if not 0 < length < np.inf:
        return False
    bins = np.zeros(_BINS + 1, np.intp)
    for first in range(0, x.size, _CHUNK):
        part = (longer[first : first + _CHUNK] - low) * (_BINS / length)
        bins += np.bincount(part.astype(np.intp), minlength=_BINS + 1)
    return bool(2 * np.convolve(bins, np.ones(3, np.intp)).max() < x.size)


def _inside(x: Floats, y: Floats, box: Region) -> NDArray[np.bool_]:
    return (x >= box[0]) & (x <= box[1]) & (y >= box[2]) & (y <= box[3])

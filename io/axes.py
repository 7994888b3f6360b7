"""Exchanged axes: easting where northing belongs."""

from __future__ import annotations

import json
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.io.columns import plain_name
from geofit.io.rows import Rows

__all__ = ["Region", "check_axes", "check_elevations", "grown_box", "place_in"]

Floats = NDArray[np.float64]

#: Bins along the longer side of all places; fewer than 20, so that rounding does no harm.
_BINS = 19
#: Places that are counted together; of more than that, those that are evenly spread are not looked at one by one.
_CHUNK = _MANY = 1 << 16
#: Rows farther from the others than this many times their extent are strays, unless they exceed this share of all rows.
#: For the outermost rows the second number applies, if only one of their coordinates is off.
STRAY, OUTERMOST, STRAYS = 3.0, 1.0, 0.05
#: Rows too many to be strays, and farther from the others than this many times their extent, are in another system.
OTHER_SYSTEM = 20.0
#: The crowd within which places are looked at first, in median distances: any row in it with x and y exchanged is
#: taken for one; any beyond the nearer one may be a stray.
EXCHANGED_REACH, STRAY_REACH = 20.0, 4.0
#: Places of longitude and latitude cover less than this, degrees.
DEGREES = 10.0
#: Most elevations of a site that are farther from 0 are none, metres: the crust is half as thick.
HIGHEST = 1e5
#: What x and y are called where the header leaves open which is the easting.
_BARE = {"x", "y", "xcoord", "ycoord", "xcoordinate", "ycoordinate", "x坐标", "y坐标", "坐标x", "坐标y"}
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
    region the rows themselves make one, around their median; the few that lie farther from the others than these
    extend are warned of, and so is a table that seems to be in degrees, in two systems, or exchanged as a whole.

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
        _warn_of_digits(rows, x, y)
        return
    far = np.flatnonzero(~_inside(x, y, box if known else _doubled(box)) & rows.ok)
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
        _warn_of_halves(rows, x, y)
        _warn_of_digits(rows, x, y)
        _warn_of_strays(rows, x, y, swapped)
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


def check_elevations(rows: Rows, z: Floats) -> None:
    """Warn of elevations (n,) at which there is no rock: another column was taken for them, or another unit."""
    known = z[rows.ok & np.isfinite(z)]
    middle = float(np.median(np.abs(known))) if known.size else 0.0
    if middle <= HIGHEST:
        return
    rows.journal.add(
        "warning",
        rows.file,
        message(
            "io.elevations-not-possible",
            "The elevations are around {z:.0f} m, more than {most:.0f} m from sea level",
            z=float(np.median(known)),
            most=HIGHEST,
        ),
        message(
            "io.check-column-and-unit",
            "Check that this column contains elevations, not northings or eastings, and their unit.",
        ),
        column=rows.table.header[rows.columns["z"]],
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


def _warn_of_halves(rows: Rows, x: Floats, y: Floats) -> None:
    """Warn of two groups far apart of which one lies on the other with x and y exchanged: which one is not clear."""
    first, second = rows.ok & (x < y), rows.ok & (x > y)
    if not (first.any() and second.any()):
        return
    group, other, turned = _Box.of(x, y, first), _Box.of(x, y, second), _Box.of(y, x, second)
    extent = max(group.extent, other.extent)
    if group.apart(other) < OTHER_SYSTEM * extent or group.apart(turned) > extent:
        return
    i, k = int(np.flatnonzero(first)[0]), int(np.flatnonzero(second)[0])
    rows.warn(
        max(i, k),
        "x",
        message(
            "io.half-of-axes-exchanged",
            "x and y appear to be exchanged in {count} of {total} rows: x is around {x:.0f} in row {row}, and {y:.0f} "
            "in row {other}",
            count=min(int(first.sum()), int(second.sum())),
            total=int(rows.ok.sum()),
            x=x[min(i, k)],
            y=x[max(i, k)],
            row=int(rows.line[min(i, k)]),
            other=int(rows.line[max(i, k)]),
        ),
        message("io.x-is-easting", "x is the easting, y the northing."),
    )


def _warn_of_digits(rows: Rows, x: Floats, y: Floats) -> None:
    """Warn of a table whose coordinates have the digits of degrees, or of a northing under x and an easting under y."""
    east, north = x[rows.ok], y[rows.ok]
    headers = [rows.table.header[rows.columns[role]] for role in ("x", "y")]
    extent = max(float(np.ptp(east)), float(np.ptp(north)))
    least, most = sorted((float(np.abs(east).max()), float(np.abs(north).max())))
    degrees = least <= 90.0 and most <= 180.0 and 0 < extent < DEGREES
    if degrees and not any((part == np.round(part, 2)).all() for part in (east, north)):
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.places-like-degrees",
                "All rows lie within {extent:.3g} m, around x = {x:.7g}, y = {y:.7g}: they may be longitude and "
                "latitude, and are read as metres",
                extent=extent,
                x=float(np.median(east)),
                y=float(np.median(north)),
            ),
            message(
                "io.state-degrees",
                "If they are degrees, name the columns longitude and latitude, and state the grid of the site: "
                '[site] crs = "EPSG:..." (geofit fit and geofit import: --crs).',
            ),
            column=headers[0],
        )
    # Northings have seven digits; eastings six, or eight with the zone in front. A header that names them is believed.
    first, second = float(np.median(np.abs(east))), float(np.median(np.abs(north)))
    named = {plain_name(header)[0] for header in headers}
    if named <= _BARE and 1e6 <= first < 1e7 and (1e5 <= second < 1e6 or 1e7 <= second < 1e8):
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.axes-like-exchanged",
                "x is around {x:.0f}, of seven digits like a northing, y around {y:.0f}, of {digits} like an easting: "
                "they may be exchanged, and the site would be mirrored",
                x=first,
                y=second,
                digits=message("io.six-digits", "six") if second < 1e6 else message("io.eight-digits", "eight"),
            ),
            message(
                "io.state-columns-exchanged",
                "x is the easting. If they are exchanged, state columns = {{ x = {y}, y = {x} }} in a site or mapping "
                "file; otherwise name the columns easting and northing.",
                x=Untranslated(json.dumps(headers[0], ensure_ascii=False)),
                y=Untranslated(json.dumps(headers[1], ensure_ascii=False)),
            ),
            column=headers[0],
        )


def _warn_of_strays(rows: Rows, x: Floats, y: Floats, swapped: NDArray[np.intp]) -> None:
    """Warn of the few rows that lie farther from all others than these extend, and of many that lie much farther."""
    used = rows.ok.copy()
    used[swapped] = False
    box = _crowd(x[used], y[used], STRAY_REACH)
    if box is None:
        return
    middle = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    inside = _inside(x, y, box) & used
    off = np.flatnonzero(used & ~inside)
    if not off.size or not inside.any():
        return
    off = off[np.argsort(np.hypot(x[off] - middle[0], y[off] - middle[1]), kind="stable")]
    gaps, extents = _gaps(x, y, off, _Box.of(x, y, inside))
    # Outwards from the crowd: a thin rim widens the extent step by step, a gap begins another group.
    starts = np.flatnonzero(gaps > STRAY * extents)
    few = max(1, int(STRAYS * used.sum()))
    strays: set[int] = set()
    for start, group in zip(starts.tolist(), np.split(off, starts)[1:], strict=True):
        if len(set(zip(x[group].tolist(), y[group].tolist(), strict=True))) <= few:
            strays.update(group.tolist())
        elif gaps[start] > OTHER_SYSTEM * extents[start]:
            _warn_of_system(rows, group, float(gaps[start]), float(extents[start]), x, y)
    last = off[-few:]
    outermost = np.flatnonzero(gaps[-few:] > OUTERMOST * extents[-few:])
    if outermost.size:
        tail = last[outermost[0] :]
        others = used.copy()
        others[tail] = False
        around = _Box.of(x, y, others)
        # A wrong digit moves one coordinate; a hole farther out is mostly so in both.
        strays.update(i for i in tail.tolist() if around.off_in_one(x[i], y[i]))
    others = used.copy()
    others[list(strays)] = False
    around = _Box.of(x, y, others)
    for i in sorted(strays):
        rows.warn(
            i,
            "y" if max(around.south - y[i], y[i] - around.north) > max(around.west - x[i], x[i] - around.east) else "x",
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


def _gaps(x: Floats, y: Floats, off: NDArray[np.intp], crowd: _Box) -> tuple[Floats, Floats]:
    """Return how far each of the rows ``off`` lies from the crowd and the rows before it, and how far these extend."""
    west, south = (
        np.minimum.accumulate(np.r_[low, part[off]])[:-1] for low, part in ((crowd.west, x), (crowd.south, y))
    )
    east, north = (
        np.maximum.accumulate(np.r_[high, part[off]])[:-1] for high, part in ((crowd.east, x), (crowd.north, y))
    )
    aside = np.maximum(np.maximum(west - x[off], x[off] - east), 0.0)
    along = np.maximum(np.maximum(south - y[off], y[off] - north), 0.0)
    return np.hypot(aside, along), np.maximum(np.hypot(east - west, north - south), 1.0)


def _warn_of_system(rows: Rows, group: NDArray[np.intp], distance: float, extent: float, x: Floats, y: Floats) -> None:
    """Warn once of many rows that lie so far from the others that one surface cannot be meant."""
    i = int(group.min())
    rows.warn(
        i,
        "x",
        message(
            "io.rows-of-another-system",
            "{count} rows lie {distance:.0f} m from the others, which cover {extent:.0f} m, the first at x = {x:.15g}, "
            "y = {y:.15g}: they may be in another coordinate system",
            count=len(group),
            distance=distance,
            extent=extent,
            x=x[i],
            y=y[i],
        ),
        message("io.convert-or-split", "Convert them to the system of the others, or import two sites one by one."),
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

    def off_in_one(self, x: float, y: float) -> bool:
        """Return whether a place lies outside in one coordinate, and inside in the other."""
        return (self.west <= x <= self.east) != (self.south <= y <= self.north)

    def apart(self, other: _Box) -> float:
        """Return how far two boxes lie from each other."""
        aside = max(other.west - self.east, self.west - other.east, 0.0)
        return float(np.hypot(aside, max(other.south - self.north, self.south - other.north, 0.0)))

    def away(self, x: float, y: float) -> float:
        return float(np.hypot(max(self.west - x, x - self.east, 0.0), max(self.south - y, y - self.north, 0.0)))


def _crowd(x: Floats, y: Floats, reach: float = EXCHANGED_REACH) -> Region | None:
    """Return the box of so many median distances around the median; None of few or evenly spread places."""
    if x.size < 4 or (x.size > _MANY and spread_out(x, y)):
        return None
    # Of two halves that lie far apart, the middle of one, not a place between them.
    cx, cy = (float(np.quantile(part, 0.5, method="lower")) for part in (x, y))
    away = x - cx
    np.hypot(away, y - cy, out=away)
    reach = reach * float(np.quantile(away, 0.5, method="lower", overwrite_input=True)) + 1.0
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


def _doubled(box: Region) -> Region:
    """Return the box of twice the sides around the same middle: a row outside it is far from the crowd."""
    west, east, south, north = box
    wide, high = (east - west) / 2, (north - south) / 2
    return (west - wide, east + wide, south - high, north + high)


def _inside(x: Floats, y: Floats, box: Region) -> NDArray[np.bool_]:
    return (x >= box[0]) & (x <= box[1]) & (y >= box[2]) & (y <= box[3])

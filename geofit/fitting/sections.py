"""Sections: named in the data, or found in it as straight lines of points in plan (METHOD, sec. 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from geofit.data.points import PointSet

__all__ = ["crossing_lines", "find_sections", "section_labels"]

Floats = NDArray[np.float64]

#: Share of all points' nearest neighbours that must lie in one direction, within ``ALIGNED`` degrees.
SHARE, ALIGNED = 0.25, 1.5
#: Fewest points of a line.
FEWEST = 5
#: More points than these were not drawn on sections by anybody.
MOST = 20_000
#: How far a point may lie off its line, as a share of the median distance to the nearest neighbour.
STRAY = 0.1
#: Neighbours of a point among which one on another line is looked for; lines that cross do so by more than these
#: degrees.
AROUND, CROSSING = 12, 30.0


def section_labels(points: PointSet) -> NDArray[np.str_]:
    """Return (n,) the section of each point: as named, or as found where none is named; empty for the others."""
    if not 4 * FEWEST <= len(points) <= MOST or (points.section != "").any():
        return points.section
    return find_sections(points.xyz[:, :2])


def find_sections(plan: Floats) -> NDArray[np.str_]:
    """Find parallel straight lines of points in plan.

    The directions to the two nearest neighbours of every point are counted; in points drawn on sections one
    direction stands out. Across it the points are grouped by their offset.

    Parameters
    ----------
    plan : (n, 2) array
        Easting and northing, metres.

    Returns
    -------
    labels : (n,) array of str
        "line 1", "line 2", ... from one side to the other; empty for points on no line, and for all if fewer
        than two lines are found.
    """
    found_at = KDTree(plan).query(plan, k=3)
    distance, index = np.asarray(found_at[0]), np.asarray(found_at[1])
    step = (plan[index[:, 1:]] - plan[:, None]).reshape(-1, 2)
    return _lines(plan, step, float(np.median(distance[:, 1])))


def crossing_lines(plan: Floats, lines: NDArray[np.str_]) -> NDArray[np.str_]:
    """Find the lines that cross those found: points on a grid lie on lines of two directions.

    Parameters
    ----------
    plan : (n, 2) array
        Easting and northing, metres.
    lines : (n,) array of str
        What :func:`find_sections` found.

    Returns
    -------
    labels : (n,) array of str
        Names of the other lines, empty for points on none.
    """
    labels = np.full(len(plan), "", dtype="<U12")
    on_line = np.flatnonzero(lines != "")
    # Coincident points have no direction.
    at, first, back = np.unique(plan[on_line], axis=0, return_index=True, return_inverse=True)
    if len(at) <= AROUND:
        return labels
    mine = lines[on_line][first]
    found_at = KDTree(at).query(at, k=AROUND)
    distance, index = np.asarray(found_at[0]), np.asarray(found_at[1])
    step = at[index] - at[:, None]
    turned = np.exp(2j * np.arctan2(step[..., 1], step[..., 0]))
    other = mine[index] != mine[:, None]
    # The first neighbour of a place is the place itself.
    along = turned[:, 1:][~other[:, 1:]]
    if not len(along):
        return labels
    row = np.flatnonzero(other.any(axis=1))
    nearest = other[row].argmax(axis=1)
    off = np.degrees(np.abs(np.angle(turned[row, nearest] / along.mean()))) / 2
    crossing = _lines(at, step[row, nearest][off > CROSSING], float(np.median(distance[:, 1])))
    labels[on_line] = crossing[back.reshape(-1)]
    return labels


def _lines(plan: Floats, step: Floats, spacing: float) -> NDArray[np.str_]:
    """Return (n,) the lines in the direction in which most of the steps (k, 2) between neighbours lie.

    Parameters
    ----------
    plan : (n, 2) array
        Easting and northing, metres.
    step : (k, 2) array
        From points to their neighbours, metres.
    spacing : float
        Median distance to the nearest neighbour, metres.
    """
    none = np.full(len(plan), "", dtype="<U12")
    step = step[np.linalg.norm(step, axis=1) > 0]
    if len(step) == 0:
        return none
    angle = np.degrees(np.arctan2(step[:, 1], step[:, 0])) % 180
    peak = int(_counts(angle).argmax())
    aligned = np.abs((angle - peak + 90) % 180 - 90) <= ALIGNED
    if aligned.mean() < SHARE:
        return none
    doubled = np.exp(2j * np.radians(angle[aligned])).mean()
    direction = np.angle(doubled) / 2
    offset = plan @ np.array([np.sin(direction), -np.cos(direction)])
    order = np.argsort(offset, kind="stable")
    group = np.cumsum(np.concatenate([[0], np.diff(offset[order]) > STRAY * spacing]))
    along = plan @ np.array([np.cos(direction), np.sin(direction)])
    labels, found = none.copy(), 0
    for k in range(int(group[-1]) + 1):
        members = order[group == k]
        if len(members) >= FEWEST and np.ptp(along[members]) > 3 * spacing:
            found += 1
            labels[members] = f"line {found}"
    return labels if found >= 2 else none


def _counts(angle: Floats) -> NDArray[np.int64]:
    """Return how many of some directions, 0 to 180, are within ``ALIGNED`` of 0, 1, ... 179 degrees."""
    once = np.sort(angle)
    around = np.concatenate([once - 180, once, once + 180])
    degrees = np.arange(180)
    return np.asarray(around.searchsorted(degrees + ALIGNED, "right") - around.searchsorted(degrees - ALIGNED, "left"))

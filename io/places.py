"""Points of one horizon that share a place, listed before a fit has to resolve them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.io.journal import MOST, Journal

__all__ = ["list_places"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points that are worked on together: they stay in the processor's cache.
CHUNK = 1 << 15


def list_places(
    horizon: str, points: PointSet, journal: Journal, nearness: float = 0.01, *, steep: bool = False
) -> None:
    """List points that lie within ``nearness`` (m) of another in plan: repeated, or at two elevations.

    All of them stay in use; the fit resolves them by accuracy. A single point is listed too. A ``steep`` horizon, such
    as a fault over its best plane or a fold, has several elevations at one location.
    """
    if len(points) == 1:
        journal.add(
            "warning",
            points.labels["file"].word(0),
            message("io.horizon-of-one-point", "Horizon {horizon} has one point only", horizon=horizon),
            message("io.give-three-points", "Three or more are needed for a surface."),
            row=int(points.row[0]),
            value=horizon,
        )
    order, repeated = _repeated(points.xyz, nearness)
    # One word each of the first: a file may repeat one row millions of times.
    if len(repeated) > MOST:
        journal.add(
            "warning",
            points.labels["file"].word(int(order[repeated[MOST]])),
            message(
                "io.horizon-points-repeated",
                "Horizon {horizon}: {count} points lie at the place of another; the first {most} are listed",
                horizon=horizon,
                count=len(repeated),
                most=MOST,
            ),
            message("io.remove-repeated", "Remove what is repeated."),
        )
    for k in repeated[:MOST].tolist():
        i, j = int(order[k]), int(order[k + 1])
        rise = float(points.xyz[j, 2] - points.xyz[i, 2])
        before = points.describe(i)
        if abs(rise) <= nearness:
            journal.add(
                "note",
                points.labels["file"].word(j),
                message(
                    "io.horizon-point-repeated",
                    "Horizon {horizon}: the point repeats {before}",
                    horizon=horizon,
                    before=before,
                ),
                row=int(points.row[j]),
            )
        elif not steep:
            journal.add(
                "warning",
                points.labels["file"].word(j),
                message(
                    "io.horizon-elevations-differ",
                    "Horizon {horizon}: two elevations at one location, {rise:+.3f} m against {before}",
                    horizon=horizon,
                    rise=rise,
                    before=before,
                ),
                message(
                    "io.correct-or-state-accuracy",
                    "Correct one of them, or state accuracies: the fit keeps the more accurate one.",
                ),
                row=int(points.row[j]),
                column="z",
                value=f"{points.xyz[j, 2]:.15g}",
            )


def _repeated(xyz: Floats, nearness: float) -> tuple[Ints, Ints]:
    """Return points by their cells of a grid, those of one cell in their order, and where one follows its like."""
    keys = np.zeros(len(xyz), np.uint64)
    for first in range(0, len(xyz), CHUNK):
        part = keys[first : first + CHUNK]
        for column in xyz[first : first + CHUNK, :2].T:
            # Equal places have equal keys; the few others that have them too are told apart below.
            part *= np.uint64(0x9E3779B97F4A7C15)
            part ^= np.floor(column / nearness + 0.5).view(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
            part ^= part >> np.uint64(29)
    ordered = np.sort(keys)
    met = np.unique(ordered[1:][ordered[1:] == ordered[:-1]])
    del ordered
    some = np.empty(0, np.int64)
    if len(met):
        parts = (keys[first : first + CHUNK] for first in range(0, len(keys), CHUNK))
        some = np.flatnonzero(np.concatenate([np.isin(part, met) for part in parts]))
    cell = np.floor(xyz[some, :2] / nearness + 0.5)
    order = np.lexsort((some, cell[:, 1], cell[:, 0]))
    same = (np.diff(cell[order], axis=0) == 0).all(axis=1)
    return some[order], np.flatnonzero(same)

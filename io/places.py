"""Points of one horizon that share a place, listed before a fit has to settle them."""

from __future__ import annotations

import numpy as np

from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.io.journal import MOST, Journal

__all__ = ["list_places"]


def list_places(horizon: str, points: PointSet, journal: Journal, nearness: float = 0.01) -> None:
    """List points that lie within ``nearness`` (m) of another in plan: repeated, or at two elevations.

    All of them stay in use; the fit settles them by accuracy. A single point is listed too.
    """
    if len(points) == 1:
        journal.add(
            "warning",
            str(points.file[0]),
            message("import.horizon-point", "Horizon {horizon} has one point only", horizon=horizon),
            message("import.three-needed-surface", "Three or more are needed for a surface."),
            row=int(points.row[0]),
            value=horizon,
        )
    cell = np.floor(points.xyz[:, :2] / nearness + 0.5)
    order = np.lexsort((np.arange(len(points)), cell[:, 1], cell[:, 0]))
    same = (np.diff(cell[order], axis=0) == 0).all(axis=1)
    # One word each of the first: a file may repeat one row millions of times.
    repeated = np.flatnonzero(same)
    if len(repeated) > MOST:
        journal.add(
            "warning",
            str(points.file[order[repeated[MOST]]]),
            message(
                "import.horizon-points-place",
                "Horizon {horizon}: {count} points lie at the place of another; the first {most} are listed",
                horizon=horizon,
                count=len(repeated),
                most=MOST,
            ),
            message("import.remove-what-repeated", "Remove what is repeated."),
        )
    for k in repeated[:MOST].tolist():
        i, j = int(order[k]), int(order[k + 1])
        rise = float(points.xyz[j, 2] - points.xyz[i, 2])
        before = points.describe(i)
        if abs(rise) <= nearness:
            journal.add(
                "note",
                str(points.file[j]),
                message(
                    "import.horizon-point-repeats",
                    "Horizon {horizon}: the point repeats {before}",
                    horizon=horizon,
                    before=before,
                ),
                row=int(points.row[j]),
            )
        else:
            journal.add(
                "warning",
                str(points.file[j]),
                message(
                    "import.horizon-two-elevations-place",
                    "Horizon {horizon}: two elevations at one place, {rise:+.3f} m against {before}",
                    horizon=horizon,
                    rise=rise,
                    before=before,
                ),
                message(
                    "import.correct-state-accuracies-fit",
                    "Correct one of them, or state accuracies: the fit keeps the more accurate one.",
                ),
                row=int(points.row[j]),
                column="z",
                value=f"{points.xyz[j, 2]:.15g}",
            )

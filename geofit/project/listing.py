"""All points of a horizon, excluded rows too, with what its surface says of each: what windows and reports list."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.points import PointSet
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import Row, find_rows, matched, turns

__all__ = ["Listing", "listing"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Listing:
    """The points of a horizon in the order of their files.

    Parameters
    ----------
    points : PointSet
        All points, those of excluded rows too.
    excluded : (n,) array of bool
        Points whose rows take no part in the next fit.
    residual : (n,) array
        Signed orthogonal distance to the surface, metres; nan without a surface. Of points that were left out of the
        fit it is what the surface misses.
    patch : (n,) array of str
        Patch that is nearest to the point; empty without a surface.
    core : (n,) array of bool
        Points that the surface interpolates.
    place : (n,) array of int
        Index among the points that were fitted; -1 of a point that was not.
    """

    points: PointSet
    excluded: Bools
    residual: Floats
    patch: NDArray[np.str_]
    core: Bools
    place: NDArray[np.int64]

    def rows(self, indices: Iterable[int]) -> tuple[Row, ...]:
        """Return the rows of points."""
        points, turn = self.points, turns(self.points)
        return tuple(Row(str(points.file[i]), int(points.row[i]), int(turn[i])) for i in indices)

    def index(self, row: Row | None) -> int | None:
        """Return the index of a row's point; None where there is none."""
        return None if row is None else row.find(self.points)


def listing(points: PointSet, excluded: Collection[Row], surface: HorizonFit | None) -> Listing:
    """List the points of a horizon.

    Parameters
    ----------
    points : PointSet
        All points of the horizon in the site.
    excluded : collection of Row
        Rows that take no part in the next fit.
    surface : HorizonFit or None
        Its surface. One with points that the site does not have (its files have changed) is listed by its own points.
    """
    place = np.full(len(points), -1)
    if surface is not None:
        same = len(surface.points) == len(points) and np.array_equal(surface.points.xyz, points.xyz)
        own = np.arange(len(points)) if same else matched(surface.points, points)
        if (own < 0).any():
            points, own = surface.points, np.arange(len(surface.points))
            place = np.full(len(points), -1)
        place[own] = np.arange(len(own))
    out = np.zeros(len(points), bool)
    out[find_rows(points, excluded)] = True
    residual, patch, core = _measured(points, place, surface)
    return Listing(points, out, residual, patch, core, place)


def _measured(
    points: PointSet, place: NDArray[np.int64], surface: HorizonFit | None
) -> tuple[Floats, NDArray[np.str_], Bools]:
    n = len(points)
    a = None if surface is None else surface.accuracy
    if surface is None or a is None:
        return np.full(n, np.nan), np.full(n, "", dtype=np.str_), np.zeros(n, bool)
    fitted = place >= 0
    residual = np.full(n, np.nan)
    residual[fitted] = a.residuals[place[fitted]]
    patch = np.full(n, "", dtype=a.patch.dtype if len(a.patch) else np.str_)
    patch[fitted] = a.patch[place[fitted]]
    core = np.zeros(n, bool)
    if len(surface.core) == a.n:
        core[fitted] = surface.core[place[fitted]]
    if not fitted.all():
        residual[~fitted] = surface.distance(points.xyz[~fitted])
    return residual, patch, core

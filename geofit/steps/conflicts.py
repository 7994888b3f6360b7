"""Points that cannot both lie on one surface: found before the fit, settled by accuracy, listed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from geofit.accuracy import Conflict
from geofit.points import PointSet
from geofit.words import said

__all__ = ["settle"]

#: Places within the distance along the sweep, up to which it is the faster.
ABREAST = 64

#: Where the sources state no accuracy, the one that was measured nearer to the rock is kept.
_TRUST = {"borehole": 0, "adit": 1, "outcrop": 2, "point": 3, "map": 4, "section": 5, "geophysics": 6}


def settle(
    points: PointSet, place: NDArray[np.float64], height: NDArray[np.float64], distance: float
) -> tuple[NDArray[np.bool_], tuple[Conflict, ...]]:
    """Choose one point at each place.

    Parameters
    ----------
    points : PointSet
        All points.
    place : (n, k) array
        Where each point stands on the surface: in-plane coordinates, or map coordinates of a folded surface.
    height : (n,) array
        What the surface must take there.
    distance : float
        Points nearer than this many metres stand at one place.

    Returns
    -------
    kept : (n,) array of bool
        The points that the fit honours.
    conflicts : tuple of Conflict
        One for each point that gives way, exact duplicates included.
    """
    kept = np.ones(len(points), dtype=bool)
    pairs = _near_pairs(place, distance)
    if not len(pairs):
        return kept, ()
    met = np.unique(pairs)
    accuracy = np.where(np.isnan(points.accuracy[met]), np.inf, points.accuracy[met])
    trust = np.array([_TRUST.get(kind, 3) for kind in points.kind[met]])
    rank = np.empty(len(points), dtype=int)
    rank[met[np.lexsort((met, trust, accuracy))]] = np.arange(len(met))
    better = np.where(rank[pairs[:, 0]] < rank[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    worse = pairs.sum(axis=1) - better
    conflicts = []
    for i in np.argsort(rank[better], kind="stable"):
        winner, loser = int(better[i]), int(worse[i])
        if kept[winner] and kept[loser]:
            kept[loser] = False
            conflicts.append(_describe(points, winner, loser, float(height[loser] - height[winner])))
    return kept, tuple(conflicts)


def _near_pairs(place: NDArray[np.float64], distance: float) -> NDArray[np.intp]:
    """Return (m, 2) indices of the places nearer to each other than a distance.

    A sweep along the longest axis finds the few pairs of a million places in a twentieth of a tree's time; where
    many places stand abreast, the tree is the faster.
    """
    order = np.argsort(place[:, int(np.argmax(np.ptp(place, axis=0)))], kind="stable")
    swept = place[order]
    along = swept[:, int(np.argmax(np.ptp(place, axis=0)))]
    found: list[NDArray[np.intp]] = []
    for step in range(1, ABREAST + 1):
        near = np.flatnonzero(along[step:] - along[:-step] <= distance)
        if not len(near):
            pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=np.intp)
            return np.sort(pairs, axis=1)
        close = near[np.linalg.norm(swept[near + step] - swept[near], axis=1) <= distance]
        found.append(np.column_stack([order[close], order[close + step]]))
    return np.asarray(KDTree(place).query_pairs(distance, output_type="ndarray"))


def _describe(points: PointSet, winner: int, loser: int, difference: float) -> Conflict:
    names = points.describe(winner), points.describe(loser)
    if difference == 0:
        text = said("{dropped} repeats {kept}", dropped=names[1], kept=names[0])
    else:
        stated = np.where(np.isnan(points.accuracy), np.inf, points.accuracy)
        if stated[winner] < stated[loser]:
            reason = said("the better stated accuracy")
        elif _TRUST.get(points.kind[winner], 3) < _TRUST.get(points.kind[loser], 3):
            reason = said("the source nearer to the rock")
        else:
            reason = said("the first")
        text = said(
            "{dropped} differs by {difference:+.3f} m from {kept} at one place; kept: {reason}",
            dropped=names[1],
            difference=difference,
            kept=names[0],
            reason=reason,
        )
    return Conflict(winner, loser, difference, text)

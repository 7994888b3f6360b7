"""Points that cannot both lie on one surface: found before the fit, resolved by accuracy, listed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from geofit.data.accuracy import Conflict
from geofit.data.labels import Labels
from geofit.data.messages import Message, message
from geofit.data.points import PointSet

__all__ = ["near_pairs", "note_lost_places", "places_lost", "resolve_conflicts", "trust_of", "trust_of_kinds"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

#: Places within the distance along the sweep, up to which it is the faster.
ABREAST = 64
#: Least width of a strip of the sweep, in distances: few places lie next to its borders.
NARROWEST = 16
#: Places that are swept together (memory).
SLAB = 1 << 19

#: Places nearer than this are one place that was written twice, metres.
ONE_PLACE = 1e-7
#: Share of all points from which on lost places are warned of.
MANY = 0.05

#: Where the sources state no accuracy, the one that was measured nearer to the rock is kept.
_TRUST = {"borehole": 0, "adit": 1, "outcrop": 2, "point": 3, "map": 4, "section": 5, "geophysics": 6}


def resolve_conflicts(
    points: PointSet, place: Floats, height: Floats, distance: float
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
        Points nearer than this many metres are coincident.

    Returns
    -------
    kept : (n,) array of bool
        The points that the fit honours.
    conflicts : tuple of Conflict
        One for each point that is dropped, exact duplicates included.
    """
    kept = np.ones(len(points), dtype=bool)
    pairs = near_pairs(place, distance)
    if not len(pairs):
        return kept, ()
    met = np.unique(pairs)
    accuracy = np.where(np.isnan(points.accuracy[met]), np.inf, points.accuracy[met])
    trust = trust_of(points.labels["kind"][met])
    rank = np.empty(len(met), dtype=int)
    rank[np.lexsort((met, trust, accuracy))] = np.arange(len(met))
    own = rank[np.searchsorted(met, pairs)]
    better = np.where(own[:, 0] < own[:, 1], pairs[:, 0], pairs[:, 1])
    worse = pairs.sum(axis=1) - better
    conflicts = []
    for i in np.lexsort((worse, own.min(axis=1))):
        winner, loser = int(better[i]), int(worse[i])
        if kept[winner] and kept[loser]:
            kept[loser] = False
            conflicts.append(_describe(points, winner, loser, float(height[loser] - height[winner])))
    return kept, tuple(conflicts)


def note_lost_places(conflicts: Sequence[Conflict], place: Floats, distance: float) -> tuple[Message, ...]:
    """Return a note where points were dropped at places of their own: data as fine as the distance, or not in metres.

    ``place`` (n, k) is where each point stands on the surface, ``distance`` (m) that of coincident points.
    """
    kept, dropped = ([getattr(one, end) for one in conflicts] for end in ("kept", "dropped"))
    apart = np.linalg.norm(place[kept] - place[dropped], axis=1)
    return places_lost(int((apart > ONE_PLACE).sum()), len(place), distance)


def places_lost(lost: int, total: int, distance: float) -> tuple[Message, ...]:
    """Return a note where points were lost to the distance of coincident ones (m); of many of them it is a warning."""
    if not lost:
        return ()
    note = message(
        "fitting.places-lost",
        "{count} of {total} points take no part in the fit: each lies within {distance:g} m of another. If these are "
        "separate locations, give a smaller coincidence_distance, or the coordinates in metres.",
        count=lost,
        total=total,
        distance=distance,
    )
    return (note.with_severity("warning" if lost > MANY * total else "info"),)


def near_pairs(place: Floats, distance: float) -> Ints:
    """Return (m, 2) indices, ascending in each row, of the places nearer to each other than a distance.

    Of many places those of one slab of the longest axis at a time, with those of the next one by the border between.
    """
    low, high = (np.array([end(column) for column in place.T]) for end in (np.min, np.max))
    axis = int(np.argmax(high - low))
    count = min(len(place) // SLAB, 250, int((high - low)[axis] / (NARROWEST * distance)))
    if count <= 1:
        return _near_pairs(place, distance)
    width = (high - low)[axis] / count
    slab, shared = np.empty(len(place), np.uint8), []
    for start in range(0, len(place), SLAB):
        along = place[start : start + SLAB, axis] - low[axis]
        slab[start : start + SLAB] = own = np.minimum(along / width, count - 1).astype(np.uint8)
        shared.append(start + np.flatnonzero(np.maximum((along - 1.01 * distance) / width, 0).astype(np.uint8) < own))
    border = np.concatenate(shared)
    before = slab[border] - 1
    pairs = []
    for k in range(count):
        rows = np.sort(np.concatenate([np.flatnonzero(slab == k), border[before == k]]))
        pairs.append(rows[_near_pairs(place[rows], distance)] if len(rows) > 1 else np.empty((0, 2), np.intp))
    return np.unique(np.concatenate(pairs), axis=0)


def _near_pairs(place: Floats, distance: float) -> Ints:
    """Return the pairs of places by a sweep along the longest axis.

    Strip by strip, each so narrow that few places stand abreast. Two places on both sides of a border between strips
    lie next to it; the few that do are swept once more without strips.
    """
    columns = np.ascontiguousarray(place.T)
    extent = np.ptp(columns, axis=1)
    longest, across = np.argsort(-extent, kind="stable")[:2]
    width = max(float(extent[across]) / np.sqrt(len(place)), NARROWEST * distance)
    # Half a strip more: the outermost places are not borders.
    strips = (columns[across] - columns[across].min()) / width + 0.5
    number = np.floor(strips)
    key = columns[longest] - columns[longest].min() + number * (float(extent[longest]) + 4 * distance)
    border = np.flatnonzero(np.abs(strips - np.rint(strips)) * width <= 1.01 * distance)
    within = _swept(columns, key, distance)
    astride = border[_swept(columns[:, border], columns[longest, border], distance)]
    astride = astride[number[astride[:, 0]] != number[astride[:, 1]]]
    return np.sort(np.concatenate([within, astride]), axis=1)


def _swept(columns: Floats, key: Floats, distance: float) -> Ints:
    """Return the pairs among places (k, n) whose keys and whose places are nearer than a distance.

    The sweep finds the few pairs of a million places in a hundredth of a tree's time; where many places stand
    abreast, the tree is the faster.
    """
    order = np.argsort(key)
    swept = key[order]
    limit = distance + 4 * np.spacing(np.abs(swept).max(initial=0.0))
    near = np.arange(len(swept))
    found: list[Ints] = [np.empty((0, 2), dtype=np.intp)]
    for step in range(1, ABREAST + 1):
        near = near[: np.searchsorted(near, len(swept) - step)]
        near = near[swept[near + step] - swept[near] <= limit]
        if not len(near):
            return np.concatenate(found)
        first, second = order[near], order[near + step]
        close = np.linalg.norm(columns[:, first] - columns[:, second], axis=0) <= distance
        found.append(np.column_stack([first, second])[close])
    pairs = np.asarray(KDTree(columns.T).query_pairs(distance, output_type="ndarray"))
    return np.asarray(pairs[np.abs(key[pairs[:, 0]] - key[pairs[:, 1]]) <= limit])


def _describe(points: PointSet, winner: int, loser: int, difference: float) -> Conflict:
    names = points.describe(winner), points.describe(loser)
    if difference == 0:
        text = message("fitting.conflict-repeated", "{dropped} repeats {kept}", dropped=names[1], kept=names[0])
    else:
        stated = np.nan_to_num(points.accuracy[[winner, loser]], nan=np.inf)
        if stated[0] < stated[1]:
            reason = message("fitting.conflict-kept-by-accuracy", "the better stated accuracy")
        elif np.less(*trust_of(points.labels["kind"][np.array([winner, loser])])):
            reason = message("fitting.conflict-kept-by-source", "the source nearer to the rock")
        else:
            reason = message("fitting.conflict-kept-first", "the first")
        text = message(
            "fitting.conflict-of-elevation",
            "{dropped} differs by {difference:+.3f} m from {kept} at the same location; used: {reason}",
            dropped=names[1],
            difference=difference,
            kept=names[0],
            reason=reason,
        ).with_severity("warning")
    return Conflict(winner, loser, difference, text)


def trust_of(kinds: Labels) -> NDArray[np.int64]:
    """Return (n,) how far from the rock each point was measured by its kind: 0 for a borehole."""
    return trust_of_kinds(kinds)[kinds.codes]


def trust_of_kinds(kinds: Labels) -> NDArray[np.int64]:
    """Return the same of each kind in the table of labels."""
    return np.array([_TRUST.get(kind, _TRUST["point"]) for kind in kinds.table], dtype=np.int64)

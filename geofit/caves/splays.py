"""Walls of stations from splays: shots from a station to points of the wall, as laser distance meters measure them.

Along the passage, each point of a wall is moved onto the section through its station. There the four quarter ellipses
of a section (:mod:`geofit.caves.body`) are fitted to the points by least absolute logarithms of their distances: four
splays to the left, right, up and down give exactly these four walls, and those of a slanting fan the same ellipse.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["walls_of_splays"]

Floats = NDArray[np.float64]

#: Steeper passages are shafts: their section is level, degrees.
SHAFT = 60.0
#: Draws what no splay determines towards a circle.
_TIE = 1e-3
#: Shorter shots have no direction, metres.
_NOTHING = 1e-6
#: Rounds of the fit, and relative distances below which points count as on the section.
_ROUNDS, _SMALL = 12, 0.02
#: A wall is at most this much farther than the farthest splay near its direction.
_BEYOND = 1.2


def walls_of_splays(
    passages: Sequence[tuple[int, int, int, Floats]], splays: Sequence[tuple[int, int, Floats]]
) -> tuple[list[tuple[int, int, list[float]]], int]:
    """Return the walls that splays show: station, shot and left, right, up, down (nan if none) of each; and their use.

    Parameters
    ----------
    passages : sequence of (shot, start, end, offset)
        Shots along passages: number, stations, vector in metres.
    splays : sequence of (start, end, offset)
        Shots to walls. The wall is at the end without a passage.

    Returns
    -------
    list, int
        The walls, and how many splays they are from. Splays that lead rather along the passage than to its walls, and
        those from stations without a passage, are not used.
    """
    ways: dict[int, dict[int, tuple[int, Floats, bool]]] = {}
    for shot, start, end, offset in passages:
        length = float(np.linalg.norm(offset))
        if start != end and length > _NOTHING:
            # A shot that was surveyed again is the same passage.
            ways.setdefault(start, {}).setdefault(end, (shot, offset / length, True))
            ways.setdefault(end, {}).setdefault(start, (shot, -offset / length, False))
    points: dict[int, list[Floats]] = {}
    for start, end, offset in splays:
        if (start in ways) != (end in ways):
            station, point = (start, offset) if start in ways else (end, -offset)
            points.setdefault(station, []).append(point)
    found, used = [], 0
    for station, own in points.items():
        shot, along = _direction(ways[station])
        walls, count = _walls(along, np.array(own))
        used += count
        if np.isfinite(walls).any():
            found.append((station, shot, walls.tolist()))
    return found, used


def _direction(ways: Mapping[int, tuple[int, Floats, bool]]) -> tuple[int, Floats]:
    """Return the shot that walls of a station refer to, and the direction (3,) of the passage there, along that shot.

    It is that of the straightest way through the station, half of the turn on either side.
    """
    leaving = list(ways.values())
    pairs = [(float(a[1] @ b[1]), i, j) for i, a in enumerate(leaving) for j, b in enumerate(leaving) if i < j]
    chosen, along = leaving[0], leaving[0][1]
    if pairs:
        cosine, i, j = min(pairs)
        # A shot that is not vertical has a left and a right.
        chosen, other = sorted((leaving[i], leaving[j]), key=lambda way: abs(float(way[1][2])))
        along = chosen[1] - other[1] if cosine < 1 - _NOTHING else chosen[1]
    along = along / np.linalg.norm(along)
    return chosen[0], along if chosen[2] else -along


def _walls(along: Floats, points: Floats) -> tuple[Floats, int]:
    """Return left, right, up and down (4,) from wall points (n, 3) about a station, and how many of them count."""
    level = float(np.hypot(*along[:2]))
    forward = np.append(along[:2] / level, 0.0) if level > _NOTHING else np.array([0.0, 1.0, 0.0])
    right = np.array([forward[1], -forward[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    if level >= np.cos(np.radians(SHAFT)):
        # Heights are measured vertically: along an inclined passage a point moves up or down as the passage does.
        gone = points @ forward / level
        side, height = points @ right, points[:, 2] - gone * along[2]
        return _section(side, height, gone)
    gone = points[:, 2] / along[2]
    flat = points - gone[:, None] * along
    round_, count = _section(flat @ right, flat @ forward, gone)
    widths = [np.nanmean(pair) for pair in (round_[:2], round_[2:]) if np.isfinite(pair).any()]
    # The body takes the mean of left and right of a shaft: that of a circle of the section's area.
    radius = float(np.sqrt(np.prod(widths)) if len(widths) == 2 else widths[0]) if widths else np.nan
    steep = points[np.abs(points @ up) > np.hypot(points @ right, points @ forward)]
    reach = [_largest(steep @ way) for way in (up, -up)]
    return np.array([radius, radius, *reach]), count


def _largest(reach: Floats) -> float:
    return float(reach.max()) if (reach > 0).any() else float("nan")


def _section(side: Floats, height: Floats, gone: Floats) -> tuple[Floats, int]:
    """Return the semi-axes (4,) to the left, right, up and down of points (n,) of a section, nan where none is near.

    ``gone`` is how far each lies along the passage; what lies farther along than across it is not used.
    """
    from scipy.optimize import lsq_linear

    away = np.hypot(side, height)
    use = (away > _NOTHING) & (away >= np.abs(gone))
    side, height, away = side[use], height[use], away[use]
    walls = np.full(4, np.nan)
    if not len(away):
        return walls, 0
    parts = np.column_stack([-side, side, height, -height]) / away[:, None]
    # One over the squares of the semi-axes, in units of the mean distance: linear in what the points say.
    unit = float(np.sqrt(np.mean(away**2)))
    rows = (np.maximum(parts, 0.0) * (away / unit)[:, None]) ** 2
    near = parts >= np.sqrt(0.5) - 1e-9
    farthest = np.array([away[own].max() if own.any() else away.max() for own in near.T])
    least = (unit / (_BEYOND * farthest)) ** 2
    weight, solved = np.ones(len(rows)), np.ones(4)
    for _ in range(_ROUNDS):
        # A splay through an opening is several times as long as its neighbours: absolute values of the logarithms of
        # distance over model count, not the squares of their ratios.
        matrix = np.vstack([weight[:, None] * rows, _TIE * np.eye(4)])
        right_hand = np.concatenate([weight, np.full(4, _TIE)])
        solved = lsq_linear(matrix, right_hand, bounds=(least, np.inf), method="bvls").x
        ratio = rows @ solved
        off = np.maximum(np.abs(np.log(ratio)), _SMALL)
        weight = np.sqrt(off) / np.maximum(np.abs(ratio - 1.0), _SMALL)
    walls[near.any(axis=0)] = (unit / np.sqrt(solved))[near.any(axis=0)]
    return walls, len(away)

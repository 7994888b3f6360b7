"""Surveys with known truth."""

from __future__ import annotations

import numpy as np

from geofit.caves.shots import ShotList


def chain(points, radius, *, closed=False, fixed=True, across=True):
    """A survey along points, with one radius (a number, or one a station) at every station."""
    points = np.asarray(points, float)
    sizes = np.broadcast_to(radius, len(points))
    shots = ShotList(across=across)
    for i in range(len(points) - 1 + closed):
        j = (i + 1) % len(points)
        shot = shots.add(str(i), str(j), points[j] - points[i], i)
        shots.add_walls(str(i), shot, [sizes[i]] * 4)
    if not closed:
        shots.add_walls(str(len(points) - 1), len(shots.shots) - 1, [sizes[-1]] * 4)
    if fixed:
        shots.fixed["0"] = tuple(points[0])
    return shots.survey("chain")


def network(seed, stations=30, extra=6, noise=0.1):
    """A random survey with loops, its stations, and the noise of its shots."""
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(0, 8, (stations, 3)), axis=0)
    ends = [(i, i + 1) for i in range(stations - 1)]
    ends += [tuple(rng.choice(stations, 2, replace=False).tolist()) for _ in range(extra)]
    shots = ShotList()
    for row, (a, b) in enumerate(ends):
        shots.add(str(a), str(b), points[b] - points[a] + rng.normal(0, noise, 3), row)
    shots.fixed["0"] = tuple(points[0])
    return points, shots.survey("network")

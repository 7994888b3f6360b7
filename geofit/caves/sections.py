"""The section of a passage at both ends of each shot: measured walls, and what replaces missing ones.

Left and right refer to the direction of a shot. Where two shots of a station run against each other, left of one is
right of the other; the interpolation along the passage minds this.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.caves.adjust import AdjustedSurvey
from geofit.caves.survey import WALLS, Survey, SurveyError
from geofit.data.messages import Untranslated, message

__all__ = ["FilledWall", "Sections", "sections"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Shorter shots do not couple stations more strongly than this length does, metres.
_SHORTEST = 0.1
#: Shots up to this length have no direction, metres.
_NOTHING = 1e-6
#: Draws walls that no measured wall is connected to towards the mean of the survey.
_TIE = 1e-9


@dataclass(frozen=True)
class FilledWall:
    """A wall that was not measured: station, wall ("left", ...), distance used (metres)."""

    station: str
    wall: str
    distance: float


@dataclass(frozen=True, eq=False)
class Sections:
    """Sections at the ends of the shots along passages.

    Parameters
    ----------
    shot : (k,) array of int
        Shots of the survey that run along a passage and have a length.
    place : (k, 2) array of int
        Stations at their start and end; of stations that a shot of length 0 joins, the first.
    walls : (k, 2, 4) array
        Left, right, up and down at the start and the end of each shot, seen along it, metres.
    source : (k, 2, 4) array of int
        Which wall each of them is: equal numbers are one measurement, or one filled wall.
    measured : (number of sources,) array of bool
        Whether the source was measured.
    filled : tuple of FilledWall
        The others, by station.
    """

    shot: Ints
    place: Ints
    walls: Floats
    source: Ints
    measured: NDArray[np.bool_]
    filled: tuple[FilledWall, ...]


def sections(adjusted: AdjustedSurvey, radius: float | None = None) -> Sections:
    """Return the sections of a survey's passages, missing walls interpolated along them.

    Parameters
    ----------
    adjusted : AdjustedSurvey
        The survey with coordinates.
    radius : float, optional
        Distance of the walls in a survey that has no wall of a kind anywhere, metres.

    Raises
    ------
    SurveyError
        If there is no shot along a passage, or no wall and no radius.

    Notes
    -----
    A missing wall solves the discrete Laplace equation on the network of stations, each shot weighted by 1 / length:
    linear between two measured stations, constant beyond the last one, and defined at junctions and in loops. Left and
    right that are both 0, or up and down, count as missing. Walls of passages without any measured one get the mean of
    the survey. Stations that a shot of length 0 joins, as Compass ties surveys together, are one.
    """
    survey, n = adjusted.survey, len(adjusted.survey.stations)
    vector = adjusted.xyz[survey.end] - adjusted.xyz[survey.start]
    length = np.linalg.norm(vector, axis=1)
    ties = survey.passage & (np.linalg.norm(survey.offset, axis=1) < _NOTHING)
    first = _first_of_tied(survey, ties)
    start, end, wall_station = first[survey.start], first[survey.end], first[survey.wall_station]
    shot = np.flatnonzero(survey.passage & ~ties & (length > _NOTHING))
    if not len(shot):
        raise SurveyError(
            message(
                "caves.survey-without-passage",
                "The survey {name} has no shot along a passage that could form a body.",
                name=Untranslated(survey.name),
            )
        )
    heading = vector[:, :2] / np.maximum(np.linalg.norm(vector[:, :2], axis=1), 1e-12)[:, None]
    reference = _references(adjusted, heading, shot, first)
    # A passage that is open to neither side was not measured there.
    given = survey.walls.copy()
    for pair in (slice(0, 2), slice(2, 4)):
        given[(given[:, pair] == 0).all(axis=1), pair] = np.nan
    value, source = _station_walls(adjusted, given, heading, reference, wall_station)
    known = source >= 0
    kinds = np.array([[0, 0, 1, 1]]).repeat(n, axis=0)
    means = [value[(kinds == kind) & known].mean() if (known & (kinds == kind)).any() else radius for kind in (0, 1)]
    if means[0] is None and means[1] is None:
        raise SurveyError(
            message(
                "caves.survey-without-walls",
                "The survey {name} has no wall distance at any station, so its passages have no size. "
                "Measure walls, or give a wall distance (in scripts: radius, in metres).",
                name=Untranslated(survey.name),
            )
        )
    both = [mean if mean is not None else other for mean, other in zip(means, means[::-1], strict=True)]
    target = np.asarray(both, dtype=np.float64)[kinds]
    value = _interpolated(start[shot], end[shot], length[shot], heading[shot], reference, value, target)
    used = np.zeros(n, dtype=bool)
    used[start[shot]] = used[end[shot]] = True
    records = 4 * len(survey.walls)
    source = np.where(known, source, records + np.arange(4 * n).reshape(n, 4))
    records_of = zip(survey.wall_shot.tolist(), wall_station.tolist(), strict=True)
    own: dict[tuple[int, int], int] = {}
    for record, key in enumerate(records_of):
        own.setdefault(key, record)
    walls, sources = np.empty((len(shot), 2, 4)), np.empty((len(shot), 2, 4), dtype=np.int64)
    for k, s in enumerate(shot.tolist()):
        for side, station in enumerate((int(start[s]), int(end[s]))):
            order = [0, 1, 2, 3] if heading[s] @ reference[station] >= 0 else [1, 0, 2, 3]
            walls[k, side], sources[k, side] = value[station][order], source[station][order]
            if (s, station) in own:
                record = own[s, station]
                mine = np.isfinite(given[record])
                walls[k, side, mine] = given[record, mine]
                sources[k, side, mine] = 4 * record + np.flatnonzero(mine)
    filled = tuple(
        FilledWall(survey.stations[i], WALLS[w], float(value[i, w]))
        for i, w in np.argwhere(~known & used[:, None]).tolist()
    )
    measured = np.arange(records + 4 * n) < records
    return Sections(shot, np.column_stack([start[shot], end[shot]]), walls, sources, measured, filled)


def _first_of_tied(survey: Survey, ties: NDArray[np.bool_]) -> Ints:
    """Return the first (n,) of the stations that each one is tied to by shots of length 0: itself for most."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = len(survey.stations)
    links = coo_array((np.ones(ties.sum()), (survey.start[ties], survey.end[ties])), shape=(n, n))
    labels = connected_components(links, directed=False)[1]
    return np.asarray(np.unique(labels, return_index=True)[1][labels], dtype=np.int64)


def _references(adjusted: AdjustedSurvey, heading: Floats, shot: Ints, first: Ints) -> Floats:
    """Return the horizontal direction (n, 2) that left and right of each station refer to."""
    survey = adjusted.survey
    reference = np.zeros((len(survey.stations), 2))
    for s in shot[::-1].tolist():
        for station in (survey.start[s], survey.end[s]):
            reference[first[station]] = heading[s]
    tied = np.linalg.norm(survey.offset, axis=1) < _NOTHING
    for station, s in zip(first[survey.wall_station[::-1]].tolist(), survey.wall_shot[::-1].tolist(), strict=True):
        # A shot of length 0 has no direction, and that of a shot to a wall is not the passage's.
        if s >= 0 and not tied[s] and survey.passage[s]:
            reference[station] = heading[s]
    return reference


def _station_walls(
    adjusted: AdjustedSurvey, given: Floats, heading: Floats, reference: Floats, wall_station: Ints
) -> tuple[Floats, Ints]:
    """Return the first measured walls (n, 4) of each station, nan where there is none, and their sources, else -1."""
    survey = adjusted.survey
    value = np.full((len(survey.stations), 4), np.nan)
    source = np.full(value.shape, -1, dtype=np.int64)
    for record, (station, s) in enumerate(zip(wall_station.tolist(), survey.wall_shot.tolist(), strict=True)):
        against = s >= 0 and survey.passage[s] and heading[s] @ reference[station] < 0
        for wall, seen in enumerate((1, 0, 2, 3) if against else (0, 1, 2, 3)):
            if np.isfinite(given[record, seen]) and source[station, wall] < 0:
                value[station, wall] = given[record, seen]
                source[station, wall] = 4 * record + seen
    return value, source


def _interpolated(
    start: Ints, end: Ints, length: Floats, heading: Floats, reference: Floats, value: Floats, target: Floats
) -> Floats:
    """Return the walls (n, 4) with the missing ones solved for."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import splu

    against = ((heading * reference[start]).sum(axis=1) < 0) != ((heading * reference[end]).sum(axis=1) < 0)
    i, j = [], []
    for wall in range(4):
        other = np.where(against & (wall < 2), 1 - wall, wall)
        i.append(4 * start + wall)
        j.append(4 * end + other)
    a, b = np.concatenate(i), np.concatenate(j)
    weight = np.tile(1.0 / np.maximum(length, _SHORTEST), 4)
    size = value.size
    links = coo_array((np.r_[weight, weight], (np.r_[a, b], np.r_[b, a])), shape=(size, size)).tocsr()
    flat, missing = value.ravel().copy(), np.flatnonzero(~np.isfinite(value.ravel()))
    if not len(missing):
        return value
    given = np.setdiff1d(np.arange(size), missing)
    degree = np.asarray(links.sum(axis=1)).ravel()[missing] + _TIE
    matrix = (diags_array(degree) - links[missing][:, missing]).tocsc()
    right = links[missing][:, given] @ flat[given] + _TIE * target.ravel()[missing]
    flat[missing] = splu(matrix).solve(right)
    return np.asarray(np.maximum(flat, 0.0).reshape(value.shape))

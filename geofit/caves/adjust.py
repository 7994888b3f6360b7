"""Coordinates of the stations: misclosures of loops are spread by least squares.

Each shot is one observation of the vector between its stations. Its covariance is that of a tape along the shot and of
compass and clinometer across it; a shot of twice the length is four times as uncertain across. The normal equations are
sparse (one 3 x 3 block a shot), so ten thousand stations take well under a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.caves.survey import LONGEST, Survey, SurveyError, first_stations
from geofit.data.columns import refuse_far
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message

__all__ = ["AdjustedSurvey", "Loop", "adjust_survey"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Shots that must not change are this much more certain than others.
_RIGID = 1e-4
#: A shot that differs less from the coordinates of its fixed stations was computed from them, metres.
_COMPUTED = 1e-9
#: How well a station is found again by the next shot, metres: short shots are not exact.
_STATION = 0.02


@dataclass(frozen=True, eq=False)
class Loop:
    """One independent loop of a survey.

    Parameters
    ----------
    stations : tuple of str
        In order round the loop; from one fixed station to another where coordinates close it.
    length : float
        Sum of the shots' lengths, metres.
    misclosure : (3,) array
        Sum of the measured vectors round the loop, metres; zero if nothing was measured wrongly.
    expected : float
        Standard deviation of the misclosure's length by the errors of the shots, metres.
    """

    stations: tuple[str, ...]
    length: float
    misclosure: Floats
    expected: float

    @property
    def distance(self) -> float:
        """Length of the misclosure, metres."""
        return float(np.linalg.norm(self.misclosure))

    @property
    def percent(self) -> float:
        """Misclosure over length, per cent."""
        return 100.0 * self.distance / max(self.length, 1e-12)

    @property
    def suspicious(self) -> bool:
        """Whether the misclosure exceeds three times its standard deviation: look for a blunder."""
        return self.distance > 3.0 * self.expected


@dataclass(frozen=True, eq=False)
class AdjustedSurvey:
    """A survey with the coordinates of its stations.

    Parameters
    ----------
    survey : Survey
        What was measured.
    xyz : (n, 3) array
        Stations, metres.
    residual : (m, 3) array
        What the adjustment adds to each shot, metres.
    loops : tuple of Loop
        The worst first, by misclosure over its standard deviation.
    covariance : (m, 3, 3) array
        Covariance of each measured shot, square metres.
    anchors : (k,) array of int
        Stations that were held fixed.
    """

    survey: Survey
    xyz: Floats
    residual: Floats
    loops: tuple[Loop, ...]
    covariance: Floats
    anchors: Ints

    @property
    def sigma(self) -> Floats:
        """Standard deviation (n, 3) of the adjusted stations, metres, by the errors of the shots."""
        free, normal = _normal_matrix(self.survey, self.covariance, self.anchors)
        sigma = np.zeros((len(self.survey.stations), 3))
        if len(free):
            from scipy.sparse.linalg import splu

            factor = splu(normal)
            unit = np.zeros((3 * len(free), 3))
            for k, station in enumerate(free.tolist()):
                unit[3 * k : 3 * k + 3] = np.eye(3)
                sigma[station] = np.sqrt(np.diagonal(factor.solve(unit)[3 * k : 3 * k + 3]))
                unit[3 * k : 3 * k + 3] = 0.0
        return sigma


@arguments_checked
def adjust_survey(survey: Survey, *, length_error: float = 0.05, angle_error: float = 1.0) -> AdjustedSurvey:
    """Return the coordinates of the stations, misclosures spread by least squares.

    Parameters
    ----------
    survey : Survey
        At least one station of each connected part must be fixed; in a survey without any, the first station is put at
        (0, 0, 0).
    length_error : float
        Standard deviation of a measured length, metres.
    angle_error : float
        Standard deviation of compass and clinometer, degrees.

    Raises
    ------
    SurveyError
        If stations are not connected to a fixed one, or a shot is too long, as measured or between fixed stations.
    PointsError
        If a coordinate of a fixed station is too large.
    SettingsError
        If an error is not above 0.
    """
    if not (length_error > 0 and angle_error > 0):
        raise SettingsError(
            message(
                "caves.errors-not-positive",
                "The errors are {length} m and {angle} degrees; give values above 0.",
                length=length_error,
                angle=angle_error,
            )
        )
    place = {name: i for i, name in enumerate(survey.stations)}
    known = {place[name]: xyz for name, xyz in survey.fixed.items()} or {0: (0.0, 0.0, 0.0)}
    _require_connected(survey, list(known))
    _require_lengths(survey, survey.offset)
    covariance = shot_covariance(survey, length_error, np.radians(angle_error))
    anchors = np.array(sorted(known), dtype=np.int64)
    xyz = np.zeros((len(survey.stations), 3))
    xyz[anchors] = [known[i] for i in anchors.tolist()]
    refuse_far(xyz)
    free, normal = _normal_matrix(survey, covariance, anchors)
    if len(free):
        from scipy.sparse.linalg import splu

        weight = np.linalg.inv(covariance)
        pull = np.einsum("mij,mj->mi", weight, survey.offset - (xyz[survey.end] - xyz[survey.start]))
        right = np.zeros_like(xyz)
        np.add.at(right, survey.end, pull)
        np.subtract.at(right, survey.start, pull)
        xyz[free] += splu(normal).solve(right[free].ravel()).reshape(-1, 3)
    xyz.flags.writeable = False
    # Fixed stations that are far apart stretch what was measured between them.
    _require_lengths(survey, xyz[survey.end] - xyz[survey.start])
    residual = xyz[survey.end] - xyz[survey.start] - survey.offset
    loops = sorted(_loops(survey, covariance, known), key=lambda loop: -loop.distance / max(loop.expected, 1e-12))
    return AdjustedSurvey(survey, xyz, residual, tuple(loops), covariance, anchors)


def shot_covariance(survey: Survey, length_error: float, angle_error: float) -> Floats:
    """Return the covariance (m, 3, 3) of each shot: errors in metres along it, radians across it."""
    length = np.linalg.norm(survey.offset, axis=1)
    along = survey.offset / np.maximum(length, 1e-12)[:, None]
    across = (length * angle_error) ** 2 + _STATION**2
    inline = length_error**2 + _STATION**2
    outer = along[:, :, None] * along[:, None, :]
    covariance = across[:, None, None] * np.eye(3) + (inline - across)[:, None, None] * outer
    return np.asarray(covariance * np.where(survey.rigid, _RIGID**2, 1.0)[:, None, None])


def _require_lengths(survey: Survey, offset: Floats) -> None:
    length = np.hypot.reduce(offset, axis=1)
    # nan is not at most anything.
    wrong = np.flatnonzero(~(length <= LONGEST))
    if len(wrong):
        k = int(wrong[0])
        raise SurveyError(
            message(
                "caves.shot-between-too-long",
                "The shot of {survey} from {start} to {end}, row {row}, is {length:.4g} m long; at most {longest:.0f} "
                "m are allowed. Correct its reading, the unit, or the coordinates of fixed stations.",
                survey=Untranslated(survey.name),
                start=Untranslated(survey.stations[survey.start[k]]),
                end=Untranslated(survey.stations[survey.end[k]]),
                row=int(survey.row[k]),
                length=float(length[k]),
                longest=LONGEST,
            )
        )


def _require_connected(survey: Survey, known: list[int]) -> None:
    part = survey.part_of()
    lost = np.flatnonzero(~np.isin(part, part[known]))
    if len(lost):
        parts = len(np.unique(part[lost]))
        raise SurveyError(
            message(
                "caves.stations-not-connected",
                "{count} stations of {survey} are not connected to station {anchor}: {names}. Unconnected parts: "
                "{parts}. Add the missing shot or equate, correct a misspelt station name, fix one station of each "
                "part, or leave them out: remove their shots, in Python survey.connected_to('{anchor}').",
                count=len(lost),
                survey=Untranslated(survey.name),
                anchor=Untranslated(survey.stations[known[0]]),
                names=first_stations([survey.stations[i] for i in lost.tolist()]),
                parts=parts,
            )
        )


def _normal_matrix(survey: Survey, covariance: Floats, anchors: Ints) -> tuple[Ints, Any]:
    """Return the free stations and the sparse normal matrix of their coordinates."""
    from scipy.sparse import coo_array

    n = len(survey.stations)
    free = np.setdiff1d(np.arange(n), anchors)
    number = np.full(n, -1)
    number[free] = np.arange(len(free))
    weight = np.linalg.inv(covariance)
    rows, columns, blocks = [], [], []
    proper = survey.start != survey.end
    for a, b, sign in (("start", "start", 1), ("end", "end", 1), ("start", "end", -1), ("end", "start", -1)):
        i, j = number[getattr(survey, a)], number[getattr(survey, b)]
        both = (i >= 0) & (j >= 0) & proper
        rows.append(np.broadcast_to(3 * i[both][:, None, None] + np.arange(3)[:, None], (both.sum(), 3, 3)).ravel())
        columns.append(np.broadcast_to(3 * j[both][:, None, None] + np.arange(3), (both.sum(), 3, 3)).ravel())
        blocks.append((sign * weight[both]).ravel())
    shape = (3 * len(free), 3 * len(free))
    matrix = coo_array((np.concatenate(blocks), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    return free, matrix.tocsc()


def _loops(survey: Survey, covariance: Floats, known: dict[int, tuple[float, float, float]]) -> list[Loop]:
    """Return the independent loops: one for each shot beyond a tree of shortest paths from the fixed stations."""
    n = len(survey.stations)
    neighbours: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for shot, (a, b) in enumerate(zip(survey.start.tolist(), survey.end.tolist(), strict=True)):
        if a != b:
            neighbours[a].append((shot, b))
            neighbours[b].append((shot, a))
    root = dict.fromkeys(known, -1)
    parent: dict[int, tuple[int, int]] = {}
    queue = list(known)
    for station in queue:
        for shot, other in neighbours[station]:
            if other not in root:
                root[other] = station
                parent[other] = (shot, station)
                queue.append(other)
    in_tree = {shot for shot, _ in parent.values()}
    loops = []
    for shot, (a, b) in enumerate(zip(survey.start.tolist(), survey.end.tolist(), strict=True)):
        if shot in in_tree or a == b:
            continue
        from_a, from_b = _path(a, parent), _path(b, parent)
        while from_a and from_b and from_a[-1][0] == from_b[-1][0]:
            from_a.pop()
            from_b.pop()
        ends = (from_a[-1][1] if from_a else a, from_b[-1][1] if from_b else b)
        # Over the shot to b, up to the common station (or a fixed one), and down to a.
        misclosure = survey.offset[shot].copy()
        if ends[0] != ends[1]:
            misclosure += np.subtract(known[ends[0]], known[ends[1]])
            if {a, b} == set(ends) and np.abs(misclosure).max() < _COMPUTED:
                # Nothing was measured: the shot is the difference of two coordinates, as in a centre line.
                continue
        for path, side in ((from_a, -1.0), (from_b, 1.0)):
            for s, upper in path:
                misclosure += side * (1.0 if survey.end[s] == upper else -1.0) * survey.offset[s]
        round_ = [shot, *(s for s, _ in from_a), *(s for s, _ in from_b)]
        length = float(np.linalg.norm(survey.offset[round_], axis=1).sum())
        spread = covariance[round_].sum(axis=0)
        names = [a, *(station for _, station in from_a)]
        back = [b, *(station for _, station in from_b)]
        if back[-1] == names[-1]:
            back.pop()
        stations = tuple(survey.stations[i] for i in [*names, *reversed(back)])
        loops.append(Loop(stations, length, misclosure, float(np.sqrt(np.trace(spread)))))
    return loops


def _path(station: int, parent: dict[int, tuple[int, int]]) -> list[tuple[int, int]]:
    """Return (shot, next station) from a station up to the root of its tree."""
    found = []
    while station in parent:
        shot, station = parent[station]
        found.append((shot, station))
    return found

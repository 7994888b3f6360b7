"""Shots collected one by one while a file is read, then frozen as a survey."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geofit.caves.splays import walls_of_splays
from geofit.caves.survey import LONGEST, Survey
from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import ImportIssue, TableCount

__all__ = ["ShotList", "polar", "require_length", "require_walls"]

#: Lengths from here on are written with a power of ten, metres.
_ABSURD = 1e9


def polar(length: float, azimuth: float, inclination: float) -> NDArray[np.float64]:
    """Return the vector (3,) of a length at an azimuth from north and an inclination upwards, degrees."""
    a, i = np.radians(azimuth), np.radians(inclination)
    return length * np.array([np.sin(a) * np.cos(i), np.cos(a) * np.cos(i), np.sin(i)])


def require_length(offset: NDArray[np.float64]) -> None:
    """Refuse a shot that is too long to be meant; readers list its row.

    Raises
    ------
    InputError
        If it is longer than :data:`~geofit.caves.survey.LONGEST`, or its length is not finite.
    """
    length = float(np.hypot.reduce(offset))
    if not length <= LONGEST:
        raise InputError(
            message(
                "caves.shot-too-long",
                "The shot is {length} m long; at most {longest} m are allowed",
                length=_shown(length),
                longest=_shown(LONGEST),
            ),
            message("caves.correct-reading-or-unit", "Correct the reading or the unit, or add stations between."),
        )


def require_walls(walls: Iterable[float]) -> None:
    """Refuse walls (nan where one is missing) that cannot be meant.

    Raises
    ------
    InputError
        If one is below 0, or farther than :data:`~geofit.caves.survey.LONGEST`.
    """
    for wall in walls:
        if wall < 0 or wall > LONGEST:
            raise InputError(
                message(
                    "caves.wall-out-of-range",
                    "A wall is {distance} m away; 0 to {longest} m are possible",
                    distance=_shown(wall),
                    longest=_shown(LONGEST),
                ),
                message("caves.correct-wall", "Correct the reading or the unit, or leave it out."),
            )


def _shown(metres: float) -> float | str:
    """Return a length for a message: whole metres, which are written in groups, unless it is negative or absurd."""
    return math.ceil(metres) if 0 <= metres < _ABSURD else f"{metres:.4g}".replace("-", "−", int(metres < 0))


@dataclass
class ShotList:
    """Stations, shots and walls in the order in which a reader finds them."""

    stations: dict[str, int] = field(default_factory=dict)
    shots: list[tuple[int, int, NDArray[np.float64], bool, bool, bool, int]] = field(default_factory=list)
    walls: list[tuple[int, int, Sequence[float]]] = field(default_factory=list)
    fixed: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    splays: list[int] = field(default_factory=list)
    across: bool = False

    def station(self, name: str) -> int:
        """Return the number of a station, a new one for a new name."""
        return self.stations.setdefault(name, len(self.stations))

    def add(
        self,
        start: str,
        end: str,
        offset: NDArray[np.float64],
        row: int,
        *,
        counted: bool = True,
        passage: bool = True,
        rigid: bool = False,
        splay: bool = False,
    ) -> int:
        """Add a shot and return its number; a ``splay`` leads to a point of the wall."""
        self.shots.append((self.station(start), self.station(end), offset, counted, passage, rigid, row))
        number = len(self.shots) - 1
        if splay:
            self.splays.append(number)
        return number

    def add_walls(self, station: str, shot: int, walls: Sequence[float]) -> None:
        """Add left, right, upper and lower wall of a station, along a shot; nan where one is missing."""
        self.walls.append((self.station(station), shot, walls))

    def add_walls_of_splays(self) -> tuple[int, int]:
        """Add the walls that splays show; return how many stations have them, and of how many splays they are.

        Walls that were measured count first; two opposite ones of 0 were not.
        """
        passages = [(k, *shot[:3]) for k, shot in enumerate(self.shots) if shot[4]]
        found, used = walls_of_splays(passages, [self.shots[k][:3] for k in self.splays])
        measured = np.zeros((len(self.stations), 4), dtype=bool)
        for station, _, walls in self.walls:
            known = np.isfinite(walls)
            for pair in (slice(0, 2), slice(2, 4)):
                measured[station, pair] |= known[pair] & np.any(walls[pair])
        # Another shot may see the left wall on its right.
        measured[:, :2] &= measured[:, :2].all(axis=1, keepdims=True)
        self.walls += [(at, shot, np.where(measured[at], np.nan, walls).tolist()) for at, shot, walls in found]
        return len(found), used

    def survey(self, name: str, issues: Sequence[ImportIssue] = (), counts: Sequence[TableCount] = ()) -> Survey:
        """Return what was collected."""
        start, end, offset, counted, passage, rigid, row = zip(*self.shots, strict=True) if self.shots else ([],) * 7
        station, shot, walls = zip(*self.walls, strict=True) if self.walls else ([],) * 3
        return Survey(
            name=name,
            stations=tuple(self.stations),
            start=np.array(start),
            end=np.array(end),
            offset=np.array(offset),
            counted=np.array(counted),
            passage=np.array(passage),
            rigid=np.array(rigid),
            wall_station=np.array(station),
            wall_shot=np.array(shot),
            walls=np.array(walls),
            across=self.across,
            fixed=self.fixed,
            row=np.array(row),
            issues=tuple(issues),
            counts=tuple(counts),
        )

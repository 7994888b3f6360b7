"""A survey along centre lines: stations, the shots between them, and the walls that were measured at stations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message
from geofit.data.site import ImportIssue, TableCount

__all__ = ["LONGEST", "WALLS", "Survey", "SurveyError"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: The columns of :attr:`Survey.walls`.
WALLS = ("left", "right", "up", "down")
#: Longest shot and farthest wall, metres: beyond it a reading or its unit is wrong, and the body would take hours.
LONGEST = 10_000.0
_SHOWN = 6


class SurveyError(GeofitError, ValueError):
    """A survey whose stations cannot be computed, or whose passages have no size."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Survey:
    """Stations, shots and walls as they were measured; lengths in metres, x east, y north, z up.

    Parameters
    ----------
    name : str
        What messages call the survey: the file's name.
    stations : tuple of str
        Names, in the order of their first use.
    start, end : (m,) array of int
        Stations of each shot.
    offset : (m, 3) array
        Measured vector from start to end, after all corrections.
    counted : (m,) array of bool
        Shots that count in the length of the survey.
    passage : (m,) array of bool
        Shots along a passage: they get a body. False for shots at the surface and to walls.
    rigid : (m,) array of bool
        Shots that loop closure must not change.
    wall_station, wall_shot : (w,) array of int
        Station of each record of walls, and the shot whose direction left and right refer to.
    walls : (w, 4) array
        Distances to the left, right, upper and lower wall; nan where they are missing.
    across : bool
        Whether up and down were measured across the passage, as the sections of tunnels are, not vertically.
    fixed : mapping of str to (x, y, z)
        Stations with known coordinates.
    row : (m,) array of int
        Line of the file of each shot.
    issues : tuple of ImportIssue
        What the reader found: rows that are not used, guesses, commands that are not read.
    counts : tuple of TableCount
        Rows read, used and listed.
    """

    name: str
    stations: tuple[str, ...]
    start: Ints
    end: Ints
    offset: Floats
    counted: Mask
    passage: Mask
    rigid: Mask
    wall_station: Ints
    wall_shot: Ints
    walls: Floats
    across: bool = False
    fixed: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    row: Ints
    issues: tuple[ImportIssue, ...] = ()
    counts: tuple[TableCount, ...] = ()

    def __post_init__(self) -> None:
        for name, kind, width in (
            ("start", np.int64, 0),
            ("end", np.int64, 0),
            ("offset", np.float64, 3),
            ("counted", np.bool_, 0),
            ("passage", np.bool_, 0),
            ("rigid", np.bool_, 0),
            ("wall_station", np.int64, 0),
            ("wall_shot", np.int64, 0),
            ("walls", np.float64, 4),
            ("row", np.int64, 0),
        ):
            array = np.array(getattr(self, name), dtype=kind).reshape((-1, width) if width else (-1,))
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        object.__setattr__(self, "fixed", MappingProxyType(dict(self.fixed)))
        if not len(self.start):
            error = next((issue for issue in self.issues if issue.severity == "error"), None)
            raise SurveyError(
                message(
                    "caves.no-shot-because",
                    "The survey {name} has no usable shot; the first row that is not used is {row}: {reason}.",
                    name=Untranslated(self.name),
                    row=error.row,
                    reason=error.reason,
                )
                if error
                else message(
                    "caves.survey-without-shot",
                    "The survey {name} has no shot. Give a file with one.",
                    name=Untranslated(self.name),
                )
            )
        unknown = [station for station in self.fixed if station not in self.stations]
        if unknown:
            raise SurveyError(
                message(
                    "caves.fixed-stations-unknown",
                    "The fixed stations {names} are not in the survey {survey}. Correct their names.",
                    names=first_stations(unknown),
                    survey=Untranslated(self.name),
                )
            )

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "fixed": dict(self.fixed)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        # A survey from another process is as read-only as one made here.
        self.__dict__.update(state)
        self.__post_init__()

    @property
    def length(self) -> float:
        """Sum of the measured lengths of the shots that count, metres."""
        return float(np.linalg.norm(self.offset[self.counted], axis=1).sum())

    def part_of(self) -> Ints:
        """Return the connected part (n,) of each station, numbered from 0 in the order of their first stations."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        n = len(self.stations)
        links = coo_array((np.ones(len(self.start)), (self.start, self.end)), shape=(n, n))
        labels = connected_components(links, directed=False)[1]
        first = np.unique(labels, return_index=True)[1]
        return np.asarray(np.argsort(np.argsort(first))[labels], dtype=np.int64)

    @arguments_checked
    def with_fixed(self, fixed: Mapping[str, tuple[float, float, float]]) -> Survey:
        """Return the survey with more stations fixed; the coordinates given here replace earlier ones."""
        return replace(self, fixed={**self.fixed, **fixed})

    @arguments_checked
    def connected_to(self, station: str) -> Survey:
        """Return the part of the survey that is connected to a station.

        Raises
        ------
        SurveyError
            If there is no such station.
        """
        if station not in self.stations:
            raise SurveyError(
                message(
                    "caves.station-unknown",
                    "The survey {survey} has no station {station}. Give one of its names.",
                    survey=Untranslated(self.name),
                    station=Untranslated(station),
                )
            )
        part = self.part_of()
        inside = part == part[self.stations.index(station)]
        number = np.cumsum(inside) - 1
        shots = inside[self.start]
        shot_number = np.cumsum(shots) - 1
        records = inside[self.wall_station]
        return replace(
            self,
            stations=tuple(name for name, kept in zip(self.stations, inside.tolist(), strict=True) if kept),
            start=number[self.start[shots]],
            end=number[self.end[shots]],
            offset=self.offset[shots],
            counted=self.counted[shots],
            passage=self.passage[shots],
            rigid=self.rigid[shots],
            wall_station=number[self.wall_station[records]],
            wall_shot=shot_number[self.wall_shot[records]],
            walls=self.walls[records],
            fixed={name: xyz for name, xyz in self.fixed.items() if inside[self.stations.index(name)]},
            row=self.row[shots],
        )


def first_stations(stations: list[str]) -> tuple[Untranslated, ...]:
    """Return station names for a message, the first few where there are many."""
    shown = [Untranslated(name) for name in stations[:_SHOWN]]
    if len(stations) > _SHOWN:
        shown.append(Untranslated("..."))
    return tuple(shown)

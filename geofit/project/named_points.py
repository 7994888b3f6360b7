"""Who excluded points are, so that they are found again when their files have changed.

A row names a point by its line: one that is inserted above makes it the name of another point. A named point holds
what does not depend on the line.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, Untranslated, message
from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.project.provenance import Row, turns
from geofit.project.state import State

__all__ = [
    "NO_NAMES",
    "CarriedRows",
    "NamedPoint",
    "Names",
    "PointKey",
    "carried_rows",
    "excluded_names",
    "found_again",
    "named_rows",
    "names_from",
    "names_to_data",
    "point_keys",
    "reopened",
    "whole_of",
]

#: Decimals to which two readings of one contact agree, metres.
DECIMALS = 3
#: Kind, hole, section and place of a point.
PointKey = tuple[str, str, str, tuple[float, ...]]


@dataclass(frozen=True)
class NamedPoint:
    """A point of a file: its ``kind``, ``hole`` and ``section``, and its ``place`` in metres, rounded.

    ``rank`` is which of the points it is that are alike in these, in the order of the file, from 0.
    """

    kind: str
    hole: str
    section: str
    place: tuple[float, ...]
    rank: int = 0

    @property
    def key(self) -> PointKey:
        """What points that are alike have in common."""
        return self.kind, self.hole, self.section, self.place

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> NamedPoint:
        """Return a point from its fields as JSON has them."""
        x, y, z = data["place"]
        place = float(x), float(y), float(z)
        return cls(str(data["kind"]), str(data["hole"]), str(data["section"]), place, int(data["rank"]))


#: Excluded rows of each horizon, and who their points are.
Names = Mapping[str, Mapping[Row, NamedPoint]]
NO_NAMES: Names = {}


@dataclass(frozen=True)
class CarriedRows:
    """Excluded rows by horizon as they are called now; how many moved; ``lost`` lists those that are not found."""

    excluded: Mapping[str, tuple[Row, ...]]
    moved: int = 0
    lost: tuple[Message, ...] = ()


def named_rows(rows: Iterable[Row], points: PointSet) -> dict[Row, NamedPoint]:
    """Return who the points of rows are; rows that ``points`` does not have are left out."""
    wanted = frozenset(rows)
    lines = np.flatnonzero(np.isin(points.row, [row.row for row in wanted]))
    names = {}
    for row, name in _named(points, points.xyz[lines, 0]):
        if row in wanted:
            names[row] = name
    return names


def found_again(names: Mapping[Row, NamedPoint], points: PointSet) -> dict[Row, Row]:
    """Return how rows are called now, by their former names; those whose points are not there are left out.

    A point stays in its file: one at the same place in another file is another observation.
    """
    x = np.array([name.place[0] for name in names.values()])
    now = {(row.file, name): row for row, name in _named(points, x)}
    return {row: now[row.file, name] for row, name in names.items() if (row.file, name) in now}


def excluded_names(state: State, site: Site) -> dict[str, dict[Row, NamedPoint]]:
    """Return who the excluded points of a state are.

    ``site`` has the data of the state as it is worked on (:meth:`~geofit.project.state.State.shaped`), its horizons
    whole; of horizons that it lacks nothing is known.
    """
    return {
        name: named_rows(rows, points)
        for name, rows in state.excluded.items()
        if rows and (points := site.horizons.get(whole_of(state, name))) is not None
    }


def carried_rows(state: State, names: Names, site: Site) -> CarriedRows:
    """Return the excluded rows of a state as a site calls them now; what has no name is lost.

    ``site`` is shaped as for :func:`excluded_names`; horizons that it lacks are left out.
    """
    excluded: dict[str, tuple[Row, ...]] = {}
    moved = 0
    lost: list[Message] = []
    for name, rows in state.excluded.items():
        points = site.horizons.get(whole_of(state, name))
        if points is None:
            continue
        now = found_again({row: one for row, one in names.get(name, {}).items() if row in rows}, points)
        excluded[name] = tuple(sorted(now.values()))
        moved += sum(row != former for former, row in now.items())
        lost += [
            message(
                "project.exclusion-lost",
                "{name}: the exclusion of {file} row {row} is lost, because its point was removed or corrected",
                name=Untranslated(name), file=Untranslated(row.file), row=row.row,
            )
            for row in sorted(rows)
            if row not in now
        ]  # fmt: skip
    return CarriedRows(excluded, moved, tuple(lost))


def reopened(state: State, names: Names, site: Site, changed: Collection[str]) -> tuple[State, CarriedRows]:
    """Return a state that was stored, its excluded rows as a site calls them now.

    Rows without a name (of a project or journal that an earlier geofit wrote) stay as they are; ``lost`` lists them
    where their file is among ``changed``: they may be other points now.
    """
    unnamed = {name: rows.difference(names.get(name, ())) for name, rows in state.excluded.items()}
    named = {name: rows - unnamed[name] for name, rows in state.excluded.items()}
    found = carried_rows(replace(state, excluded=named), names, site)
    excluded = {name: frozenset(found.excluded.get(name, named[name])) | unnamed[name] for name in named}
    doubtful = [
        message(
            "project.exclusion-doubtful",
            "{name}: {file} has changed, and row {row} stays excluded by its number: check that it is the same point",
            name=Untranslated(name), file=Untranslated(row.file), row=row.row,
        )
        for name, rows in unnamed.items()
        for row in sorted(rows)
        if row.file in changed
    ]  # fmt: skip
    excluded = {name: rows for name, rows in excluded.items() if rows}
    return replace(state, excluded=excluded), replace(found, lost=(*found.lost, *doubtful))


def whole_of(state: State, name: str) -> str:
    """Return the horizon that a block is a part of; a horizon that was not split is its own whole."""
    return state.parts[name].horizon if name in state.parts else name


def point_keys(points: PointSet) -> list[PointKey]:
    """Return what tells points apart, but for their file."""
    places = points.xyz.round(DECIMALS).tolist()
    return [
        (kind, hole, section, tuple(place))
        for kind, hole, section, place in zip(
            points.kind.tolist(), points.hole.tolist(), points.section.tolist(), places, strict=True
        )
    ]


def names_to_data(names: Names) -> dict[str, list[dict[str, Any]]]:
    """Return numbers, words, lists and mappings only."""
    return {
        name: [{**asdict(row), "point": asdict(one)} for row, one in sorted(rows.items(), key=lambda pair: pair[0])]
        for name, rows in names.items()
    }


def names_from(data: Mapping[str, Iterable[Mapping[str, Any]]]) -> dict[str, dict[Row, NamedPoint]]:
    """Return what :func:`names_to_data` was called on."""
    return {
        name: {Row(one["file"], one["row"], one["turn"]): NamedPoint.from_data(one["point"]) for one in rows}
        for name, rows in data.items()
    }


def _named(points: PointSet, x: NDArray[np.float64]) -> Iterable[tuple[Row, NamedPoint]]:
    """Return rows and names of the points that have one of the coordinates ``x``: of all a large cloud has many."""
    near = np.flatnonzero(np.isin(points.xyz[:, 0].round(DECIMALS), x.round(DECIMALS)))
    if not len(near):
        return
    turn = turns(points)[near].tolist()
    some = points[near]
    alike: Counter[tuple[str, PointKey]] = Counter()
    for file, row, which, key in zip(some.file.tolist(), some.row.tolist(), turn, point_keys(some), strict=True):
        yield Row(file, row, which), NamedPoint(*key, rank=alike[file, key])
        alike[file, key] += 1

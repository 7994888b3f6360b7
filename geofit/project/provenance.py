"""From what a surface is made: plain values that name it, so that it can be made again to the last bit."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site

__all__ = [
    "Corners",
    "DocumentError",
    "Earlier",
    "ManualEdit",
    "Move",
    "MoveToPointEdit",
    "Part",
    "Provenance",
    "Row",
    "SeparationEdit",
    "Weigh",
    "corners_from",
    "data_digest",
    "find_rows",
    "fingerprint",
    "matched",
    "settings_from",
    "turns",
    "without_rows",
]


#: No move, in map coordinates.
NOWHERE = (0.0, 0.0, 0.0)
#: Corners of a polygon in map coordinates, metres, not closed.
Corners = tuple[tuple[float, float], ...]


class DocumentError(GeofitError):
    """The document cannot do what was asked for: it has no such horizon, row or surface."""


@dataclass(frozen=True, order=True)
class Row:
    """One point by its place in the files: file, line, and which of the points that this line gave (from 0)."""

    file: str
    row: int
    turn: int = 0

    @classmethod
    def of(cls, points: PointSet, index: int) -> Row:
        """Return the row of a point."""
        file, row = str(points.file[index]), int(points.row[index])
        return cls(file, row, int(np.searchsorted(_same(points, file, row), index)))

    def find(self, points: PointSet) -> int | None:
        """Return the index of the point of this row, None where ``points`` does not have it."""
        same = _same(points, self.file, self.row)
        return int(same[self.turn]) if self.turn < len(same) else None


@dataclass(frozen=True)
class Move:
    """A control point of a patch, raised by ``dz`` metres and moved by ``aside``, map coordinates, metres."""

    patch: str
    i: int
    j: int
    dz: float
    aside: tuple[float, float, float] = NOWHERE


@dataclass(frozen=True)
class MoveToPointEdit:
    """The surface moved to the point ``index`` of those that were fitted, by ``share`` of its residual."""

    index: int
    share: float


@dataclass(frozen=True)
class Weigh:
    """A control point of the periphery with another weight."""

    patch: str
    i: int
    j: int
    weight: float


@dataclass(frozen=True)
class SeparationEdit:
    """Horizons separated to ``minimum`` metres, from the top; ``others`` made all of them but this one."""

    sequence: tuple[str, ...]
    minimum: float
    others: tuple[Provenance, ...]


@dataclass(frozen=True)
class Part:
    """One block of a horizon that faults cut.

    Parameters
    ----------
    horizon : str
        Name of the whole.
    given : str
        :func:`fingerprint` of the whole.
    faults : tuple of Provenance
        The faults that the site states to cut it.
    sides : tuple of int
        On which side of each of them the block lies, 0 or 1; -1 of one that has all points on one side.
    members : str
        Its points among those of the whole, as :func:`runs` writes them.
    area : tuple of (x, y)
        Corners of the study area, map coordinates.
    """

    horizon: str
    given: str
    faults: tuple[Provenance, ...]
    sides: tuple[int, ...]
    members: str
    area: tuple[tuple[float, float], ...]

    def of(self, whole: PointSet) -> PointSet:
        """Return its points; numbers that the whole does not have any more are passed over."""
        index = indices(self.members)
        return whole[index[index < len(whole)]]

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {
            "horizon": self.horizon,
            "given": self.given,
            "faults": [fault.to_data() for fault in self.faults],
            "sides": list(self.sides),
            "members": self.members,
            "area": [list(corner) for corner in self.area],
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Part:
        """Return what :meth:`to_data` was called on."""
        return cls(
            data["horizon"],
            data["given"],
            tuple(Provenance.from_data(fault) for fault in data["faults"]),
            tuple(data["sides"]),
            data["members"],
            tuple((x, y) for x, y in data["area"]),
        )


ManualEdit = Move | MoveToPointEdit | Weigh
_EDITS: dict[str, type[ManualEdit]] = {"move": Move, "pull": MoveToPointEdit, "weigh": Weigh}


@dataclass(frozen=True)
class Provenance:
    """What a surface is made from.

    Parameters
    ----------
    horizon : str
        Name of the horizon.
    settings : FitSettings
        Settings of the fit.
    given : str
        :func:`fingerprint` of the site for the horizon.
    excluded : tuple of Row
        Rows that were left out, sorted.
    edits : tuple of ManualEdit or SeparationEdit
        Changes after the fit, in their order.
    part : Part or None
        What the horizon is a block of.
    """

    horizon: str
    settings: FitSettings
    given: str
    excluded: tuple[Row, ...] = ()
    edits: tuple[ManualEdit | SeparationEdit, ...] = field(default=())
    part: Part | None = None

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {
            "horizon": self.horizon,
            "settings": asdict(self.settings),
            "given": self.given,
            "excluded": [asdict(row) for row in self.excluded],
            "edits": [_edit_data(edit) for edit in self.edits],
            "part": None if self.part is None else self.part.to_data(),
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Provenance:
        """Return what :meth:`to_data` was called on."""
        return cls(
            data["horizon"],
            settings_from(data["settings"]),
            data["given"],
            tuple(Row(**row) for row in data["excluded"]),
            tuple(_edit_from(edit) for edit in data["edits"]),
            None if data.get("part") is None else Part.from_data(data["part"]),
        )

    def ancestors(self) -> Iterator[Provenance]:
        """Return this provenance, and all that its changes and its faults name."""
        yield self
        for fault in () if self.part is None else self.part.faults:
            yield from fault.ancestors()
        for edit in self.edits:
            if isinstance(edit, SeparationEdit):
                for other in edit.others:
                    yield from other.ancestors()


@dataclass(frozen=True)
class Earlier:
    """The state of a horizon before the data of the site changed.

    ``data`` names the data, ``provenance`` what its surface was made from, ``area`` is the study area that was drawn.
    """

    data: str
    provenance: Provenance
    area: Corners | None = None

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        area = None if self.area is None else [list(corner) for corner in self.area]
        return {"data": self.data, "provenance": self.provenance.to_data(), "area": area}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Earlier:
        """Return what :meth:`to_data` was called on."""
        return cls(data["data"], Provenance.from_data(data["provenance"]), corners_from(data.get("area")))


def corners_from(data: Any) -> Corners | None:
    """Return corners from plain data; None where none are given."""
    return None if data is None else tuple((float(x), float(y)) for x, y in data)


def settings_from(data: Mapping[str, Any]) -> FitSettings:
    """Return settings from plain data: lists of corners become tuples again."""
    return FitSettings(**data)


def without_rows(points: PointSet, rows: Iterable[Row]) -> PointSet:
    """Return the points but those of ``rows``; rows that are not there are passed over."""
    wanted = frozenset(rows)
    found = find_rows(points, wanted)
    if not len(found):
        return points
    kept = np.ones(len(points), bool)
    kept[found] = False
    return points[kept]


def find_rows(points: PointSet, rows: Collection[Row]) -> NDArray[np.intp]:
    """Return the indices of the points of rows, ascending; rows that are not there are passed over."""
    if not rows:
        return np.empty(0, np.intp)
    candidates = np.flatnonzero(np.isin(points.row, [row.row for row in rows]))
    turn = turns(points)
    known = [Row(str(points.file[i]), int(points.row[i]), int(turn[i])) in rows for i in candidates]
    found: NDArray[np.intp] = candidates[np.array(known, bool)]
    return found


def turns(points: PointSet) -> NDArray[np.int64]:
    """Return which of the points of its line each point is, (n,) from 0 on."""
    file = np.unique(points.file, return_inverse=True)[1].ravel()
    order = np.lexsort((np.arange(len(points)), points.row, file))
    new = np.ones(len(points), bool)
    new[1:] = (np.diff(points.row[order]) != 0) | (np.diff(file[order]) != 0)
    start = np.maximum.accumulate(np.where(new, np.arange(len(points)), 0))
    turn = np.empty(len(points), np.int64)
    turn[order] = np.arange(len(points)) - start
    return turn


def matched(points: PointSet, among: PointSet) -> NDArray[np.int64]:
    """Return the index among other points of each point by its file, line and turn; -1 where there is none.

    Points that lack some turns of a line (one of them was excluded) are told apart by their places.
    """
    keys: dict[tuple[str, int, bytes], list[int]] = {}
    for index, key in enumerate(_keys(among)):
        keys.setdefault(key, []).append(index)
    taken: dict[tuple[str, int, bytes], int] = {}
    found = np.full(len(points), -1)
    for index, key in enumerate(_keys(points)):
        turn = taken.get(key, 0)
        places = keys.get(key, ())
        if turn < len(places):
            found[index], taken[key] = places[turn], turn + 1
    return found


def _keys(points: PointSet) -> Iterator[tuple[str, int, bytes]]:
    for file, row, xyz in zip(points.file.tolist(), points.row.tolist(), points.xyz, strict=True):
        yield file, row, xyz.tobytes()


def runs(index: NDArray[np.intp]) -> str:
    """Return ascending numbers in short.

    Examples
    --------
    >>> runs(np.array([0, 1, 2, 5, 7, 8]))
    '0-2 5 7-8'
    """
    parts = np.split(index, np.flatnonzero(np.diff(index) != 1) + 1) if len(index) else []
    return " ".join(f"{one[0]}-{one[-1]}" if len(one) > 1 else f"{one[0]}" for one in parts)


def indices(text: str) -> NDArray[np.intp]:
    """Return the numbers that :func:`runs` wrote."""
    ends = ([int(word) for word in run.split("-")] for run in text.split())
    return np.concatenate([np.arange(0), *(np.arange(end[0], end[-1] + 1) for end in ends)])


def fingerprint(points: PointSet, site: Site) -> str:
    """Return a hash of everything that a fit of points of a site, and its check, depend on."""
    digest = hashlib.sha256(site_digest(site))
    for array in (points.xyz, points.accuracy, points.row):
        digest.update(np.ascontiguousarray(array).tobytes())
    for words in (points.kind, points.hole, points.section, points.file):
        digest.update("\n".join(words.tolist()).encode())
    return digest.hexdigest()[:16]


def data_digest(site: Site) -> str:
    """Return the name of the data of a site: a hash of all that was read and of the files that it came from."""
    digest = hashlib.sha256(site_digest(site))
    for name, points in site.horizons.items():
        digest.update(f"{name}\n{fingerprint(points, site)}\n".encode())
    for name, value in sorted(site.inputs.items()):
        digest.update(f"{name}\n{value}\n".encode())
    return digest.hexdigest()[:16]


def site_digest(site: Site) -> bytes:
    """Return a hash of the study area, the ground and the measured dips."""
    digest = hashlib.sha256()
    arrays = [site.boundary]
    if site.ground is not None:
        arrays += [site.ground.x, site.ground.y, site.ground.z]
    if site.orientations is not None:
        arrays += [site.orientations.xyz, site.orientations.azimuth, site.orientations.dip]
        digest.update("\n".join(site.orientations.horizon.tolist()).encode())
    for array in arrays:
        digest.update(b"" if array is None else np.ascontiguousarray(array, dtype=np.float64).tobytes())
    return digest.digest()


def _same(points: PointSet, file: str, row: int) -> NDArray[np.intp]:
    found: NDArray[np.intp] = np.flatnonzero(points.row == row)
    same: NDArray[np.intp] = found[points.file[found] == file]
    return same


def _edit_data(edit: ManualEdit | SeparationEdit) -> dict[str, Any]:
    if isinstance(edit, SeparationEdit):
        others = [other.to_data() for other in edit.others]
        return {"kind": "separate", "sequence": list(edit.sequence), "minimum": edit.minimum, "others": others}
    values = asdict(edit)
    if values.get("aside") == NOWHERE:
        # As projects and journals had it before control points moved aside.
        del values["aside"]
    return {"kind": next(kind for kind, made in _EDITS.items() if isinstance(edit, made)), **values}


def _edit_from(data: Mapping[str, Any]) -> ManualEdit | SeparationEdit:
    if data["kind"] == "separate":
        others = tuple(Provenance.from_data(other) for other in data["others"])
        return SeparationEdit(tuple(data["sequence"]), data["minimum"], others)
    values = {name: value for name, value in data.items() if name != "kind"}
    if "aside" in values:
        values["aside"] = tuple(values["aside"])
    return _EDITS[data["kind"]](**values)

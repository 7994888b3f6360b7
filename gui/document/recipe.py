"""From what a surface is made: plain values that name it, so that it can be made again to the last bit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.errors import GeofitError
from geofit.points import PointSet
from geofit.settings import FitSettings

__all__ = [
    "Apart",
    "DocumentError",
    "HandEdit",
    "Move",
    "Pull",
    "Recipe",
    "Row",
    "Weigh",
    "fingerprint",
    "settings_from",
    "without_rows",
]


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
    """A control point of a patch, raised by ``dz`` metres."""

    patch: str
    i: int
    j: int
    dz: float


@dataclass(frozen=True)
class Pull:
    """The surface pulled to the point ``index`` of those that were fitted, by ``share`` of its residual."""

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
class Apart:
    """Horizons pushed apart to ``minimum`` metres, from the top; ``others`` made all of them but this one."""

    sequence: tuple[str, ...]
    minimum: float
    others: tuple[Recipe, ...]


HandEdit = Move | Pull | Weigh
_EDITS: dict[str, type[HandEdit]] = {"move": Move, "pull": Pull, "weigh": Weigh}


@dataclass(frozen=True)
class Recipe:
    """What a surface is made from.

    Parameters
    ----------
    horizon : str
        Name of the horizon.
    settings : FitSettings
        Settings of the fit.
    given : str
        :func:`fingerprint` of the site's points and study area.
    excluded : tuple of Row
        Rows that were left out, sorted.
    edits : tuple of HandEdit or Apart
        Changes after the fit, in their order.
    """

    horizon: str
    settings: FitSettings
    given: str
    excluded: tuple[Row, ...] = ()
    edits: tuple[HandEdit | Apart, ...] = field(default=())

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {
            "horizon": self.horizon,
            "settings": asdict(self.settings),
            "given": self.given,
            "excluded": [asdict(row) for row in self.excluded],
            "edits": [_edit_data(edit) for edit in self.edits],
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Recipe:
        """Return what :meth:`to_data` was called on."""
        return cls(
            data["horizon"],
            settings_from(data["settings"]),
            data["given"],
            tuple(Row(**row) for row in data["excluded"]),
            tuple(_edit_from(edit) for edit in data["edits"]),
        )

    def parts(self) -> Iterator[Recipe]:
        """Return this recipe, and all that its changes name."""
        yield self
        for edit in self.edits:
            if isinstance(edit, Apart):
                for other in edit.others:
                    yield from other.parts()


def settings_from(data: Mapping[str, Any]) -> FitSettings:
    """Return settings from plain data: lists of corners become tuples again."""
    return FitSettings(**data)


def without_rows(points: PointSet, rows: Iterable[Row]) -> PointSet:
    """Return the points but those of ``rows``; rows that are not there are passed over."""
    found = [index for row in rows if (index := row.find(points)) is not None]
    if not found:
        return points
    kept = np.ones(len(points), bool)
    kept[found] = False
    return points[kept]


def fingerprint(points: PointSet, boundary: NDArray[np.float64] | None) -> str:
    """Return a hash of everything in the points and the study area that a fit depends on."""
    digest = hashlib.sha256()
    for array in (points.xyz, points.accuracy, points.row):
        digest.update(np.ascontiguousarray(array).tobytes())
    for words in (points.kind, points.hole, points.section, points.file):
        digest.update("\n".join(words.tolist()).encode())
    digest.update(b"" if boundary is None else np.ascontiguousarray(boundary, dtype=np.float64).tobytes())
    return digest.hexdigest()[:16]


def _same(points: PointSet, file: str, row: int) -> NDArray[np.intp]:
    found: NDArray[np.intp] = np.flatnonzero(points.row == row)
    same: NDArray[np.intp] = found[points.file[found] == file]
    return same


def _edit_data(edit: HandEdit | Apart) -> dict[str, Any]:
    if isinstance(edit, Apart):
        others = [other.to_data() for other in edit.others]
        return {"kind": "apart", "sequence": list(edit.sequence), "minimum": edit.minimum, "others": others}
    return {"kind": next(kind for kind, made in _EDITS.items() if isinstance(edit, made)), **asdict(edit)}


def _edit_from(data: Mapping[str, Any]) -> HandEdit | Apart:
    if data["kind"] == "apart":
        others = tuple(Recipe.from_data(other) for other in data["others"])
        return Apart(tuple(data["sequence"]), data["minimum"], others)
    return _EDITS[data["kind"]](**{name: value for name, value in data.items() if name != "kind"})

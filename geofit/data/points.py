"""Points of one horizon with their origin: what every fit, check and report starts from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import column, finite_places, wrong_shape
from geofit.data.errors import PointsError
from geofit.data.given import arguments_checked, keywords_known
from geofit.data.labels import Labels
from geofit.data.messages import Message, Untranslated, message

__all__ = ["KINDS", "PointSet", "look_like_degrees"]

#: Source kinds that the readers give; any other word is allowed.
KINDS = ("borehole", "adit", "section", "outcrop", "geophysics", "map", "point")

Strings = NDArray[np.str_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Longitudes and latitudes: limits; the widest site; how much nearer to each other than to the origin the places are;
#: metres of elevation a degree (one is 111 km) below which a surface over degrees would be flatter than any rock.
_LIMITS, _WIDEST, _AWAY, _RISE = (180.0, 90.0), 5.0, 10.0, 10.0


def look_like_degrees(xyz: ArrayLike) -> bool:
    """Return whether (n, 3) coordinates can only be longitude and latitude, in either order, and metres.

    They are within the limits of both, in less than 5 units of each other but far from 0, written finer than to the
    millimetre, and rise ten times more than they extend: a slope that a horizon over metres does not have, but
    every horizon over degrees.

    Examples
    --------
    >>> look_like_degrees([[110.1012, 30.2034, 5.0], [110.1223, 30.2145, 9.0], [110.1334, 30.2256, 7.0]])
    True
    >>> look_like_degrees([[0.0, 0.0, 5.0], [100.0, 0.0, 9.0], [50.0, 80.0, 7.0]])
    False
    """
    values = np.asarray(xyz, float)
    # The first rows mostly settle it: a million are looked at last.
    if len(values) < 3 or not all(map(_within_limits, (values[:3], values))):
        return False
    low, high = values.min(axis=0), values.max(axis=0)
    extent = float((high - low)[:2].max())
    middle = float(np.hypot(*(low + high)[:2] / 2))
    milli = 1e3 * values[:, :2]
    fine = (np.abs(milli - np.round(milli)) > 1e-4).any(axis=1).mean() > 0.5
    return bool(0 < extent <= _WIDEST and middle > _AWAY * extent and high[2] - low[2] > _RISE * extent and fine)


def _within_limits(xyz: Floats) -> bool:
    """Return whether x and y can be longitude and latitude, in either order."""
    size = np.abs(xyz[:, :2]).max(axis=0)
    return bool((size <= _LIMITS).all() or (size <= _LIMITS[::-1]).all())


_WORDS = ("kind", "hole", "section", "file")


@keywords_known
@dataclass(frozen=True, eq=False, init=False)
class PointSet:
    """Points of one horizon, each traceable to a row of a file (paper, sec. 2).

    Parameters
    ----------
    xyz : (n, 3) array_like
        Easting, northing, elevation in metres. Numbers of 32 bits that round them by centimetres cause a
        ``UserWarning``.
    kind : str or (n,) array_like of str
        Source kind of each point, see :data:`KINDS`.
    hole, section : str or (n,) array_like of str
        Identifier of the hole (or adit) and of the section a point comes from; empty where there is none.
        The points of a section follow each other in file order along the drawn line.
    accuracy : float or (n,) array_like
        One standard deviation of the elevation in metres; nan where the source states none.
    row : (n,) array_like of int
        Line of the source file, counted from 1; 0 where unknown.
    file : str or (n,) array_like of str
        Name of the source file; empty where unknown.

    Attributes
    ----------
    labels : mapping of str to Labels
        Codes of "kind", "hole", "section" and "file": what is held, and what large sets are grouped by.

    Raises
    ------
    PointsError
        If ``xyz`` is not (n, 3) and finite, or another array has another length.

    Examples
    --------
    >>> points = PointSet([[0, 0, 10.0], [5, 0, 11.0]], kind="borehole", hole=["B1", "B2"])
    >>> len(points), points.hole.tolist()
    (2, ['B1', 'B2'])
    """

    xyz: Floats
    accuracy: Floats
    row: Ints
    labels: Mapping[str, Labels]

    def __init__(
        self,
        xyz: ArrayLike,
        kind: ArrayLike | Labels = "point",
        hole: ArrayLike | Labels = "",
        section: ArrayLike | Labels = "",
        accuracy: ArrayLike = np.nan,
        row: ArrayLike = 0,
        file: ArrayLike | Labels = "",
    ) -> None:
        xyz = finite_places(xyz)
        n = len(xyz)
        self._set("xyz", xyz)
        self._set("accuracy", column("accuracy", accuracy, n, np.float64))
        self._set("row", column("row", row, n, np.int64))
        words = {"kind": kind, "hole": hole, "section": section, "file": file}
        object.__setattr__(self, "labels", {name: _labels(name, values, n) for name, values in words.items()})
        wrong = np.flatnonzero((self.accuracy <= 0) | np.isinf(self.accuracy))
        if wrong.size:
            raise PointsError(
                message(
                    "data.accuracy-not-positive",
                    "accuracy[{index}] is {value:g} m; one standard deviation must be above 0. Use nan where the "
                    "source states none.",
                    index=wrong[0],
                    value=self.accuracy[wrong[0]],
                )
            )

    def _set(self, name: str, array: NDArray[Any]) -> None:
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.xyz)

    @cached_property
    def kind(self) -> Strings:
        """Source kind of each point, (n,)."""
        return self.labels["kind"].words()

    @cached_property
    def hole(self) -> Strings:
        """Hole or adit of each point, (n,); empty where there is none."""
        return self.labels["hole"].words()

    @cached_property
    def section(self) -> Strings:
        """Section of each point, (n,); empty where there is none."""
        return self.labels["section"].words()

    @cached_property
    def file(self) -> Strings:
        """Source file of each point, (n,); empty where unknown."""
        return self.labels["file"].words()

    def _columns(self) -> dict[str, Any]:
        return {"xyz": self.xyz, "accuracy": self.accuracy, "row": self.row, **self.labels}

    def __repr__(self) -> str:
        counts = np.bincount(self.labels["kind"].codes, minlength=1)
        kinds = sorted((kind, n) for kind, n in zip(self.labels["kind"].table, counts.tolist(), strict=False) if n)
        parts = [f"{len(self)} points", *(f"{n} {kind}" for kind, n in kinds)]
        if len(self):
            low, high = self.xyz[:, 2].min(), self.xyz[:, 2].max()
            parts.append(f"z {low:.1f} to {high:.1f} m")
        return f"<PointSet: {', '.join(parts)}>"

    def __getitem__(self, index: Any) -> PointSet:
        """Return the points at an index array, a mask or a slice."""
        index = np.atleast_1d(index) if np.ndim(index) == 0 and not isinstance(index, slice) else index
        return PointSet(**{name: column[index] for name, column in self._columns().items()})

    def with_(self, **changes: Any) -> PointSet:
        """Return a copy with some columns replaced."""
        return PointSet(**{**self._columns(), **changes})

    @classmethod
    @arguments_checked
    def concatenate(cls, sets: Sequence[PointSet]) -> PointSet:
        """Join sets of points, in order."""
        if not sets:
            return cls(np.empty((0, 3)))
        columns: dict[str, Any] = {name: Labels.concatenate([s.labels[name] for s in sets]) for name in _WORDS}
        arrays = {name: np.concatenate([getattr(s, name) for s in sets]) for name in ("xyz", "accuracy", "row")}
        return cls(**columns, **arrays)

    @arguments_checked
    def describe(self, index: int) -> Message:
        """Name one point as a person would look it up: hole or section, file and row."""
        word = {label: self.labels[label].word(index) for label in _WORDS}
        name, kind = word["hole"] or word["section"], word["kind"]
        what = (
            message("data.point-kind-name", "{kind} {name}", kind=kind, name=Untranslated(name))
            if name
            else message("data.point-kind", "{kind}", kind=kind)
        )
        file, row = word["file"], int(self.row[index])
        if file:
            return message("data.point-in-file", "{point}, {file} row {row}", point=what, file=file, row=row)
        return message("data.point-in-row", "{point}, row {row}", point=what, row=row) if row else what


def _labels(name: str, values: ArrayLike | Labels, n: int) -> Labels:
    if not isinstance(values, Labels):
        if np.ndim(values) == 0:
            return Labels.same(str(values), n)
        values = Labels.of(column(name, values, n, np.str_))
    if len(values) != n:
        raise PointsError(wrong_shape(name, (len(values),), n))
    return values

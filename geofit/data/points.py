"""Points of one horizon with their origin: what every fit, check and report starts from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import PointsError
from geofit.data.messages import Message, Verbatim, message

__all__ = ["KINDS", "PointSet"]

#: Source kinds that the readers give; any other word is allowed.
KINDS = ("borehole", "adit", "section", "outcrop", "geophysics", "map", "point")

Strings = NDArray[np.str_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PointSet:
    """Points of one horizon, each traceable to a row of a file (paper, sec. 2).

    Parameters
    ----------
    xyz : (n, 3) array_like
        Easting, northing, elevation in metres.
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
    kind: Strings = "point"  # type: ignore[assignment]
    hole: Strings = ""  # type: ignore[assignment]
    section: Strings = ""  # type: ignore[assignment]
    accuracy: Floats = np.nan  # type: ignore[assignment]
    row: Ints = 0  # type: ignore[assignment]
    file: Strings = ""  # type: ignore[assignment]

    if TYPE_CHECKING:
        # What may be given is wider than what is held.
        def __init__(
            self,
            xyz: ArrayLike,
            kind: ArrayLike = ...,
            hole: ArrayLike = ...,
            section: ArrayLike = ...,
            accuracy: ArrayLike = ...,
            row: ArrayLike = ...,
            file: ArrayLike = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        try:
            xyz = np.array(self.xyz, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise PointsError(
                message(
                    "points.xyz-hold-numbers-give",
                    "xyz must hold numbers: {error}. Give an (n, 3) array of metres.",
                    error=error,
                )
            ) from None
        if xyz.size == 0:
            xyz = xyz.reshape(0, 3)
        if xyz.ndim != 2 or xyz.shape[1] != 3:
            raise PointsError(
                message(
                    "points.xyz-shape-array-easting",
                    "xyz has shape {shape}; an (n, 3) array of easting, northing, elevation is needed.",
                    shape=xyz.shape,
                )
            )
        bad = np.flatnonzero(~np.isfinite(xyz).all(axis=1))
        if bad.size:
            raise PointsError(
                message(
                    "points.points-not-finite-first",
                    "{count} of {total} points are not finite, the first at index {index}: {place}. Remove or "
                    "complete them before fitting.",
                    count=bad.size,
                    total=len(xyz),
                    index=bad[0],
                    place=xyz[bad[0]].tolist(),
                )
            )
        n = len(xyz)
        self._set("xyz", xyz)
        for name in ("kind", "hole", "section", "file"):
            self._set(name, _column(name, getattr(self, name), n, np.str_))
        self._set("accuracy", _column("accuracy", self.accuracy, n, np.float64))
        self._set("row", _column("row", self.row, n, np.int64))
        wrong = np.flatnonzero((self.accuracy <= 0) | np.isinf(self.accuracy))
        if wrong.size:
            raise PointsError(
                message(
                    "points.accuracy-standard-deviation-above",
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

    def __getitem__(self, index: Any) -> PointSet:
        """Return the points at an index array, a mask or a slice."""
        return PointSet(
            **{f.name: np.atleast_1d(getattr(self, f.name)[index]) for f in fields(self)}
            | {"xyz": np.atleast_2d(self.xyz[index])}
        )

    def with_(self, **changes: Any) -> PointSet:
        """Return a copy with some columns replaced."""
        return replace(self, **changes)

    @classmethod
    def concatenate(cls, sets: Sequence[PointSet]) -> PointSet:
        """Join sets of points, in order."""
        if not sets:
            return cls(np.empty((0, 3)))
        return cls(**{f.name: np.concatenate([getattr(s, f.name) for s in sets]) for f in fields(cls)})

    def describe(self, index: int) -> Message:
        """Name one point as a person would look it up: hole or section, file and row."""
        name, kind = str(self.hole[index] or self.section[index]), str(self.kind[index])
        what = (
            message("point.kind-name", "{kind} {name}", kind=kind, name=Verbatim(name))
            if name
            else message("point.kind", "{kind}", kind=kind)
        )
        file, row = str(self.file[index]), int(self.row[index])
        if file:
            return message("point.in-file", "{point}, {file} row {row}", point=what, file=file, row=row)
        return message("point.in-row", "{point}, row {row}", point=what, row=row) if row else what


def _column(name: str, values: ArrayLike, n: int, dtype: type) -> NDArray[Any]:
    try:
        array: NDArray[Any] = np.asarray(values, dtype=dtype)
    except (TypeError, ValueError) as error:
        raise PointsError(
            message(
                "points.cannot-read",
                "{name} cannot be read as {type}: {error}.",
                name=name,
                type=dtype.__name__,
                error=error,
            )
        ) from None
    if array.ndim == 0:
        return np.full(n, array, dtype=array.dtype)
    if array.shape != (n,):
        raise PointsError(
            message(
                "points.shape-points-need-shape",
                "{name} has shape {shape}; {n} points need shape ({n},) or one value for all.",
                name=name,
                shape=array.shape,
                n=n,
            )
        )
    return array.copy()

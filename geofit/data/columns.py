"""Arrays as a caller gives them, checked: places (n, 3) and columns of n values."""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import PointsError
from geofit.data.messages import Message, Untranslated, message, plural_message

__all__ = ["LARGEST", "column", "finite_places", "measurable_places", "places", "refuse_far", "wrong_shape"]

#: Largest coordinate, metres: beyond it a double has not the digits that a surface is measured by.
LARGEST = 1e9
#: Metres that numbers of 32 bits may move a place by without a warning.
UNNOTICED = 0.01


def places(name: str, given: ArrayLike) -> NDArray[np.float64]:
    """Return a copy of easting, northing, elevation, (n, 3), metres; nothing given is (0, 3).

    A read-only array is not copied. Of a table with columns x, y and z, such as a pandas DataFrame, these are taken,
    whatever their order.

    Raises
    ------
    PointsError
        If the values are not numbers or no (n, 3) array.

    Warns
    -----
    UserWarning
        If they are numbers of 32 or 16 bits, which round map coordinates by more than :data:`UNNOTICED`.
    """
    if isinstance(given, np.ndarray) and _fixed(given, np.float64) and given.ndim == 2 and given.shape[1] == 3:
        return given
    types = [getattr(given, "dtype", np.float64)]
    if isinstance(given, np.ma.MaskedArray):
        # A masked value is missing, whatever number it hides.
        given = np.ma.filled(given.astype(np.float64), np.nan)
    try:
        named = {str(one).casefold(): one for one in _names(given)}
        if named.keys() >= set("xyz"):
            table: Any = given
            types = [getattr(table[named[axis]], "dtype", np.float64) for axis in "xyz"]
            given = np.column_stack([np.asarray(table[named[axis]], dtype=np.float64) for axis in "xyz"])
        if np.iscomplexobj(given):
            raise TypeError("they are complex")
        xyz = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise PointsError(
            message(
                "data.coordinates-not-numbers",
                "{name} must contain numbers: {error}. Give an (n, 3) array of metres.",
                name=Untranslated(name),
                error=error,
            )
        ) from None
    if xyz.size == 0:
        xyz = xyz.reshape(0, 3)
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise PointsError(
            message(
                "data.coordinates-wrong-shape",
                "{name} has shape {shape}; an (n, 3) array of easting, northing, elevation is needed.",
                name=Untranslated(name),
                shape=xyz.shape,
            )
        )
    _warn_of_rounding(name, xyz, types)
    return xyz


def _warn_of_rounding(name: str, xyz: NDArray[np.float64], types: list[Any]) -> None:
    """Warn a caller in Python of coordinates that came as numbers of 32 or 16 bits and are that much off."""
    steps = [
        float(np.spacing(np.abs(part[np.isfinite(part)]).max(initial=0.0).astype(kind)))
        for part, kind in zip(np.array_split(xyz, len(types), axis=1), types, strict=True)
        if isinstance(kind, np.dtype) and kind.kind == "f" and kind.itemsize < np.dtype(np.float64).itemsize
    ]
    if max(steps, default=0.0) > 2 * UNNOTICED:
        warnings.warn(
            f"{name}: single precision (float32) rounds coordinates of this size to {max(steps):.3g} m. Read and keep "
            "them as float64, or subtract a constant before they become float32.",
            UserWarning,
            stacklevel=4,
        )


def _names(given: Any) -> list[Any]:
    """Return the names of the columns of a table: a DataFrame or a structured array."""
    return list(given.dtype.names or ()) if isinstance(given, np.ndarray) else list(getattr(given, "columns", ()))


def finite_places(given: ArrayLike, name: str = "xyz") -> NDArray[np.float64]:
    """Return :func:`places` that are neither nan nor infinite.

    Raises
    ------
    PointsError
        If one is; the text names the first.
    """
    xyz = places(name, given)
    if not np.isfinite(xyz).all():
        bad = np.flatnonzero(~np.isfinite(xyz).all(axis=1))
        raise PointsError(
            plural_message(
                "data.points-not-finite",
                "{count} of {total} points is not finite, at index {index}: {place}. Remove or complete it.",
                "{count} of {total} points are not finite, the first at index {index}: {place}. Remove or complete "
                "them.",
                count=int(bad.size),
                total=len(xyz),
                index=bad[0],
                place=xyz[bad[0]].tolist(),
            )
        )
    return xyz


def measurable_places(given: ArrayLike, name: str = "xyz") -> NDArray[np.float64]:
    """Return :func:`finite_places` of which each coordinate is at most :data:`LARGEST`; one place (3,) is (1, 3).

    Raises
    ------
    PointsError
        If a coordinate is larger: distances to it have no digits left.
    """
    rows: Any = given
    with suppress(ValueError):  # ragged, which is reported below
        rows = [given] if np.ndim(given) == 1 and np.size(given) else given
    xyz = finite_places(rows, name)
    refuse_far(xyz)
    return xyz


def refuse_far(xyz: NDArray[np.float64]) -> None:
    """Refuse coordinates larger than :data:`LARGEST`.

    Raises
    ------
    PointsError
        If there is one.
    """
    farthest = float(max(xyz.max(initial=0.0), -xyz.min(initial=0.0)))
    if farthest > LARGEST:
        raise PointsError(
            message(
                "data.coordinate-too-large",
                "A coordinate is {farthest:.10g} m; at most {largest:.0f} m are possible. Check the unit and the "
                "columns.",
                farthest=farthest,
                largest=LARGEST,
            )
        )


def column(name: str, values: ArrayLike, n: int, dtype: type) -> NDArray[Any]:
    """Return a copy of ``values``, (n,), or one value repeated n times.

    A read-only array is not copied.

    Raises
    ------
    PointsError
        If the values cannot be read as ``dtype``, or are neither n nor one.
    """
    if isinstance(values, np.ma.MaskedArray) and np.issubdtype(dtype, np.floating):
        values = np.ma.filled(values.astype(dtype), np.nan)
    try:
        array: NDArray[Any] = np.asarray(values, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise PointsError(
            message(
                "data.cannot-read",
                "{name} cannot be read as {type}: {error}.",
                name=name,
                type=dtype.__name__,
                error=error,
            )
        ) from None
    if array.ndim == 0:
        return np.full(n, array, dtype=array.dtype)
    if array.shape != (n,):
        raise PointsError(wrong_shape(name, array.shape, n))
    return array if _fixed(array, dtype) else array.copy()


def _fixed(array: NDArray[Any], dtype: type) -> bool:
    """Whether an array owns its values, and nobody can change them."""
    return array.base is None and not array.flags.writeable and array.dtype == dtype


def wrong_shape(name: str, shape: tuple[int, ...], n: int) -> Message:
    """Return the message of a column that is neither n values nor one."""
    return message(
        "data.wrong-shape",
        "{name} has shape {shape}; {n} points need shape ({n},) or one value for all.",
        name=name,
        shape=shape,
        n=n,
    )

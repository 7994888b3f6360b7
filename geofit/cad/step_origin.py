"""Origin of a STEP file: map coordinates, or an offset that the file states and that reading it restores.

Many CAD systems show coordinates in single precision, or draw badly far from zero. A file about a nearby origin has
neither trouble; its products state the offset to map coordinates as attributes, and its head says it in words.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import LARGEST
from geofit.data.errors import SettingsError
from geofit.data.messages import message

__all__ = ["OFFSET_KEYS", "Origin", "StepFields", "offset_at", "offset_attributes", "offset_of", "offset_words"]

Floats = NDArray[np.float64]

#: Where a file has its zero: that of the map, a round place below the data, or a place in map coordinates, metres.
Origin = Literal["map", "local"] | ArrayLike

#: Attributes of a product that give the offset: what is added to the file's coordinates for those of the map.
OFFSET_KEYS = ("offset_easting_m", "offset_northing_m", "offset_elevation_m")

#: A local origin is a multiple of it, metres.
ROUND = 100.0
#: Digits of the offset, which the attributes hold in full.
DIGITS = ".15g"


class StepFields(TypedDict, total=False):
    """What a STEP file states beside its geometry: ``author``, ``organisation``, ``origin``, ``colour`` (#rrggbb)."""

    author: str
    organisation: str
    origin: Origin
    colour: str


def offset_of(origin: Origin, corners: Iterable[ArrayLike]) -> Floats:
    """Return the offset (3,) of a file in metres: map coordinates = coordinates in the file + offset.

    Parameters
    ----------
    origin : {"map", "local"} or (3,) array_like
        Zero; the corner below and left of the data, rounded down to 100 m, with elevations as they are; or the
        project datum in map coordinates.
    corners : iterable of (3,) array_like
        Lowest coordinates of each surface or body in the file, metres.

    Raises
    ------
    SettingsError
        If the origin is neither a known word nor three finite numbers.
    """
    if isinstance(origin, str):
        if origin == "map":
            return np.zeros(3)
        if origin == "local":
            lowest = np.min([np.asarray(corner, float) for corner in corners], axis=0)
            plan = ROUND * np.floor(lowest[:2] / ROUND)
            return np.array([plan[0], plan[1], 0.0]) + 0.0  # no -0
        raise _unusable(origin)
    try:
        datum = np.asarray(origin, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise _unusable(origin) from None
    if datum.shape != (3,) or not (np.abs(datum) <= LARGEST).all():
        raise _unusable(origin)
    return np.array([float(format(value, DIGITS)) for value in datum.tolist()])


def _unusable(origin: object) -> SettingsError:
    return SettingsError(
        message(
            "cad.origin-unusable",
            "The origin of a STEP file is '{origin}'; give 'map', 'local', or easting, northing and elevation of the "
            "project datum in metres.",
            origin=str(origin),
        )
    )


def offset_attributes(offset: Floats) -> dict[str, str]:
    """Return the attributes that state an offset; none where the file is in map coordinates."""
    if not offset.any():
        return {}
    return {key: format(value, DIGITS) for key, value in zip(OFFSET_KEYS, offset.tolist(), strict=True)}


def offset_at(attributes: Mapping[str, str]) -> Floats:
    """Return the offset (3,) that the attributes of a product state, metres; zeros where they state none."""
    try:
        offset = np.array([float(attributes[key]) for key in OFFSET_KEYS])
    except (KeyError, ValueError):
        return np.zeros(3)
    return offset if (np.abs(offset) <= LARGEST).all() else np.zeros(3)


def offset_words(offset: Floats) -> str:
    """Return the line in the head of a file that states its offset; empty where it is in map coordinates."""
    if not offset.any():
        return ""
    easting, northing, elevation = offset_attributes(offset).values()
    return (
        f"Local coordinates. Map coordinates = coordinates in this file + ({easting}, {northing}, {elevation}) m "
        "(easting, northing, elevation)"
    )

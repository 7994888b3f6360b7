"""Squared Euclidean distance of every pore voxel to the rock, exact, and the sums of three squares it can take.

The distance map is separable: the first scan measures along rows, each further scan takes the lower envelope of
parabolas along the next axis (Meijster, Roerdink & Hesselink 2000). Rock ends a parabola's reach, so the envelope is
built for one run of pore voxels at a time, and rock costs no more than the look at it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.pores.threads import in_parts
from geofit.pores.volume import VolumeError

__all__ = ["Border", "border_walls", "squared_distance", "sums_of_squares"]

#: Voxels that are worth a thread.
_LEAST = 500_000

#: Which faces of the sample stop a ball: all, none, or one word for each axis of the array.
Border = Literal["closed", "open"] | tuple[Literal["closed", "open"], ...]


@arguments_checked
def border_walls(border: str | Sequence[str]) -> tuple[bool, bool, bool]:
    """Return for each axis whether its two faces are walls.

    Raises
    ------
    VolumeError
        If ``border`` is neither a word nor three words.
    """
    words = (border,) * 3 if isinstance(border, str) else tuple(border)
    if len(words) != 3 or not all(word in ("closed", "open") for word in words):
        raise VolumeError(
            message(
                "pores.border-unknown",
                "border={border} is not valid. Give 'closed', 'open', or one of the two for each of the three axes.",
                border=repr(border),
            )
        )
    return words[0] == "closed", words[1] == "closed", words[2] == "closed"


def squared_distance(
    pore: NDArray[np.bool_],
    border: Border = "closed",
    edges: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> NDArray[Any]:
    """Return the squared distance from each voxel's centre to the centre of the nearest rock voxel.

    Parameters
    ----------
    pore : ndarray of bool, shape (n0, n1, n2)
        True in the pore space.
    border : "closed", "open" or three of them
        Closed: one layer of rock lies outside the sample's faces. Open: only rock is a wall.
    edges : tuple of float
        Edge lengths of a voxel, the shortest being 1.

    Returns
    -------
    ndarray, shape (n0, n1, n2)
        0 in rock. int32 for cubic voxels, else float64. Without any wall in reach, the squared diagonal of the sample.

    Examples
    --------
    >>> squared_distance(np.ones((1, 1, 5), bool), ("open", "open", "closed"))[0, 0]
    array([1, 4, 9, 4, 1], dtype=int32)
    """
    from geofit.pores.distance_scans import scan_envelopes, scan_rows

    walls = border_walls(border)
    cubic = edges == (1.0, 1.0, 1.0)
    squares = np.array([edge * edge for edge in edges], dtype=np.int32 if cubic else np.float64)
    shape = np.array(pore.shape)
    farthest = squares.dtype.type((squares * shape * shape).sum())
    out = np.empty(pore.shape, dtype=squares.dtype)
    n0, n1, n2 = pore.shape

    def in_slices(first: int, end: int) -> None:
        part = out[first:end]
        scan_rows(pore[first:end], squares[2], farthest, walls[2], part)
        # A view with the scanned axis first; the middle axis walks through planes that lie together in memory.
        scan_envelopes(part.transpose(1, 0, 2), squares[1], farthest, walls[1])

    in_parts(in_slices, n0, _LEAST // (n1 * n2) + 1)
    in_parts(
        lambda first, end: scan_envelopes(out[:, first:end], squares[0], farthest, walls[0]),
        n1,
        _LEAST // (n0 * n2) + 1,
    )
    return out


def sums_of_squares(limit: int) -> NDArray[np.int32]:
    """Return, for each F² up to ``limit``, the largest sum of three squares below it: the R² of the article's step 1.

    Examples
    --------
    >>> sums_of_squares(9).tolist()
    [-1, 0, 1, 2, 3, 4, 5, 6, 6, 8]
    """
    squares = np.arange(int(limit**0.5) + 1, dtype=np.int64) ** 2
    pairs = np.unique(squares[:, None] + squares)
    pairs = pairs[pairs <= limit]
    possible = np.zeros(limit + 1, dtype=bool)
    for square in squares:
        possible[pairs[pairs <= limit - square] + square] = True
    values = np.where(possible, np.arange(limit + 1), -1)
    below = np.full(limit + 1, -1, dtype=np.int32)
    below[1:] = np.maximum.accumulate(values)[:-1]
    return below

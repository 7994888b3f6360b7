"""Arrays that are longer than the memory: made block by block, and reduced without ever being held.

A :class:`LongArray` has the shape of an array and can be sliced along its first axis. What reduces arrays here takes
ordinary ones as well, and goes through both in the same blocks, so both give the same digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BLOCK",
    "LongArray",
    "Rows",
    "blocks",
    "covariance",
    "everywhere",
    "inverse_squares",
    "left_rows",
    "spread",
    "sum_squares",
    "without",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Rows that are worked on together.
BLOCK = 1 << 18
#: Rows left out of a block, up to which those between them are copied piece by piece.
FEW = 1_000


@dataclass(frozen=True, eq=False)
class LongArray:
    """An array of numbers that is made when it is sliced.

    Parameters
    ----------
    shape : (n,) or (n, k)
        Its shape.
    read : callable
        ``read(start, stop)`` returns the rows from start to stop.
    """

    shape: tuple[int, ...]
    read: Callable[[int, int], Floats]

    def __len__(self) -> int:
        return self.shape[0]

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    @cached_property
    def moments(self) -> tuple[Floats, Floats]:
        """Mean and products as :func:`covariance` returns them, found once: both ask for all rows twice."""
        return _covariance(self)

    def __getitem__(self, index: Any) -> Any:
        """Return rows, every so many of them if asked, or for ``[:, columns]`` the array of other columns."""
        if isinstance(index, tuple):
            _, columns = index
            return LongArray(self.shape, lambda start, stop: self.read(start, stop)[:, columns])
        start, stop, step = index.indices(len(self))
        if step == 1:
            return self.read(start, stop)
        # Copies: a view would keep its whole block.
        parts = [
            self.read(low, min(low + BLOCK, stop))[(start - low) % step :: step].copy()
            for low in range(start, stop, BLOCK)
        ]
        return np.concatenate(parts) if parts else self.read(start, start)


#: What can be sliced along its rows.
Rows = Floats | LongArray


def blocks(*arrays: Any) -> Iterator[tuple[Any, ...]]:
    """Yield the same rows of several arrays, some at a time."""
    for start in range(0, max(len(arrays[0]), 1), BLOCK):
        yield tuple(array[start : start + BLOCK] for array in arrays)


def everywhere(value: float, n: int) -> Floats:
    """Return n times the same number, held once; read-only."""
    return np.broadcast_to(np.float64(value), (n,))


def inverse_squares(noise: Floats) -> Floats:
    """Return 1 / noise^2; of one number held once, one number held once."""
    return everywhere(1 / float(noise[0]) ** 2, len(noise)) if _single(noise) else 1 / noise**2


def _single(values: Floats) -> bool:
    return len(values) > 0 and values.strides == (0,)


def sum_squares(z: Rows, weight: Floats) -> float:
    """Return the sum of w z^2 over all values of (n,) or (n, k)."""
    return sum(float((w @ (part.reshape(len(part), -1) ** 2)).sum()) for part, w in blocks(z, weight))


def covariance(plane: Rows) -> tuple[Floats, Floats]:
    """Return the (k,) mean of n places, and the (k, k) sum of products of what they are off it."""
    return plane.moments if isinstance(plane, LongArray) else _covariance(plane)


def _covariance(plane: Rows) -> tuple[Floats, Floats]:
    n = len(plane)
    mean = np.sum([[column.sum() for column in part.T] for (part,) in blocks(plane)], axis=0) / n
    total = np.zeros((len(mean), len(mean)))
    for (part,) in blocks(plane):
        # Column by column: short rows take several times as long.
        off = [column - middle for column, middle in zip(part.T, mean, strict=True)]
        total += [[one @ other for other in off] for one in off]
    return mean, total


def without(rows: Rows, gone: Ints) -> Rows:
    """Return rows but those of some ascending indices, without a copy."""
    if not len(gone):
        return rows
    before = gone - np.arange(len(gone))

    def read(start: int, stop: int) -> Floats:
        low, high = (
            k + int(np.searchsorted(before, k, side="right")) for k in (start, min(stop, len(rows) - len(gone)))
        )
        first, last = np.searchsorted(gone, (low, high))
        part = rows[low:high]
        if last - first > FEW:
            kept = np.ones(high - low, bool)
            kept[gone[first:last] - low] = False
            # A tenth of the time that np.delete and a mask as index take for short rows.
            return np.compress(kept, part, axis=0)
        ends = gone[first:last] - low
        pieces = [part[a:b] for a, b in zip([0, *(ends + 1)], [*ends, high - low], strict=True)]
        return np.concatenate(pieces) if len(pieces) > 1 else part

    return LongArray((len(rows) - len(gone), *rows.shape[1:]), read)


def left_rows(active: NDArray[np.bool_], which: Ints) -> Ints:
    """Return the rows of the given ones (0, 1, ...) among those that are active, without a list of them all."""
    gone = np.flatnonzero(~active)
    return np.asarray(which + np.searchsorted(gone - np.arange(len(gone)), which, side="right"))


def spread(z: Rows) -> float:
    """Return the standard deviation of (n,) values, the largest one of (n, k)."""
    if len(z) <= BLOCK:
        return float(np.std(z[:BLOCK], axis=0).max())
    columns = z if z.ndim > 1 else LongArray((len(z), 1), lambda start, stop: z[start:stop].reshape(-1, 1))
    return float(np.sqrt(np.diag(covariance(columns)[1]).max() / len(z)))

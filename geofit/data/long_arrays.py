"""Arrays that are longer than the memory: made block by block, and reduced without ever being held.

A :class:`LongArray` has the shape of an array and can be sliced along its first axis. What reduces arrays here takes
ordinary ones as well, and goes through both in the same blocks, so both give the same digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
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
    "spread",
    "sum_squares",
]

Floats = NDArray[np.float64]

#: Rows that are worked on together.
BLOCK = 1 << 20


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

    def __getitem__(self, index: Any) -> Any:
        """Return rows, every so many of them if asked, or for ``[:, columns]`` the array of other columns."""
        if isinstance(index, tuple):
            _, columns = index
            return LongArray(self.shape, lambda start, stop: self.read(start, stop)[:, columns])
        start, stop, step = index.indices(len(self))
        if step == 1:
            return self.read(start, stop)
        parts = [
            self.read(low, min(low + BLOCK, stop))[(start - low) % step :: step] for low in range(start, stop, BLOCK)
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
    n = len(plane)
    mean = np.sum([part.sum(axis=0) for (part,) in blocks(plane)], axis=0) / n
    return mean, np.sum([(part - mean).T @ (part - mean) for (part,) in blocks(plane)], axis=0)


def spread(z: Rows) -> float:
    """Return the standard deviation of (n,) values, the largest one of (n, k)."""
    if len(z) <= BLOCK:
        return float(np.std(z[:BLOCK], axis=0).max())
    columns = z if z.ndim > 1 else LongArray((len(z), 1), lambda start, stop: z[start:stop].reshape(-1, 1))
    return float(np.sqrt(np.diag(covariance(columns)[1]).max() / len(z)))

"""Pieces of a curve joined to whole lines, by the numbers of their ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["chains_of"]

Ints = NDArray[np.int64]


def chains_of(pairs: NDArray[np.integer], count: int) -> list[Ints]:
    """Join pieces at common ends: open lines from their loose ends first, then rings.

    Parameters
    ----------
    pairs : (m, 2) array of int
        Numbers of the two ends of each piece.
    count : int
        How many ends there are: numbers are below it.

    Returns
    -------
    list of (k,) array of int
        Numbers along each line, in the order of their first ends; a ring ends where it began. Each piece is in one
        line; where more than two meet, a line goes on along the piece that is listed first.

    Examples
    --------
    >>> [chain.tolist() for chain in chains_of(np.array([[3, 4], [1, 0], [1, 2], [4, 5], [5, 3]]), 6)]
    [[0, 1, 2], [3, 4, 5, 3]]
    """
    ways: list[list[int]] = [[] for _ in range(count)]
    ends = pairs.tolist()
    for k, (a, b) in enumerate(ends):
        ways[a].append(k)
        ways[b].append(k)
    used = np.zeros(len(ends), bool)
    chains = []
    for start in [n for n in range(count) if len(ways[n]) == 1] + list(range(count)):
        way = next((k for k in ways[start] if not used[k]), None)
        if way is None:
            continue
        chain = [start]
        while way is not None:
            used[way] = True
            a, b = ends[way]
            chain.append(b if chain[-1] == a else a)
            way = next((k for k in ways[chain[-1]] if not used[k]), None)
        chains.append(np.array(chain))
    return chains

"""Which balls are kept: the exact decision by look-up tables, and the article's comparison of radii."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.ball_tables import DIRECTIONS, inclusion_table, signed_directions
from geofit.pores.distance import sums_of_squares
from geofit.pores.threads import in_parts

__all__ = ["BLOCK", "BallSearch", "block_maxima", "exact", "paper"]


#: Edge of the blocks that share one bound of the balls around them, voxels.
BLOCK = 8
#: Voxels that are worth a thread.
_LEAST = 500_000


def exact(reach2: NDArray[Any]) -> NDArray[np.int64]:
    """Return the flat indices of the maximal balls of a squared distance map of cubic voxels, in ascending order."""
    search = BallSearch(block_maxima(reach2, 0))
    return search.balls(reach2, 0, 0, len(reach2))


class BallSearch:
    """The search for maximal balls in a volume, of which a slab is available at a time.

    Parameters
    ----------
    largest : ndarray of int
        Largest F² of each block of voxels of the whole volume; see :func:`block_maxima`.
    """

    #: Slices that a slab needs on both sides.
    REACH = max(entry[0] for entry in DIRECTIONS)

    def __init__(self, largest: NDArray[np.int64]) -> None:
        most = int(largest.max(initial=0))
        # A ball can be included in a larger one, so the directions go by the largest ball that reaches a voxel.
        needed = [entry for entry in DIRECTIONS if entry[3] <= most] or [(1, 0, 0, 0)]
        generators = np.array([entry[:3] for entry in needed], dtype=np.int64)
        self._tables = np.array([inclusion_table(g0, g1, g2, most) for g0, g1, g2 in generators], dtype=np.int32)
        directions, source = signed_directions(generators)
        from_ = np.array([entry[3] for entry in needed])[source]
        order = np.argsort(from_, kind="stable")
        self._directions, self._source = directions[order], source[order]
        self._counts = np.searchsorted(from_[order], _spread(largest), side="right")

    def balls(self, reach2: NDArray[Any], low: int, first: int, end: int) -> NDArray[np.int64]:
        """Return the flat indices, in the whole volume, of the maximal balls in slices ``first`` ... ``end - 1``.

        ``reach2`` begins with slice ``low`` and reaches beyond those slices by ``REACH``, or to the end of the volume.
        """
        tables = self._directions, self._source, self._tables, self._counts
        found = in_parts(
            lambda a, b: _maximal(reach2, first - low + a, first - low + b, low, *tables),
            end - first,
            _LEAST // (reach2.shape[1] * reach2.shape[2]) + 1,
        )
        return np.asarray(np.concatenate(found) + low * reach2.shape[1] * reach2.shape[2], np.int64)


def block_maxima(reach2: NDArray[Any], first: int) -> NDArray[np.int64]:
    """Return the largest F² of each block of voxels of a slab that begins with slice ``first`` of the volume.

    Blocks count from the low corner of the volume; the first row of blocks is that of the slab's first slice.
    """
    rows = (first + np.arange(len(reach2))) // BLOCK - first // BLOCK
    out = np.zeros((int(rows[-1]) + 1, *(-(-n // BLOCK) for n in reach2.shape[1:])), np.int64)
    for row, slice_ in zip(rows.tolist(), reach2, strict=True):
        strips = np.maximum.reduceat(slice_, np.arange(0, slice_.shape[0], BLOCK), axis=0)
        np.maximum(out[row], np.maximum.reduceat(strips, np.arange(0, slice_.shape[1], BLOCK), axis=1), out=out[row])
    return out


@njit(cache=True)
def _spread(largest: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the largest value of the blocks from which a ball of that value may reach each block."""
    n0, n1, n2 = largest.shape
    out = largest.copy()
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                value = largest[i, j, k]
                # Voxels of two blocks are nearer than their corners are by one block less a voxel.
                reach = int((np.sqrt(value) - 1.0) / BLOCK) + 1
                for a in range(max(i - reach, 0), min(i + reach + 1, n0)):
                    for b in range(max(j - reach, 0), min(j + reach + 1, n1)):
                        for c in range(max(k - reach, 0), min(k + reach + 1, n2)):
                            out[a, b, c] = max(out[a, b, c], value)
    return out


@njit(cache=True, nogil=True)
def _maximal(
    reach2: NDArray[Any],
    first: int,
    end: int,
    low: int,
    directions: NDArray[np.int64],
    source: NDArray[np.int64],
    tables: NDArray[np.int32],
    counts: NDArray[np.int64],
) -> NDArray[np.int64]:
    n0, n1, n2 = reach2.shape
    flat = reach2.ravel()
    steps = directions[:, 0] * (n1 * n2) + directions[:, 1] * n2 + directions[:, 2]
    margin = np.abs(directions).max()
    kept = np.empty(1024, np.int64)
    count = 0
    for i in range(first, end):
        for j in range(n1):
            row_inside = margin <= i < n0 - margin and margin <= j < n1 - margin
            for k in range(n2):
                here = (i * n1 + j) * n2 + k
                own = flat[here]
                if own == 0:
                    continue
                inside = row_inside and margin <= k < n2 - margin
                included = False
                for d in range(counts[(i + low) // BLOCK, j // BLOCK, k // BLOCK]):
                    if not inside:
                        a, b, c = i + directions[d, 0], j + directions[d, 1], k + directions[d, 2]
                        if a < 0 or b < 0 or c < 0 or a >= n0 or b >= n1 or c >= n2:
                            continue
                    other = flat[here + steps[d]]
                    if other > own and other >= tables[source[d], own]:
                        included = True
                        break
                if included:
                    continue
                if count == len(kept):
                    grown = np.empty(2 * count, np.int64)
                    grown[:count] = kept
                    kept = grown
                kept[count] = here
                count += 1
    return kept[:count].copy()


def paper(reach2: NDArray[Any]) -> NDArray[np.int64]:
    """Return the flat indices of the balls that the article's step 2 keeps, in ascending order.

    From large to small, ball 1 deletes each ball 2 within R1 with R2 + distance <= L1, where L1² = F1² + 1 is the
    article's upper limit of the radius. It stops at R² = 0.
    """
    flat = reach2.ravel()
    alive = flat > 0
    ranked = np.flatnonzero(alive)
    ranked = ranked[np.argsort(-flat[ranked], kind="stable")]
    _delete_by_radius(reach2, sums_of_squares(int(flat.max(initial=0))), ranked, alive.reshape(reach2.shape))
    return np.flatnonzero(alive)


@njit(cache=True)
def _delete_by_radius(
    reach2: NDArray[Any], radius2: NDArray[np.int32], ranked: NDArray[np.int64], alive: NDArray[np.bool_]
) -> None:
    n0, n1, n2 = reach2.shape
    for here in ranked:
        i, j, k = here // (n1 * n2), here // n2 % n1, here % n2
        square = radius2[reach2[i, j, k]]
        if square == 0:
            return
        if not alive[i, j, k]:
            continue
        limit = np.sqrt(reach2[i, j, k] + 1)
        reach = int(np.sqrt(square))
        for a in range(max(i - reach, 0), min(i + reach + 1, n0)):
            for b in range(max(j - reach, 0), min(j + reach + 1, n1)):
                for c in range(max(k - reach, 0), min(k + reach + 1, n2)):
                    gap = (a - i) ** 2 + (b - j) ** 2 + (c - k) ** 2
                    smaller = alive[a, b, c] and reach2[a, b, c] < reach2[i, j, k]
                    if not smaller or gap == 0 or gap > square:
                        continue
                    if np.sqrt(radius2[reach2[a, b, c]]) + np.sqrt(gap) <= limit + 1e-12:
                        alive[a, b, c] = False

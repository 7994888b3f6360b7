"""The article's hierarchy (Huang et al. 2007, step 3): super balls, and the slaves that belong to their pores.

Of two balls that intersect or touch, the smaller is the slave of the larger; slaves of slaves belong to the same super
ball. Equal radii are ranked by order in the list of balls, which the article leaves open: without a rank a straight
tube has as many super balls as voxels. Taken literally, the rule makes many pores of a single voxel.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.balls import MaximalBalls
from geofit.pores.packed import PackedSpace, slots

__all__ = ["super_balls"]


def super_balls(balls: MaximalBalls, space: PackedSpace, label: NDArray[np.int32], basins: int) -> NDArray[np.int64]:
    """Return for each basin of the distance map the pore, that is the super ball, that it belongs to.

    Parameters
    ----------
    balls : MaximalBalls
    space : PackedSpace
        The pore space.
    label : ndarray of int32
        Basin of each pore voxel, counted from 1.
    basins : int
        Number of basins, the widest first.

    Returns
    -------
    ndarray of int64, shape (basins,)
        Pores count from 0 in the order of their widest basins. A basin belongs to the super ball of its largest ball.
    """
    family = _families(balls.centre, np.sqrt(balls.radius2.astype(np.float64)), np.array(balls.edges), balls.shape)
    basin = label[slots(space, np.ravel_multi_index(tuple(balls.centre.T), balls.shape))] - 1
    # Balls are listed from large to small: the first of a basin is its largest.
    largest = np.full(basins, len(balls))
    np.minimum.at(largest, basin, np.arange(len(balls)))
    of_basin = family[largest]
    _, first, pore = np.unique(of_basin, return_index=True, return_inverse=True)
    order = np.empty(len(first), np.int64)
    order[np.argsort(first)] = np.arange(len(first))
    return order[pore]


@njit(cache=True)
def _families(
    centre: NDArray[np.int32], radius: NDArray[np.float64], edges: NDArray[np.float64], shape: tuple[int, int, int]
) -> NDArray[np.int64]:
    """Return the number of the super ball of each ball; of several, the largest."""
    n0, n1, n2 = shape
    at = np.full(shape, -1, np.int32)
    for ball in range(len(centre)):
        at[centre[ball, 0], centre[ball, 1], centre[ball, 2]] = ball
    family = np.full(len(centre), -1, np.int64)
    supers = 0
    for ball in range(len(centre)):
        if family[ball] < 0:
            family[ball] = supers
            supers += 1
        i, j, k = centre[ball]
        # A slave is not larger than its master: twice the master's radius is far enough.
        r0, r1, r2 = (
            int(2 * radius[ball] / edges[0]),
            int(2 * radius[ball] / edges[1]),
            int(2 * radius[ball] / edges[2]),
        )
        for a in range(max(i - r0, 0), min(i + r0 + 1, n0)):
            for b in range(max(j - r1, 0), min(j + r1 + 1, n1)):
                for c in range(max(k - r2, 0), min(k + r2 + 1, n2)):
                    other = at[a, b, c]
                    if other <= ball:
                        continue
                    gap = (edges[0] * (a - i)) ** 2 + (edges[1] * (b - j)) ** 2 + (edges[2] * (c - k)) ** 2
                    if gap <= (radius[ball] + radius[other]) ** 2 and (
                        family[other] < 0 or family[other] > family[ball]
                    ):
                        family[other] = family[ball]
    return family

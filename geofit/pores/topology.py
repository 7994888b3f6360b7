"""Where a rebuilt pore space is connected in another way than its voxels: throats that it lost, walls that it broke.

Voxels in which the two differ are turned over one by one as long as this changes no connection (simple points,
Bertrand & Malandain 1994). If all can be turned, the two have the same parts, tunnels and cavities; what is left are
the places where they have not.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["topology_faults"]


def topology_faults(rebuilt: NDArray[np.bool_], pore: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the voxels (n, 3) that part the topology of two volumes of one shape.

    Pores connect by faces, rock by corners. Without such voxels the volumes have equal Betti numbers; the reverse need
    not hold, since two faults can make up for each other.

    Examples
    --------
    >>> tube = np.zeros((3, 3, 9), bool)
    >>> tube[1, 1] = True
    >>> broken = tube.copy()
    >>> broken[1, 1, 4] = False
    >>> topology_faults(broken, tube).tolist(), topology_faults(tube[..., :8], tube[..., 1:]).tolist()
    ([[1, 1, 4]], [])
    """
    # Rock outside: the faces of the sample are walls to both.
    current, truth = np.pad(rebuilt, 1), np.pad(pore, 1)
    _turn(current, truth, np.argwhere(current != truth))
    return np.argwhere(current != truth) - 1


@njit(cache=True)
def _turn(current: NDArray[np.bool_], truth: NDArray[np.bool_], places: NDArray[np.int64]) -> None:
    changed = True
    while changed:
        changed = False
        for row in range(len(places)):
            i, j, k = places[row]
            if current[i, j, k] == truth[i, j, k]:
                continue
            if _simple(current[i - 1 : i + 2, j - 1 : j + 2, k - 1 : k + 2]):
                current[i, j, k] = truth[i, j, k]
                changed = True


@njit(cache=True)
def _simple(near: NDArray[np.bool_]) -> bool:
    """Return whether the middle of 3 x 3 x 3 voxels can be turned over without a change of connections."""
    return _parts(near, True) == 1 and _parts(near, False) == 1


@njit(cache=True)
def _parts(near: NDArray[np.bool_], pore: bool) -> int:
    """Count the parts of one kind round the middle voxel: pores by faces and next to a face, rock by corners."""
    seen = np.zeros((3, 3, 3), np.bool_)
    stack = np.empty((27, 3), np.int64)
    parts = 0
    for a in range(3):
        for b in range(3):
            for c in range(3):
                far = abs(a - 1) + abs(b - 1) + abs(c - 1)
                if far == 0 or seen[a, b, c] or near[a, b, c] != pore or (pore and far > 1):
                    continue
                parts += 1
                seen[a, b, c] = True
                stack[0, 0], stack[0, 1], stack[0, 2], size = a, b, c, 1
                while size > 0:
                    size -= 1
                    p, q, r = stack[size, 0], stack[size, 1], stack[size, 2]
                    for x in range(max(p - 1, 0), min(p + 2, 3)):
                        for y in range(max(q - 1, 0), min(q + 2, 3)):
                            for z in range(max(r - 1, 0), min(r + 2, 3)):
                                step = abs(x - p) + abs(y - q) + abs(z - r)
                                out = abs(x - 1) + abs(y - 1) + abs(z - 1)
                                if out == 0 or seen[x, y, z] or near[x, y, z] != pore:
                                    continue
                                if pore and (step > 1 or out > 2):
                                    continue
                                seen[x, y, z] = True
                                stack[size, 0], stack[size, 1], stack[size, 2] = x, y, z
                                size += 1
    return parts

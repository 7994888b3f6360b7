"""What of a core's noise is noise, as its nearest points show it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

__all__ = ["SHARED", "near_noise"]

Floats = NDArray[np.float64]

#: One of so many points, but at least the second number, is looked at: those with the nearest neighbours.
NEAREST, FEWEST = 3, 20
#: Share of the noise by which the nearest points must differ at least: what they share more of is relief.
SHARED = 0.5


def near_noise(plane: Floats, misfit: Floats) -> float:
    """Return the noise of points as the nearest of them show it, in units of the misfits (1 sigma).

    A field counts relief that its spans cannot follow as noise. Of that, two points share the more the nearer to each
    other they are; of noise, they share none. Single wrong points count: they are noise, too.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points.
    misfit : (n,) array
        What a field leaves of them.
    """
    apart, index = (np.asarray(found) for found in KDTree(plane).query(plane, k=2))
    near = np.argsort(apart[:, 1], kind="stable")[: max(len(plane) // NEAREST, FEWEST)]
    return float(np.sqrt(np.mean((misfit[near] - misfit[index[near, 1]]) ** 2) / 2))

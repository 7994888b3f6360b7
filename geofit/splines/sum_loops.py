"""Compiled: the sums of very many points over the cells of a mesh.

The terms are those of :mod:`geofit.splines.sums`, point by point instead of cell by cell: no point is sorted or copied.
Loading the compiled code takes longer than summing a few thousand points without it.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["add_points"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True, error_model="numpy")
def add_points(
    sums: Floats,
    lines_u: Floats,
    lines_v: Floats,
    cell_u: Ints,
    cell_v: Ints,
    plane: Floats,
    z: Floats,
    weight: Floats,
) -> None:
    """Add points in cells to sums (k, m, 2p + 1, 3p + 2) of Legendre polynomials, those with the heights last."""
    along, across = sums.shape[2], sums.shape[3]
    of_u, of_v = np.empty(along), np.empty(across)
    ahead, back = np.empty(along), np.empty(along)
    for k in range(1, along - 1):  # Bonnet's recurrence
        ahead[k], back[k] = (2 * k + 1) / (k + 1), k / (k + 1)
    for i in range(len(z)):
        cu, cv = cell_u[i], cell_v[i]
        low, high = lines_u[cu], lines_u[cu + 1]
        t = (2 * plane[i, 0] - low - high) / (high - low)
        of_u[0] = weight[i]
        of_u[1] = weight[i] * t
        for k in range(1, along - 1):
            of_u[k + 1] = ahead[k] * t * of_u[k] - back[k] * of_u[k - 1]
        low, high = lines_v[cv], lines_v[cv + 1]
        t = (2 * plane[i, 1] - low - high) / (high - low)
        of_v[0] = 1.0
        of_v[1] = t
        for k in range(1, along - 1):
            of_v[k + 1] = ahead[k] * t * of_v[k] - back[k] * of_v[k - 1]
        for k in range(across - along):
            of_v[along + k] = z[i] * of_v[k]
        for j in range(along):
            for k in range(across):
                sums[cu, cv, j, k] += of_u[j] * of_v[k]

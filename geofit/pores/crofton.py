"""Surface area of a voxel body by Crofton's formula: crossings of lines in 13 directions."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.pores.volume import VolumeError

__all__ = ["surface_area"]

_DIRECTIONS = tuple((a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1) if (a, b, c) > (0, 0, 0))


@arguments_checked
def surface_area(pore: NDArray[np.bool_], edges: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> float:
    """Return the area between pore and rock inside the sample, in units of the edges squared.

    Twice the mean over all directions of the projected area, each direction weighted by the part of the sphere that is
    nearer to it than to the others. For spheres of 10 voxels and more the error is below 2 %, where counting voxel
    faces gives 50 % too much.

    Parameters
    ----------
    pore : (nx, ny, nz) array of bool
        The pore voxels.
    edges : (float, float, float)
        Edges of a voxel.
    """
    pore, edges = np.asarray(pore, bool), (float(edges[0]), float(edges[1]), float(edges[2]))
    if not (np.isfinite(edges).all() and min(edges) > 0):
        raise VolumeError(
            message("pores.edges-not-positive", "The voxel edges are {edges}; give 3 lengths above 0.", edges=edges)
        )
    total = 0.0
    for direction, weight in zip(_DIRECTIONS, _weights(edges), strict=True):
        here, there = [], []
        for step, n in zip(direction, pore.shape, strict=True):
            here.append(slice(max(-step, 0), n - max(step, 0)))
            there.append(slice(max(step, 0), n - max(-step, 0)))
        crossings = int(np.count_nonzero(pore[tuple(here)] != pore[tuple(there)]))
        length = float(np.linalg.norm(np.array(direction) * edges))
        total += weight * crossings * float(np.prod(edges)) / length
    return 2.0 * total


@lru_cache(maxsize=8)
def _weights(edges: tuple[float, float, float]) -> tuple[float, ...]:
    """Return the share of the sphere of each direction and its opposite."""
    from scipy.spatial import SphericalVoronoi

    directions = np.array(_DIRECTIONS) * np.array(edges)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    areas = SphericalVoronoi(np.concatenate([directions, -directions])).calculate_areas()
    return tuple((areas[: len(directions)] / (2.0 * np.pi)).tolist())

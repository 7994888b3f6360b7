"""Surface area of a voxel body by Crofton's formula: crossings of lines in 13 directions."""

from __future__ import annotations

import itertools
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
    faces gives 50 % too much. With 13 directions the area of a plane depends on where it faces: in cubic voxels from
    7.4 % too little along the axes to 2.3 % too much, in voxels twice as long as wide from -12.6 to +9.4 %.

    An axis with a single slice shows no slope of the walls: they are taken to be perpendicular to the slice.

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
        crossings = _crossings(pore, direction)
        length = float(np.linalg.norm(np.array(direction) * edges))
        total += weight * crossings * float(np.prod(edges)) / length
    return 2.0 * total


def _crossings(pore: NDArray[np.bool_], direction: tuple[int, ...]) -> float:
    """Return how often lines in a direction, one through each voxel, cross the wall.

    Lines between the middles of voxels end half a voxel before the faces. What they miss there is what they find in the
    other half of the same layer: a pair of voxels at a face counts half more.
    """
    here, there, ends = [], [], []
    for step, n in zip(direction, pore.shape, strict=True):
        by = step if n > 1 else 0  # from a single slice no line leads to a next one
        here.append(slice(max(-by, 0), n - max(by, 0)))
        there.append(slice(max(by, 0), n - max(-by, 0)))
        ends.append([(slice(None), 1.0), (slice(1), 0.5), (slice(-1, None), 0.5)] if by else [(slice(None), 1.0)])
    changed = pore[tuple(here)] != pore[tuple(there)]
    total = 0.0
    for parts in itertools.product(*ends):
        where, shares = zip(*parts, strict=True)
        total += float(np.prod(shares)) * int(np.count_nonzero(changed[where]))
    return total


@lru_cache(maxsize=8)
def _weights(edges: tuple[float, float, float]) -> tuple[float, ...]:
    """Return the share of the sphere of each direction and its opposite."""
    from scipy.spatial import SphericalVoronoi

    directions = np.array(_DIRECTIONS) * np.array(edges)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    areas = SphericalVoronoi(np.concatenate([directions, -directions])).calculate_areas()
    return tuple((areas[: len(directions)] / (2.0 * np.pi)).tolist())

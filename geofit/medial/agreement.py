"""How well a body agrees with voxels: overlap, volume, distance between the surfaces, topology."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Agreement", "agreement", "betti"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Agreement:
    """Agreement of covered voxels with the voxels of a body.

    Parameters
    ----------
    dice : float
        Twice the common voxels over the sum of both, 0 to 1.
    share : float
        Share of the body's voxels that are covered.
    volume, volume_of_voxels : float
        Covered volume and the body's, cubic metres.
    hausdorff, hausdorff95 : float
        Largest distance, and the one that 95 % do not exceed, from the boundary voxels of either to the nearest
        boundary voxel of the other, metres. Infinite if one is empty.
    """

    dice: float
    share: float
    volume: float
    volume_of_voxels: float
    hausdorff: float
    hausdorff95: float


def agreement(covered: Mask, body: Mask, edges: ArrayLike) -> Agreement:
    """Return how covered voxels agree with a body's voxels; ``edges`` (3,) of a voxel in metres."""
    h = np.asarray(edges, dtype=np.float64)
    common, both = int((covered & body).sum()), int(covered.sum()) + int(body.sum())
    gaps = _gaps(covered, body, h)
    return Agreement(
        dice=2.0 * common / max(both, 1),
        share=common / max(int(body.sum()), 1),
        volume=float(covered.sum() * h.prod()),
        volume_of_voxels=float(body.sum() * h.prod()),
        hausdorff=float(gaps.max()),
        hausdorff95=float(np.quantile(gaps, 0.95, method="higher")),
    )


def betti(mask: Mask) -> tuple[int, int, int]:
    """Return components, tunnels and cavities of a voxel body; voxels are connected by faces, rock by corners.

    The tunnels follow from Euler's number of the open voxels: V - E + F - C of the complement's closed cubes.
    """
    from scipy.ndimage import label

    solid = np.pad(np.asarray(mask, dtype=bool), 1)
    components = int(label(solid)[1])
    cavities = int(label(~solid, np.ones((3, 3, 3)))[1]) - 1
    # A cell of the grid belongs to the body if all voxels around it do: connection by faces.
    euler = 0
    for axes in ((), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)):
        cells = solid
        for axis in axes:
            front, back = [slice(None)] * 3, [slice(None)] * 3
            front[axis], back[axis] = slice(1, None), slice(None, -1)
            cells = cells[tuple(front)] & cells[tuple(back)]
        euler += (-1) ** len(axes) * int(cells.sum())
    return components, components + cavities - euler, cavities


def _gaps(a: Mask, b: Mask, edges: NDArray[np.float64]) -> NDArray[np.float64]:
    from scipy.spatial import cKDTree

    first, second = _rim(a) * edges, _rim(b) * edges
    if not len(first) or not len(second):
        return np.array([0.0 if len(first) == len(second) else np.inf])
    return np.asarray(np.r_[cKDTree(second).query(first)[0], cKDTree(first).query(second)[0]])


def _rim(mask: Mask) -> NDArray[np.int64]:
    """Return the voxels (n, 3) of a mask that have a face neighbour outside it."""
    solid = np.pad(mask, 1)
    inner = solid[1:-1, 1:-1, 1:-1].copy()
    for axis in range(3):
        for shift in (-1, 1):
            inner &= np.roll(solid, shift, axis)[1:-1, 1:-1, 1:-1]
    return np.argwhere(mask & ~inner)

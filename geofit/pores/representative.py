"""How the porosity of a sample settles with its size: the curve from which a representative volume is read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.pores.volume import RockVolume

__all__ = ["RepresentativeVolume", "representative_volume"]

Floats = NDArray[np.float64]

#: Sizes of cubes at most, and the smallest edge in voxels.
SIZES, SMALLEST = 14, 4


@dataclass(frozen=True, eq=False)
class RepresentativeVolume:
    """Porosity of cubes of several sizes that fill the sample: ``edge`` (k,) in metres; lowest, mean and highest.

    ``count`` (k,) is the number of cubes of each size. Of voxels that are not cubes, ``edge`` is the cube root of the
    volume of blocks that are cubes but for parts of a voxel.
    """

    edge: Floats
    lowest: Floats
    mean: Floats
    highest: Floats
    count: NDArray[np.int64]


def representative_volume(volume: RockVolume) -> RepresentativeVolume:
    """Return the porosity of cubes that stand side by side in a sample, for edges up to its shortest side.

    Parameters
    ----------
    volume : RockVolume
        The sample.

    Returns
    -------
    RepresentativeVolume
        Sizes ascending; a single size for a sample of a few voxels.

    Notes
    -----
    Sums over all cubes of a size come from the cumulative sums along the axes (Crow, "Summed-area tables", SIGGRAPH
    1984). Bear, Dynamics of Fluids in Porous Media (1972), sec. 1.3, defines the representative volume by this curve.
    """
    total = np.pad(np.asarray(volume.pore, np.int64), ((1, 0),) * 3)
    for axis in range(3):
        np.cumsum(total, axis=axis, out=total)
    voxel, shape = np.array(volume.voxel), np.array(volume.shape)
    longest = float((shape * voxel).min())
    sizes = np.geomspace(min(SMALLEST * float(voxel.max()), longest), longest, SIZES)
    blocks = np.unique(np.clip(np.rint(sizes[:, None] / voxel), 1, shape).astype(int), axis=0)
    found = [_porosities(total, block) for block in blocks]
    return RepresentativeVolume(
        np.cbrt((blocks * voxel).prod(axis=1)),
        np.array([phi.min() for phi in found]),
        np.array([phi.mean() for phi in found]),
        np.array([phi.max() for phi in found]),
        np.array([phi.size for phi in found]),
    )


def _porosities(total: NDArray[np.int64], block: NDArray[np.int64]) -> Floats:
    """Return the porosity of each block of voxels (3,); what is left at the high ends of the axes is not counted."""
    cuts = [np.arange(0, size, step) for size, step in zip(total.shape, block, strict=True)]
    corners = total[np.ix_(*cuts)]
    for axis in range(3):
        corners = np.diff(corners, axis=axis)
    return np.asarray(corners.ravel() / block.prod(), float)

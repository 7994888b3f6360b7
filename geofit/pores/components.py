"""Which pore voxels are connected, by faces as flow is, and through which axes; exact, without a network."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["Connectivity", "connectivity", "euler_number"]


@dataclass(frozen=True)
class Connectivity:
    """Connected parts of the pore space, and porosities.

    Attributes
    ----------
    parts : int
        Parts connected by voxel faces.
    parts26 : int
        Parts connected by faces, edges or corners.
    percolates : tuple of three bool
        For each axis, whether one part (by faces) touches both faces of the sample.
    porosity : float
        Total.
    connected : float
        Porosity of the parts that touch any face of the sample: the effective porosity of Huang et al.
    percolating : tuple of three float
        For each axis, porosity of the parts that touch both of its faces.
    euler : int
        Euler number of the pore space connected by faces: parts - tunnels + enclosed grains.
    """

    parts: int
    parts26: int
    percolates: tuple[bool, bool, bool]
    porosity: float
    connected: float
    percolating: tuple[float, float, float]
    euler: int


@arguments_checked
def connectivity(volume: RockVolume) -> Connectivity:
    """Count connected parts of the pore space and what they reach."""
    from scipy import ndimage

    label, parts = ndimage.label(volume.pore)
    size = np.bincount(label.ravel(), minlength=parts + 1)
    size[0] = 0
    touches = np.zeros((parts + 1, 6), dtype=bool)
    for face in range(6):
        axis, high = divmod(face, 2)
        touches[np.unique(label.take(-1 if high else 0, axis=axis)), face] = True
    touches[0] = False
    both = [touches[:, 2 * axis] & touches[:, 2 * axis + 1] for axis in range(3)]
    shares = [float(size[through].sum() / label.size) for through in both]
    parts26 = ndimage.label(volume.pore, structure=np.ones((3, 3, 3)), output=label)
    return Connectivity(
        int(parts),
        int(parts26),
        (bool(both[0].any()), bool(both[1].any()), bool(both[2].any())),
        volume.porosity,
        float(size[touches.any(axis=1)].sum() / label.size),
        (shares[0], shares[1], shares[2]),
        euler_number(volume.pore),
    )


@arguments_checked
def euler_number(pore: NDArray[np.bool_], *, neighbours: int = 6) -> int:
    """Return the Euler number of a voxel body connected by faces (6) or by faces, edges and corners (26).

    Parameters
    ----------
    pore : (nx, ny, nz) array of bool
        The body.
    neighbours : {6, 26}
        Which voxels are connected.

    Examples
    --------
    >>> ring = np.ones((1, 3, 3), bool)
    >>> ring[0, 1, 1] = False
    >>> euler_number(ring)
    0
    """
    if neighbours not in (6, 26):
        raise VolumeError(
            message(
                "pores.neighbours-unknown",
                "Voxels have 6 or 26 neighbours, not {count}: give neighbours=6 or neighbours=26.",
                count=neighbours,
            )
        )
    pore = np.asarray(pore, bool)
    if neighbours == 26:
        # Closed voxels: each corner, edge and face of the grid counts once if any voxel round it is pore.
        wide = np.pad(pore, 1)
        total = 0
        for axes in ((), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)):
            cells = wide
            for axis in axes:
                low, high = [slice(None)] * 3, [slice(None)] * 3
                low[axis], high[axis] = slice(None, -1), slice(1, None)
                cells = cells[tuple(low)] | cells[tuple(high)]
            total += (-1) ** (3 - len(axes)) * int(np.count_nonzero(cells))
        return total
    # Voxels as points: pairs, squares and cubes of pore voxels are the edges, faces and cells between them.
    total = 0
    for axes in ((), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)):
        cells = pore
        for axis in axes:
            low, high = [slice(None)] * 3, [slice(None)] * 3
            low[axis], high[axis] = slice(None, -1), slice(1, None)
            cells = cells[tuple(low)] & cells[tuple(high)]
        total += (-1) ** len(axes) * int(np.count_nonzero(cells))
    return total

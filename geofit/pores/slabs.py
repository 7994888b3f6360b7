"""Distances of a volume slab by slab, each with as many slices around it as its largest ball needs.

A distance is exact if the rock that a slab does not see is farther: every voxel is checked, and the slab is widened
until all are. The result is that of the whole volume, voxel for voxel.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.data.progress import Progress, tell
from geofit.pores.distance import Border, border_walls, squared_distance
from geofit.pores.packed import PackedSpace, pack_slab

__all__ = ["VOXELS", "Slices", "distance_slabs", "packed_distances"]

#: Voxels whose distances are held at a time.
VOXELS = 100_000_000
#: Slices on both sides of the first slab.
HALO = 16


class Slices(Protocol):
    """A rock volume that can be read slice by slice: :class:`RockVolume`, :class:`SlicedVolume`."""

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along each axis."""
        ...

    @property
    def voxel(self) -> tuple[float, float, float]:
        """Edges of a voxel, metres."""
        ...

    @property
    def unit(self) -> float:
        """The shortest edge, metres."""
        ...

    @property
    def edges(self) -> tuple[float, float, float]:
        """Edges in units of the shortest one."""
        ...

    @property
    def cubic(self) -> bool:
        """Whether all edges are equal."""
        ...

    @property
    def porosity(self) -> float:
        """Share of pore voxels."""
        ...

    def slab(self, first: int, end: int) -> NDArray[np.bool_]:
        """Return the slices ``first`` ... ``end - 1``, True in pores."""
        ...


def distance_slabs(
    volume: Slices, border: Border, reach: int = 0, progress: Progress | None = None
) -> Iterator[tuple[int, int, int, NDArray[Any]]]:
    """Yield slabs of squared distances: first and last + 1 slice, the slices before the first, and the distances.

    ``reach`` slices on both sides of a slab (fewer at the ends of the volume) are part of the distances, and exact too.
    """
    n0, n1, n2 = volume.shape
    halo, first = HALO, 0
    whole = n0 * n1 * n2 <= VOXELS
    while first < n0:
        tell(progress, "distance", 0.2 * first / n0)
        thick = n0 if whole else max(VOXELS // (n1 * n2) - 2 * (halo + reach), max(halo // 2, 1))
        end = min(first + thick, n0)
        while True:
            low, high = max(first - reach, 0), min(end + reach, n0)
            below, above = (0, n0) if whole else (max(low - halo, 0), min(high + halo, n0))
            found = _distances(volume, border, below, above)[low - below : high - below]
            if _exact(found, low, below, above, n0, volume.edges[0]):
                break
            halo *= 2
        yield first, end, first - low, found
        first = end


def _distances(volume: Slices, border: Border, below: int, above: int) -> NDArray[Any]:
    """Return the distances as far as the slices ``below`` ... ``above - 1`` tell."""
    n0 = volume.shape[0]
    if (below, above) == (0, n0):
        return squared_distance(volume.slab(0, n0), border, volume.edges)
    walls = border_walls(border)
    pore = volume.slab(below, above)
    # A closed end is a layer of rock; where the slab is cut there is no wall.
    layers = (int(walls[0] and below == 0), int(walls[0] and above == n0))
    padded = np.pad(pore, (layers, (0, 0), (0, 0))) if any(layers) else pore
    words: Border = ("open", "closed" if walls[1] else "open", "closed" if walls[2] else "open")
    return squared_distance(padded, words, volume.edges)[layers[0] : len(padded) - layers[1]]


def _exact(found: NDArray[Any], low: int, below: int, above: int, n0: int, edge: float) -> bool:
    """Return whether no rock outside ``below`` ... ``above`` can be nearer than what was found."""
    for row, slice_ in enumerate(found):
        here = low + row
        gap = min(here - below + 1 if below > 0 else n0, above - here if above < n0 else n0)
        if (below > 0 or above < n0) and slice_.max() > (gap * edge) ** 2:
            return False
    return True


def packed_distances(
    volume: Slices, border: Border, progress: Progress | None = None
) -> tuple[PackedSpace, NDArray[Any]]:
    """Return the pore space of a volume and the squared distance of each pore voxel to the rock."""
    space = PackedSpace.empty(volume.shape)
    count = round(volume.porosity * int(space.shape.prod()))
    reach2 = np.empty(count, np.int32 if volume.cubic else np.float64)
    filled = 0
    for first, _, _, found in distance_slabs(volume, border, 0, progress):
        pore = found > 0
        before, filled = filled, pack_slab(space, pore, first, filled)
        reach2[before:filled] = found[pore]
    return space, reach2

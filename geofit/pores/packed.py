"""The pore space in little memory: one bit a voxel, and values for pore voxels alone.

Values of pore voxels are stored in the order of the voxels. The place ("slot") of a voxel's value is the number of pore
voxels before it: a count for each word of 64 bits, and the bits below it in its word. Rock costs no more than its bit,
and the bits of a whole volume fit into the processor's cache.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["PackedSpace", "pack_slab", "pore_voxels", "row_of_three", "slot", "slots", "unpacked"]


class PackedSpace(NamedTuple):
    """Pore voxels of a volume.

    ``bits`` has one bit for each voxel in the order of flat indices, ``before`` the number of pore voxels before each
    of its words, ``shape`` the voxels along each axis.
    """

    bits: NDArray[np.uint64]
    before: NDArray[np.uint32]
    shape: NDArray[np.int64]

    @classmethod
    def empty(cls, shape: tuple[int, int, int]) -> PackedSpace:
        """Return a space without pores, to be filled from its first slice on."""
        words = (shape[0] * shape[1] * shape[2] + 63) // 64
        return cls(np.zeros(words, np.uint64), np.zeros(words, np.uint32), np.array(shape, np.int64))

    @property
    def address_type(self) -> type[np.unsignedinteger[Any]]:
        """Smallest type for flat indices."""
        return np.uint32 if self.shape.prod() < 2**32 else np.uint64


@njit(cache=True)
def _bit_count(word: np.uint64) -> np.int64:
    x = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    x = (x & np.uint64(0x3333333333333333)) + ((x >> np.uint64(2)) & np.uint64(0x3333333333333333))
    x = (x + (x >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return np.int64((x * np.uint64(0x0101010101010101)) >> np.uint64(56))


@njit(cache=True)
def slot(space: PackedSpace, here: Any) -> Any:
    """Return where the value of the voxel with this flat index is stored; -1 for rock."""
    word = space.bits[here >> 6]
    bit = np.uint64(1) << np.uint64(here & 63)
    if word & bit == 0:
        return -1
    return np.int64(space.before[here >> 6]) + _bit_count(word & (bit - np.uint64(1)))


@njit(cache=True)
def row_of_three(space: PackedSpace, here: int) -> tuple[int, int]:
    """Return the slot of the first pore voxel of three in a row, and a bit for each of them; ``here`` is the middle.

    Neighbours lie together in their word: the 26 round a voxel take nine looks at the bits instead of 26. All three
    voxels must be in the volume.
    """
    low = here - 1
    word, offset = low >> 6, low & 63
    first = space.bits[word]
    three = first >> np.uint64(offset)
    if offset > 61:
        three |= space.bits[word + 1] << np.uint64(64 - offset)
    below = first & ((np.uint64(1) << np.uint64(offset)) - np.uint64(1))
    return int(space.before[word]) + int(_bit_count(below)), int(three & np.uint64(7))


@njit(cache=True)
def slots(space: PackedSpace, voxels: NDArray[Any]) -> NDArray[np.int64]:
    """Return the slot (n,) of voxels given by flat index (n,); -1 for rock."""
    out = np.empty(len(voxels), np.int64)
    for row in range(len(voxels)):
        out[row] = slot(space, np.int64(voxels[row]))
    return out


@njit(cache=True)
def pack_slab(space: PackedSpace, pore: NDArray[np.bool_], first: int, filled: int) -> int:
    """Write slices ``first``, ``first + 1``, ...; return the number of pore voxels up to their end.

    ``filled`` is the number before them; slabs must be written in order.
    """
    here = first * space.shape[1] * space.shape[2]
    for value in pore.ravel():
        if here & 63 == 0:
            space.before[here >> 6] = filled
        if value:
            space.bits[here >> 6] |= np.uint64(1) << np.uint64(here & 63)
            filled += 1
        here += 1
    return filled


@njit(cache=True)
def pore_voxels(space: PackedSpace, out: NDArray[Any]) -> None:
    """Write the flat indices of all pore voxels, in ascending order."""
    row = 0
    for place in range(len(space.bits)):
        word = space.bits[place]
        while word != 0:
            lowest = word & (~word + np.uint64(1))
            out[row] = (place << 6) + _bit_count(lowest - np.uint64(1))
            row += 1
            word ^= lowest


def unpacked(space: PackedSpace, values: NDArray[Any]) -> NDArray[Any]:
    """Return values of pore voxels as an array of the volume's shape, 0 in rock."""
    out = np.zeros(tuple(space.shape.tolist()), values.dtype)
    _unpack(space, values, out.reshape(-1))
    return out


@njit(cache=True)
def _unpack(space: PackedSpace, values: NDArray[Any], out: NDArray[Any]) -> None:
    row = 0
    for place in range(len(space.bits)):
        word = space.bits[place]
        while word != 0:
            lowest = word & (~word + np.uint64(1))
            out[(place << 6) + _bit_count(lowest - np.uint64(1))] = values[row]
            row += 1
            word ^= lowest

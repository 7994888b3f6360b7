"""A rock volume that stays on the disk: its slices are read when they are needed."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.pores.volume import RockVolume, VolumeError, label_shares, pore_mask, voxel_edges

__all__ = ["SlicedVolume", "Voxels"]

#: Voxels read at a time to find the labels.
_VOXELS = 50_000_000


class Voxels(Protocol):
    """Values on the disk: a memory-mapped array, a zarr array, the pages of a TIFF file."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Voxels along each axis."""
        ...

    def __getitem__(self, slices: slice, /) -> Any:
        """Return slices along the first axis."""
        ...


@dataclass(frozen=True, eq=False, init=False)
class SlicedVolume:
    """Pore space of a rock sample that need not fit into memory.

    Parameters
    ----------
    values : array-like of shape (n0, n1, n2)
        Labels or grey values of the voxels; only ``shape`` and slices along axis 0 are used.
    pore, voxel
        As for :class:`RockVolume`.

    Attributes
    ----------
    shape : tuple of int
        Voxels along each axis.
    voxel : tuple of three floats
        Edge lengths in metres.
    porosity : float
        Share of pore voxels, connected or not.

    Raises
    ------
    VolumeError
        As for :class:`RockVolume`. All slices are read once to find the labels.

    Examples
    --------
    >>> rock = np.ones((4, 5, 6), np.uint8)
    >>> rock[1:3, 2, 2:4] = 0
    >>> volume = SlicedVolume(rock, pore=0, voxel=5e-6)
    >>> volume.shape, round(volume.porosity, 4), int(volume.slab(2, 4).sum())
    ((4, 5, 6), 0.0333, 2)
    """

    shape: tuple[int, int, int]
    voxel: tuple[float, float, float]
    porosity: float
    _values: Voxels
    _pore: Any

    def __init__(
        self,
        values: Voxels,
        *,
        pore: Any | Collection[Any] | None = None,
        voxel: float | Collection[float] | None = None,
    ) -> None:
        if len(values.shape) != 3 or 0 in values.shape:
            # The error for arrays of the wrong shape.
            RockVolume(np.asarray(values[0:1]), pore=pore, voxel=voxel)
        n0, n1, n2 = values.shape
        counts: dict[Any, int] = {}
        thick = max(1, _VOXELS // (n1 * n2))
        for first in range(0, n0, thick):
            part = np.asarray(values[first : first + thick])
            if part.dtype.kind == "f" and not np.isfinite(part).all():
                raise VolumeError(
                    message(
                        "pores.slices-not-finite",
                        "Slices {first} to {last} have voxels that are NaN or infinite. Give them the value of rock or "
                        "of pore before reading.",
                        first=first,
                        last=first + len(part) - 1,
                    )
                )
            for label, share in label_shares(part).items():
                counts[label] = counts.get(label, 0) + round(share * part.size)
        size = n0 * n1 * n2
        shares = {label: count / size for label, count in sorted(counts.items(), key=lambda item: -item[1])}
        # One voxel of each label decides whether the labels leave a doubt.
        labels = np.array(list(shares), part.dtype)
        chosen = pore_mask(labels.reshape(1, 1, -1), pore, shares).ravel()
        object.__setattr__(self, "shape", (n0, n1, n2))
        object.__setattr__(self, "voxel", voxel_edges(voxel))
        object.__setattr__(self, "porosity", sum(counts[label.item()] for label in labels[chosen]) / size)
        object.__setattr__(self, "_values", values)
        object.__setattr__(self, "_pore", labels[chosen])

    def slab(self, first: int, end: int) -> NDArray[np.bool_]:
        """Return the slices ``first`` ... ``end - 1``, True in pores."""
        part = np.asarray(self._values[first:end])
        return np.ascontiguousarray(part == self._pore[0] if len(self._pore) == 1 else np.isin(part, self._pore))

    @property
    def size(self) -> tuple[float, float, float]:
        """Lengths of the sample in metres."""
        (n0, n1, n2), (e0, e1, e2) = self.shape, self.voxel
        return n0 * e0, n1 * e1, n2 * e2

    @property
    def unit(self) -> float:
        """The shortest edge of a voxel, metres."""
        return min(self.voxel)

    @property
    def edges(self) -> tuple[float, float, float]:
        """Edge lengths in units of the shortest edge."""
        e0, e1, e2 = (edge / self.unit for edge in self.voxel)
        return e0, e1, e2

    @property
    def cubic(self) -> bool:
        """Whether all edges of a voxel are equal."""
        return self.edges == (1.0, 1.0, 1.0)

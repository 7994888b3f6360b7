"""The pore network of a rock volume: wide places (pores) and the narrow places between them (throats)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["AXES", "FaceThroats", "PoreNetwork", "Pores", "Throats"]

#: Names of the axes of the array in results: axis 0 is usually the number of the slice.
AXES = ("axis 0", "axis 1", "axis 2")


class _Table:
    """Columns of equal length."""

    def __len__(self) -> int:
        return len(self.radius)  # type: ignore[attr-defined]


@dataclass(frozen=True, eq=False)
class Pores(_Table):
    """Pores, the widest first; lengths in units of the shortest voxel edge ("voxels").

    Attributes
    ----------
    centre : ndarray of int32, shape (n, 3)
        Voxel in which the largest ball is centred.
    radius : ndarray of float, shape (n,)
        Radius of the largest ball centred on a voxel, from its centre to the rock's surface.
    inscribed : ndarray of float, shape (n,)
        Radius of the largest ball near it whose centre may lie between voxels.
    volume : ndarray of float, shape (n,)
        In cubic voxels.
    faces : ndarray of bool, shape (n, 6)
        Faces of the sample the pore touches: low and high end of axis 0, of axis 1, of axis 2.
    """

    centre: NDArray[np.int32]
    radius: NDArray[np.float64]
    inscribed: NDArray[np.float64]
    volume: NDArray[np.float64]
    faces: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Throats(_Table):
    """Throats between pores; lengths in voxels.

    Attributes
    ----------
    pores : ndarray of int32, shape (m, 2)
        The two pores, the wider one first.
    radius : ndarray of float, shape (m,)
        Radius of the largest ball that passes, centred on voxels.
    inscribed : ndarray of float, shape (m,)
        The same for a centre that may lie between voxels.
    area : ndarray of float, shape (m,)
        Area of the section.
    perimeter : ndarray of float, shape (m,)
        Length of its wall by Crofton's formula.
    length : ndarray of float, shape (m, 2)
        Distances from the middle of the section to the centres of the two pores.
    middle : ndarray of float, shape (m, 3)
        Middle of the section, as indices along the axes.
    conductance : ndarray of float, shape (m,)
        Integral of the velocity over the section of a straight duct under unit gradient and viscosity, in voxels^4.
    """

    pores: NDArray[np.int32]
    radius: NDArray[np.float64]
    inscribed: NDArray[np.float64]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    length: NDArray[np.float64]
    middle: NDArray[np.float64]
    conductance: NDArray[np.float64]

    @property
    def shape_factor(self) -> NDArray[np.float64]:
        """G = A / P², at most that of the circle, 1 / (4 pi)."""
        return np.asarray(np.minimum(self.area / np.maximum(self.perimeter, 1e-300) ** 2, 0.25 / np.pi))


@dataclass(frozen=True, eq=False)
class FaceThroats(_Table):
    """Sections of pores in the sample's faces, through which flow enters and leaves; see :class:`Throats`.

    Attributes
    ----------
    pore : ndarray of int32, shape (k,)
    face : ndarray of int32, shape (k,)
        0 and 1: low and high end of axis 0; 2 and 3: of axis 1; 4 and 5: of axis 2.
    length : ndarray of float, shape (k,)
        Distance from the section to the pore's centre.
    """

    pore: NDArray[np.int32]
    face: NDArray[np.int32]
    radius: NDArray[np.float64]
    inscribed: NDArray[np.float64]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    length: NDArray[np.float64]
    middle: NDArray[np.float64]
    conductance: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PoreNetwork:
    """Pores and throats of a rock volume.

    Attributes
    ----------
    pores : Pores
    throats : Throats
    face_throats : FaceThroats
    dropped : Pores
        Pores that no path of pore space connects to a face of the sample, left out of the network.
    percolates : tuple of three bool
        For each axis of the array, whether the pore space connects its two faces.
    shape : tuple of int
        Shape of the volume.
    voxel : tuple of float
        Edge lengths of a voxel in metres.
    settings : mapping
        What the network was made with (r_min, tau, border, hierarchy).
    pore_of : ndarray of int32, shape ``shape``
        Number of the pore of each voxel, counted from 1; 0 in rock and in dropped pores. None in a network from a file.
    """

    pores: Pores
    throats: Throats
    face_throats: FaceThroats
    dropped: Pores
    percolates: tuple[bool, bool, bool]
    shape: tuple[int, int, int]
    voxel: tuple[float, float, float]
    settings: Mapping[str, Any] = field(default_factory=dict)
    pore_of: NDArray[np.int32] | None = field(default=None, repr=False)

    @property
    def unit(self) -> float:
        """Length of one voxel, the shortest edge, in metres."""
        return min(self.voxel)

    @property
    def edges(self) -> NDArray[np.float64]:
        """Edge lengths of a voxel in units of the shortest one."""
        return np.array(self.voxel) / self.unit

    @property
    def coordination(self) -> NDArray[np.int64]:
        """Number of different pores that each pore is connected to; shape (n,)."""
        pairs = np.unique(np.sort(self.throats.pores, axis=1), axis=0)
        return np.bincount(pairs.ravel(), minlength=len(self.pores))

    @property
    def porosity(self) -> float:
        """Volume of the pores in the network over that of the sample."""
        return float(self.pores.volume.sum() / (np.prod(self.shape) * np.prod(self.edges)))

    @property
    def centre(self) -> NDArray[np.float64]:
        """Centres of the pores in metres from the low corner of the sample, along the axes of the array."""
        metres: NDArray[np.float64] = (self.pores.centre + 0.5) * np.array(self.voxel)
        return metres

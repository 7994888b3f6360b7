"""Regular nodes in a box, and a field sampled at them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, Field, box_of

__all__ = ["Lattice", "sample"]

Floats = NDArray[np.float64]

#: Points that a field gets at a time: more cost memory and no less time.
BATCH = 1 << 18


@arguments_checked
@dataclass(frozen=True, eq=False)
class Lattice:
    """Nodes ``origin + spacing * (i, j, k)``.

    Parameters
    ----------
    origin : (3,) array
        Node (0, 0, 0), metres.
    spacing : float
        Distance of neighbouring nodes h, metres, the same along every axis.
    shape : tuple of 3 int
        Nodes along x, y and z, at least 2.
    """

    origin: Floats
    spacing: float
    shape: tuple[int, int, int]

    def __post_init__(self) -> None:
        origin = np.array(self.origin, float)
        if origin.shape != (3,) or not np.isfinite(origin).all():
            raise SettingsError(
                message(
                    "implicit.origin-not-a-point",
                    "the origin {origin} is not a point: give x, y, z",
                    origin=origin.tolist(),
                )
            )
        if not (np.isfinite(self.spacing) and self.spacing > 0):
            raise SettingsError(
                message(
                    "implicit.spacing-not-positive",
                    "the spacing {spacing} must be a positive length",
                    spacing=self.spacing,
                )
            )
        if len(self.shape) != 3 or min(self.shape) < 2:
            raise SettingsError(
                message(
                    "implicit.lattice-too-small",
                    "a lattice needs 2 nodes or more an axis, not {shape}",
                    shape=tuple(self.shape),
                )
            )
        origin.flags.writeable = False
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "spacing", float(self.spacing))
        object.__setattr__(self, "shape", tuple(int(n) for n in self.shape))

    @classmethod
    @arguments_checked
    def around(cls, lower: ArrayLike, upper: ArrayLike, *, cells: int) -> Lattice:
        """Return cubic cells that cover a box, ``cells`` of them along its longest side, centred on the box.

        Raises
        ------
        SettingsError
            If the box is infinite, flat in every direction, or ``cells`` is below 1.
        """
        low, high = box_of(lower, upper)
        size = high - low
        if not np.isfinite(size).all() or size.max() <= 0 or cells < 1:
            raise SettingsError(
                message(
                    "implicit.cells-cannot-cover-box",
                    "{cells} cells cannot cover the box {lower} to {upper}: give a finite box and at least 1 cell",
                    cells=cells,
                    lower=low.tolist(),
                    upper=high.tolist(),
                )
            )
        spacing = float(size.max()) / cells
        # A side that is a whole number of cells but for rounding must not get one more.
        counts = np.maximum(1, np.ceil(size / spacing - 1e-9)).astype(int)
        origin = (low + high - counts * spacing) / 2
        return cls(origin, spacing, (int(counts[0]) + 1, int(counts[1]) + 1, int(counts[2]) + 1))

    @property
    def bounds(self) -> Box:
        """First and last node, (3,) each."""
        return self.origin, self.origin + self.spacing * (np.array(self.shape) - 1)

    @property
    def axes(self) -> tuple[Floats, Floats, Floats]:
        """Coordinates of the nodes along x, y and z."""
        x, y, z = (self.origin[i] + self.spacing * np.arange(self.shape[i]) for i in range(3))
        return x, y, z

    def nodes(self) -> Floats:
        """Return all nodes as (n, 3) array, z fastest."""
        return np.stack(np.meshgrid(*self.axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def coarse(self) -> Lattice:
        """Return every second node.

        Raises
        ------
        SettingsError
            If the last node is not among them: the number of cells along an axis is odd.
        """
        if any(n % 2 == 0 for n in self.shape):
            raise SettingsError(
                message(
                    "implicit.nodes-not-odd",
                    "every second node of a lattice of shape {shape} misses its end: give odd numbers of nodes",
                    shape=self.shape,
                )
            )
        nx, ny, nz = self.shape
        return Lattice(self.origin, 2 * self.spacing, ((nx + 1) // 2, (ny + 1) // 2, (nz + 1) // 2))


@arguments_checked
def sample(field: Field, lattice: Lattice) -> Floats:
    """Return the values of a field at all nodes of a lattice, shape ``lattice.shape``."""
    x, y, z = lattice.axes
    values = np.empty(lattice.shape)
    layers = max(1, BATCH // (len(y) * len(z)))
    for first in range(0, len(x), layers):
        part = x[first : first + layers]
        xyz = np.stack(np.meshgrid(part, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
        values[first : first + layers] = field.value(xyz).reshape(len(part), len(y), len(z))
    return values

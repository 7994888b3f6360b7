"""The field of a fitted body about its local origin: the interpolant in the box, closed and positive outside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.frame import BodyFrame

__all__ = ["BodyField", "Interpolant"]

Floats = NDArray[np.float64]
SIDES = ("west", "east", "south", "north", "bottom", "top")
#: Rasters on a side of the box, of which each is finer about so many least values of the last, and its places a line.
_ZOOMS, _LEAST, _FINER = 4, 8, 9


class Interpolant(Protocol):
    """A function with a gradient, in fitted coordinates."""

    def value(self, x: Floats) -> Floats:
        """Return values (n,)."""
        ...

    def gradient(self, x: Floats) -> Floats:
        """Return gradients (n, 3)."""
        ...


@dataclass(frozen=True, eq=False)
class BodyField:
    """Values and gradients of a body at places about its local origin, metres; negative inside.

    Beyond the box the value at the nearest place of the box counts, plus the distance to it: no second body appears
    where the trend of the interpolant would make one. Where the body reaches a side of the box it is cut there.

    Parameters
    ----------
    interpolant : Interpolant
        The function in fitted coordinates.
    frame : BodyFrame
        Fitted coordinates.
    lower, upper : (3,) arrays
        Corners of the box about the local origin.
    cut : tuple of str
        Sides of the box at which the body is cut, of "west", "east", "south", "north", "bottom", "top".
    """

    interpolant: Interpolant
    frame: BodyFrame
    lower: Floats
    upper: Floats
    cut: tuple[str, ...] = ()

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Corners of the box."""
        return self.lower, self.upper

    @property
    def lipschitz(self) -> float:
        """No bound of the gradient is known."""
        return float("inf")

    def value(self, xyz: Floats) -> Floats:
        """Return the values (n,) at (n, 3) places about the local origin."""
        if not self.cut and self._holds(xyz):
            return self._raw(xyz)
        near = np.clip(xyz, self.lower, self.upper)
        beyond = np.linalg.norm(xyz - near, axis=1)
        value = self._raw(near)
        value = np.where(beyond > 0, np.maximum(value, 0.0) + beyond, value)
        return np.maximum(value, self._depth(xyz)[0]) if self.cut else value

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradients (n, 3) at (n, 3) places about the local origin."""
        if not self.cut and self._holds(xyz):
            return self.frame.gradient(self.interpolant.gradient(xyz @ self.frame.matrix.T))
        near = np.clip(xyz, self.lower, self.upper)
        off = xyz - near
        beyond = np.linalg.norm(off, axis=1)
        fitted = near @ self.frame.matrix.T
        gradient = self.frame.gradient(self.interpolant.gradient(fitted))
        out = beyond > 0
        if not (out.any() or self.cut):
            return gradient
        value = self._raw(near)
        if out.any():
            along = np.where((off == 0) & (value > 0)[:, None], gradient, 0.0)
            gradient[out] = (along + off / np.maximum(beyond, 1e-300)[:, None])[out]
        if self.cut:
            depth, side = self._depth(xyz)
            over = depth > np.where(out, np.maximum(value, 0.0) + beyond, value)
            gradient[over] = side[over]
        return gradient

    def reaches(self, count: int = 40) -> tuple[str, ...]:
        """Return the sides of the box on which the body has places.

        They are looked for on a raster of ``count`` squared, and around its least values on finer ones: a body that
        only touches a side is cut there, too.
        """
        return tuple(name for k, name in enumerate(SIDES) if self._on_side(k // 2, k % 2, count))

    def _on_side(self, axis: int, end: int, count: int) -> bool:
        across = [a for a in range(3) if a != axis]
        low, high = self.lower[across], self.upper[across]
        places = _raster(np.linspace(low, high, count))
        step = (high - low) / (count - 1)
        for _ in range(_ZOOMS):
            plane = np.insert(places, axis, (self.lower, self.upper)[end][axis], axis=1)
            value = self._raw(plane)
            if (value < 0).any():
                return True
            least = places[np.argsort(value, kind="stable")[:_LEAST]]
            around = _raster(np.linspace(-step, step, _FINER))
            places = np.clip((least[:, None] + around).reshape(-1, 2), low, high)
            step = 2 * step / (_FINER - 1)
        return False

    def _holds(self, xyz: Floats) -> bool:
        """Whether all places are in the box: most are asked for along the surface."""
        sides = zip(xyz.T, self.lower.tolist(), self.upper.tolist(), strict=True)
        return all(low <= x.min(initial=low) and x.max(initial=low) <= high for x, low, high in sides)

    def _raw(self, xyz: Floats) -> Floats:
        return self.interpolant.value(xyz @ self.frame.matrix.T)

    def _depth(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Return the largest signed distance (n,) to the planes of the cut sides, negative inside, and its gradient."""
        distances, normals = [], []
        for k, name in enumerate(SIDES):
            if name in self.cut:
                sign = 1.0 if k % 2 else -1.0
                distances.append(sign * (xyz[:, k // 2] - (self.upper if k % 2 else self.lower)[k // 2]))
                normals.append(sign * np.eye(3)[k // 2])
        stacked = np.array(distances)
        return stacked.max(axis=0), np.array(normals)[stacked.argmax(axis=0)]


def _raster(lines: Floats) -> Floats:
    """Return the (n * n, 2) places of a raster with (n, 2) coordinates of its lines."""
    return np.stack(np.meshgrid(*lines.T, indexing="ij"), axis=-1).reshape(-1, 2)

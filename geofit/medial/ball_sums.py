"""Sums of metaball fields at many points: each cell of a grid lists the balls that reach it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.medial.kernel import reach

__all__ = ["BallCells"]

Floats = NDArray[np.float64]

#: Cells of the grid at most; beyond, they become larger.
_MOST = 200_000


class BallCells:
    """Balls sorted into the cells of a grid.

    Parameters
    ----------
    centre : (n, 3) array
        Centres.
    radius : (n,) array
        Visible radii.
    stiffness : float
        s of the kernel.
    """

    def __init__(self, centre: Floats, radius: Floats, stiffness: float) -> None:
        far = reach(radius, stiffness)
        self.centre, self.radius, self.stiffness, self.far = centre, radius, stiffness, far
        low, high = (centre - far[:, None]).min(axis=0), (centre + far[:, None]).max(axis=0)
        size = high - low
        self.cell = float(max(np.median(far), (size.prod() / _MOST) ** (1 / 3), size.max() / 1000))
        self.origin = low
        self.shape = np.ceil(size / self.cell).astype(np.int64) + 1
        first = np.floor((centre - far[:, None] - low) / self.cell).astype(np.int64)
        last = np.floor((centre + far[:, None] - low) / self.cell).astype(np.int64)
        first, last = np.maximum(first, 0), np.minimum(last, self.shape - 1)
        self.start, self.member = _loops()[0](first, last, self.shape)

    def sums(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Return the sum of the fields (m,) and its gradient (m, 3) at points (m, 3)."""
        value, gradient = np.zeros(len(xyz)), np.zeros((len(xyz), 3))
        _loops()[1](
            np.ascontiguousarray(xyz), self.origin, self.cell, self.shape, self.start, self.member,
            self.centre, self.radius, self.far, self.stiffness, value, gradient,
        )  # fmt: skip
        return value, gradient

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds (k,), (k,) of the sum in boxes with corners (k, 3): every ball at its farthest and nearest."""
        low, high = np.zeros(len(lower)), np.zeros(len(lower))
        _loops()[2](lower, upper, self.centre, self.radius, self.far, self.stiffness, low, high)
        return low, high

    def lipschitz(self) -> float:
        """Return the largest sum, over the cells, of the steepest slopes of the balls that reach a cell."""
        slope = np.add.reduceat(np.r_[(self.stiffness / self.radius)[self.member], 0.0], self.start[:-1])
        return float(np.where(np.diff(self.start) > 0, slope, 0.0).max())


@cache
def _loops() -> tuple[Any, Any, Any]:
    """Return the compiled loops: balls into cells, sums at points, bounds in boxes."""
    from numba import njit

    @njit(cache=True)
    def sort_into_cells(first, last, shape):  # type: ignore[no-untyped-def]  # pragma: no cover
        start = np.zeros(shape[0] * shape[1] * shape[2] + 1, dtype=np.int64)
        member = np.zeros(0, dtype=np.int64)
        for turn in range(2):
            fill = start[:-1].copy()
            for n in range(len(first)):
                for i in range(first[n, 0], last[n, 0] + 1):
                    for j in range(first[n, 1], last[n, 1] + 1):
                        for k in range(first[n, 2], last[n, 2] + 1):
                            cell = (i * shape[1] + j) * shape[2] + k
                            if turn == 0:
                                start[cell + 1] += 1
                            else:
                                member[fill[cell]] = n
                                fill[cell] += 1
            if turn == 0:
                start = np.cumsum(start)
                member = np.zeros(start[-1], dtype=np.int64)
        return start, member

    @njit(cache=True, inline="always")
    def field(r, e, s):  # type: ignore[no-untyped-def]  # pragma: no cover
        if r <= e:
            return 1.0 + s * (1.0 - r / e), -s / e
        t = max(e * (1.0 + 2.0 / s) - r, 0.0) * s / (2.0 * e)
        return t * t, -t * s / e

    @njit(cache=True)
    def sums(xyz, origin, width, shape, start, member, centre, radius, far, s, value, gradient):  # type: ignore[no-untyped-def]  # pragma: no cover
        for p in range(len(xyz)):
            i = int(np.floor((xyz[p, 0] - origin[0]) / width))
            j = int(np.floor((xyz[p, 1] - origin[1]) / width))
            k = int(np.floor((xyz[p, 2] - origin[2]) / width))
            if not (0 <= i < shape[0] and 0 <= j < shape[1] and 0 <= k < shape[2]):
                # A place with a coordinate that is not a number has no value.
                value[p] += np.nan if np.isnan(xyz[p].sum()) else 0.0
                continue
            cell = (i * shape[1] + j) * shape[2] + k
            for m in range(start[cell], start[cell + 1]):
                n = member[m]
                x, y, z = xyz[p, 0] - centre[n, 0], xyz[p, 1] - centre[n, 1], xyz[p, 2] - centre[n, 2]
                r2 = x * x + y * y + z * z
                if r2 < far[n] * far[n]:
                    r = np.sqrt(r2)
                    f, slope = field(r, radius[n], s)
                    value[p] += f
                    if r > 0.0:
                        gradient[p, 0] += slope * x / r
                        gradient[p, 1] += slope * y / r
                        gradient[p, 2] += slope * z / r

    @njit(cache=True)
    def bounds(lower, upper, centre, radius, far, s, low, high):  # type: ignore[no-untyped-def]  # pragma: no cover
        for b in range(len(lower)):
            for n in range(len(centre)):
                near2 = far2 = 0.0
                for a in range(3):
                    below, above = lower[b, a] - centre[n, a], centre[n, a] - upper[b, a]
                    gap = max(below, above, 0.0)
                    near2 += gap * gap
                    gap = max(-below, -above)
                    far2 += gap * gap
                if near2 < far[n] * far[n]:
                    high[b] += field(np.sqrt(near2), radius[n], s)[0]
                    low[b] += field(np.sqrt(far2), radius[n], s)[0]

    return sort_into_cells, sums, bounds

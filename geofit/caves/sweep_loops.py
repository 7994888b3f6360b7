"""Values of swept sections, compiled: at points, as bounds in boxes, and painted on the nodes of a lattice."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.caves.sweeps import Sweeps

__all__ = ["SweepCells", "extremes", "half_axes", "margin", "paint_sweeps", "ranges"]

Floats = NDArray[np.float64]

#: Cells of the grid at most.
CELLS = 60_000
#: Spacings beyond the walls of a sweep within which its values are needed.
MARGIN = 4


def _arrays(sweeps: Sweeps) -> tuple[Any, ...]:
    s = sweeps
    return s.origin, s.along, s.right, s.up, s.length, s.walls, s.cap, s.onward


def extremes(sweeps: Sweeps) -> tuple[Floats, Floats]:
    """Return the largest and smallest semi-axis (k,), (k,) of each sweep; 0 where an end is flat.

    The smallest one of a sweep that another one goes on from is that of its branch: beyond the end the others count.
    """
    most = np.maximum(sweeps.walls.max(axis=(1, 2)), sweeps.cap.max(axis=1))
    own = np.minimum(sweeps.walls.min(axis=(1, 2)), sweeps.cap.min(axis=1))
    least = np.full(sweeps.branch.max(initial=-1) + 1, np.inf)
    np.minimum.at(least, sweeps.branch, own)
    return most, np.where(sweeps.onward.any(axis=(1, 2)), least[sweeps.branch], own)


def half_axes(sweeps: Sweeps) -> Floats:
    """Return how far (k, 3) each sweep reaches from its axis to a side, up or down, and beyond an end."""
    side, level = sweeps.walls[..., :2].max(axis=(1, 2)), sweeps.walls[..., 2:].max(axis=(1, 2))
    return np.column_stack([side, level, sweeps.cap.max(axis=1)])


def margin(sweeps: Sweeps, blend: float, spacing: float) -> float:
    """Return the distance from the walls beyond which sweeps change nothing: a single branch does not blend."""
    return (blend if np.ptp(sweeps.branch) else 0.0) + MARGIN * spacing


class SweepCells:
    """The sweeps that can matter in each cell of a grid, so that a value costs a few sweeps instead of all.

    Parameters
    ----------
    sweeps : Sweeps
        The swept sections.
    blend : float
        Radius of the smooth union.
    bounds : pair of (3,) arrays
        Box that the grid covers; points outside it are measured against all sweeps.
    """

    def __init__(self, sweeps: Sweeps, blend: float, bounds: tuple[Floats, Floats]) -> None:
        self.sweeps, self.blend = sweeps, blend
        most, least = extremes(sweeps)
        size = bounds[1] - bounds[0]
        self.width = float(max(np.median(most) / 2, (size.prod() / CELLS) ** (1 / 3)))
        self.corner = bounds[0] - self.width
        self.shape = np.ceil(size / self.width).astype(np.int64) + 2
        self.start, self.member = _loops()[0](
            self.corner, self.width, self.shape, sweeps.origin, sweeps.along, sweeps.length, most, least, blend
        )

    def values(self, xyz: Floats) -> Floats:
        """Return the field (n,) of the union at points (n, 3)."""
        found = np.empty(len(xyz))
        grid = (self.corner, self.width, self.shape, self.start, self.member)
        _loops()[1](np.ascontiguousarray(xyz), *_arrays(self.sweeps), self.sweeps.branch, *grid, self.blend, found)
        return found


def ranges(sweeps: Sweeps, blend: float, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Return bounds (k,), (k,) of the field in boxes with corners (k, 3)."""
    low, high = np.empty(len(lower)), np.empty(len(lower))
    frame = sweeps.origin, sweeps.along, sweeps.right, sweeps.up, sweeps.length
    _loops()[2](lower, upper, *frame, *extremes(sweeps), half_axes(sweeps), blend, low, high)
    return low, high


def paint_sweeps(
    sweeps: Sweeps, blend: float, boxes: tuple[Floats, Floats], origin: Floats, spacing: float, shape: tuple[int, ...]
) -> Floats:
    """Return the field at the nodes of a lattice, shape ``shape``; infinite outside the boxes of all sweeps."""
    best, second = np.full(shape, np.inf), np.full(shape, np.inf)
    owner = np.full(shape, -1, dtype=np.int32)
    first = np.maximum(np.floor((boxes[0] - origin) / spacing).astype(np.int64) - 2, 0)
    last = np.minimum(np.ceil((boxes[1] - origin) / spacing).astype(np.int64) + 2, np.array(shape) - 1)
    # Beyond this distance from the axis a node is outside, has no neighbour inside, and does not blend.
    from_axis = extremes(sweeps)[0] + blend + 2 * spacing
    # The same holds beyond this distance from the walls: slots are much narrower than they are high.
    from_walls = half_axes(sweeps)[:, :2] + margin(sweeps, blend, spacing)
    far = np.column_stack([from_walls, from_axis])
    _loops()[3](first, last, origin, spacing, *_arrays(sweeps), sweeps.branch, far, best, second, owner)
    if blend > 0:
        near = second < best + blend
        best[near] -= (blend - (second[near] - best[near])) ** 2 / (4 * blend)
    return best


@cache
def _loops() -> tuple[Any, Any, Any, Any]:
    """Return the compiled loops: sweeps into cells, values at points, bounds in boxes, painting."""
    from numba import njit

    @njit(cache=True)
    def sweep(x, y, z, n, origin, along, right, up, length, walls, cap, onward):  # type: ignore[no-untyped-def]  # pragma: no cover
        qx, qy, qz = x - origin[n, 0], y - origin[n, 1], z - origin[n, 2]
        s = qx * along[n, 0] + qy * along[n, 1] + qz * along[n, 2]
        v = qx * right[n, 0] + qy * right[n, 1] + qz * right[n, 2]
        w = qx * up[n, 0] + qy * up[n, 1] + qz * up[n, 2]
        t = min(max(s / length[n], 0.0), 1.0)
        side, level = 1 if v >= 0 else 0, 2 if w >= 0 else 3
        a = (1 - t) * walls[n, 0, side] + t * walls[n, 1, side]
        b = (1 - t) * walls[n, 0, level] + t * walls[n, 1, level]
        over, axis = 0.0, 1.0
        plane = -np.inf
        if cap[n, 0] == 0.0:
            plane = -s
        elif s < 0:
            if qx * onward[n, 0, 0] + qy * onward[n, 0, 1] + qz * onward[n, 0, 2] > 0:
                return np.inf
            over, axis = -s, cap[n, 0]
        if cap[n, 1] == 0.0:
            plane = max(plane, s - length[n])
        elif s > length[n]:
            ex, ey, ez = qx - length[n] * along[n, 0], qy - length[n] * along[n, 1], qz - length[n] * along[n, 2]
            if ex * onward[n, 1, 0] + ey * onward[n, 1, 1] + ez * onward[n, 1, 2] > 0:
                return np.inf
            over, axis = s - length[n], cap[n, 1]
        away = np.sqrt(v * v + w * w + over * over)
        rho = np.sqrt((v / a) ** 2 + (w / b) ** 2 + (over / axis) ** 2)
        found = away - away / rho if rho > 1e-9 else -min(a, b)
        return max(found, plane)

    @njit(cache=True)
    def axis_distance(x, y, z, n, origin, along, length):  # type: ignore[no-untyped-def]  # pragma: no cover
        qx, qy, qz = x - origin[n, 0], y - origin[n, 1], z - origin[n, 2]
        s = min(max(qx * along[n, 0] + qy * along[n, 1] + qz * along[n, 2], 0.0), length[n])
        qx, qy, qz = qx - s * along[n, 0], qy - s * along[n, 1], qz - s * along[n, 2]
        return np.sqrt(qx * qx + qy * qy + qz * qz)

    @njit(cache=True)
    def sort_into_cells(corner, width, shape, origin, along, length, most, least, blend):  # type: ignore[no-untyped-def]  # pragma: no cover
        start = np.zeros(shape[0] * shape[1] * shape[2] + 1, dtype=np.int64)
        member = np.empty(16 * len(start), dtype=np.int32)
        lowest = np.empty(len(length))
        half = 0.5 * np.sqrt(3.0) * width
        cell = 0
        for i in range(shape[0]):
            for j in range(shape[1]):
                for k in range(shape[2]):
                    x, y, z = (
                        corner[0] + (i + 0.5) * width,
                        corner[1] + (j + 0.5) * width,
                        corner[2] + (k + 0.5) * width,
                    )
                    bound = np.inf
                    for n in range(len(length)):
                        away = axis_distance(x, y, z, n, origin, along, length)
                        outside = away - half - most[n]
                        lowest[n] = min(outside, 0.5 * outside)
                        bound = min(bound, away + half - least[n])
                    count = start[cell]
                    for n in range(len(length)):
                        if lowest[n] <= bound + blend:
                            if count == len(member):
                                member = np.concatenate((member, np.empty_like(member)))
                            member[count] = n
                            count += 1
                    cell += 1
                    start[cell] = count
        return start, member[: start[-1]].copy()

    @njit(cache=True)
    def at_points(  # type: ignore[no-untyped-def]  # pragma: no cover
        xyz,
        origin,
        along,
        right,
        up,
        length,
        walls,
        cap,
        onward,
        branch,
        corner,
        width,
        shape,
        start,
        member,
        blend,
        found,
    ):
        for p in range(len(xyz)):
            x, y, z = xyz[p]
            i = int(np.floor((x - corner[0]) / width))
            j = int(np.floor((y - corner[1]) / width))
            k = int(np.floor((z - corner[2]) / width))
            listed = 0 <= i < shape[0] and 0 <= j < shape[1] and 0 <= k < shape[2]
            cell = (i * shape[1] + j) * shape[2] + k if listed else 0
            first, last = (start[cell], start[cell + 1]) if listed else (0, len(length))
            best = second = np.nan if np.isnan(x + y + z) else np.inf
            owner = -1
            for m in range(first, last):
                n = member[m] if listed else m
                here = sweep(x, y, z, n, origin, along, right, up, length, walls, cap, onward)
                if branch[n] == owner:
                    best = min(best, here)
                elif here < best:
                    best, second, owner = here, best, branch[n]
                elif here < second:
                    second = here
            found[p] = best
            if blend > 0 and second < best + blend:
                found[p] -= (blend - (second - best)) ** 2 / (4 * blend)

    @njit(cache=True)
    def in_boxes(  # type: ignore[no-untyped-def]  # pragma: no cover
        lower, upper, origin, along, right, up, length, most, least, reach, blend, low, high
    ):
        for k in range(len(lower)):
            x, y, z = 0.5 * (lower[k] + upper[k])
            half = 0.5 * np.sqrt(((upper[k] - lower[k]) ** 2).sum())
            low[k] = high[k] = np.inf
            for n in range(len(length)):
                away = axis_distance(x, y, z, n, origin, along, length)
                qx, qy, qz = x - origin[n, 0], y - origin[n, 1], z - origin[n, 2]
                side = abs(qx * right[n, 0] + qy * right[n, 1] + qz * right[n, 2]) - reach[n, 0]
                level = abs(qx * up[n, 0] + qy * up[n, 1] + qz * up[n, 2]) - reach[n, 1]
                nearest = max(away - most[n], side, level) - half
                low[k] = min(low[k], nearest, 0.5 * nearest)
                high[k] = min(high[k], away + half - least[n])
            low[k] -= blend / 4

    @njit(cache=True)
    def painted(  # type: ignore[no-untyped-def]  # pragma: no cover
        first,
        last,
        corner,
        spacing,
        origin,
        along,
        right,
        up,
        length,
        walls,
        cap,
        onward,
        branch,
        far,
        best,
        second,
        owner,
    ):
        for n in range(len(length)):
            for i in range(first[n, 0], last[n, 0] + 1):
                for j in range(first[n, 1], last[n, 1] + 1):
                    for k in range(first[n, 2], last[n, 2] + 1):
                        x, y, z = corner[0] + i * spacing, corner[1] + j * spacing, corner[2] + k * spacing
                        if axis_distance(x, y, z, n, origin, along, length) > far[n, 2]:
                            continue
                        qx, qy, qz = x - origin[n, 0], y - origin[n, 1], z - origin[n, 2]
                        if abs(qx * right[n, 0] + qy * right[n, 1] + qz * right[n, 2]) > far[n, 0]:
                            continue
                        if abs(qx * up[n, 0] + qy * up[n, 1] + qz * up[n, 2]) > far[n, 1]:
                            continue
                        here = sweep(x, y, z, n, origin, along, right, up, length, walls, cap, onward)
                        if branch[n] == owner[i, j, k]:
                            best[i, j, k] = min(best[i, j, k], here)
                        elif here < best[i, j, k]:
                            best[i, j, k], second[i, j, k] = here, best[i, j, k]
                            owner[i, j, k] = branch[n]
                        elif here < second[i, j, k]:
                            second[i, j, k] = here

    return sort_into_cells, at_points, in_boxes, painted

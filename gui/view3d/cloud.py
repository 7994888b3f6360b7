"""Many points by level of detail: blocks of neighbours, of which each view draws as many as its pixels deserve.

The points are sorted along a space-filling curve and cut into blocks of as many points each. Within a block they are
in an order of which every beginning is spread over the block, so that a coarser picture is a shorter beginning: no
point is held twice. What is picked is looked for among all points, in the few blocks under the pointer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.gui.view3d.projector import Projector

__all__ = ["PointCloud", "shares"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points of a block, and its parts: powers of two.
BLOCK, PARTS = 4096, 64
#: Blocks in sight up to which their parts are told apart.
FEW = 64
#: Bits of the curve along each axis: with three axes they fill the upper half of a sorted number, beside the index.
BITS = 10
#: Points that are sorted in at a time.
PART = 1_000_000


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Points in blocks.

    Parameters
    ----------
    xyz : (n, 3) array
        All points in their own order, map coordinates; not copied.
    order : (n,) array of uint32
        Their indices block by block, each beginning of a block spread over it.
    boxes : (k, 2, 3) array
        Least and largest coordinates of each block.
    parts : (k, PARTS, 2, 3) array
        Those of its parts: neighbours again, the points at every PARTS-th place of the block.
    """

    xyz: Floats
    order: NDArray[np.uint32]
    boxes: Floats
    parts: Floats

    @classmethod
    def of(cls, xyz: Floats) -> PointCloud:
        """Sort (n, 3) points into blocks; beside them it takes 5 bytes a point, and 13 while it sorts.

        Examples
        --------
        >>> cloud = PointCloud.of(np.random.default_rng(0).uniform(0, 9, (5000, 3)))
        >>> len(cloud.boxes), sorted(cloud.order.tolist()) == list(range(5000))
        (2, True)
        """
        keys = _along_curve(xyz)
        keys.sort()
        order = keys.astype(np.uint32)  # the lower half of the numbers: the indices
        del keys
        parts = np.empty((-(-len(order) // BLOCK), PARTS, 2, 3))
        for k, start in enumerate(range(0, len(order), BLOCK)):
            block = order[start : start + BLOCK]
            spread = _SPREAD if len(block) == BLOCK else _SPREAD[len(block) > _SPREAD]
            block[:] = block[spread]
            # A part of the last block may have no point: it takes another's.
            places = np.resize(xyz[block], (-(-len(block) // PARTS) * PARTS, 3)).reshape(-1, PARTS, 3)
            parts[k] = np.stack([places.min(axis=0), places.max(axis=0)], axis=1)
        boxes = np.stack([parts[:, :, 0].min(axis=1), parts[:, :, 1].max(axis=1)], axis=1)
        return cls(xyz, order, boxes, parts)

    def __len__(self) -> int:
        return len(self.order)

    @property
    def box(self) -> Floats:
        """Least and largest coordinates (2, 3) of all points."""
        return np.stack([self.boxes[:, 0].min(axis=0), self.boxes[:, 1].max(axis=0)])

    def drawn(self, view: Projector, budget: int) -> Ints:
        """Return the indices of at most ``budget`` points, of each block in sight in proportion to its pixels.

        Where few blocks are in sight, their parts are told apart.
        """
        pixels = _pixels(self.boxes, view)
        block = np.flatnonzero(pixels)
        if len(block) > FEW:
            return self.beginnings(shares(self.sizes, pixels, budget))
        pixels = _pixels(self.parts[block].reshape(-1, 2, 3), view)
        sizes = -((np.arange(PARTS) - self.sizes[block, None]) // PARTS)
        starts = block[:, None] * BLOCK + np.arange(PARTS)
        return self._beginnings(starts.ravel(), PARTS, shares(sizes.ravel(), pixels, budget))

    def beginnings(self, counts: Ints) -> Ints:
        """Return the indices of the first (k,) points of each block."""
        return self._beginnings(np.arange(len(counts)) * BLOCK, 1, counts)

    def _beginnings(self, starts: Ints, step: int, counts: Ints) -> Ints:
        ends = np.cumsum(counts)
        number = np.arange(ends[-1] if len(ends) else 0) - np.repeat(ends - counts, counts)
        return np.asarray(self.order[np.repeat(starts, counts) + step * number], np.int64)

    def under(self, view: Projector, column: float, row: float, reach: float) -> Iterator[tuple[float, Ints]]:
        """Yield the points that can be drawn within ``reach`` pixels of a pixel, some at a time from front to back.

        Each time: the least depth that these or later ones can have, and their indices.
        """
        size = np.array([view.width, view.height])
        here = (2 * np.array([column, row]) / size - 1) * (1, -1)
        near = 2 * (reach + 1e-6) / size
        block = np.flatnonzero(_within(_corners(self.boxes, view), here, near))
        corners = _corners(self.parts[block].reshape(-1, 2, 3), view)
        met = np.flatnonzero(_within(corners, here, near))
        depth = _least_depth(self.parts[block].reshape(-1, 2, 3)[met], view)
        order = np.argsort(depth, kind="stable")
        start = block[met[order] // PARTS] * BLOCK + met[order] % PARTS
        first, count = 0, PARTS
        while first < len(start):
            place = start[first : first + count, None] + np.arange(0, BLOCK, PARTS)
            yield float(depth[order[first]]), np.asarray(self.order[place[place < len(self)]], np.int64)
            first, count = first + count, 2 * count

    @property
    def sizes(self) -> Ints:
        """Number of points (k,) of each block."""
        sizes = np.full(len(self.boxes), BLOCK)
        sizes[-1] = len(self.order) - BLOCK * (len(sizes) - 1)
        return sizes


def _least_depth(boxes: Floats, view: Projector) -> Floats:
    """Return the least depth (k,) at which a place of boxes (k, 2, 3) can be drawn; it is at a corner."""
    corners = _corners(boxes, view, (2, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = ((corners[:, 0] / corners[:, 1] + 1) / 2).min(axis=1) - 1e-9
    return np.where(np.any(corners[:, 1] <= 1e-6, axis=1), -np.inf, depth)


def _corners(boxes: Floats, view: Projector, rows: tuple[int, ...] = (0, 1, 3)) -> Floats:
    """Return x, y and w (k, 3, 8) of the corners of boxes (k, 2, 3); they are drawn at x / w and y / w, -1 to 1.

    Other ``rows`` of the camera's matrix give others of x, y, z and w; z / w is the depth, -1 to 1.
    """
    matrix = view.matrix[list(rows)]
    turn = matrix[:, :3] * (1.0, 1.0, view.stretch)
    ends = (boxes - view.origin)[:, :, None, :] * turn
    x, y, z = (ends[..., axis].transpose(0, 2, 1) for axis in range(3))
    whole = x[..., :, None, None] + y[..., None, :, None] + z[..., None, None, :]
    return np.asarray(whole.reshape(len(whole), len(matrix), 8) + matrix[:, 3, None])


def _pixels(boxes: Floats, view: Projector) -> Floats:
    """Return about how many pixels boxes (k, 2, 3) take of the picture; 0 out of sight."""
    size = np.array([view.width, view.height])
    corners = _corners(boxes, view)
    seen = _within(corners, np.zeros(2), np.ones(2))
    around = np.any(corners[:, 2] <= 0, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        place = (corners[:, :2] / corners[:, 2:] + 1) / 2 * size[:, None]
    # A box that the viewpoint is in may fill the picture; one that is seen from its edge is there all the same.
    low = np.where(around, 0.0, np.clip(place.min(axis=2), 0.0, size))
    high = np.where(around, size, np.clip(place.max(axis=2), 0.0, size))
    return np.where(seen, np.maximum(high - low, 1.0).prod(axis=1), 0.0)


def _within(corners: Floats, middle: Floats, reach: Floats) -> NDArray[np.bool_]:
    """Return which boxes may be drawn within a reach of a place of the picture: none of its sides parts them from it.

    Without division the test holds for boxes through the viewpoint, too (Blinn, Newell 1978, "Clipping using
    homogeneous coordinates").
    """
    place, w = corners[:, :2], corners[:, 2:]
    below = np.all(place < (middle - reach)[:, None] * w, axis=2)
    above = np.all(place > (middle + reach)[:, None] * w, axis=2)
    return np.asarray(~np.any(below, axis=1) & ~np.any(above, axis=1) & np.any(w > 0, axis=(1, 2)))


def shares(sizes: Ints, weights: Floats, budget: int) -> Ints:
    """Return how many of ``sizes`` (k,) to take: in proportion to ``weights``, in all at most ``budget``.

    Examples
    --------
    >>> shares(np.array([10, 100, 100]), np.array([1.0, 1.0, 2.0]), 100).tolist()
    [10, 30, 60]
    """
    wanted = np.where(weights > 0, sizes, 0)
    if wanted.sum() <= budget:
        return wanted
    # Those that are used up first come first; from some place on all take the same share of their weight.
    known = np.flatnonzero(wanted)
    known = known[np.argsort(wanted[known] / weights[known], kind="stable")]
    full = np.cumsum(wanted[known]) - wanted[known]
    rest = np.cumsum(weights[known][::-1])[::-1]
    share = (budget - full) / rest
    last = np.flatnonzero(share * weights[known] < wanted[known])[0]
    exact = np.minimum(wanted, share[last] * weights)
    # What is lost by rounding goes to the next.
    return np.minimum(wanted, np.diff(np.floor(np.cumsum(exact) + 1e-9), prepend=0.0).astype(np.int64))


def _along_curve(xyz: Floats) -> NDArray[np.uint64]:
    """Return a number for each point: above, its place on a curve through the cells of a grid, and its index below.

    The curve is Morton's (1966, "A computer oriented geodetic data base").
    """
    low = np.array([xyz[:, k].min() for k in range(3)])
    width = max(float(max(xyz[:, k].max() - low[k] for k in range(3))), 1e-9)
    keys = np.empty(len(xyz), np.uint64)
    for start in range(0, len(xyz), PART):
        some = slice(start, start + PART)
        cell = ((xyz[some] - low) * ((1 << BITS) * (1 - 1e-9) / width)).astype(np.int64)
        code = _WIDENED[cell[:, 0]] | _WIDENED[cell[:, 1]] << np.uint64(1) | _WIDENED[cell[:, 2]] << np.uint64(2)
        keys[some] = code << np.uint64(32)
        keys[some] |= np.arange(start, start + len(cell), dtype=np.uint64)
    return keys


def _widened() -> NDArray[np.uint64]:
    """Return each number of BITS bits with two zeros between its bits."""
    numbers = np.arange(1 << BITS, dtype=np.uint64)
    one = np.uint64(1)
    return sum((((numbers >> np.uint64(k)) & one) << np.uint64(3 * k) for k in range(BITS)), np.zeros_like(numbers))


def _bits_reversed() -> Ints:
    """Return 0 .. BLOCK - 1 with their bits in reverse: every beginning is spread evenly (van der Corput 1935)."""
    bits = BLOCK.bit_length() - 1
    numbers = np.arange(BLOCK)
    return sum((((numbers >> k) & 1) << (bits - 1 - k) for k in range(bits)), np.zeros_like(numbers))


_WIDENED, _SPREAD = _widened(), _bits_reversed()

"""Height of a surface at map coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.geometry.cells import Cells, Place, refine_foot_points, tabulate
from geofit.splines import bspline
from geofit.splines.patch import Patch, Patches

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["PlanMap", "elevation", "plan_map"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: A place counts as inside up to so many times the size of the patch beyond its edge (1e-6 m on a kilometre).
RIM = 1e-9
#: Points in one batch of the general search, which handles every (point, cell) pair at once.
PAIRED = 50_000


def elevation(patches: Sequence[Patch], origin: Floats, outline: Floats | None, x: ArrayLike, y: ArrayLike) -> Floats:
    """Return the height of patches at map coordinates.

    Parameters
    ----------
    patches : sequence of Patch
        Any patches. Height fields, whose x and y follow the parameters (control points at the Greville
        abscissae), are found from their control points and answered directly; other patches by search.
    origin : (3,) array
        Offset that turns the patches' coordinates into map coordinates, metres.
    outline : (k, 2) array or None
        Plan polygon in map coordinates that ends the surface.
    x, y : array_like
        Easting and northing, metres; they broadcast.

    Returns
    -------
    array
        Elevation in metres; nan outside all patches or outside the outline. The boundary is inside.
        Where the surface is not single-valued, the highest.
    """
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    plan = np.stack([x.ravel() - origin[0], y.ravel() - origin[1]])
    height = np.full(plan.shape[1], -np.inf)
    fields, folded = Patches.of(patches).prepared(_sorted)
    for single, mapping in fields:
        _over_height_field(single, mapping, plan, height)
    if folded:
        _over_folds(folded, plan, height)
    height[np.isneginf(height)] = np.nan
    if outline is not None:
        known = np.flatnonzero(np.isfinite(height))
        height[known[~_inside(outline - origin[:2], plan[:, known])]] = np.nan
    return np.asarray((height + origin[2]).reshape(x.shape))


class PlanMap:
    """The affine map from parameters to plan of a height field: (x, y) = start + matrix @ (u, v)."""

    def __init__(self, start: Floats, matrix: Floats) -> None:
        self.start, self.matrix = start, matrix

    def parameters(self, plan: Floats) -> Floats:
        """Return (2, n) parameters of (2, n) plan coordinates."""
        return np.asarray(np.linalg.solve(self.matrix, plan - self.start[:, None]))


def plan_map(patch: Patch) -> PlanMap | None:
    """Return the map to the plan if the patch is a height field, else None.

    A patch is one if its weights are equal and the x, y of its control points are an affine image of the
    Greville abscissae, to 1e-12 of its size: then x and y are linear in u and v.
    """
    return patch.prepared(_plan_map)


def _plan_map(patch: Patch) -> PlanMap | None:
    if patch.weights is not None and np.ptp(patch.weights) > 1e-15 * np.abs(patch.weights).max():
        return None
    gu = bspline.greville(patch.knots_u, patch.degree[0])
    gv = bspline.greville(patch.knots_v, patch.degree[1])
    xy = patch.control[..., :2]
    along_u = (xy[-1, 0] - xy[0, 0]) / (gu[-1] - gu[0])
    along_v = (xy[0, -1] - xy[0, 0]) / (gv[-1] - gv[0])
    start = xy[0, 0] - along_u * gu[0] - along_v * gv[0]
    matrix = np.stack([along_u, along_v], axis=1)
    expected = start + gu[:, None, None] * along_u + gv[None, :, None] * along_v
    size = np.abs(xy).max() + np.ptp(xy, axis=(0, 1)).max()
    sides = np.linalg.norm(along_u) * np.linalg.norm(along_v)
    if np.abs(xy - expected).max() > 1e-12 * size or abs(np.linalg.det(matrix)) <= 1e-6 * sides:
        return None
    return PlanMap(start, matrix)


def _over_height_field(single: Patches, mapping: PlanMap, plan: Floats, height: Floats) -> None:
    u0, u1, v0, v1 = single[0].domain
    u, v = mapping.parameters(plan)
    rim_u, rim_v = RIM * (u1 - u0), RIM * (v1 - v0)
    inside = np.flatnonzero((u >= u0 - rim_u) & (u <= u1 + rim_u) & (v >= v0 - rim_v) & (v <= v1 + rim_v))
    if not len(inside):
        return
    cells = single.prepared(tabulate)
    z = cells.points(cells.locate(0, u[inside], v[inside]))[2]
    height[inside] = np.maximum(height[inside], z)


def _sorted(patches: Patches) -> tuple[list[tuple[Patches, PlanMap]], Patches]:
    """Return the height fields over the map, each by itself with its map, and all other patches together."""
    mapped = [(patch, plan_map(patch)) for patch in patches]
    return (
        [(Patches([patch]), mapping) for patch, mapping in mapped if mapping is not None],
        Patches(patch for patch, mapping in mapped if mapping is None),
    )


def _over_folds(patches: Patches, plan: Floats, height: Floats) -> None:
    """Walk in plan from every piece of the patches that may lie over a place, and keep the highest."""
    cells, flat, pieces = patches.prepared(tabulate), patches.prepared(_plan_cells), patches.prepared(_pieces)
    size = np.ptp(pieces.high, axis=1).max()
    candidates = np.flatnonzero(
        (plan >= pieces.low.min(axis=1)[:, None]).all(axis=0) & (plan <= pieces.high.max(axis=1)[:, None]).all(axis=0)
    )
    for k in range(0, len(candidates), PAIRED):
        batch = candidates[k : k + PAIRED]
        point, piece = pieces.pairs(plan[:, batch])
        if not point.size:
            continue
        target = np.zeros((3, len(point)))
        target[:2] = plan[:, batch][:, point]
        end = refine_foot_points(flat, pieces.place[piece], target)
        off = np.linalg.norm(flat.points(end) - target, axis=0)
        hit = off <= RIM * size
        np.maximum.at(height, batch[point[hit]], cells.points(end[hit])[2])


def _plan_cells(patches: Patches) -> Cells:
    return tabulate(patches, axes=(0, 1))


class _Pieces:
    """Small pieces of patches: boxes in plan that hold them, a place in the middle, and a grid of bins."""

    def __init__(self, place: Place, low: Floats, high: Floats) -> None:
        self.place, self.low, self.high = place, low, high
        count = low.shape[1]
        self._bins = max(1, int(np.sqrt(count)))
        self._start = low.min(axis=1)
        self._width = np.maximum((high.max(axis=1) - self._start) / self._bins, 1e-300)
        first = self._bin(low)
        last = self._bin(high)
        across = last - first + 1
        number = across[0] * across[1]
        piece = np.repeat(np.arange(count), number)
        turn = np.arange(len(piece)) - np.repeat(np.cumsum(number) - number, number)
        i = first[0, piece] + turn // across[1, piece]
        j = first[1, piece] + turn % across[1, piece]
        order = np.argsort(i * self._bins + j, kind="stable")
        self._members = piece[order]
        self._ends = np.searchsorted((i * self._bins + j)[order], np.arange(self._bins**2 + 1))

    def _bin(self, plan: Floats) -> Ints:
        index = np.floor((plan - self._start[:, None]) / self._width[:, None]).astype(np.int64)
        return np.asarray(np.clip(index, 0, self._bins - 1))

    def pairs(self, plan: Floats) -> tuple[Ints, Ints]:
        """Return the indices of points and of the pieces whose box holds them."""
        i, j = self._bin(plan)
        first, last = self._ends[i * self._bins + j], self._ends[i * self._bins + j + 1]
        number = last - first
        point = np.repeat(np.arange(plan.shape[1]), number)
        turn = np.arange(len(point)) - np.repeat(np.cumsum(number) - number, number)
        piece = self._members[first[point] + turn]
        within = ((plan[:, point] >= self.low[:, piece]) & (plan[:, point] <= self.high[:, piece])).all(axis=0)
        return point[within], piece[within]


def _pieces(patches: Patches) -> _Pieces:
    """Quarter every cell (single cells finer) and box the pieces, with room for what bulges over the box."""
    flat = patches.prepared(_plan_cells)
    count = len(flat.patch)
    steps = int(np.clip(np.ceil(np.sqrt(4000 / count)), 2, 16))
    edge = np.linspace(-1, 1, 2 * steps + 1)
    local = np.stack(np.meshgrid(edge, edge, indexing="ij")).reshape(2, -1)
    grid = Place(np.repeat(np.arange(count), local.shape[1]), np.tile(local, count))
    xy = flat.points(grid)[:2].reshape(2, count, len(edge), len(edge))
    corners = [xy[:, :, a : a + 2 * steps - 1 : 2, b : b + 2 * steps - 1 : 2] for a in range(3) for b in range(3)]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    middle = np.stack(np.meshgrid(edge[1::2], edge[1::2], indexing="ij")).reshape(2, -1)
    room = 0.25 * (high - low).max(axis=0) + 1e-9 * np.abs(xy).max()
    place = Place(np.repeat(np.arange(count), steps**2), np.tile(middle, count))
    return _Pieces(place, (low - room).reshape(2, -1), (high + room).reshape(2, -1))


def _inside(outline: Floats, plan: Floats) -> NDArray[np.bool_]:
    import shapely

    polygon: Polygon = shapely.Polygon(outline).buffer(RIM * np.ptp(outline, axis=0).max(), join_style="mitre")
    shapely.prepare(polygon)
    return np.asarray(shapely.intersects_xy(polygon, plan[0], plan[1]))

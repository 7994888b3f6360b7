"""Horizons that a fault cuts: each block fitted apart, and the displacement along the fault.

A fault is a surface (fitted over its best plane) or its trace in plan. The points of a horizon are split by the side of
each fault they lie on; each block's surface ends where it meets the fault, so that on an inclined fault the blocks end
at two different lines, with the heave between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.errors import FitError, InputError, SettingsError
from geofit.pipeline import fit_horizon
from geofit.points import PointSet
from geofit.progress import Progress, tell
from geofit.settings import FitSettings
from geofit.site import Site
from geofit.stack.relief import Relief
from geofit.stack.zero_lines import zero_lines
from geofit.surface import HorizonSurface
from geofit.words import Said, said

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

__all__ = ["BlockFit", "FaultCut", "fit_blocks", "fit_faulted"]

Floats = NDArray[np.float64]
Height = Callable[[Floats, Floats], Floats]
Sides = tuple[int, ...]

#: Points that a block needs to bend by itself; below three there is no surface at all.
FEW, FEWEST = 6, 3
#: Cells along the longer side of the lattice on which a fault is traced.
CELLS = 40
#: Halvings of a cell's edge where it meets a fault: 24 leave 2e-6 m of 30 m.
HALVINGS = 24
#: How far a block's surface is laid beyond its fault, as a share of the area's longer side, before it is cut there.
BEYOND = 0.1
#: Places along a fault at which the throw is measured.
PLACES = 50


@dataclass(frozen=True, eq=False)
class FaultCut:
    """The displacement of one horizon along one fault, between two blocks.

    ``trace`` (k, 3) runs midway between the ends of both blocks in map coordinates, ``distance`` (k,) along it in
    metres, and ``throw`` (k,) is the elevation of the block ``up`` minus that of the block ``down`` there: positive
    on average, negative where the fault's sense is turned round. ``heave`` (k,) is the horizontal distance between
    the two blocks' ends, negative where they overlap in plan (a reverse fault), nan at the area's edge.
    """

    fault: str
    horizon: str
    up: str
    down: str
    trace: Floats
    distance: Floats
    throw: Floats
    heave: Floats

    @property
    def text(self) -> Said:
        """The throw in words."""
        return said(
            "{fault} throws {horizon} down by {low:.2f} to {high:.2f} m, {mean:.2f} m on average over {length:.0f} m: "
            "{up} lies above {down}",
            fault=self.fault, horizon=self.horizon, low=float(self.throw.min()), high=float(self.throw.max()),
            mean=float(self.throw.mean()), length=float(self.distance[-1]), up=self.up, down=self.down,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class BlockFit:
    """The blocks of a faulted horizon, each trimmed at its faults, and what the faults displace.

    ``block`` (n,) is the number of the block of each point, -1 where it is in none.
    """

    blocks: tuple[HorizonSurface, ...]
    block: NDArray[np.int64]
    cuts: tuple[FaultCut, ...]
    notes: tuple[str, ...]


def fit_faulted(site: Site, name: str, progress: Progress | None = None) -> BlockFit:
    """Fit the faults that cut a horizon of a site (``site.faults``), then the horizon block by block.

    Raises
    ------
    InputError
        If the site has no such horizon, or no fault that cuts it.
    FitError, SettingsError
        As :func:`fit_blocks`.
    """
    if name not in site.horizons:
        raise InputError(f"There is no horizon '{name}'", f"The horizons are: {', '.join(site.horizons)}.")
    cutting = [fault for fault, cut in site.faults.items() if name in cut]
    if not cutting:
        raise InputError(f"No fault of the site cuts '{name}'", f'Write F1 = ["{name}"] under [faults].')
    faults = []
    for k, fault in enumerate(cutting):
        tell(progress, f"fault {fault}", 0.5 * k / len(cutting))
        settings = site.settings.get(fault, FitSettings())
        faults.append(fit_horizon(site.horizons[fault], settings, site.boundary, name=fault))
    settings = site.settings.get(name, FitSettings())
    return fit_blocks(site.horizons[name], faults, settings, site.boundary, name=name, progress=progress)


def fit_blocks(
    points: PointSet,
    faults: Sequence[HorizonSurface | ArrayLike],
    settings: FitSettings | None = None,
    boundary: ArrayLike | None = None,
    *,
    name: str = "horizon",
    progress: Progress | None = None,
) -> BlockFit:
    """Fit a horizon apart on each side of its faults, and measure how far they displace it.

    Parameters
    ----------
    points : PointSet
        All points of the horizon.
    faults : sequence of HorizonSurface or (k, 2) array_like
        Steep surfaces, or traces in plan (map coordinates), which are continued straight at their ends.
    settings : FitSettings, optional
        Of each block's fit.
    boundary : (k, 2) array_like, optional
        Corners of the study area; without it, of the points' rectangle.
    name : str
        Name of the horizon; its blocks are called "NAME (A)", "NAME (B)", ...
    progress : callable, optional
        Called as ``progress(stage, fraction)``.

    Returns
    -------
    BlockFit
        Blocks, the larger ones first. A fault that leaves all points on one side does not cut; a note says so.

    Raises
    ------
    FitError
        If a block has fewer than three points, or a fault ends before it parts the area.
    SettingsError
        If a fault is neither a surface nor a line in plan.

    Notes
    -----
    A fault that dies out inside the area is continued through it: its throw there is what the blocks' data say.
    """
    import shapely

    corners = _corners(points, boundary)
    area = shapely.Polygon(corners)
    known = [_Fault.of(fault, k, area) for k, fault in enumerate(faults)]
    sides = [fault.side(points.xyz) for fault in known]
    notes: list[str] = []
    cutting = []
    for fault, side in zip(known, sides, strict=True):
        if side.min() == side.max():
            notes.append(said("all points of {horizon} lie on one side of {fault}", horizon=name, fault=fault.name))
        else:
            cutting.append((fault, side))
    key = np.column_stack([side for _, side in cutting]) if cutting else np.zeros((len(points), 0), np.int64)
    signs, block, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(-count, kind="stable")
    rank = np.argsort(order)
    block = rank[block.ravel()]
    blocks: dict[Sides, _Block] = {}
    for k, row in enumerate(signs[order].tolist()):
        title = f"{name} ({chr(ord('A') + k)})" if len(signs) > 1 else name
        part = points[np.flatnonzero(block == k)]
        if len(part) < FEWEST:
            text = said(
                "Too few points in the block '{block}' of {horizon}: {count} ({points}); at least {least} are needed "
                "to lay a surface. Give more points there, or leave the fault out.",
                block=title,
                horizon=name,
                count=len(part),
                points="; ".join(part.describe(i) for i in range(len(part))),
                least=FEWEST,
            )
            raise FitError(text)
        if len(part) < FEW:
            notes.append(said("{block} rests on {count} points only", block=title, count=len(part)))
        tell(progress, f"block {title}", 0.5 + 0.5 * k / len(signs))
        blocks[tuple(row)] = _Block.fit(title, part, [f for f, _ in cutting], tuple(row), settings, area)
    cuts = []
    for (first, one), (second, two) in combinations(blocks.items(), 2):
        differing = [k for k in range(len(cutting)) if first[k] != second[k]]
        if len(differing) == 1:
            cut = _displacement(differing[0], [fault for fault, _ in cutting], name, one, two, area)
            cuts += [cut] if cut is not None else []
    return BlockFit(tuple(one.surface for one in blocks.values()), block, tuple(cuts), tuple(notes))


def _corners(points: PointSet, boundary: ArrayLike | None) -> Floats:
    if boundary is not None:
        return np.asarray(boundary, float)
    (x0, y0), (x1, y1) = points.xyz[:, :2].min(axis=0), points.xyz[:, :2].max(axis=0)
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def _longer(line: Floats, length: float) -> Floats:
    """Return a line continued straight at both ends."""
    first, last = line[0] - line[1], line[-1] - line[-2]
    start, end = (length * way / np.linalg.norm(way) for way in (first, last))
    return np.vstack([line[0] + start, line, line[-1] + end])


class _Fault:
    """A fault, as a surface or as the part of the plan on the left of its trace."""

    def __init__(self, name: str, surface: HorizonSurface | None, left: Polygon | None) -> None:
        self.name, self._surface, self._left = name, surface, left

    @classmethod
    def of(cls, fault: HorizonSurface | ArrayLike, number: int, area: Polygon) -> _Fault:
        """Return the fault of a surface or of a trace in plan."""
        if isinstance(fault, HorizonSurface):
            return cls(fault.name, fault, None)
        line = np.asarray(fault, float)
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2 or not np.isfinite(line).all():
            raise SettingsError(
                f"Fault {number + 1} has shape {line.shape}; a fitted surface or at least two (easting, northing) "
                "corners of its trace are needed."
            )
        return cls(f"fault {number + 1}", None, _left_of(line, area))

    def side(self, xyz: Floats) -> NDArray[np.int64]:
        """Return (n,) on which side places lie: 1 above or left of the fault, else 0."""
        import shapely

        if self._surface is not None:
            return (self._surface.distance(xyz) > 0).astype(np.int64)
        assert self._left is not None
        return np.asarray(shapely.intersects_xy(self._left, xyz[:, 0], xyz[:, 1])).astype(np.int64)

    def traces(self, area: Polygon, height: Height) -> list[Floats]:
        """Return the lines (k, 2) in plan along which a surface over an area meets the fault."""
        import shapely

        if self._left is not None:
            edge = shapely.intersection(self._left.exterior, shapely.buffer(area, 0.01 * _size(area)))
            return [shapely.get_coordinates(line) for line in shapely.get_parts(shapely.line_merge(edge))]
        plan = _lattice(area)

        def above(x: Floats, y: Floats) -> Floats:
            z = height(x, y)
            value = np.full(x.shape, np.nan)
            known = np.isfinite(z)
            value[known] = self.side(np.column_stack([x[known], y[known], z[known]])) - 0.5
            return value

        value = above(plan[..., 0].ravel(), plan[..., 1].ravel()).reshape(plan.shape[:2])
        return zero_lines(plan, value, above, HALVINGS)


def _left_of(line: Floats, area: Polygon) -> Polygon:
    """Return the part of a wide box around an area on the left of a trace, continued straight at both ends."""
    import shapely
    from shapely.ops import split

    (x0, y0, x1, y1) = area.bounds
    size = max(x1 - x0, y1 - y0) + float(np.abs(line - (x0, y0)).max())
    whole = _longer(line, 10 * size)
    parts = split(shapely.box(x0 - size, y0 - size, x1 + size, y1 + size), shapely.LineString(whole)).geoms
    way = line[1] - line[0]
    beside = (line[0] + line[1]) / 2 + 1e-6 * size * np.array([-way[1], way[0]]) / np.linalg.norm(way)
    return next(part for part in parts if isinstance(part, shapely.Polygon) and part.intersects(shapely.Point(*beside)))


@dataclass(frozen=True, eq=False)
class _Block:
    """One block: its surface, trimmed at the faults, and the whole of it as a relief."""

    signs: Sides
    surface: HorizonSurface
    relief: Relief

    @classmethod
    def fit(
        cls,
        title: str,
        points: PointSet,
        faults: Sequence[_Fault],
        signs: Sides,
        settings: FitSettings | None,
        area: Polygon,
    ) -> _Block:
        """Fit a block to somewhat beyond its faults, then cut it where its surface meets them."""
        import shapely

        centre = points.xyz.mean(axis=0)
        slope = np.linalg.lstsq((points.xyz - centre)[:, :2], points.xyz[:, 2] - centre[2], rcond=None)[0]

        def plane(x: Floats, y: Floats) -> Floats:
            return np.asarray(centre[2] + slope[0] * (x - centre[0]) + slope[1] * (y - centre[1]))

        guess = _cut(area, plane, faults, signs, title)
        widened = _largest(shapely.intersection(shapely.buffer(guess, BEYOND * _size(area), join_style="mitre"), area))
        surface = fit_horizon(points, settings, shapely.get_coordinates(widened.exterior)[:-1], name=title)
        relief = Relief(surface)
        held = _largest(shapely.intersection(area, relief.area()))
        outline = _cut(held, relief, faults, signs, title)
        return cls(signs, surface.with_(outline=shapely.get_coordinates(outline.exterior)[:-1]), relief)


def _cut(area: Polygon, height: Height, faults: Sequence[_Fault], signs: Sides, title: str) -> Polygon:
    """Return the part of an area where a surface lies on the given side of every fault."""
    import shapely
    from shapely.ops import split

    part = area
    # A surface ends at the area's edge, and so its trace up to one cell before it: it is continued straight.
    for fault, sign in zip(faults, signs, strict=True):
        pieces = [part]
        for line in fault.traces(area, height):
            whole = _longer(line, 3 * _size(area) / CELLS)
            cut = (one for piece in pieces for one in split(piece, shapely.LineString(whole)).geoms)
            pieces = [one for one in cut if isinstance(one, shapely.Polygon)]
        inner = shapely.get_coordinates([shapely.point_on_surface(piece) for piece in pieces])
        side = fault.side(np.column_stack([inner, height(*inner.T)]))
        mine = [piece for piece, one in zip(pieces, side, strict=True) if one == sign]
        if not mine:
            text = said(
                "The block '{block}' has points on a side of {fault} where its surface has no area. Look at the points "
                "beside the fault: one on the wrong side makes a block of its own.",
                block=title,
                fault=fault.name,
            )
            raise FitError(text)
        part = max(mine, key=shapely.area)
    return part


def _largest(shape: BaseGeometry) -> Polygon:
    """Return the largest polygon of what an intersection left."""
    import shapely

    return max((part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon)), key=shapely.area)


def _lattice(area: Polygon) -> Floats:
    """Return (nu, nv, 2) nodes of square cells that reach just beyond an area."""
    x0, y0, x1, y1 = area.bounds
    step = max(x1 - x0, y1 - y0) / CELLS
    x, y = (np.arange(low - 0.5 * step, high + step, step) for low, high in ((x0, x1), (y0, y1)))
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def _size(area: Polygon) -> float:
    x0, y0, x1, y1 = area.bounds
    return float(max(x1 - x0, y1 - y0))


def _displacement(
    number: int, faults: Sequence[_Fault], horizon: str, one: _Block, two: _Block, area: Polygon
) -> FaultCut | None:
    """Measure throw and heave between two blocks along one fault; None where they do not meet."""
    import shapely

    fault = faults[number]

    def middle(x: Floats, y: Floats) -> Floats:
        return np.asarray((one.relief(x, y) + two.relief(x, y)) / 2)

    lines = [
        part
        for line in fault.traces(area, middle)
        for part in shapely.get_parts(
            shapely.intersection(shapely.LineString(_longer(line, 3 * _size(area) / CELLS)), area)
        )
        if part.geom_type == "LineString"
    ]
    if not lines:
        return None
    line = max(lines, key=shapely.length)
    distance = np.linspace(0, line.length, PLACES)
    plan = shapely.get_coordinates(shapely.line_interpolate_point(line, distance))
    trace = np.column_stack([plan, middle(*plan.T)])
    # Where a further fault parts the two blocks from this place, they do not meet here.
    meets = np.isfinite(trace[:, 2])
    for k, other in enumerate(faults):
        if k != number:
            meets[meets] &= other.side(trace[meets]) == one.signs[k]
    if meets.sum() < 2:
        return None
    trace, distance = trace[meets], distance[meets] - distance[meets][0]
    throw = one.relief(*trace[:, :2].T) - two.relief(*trace[:, :2].T)
    heave = _heave(fault, number, one, two, trace[:, :2], 0.5 * BEYOND * _size(area))
    upper, lower = (one, two) if throw.mean() >= 0 else (two, one)
    throw = throw if upper is one else -throw
    return FaultCut(fault.name, horizon, upper.surface.name, lower.surface.name, trace, distance, throw, heave)


def _heave(fault: _Fault, number: int, one: _Block, two: _Block, plan: Floats, reach: float) -> Floats:
    """Return (k,) the distance in plan, across the trace, from the end of one block to that of the other."""
    way = np.gradient(plan, axis=0)
    across = np.column_stack([-way[:, 1], way[:, 0]]) / np.linalg.norm(way, axis=1)[:, None]
    ends = []
    for block in (one, two):

        def side(off: Floats, block: _Block = block) -> NDArray[np.int64]:
            place = plan + off[:, None] * across
            return fault.side(np.column_stack([place, np.nan_to_num(block.relief(*place.T))]))

        low, high = np.full(len(plan), -reach), np.full(len(plan), reach)
        first = side(low)
        for _ in range(HALVINGS):
            half = (low + high) / 2
            same = side(half) == first
            low, high = np.where(same, half, low), np.where(same, high, half)
        end = (low + high) / 2
        known = np.isfinite(block.relief(*(plan + end[:, None] * across).T)) & (np.abs(end) < 0.99 * reach)
        ends.append(np.where(known, end, np.nan))
    # The block whose side lies across the trace begins where the other ends.
    ahead = side(np.full(len(plan), reach)) == one.signs[number]
    return np.where(ahead, ends[0] - ends[1], ends[1] - ends[0])

"""Where the upper of two horizons lies below the lower one: found, measured, drawn.

Two height fields have no common knots, so the thickness is looked at on two lattices, one after the knots of each
surface: where either of them can bend, one lattice is fine. From each local minimum a continuous search walks down;
a crossing that lies within one cell is found by it. Around a crossing the lattice is refined until area and volume
are settled, and the lines of crossing are exact on its edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Ground
from geofit.site.height_field import HeightField, onto
from geofit.site.presence import presence_of
from geofit.site.zero_contours import lattice_triangles, zero_contours
from geofit.surfaces.below_ground import below_ground

if TYPE_CHECKING:
    from shapely import Geometry

__all__ = ["TOUCH", "HorizonCrossing", "LayerSize", "Overlap"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Extreme = tuple[float, float, float]

#: Horizons that overlap by less than this (metres) touch; rounding makes no crossing.
TOUCH = 1e-6
#: Pieces of a knot span on the lattices that look for crossings.
PIECES = 2
#: Nodes in the continuous search's window, its shrinking a step, and its last width in metres.
WINDOW, SHRINK, CLOSE = 9, 0.3, 1e-5
#: Continuous searches a lattice at most, the most promising ones.
STARTS = 500
#: Nodes below zero that settle area and volume (to some 0.1 %), and how fine a cell may be cut for them.
ENOUGH, FINEST = 4_000, 64
#: More room than this for a layer below the ground is enough, metres.
ROOM = 1e3
#: Nodes of one window at most, and of the one for the mean thickness.
MOST, MANY = 2_000_000, 100_000


@dataclass(frozen=True, eq=False)
class HorizonCrossing:
    """One place where the upper horizon lies below the lower one.

    ``area`` (m2) and ``volume`` (m3) of the overlap; ``x``, ``y`` and ``depth`` (m) of its deepest place; ``lines``
    (k, 3) in map coordinates along which the horizons cross, ending at the edge of their common area or where they
    began. ``in_air`` is the share of the overlap above the ground, where neither horizon is any more (nan without a
    ground).
    """

    area: float
    volume: float
    x: float
    y: float
    depth: float
    lines: tuple[Floats, ...]
    in_air: float


@dataclass(frozen=True)
class LayerSize:
    """How much lies between two horizons: ``volume`` in m3, and the area where it is ``present``, m2.

    Where holes met both horizons at one contact, ``without`` of them, the area is at least that of the triangles of
    holes that all have the layer, and at most that of all triangles but those of holes that all lack it; else all three
    areas are one, and ``doubtful`` (m3), the volume over the triangles of holes that all lack it, is 0. ``disputed``
    (m3) is what another horizon claims of the volume.
    """

    volume: float
    present: float
    at_least: float
    at_most: float
    without: int
    doubtful: float
    disputed: float


@dataclass(frozen=True, eq=False)
class _Window:
    """Nodes of a lattice (nu, nv, 2) and the thickness at them (nu, nv): nan beyond the common area."""

    plan: Floats
    value: Floats

    def integrals(self, label: NDArray[Any], count: int) -> tuple[Floats, Floats]:
        """Return area and volume below zero by the label (1 to count) of the nodes; the thickness linear a triangle."""
        triangles = lattice_triangles((self.value.shape[0], self.value.shape[1]))
        value, plan = self.value.ravel()[triangles], self.plan.reshape(-1, 2)[triangles]
        touched = np.isfinite(value).all(axis=1) & (value < 0).any(axis=1)
        value, plan = value[touched], plan[touched]
        owner = np.where(value < 0, label.ravel()[triangles[touched]], 0).max(axis=1)
        size = _signed(plan)
        area, volume = _below(value)
        sums = [np.bincount(owner, weights=size * share, minlength=count + 1)[1:] for share in (area, -volume)]
        return np.asarray(sums[0], float), np.asarray(sums[1], float)


class Overlap:
    """The thickness between two reliefs over the area that both stand over."""

    def __init__(self, upper: HeightField, lower: HeightField, area: Geometry) -> None:
        self.upper, self.lower, self.area = upper, lower, area

    @classmethod
    def between(cls, upper: HeightField, lower: HeightField) -> Overlap | None:
        """Return the overlap of two reliefs, None if they share no area."""
        import shapely

        area = shapely.intersection(upper.area(), lower.area())
        if not shapely.area(area) > 0:
            return None
        shapely.prepare(area)
        return cls(upper, lower, area)

    def __call__(self, x: Floats, y: Floats) -> Floats:
        """Return upper minus lower elevation, metres, nan where either is absent."""
        return self.upper(x, y) - self.lower(x, y)

    def over(self, x: Floats, y: Floats) -> Floats:
        """Return what is below zero where the upper horizon lies more than TOUCH below the lower one."""
        return self(x, y) + TOUCH

    @property
    def size(self) -> float:
        """The common area, m2."""
        import shapely

        return float(shapely.area(self.area))

    @property
    def mean(self) -> float:
        """Mean thickness over the common area, metres."""
        return _mean(self._fine_upper)

    def layer(
        self, ground: Ground | None, least: float, above: Sequence[HeightField] = (), below: Sequence[HeightField] = ()
    ) -> LayerSize:
        """Return how much lies between the horizons, below the ground.

        Where the upper one lies below the lower one there is nothing. Disputed is what lies over a horizon that should
        be ``above`` both, or under one that should be ``below`` them.
        """
        window = self._fine_upper
        known = np.isfinite(window.value)
        plan = window.plan[known]
        top = self.upper(*plan.T)
        low = top - window.value[known]
        top, low = (below_ground(z, plan[:, 0], plan[:, 1], ground) for z in (top, low))
        cap, floor = top, low
        for one in above:
            cap = np.fmin(cap, one(*plan.T))
        for one in below:
            floor = np.fmax(floor, one(*plan.T))
        triangles = lattice_triangles((window.value.shape[0], window.value.shape[1]))
        whole = known.ravel()[triangles].all(axis=1)
        triangles = triangles[whole]
        corners = window.plan.reshape(-1, 2)[triangles]
        size = _signed(corners)

        def over(thickness: Floats, least: float = 0.0) -> tuple[Floats, Floats]:
            """Return the area of each triangle where it is thicker than ``least``, m2, and the volume beyond, m3."""
            value = np.full(window.value.shape, np.nan)
            value[known] = thickness
            value = value.ravel()[triangles]
            # Triangles without any of it are left out: shares are known for those that have a part.
            some = (value > least).any(axis=1)
            found = np.zeros((2, len(size)))
            found[:, some] = size[some] * np.abs(_below(least - value[some]))
            return found[0], found[1]

        volumes = over(top - low)[1]
        volume = float(volumes.sum())
        disputed = volume - float(over(cap - floor)[1].sum()) if len(above) or len(below) else 0.0
        thick = over(top - low, least)[0]
        seen = presence_of(self.upper.points, self.lower.points)
        if seen is None:
            present = float(thick.sum())
            return LayerSize(volume, present, present, present, 0, 0.0, max(disputed, 0.0))
        middle = corners.mean(axis=1)
        having, lacking = seen.around(middle)
        here = having | (seen.nearest(middle) & ~lacking)
        room = over(self._room(plan, ground))[0]
        return LayerSize(
            volume=volume,
            present=float(thick[here].sum()),
            at_least=float(thick[having].sum()),
            at_most=float(room[~lacking].sum()),
            without=seen.without,
            doubtful=float(volumes[lacking].sum()),
            disputed=max(disputed, 0.0),
        )

    def _room(self, plan: Floats, ground: Ground | None) -> Floats:
        """Return how far the ground lies above the lower horizon at (n, 2) places, metres, at most ROOM."""
        over = np.full(len(plan), np.nan) if ground is None else ground.elevation(*plan.T)
        return np.clip(np.where(np.isnan(over), np.inf, over) - self.lower(*plan.T), -ROOM, ROOM)

    @cached_property
    def _fine_upper(self) -> _Window:
        return self._finer(self.upper)

    @property
    def thinnest(self) -> Extreme:
        """Place (x, y) of the least thickness, and the thickness there, metres."""
        x, y, value = self._extremes[0][self._extremes[0][:, 2].argmin()].tolist()
        return x, y, value

    @property
    def thickest(self) -> Extreme:
        """Place (x, y) of the largest thickness, and the thickness there, metres."""
        x, y, value = self._extremes[1][self._extremes[1][:, 2].argmin()].tolist()
        return x, y, -value

    @cached_property
    def _windows(self) -> tuple[_Window, _Window]:
        coarse = self.window(self.upper.lattice(PIECES)), self.window(self.lower.lattice(PIECES))
        if np.isfinite(np.concatenate([window.value.ravel() for window in coarse])).any():
            return coarse
        # The common area lies between the nodes of both lattices.
        return self._finer(self.upper), self._finer(self.lower)

    def _finer(self, field: HeightField) -> _Window:
        """Return the thickness on the part of a field's lattice around the common area, its cells cut."""
        import shapely

        plan = field.lattice(PIECES)
        x0, y0, x1, y1 = shapely.bounds(self.area)
        at = np.argwhere(_holding(plan, np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])))
        (i, j), (last_i, last_j) = at.min(axis=0), at.max(axis=0)
        plan = plan[i : last_i + 2, j : last_j + 2]
        return self.window(_between(plan, int(np.ceil(np.sqrt(MANY / plan[..., 0].size)))))

    @cached_property
    def _extremes(self) -> tuple[Floats, Floats]:
        """Local minima of the thickness, and of its negative: (n, 3) x, y, value."""
        starts = [_extremes(window, sign) for sign in (1.0, -1.0) for window in self._windows]
        sign = np.repeat([1.0, 1.0, -1.0, -1.0], [len(place) for place, _ in starts])
        place, reach = (np.concatenate(parts) for parts in zip(*starts, strict=True))
        found = self._minimize(place, reach, sign)
        return found[sign > 0], found[sign < 0]

    def nodes(self) -> Floats:
        """Return (n, 2) nodes of both lattices on the common area."""
        return np.concatenate([window.plan[np.isfinite(window.value)] for window in self._windows])

    def below(self) -> Floats:
        """Return (n, 2) places below zero: of the nodes of both lattices, and of the local minima."""
        minima = self._extremes[0]
        nodes = [window.plan[window.value < -TOUCH] for window in self._windows]
        return np.concatenate([*nodes, minima[minima[:, 2] < -TOUCH, :2]])

    def window(self, plan: Floats, active: Bools | None = None) -> _Window:
        """Return the thickness on a lattice; nodes just beyond the common area are drawn onto its edge.

        Only the ``active`` nodes are looked at; those farther outside have no thickness, active or not.
        """
        import shapely

        plan = plan.copy()
        inside = shapely.intersects_xy(self.area, plan[..., 0], plan[..., 1])
        near = _dilated(inside)
        if active is not None:
            near &= active
        edge = near & ~inside
        plan[edge] = onto(self.area, plan[edge])
        value = np.full(inside.shape, np.nan)
        value[near] = self(*plan[near].T)
        return _Window(plan, value)

    def _minimize(self, place: Floats, reach: Floats, sign: Floats) -> Floats:
        """Look in ever smaller windows around (n, 2) places for the least of sign (n,) * thickness; return (n, 3)."""
        steps = np.linspace(-1, 1, WINDOW)
        offset = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        best = np.column_stack([place, sign * self(*place.T)])
        width = reach.copy()
        while len(best) and width.max() > CLOSE:
            around = best[:, None, :2] + width[:, None, None] * offset
            around = onto(self.area, around.reshape(-1, 2)).reshape(around.shape)
            value = sign[:, None] * self(around[..., 0], around[..., 1])
            least = value.argmin(axis=1)
            rows = np.arange(len(best))
            lower = value[rows, least] < best[:, 2]
            best[lower] = np.column_stack([around[rows, least], value[rows, least]])[lower]
            width *= SHRINK
        return best

    def crossings(self, ground: Ground | None = None) -> tuple[HorizonCrossing, ...]:
        """Return the crossings, the largest volume first; a ground shows which of them lie above it."""
        plan = self.upper.lattice(PIECES)
        # Gather the cells around all that lies below zero, in groups.
        active = _dilated(_holding(plan, self.below()))
        while True:
            spread = active.copy()
            for box, mine, fine, pieces in self._groups(plan, active):
                # Where an overlap reaches the rim of the cells that were cut, those beyond it belong to it too.
                spread[box] |= _dilated(_touched(np.argwhere(fine.value < -TOUCH), pieces, mine.shape))
            if np.array_equal(spread, active):
                break
            active = spread
        # To cut the cells once more takes less time than to measure in each round, and less memory than to keep them.
        found = [one for _, _, fine, _ in self._groups(plan, active) for one in self._measured(fine, ground)]
        return tuple(sorted(found, key=lambda one: -one.volume))

    def _groups(self, plan: Floats, active: Bools) -> Iterator[tuple[tuple[slice, ...], Bools, _Window, int]]:
        """Return each group of active cells: its box, which cells of the box, its window, the pieces of a cell."""
        from scipy.ndimage import find_objects, label

        groups, _ = label(active, np.ones((3, 3)))
        for number, tight in enumerate(find_objects(groups), start=1):
            box = _wider(tight)
            mine = groups[box] == number
            yield box, mine, *self._fine(plan[box[0].start : box[0].stop + 1, box[1].start : box[1].stop + 1], mine)

    def _fine(self, plan: Floats, cells: Bools) -> tuple[_Window, int]:
        """Cut the wanted cells of a box until enough nodes lie below zero; return how many pieces that took."""
        pieces = 1
        while True:
            active = np.kron(cells, np.ones((pieces, pieces), bool))
            nodes = np.zeros((active.shape[0] + 1, active.shape[1] + 1), bool)
            for i in (slice(None, -1), slice(1, None)):
                for j in (slice(None, -1), slice(1, None)):
                    nodes[i, j] |= active
            window = self.window(_between(plan, pieces), nodes)
            enough = int((window.value < 0).sum()) >= ENOUGH
            if enough or pieces >= FINEST or 4 * nodes.size > MOST:
                return window, pieces
            pieces *= 2

    def _measured(self, window: _Window, ground: Ground | None) -> list[HorizonCrossing]:
        """Return the crossings in a window: each a connected part below zero."""
        from scipy.ndimage import find_objects, label

        below = np.nan_to_num(window.value, nan=1.0) < -TOUCH
        labels, count = label(below, np.ones((3, 3)))
        areas, volumes = _Window(window.plan, window.value + TOUCH).integrals(labels, count)
        found = []
        for k, box in enumerate(find_objects(labels)):
            box = _wider(box)
            part = _Window(window.plan[box], window.value[box])
            mine = labels[box] == k + 1
            at = np.argwhere(mine & (part.value == part.value[mine].min()))[:1]
            deep = self._minimize(part.plan[at[:, 0], at[:, 1]], _reach(part.plan, at), np.ones(1))[0]
            value = np.where(mine, part.value + TOUCH, np.maximum(part.value + TOUCH, 0.0))
            lines = zero_contours(part.plan, value, self.over)
            found.append(
                HorizonCrossing(
                    area=float(areas[k]),
                    volume=float(volumes[k]),
                    x=float(deep[0]),
                    y=float(deep[1]),
                    depth=float(-deep[2]),
                    lines=tuple(np.column_stack([line, self.upper(*line.T)]) for line in lines),
                    in_air=self._in_air(part.plan[mine], ground),
                )
            )
        return found

    def _in_air(self, plan: Floats, ground: Ground | None) -> float:
        if ground is None:
            return float("nan")
        top = ground.elevation(*plan.T)
        return float((self.upper(*plan.T) > top).mean())


def _extremes(window: _Window, sign: float) -> tuple[Floats, Floats]:
    """Return (n, 2) local minima of sign * thickness that may count, and how far their neighbours are, (n,)."""
    from scipy.ndimage import maximum_filter, minimum_filter

    height = sign * window.value
    low = minimum_filter(np.where(np.isnan(height), np.inf, height), 3, mode="nearest")
    high = maximum_filter(np.where(np.isnan(height), -np.inf, height), 3, mode="nearest")
    # Between its neighbours the thickness falls no further below a node than it rises around it.
    enough = max(float(low.min()), 0.0) if sign > 0 else float(low.min())
    with np.errstate(invalid="ignore"):
        wanted = (height == low) & (2 * height - high <= enough)
    at = np.argwhere(wanted)
    at = at[np.argsort(height[wanted], kind="stable")[:STARTS]]
    return window.plan[at[:, 0], at[:, 1]], _reach(window.plan, at)


def _signed(plan: Floats) -> Floats:
    """Return the (m,) areas of triangles (m, 3, 2): those that edge nodes have turned over count against the others."""
    first, second = plan[:, 1] - plan[:, 0], plan[:, 2] - plan[:, 0]
    return np.asarray(0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]))


def _mean(window: _Window) -> float:
    triangles = lattice_triangles((window.value.shape[0], window.value.shape[1]))
    value, plan = window.value.ravel()[triangles], window.plan.reshape(-1, 2)[triangles]
    known = np.isfinite(value).all(axis=1)
    size = _signed(plan[known])
    return float((size * value[known].mean(axis=1)).sum() / size.sum())


def _below(value: Floats) -> tuple[Floats, Floats]:
    """Return, as shares of triangles with linear values (m, 3), the area below zero and the integral over it."""
    value = np.sort(value, axis=1)
    a, b, c = value.T
    with np.errstate(divide="ignore", invalid="ignore"):
        # One corner below: a small triangle of the same shape; two: all but the one above; three: all.
        one = a**2 / ((a - b) * (a - c))
        rest = c**2 / ((c - a) * (c - b))
    mean = value.mean(axis=1)
    single, whole = (b >= 0), (c <= 0)
    area = np.where(whole, 1.0, np.where(single, one, 1 - rest))
    integral = np.where(whole, mean, np.where(single, one * a / 3, mean - rest * c / 3))
    return area, integral


def _dilated(mask: Bools) -> Bools:
    from scipy.ndimage import binary_dilation

    return np.asarray(binary_dilation(mask, np.ones((3, 3), bool)))


def _reach(plan: Floats, at: Ints) -> Floats:
    """Return (n,) how far the neighbours of nodes of a lattice are."""
    reach = np.zeros(len(at))
    for axis in (0, 1):
        for step in (-1, 1):
            other = at.copy()
            other[:, axis] = np.clip(other[:, axis] + step, 0, plan.shape[axis] - 1)
            gap = np.linalg.norm(plan[other[:, 0], other[:, 1]] - plan[at[:, 0], at[:, 1]], axis=1)
            reach = np.maximum(reach, gap)
    return reach


def _holding(plan: Floats, places: Floats) -> Bools:
    """Return (nu - 1, nv - 1): the cells of a lattice (tensor product of lines) that hold any of (n, 2) places."""
    start, along, across = plan[0, 0], plan[-1, 0] - plan[0, 0], plan[0, -1] - plan[0, 0]
    axes = np.column_stack([along, across])
    share = np.linalg.solve(axes, (places - start).T)
    lines = [np.linalg.solve(axes, (edge - start).T)[k] for k, edge in enumerate((plan[:, 0], plan[0]))]
    cells = np.zeros((plan.shape[0] - 1, plan.shape[1] - 1), bool)
    i, j = (
        np.clip(np.searchsorted(line, part, side="right") - 1, 0, len(line) - 2)
        for line, part in zip(lines, share, strict=True)
    )
    cells[i, j] = True
    return cells


def _between(plan: Floats, pieces: int) -> Floats:
    """Return the lattice with each cell cut into pieces x pieces."""
    for axis in (0, 1):
        plan = np.moveaxis(plan, axis, 0)
        share = (np.arange(pieces) / pieces)[:, None, None]
        inner = (plan[:-1, None] + np.diff(plan, axis=0)[:, None] * share).reshape(-1, *plan.shape[1:])
        plan = np.moveaxis(np.concatenate([inner, plan[-1:]]), 0, axis)
    return plan


def _wider(box: tuple[slice, ...]) -> tuple[slice, ...]:
    return tuple(slice(max(part.start - 1, 0), part.stop + 1) for part in box)


def _touched(nodes: Ints, pieces: int, shape: tuple[int, ...]) -> Bools:
    """Return the coarse cells (of ``shape``) that fine nodes (n, 2) touch."""
    cells = np.zeros(shape, bool)
    for step in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        at = (nodes + np.array(step)) // pieces
        held = ((at >= 0) & (at < np.array(shape))).all(axis=1)
        cells[at[held, 0], at[held, 1]] = True
    return cells

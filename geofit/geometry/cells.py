"""Patches as polynomial cells, and the descent to the nearest point on them. Pure functions over arrays.

Between two neighbouring knots a B-spline is one polynomial. Its coefficients are computed once for each cell
(span of u times span of v); evaluating a million points is then a gather and a Horner scheme, without the
recurrences. A cell has local coordinates s, t in [-1, 1]; all patches of a surface share one table of cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import NDArray

from geofit.data.threads import side_by_side
from geofit.splines import bspline
from geofit.splines.patch import Patch

__all__ = ["Cells", "Place", "refine_foot_points", "tabulate"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Points that are worked on together: their coefficients stay in the processor's cache.
BATCH = 4096
#: A quadratically converging step below this length (metres) leaves an error near its square.
LAST_STEP = 1e-7
#: The same for steps that converge linearly (singular or indefinite Hessian).
LAST_SLOW_STEP = 1e-9
MAX_STEPS = 80
#: From this many walks on, compiled loops are worth loading.
COMPILED = 5_000


@dataclass(frozen=True, eq=False)
class Cells:
    """Polynomial pieces of several patches.

    ``coefficients`` (q + 1, (p + 1) * d, cells): powers of t, then of s, then d = 3 coordinates (d = 4, with
    the weight, if any patch is rational). ``neighbour`` (4, cells): the cell beyond s = -1, s = 1, t = -1, t
    = 1, or -1 at the patch's edge. ``centre``, ``half`` (2, cells): middle and half width in u and v.
    ``patch`` (cells,). ``first`` and ``shape`` locate the cell (i, j) of a patch: first[patch] + i *
    shape[patch][1] + j. ``extent`` is the largest coordinate, metres: rounding errors are some 1e-16 of it.
    """

    coefficients: Floats
    dimension: int
    neighbour: Ints
    centre: Floats
    half: Floats
    patch: Ints
    breaks: tuple[tuple[Floats, Floats], ...]
    first: Ints
    shape: tuple[tuple[int, int], ...]
    extent: float

    @property
    def noise(self) -> float:
        """Rounding error of a distance, metres."""
        return 4e-15 * self.extent

    @cached_property
    def table(self) -> Floats:
        """Coefficients (cells, q + 1, p + 1, d), those of a cell next to each other."""
        q, rows, count = self.coefficients.shape
        whole = self.coefficients.reshape(q, rows // self.dimension, self.dimension, count)
        return np.ascontiguousarray(np.moveaxis(whole, 3, 0))

    def locate(self, patch: int, u: Floats, v: Floats) -> Place:
        """Return the cells and local coordinates of parameters of one patch, clamped to its domain."""
        (bu, bv), (_, nv) = self.breaks[patch], self.shape[patch]
        cell = self.first[patch] + bspline.intervals(bu, u) * nv + bspline.intervals(bv, v)
        local = (np.stack([u, v]) - self.centre.take(cell, axis=1)) / self.half.take(cell, axis=1)
        return Place(cell, local.clip(-1.0, 1.0))

    def parameters(self, place: Place) -> tuple[Floats, Floats]:
        """Return u, v of places."""
        u, v = self.centre[:, place.cell] + self.half[:, place.cell] * place.local
        return u, v

    def coordinate(self, axis: int) -> Cells:
        """Return the cells of one coordinate alone, of patches that are not rational; its jets are (1, n)."""
        one = np.ascontiguousarray(self.coefficients[:, axis :: self.dimension])
        return replace(self, coefficients=one, dimension=1)

    def points(self, place: Place) -> Floats:
        """Return positions (3, n) at places."""
        parts = [self._jet(place[k : k + BATCH], 0)[0] for k in range(0, max(len(place.cell), 1), BATCH)]
        return np.concatenate(parts, axis=1)

    def jets(self, place: Place) -> list[Floats]:
        """Return S, S_s, S_t, S_ss, S_st, S_tt at places, each (3, n), in local coordinates."""
        parts = [self._jet(place[k : k + BATCH], 2) for k in range(0, max(len(place.cell), 1), BATCH)]
        return [np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True)]

    def slopes(self, place: Place) -> tuple[Floats, Floats]:
        """Return S_s, S_t at places, each (3, n), in local coordinates."""
        parts = [self._jet(place[k : k + BATCH], 2)[1:3] for k in range(0, max(len(place.cell), 1), BATCH)]
        along, across = (np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True))
        return along, across

    def _jet(self, place: Place, order: int) -> list[Floats]:
        c = self.coefficients.take(place.cell, axis=2)
        s, t = place.local
        d = self.dimension
        rows = [row.reshape(c.shape[1] // d, d, len(s)) for row in _horner(c, t, order)]
        if order == 0:
            jet = [_horner(rows[0], s, 0)[0]]
        else:
            value, ds, dss = _horner(rows[0], s, 2)
            dt, dst, _ = _horner(rows[1], s, 2)
            jet = [value, ds, dt, dss, dst, _horner(rows[2], s, 0)[0]]
        return _quotients(jet) if d == 4 else jet


@dataclass(frozen=True, eq=False)
class Place:
    """Where points are on the cells: ``cell`` (n,), ``local`` (2, n) coordinates s, t."""

    cell: Ints
    local: Floats
    converged: Bools = field(default_factory=lambda: np.zeros(0, bool))

    def __getitem__(self, index: slice | Ints | Bools) -> Place:
        return Place(self.cell[index], self.local[:, index])

    @classmethod
    def join(cls, places: Sequence[Place]) -> Place:
        """Put places behind each other."""
        return cls(
            np.concatenate([place.cell for place in places]),
            np.concatenate([place.local for place in places], axis=1),
            np.concatenate([place.converged for place in places]),
        )


def tabulate(patches: Sequence[Patch], axes: tuple[int, ...] = (0, 1, 2)) -> Cells:
    """Return the cells of patches.

    Parameters
    ----------
    patches : sequence of Patch
        Any degrees, knots and weights.
    axes : tuple of int
        Coordinates that are kept; the others become 0 ((0, 1): the patch as seen in plan).
    """
    rational = any(patch.weights is not None and np.ptp(patch.weights) > 0 for patch in patches)
    p, q = (max(patch.degree[k] for patch in patches) for k in (0, 1))
    d = 4 if rational else 3
    tables, neighbours, centres, halves, owner, breaks, first, shape = [], [], [], [], [], [], [], []
    count = 0
    for index, patch in enumerate(patches):
        control = np.zeros((*patch.control.shape[:2], d))
        control[..., list(axes)] = patch.control[..., list(axes)]
        if rational:
            weights = np.ones(control.shape[:2]) if patch.weights is None else patch.weights
            control *= weights[..., None]
            control[..., 3] = weights
        start_u, to_u, bu = _taylor(patch.knots_u, patch.degree[0])
        start_v, to_v, bv = _taylor(patch.knots_v, patch.degree[1])
        rows = start_u[:, None] + np.arange(patch.degree[0] + 1)
        columns = start_v[:, None] + np.arange(patch.degree[1] + 1)
        half_way = np.einsum("iar,irmd->iamd", to_u, control[rows])
        local = np.einsum("jbc,iajcd->ijbad", to_v, half_way[:, :, columns], optimize=True)
        nu, nv = local.shape[:2]
        table = np.zeros((nu, nv, q + 1, p + 1, d))
        table[:, :, : patch.degree[1] + 1, : patch.degree[0] + 1] = local
        tables.append(table.reshape(nu * nv, q + 1, (p + 1) * d))
        neighbours.append(_neighbours(nu, nv, count))
        mid = [(b[1:] + b[:-1]) / 2 for b in (bu, bv)]
        width = [np.diff(b) / 2 for b in (bu, bv)]
        centres.append(np.stack([np.repeat(mid[0], nv), np.tile(mid[1], nu)]))
        halves.append(np.stack([np.repeat(width[0], nv), np.tile(width[1], nu)]))
        owner.append(np.full(nu * nv, index))
        breaks.append((bu, bv))
        first.append(count)
        shape.append((nu, nv))
        count += nu * nv
    return Cells(
        coefficients=np.ascontiguousarray(np.moveaxis(np.concatenate(tables), 0, 2)),
        dimension=d,
        neighbour=np.concatenate(neighbours, axis=1),
        centre=np.concatenate(centres, axis=1),
        half=np.concatenate(halves, axis=1),
        patch=np.concatenate(owner),
        breaks=tuple(breaks),
        first=np.array(first),
        shape=tuple(shape),
        extent=max(float(np.abs(patch.control).max()) for patch in patches),
    )


def refine_foot_points(cells: Cells, start: Place, target: Floats) -> Place:
    """Walk from places down to the nearest point of the surface, a local minimum of |S - target|.

    Newton's method on half the squared distance, with analytic second derivatives; where the Hessian is not
    positive definite, with its negative eigenvalues turned round. A step ends at the wall of its cell; at
    the wall the walk goes on in the neighbouring cell if the distance falls there too. Where it rises on
    both sides (a crease at a multiple knot, or the patch's edge) the coordinate is held and the walk follows
    the wall.

    Parameters
    ----------
    cells : Cells
        The surface.
    start : Place
        Where to begin, n places.
    target : (3, n) array
        Points to come near to.

    Returns
    -------
    Place
        Feet, with ``converged``.
    """
    if target.shape[1] >= COMPILED:
        return _compiled_walks(cells, start, target)
    batches = [slice(k, k + BATCH) for k in range(0, max(target.shape[1], 1), BATCH)]
    end = Place.join([_refine_foot_points(cells, start[batch], target[:, batch]) for batch in batches])
    return _look_behind_walls(cells, end, target)


def _compiled_walks(cells: Cells, start: Place, target: Floats) -> Place:
    """Walk by compiled loops, on all processors."""
    from geofit.geometry.foot_loops import walks

    cell, local = start.cell.astype(np.int64), np.ascontiguousarray(start.local)
    points, done = np.ascontiguousarray(target.T), np.zeros(len(start.cell), bool)

    def walk(some: slice) -> None:
        walks(cells.table, cells.neighbour, cells.noise, cell[some], local[:, some], points[some], done[some])

    side_by_side(walk, len(cell))
    return Place(cell, local, done)


def _refine_foot_points(cells: Cells, start: Place, target: Floats) -> Place:
    cell, local = start.cell.copy(), start.local.copy()
    done = np.zeros(len(cell), bool)
    # State of the points still walking: what they came from, to step back to if the distance rose.
    walking = np.arange(len(cell))
    c, x = cell.copy(), local.copy()
    entered = np.zeros(x.shape)
    previous, step, before = x.copy(), np.zeros_like(x), np.full(len(cell), np.inf)
    noise = cells.noise
    for _ in range(MAX_STEPS):
        s, ds, dt, dss, dst, dtt = cells._jet(Place(c, x), 2)
        r = s - target[:, walking]
        value = np.sqrt(_dot(r, r))
        rose = value > before + noise
        gradient = np.stack([_dot(r, ds), _dot(r, dt)])
        jss, jst, jtt = _dot(ds, ds), _dot(ds, dt), _dot(dt, dt)
        hessian = np.stack([jss + _dot(r, dss), jst + _dot(r, dst), jtt + _dot(r, dtt)])
        outward = (np.abs(x) >= 1) & (x * gradient < 0)
        convex, hessian = _convex(hessian, np.stack([jss, jst, jtt]), outward)
        hop, beyond = _doors(cells, c, x, outward & (entered != np.sign(x)))
        hop &= ~rose
        new = _box_step(x, gradient, hessian, outward)
        retreat = 0.25 * step
        moved = np.where(rose, retreat, new)
        base = np.where(rose, previous, x)
        hopping = hop.any(axis=0)
        moved[:, hopping] = 0
        after = np.clip(base + moved, -1, 1)
        length = np.sqrt(np.maximum(jss * moved[0] ** 2 + 2 * jst * moved[0] * moved[1] + jtt * moved[1] ** 2, 0))
        finished = ~hopping & (length < np.where(convex & ~rose, LAST_STEP, LAST_SLOW_STEP))

        before = np.where(rose, before, value)
        previous, step = base, moved
        entered = np.where(hop, -np.sign(x), np.where(np.abs(after) < 1, 0, entered))
        x = np.where(hop, -np.sign(x), after)
        previous = np.where(hop, x, previous)
        c = np.where(hopping, beyond, c)
        cell[walking], local[:, walking] = c, x
        done[walking[finished]] = True
        keep = ~finished
        if not keep.any():
            break
        walking, c, x, entered, before = walking[keep], c[keep], x[:, keep], entered[:, keep], before[keep]
        previous, step = previous[:, keep], step[:, keep]
    return Place(cell, local, done)


@np.errstate(over="ignore", invalid="ignore")  # a collapsed edge has no metric; its walk is held
def _convex(hessian: Floats, metric: Floats, held: Bools) -> tuple[Bools, Floats]:
    """Whether Hessians (3, n) are well positive definite, and the Hessians made so where they are not.

    Their eigenvalues relative to the surface's metric are 1 - d kappa; a negative one changes its sign. Where
    a coordinate is held, only the other one counts.
    """
    hss, hst, htt = hessian
    e, f, g = metric
    det = np.maximum(e * g - f * f, 1e-300)
    trace = (hss * g - 2 * hst * f + htt * e) / (2 * det)
    least = trace - np.sqrt(np.maximum(trace**2 - (hss * htt - hst**2) / det, 0))
    least = np.where(held[0], htt / np.maximum(g, 1e-300), least)
    least = np.where(held[1], hss / np.maximum(e, 1e-300), least)
    convex = least > 1e-3
    shift = np.where(convex, 0.0, np.abs(least) - least + 1e-3)
    return convex, hessian + shift * metric


def _doors(cells: Cells, cell: Ints, x: Floats, wanted: Bools) -> tuple[Bools, Ints]:
    """Choose the wall to go through, s before t, and the cell behind it."""
    behind_s = np.where(x[0] > 0, cells.neighbour[1, cell], cells.neighbour[0, cell])
    behind_t = np.where(x[1] > 0, cells.neighbour[3, cell], cells.neighbour[2, cell])
    hop_s = wanted[0] & (behind_s >= 0)
    hop_t = wanted[1] & (behind_t >= 0) & ~hop_s
    return np.stack([hop_s, hop_t]), np.where(hop_s, behind_s, behind_t)


@np.errstate(over="ignore", invalid="ignore")  # a flat model asks for an infinite step, which the box cuts
def _box_step(x: Floats, g: Floats, h: Floats, held: Bools) -> Floats:
    """Step to the minimum of the quadratic model in the box [-1, 1]^2, with some coordinates held."""
    hss, hst, htt = h
    tiny = 1e-300
    det = hss * htt - hst**2
    # A singular model (cusp, collapsed edge) moves along each coordinate on its own.
    regular = det > 1e-14 * np.abs(hss * htt)
    cross = np.where(regular, hst, 0.0)
    det = np.where(regular, det, hss * htt)
    alone = -g / np.maximum(np.stack([hss, htt]), tiny)
    full = np.stack([-(htt * g[0] - cross * g[1]), -(hss * g[1] - cross * g[0])]) / np.maximum(det, tiny)
    # An infinite model (no metric: the surface stands upright in the plan that is walked) holds the walk.
    full = np.where(np.isfinite(full), full, alone)
    step = np.where(held.any(axis=0), np.where(held, 0.0, alone), full)
    low, high = -1 - x, 1 - x
    over = np.maximum(step - high, low - step)
    beyond = over > 0
    step = np.clip(step, low, high)
    # One coordinate stops at the wall: the other goes to its minimum given that.
    free = ~held.any(axis=0)
    first = free & beyond[0] & (over[0] >= over[1])
    second = free & beyond[1] & ~first
    step_t = np.clip(-(g[1] + cross * step[0]) / np.maximum(htt, tiny), low[1], high[1])
    step_s = np.clip(-(g[0] + cross * step[1]) / np.maximum(hss, tiny), low[0], high[0])
    step = np.stack([np.where(second, step_s, step[0]), np.where(first, step_t, step[1])])
    uphill = g[0] * step[0] + g[1] * step[1] > 0
    return np.where(uphill, np.clip(np.where(held, 0.0, alone), low, high), step)


def _look_behind_walls(cells: Cells, end: Place, target: Floats) -> Place:
    """Try the cells around feet that were held at an inner wall (creases, and corners of creases)."""
    for _ in range(3):
        at_wall = np.abs(end.local) >= 1
        side = (end.local > 0).astype(np.int64)
        next_s = np.where(at_wall[0], cells.neighbour[side[0], end.cell], -1)
        next_t = np.where(at_wall[1], cells.neighbour[2 + side[1], end.cell], -1)
        diagonal = np.where((next_s >= 0) & (next_t >= 0), cells.neighbour[2 + side[1], next_s], -1)
        improved = False
        for others, flip in ((next_s, (-1, 1)), (next_t, (1, -1)), (diagonal, (-1, -1))):
            index = np.flatnonzero(others >= 0)
            if not index.size:
                continue
            start = Place(others[index], end.local[:, index] * np.array(flip)[:, None])
            trial = _refine_foot_points(cells, start, target[:, index])
            old = np.linalg.norm(cells.points(end[index]) - target[:, index], axis=0)
            new = np.linalg.norm(cells.points(trial) - target[:, index], axis=0)
            better = new < old - 1e-12
            if better.any():
                improved = True
                cell, local, done = end.cell.copy(), end.local.copy(), end.converged.copy()
                chosen = index[better]
                cell[chosen], local[:, chosen] = trial.cell[better], trial.local[:, better]
                done[chosen] = trial.converged[better]
                end = Place(cell, local, done)
        if not improved:
            break
    return end


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _horner(c: Floats, x: Floats, order: int) -> list[Floats]:
    """Value (and first and second derivative) of the polynomials c[0] + c[1] x + ... along the first axis."""
    degree = len(c) - 1
    if order == 0:
        value = c[degree].copy()
        for k in range(degree - 1, -1, -1):
            value *= x
            value += c[k]
        return [value]
    value, slope, bend = c[degree].copy(), np.zeros_like(c[0]), np.zeros_like(c[0])
    for k in range(degree - 1, -1, -1):
        if k < degree - 1:
            bend *= x
            bend += slope
        slope *= x
        slope += value
        value *= x
        value += c[k]
    bend *= 2
    return [value, slope, bend]


def _quotients(jet: list[Floats]) -> list[Floats]:
    """Return a rational surface's derivatives from its homogeneous one's (The NURBS Book, eq. 4.20)."""
    if len(jet) == 1:
        return [jet[0][:3] / jet[0][3]]
    (a, w), (a_s, w_s), (a_t, w_t), (a_ss, w_ss), (a_st, w_st), (a_tt, w_tt) = ((j[:3], j[3]) for j in jet)
    x = a / w
    x_s, x_t = (a_s - w_s * x) / w, (a_t - w_t * x) / w
    x_ss = (a_ss - 2 * w_s * x_s - w_ss * x) / w
    x_st = (a_st - w_s * x_t - w_t * x_s - w_st * x) / w
    x_tt = (a_tt - 2 * w_t * x_t - w_tt * x) / w
    return [x, x_s, x_t, x_ss, x_st, x_tt]


def _taylor(knots: Floats, degree: int) -> tuple[Ints, Floats, Floats]:
    """First control point of each span, and the matrices from its control points to powers on [-1, 1]."""
    breaks = np.unique(knots)
    middle, half = (breaks[1:] + breaks[:-1]) / 2, np.diff(breaks) / 2
    rows = []
    for k in range(degree + 1):
        first, values = bspline.basis(knots, degree, middle, k)
        rows.append(values * (half**k / factorial(k))[:, None])
    return first, np.stack(rows, axis=1), breaks


def _neighbours(nu: int, nv: int, count: int) -> Ints:
    grid = np.full((nu + 2, nv + 2), -1)
    grid[1:-1, 1:-1] = count + np.arange(nu * nv).reshape(nu, nv)
    around = (grid[:-2, 1:-1], grid[2:, 1:-1], grid[1:-1, :-2], grid[1:-1, 2:])
    return np.stack([side.ravel() for side in around])

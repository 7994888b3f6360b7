"""Nearest places of a surface, and those on a height field that need no search.

Let a point stand h above or below its place on a height field z. The nearest place of all is within h of it, so over
the disk of radius h in plan. With slopes of at most G and second derivatives of at most K, half the squared distance
as a function of the plan has a Hessian of at least 1 - h (1 + G) K over that disk: where that is positive there is
one foot alone, and Newton's method from the place above or below finds it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.threads import side_by_side
from geofit.geometry.cells import BATCH, Cells, Place, tabulate
from geofit.geometry.elevation import PlanMap, plan_map
from geofit.geometry.one_sheet import lie_apart
from geofit.splines import bspline
from geofit.splines.patch import Patch, Patches

__all__ = ["CONVEX", "Projection", "creases", "foot_points_over_plan"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: What h (1 + G) K, or distance times curvature, may be: the Hessian is then far from singular, and Newton's method
#: converges in a few steps.
CONVEX = 0.5
#: Steps of Newton's method, and how short (metres) the last one is: it leaves an error near its square. What has not
#: come to rest is searched for.
STEPS, LAST = 8, 1e-6
#: Metres from the surface within which a point is on it: its place in plan is its foot point, at a seam too.
TOUCHING = 1e-9
#: From this many points on, compiled loops are worth loading: they take a quarter of the time.
COMPILED = 20_000
#: How far the control points may be from the plan's map, metres.
EXACT = 1e-10


@dataclass(frozen=True, eq=False)
class Projection:
    """Nearest places of a surface to n points.

    ``distance`` (n,) metres, signed: positive on the upper side. ``foot`` (n, 3) metres, ``patch`` (n,) index
    of the patch, ``u``, ``v`` (n,) its parameters (nan on triangles), ``converged`` (n,) bool. ``beyond`` (n,): the
    foot point is on the rim and the point lies beyond the edge; None where that was not looked at.
    """

    distance: Floats
    foot: Floats
    patch: Ints
    u: Floats
    v: Floats
    converged: Bools
    beyond: Bools | None = None

    @classmethod
    def unknown(cls, n: int) -> Projection:
        """Return room for n points."""
        return cls(np.zeros(n), np.zeros((n, 3)), np.zeros(n, np.int64), np.zeros(n), np.zeros(n), np.zeros(n, bool))

    def __getitem__(self, rows: Ints) -> Projection:
        """Return what was found for some of the points."""
        some: dict[str, Any] = {name: None if values is None else values[rows] for name, values in vars(self).items()}
        return Projection(**some)

    def fill(self, rows: Ints, other: Projection) -> None:
        """Write what was found for some of the points."""
        for name, values in vars(other).items():
            if values is not None:
                getattr(self, name)[rows] = values


def foot_points_over_plan(patches: Sequence[Patch], target: Floats) -> Projection:
    """Find the feet of (n, 3) points on a height field; those that are not proven are left ``converged`` False.

    That is a point by the surface's edge or a seam (nearer than h), or beyond the radius of curvature; and every
    point if the patches are not height fields side by side, without creases.
    """
    found = Projection.unknown(len(target))
    for field in Patches.of(patches).prepared(_fields):
        if len(target) >= COMPILED:
            _compiled_walks(field, target, found)
            continue
        x, y = target[:, 0] - field.start[0], target[:, 1] - field.start[1]
        u, v = (a * x + b * y for a, b in field.inverse)
        low_u, high_u, low_v, high_v = field.domain
        over = np.flatnonzero((u >= low_u) & (u <= high_u) & (v >= low_v) & (v <= high_v) & ~found.converged)
        for start in range(0, len(over), BATCH):
            rows = over[start : start + BATCH]
            _walk(field, u[rows], v[rows], rows, target, found)
    return found


@dataclass(frozen=True, eq=False)
class _Field:
    """A patch as heights over its parameters: (x, y) = start + matrix @ (u, v).

    ``slope`` bounds the gradient of its heights, ``bend`` their second derivatives (1/m).
    """

    patch: int
    domain: tuple[float, float, float, float]
    start: Floats
    matrix: Floats
    inverse: Floats
    cells: Cells
    slope: float
    bend: float

    def jets(self, u: Floats, v: Floats) -> list[Floats]:
        """Return z, z_u, z_v, z_uu, z_uv, z_vv at parameters; beyond the domain the outermost cells go on."""
        bu, bv = self.cells.breaks[0]
        cell = bspline.intervals(bu, u) * (len(bv) - 1) + bspline.intervals(bv, v)
        half_u, half_v = self.cells.half.take(cell, axis=1)
        centre_u, centre_v = self.cells.centre.take(cell, axis=1)
        local = np.stack([(u - centre_u) / half_u, (v - centre_v) / half_v])
        z, zu, zv, zuu, zuv, zvv = (row[0] for row in self.cells.jets(Place(cell, local)))
        return [z, zu / half_u, zv / half_v, zuu / half_u**2, zuv / (half_u * half_v), zvv / half_v**2]


def _compiled_walks(field: _Field, target: Floats, found: Projection) -> None:
    """Walk from the places above or below all points by compiled loops, on all processors."""
    from geofit.geometry.foot_loops import feet_over_plan

    (breaks_u, breaks_v), already = field.cells.breaks[0], found.converged.copy()

    def walk(some: slice) -> None:
        feet_over_plan(
            field.cells.table,
            breaks_u,
            breaks_v,
            np.array(field.domain),
            field.start,
            field.matrix,
            field.inverse,
            field.slope,
            field.bend,
            (STEPS, CONVEX, LAST, TOUCHING),
            target[some],
            found.distance[some],
            found.foot[some],
            found.u[some],
            found.v[some],
            found.converged[some],
        )

    side_by_side(walk, len(target))
    found.patch[found.converged & ~already] = field.patch


def _walk(field: _Field, u0: Floats, v0: Floats, rows: Ints, target: Floats, found: Projection) -> None:
    """Walk from the places above or below some points, and write the feet that are proven."""
    u, v, height = u0, v0, target[rows, 2]
    metric = field.matrix.T @ field.matrix
    apart = np.full(len(rows), np.inf)
    for step in range(STEPS):
        z, zu, zv, zuu, zuv, zvv = field.jets(u, v)
        r, du, dv = z - height, u - u0, v - v0
        if step == 0:
            apart = np.abs(r)
            go = (apart * (1 + field.slope) * field.bend <= CONVEX) & _within(field, u, v, apart)
        # Newton's method on half the squared distance, as a function of u and v.
        gu = metric[0, 0] * du + metric[0, 1] * dv + r * zu
        gv = metric[0, 1] * du + metric[1, 1] * dv + r * zv
        e, f, g = metric[0, 0] + zu * zu, metric[0, 1] + zu * zv, metric[1, 1] + zv * zv
        a, b, c = e + r * zuu, f + r * zuv, g + r * zvv
        det = np.where(go, a * c - b * b, 1.0)
        su, sv = (b * gv - c * gu) / det, (b * gu - a * gv) / det
        rest = go & (e * su * su + 2 * f * su * sv + g * sv * sv < LAST**2)
        u, v, du, dv = u + su, v + sv, du + su, dv + sv
        if rest.any():
            # The last step is so short that the derivatives lead to the height at its end.
            bend_u, bend_v = zuu * su + zuv * sv, zuv * su + zvv * sv
            r = r + (zu + bend_u / 2) * su + (zv + bend_v / 2) * sv
            plan = field.matrix @ np.stack([du, dv])
            # Beside the disk there may be other feet.
            rest &= np.hypot(*plan) <= apart + LAST
            off = np.concatenate([plan, r[None]])
            length = np.sqrt((off * off).sum(axis=0))
            side = du * (zu + bend_u) + dv * (zv + bend_v) - r
            at = rows[rest]
            found.distance[at] = np.where(side < 0, -length, length)[rest]
            found.foot[at] = target[at] + off[:, rest].T
            low_u, high_u, low_v, high_v = field.domain
            found.u[at], found.v[at] = u[rest].clip(low_u, high_u), v[rest].clip(low_v, high_v)
            found.patch[at], found.converged[at] = field.patch, True
        go &= ~rest
        if not go.any():
            return
        rows, u, v, u0, v0, height, apart = (x[go] for x in (rows, u, v, u0, v0, height, apart))
        go = go[go]


def _within(field: _Field, u: Floats, v: Floats, reach: Floats) -> Bools:
    """Whether disks of a radius in plan are inside the patch: there is no other surface in them."""
    reach = np.where(reach < TOUCHING, 0.0, reach)
    low_u, high_u, low_v, high_v = field.domain
    reach_u, reach_v = (float(np.hypot(*row)) * reach for row in field.inverse)
    across = (u - reach_u >= low_u) & (u + reach_u <= high_u)
    return np.asarray(across & (v - reach_v >= low_v) & (v + reach_v <= high_v))


def _fields(patches: Patches) -> tuple[_Field, ...]:
    """Return the patches as height fields; none if one of them is none, or has a crease, or they overlap."""
    plans = [plan for patch in patches if (plan := plan_map(patch)) is not None]
    if len(plans) < len(patches) or not lie_apart(plans, patches):
        return ()
    fields = [_field(*one) for one in zip(range(len(patches)), patches, plans, strict=True)]
    found = tuple(field for field in fields if field is not None)
    return found if len(found) == len(patches) else ()


def _field(index: int, patch: Patch, plan: PlanMap) -> _Field | None:
    p, q = patch.degree
    if creases(patch.knots_u, p).any() or creases(patch.knots_v, q).any():
        return None
    u, v = bspline.greville(patch.knots_u, p)[:, None, None], bspline.greville(patch.knots_v, q)[:, None]
    expected = plan.start + u * plan.matrix[:, 0] + v * plan.matrix[:, 1]
    if np.abs(patch.control[..., :2] - expected).max() > EXACT:
        return None
    z, inner_u, inner_v = patch.control[..., 2], patch.knots_u[1:-1], patch.knots_v[1:-1]
    zu, zv = _derivative(z, patch.knots_u, p, 0), _derivative(z, patch.knots_v, q, 1)
    zuu, zuv = _derivative(zu, inner_u, p - 1, 0), _derivative(zu, patch.knots_v, q, 1)
    zvv = _derivative(zv, inner_v, q - 1, 1)
    # A spline is nowhere larger than its control points.
    a, b, c, d, e = (float(np.abs(one).max()) for one in (zu, zv, zuu, zuv, zvv))
    inverse = np.asarray(np.linalg.inv(plan.matrix), float)
    scale = float(np.linalg.norm(inverse, 2))
    slope, bend = scale * math.hypot(a, b), scale**2 * math.sqrt(c * c + 2 * d * d + e * e)
    cells = tabulate([patch]).coordinate(2)
    return _Field(index, patch.domain, plan.start, plan.matrix, inverse, cells, slope, bend)


def creases(knots: Floats, degree: int) -> Bools:
    """Mark the spans at whose start the first derivative may jump."""
    line, count = np.unique(knots[degree : -degree - 1], return_counts=True)
    return np.asarray((count >= degree) & (line > line[0]))


def _derivative(net: Floats, knots: Floats, degree: int, axis: int) -> Floats:
    """Return the control points of the derivative along an axis (The NURBS Book, eq. 3.24)."""
    if degree == 0:
        return np.zeros((1, 1))
    width = knots[degree + 1 : -1] - knots[1 : -degree - 1]
    return np.asarray(degree * np.diff(net, axis=axis) / (width[:, None] if axis == 0 else width))

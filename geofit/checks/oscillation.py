"""Swings of the surface between its points that the points do not support.

The points say what is between them by a thin-plate spline of the nearest ones, fitted over the surface's own tangent
plane, so that steep and overturned surfaces are asked alike. How far that may be trusted they say too: each point
is left out, with all others as near to it as the widest gap around is wide, and predicted. Where the surface
departs from the spline by several times the worst of these errors nearby, it swings of its own accord.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geofit.checks.lattice import PatchLattice
from geofit.checks.residual_tests import partly
from geofit.data.accuracy import Check
from geofit.data.long_arrays import left_rows
from geofit.data.messages import message
from geofit.geometry.projection import Projection
from geofit.surfaces.protocol import FittedSurface

__all__ = ["oscillation"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: How many times the left-out error nearby the surface may depart from the points' spline. 500 surfaces of ten kinds:
#: 1.0 in the median, 3.9 on 19 of 20; above it are 14, of which 2 are right there.
TIMES = 6.0
#: Points of one spline, and how many are looked at for those that are left when the nearest are left out.
NEAR, FAR = 10, 32
#: Nearest points whose mean distance is the width of a gap.
AROUND = 3
#: Fewest of these whose left-out error must be known; otherwise the gap is not checked.
SEEN = 2
FEWEST = 20
#: Places that are asked: half of them spread evenly by area, half where the surface bends most. All of ``GAPS`` places,
#: spread in the same way, show how wide the gaps between the points are. Points: a part of more.
PLACES, GAPS, MOST = 800, 3_000, 5_000
#: A place whose points leave a wider angle open lies at the rim, where the trend is asked instead.
OPEN = 5 * np.pi / 6
#: A point whose others leave so wide an angle open is predicted from one side: on the outermost section, say.
RIM = 0.98 * np.pi
#: Cosine between normals below which a point belongs to another limb of a fold.
SAME_LIMB = 0.3
#: Nugget of the spline: points at one location do no harm.
NUGGET = 1e-3
NAMED = 20


def oscillation(
    surface: FittedSurface, parts: Sequence[PatchLattice], feet_of: Callable[[Ints], Projection], active: Bools
) -> Check | None:
    """Compare the surface between its points with what the points support.

    Parameters
    ----------
    surface : FittedSurface
        The surface.
    parts : sequence of Lattice
        Its places.
    feet_of : callable
        ``feet_of(rows)`` returns the nearest places of some of its points.
    active : (n,) array of bool
        Points that conflicts left.

    Returns
    -------
    Check or None
        The largest departure, metres, against what is allowed at that place; None with fewer than 20 points.
    """
    given = int(active.sum())
    if given < FEWEST:
        return None
    many = given > MOST
    chosen = np.sort(np.random.default_rng(0).choice(given, MOST, replace=False)) if many else np.arange(given)
    chosen = left_rows(active, chosen)
    points, projection = surface.points.xyz[chosen] - surface.origin, feet_of(chosen)
    feet, normals = projection.foot, _normals(surface, projection)
    places, upward, bent = _places(parts)
    tree = cKDTree(points)
    near = np.asarray(tree.query(places, k=NEAR, workers=-1)[1])
    around = _Around.of(places, upward, near, feet, normals)
    surrounded = around.open_angle() < OPEN
    error, reach, known = _left_out(tree, points, feet, normals, places[surrounded], near[surrounded])
    asked = bent & surrounded & (known[near].sum(axis=1) >= NEAR // 2) & (known[near[:, :AROUND]].sum(axis=1) >= SEEN)
    if not asked.any():
        return None
    least = max(float(np.median(error[known])), surface.settings.interior_tolerance)
    # Across a gap wider than those of the points whose errors are known, the error grows with the width.
    away = np.linalg.norm(places[asked, None] - points[near[asked, :AROUND]], axis=2).mean(axis=1)
    wider = np.maximum(away[:, None] / reach[near[asked]], 1.0)
    allowed = TIMES * np.maximum((error[near[asked]] * wider).max(axis=1), least)
    off, where = np.abs(around[asked].spline()), places[asked] + surface.origin
    worst = np.argsort(-off / allowed, kind="stable")
    value, limit = float(off[worst[0]]), float(allowed[worst[0]])
    x, y = where[worst[0], :2]
    figures = {"value": value, "limit": limit, "x": x, "y": y}
    beyond = worst[off[worst] > allowed[worst]]
    if not len(beyond):
        text = message(
            "checks.surface-follows-support",
            "between the points the surface follows what they support; it departs by {value:.1f} m "
            "where {limit:.1f} m are allowed, at {x:.0f}, {y:.0f}",
            **figures,
        )
        return Check("oscillation", True, value, limit, "m", partly(text, len(chosen), given))
    text = message(
        "checks.surface-oscillates",
        "the surface oscillates between the points: at {x:.0f}, {y:.0f} it departs by {value:.1f} m from what the "
        "points around support ({limit:.1f} m allowed); this happens at {count} of {n} places; a point there may be "
        "wrong, or the tolerance finer than the data",
        count=len(beyond),
        n=len(off),
        **figures,
    )
    named = tuple((float(a), float(b), float(c)) for a, b, c in where[beyond[:NAMED]])
    return Check("oscillation", False, value, limit, "m", partly(text, len(chosen), given), named)


def _normals(surface: FittedSurface, projection: Projection) -> Floats:
    normals = np.zeros((len(projection.patch), 3))
    for index, patch in enumerate(surface.patches):
        mine = projection.patch == index
        if mine.any():
            u, v = projection.u[mine], projection.v[mine]
            cross = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1))
            normals[mine] = _unit(cross)
    return normals


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))


def _places(parts: Sequence[PatchLattice]) -> tuple[Floats, Floats, Bools]:
    """Choose middles of spans that show the gaps, and mark those that are asked: places, normals, asked."""
    points, normals, bends, areas = [], [], [], []
    for part, area in ((one.middles, one.areas) for one in parts):
        normal = _unit(part.normal)
        bend = np.zeros(part.within.shape)
        for axis in (0, 1):
            p, n, b = (np.moveaxis(a, axis, 0) for a in (part.points, normal, bend))
            if len(p) > 2:
                back, ahead = p[:-2] - p[1:-1], p[2:] - p[1:-1]
                width = np.linalg.norm(back, axis=-1) + np.linalg.norm(ahead, axis=-1)
                b[1:-1] += np.abs(((back + ahead) * n[1:-1]).sum(axis=-1)) / np.maximum(width, 1e-300)
        points.append(part.points[part.within])
        normals.append(normal[part.within])
        bends.append(bend[part.within])
        areas.append(area[part.within])
    place, upward, bend = np.concatenate(points), np.concatenate(normals), np.concatenate(bends)
    asked = np.ones(len(place), bool)
    if len(place) > PLACES:
        asked[:] = False
        asked[_spread(np.concatenate(areas), PLACES // 2)] = True
        asked[np.argsort(-bend, kind="stable")[: PLACES // 2]] = True
    chosen = asked.copy()
    chosen[_spread(np.concatenate(areas), min(GAPS, len(place)))] = True
    return place[chosen], upward[chosen], asked[chosen]


def _spread(areas: Floats, count: int) -> Ints:
    """Return at most so many places, evenly by area: spans are short where the points are dense."""
    ends = np.cumsum(areas)
    return np.asarray(np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1]))


def _left_out(
    tree: cKDTree, points: Floats, feet: Floats, normals: Floats, places: Floats, near: Ints
) -> tuple[Floats, Floats, Bools]:
    """Predict each point without those nearer than the widest gap around.

    Returns the error (m), the mean distance of the nearest points that were not left out, and where both are known.
    """
    gap = np.zeros(len(points))
    to_nearest = np.linalg.norm(places - points[near[:, 0]], axis=1)
    for column in range(AROUND):
        np.maximum.at(gap, near[:, column], to_nearest)
    distance, others = (np.asarray(found) for found in tree.query(points, k=min(FAR, len(points)), workers=-1))
    left = (distance >= 0.999 * gap[:, None]) & (others != np.arange(len(points))[:, None])
    order = np.argsort(~left, axis=1, kind="stable")[:, :NEAR]
    around = _Around.of(feet, normals, np.take_along_axis(others, order, axis=1), points, normals)
    known = (left.sum(axis=1) >= NEAR) & (around.open_angle() < RIM)
    error = np.zeros(len(points))
    error[known] = np.abs(around[known].spline() - ((points - feet) * normals).sum(axis=1)[known])
    nearest = np.take_along_axis(distance, order[:, :AROUND], axis=1).mean(axis=1)
    return error, np.maximum(nearest, 1e-9), known


@dataclass(frozen=True, eq=False)
class _Around:
    """The points around m places: ``local`` (m, k, 3) over each tangent plane, ``with_it`` (m, k) on its limb."""

    local: Floats
    with_it: Bools

    @classmethod
    def of(cls, places: Floats, upward: Floats, near: Ints, points: Floats, normals: Floats) -> _Around:
        """Take the points ``near`` (m, k) the places, whose normals are ``upward``."""
        first = _unit(np.cross(upward, np.eye(3)[np.argmin(np.abs(upward), axis=1)]))
        axes = np.stack([first, np.cross(upward, first), upward], axis=1)
        local = (points[near] - places[:, None]) @ axes.transpose(0, 2, 1)
        return cls(local, np.einsum("mkj,mj->mk", normals[near], upward) > SAME_LIMB)

    def __getitem__(self, chosen: Bools) -> _Around:
        return _Around(self.local[chosen], self.with_it[chosen])

    def spline(self) -> Floats:
        """Return the height at each place of the thin-plate spline of its points over its tangent plane."""
        m, k = self.with_it.shape
        reach = np.linalg.norm(self.local[..., :2], axis=2)
        size = np.maximum(np.where(self.with_it, reach, 0.0).max(axis=1), 1e-9)
        plan = self.local[..., :2] / size[:, None, None]
        between = np.square(plan[:, :, None] - plan[:, None, :]).sum(axis=-1)
        system = np.zeros((m, k + 3, k + 3))
        both = self.with_it[:, :, None] & self.with_it[:, None, :]
        system[:, :k, :k] = np.where(both, _kernel(between), 0.0)
        system[:, range(k), range(k)] = np.where(self.with_it, NUGGET, 1.0)
        system[:, :k, k:] = np.concatenate([np.ones((m, k, 1)), plan], axis=2) * self.with_it[..., None]
        system[:, k:, :k] = system[:, :k, k:].transpose(0, 2, 1)
        # Points in one line say nothing across it: there the surface's own tangent plane is taken.
        system[:, range(k, k + 3), range(k, k + 3)] = -1e-6
        right = np.zeros((m, k + 3, 1))
        right[:, :k, 0] = np.where(self.with_it, self.local[..., 2], 0.0)
        weights = np.linalg.solve(system, right)[..., 0]
        at_place = np.where(self.with_it, _kernel(np.square(plan).sum(axis=-1)), 0.0)
        return np.asarray((weights[:, :k] * at_place).sum(axis=1) + weights[:, k])

    def open_angle(self) -> Floats:
        """Return the widest angle between the directions of neighbouring points; 2 pi for fewer than four."""
        angle = np.arctan2(self.local[..., 1], self.local[..., 0])
        angle = np.sort(np.where(self.with_it, angle, np.inf), axis=1)
        count = self.with_it.sum(axis=1)
        first = np.where(count > 0, angle[:, 0], 0.0)[:, None] + 2 * np.pi
        # Once around: behind the last direction comes the first again.
        around = np.concatenate([np.where(np.isfinite(angle), angle, first), first], axis=1)
        return np.asarray(np.where(count >= 4, np.diff(around, axis=1).max(axis=1), 2 * np.pi))


def _kernel(squared: Floats) -> Floats:
    """r^2 log r of the squared distance."""
    return np.asarray(0.5 * squared * np.log(np.maximum(squared, 1e-30)))

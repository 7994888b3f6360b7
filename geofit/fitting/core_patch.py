"""What passes through a core's points, and the patch around them that has knots of its own.

Knots of one tensor product would run from the core to the ends of the surface, where nothing needs them. The field and
the periphery therefore lie in a space of their own spans; the patch of the core is finer, and the finer functions
vanish at its edges (:mod:`geofit.splines.refined`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from geofit.data.allowance import allowance
from geofit.data.errors import ExactnessError
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data, degree_for
from geofit.fitting.approximate import RIM, swinging_points
from geofit.fitting.assemble import carried
from geofit.fitting.caps import in_patches
from geofit.fitting.core_relief import CoreRelief
from geofit.fitting.field import FieldChoice
from geofit.fitting.knots import graded_breaks, neighbour_pairs, pair_sizes
from geofit.fitting.resolution import longest_span
from geofit.fitting.skin import OVERSHOOT, Lines, minimum_norm_correction, refine_knots
from geofit.splines.refined import RefinedSpace, Space
from geofit.splines.tensor import TensorSpace

__all__ = [
    "FIELD_SPAN",
    "LAID",
    "NARROW",
    "Core",
    "Limits",
    "Through",
    "on_coarse",
    "span_sizes",
    "through_points_locally",
    "without_repeats",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Rectangle = tuple[float, float, float, float]
Spans = tuple[float, float, float]

#: Share of the control points that follows the spacing of a core's points; the rest goes to single pairs that need
#: more. The second share is tried where the first leaves points strained.
LAID = (0.95, 0.6)
#: Span of the field's space where the knots are finer for the core's points alone, in units. Spans longer than the
#: other were chosen by the likelihood, and are kept: the field there is smoother than on finer ones.
FIELD_SPAN, SIMPLE = 0.3, 0.55
#: Spans between neighbouring points, as a share of their distance.
BETWEEN = 0.9
#: Spans next to a section line, as a share of the distance to the next line, and their number on each side.
HUG, HUGGED = 1 / 8, 1
#: Lines nearer to the core's edge or to each other than this share of their mean distance get one knot.
NARROW = 0.2
#: Room between a core's points and the edge of its patch, as a share of their spacing, and the spans that it holds:
#: the finer functions vanish at the edge.
ROOM, IN_ROOM = 0.5, 2.5
#: Points of the periphery nearer to the core's than this share of its room lie in its patch.
CLOSE = 0.5
#: A point on which the finer functions act with less than this sum of squares is not reached by them.
REACHED = 0.003
#: An edge of the patch nearer to the area's than this share of the spans there is the area's.
SLIVER = 0.3
#: How many times longer the spans in the patch become, for the cap, before those outside do, and those of the field.
YIELDING = (2.0, 50.0)


@dataclass(frozen=True, eq=False)
class Core:
    """What passes through points: those marked ``inside``, in a rectangle in units, with the field chosen for all.

    ``coarse`` is the space on which the field was chosen, ``relief`` the field of the core's own points where that one
    cannot follow them; ``lines`` are the sections. ``between`` marks the points between the section curves of a fold.
    """

    data: Data
    rectangle: Rectangle
    inside: NDArray[np.bool_]
    between: NDArray[np.bool_]
    field: FieldChoice
    coarse: TensorSpace
    lines: Lines
    parametric: bool
    settings: FitSettings
    relief: CoreRelief | None

    def field_at(self, space: TensorSpace, coefficients: Floats, plane: Floats) -> Floats:
        """Return the field at (m, 2) places of the core: that on a space, or the core's own in its place."""
        found = np.asarray(space.matrix(plane) @ coefficients)
        return found if self.relief is None else self.relief.instead(plane, found)

    def misfit(self, chosen: Ints) -> Floats:
        """Return what the field leaves of some points, (m,) or (m, k) metres."""
        found = self.data.smoothed(self.coarse, self.field).coefficients
        return np.asarray(self.data.value[chosen] - self.field_at(self.coarse, found, self.data.plane[chosen]))

    @property
    def chosen(self) -> Ints:
        """The points to pass through, ordered by place: ties do not depend on the order of the points."""
        chosen = np.flatnonzero(self.inside)
        return np.asarray(chosen[np.lexsort(self.data.plane[chosen].T)])


@dataclass(frozen=True)
class Limits:
    """How many control points there may be, and how short the spans are.

    Between neighbours along the sections the spans are ``closer`` times as long as usual, outside the core no longer
    than ``longest``, in units.
    """

    most: int
    longest: float
    closer: float = 1.0


@dataclass(frozen=True, eq=False)
class Through:
    """A surface through a core: the field's space, its own, coefficients, the plane under them.

    ``rule`` are the section lines of a core that is linear across them. ``held`` (k,) marks the finer functions that
    act on the core's points.
    """

    base: TensorSpace
    space: Space
    coefficients: Floats
    plane: Floats
    rule: Floats | None
    held: NDArray[np.bool_]


def on_coarse(core: Core, degree: int) -> bool:
    """Whether the field stays on the space on which it was chosen, however fine the knots of the surface are."""
    return longest_span(core.coarse) > SIMPLE or core.field.alpha > degree


def through_points_locally(core: Core, limits: Limits) -> Through:
    """Lay knots within the limits, fit the field, and let the core's patch pass through the core's points.

    Raises
    ------
    ExactnessError
        If so many control points cannot pass through the points.
    """
    data, degree, chosen = core.data, degree_for(len(core.data.plane)), core.chosen
    plane = data.plane[chosen]
    pairs = neighbour_pairs(plane)
    tried, rounds = [], max(core.settings.max_iterations, 1)
    for laid in LAID:
        given = _laid(core, plane, pairs, limits, laid)
        base = core.coarse if on_coarse(core, degree) else given.outer
        regional = data.smoothed(base, core.field)
        misfit = data.value[chosen] - core.field_at(base, regional.coefficients, plane)

        def finer(breaks_u: Floats, breaks_v: Floats, outer: TensorSpace = given.outer) -> RefinedSpace:
            return RefinedSpace(outer, TensorSpace.on_breaks(breaks_u, breaks_v, degree))

        def allowed(shape: tuple[int, int], elsewhere: int = _count(given) - given.fine.size) -> bool:
            return elsewhere + shape[0] * shape[1] <= limits.most

        breaks = np.unique(given.fine.knots_u), np.unique(given.fine.knots_v)
        refined = refine_knots(*breaks, plane, pairs, misfit, finer, allowed, rounds, data.unit)
        tried.append((refined.strain, base, regional, finer(*refined.breaks)))
        if refined.strain <= 1.0:
            break
    _, base, regional, space = min(tried, key=itemgetter(0))
    _, start = carried(base, regional.coefficients, space.knots_u, space.knots_v)
    more = np.zeros(len(space.inner))
    if core.relief is not None:
        more = core.relief.departure(space.fine, lambda at: space.outer.matrix(at) @ start)[space.inner]
    more, held = _through(core, chosen, space, start, more)
    return Through(base, space, np.concatenate([start, more]), regional.plane, None, held)


def _through(
    core: Core, chosen: Ints, space: RefinedSpace, start: Floats, more: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Let the finer functions, with coefficients ``more``, pass through the core's points.

    Others in the core's patch are kept within the tolerance: no function outside reaches them without acting on the
    core. Return also which functions act on the core's points.
    """
    data = core.data
    finest = space.fine_matrix(data.plane[:])
    off = np.asarray(data.value[:] - space.outer.matrix(data.plane[:]) @ start - finest @ more)
    mine = csr_array(finest[chosen])
    held = np.bincount(mine.indices, minlength=len(more)) > 0
    settings, acting = core.settings, np.asarray(finest.power(2).sum(axis=1)).ravel() > REACHED
    others = np.flatnonzero(acting & ~core.inside)
    if settings.smoothing != "auto" or core.field.contradictory:
        others = others[:0]
    limit = np.full(len(others), settings.interior_tolerance)
    if not settings.strict:
        limit = allowance(data.accuracy[others], settings.interior_tolerance, settings.interior_tolerance)
    size = np.abs(off[others])
    wanted = np.where(size > limit, off[others] * (1 - RIM * limit / np.maximum(size, limit)), 0.0)
    kept = np.ones(len(others), bool)
    while kept.any():
        both = csr_array(vstack([mine, finest[others[kept]]]))
        left = np.concatenate([off[chosen], wanted[kept]])
        try:
            change = minimum_norm_correction(both, left)
        except ExactnessError:
            break
        # Points that contradict the core are let go, and reported.
        swinging = swinging_points(both, change, np.abs(left), np.ones(len(left), bool), OVERSHOOT)[len(chosen) :]
        if not swinging.any():
            return more + change, held
        kept[kept] = ~swinging
    return more + minimum_norm_correction(mine, off[chosen]), held


def _laid(core: Core, plane: Floats, pairs: Ints, limits: Limits, share: float) -> RefinedSpace:
    """Lay knots for the surface and for the patch of a core, with a share of the control points that the cap allows.

    In the patch they follow the core's points, ``plane`` (m, 2) with the ``pairs`` of neighbours among them. It keeps
    room between them and its edges, where the finer functions vanish.
    """
    area, lines, degree = core.data.area, core.lines, degree_for(len(core.data.plane))
    patch, room = _patch_of(core, plane, limits)
    sizes = [np.concatenate(both) for both in zip(span_sizes(core, plane, pairs, limits), room, strict=True)]
    narrow = NARROW * (core.rectangle[1] - core.rectangle[0]) / max(len(lines.u), 1)
    stretch = 1.0
    while True:
        wider, given = (max(1.0, stretch / times) for times in YIELDING)
        outer, inner = [], []
        for axis, size in ((0, sizes[0]), (1, sizes[1])):
            low, high = patch[2 * axis : 2 * axis + 2]
            field = np.array([[low, high, min(FIELD_SPAN, limits.longest) * given]])
            breaks = graded_breaks([area[2 * axis], low, high, area[2 * axis + 1]], wider * limits.longest, field)
            within = breaks[(breaks >= low) & (breaks <= high)]
            if axis == 0:
                within = without_repeats(lines.u[(lines.u > low) & (lines.u < high)], within, narrow)
            outer.append(breaks)
            inner.append(graded_breaks(within, limits.longest * stretch, size * np.array([1.0, 1.0, stretch])))
        space = RefinedSpace(
            TensorSpace.on_breaks(outer[0], outer[1], degree), TensorSpace.on_breaks(inner[0], inner[1], degree)
        )
        if _count(space) <= share * limits.most or stretch > 1e3:
            return space
        stretch *= 1.1


def _patch_of(core: Core, plane: Floats, limits: Limits) -> tuple[Rectangle, tuple[Floats, Floats]]:
    """Return the rectangle of a core's patch, and for u and v the rows (low, high, size) of the spans in its room.

    Its edges lie at most halfway to the next point of the periphery, which needs functions of its own.
    """
    area, others = core.data.area, core.data.plane[~core.inside]
    given = core.rectangle if core.relief is None else core.relief.reach
    u0, u1, v0, v1 = core.rectangle
    least = ROOM * math.sqrt((u1 - u0) * (v1 - v0) / len(plane))
    sides, rooms = list(given), (list[Spans](), list[Spans]())
    for side, edge in enumerate(given):
        if edge == area[side]:
            continue
        axis, way = side // 2, 1.0 if side % 2 else -1.0
        last = float((way * plane[:, axis]).max())
        low, high = given[2 - 2 * axis] - least, given[3 - 2 * axis] + least
        facing = others[(others[:, 1 - axis] >= low) & (others[:, 1 - axis] <= high)]
        apart = np.sort(way * facing[:, axis]) - last
        room = max(way * edge - last, least)
        if core.relief is None:
            room = min(room, float(apart[apart >= CLOSE * least].min(initial=np.inf)) / 2)
        end = last + room
        if way * area[side] - end < SLIVER * limits.longest:
            sides[side] = area[side]
            continue
        sides[side] = way * end
        rooms[axis].append((min(way * last, way * end), max(way * last, way * end), room / IN_ROOM))
    room_u, room_v = (np.array(rows, float).reshape(-1, 3) for rows in rooms)
    return (sides[0], sides[1], sides[2], sides[3]), (room_u, room_v)


def span_sizes(core: Core, plane: Floats, pairs: Ints, limits: Limits, along: float = BETWEEN) -> tuple[Floats, Floats]:
    """Return, for u and v, rows (low, high, size) of the spans that a core's points ask for.

    ``along`` is the share of the distance between neighbours of one straight section. What makes the surface pass
    through a point must be narrow in both directions: across the sections spans hug each of them, along them they
    follow the closest neighbours of any.
    """
    lines = core.lines
    sizes_u = _at_lines(lines) if lines.straight else pair_sizes(plane, pairs, 0, BETWEEN)
    sizes_v = pair_sizes(plane, pairs, 1, limits.closer * (along if lines.straight else BETWEEN))
    if core.relief is None:
        return sizes_u, sizes_v
    following_u, following_v = core.relief.spans()
    return np.concatenate([sizes_u, following_u]), np.concatenate([sizes_v, following_v])


def without_repeats(values: Floats, fixed: Floats | tuple[float, ...], least: float) -> Floats:
    """Return ascending values without those that all but repeat a fixed one or each other."""
    result = np.unique(fixed)
    for value in np.unique(values):
        if np.abs(result - value).min() > least:
            result = np.sort(np.append(result, value))
    return result


def _at_lines(lines: Lines) -> Floats:
    """Return (k, 3) rows (low, high, size) of short spans that hug each section line."""
    gaps = np.diff(lines.u)
    size = HUG * np.minimum(np.append(gaps, gaps[-1]), np.insert(gaps, 0, gaps[0]))
    return np.column_stack([lines.u - lines.stray - HUGGED * size, lines.u + lines.stray + HUGGED * size, size])


def _count(space: RefinedSpace) -> int:
    return in_patches(space.outer.shape, space.rectangle, space)

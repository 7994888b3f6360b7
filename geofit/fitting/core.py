"""A surface with a core: interpolated where the points are dense, approximated around (paper, sec. 3.2).

The steps: choose the regional field on a coarse space; lay knots that follow the core's points; solve the field
there; let the core pass through its points; approximate the periphery with what it borrows from the core.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.data.errors import ExactnessError
from geofit.data.long_arrays import everywhere, spread
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data, degree_for
from geofit.fitting.approximate import fixed_by_core
from geofit.fitting.assemble import carried, multiply_knots
from geofit.fitting.caps import cap_for, in_patches
from geofit.fitting.contradiction import CLIFF, SHARED, near_noise, torn_points
from geofit.fitting.core_patch import (
    FIELD_SPAN,
    LAID,
    NARROW,
    Core,
    Limits,
    Through,
    on_coarse,
    span_sizes,
    through_points_locally,
    without_repeats,
)
from geofit.fitting.core_relief import relief_of_core
from geofit.fitting.field import FieldChoice, Smoothed, plane_trend
from geofit.fitting.knots import graded_breaks, neighbour_pairs, some_breaks
from geofit.fitting.net import Net
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.periphery import Periphery
from geofit.fitting.resolution import CLOSE, Choice, choose_field, longest_span
from geofit.fitting.skin import (
    curve_lines,
    lofted,
    minimum_norm_correction,
    refine_knots,
    ruled,
    section_lines,
)
from geofit.fitting.split import Split
from geofit.splines import bspline
from geofit.splines.refined import RefinedSpace, outer_of
from geofit.splines.tensor import TensorSpace

__all__ = ["fit_with_core"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Rectangle = tuple[float, float, float, float]

#: Control points a data point beside a core, and how many it may take where its points are met with no fewer.
A_POINT, LAST_CAP = 15, 60
#: Longest span outside a core, in units of the spacing of the sparse points: on longer ones no rough field fits.
LONGEST = 0.45
#: The same where the likelihood asks for a field on finer spans than evenly spaced points do, as far as the cap allows.
LONGEST_IN_GROUPS = 0.35
#: Spans below this share of the shortest that points in groups resolve calm a field that would swing: they are kept.
#: (Spans that divide an area evenly are a little shorter than was asked for.)
CALMED = 0.9
#: Noise above this share of the values' spread: points that do not support each other. It does not follow the
#: tolerances, which may be raised beyond all relief.
RESOLVED = 0.03
#: The same where this share of the points is on named sections: those are drawn, and what varies along them is relief.
RESOLVED_DRAWN, DRAWN = 0.2, 0.9
#: The same for noise within these shares of the interior tolerance: what is far below it bends no surface visibly.
LITTLE = ((3.0, RESOLVED), (1.0, 0.05), (0.3, 0.2))
#: Spans between neighbours of one section, as a share of their distance, where knots run through the whole surface.
ALONG = 1.8
#: No finer functions act on a core whose knots run through the whole surface.
NONE = np.zeros(0, bool)


def fit_with_core(
    points: PointSet,
    data: Data,
    parametrization: Parametrization,
    split: Split,
    kept: NDArray[np.bool_],
    settings: FitSettings,
    stage: Callable[[str, float], None],
    chosen: Choice | None = None,
    sketched: Sequence[FieldChoice] = (),
) -> Net:
    """Fit a surface whose core passes through its points.

    ``data`` are the points that are ``kept``. ``chosen`` is the field to take; None: it is chosen by these points, from
    ``sketched`` fields on if there are any.

    Raises
    ------
    ExactnessError
        If no control net within the cap passes through them without swinging between them.
    """
    assert split.core is not None
    data = data.whole()
    inside = split.inside[kept]
    scaled = [x / data.unit for x in split.core]
    core = (scaled[0], scaled[1], scaled[2], scaled[3])
    degree, most = degree_for(len(data.plane)), cap_for(settings, len(data.plane), A_POINT)
    stage("field", 0.25)
    field, coarse = choose_field(data, settings, most, sketched) if chosen is None else chosen
    between = ~parametrization.parametrized[kept]
    if parametrization.parametric:
        lines = curve_lines(data.plane[~between, 0])
        between |= ~np.isin(data.plane[:, 0], lines.u)
    else:
        lines = section_lines(data.plane[inside], parametrization.section[kept][inside], 0.5 * (core[1] - core[0]))
    given = Core(data, core, inside, between, field, coarse, lines, parametrization.parametric, settings, None)
    relief = relief_of_core(data, core, inside, field, settings, most, lambda: _near_noise(given))
    if relief is not None and not relief.field.contradictory:
        # Points do not contradict each other where a field of a shorter range follows them.
        field = replace(field, contradictory=False)
    given = replace(given, field=field, relief=relief)
    if settings.core == "auto" and settings.smoothing == "auto" and not parametrization.parametric:
        _refuse_noise(given, drawn=float(np.mean(parametrization.section[kept][inside] != "")))
    stage("core", 0.4)
    linear = settings.across == "linear" and degree == 3
    notes: tuple[Message, ...] = ()
    if linear and not lines.straight:
        linear = False
        notes = (
            message(
                "fitting.ruled-core-without-sections",
                "across='linear' needs at least two straight, named sections; the core is cubic across",
            ).with_severity("warning"),
        )
    longest = longest_span(coarse)
    if longest > CALMED * CLOSE:
        longest = min(LONGEST, max(longest, LONGEST_IN_GROUPS))
    first = limits = Limits(most, longest)
    # Curves that run through the whole surface, and a break at the core's edge, need knots that do so too.
    local = not (linear or parametrization.parametric or settings.seam == "position" or inside.all())
    while True:
        given = replace(given, inside=inside)
        try:
            through = through_points_locally(given, limits) if local else _through_points(given, limits, linear)
            break
        except ExactnessError:
            torn = _torn(given)
            if torn.any():
                notes = (*notes, *(_torn_note(points.describe(int(k))) for k in np.flatnonzero(kept)[torn]))
                inside = inside & ~torn
                continue
            # Exactness outranks economy; a cap that a person gave is kept.
            if settings.max_control_points is not None or limits.most > LAST_CAP * len(data.plane):
                if local:
                    # Of few control points, those that act across the edges of a patch are needed, too.
                    local, limits = False, first
                    continue
                if not (inside & between).any():
                    raise
                # The drawn curves of a fold outrank the points between them.
                notes = (*notes, _released_note(int((inside & between).sum())))
                inside, limits = inside & ~between, first
                continue
            if limits.longest < LONGEST:
                # Under the cap, the points of the core come before short spans outside it.
                limits = replace(limits, longest=LONGEST)
                continue
            limits = replace(limits, most=int(1.5 * limits.most), closer=0.75 * limits.closer)
    base, space, rule = through.base, through.space, through.rule
    if isinstance(space, RefinedSpace):
        core = space.rectangle
    if linear and rule is None:
        notes = (
            *notes,
            message(
                "fitting.ruled-core-not-exact",
                "a core linear across its sections cannot meet all of its points; it is cubic across",
            ).with_severity("warning"),
        )
    if limits.most > most:
        words = message(
            "fitting.core-too-many-control-points",
            "meeting every point of the core takes {count} control points, more than {a_point} a data point",
            count=in_patches(outer_of(space).shape, core, space),
            a_point=A_POINT,
        )
        notes = (*notes, words)
    stage("periphery", 0.6)
    outer = ~inside
    if not outer.any():
        total, frozen = through.coefficients + data.over_trend(space), fixed_by_core(outer_of(space), core).ravel()
        return Net(
            space, base, total, frozen, None, rule, data.unit, field, 0, settings.interior_tolerance,
            notes, outer, relief,
        )  # fmt: skip
    refit = settings.seam == "position"
    periphery = Periphery(data, outer, core, field, settings, limits.most, refit, through.held)
    found = periphery.fit(space, Smoothed(through.coefficients, through.plane))
    torn = np.zeros(len(outer), bool)
    torn[outer] = found.torn
    total = found.coefficients + data.over_trend(found.space)
    return Net(
        found.space, base, total, found.frozen, core, rule, data.unit, field, found.rounds, found.limit,
        notes + found.notes, torn, relief,
    )  # fmt: skip


def _through_points(core: Core, limits: Limits, linear: bool) -> Through:
    """Lay knots of the whole surface within the limits, fit the field on them, and pass through the core's points.

    Raises
    ------
    ExactnessError
        If so many control points cannot pass through the points.
    """
    data, lines = core.data, core.lines
    degree, chosen = degree_for(len(data.plane)), core.chosen
    plane = data.plane[chosen]
    pairs = neighbour_pairs(plane)
    tried, rounds = [], max(core.settings.max_iterations, 1)
    for laid in LAID:
        breaks, counted = _breaks(plane, pairs, core, limits, laid)
        span = min(FIELD_SPAN, limits.longest)
        some = [some_breaks(along, span) for along in breaks]
        base = core.coarse if on_coarse(core, degree) else TensorSpace.on_breaks(some[0], some[1], degree)
        regional = data.smoothed(base, core.field)
        misfit = data.value[chosen] - core.field_at(base, regional.coefficients, plane)
        refined = refine_knots(
            *breaks, plane, pairs, misfit, lambda u, v: TensorSpace.on_breaks(u, v, degree), counted, rounds, data.unit
        )
        tried.append((refined.strain, base, regional, refined.breaks))
        if refined.strain <= 1.0:
            break
    _, base, regional, breaks = min(tried, key=itemgetter(0))
    fine = TensorSpace.on_breaks(*breaks, degree)
    _, start = carried(base, regional.coefficients, fine.knots_u, fine.knots_v)
    if core.relief is not None:
        start = core.relief.blended(fine, start)
    if linear:
        low, high = core.rectangle[:2]
        within = lines.u[(lines.u > low) & (lines.u < high)]
        rule = without_repeats(within, (low, high), NARROW * (high - low) / len(lines.u))
        try:
            return Through(base, *_skinned(fine, start, core, rule), regional.plane, rule, NONE)
        except ExactnessError:
            pass
    if core.parametric and lines.straight:
        return Through(base, fine, _lofted(fine, start, core), regional.plane, None, NONE)
    return Through(base, *_skinned(fine, start, core, None), regional.plane, None, NONE)


def _breaks(
    plane: Floats, pairs: Ints, given: Core, limits: Limits, laid: float
) -> tuple[tuple[Floats, Floats], Callable[[tuple[int, int]], bool]]:
    """Lay breaks of the whole surface that follow the core's points, ``plane`` (m, 2) with the ``pairs`` of neighbours.

    They use the share ``laid`` of the control points that the cap allows. Return also a function that states whether
    the cap allows a net of a given shape.
    """
    core, lines, area, degree = given.rectangle, given.lines, given.data.area, degree_for(len(given.data.plane))
    within = lines.u[(lines.u > core[0]) & (lines.u < core[1])]
    narrow = NARROW * (core[1] - core[0]) / max(len(lines.u), 1)
    required_u = without_repeats(within, (area[0], core[0], core[1], area[1]), narrow)
    required_v = np.array([area[2], core[2], core[3], area[3]])
    sizes_u, sizes_v = span_sizes(given, plane, pairs, limits, ALONG)
    stretch = 1.0
    while True:
        scale = np.array([1.0, 1.0, stretch])
        breaks_u = graded_breaks(required_u, limits.longest * stretch, sizes_u * scale)
        breaks_v = graded_breaks(required_v, limits.longest * stretch, sizes_v * scale)
        space = TensorSpace.on_breaks(breaks_u, breaks_v, degree)
        if in_patches(space.shape, core, space) <= laid * limits.most or stretch > 1e3:
            break
        stretch *= 1.1

    def counted(shape: tuple[int, int]) -> bool:
        return in_patches(shape, core, space) <= limits.most

    return (breaks_u, breaks_v), counted


def _refuse_noise(core: Core, drawn: float) -> None:
    """Refuse to pass through points whose noise is not small against their relief.

    ``drawn`` is the share of them on named sections. What the field takes for noise is relief where the nearest points
    differ by far less.

    Raises
    ------
    ExactnessError
        If it is not.
    """
    field = core.field if core.relief is None else core.relief.field
    relief, tolerance = max(field.spread, core.field.spread), core.settings.interior_tolerance
    # Noise of points that are not on sections is compared with the core's own relief: steep ground around the core
    # does not make it smaller.
    resolved = RESOLVED_DRAWN * relief if drawn >= DRAWN else RESOLVED * min(relief, _relief(core))
    limit = max(resolved, *(min(share * tolerance, part * relief) for share, part in LITTLE))
    if field.noise <= limit:
        return
    if _near_noise(core) > max(limit, SHARED * field.noise):
        raise ExactnessError(
            message(
                "fitting.points-support-to-noise",
                "its points agree only to about {noise:.3g} m, while their height varies by about {spread:.3g} m",
                noise=field.noise,
                spread=_relief(core),
            )
        )


def _relief(core: Core) -> float:
    """Return the deviation of a core's points from their plane, metres."""
    inside = np.flatnonzero(core.inside)
    plane, value = core.data.plane[inside], core.data.value[inside]
    trend = plane_trend(plane, value, everywhere(1.0, len(inside)))
    return spread(value - trend[0] - plane @ trend[1:])


def _near_noise(core: Core) -> float:
    """Return the noise about its field that the nearest points of a core show, metres."""
    inside = np.flatnonzero(core.inside)
    return near_noise(core.data.plane[inside], core.misfit(inside))


def _torn(core: Core) -> NDArray[np.bool_]:
    """Return (n,) the core's points to let go: of two that ask for a cliff, the one farther from the field.

    No point of a fold's section curves is.
    """
    data, chosen = core.data, np.flatnonzero(core.inside)
    torn, loose = np.zeros(len(core.inside), bool), core.between[chosen] | (not core.parametric)
    if loose.any():
        plane, misfit = data.plane[chosen], core.misfit(chosen)
        size = np.linalg.norm(misfit.reshape(len(chosen), -1), axis=1)
        torn[chosen] = torn_points(data.unit * plane, misfit, neighbour_pairs(plane), loose, CLIFF, lambda: size)
    return torn


def _torn_note(point: Message) -> Message:
    note = message(
        "fitting.core-points-contradict",
        "{point} contradicts a point very close to it: the core cannot meet both and passes through the other",
        point=point,
    )
    return note.with_severity("warning")


def _released_note(count: int) -> Message:
    note = message(
        "fitting.points-between-sections-released",
        "points between the sections, {count}: no surface meets them and the section curves exactly; "
        "it passes through the curves, and the points are measured to it",
        count=count,
    )
    return note.with_severity("warning")


def _skinned(
    space: TensorSpace,
    coefficients: Floats,
    given: Core,
    rule: Floats | None,
) -> tuple[TensorSpace, Floats]:
    """Let the surface pass through the core's points (eq. 2), and open the seams as far as the joint asks.

    Simple knots join patches with one tangent plane and one curvature; a core ruled between its section curves
    (at ``rule``), which has no curvature across, needs a double knot to join by its tangent plane; a full knot
    allows a break.
    """
    core, data, inside, p = given.rectangle, given.data, given.inside, space.degree
    broken = given.settings.seam == "position"
    at_u = dict.fromkeys(_inner(core[:2], space.knots_u), p if broken else 1 if rule is None else p - 1)
    at_v = dict.fromkeys(_inner(core[2:], space.knots_v), p if broken else 1)
    if rule is not None:
        at_u.update(dict.fromkeys(rule[1:-1].tolist(), p))
    space, coefficients = multiply_knots(space, coefficients, at_u, at_v)
    matrix, value = space.matrix(data.plane[inside]), data.value[inside]
    if rule is None:
        return space, coefficients + minimum_norm_correction(matrix, value - matrix @ coefficients)
    # The unknowns are the section curves; the rows of control points between them lie on straight lines.
    held = fixed_by_core(space, core)
    rows = np.flatnonzero(held.any(axis=1))
    nv = space.shape[1]
    net = coefficients.reshape(*space.shape, -1)
    abscissa = bspline.greville(space.knots_u, p)[rows]
    nearest = rows[np.abs(abscissa[:, None] - rule).argmin(axis=0)]
    start = net[nearest].reshape(len(rule) * nv, *coefficients.shape[1:])
    spread = ruled(space, rule, rows)
    columns = (rows[:, None] * nv + np.arange(nv)).ravel()
    acting = matrix[:, columns] @ spread
    start = start + minimum_norm_correction(acting, value - acting @ start)
    result = coefficients.copy()
    mine = held[rows].ravel()
    result[columns[mine]] = (spread @ start)[mine]
    return space, result


def _lofted(space: TensorSpace, coefficients: Floats, core: Core) -> Floats:
    """Lay a parametric surface through its section curves, each through its points, then through those between.

    The hinges of a fold are sharper than the spacing of its sections: the regional field would round them off
    between the sections, where the curves on both sides carry them on. A point between them says nothing about the
    curves: what it asks for is a change of its own surroundings.
    """
    data, lines = core.data, core.lines.u
    through = bspline.collocation(space.knots_u, space.degree, lines)
    net = coefficients.reshape(*space.shape, -1)
    start = np.einsum("ki,ijc->kjc", through, net).reshape(len(lines) * space.shape[1], *coefficients.shape[1:])
    spread = lofted(space, lines)
    matrix, value = space.matrix(data.plane[core.inside]), data.value[core.inside]
    drawn = np.flatnonzero(~core.between[core.inside])
    acting = csr_array(matrix[drawn] @ spread)
    curves = np.asarray(spread @ (start + minimum_norm_correction(acting, value[drawn] - acting @ start)))
    if len(drawn) == len(value):
        return curves
    return curves + minimum_norm_correction(matrix, value - matrix @ curves)


def _inner(edges: tuple[float, float], knots: Floats) -> list[float]:
    return [float(x) for x in edges if knots[0] < x < knots[-1]]

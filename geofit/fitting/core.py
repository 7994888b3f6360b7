"""A surface with a core: interpolated where the points are dense, approximated around (paper, sec. 3.2).

The steps: choose the regional field on a coarse space; lay knots that follow the core's points; solve the field
there; let the core pass through its points; approximate the periphery with what it borrows from the core.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import ExactnessError
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.approximate import borrowed
from geofit.fitting.assemble import multiply_knots
from geofit.fitting.field import Field, cell_weights, smooth
from geofit.fitting.knots import graded_breaks, neighbour_pairs, pair_sizes
from geofit.fitting.net import COARSE, EVEN, Data, Net, Periphery, cap_for, choose_field, degree_for, gather, in_patches
from geofit.fitting.parametrize import Chart
from geofit.fitting.partition import Split
from geofit.fitting.skin import Lines, across_curves, least_change, ruled, section_lines, separate
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

__all__ = ["fit_with_core"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]

#: Longest span beside a core, in units of the spacing of the sparse points.
LONGEST = 0.8
#: Spans between neighbours of one section, and of neighbouring sections, as a share of their distance.
ALONG, ACROSS = 1.8, 1.0
#: Lines nearer to the core's edge or to each other than this share of their mean distance get one knot.
NARROW = 0.2
#: Noise above this share of the values' spread, and above epsilon: points that do not bear each other out.
RESOLVED = 0.02


def fit_with_core(
    points: PointSet,
    chart: Chart,
    split: Split,
    kept: NDArray[np.bool_],
    settings: FitSettings,
    stage: Callable[[str, float], None],
) -> Net:
    """Fit a surface whose core passes through its points.

    Raises
    ------
    ExactnessError
        If no control net within the cap passes through them without swinging between them.
    """
    assert split.core is not None
    data = gather(points, chart, kept, split)
    inside = split.inside[kept]
    scaled = [x / data.unit for x in split.core]
    core = (scaled[0], scaled[1], scaled[2], scaled[3])
    degree, most = degree_for(len(data.plane)), cap_for(settings, len(data.plane))
    stage("field", 0.25)
    coarse = _coarse_space(data, core, inside, degree, min(COARSE, most))
    field = choose_field(data, coarse, settings)
    chosen = settings.core == "auto" and settings.smoothing == "auto" and not chart.parametric
    if chosen and field.noise > max(settings.epsilon, RESOLVED * field.spread):
        raise ExactnessError(
            message(
                "fit.points-bear-epsilon",
                "its points bear each other out to about {noise:.3g} m only, more than epsilon {epsilon:g} m",
                noise=field.noise,
                epsilon=settings.epsilon,
            )
        )
    stage("core", 0.4)
    lines = section_lines(data.plane[inside], chart.section[kept][inside], 0.5 * (core[1] - core[0]))
    linear = settings.across == "linear" and degree == 3
    notes: tuple[Message, ...] = ()
    if linear and not lines.straight:
        linear = False
        notes = (
            message(
                "fit.across-linear-needs-least",
                "across='linear' needs at least two straight, named sections; the core is cubic across",
            ).with_severity("warning"),
        )
    breaks = _breaks(data, core, inside, field, coarse, lines, most, settings)
    knots = [bspline.clamped_knots(along, degree) for along in breaks]
    space = TensorSpace(knots[0], knots[1], degree)
    weight = cell_weights(space, data.plane, data.accuracy)
    smoothed = smooth(space, field, data.plane, data.value, weight)
    rule = None
    if linear:
        within = lines.u[(lines.u > core[0]) & (lines.u < core[1])]
        rule = _apart(within, (core[0], core[1]), NARROW * (core[1] - core[0]) / len(lines.u))
        try:
            space, coefficients = _skinned(space, smoothed, core, data, inside, settings, rule)
        except ExactnessError:
            rule = None
            notes = (
                message(
                    "fit.core-linear-across-sections",
                    "a core linear across its sections cannot meet all of its points; it is cubic across",
                ).with_severity("warning"),
            )
    if rule is None and chart.parametric and lines.straight:
        coefficients = _lofted(space, smoothed, data, inside, lines.u)
    elif rule is None:
        space, coefficients = _skinned(space, smoothed, core, data, inside, settings, None)
    stage("periphery", 0.6)
    outer = ~inside
    frozen = borrowed(space, core).ravel()
    if not outer.any():
        total = coefficients + data.over_trend(space)
        return Net(space, total, frozen, None, rule, data.unit, field, 0, notes)
    periphery = Periphery(data, outer, core, field, settings, most, refit=settings.seam == "position")
    space, coefficients, frozen, rounds, more = periphery.fit(space, coefficients)
    total = coefficients + data.over_trend(space)
    return Net(space, total, frozen, core, rule, data.unit, field, rounds, notes + more)


def _coarse_space(data: Data, core: Rectangle, inside: NDArray[np.bool_], degree: int, most: int) -> TensorSpace:
    """Return the space on which the field is chosen: spans as fine as the points of the core, and of the rest."""
    dense = float(np.sqrt((core[1] - core[0]) * (core[3] - core[2]) / inside.sum()))
    span, area = EVEN, data.area
    while True:
        breaks = [
            graded_breaks([*area[k : k + 2], *core[k : k + 2]], span, np.array([[*core[k : k + 2], span * dense]]))
            for k in (0, 2)
        ]
        knots = [bspline.clamped_knots(along, degree) for along in breaks]
        space = TensorSpace(knots[0], knots[1], degree)
        if space.size <= most or span > 1e3:
            return space
        span *= 1.1


def _breaks(
    data: Data,
    core: Rectangle,
    inside: NDArray[np.bool_],
    field: Field,
    coarse: TensorSpace,
    lines: Lines,
    most: int,
    settings: FitSettings,
) -> tuple[Floats, Floats]:
    """Lay breaks that follow the core's points, and split them where two points pull one control point apart."""
    plane, degree, area = data.plane[inside], coarse.degree, data.area
    pairs = neighbour_pairs(plane)
    within = lines.u[(lines.u > core[0]) & (lines.u < core[1])]
    narrow = NARROW * (core[1] - core[0]) / max(len(lines.u), 1)
    required_u = _apart(within, (area[0], core[0], core[1], area[1]), narrow)
    required_v = np.array([area[2], core[2], core[3], area[3]])
    sizes_u = np.empty((0, 3)) if lines.straight else pair_sizes(plane, pairs, 0, ACROSS)
    sizes_v = pair_sizes(plane, pairs, 1, ALONG if lines.straight else ACROSS)
    stretch = 1.0
    while True:
        scale = np.array([1.0, 1.0, stretch])
        breaks_u = graded_breaks(required_u, LONGEST * stretch, sizes_u * scale)
        breaks_v = graded_breaks(required_v, LONGEST * stretch, sizes_v * scale)
        knots = [bspline.clamped_knots(along, degree) for along in (breaks_u, breaks_v)]
        space = TensorSpace(knots[0], knots[1], degree)
        if in_patches(space.shape, core, space) <= 0.9 * most or stretch > 1e3:
            break
        stretch *= 1.15
    weight = cell_weights(coarse, data.plane, data.accuracy)
    trial = smooth(coarse, field, data.plane, data.value, weight)
    misfit = data.value[inside] - coarse.matrix(plane) @ trial

    def counted(shape: tuple[int, int]) -> bool:
        return in_patches(shape, core, space) <= most

    return separate(breaks_u, breaks_v, plane, misfit, degree, counted, max(settings.max_iterations, 1))


def _apart(values: Floats, fixed: tuple[float, ...], least: float) -> Floats:
    """Return ascending values without those that all but repeat a fixed one or each other."""
    result = np.unique(fixed)
    for value in np.unique(values):
        if np.abs(result - value).min() > least:
            result = np.sort(np.append(result, value))
    return result


def _skinned(
    space: TensorSpace,
    coefficients: Floats,
    core: Rectangle,
    data: Data,
    inside: NDArray[np.bool_],
    settings: FitSettings,
    rule: Floats | None,
) -> tuple[TensorSpace, Floats]:
    """Let the surface pass through the core's points (eq. 2), and open the seams as far as the joint asks.

    Simple knots join patches with one tangent plane and one curvature; a core ruled between its section curves
    (at ``rule``), which has no curvature across, needs a double knot to join by its tangent plane; a full knot
    allows a break.
    """
    p = space.degree
    broken = settings.seam == "position"
    at_u = dict.fromkeys(_inner(core[:2], space.knots_u), p if broken else 1 if rule is None else p - 1)
    at_v = dict.fromkeys(_inner(core[2:], space.knots_v), p if broken else 1)
    if rule is not None:
        at_u.update(dict.fromkeys(rule[1:-1].tolist(), p))
    space, coefficients = multiply_knots(space, coefficients, at_u, at_v)
    matrix, value = space.matrix(data.plane[inside]), data.value[inside]
    if rule is None:
        return space, coefficients + least_change(matrix, value - matrix @ coefficients)
    # The unknowns are the section curves; the rows of control points between them lie on straight lines.
    held = borrowed(space, core)
    rows = np.flatnonzero(held.any(axis=1))
    nv = space.shape[1]
    net = coefficients.reshape(*space.shape, -1)
    abscissa = bspline.greville(space.knots_u, p)[rows]
    nearest = rows[np.abs(abscissa[:, None] - rule).argmin(axis=0)]
    start = net[nearest].reshape(len(rule) * nv, *coefficients.shape[1:])
    spread = ruled(space, rule, rows)
    columns = (rows[:, None] * nv + np.arange(nv)).ravel()
    acting = matrix[:, columns] @ spread
    start = start + least_change(acting, value - acting @ start)
    result = coefficients.copy()
    mine = held[rows].ravel()
    result[columns[mine]] = (spread @ start)[mine]
    return space, result


def _lofted(space: TensorSpace, coefficients: Floats, data: Data, inside: NDArray[np.bool_], lines: Floats) -> Floats:
    """Lay a parametric surface through its section curves, each curve through its points.

    The hinges of a fold are sharper than the spacing of its sections: the regional field would round them off
    between the sections, where the curves on both sides carry them on.
    """
    through = bspline.collocation(space.knots_u, space.degree, lines)
    net = coefficients.reshape(*space.shape, -1)
    start = np.einsum("ki,ijc->kjc", through, net).reshape(len(lines) * space.shape[1], *coefficients.shape[1:])
    spread = across_curves(space, lines)
    value = data.value[inside]
    acting = space.matrix(data.plane[inside]) @ spread
    return np.asarray(spread @ (start + least_change(acting, value - acting @ start)))


def _inner(edges: tuple[float, float], knots: Floats) -> list[float]:
    return [float(x) for x in edges if knots[0] < x < knots[-1]]

"""The control net: from points on a chart to the coefficients of one tensor-product surface.

Here stand what every fit needs (the points in units, the spaces, the caps) and the approximation: all points, or
those beside a core, whose net :mod:`geofit.fitting.core` makes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.approximate import approximate, borrowed
from geofit.fitting.assemble import multiply_knots
from geofit.fitting.field import ENOUGH, Field, cell_weights, choose, energy_band, plane_trend
from geofit.fitting.parametrize import Chart
from geofit.fitting.partition import Split
from geofit.splines import bspline
from geofit.splines.tensor import CELLWISE, Factor, TensorSpace

__all__ = [
    "COARSE",
    "EVEN",
    "Data",
    "Net",
    "Periphery",
    "approximate_all",
    "cap_for",
    "choose_field",
    "degree_for",
    "even_space",
    "gather",
    "in_patches",
]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]
Stage = Callable[[str, float], None]

#: Longest span of a surface without a core, in units of the spacing of the points.
EVEN = 0.6
#: Shortest span that is still halved for a point outside its tolerance.
FINEST = 0.05
#: Noise beyond this many times the interior tolerance is told: the points are met at the cost of what is between.
BENT = 3.0
#: Control points of the space on which the field is chosen.
COARSE = 1_600
#: Control points to try where points are many, and how many of these points choose the field.
LEVELS, PART = (1_000, 4_000, 16_000, 60_000), 50_000


@dataclass(frozen=True, eq=False)
class Net:
    """A fitted surface before it is cut into patches; lengths in u and v are counted in ``unit`` metres.

    ``coefficients`` (size,) heights or (size, 3) coordinates, metres; ``frozen`` (size,) marks the control
    points that act on the core; ``lines`` are the section lines of a core that is linear across them.
    """

    space: TensorSpace
    coefficients: Floats
    frozen: NDArray[np.bool_]
    core: Rectangle | None
    lines: Floats | None
    unit: float
    field: Field
    rounds: int
    notes: tuple[Message, ...]


@dataclass(frozen=True, eq=False)
class Data:
    """The points that the fit honours, in units, about their trend."""

    plane: Floats
    value: Floats
    accuracy: Floats
    area: Rectangle
    unit: float
    trend: Floats

    def over_trend(self, space: TensorSpace) -> Floats:
        """Return the trend's coefficients on a space."""
        u = bspline.greville(space.knots_u, space.degree)
        v = bspline.greville(space.knots_v, space.degree)
        plane = np.stack([np.ones(space.shape), *np.meshgrid(u, v, indexing="ij")], axis=-1)
        trend: Floats = plane.reshape(space.size, 3) @ self.trend
        return trend


def gather(points: PointSet, chart: Chart, kept: NDArray[np.bool_], split: Split | None) -> Data:
    """Return the points that the fit honours, in units of the spacing of the sparse ones, about their trend."""
    area = chart.area
    size, n = (area[1] - area[0]) * (area[3] - area[2]), int(kept.sum())
    sparse = int((~split.inside & kept).sum()) if split is not None else 0
    if split is not None and split.core is not None and sparse >= 10:
        c = split.core
        size, n = size - (c[1] - c[0]) * (c[3] - c[2]), sparse
    unit = float(np.sqrt(size / n))
    plane, value = chart.plane[kept] / unit, chart.values[kept]
    trend = plane_trend(plane, value, np.ones(len(plane)))
    base = trend[0] + plane @ trend[1:]
    scaled = (area[0] / unit, area[1] / unit, area[2] / unit, area[3] / unit)
    return Data(plane, value - base, points.accuracy[kept], scaled, unit, trend)


def degree_for(n: int) -> int:
    """Fewer than 16 points cannot hold a bicubic patch."""
    return 3 if n >= 16 else 2 if n >= 6 else 1


def even_space(area: Rectangle, span: float, degree: int, most: int) -> TensorSpace:
    """Return a space of even spans no longer than ``span``, or as long as the cap of control points asks for."""
    while True:
        counts = [max(int(np.ceil((area[k + 1] - area[k]) / span - 1e-9)), 1) for k in (0, 2)]
        if (counts[0] + degree) * (counts[1] + degree) <= most or max(counts) == 1:
            break
        span *= 1.02
    return TensorSpace(
        bspline.clamped_knots(np.linspace(area[0], area[1], counts[0] + 1), degree),
        bspline.clamped_knots(np.linspace(area[2], area[3], counts[1] + 1), degree),
        degree,
    )


def cap_for(settings: FitSettings, n: int) -> int:
    """Return the cap of the number of control points."""
    return settings.max_control_points or int(np.clip(10 * n, 400, 60_000))


def in_patches(shape: tuple[int, int], core: Rectangle | None, space: TensorSpace) -> int:
    """Return the control points of all patches: each seam adds knots, and a row that both sides count."""
    if core is None:
        return shape[0] * shape[1]
    rows = []
    for count, knots, edges in ((shape[0], space.knots_u, core[:2]), (shape[1], space.knots_v, core[2:])):
        inner = [x for x in edges if knots[0] < x < knots[-1]]
        rows.append(count + sum(space.degree + 1 - int((knots == x).sum()) for x in inner))
    return rows[0] * rows[1]


def choose_field(data: Data, space: TensorSpace, settings: FitSettings) -> Field:
    """Choose the regional field on a space (see :func:`geofit.fitting.field.choose`)."""
    weight = cell_weights(space, data.plane, data.accuracy)
    given = None if settings.smoothing == "auto" else float(settings.smoothing)
    return choose(space, data.plane, data.value, weight, given)


def approximate_all(
    points: PointSet, chart: Chart, kept: NDArray[np.bool_], settings: FitSettings, stage: Stage
) -> Net:
    """Fit a surface without a core: the smoothest one within the interior tolerance, as far as knots allow."""
    data = gather(points, chart, kept, None)
    n, degree = len(data.plane), degree_for(len(data.plane))
    most = cap_for(settings, n)
    stage("field", 0.25)
    if n >= CELLWISE and not chart.parametric:
        return _approximate_many(data, settings, most)
    space = even_space(data.area, EVEN, degree, most)
    field = choose_field(data, space, settings)
    stage("periphery", 0.5)
    start = np.zeros((space.size, *data.value.shape[1:]))
    periphery = Periphery(data, np.ones(n, bool), None, field, settings, most, refit=True)
    space, coefficients, frozen, rounds, notes = periphery.fit(space, start)
    return Net(space, coefficients + data.over_trend(space), frozen, None, None, data.unit, field, rounds, notes)


@dataclass(frozen=True, eq=False)
class Periphery:
    """The points to approximate, beside the core that lends its control points.

    Beside a core the regional field's fit stands already, and its core's edge is the patch's edge. ``refit``
    solves for it anew: without a core, or where a break is allowed at the seams.
    """

    data: Data
    outer: NDArray[np.bool_]
    core: Rectangle | None
    field: Field
    settings: FitSettings
    most: int
    refit: bool

    def fit(
        self, space: TensorSpace, start: Floats
    ) -> tuple[TensorSpace, Floats, NDArray[np.bool_], int, tuple[Message, ...]]:
        """Approximate, and add knots where points stay outside the tolerance, as far as the cap allows."""
        data, tolerance = self.data, self.settings.interior_tolerance
        plane, value = data.plane[self.outer], data.value[self.outer]
        # A tolerance finer than the data's own contradiction is reported, not chased; nor is a given smoothing.
        chased = not self.field.contradictory and self.settings.smoothing == "auto"
        rounds = self.settings.max_iterations if chased else 0
        total = 0
        while True:
            frozen = np.zeros(space.size, bool) if self.core is None else borrowed(space, self.core).ravel()
            energy = self.field.smoothing * energy_band(space, self.field.energy) if self.refit else None
            weight = cell_weights(space, data.plane, data.accuracy)[self.outer]
            result = approximate(space, energy, start, frozen, plane, value, weight, tolerance, rounds)
            total += result.rounds
            excess = np.where(result.misfit > tolerance, result.misfit, 0.0)
            at_u, at_v = self._new_knots(space, plane, excess) if chased else ({}, {})
            if not at_u and not at_v:
                break
            space, start = multiply_knots(space, result.coefficients, at_u, at_v)
        return space, result.coefficients, frozen, total, self._notes(excess)

    def _new_knots(
        self, space: TensorSpace, plane: Floats, excess: Floats
    ) -> tuple[dict[float, int], dict[float, int]]:
        """Halve the longer span at the worst points first; a knot never runs through the core."""
        breaks = [np.unique(space.knots_u), np.unique(space.knots_v)]
        ranges = [(np.inf, -np.inf)] * 2 if self.core is None else [self.core[:2], self.core[2:]]
        counts = list(space.shape)
        new: tuple[dict[float, int], dict[float, int]] = ({}, {})
        for point in np.argsort(-excess, kind="stable"):
            if excess[point] == 0:
                break
            choices = []
            for axis, (low, high) in enumerate(ranges):
                x = plane[point, axis]
                k = int(np.clip(np.searchsorted(breaks[axis], x, side="right") - 1, 0, len(breaks[axis]) - 2))
                span = float(breaks[axis][k + 1] - breaks[axis][k])
                if not low <= x <= high and span > FINEST:
                    choices.append((span, axis, float(breaks[axis][k] + breaks[axis][k + 1]) / 2))
            if not choices:
                continue
            _, axis, middle = max(choices)
            if middle not in new[axis]:
                counts[axis] += 1
                if in_patches((counts[0], counts[1]), self.core, space) > self.most:
                    break
                new[axis][middle] = 1
        return new

    def _notes(self, excess: Floats) -> tuple[Message, ...]:
        return (*self._bent_notes(), *self._excess_notes(excess))

    def _bent_notes(self) -> tuple[Message, ...]:
        """Say where meeting the points costs more between them than it gains at them."""
        noise, tolerance = self.field.noise, self.settings.interior_tolerance
        chased = not self.field.contradictory and self.settings.smoothing == "auto"
        if not chased or noise <= BENT * tolerance or len(self.data.plane) < ENOUGH:
            return ()
        note = message(
            "fit.points-scatter-smoothest-surface",
            "the points scatter by about {noise:.2g} m about the smoothest surface that they support; meeting each "
            "within {tolerance:g} m bends it between them, and an interior tolerance of about {wider:.2g} m would "
            "predict new holes better",
            noise=noise,
            tolerance=tolerance,
            wider=2 * noise,
        )
        return (note.with_severity("warning"),)

    def _excess_notes(self, excess: Floats) -> tuple[Message, ...]:
        count = int((excess > 0).sum())
        if not count:
            return ()
        reason = message("fit.no-control-points-allowed", "no more control points are allowed there")
        if self.field.contradictory:
            noise = self.field.noise
            reason = message(
                "fit.data-contradict-not-chased",
                "the data contradict each other by about {noise:.2f} m, which is not chased",
                noise=noise,
            )
        elif self.settings.smoothing != "auto":
            reason = message("fit.smoothing-given", "the smoothing is given")
        note = message(
            "fit.interior-tolerance-not-met",
            "interior tolerance {tolerance:g} m not met in height, points: {count}, worst {worst:.3f} m: {reason}",
            tolerance=self.settings.interior_tolerance,
            count=count,
            worst=float(excess.max()),
            reason=reason,
        )
        return (note.with_severity("warning"),)


def _approximate_many(data: Data, settings: FitSettings, most: int) -> Net:
    """Approximate more points than can be pulled one by one: refine while the fit gains by it.

    Energy and lambda, which do not depend on the number of points, are chosen on a part of them.
    """
    n = len(data.plane)
    part = slice(None, None, max(n // PART, 1))
    weight = np.ones(n)
    given = None if settings.smoothing == "auto" else float(settings.smoothing)
    coarse = even_space(data.area, EVEN, 3, LEVELS[0])
    field = choose(coarse, data.plane[part], data.value[part], weight[part], given)
    best: tuple[float, TensorSpace, Floats] | None = None
    for count in LEVELS:
        if best is not None and count > min(most, n / 3):
            break
        space = even_space(data.area, EVEN, 3, count)
        sums = space.sums(data.plane, data.value, weight)
        band, right = space.equations(sums)
        coefficients = Factor(band + field.smoothing * energy_band(space, field.energy)).solve(right)
        score = float(np.sqrt(sums.misfit(coefficients) * n)) / max(n - space.size, 1)
        if best is not None and score > 0.99 * best[0]:
            break
        best = (score, space, coefficients)
    assert best is not None
    noise, space, coefficients = best
    field = replace(field, noise=noise)
    note = message(
        "fit.points-judged-sigma-not",
        "{n} points are judged by sigma, not pulled into the tolerance one by one; noise about {noise:.3f} m",
        n=n,
        noise=noise,
    )
    free = np.zeros(space.size, bool)
    total = coefficients + data.over_trend(space)
    return Net(space, total, free, None, None, data.unit, field, 1, (note,))

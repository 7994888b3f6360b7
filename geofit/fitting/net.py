"""The control net: from points on a parametrization to the coefficients of one tensor-product surface.

This module holds what every fit needs (the net, the caps) and the approximation of all points, or of those outside a
core, whose net :mod:`geofit.fitting.core` makes.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.data.allowance import allowance, any_coarse, largest_noise
from geofit.data.long_arrays import Rows, blocks
from geofit.data.messages import Message, message
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data
from geofit.fitting.approximate import approximate, fixed_by_core, solved_beside
from geofit.fitting.assemble import with_knots
from geofit.fitting.core_relief import CoreRelief
from geofit.fitting.density import CLOUD
from geofit.fitting.field import (
    FieldChoice,
    Smoothed,
    precision_band,
    smooth,
)
from geofit.fitting.likelihood import plane_coefficients
from geofit.fitting.resolution import Choice, choose_field
from geofit.fitting.smoothness import ENOUGH
from geofit.geometry.cells import tabulate
from geofit.splines.patch import Patch
from geofit.splines.refined import RefinedSpace, Space, outer_of
from geofit.splines.tensor import TensorSpace

__all__ = [
    "Net",
    "Periphery",
    "approximate_all",
    "cap_for",
    "crowded",
    "in_patches",
    "smoothed",
]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]
Stage = Callable[[str, float], None]

#: Spans between the core and a point next to it that is met, so that some reach it and do not act on the core, and the
#: shortest of them, in units.
AT_CORE, LEAST = 2.5, 0.01
#: Span around a point that is met within its tolerance, in units: what lies between stays the field's.
NARROW = 0.15
#: Shortest span that is still halved for a point outside its tolerance.
FINEST = 0.05
#: Noise beyond this many times the interior tolerance is not noise, but relief between sparse points.
BENT = 3.0
#: Where points scatter by this share of their noise about the field, they are so many that it shows.
SHOWN = 0.8
#: Places whose rows are held at a time.
PART = 50_000
#: Spans across nine tenths of the points, below which no control points can follow them.
CROWDED = 4
#: Control points a data point, and their bounds.
A_POINT, FEWEST, MOST = 40, 1_600, 20_000


@dataclass(frozen=True, eq=False)
class Net:
    """A fitted surface before it is cut into patches; lengths in u and v are counted in ``unit`` metres.

    ``coefficients`` (size,) heights or (size, 3) coordinates, metres; ``frozen`` (size,) marks the control
    points that act on the core; ``lines`` are the section lines of a core that is linear across them. ``base`` is
    the space of the field, before knots were added; ``limit`` (m) is how far from the surface noise explains points.
    ``relief`` is the field that replaces it in the core, if there is one.
    """

    space: Space
    base: TensorSpace
    coefficients: Floats
    frozen: NDArray[np.bool_]
    core: Rectangle | None
    lines: Floats | None
    unit: float
    field: FieldChoice
    rounds: int
    limit: float
    notes: tuple[Message, ...]
    relief: CoreRelief | None = None


def cap_for(settings: FitSettings, n: int, a_point: int = A_POINT) -> int:
    """Return the cap of the number of control points."""
    return settings.max_control_points or int(np.clip(a_point * n, FEWEST, MOST))


def in_patches(shape: tuple[int, int], core: Rectangle | None, space: Space) -> int:
    """Return the control points of all patches: each seam adds knots, and a row that both sides count.

    ``shape`` is that of the net, outside of what is finer.
    """
    if core is None:
        return shape[0] * shape[1]
    rows, within = [], []
    for count, knots, edges in ((shape[0], space.knots_u, core[:2]), (shape[1], space.knots_v, core[2:])):
        inner = [x for x in edges if knots[0] < x < knots[-1]]
        rows.append(count + sum(space.degree + 1 - int((knots == x).sum()) for x in inner))
        within.append(int(((knots > edges[0]) & (knots < edges[1])).sum()) + space.degree + 1)
    finer = space.fine.size - within[0] * within[1] if isinstance(space, RefinedSpace) else 0
    return rows[0] * rows[1] + finer


def crowded(space: TensorSpace, plane: Rows) -> tuple[float, float] | None:
    """Return the extent of nine tenths of the points and the longest span there, if they lie within a few spans.

    Of an area far wider than its points no control points can follow them.
    """
    if len(plane) > CLOUD:
        return None
    low, high = np.quantile(plane[:], (0.05, 0.95), axis=0)
    spans = []
    for axis, knots in enumerate((space.knots_u, space.knots_v)):
        breaks = np.unique(knots)
        first, last = np.searchsorted(breaks, (low[axis], high[axis]), side="right")
        spans.append(float(np.diff(breaks[max(first - 1, 0) : last + 1]).max()))
    extent = float((high - low).max())
    return (extent, max(spans)) if extent < CROWDED * max(spans) else None


def smoothed(data: Data, space: TensorSpace, field: FieldChoice) -> Smoothed:
    """Return a chosen field on a space."""
    return smooth(space, field, data.weighted, data.trend, data.slopes)


def approximate_all(
    data: Data,
    settings: FitSettings,
    stage: Stage,
    chosen: Choice | None = None,
    sketched: Sequence[FieldChoice] = (),
) -> Net:
    """Fit a surface without a core: the field, brought within the interior tolerance of sparse points.

    ``chosen`` is the field to take; None: it is chosen by these points, from ``sketched`` fields on if there are any.
    """
    n = len(data.plane)
    most = cap_for(settings, n)
    stage("field", 0.25)
    field, base = choose_field(data, settings, most, sketched) if chosen is None else chosen
    start = smoothed(data, base, field)
    stage("periphery", 0.5)
    periphery = Periphery(data, np.ones(n, bool), None, field, settings, most, False, np.zeros(0, bool))
    found = periphery.fit(base, start)
    total = found.coefficients + data.over_trend(found.space)
    return Net(
        found.space, base, total, found.frozen, None, None, data.unit, field, found.rounds, found.limit, found.notes
    )


@dataclass(frozen=True, eq=False)
class PeripheryFit:
    """What an approximation gives: see :class:`Net`."""

    space: Space
    coefficients: Floats
    frozen: NDArray[np.bool_]
    rounds: int
    limit: float
    notes: tuple[Message, ...]


@dataclass(frozen=True, eq=False)
class Periphery:
    """The points to approximate, beside the core that lends its control points.

    The regional field's fit stands already, and its core's edge is the patch's edge. ``refit`` solves for it anew
    where a break is allowed at the seams. ``held`` (k,) marks the finer functions that act on the core's points; the
    others may move for other points in its patch.
    """

    data: Data
    outer: NDArray[np.bool_]
    core: Rectangle | None
    field: FieldChoice
    settings: FitSettings
    most: int
    refit: bool
    held: NDArray[np.bool_]

    def fit(self, space: Space, start: Smoothed) -> PeripheryFit:
        """Approximate, and add knots where points stay outside the tolerance, as far as the cap allows."""
        data, tolerance, base = self.data, self.settings.interior_tolerance, space
        coefficients = start.coefficients
        if self.refit and isinstance(space, TensorSpace):
            coefficients = self._refitted(space, start)
        chased = self._chased
        if not chased and self.outer.all():
            return self._unchanged(space, coefficients)
        plane, value = data.plane[:][self.outer], data.value[:][self.outer]
        misfit = _misfit(space, coefficients, plane, value)
        limit = self._limit(misfit)
        allowed = self._allowed(limit)
        rounds = self.settings.max_iterations if chased else 0
        if chased and (misfit > allowed).any():
            space, coefficients = self._narrowed(space, coefficients, plane[misfit > allowed])
        total, field = 0, coefficients
        if not chased or not (misfit > allowed).any():
            notes = self._notes(base, self._beyond(misfit, allowed, limit), limit)
            return PeripheryFit(space, coefficients, self._frozen(space), 0, limit, notes)
        while True:
            frozen = self._frozen(space)
            met = np.where(allowed > limit, allowed, tolerance)
            result = approximate(space, field, frozen, plane, value, met, allowed, rounds, self.settings.strict)
            total += result.rounds
            excess = np.where(result.misfit > allowed, result.misfit, 0.0)
            at_u, at_v = self._new_knots(space, plane, excess) if chased else ({}, {})
            if not at_u and not at_v:
                break
            space, field = with_knots(space, field, at_u, at_v)
        beyond = self._beyond(result.misfit, allowed, limit)
        notes = self._notes(base, beyond, limit, bool((result.released & (beyond > 0)).any()))
        return PeripheryFit(space, result.coefficients, frozen, total, limit, notes)

    def _unchanged(self, space: Space, coefficients: Floats) -> PeripheryFit:
        """Return the field's own surface, with what it leaves of the points: nothing but the distances is held."""
        misfit = _misfit(space, coefficients, self.data.plane, self.data.value)
        limit = self._limit(misfit)
        misfit[misfit <= self.settings.interior_tolerance] = 0.0
        return PeripheryFit(space, coefficients, self._frozen(space), 0, limit, self._notes(space, misfit, limit))

    @property
    def _chased(self) -> bool:
        """Whether points beyond the tolerance are met: not if the data contradict each other, nor by a given smoothing.

        Nor are those of a cloud (CLOUD). A tolerance finer than the data's own contradiction is reported, unless every
        point is to be met all the same.
        """
        sound = not self.field.contradictory and self.settings.smoothing == "auto"
        return self.settings.strict or (sound and len(self.data.plane) <= CLOUD)

    def _frozen(self, space: Space) -> NDArray[np.bool_]:
        if self.core is None:
            return np.zeros(space.size, bool)
        return np.concatenate([fixed_by_core(outer_of(space), self.core).ravel(), self.held])

    def _refitted(self, space: TensorSpace, start: Smoothed) -> Floats:
        """Solve for the control points beside the core again, in a space that may break at its edge."""
        data, over = self.data, plane_coefficients(space) @ start.plane
        plane = data.plane[:][self.outer]
        rest = data.value[:][self.outer] - np.column_stack([np.ones(len(plane)), plane]) @ start.plane
        frozen = self._frozen(space)
        weight = 1 / data.noise[self.outer] ** 2
        # The spans next to a core are of any length, which a form applied twice does not bear.
        energy = precision_band(space, self.field.at_most(space.degree))
        return over + solved_beside(space, energy, start.coefficients - over, frozen, plane, rest, weight)

    @cached_property
    def _coarse(self) -> bool:
        """Whether any point is known less accurately than the tolerance."""
        return any_coarse(self.data.accuracy, self.settings.interior_tolerance)

    @cached_property
    def _accurate(self) -> NDArray[np.bool_]:
        """Which of the points to approximate are not."""
        return ~(self.data.accuracy[self.outer] > self.settings.interior_tolerance)

    @cached_property
    def _noise(self) -> float:
        """Noise of the accurate points, metres: what excuses the coarse ones excuses none of these."""
        if not self._coarse:
            return self.field.noise
        relative = self.data.noise[self.outer][self._accurate]
        return self.field.noise * float(np.median(relative)) if len(relative) else 0.0

    def _limit(self, misfit: Floats) -> float:
        """Return how far a point may lie from the field: the tolerance, or as far as noise explains.

        It does where so many points show it that their misfit to the field is the noise itself, and where it is of the
        tolerance's size: what is far larger is relief between sparse points.
        """
        noise, tolerance = self._noise, self.settings.interior_tolerance
        if self._coarse:
            misfit = misfit[self._accurate]
        shown = float(np.sqrt(misfit @ misfit / max(len(misfit), 1))) > SHOWN * noise
        if self.settings.strict or not shown or noise > BENT * tolerance or len(misfit) < ENOUGH:
            return tolerance
        return max(tolerance, noise * largest_noise(len(misfit)))

    def _allowed(self, limit: float) -> Floats:
        """Return how far each point may lie from the field: as far as its own accuracy explains, where that is more.

        With ``strict`` every point is met all the same.
        """
        accuracy = self.data.accuracy[self.outer]
        if self.settings.strict:
            return np.full(len(accuracy), limit)
        return allowance(accuracy, self.settings.interior_tolerance, limit)

    def _beyond(self, misfit: Floats, allowed: Floats, limit: float) -> Floats:
        """Return the misfits beyond the tolerance that no accuracy of their own explains, 0 for all others."""
        explained = (allowed > limit) & (misfit <= allowed)
        return np.where((misfit > self.settings.interior_tolerance) & ~explained, misfit, 0.0)

    def _narrowed(self, space: Space, coefficients: Floats, corrected: Floats) -> tuple[Space, Floats]:
        """Shorten the spans around the points to pull, as far as the cap allows."""
        ranges = [(np.inf, -np.inf)] * 2 if self.core is None else [self.core[:2], self.core[2:]]
        stretch = 1.0
        while True:
            new = []
            for axis, knots in enumerate((space.knots_u, space.knots_v)):
                low, high = ranges[axis]
                x = corrected[(corrected[:, axis] < low) | (corrected[:, axis] > high), axis]
                # Next to the core, short enough for functions that do not act on it.
                longest = np.minimum(NARROW, np.maximum(np.maximum(low - x, x - high) / AT_CORE, LEAST))
                added = finer_breaks(np.unique(knots), x, stretch * longest)
                new.append(dict.fromkeys(added[(added < low) | (added > high)].tolist(), 1))
            nu, nv = outer_of(space).shape
            shape = (nu + len(new[0]), nv + len(new[1]))
            if in_patches(shape, self.core, space) <= self.most or not (new[0] or new[1]):
                break
            stretch *= 1.1
        return with_knots(space, coefficients, new[0], new[1]) if new[0] or new[1] else (space, coefficients)

    def _new_knots(self, space: Space, plane: Floats, excess: Floats) -> tuple[dict[float, int], dict[float, int]]:
        """Halve the longer span at the worst points first; a knot never runs through the core."""
        breaks = [np.unique(space.knots_u), np.unique(space.knots_v)]
        ranges = [(np.inf, -np.inf)] * 2 if self.core is None else [self.core[:2], self.core[2:]]
        counts = list(outer_of(space).shape)
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

    def _notes(self, base: Space, beyond: Floats, limit: float, released: bool = False) -> tuple[Message, ...]:
        if limit > self.settings.interior_tolerance and not (beyond > limit).any():
            return (*self._coarse_notes(), *self._noise_notes(beyond))
        return (*self._coarse_notes(), *self._bent_notes(), *self._excess_notes(base, beyond, released))

    def _coarse_notes(self) -> tuple[Message, ...]:
        """Count the points that are held to their own accuracy only."""
        if self.settings.strict or not self._coarse:
            return ()
        coarse = self.data.accuracy[self.outer][~self._accurate]
        if not len(coarse):
            return ()
        note = message(
            "fitting.points-less-accurate",
            "{count} points are known less accurately than the interior tolerance of {tolerance:g} m, at worst to "
            "{accuracy:.3g} m; the surface follows them only to their accuracy, and they count in sigma like all "
            "others",
            count=len(coarse),
            tolerance=self.settings.interior_tolerance,
            accuracy=float(coarse.max()),
        )
        return (note,)

    def _noise_notes(self, beyond: Floats) -> tuple[Message, ...]:
        """Count the points that lie beyond the tolerance because their own noise puts them there."""
        count = int((beyond > 0).sum())
        if not count:
            return ()
        note = message(
            "fitting.points-beyond-tolerance-as-noise",
            "{count} points beyond {tolerance:g} m, as noise of {noise:.3g} m predicts; they are listed, not fitted",
            count=count,
            tolerance=self.settings.interior_tolerance,
            noise=self._noise,
        )
        return (note,)

    def _bent_notes(self) -> tuple[Message, ...]:
        """Say where meeting the points costs more between them than it gains at them; coarse ones are not met."""
        noise, tolerance = self.field.noise, self.settings.interior_tolerance
        coarse = self._coarse and not self.settings.strict
        if coarse or not self._chased or noise <= BENT * tolerance or len(self.data.plane) < ENOUGH:
            return ()
        note = message(
            "fitting.points-scatter",
            "the points scatter by about {noise:.2g} m about the smoothest surface that they support; meeting each "
            "within {tolerance:g} m bends it between them, and an interior tolerance of about {wider:.2g} m would "
            "predict new holes better",
            noise=noise,
            tolerance=tolerance,
            wider=2 * noise,
        )
        return (note.with_severity("warning"),)

    def _excess_notes(self, base: Space, excess: Floats, released: bool) -> tuple[Message, ...]:
        count = int((excess > 0).sum())
        if not count:
            return ()
        reason = message("fitting.control-points-used-up", "no more control points are allowed there")
        if released:
            reason = message(
                "fitting.points-too-close-for-knots",
                "the knots there are longer than the distance to the next point or to the core, so the surface would "
                "swing if it met them (strict meets them where knots allow)",
            )
        close = crowded(outer_of(base), self.data.plane) if self.field.contradictory or released else None
        if close is not None:
            reason = message(
                "fitting.area-far-wider",
                "nine tenths of the points lie within {extent:.0f} m, but the study area is so wide that its control "
                "points are {span:.0f} m apart; draw the area around the points, or check the points farthest from "
                "the others",
                extent=close[0] * self.data.unit,
                span=close[1] * self.data.unit,
            )
        elif self.field.contradictory:
            noise = self.field.noise
            reason = message(
                "fitting.data-contradict",
                "the data contradict each other by about {noise:.2f} m, which is not fitted",
                noise=noise,
            )
        elif len(self.data.plane) > CLOUD:
            reason = message("fitting.cloud-not-met-by-points", "the points of a cloud are not met one by one")
        elif self.settings.smoothing != "auto":
            reason = message("fitting.smoothing-given", "the smoothing is given")
        note = message(
            "fitting.tolerance-not-met",
            "interior tolerance {tolerance:g} m not met in height, points: {count}, worst {worst:.3f} m: {reason}",
            tolerance=self.settings.interior_tolerance,
            count=count,
            worst=float(excess.max()),
            reason=reason,
        )
        return (note.with_severity("warning"),)


def finer_breaks(breaks: Floats, x: Floats, longest: Floats) -> Floats:
    """Return new breaks, between ascending ones, that leave no span longer than ``longest`` (k,) around places x (k,).

    Around a place lie its own span and the parts of others within two of the longest spans of it: where the bumps of
    cubic splines at that place lie. Spans are halved.
    """
    added = []
    for low, high in itertools.pairwise(breaks):
        near = (x > low - 2 * longest) & (x < high + 2 * longest)
        for least in np.unique(longest[near & (longest < high - low)]):
            parts = 2 ** int(np.ceil(np.log2((high - low) / least) - 1e-9))
            inner = np.linspace(low, high, parts + 1)
            mine = x[near & (longest == least)]
            away = np.abs((inner[:-1] + inner[1:])[:, None] / 2 - mine).min(axis=1)
            close = away < 2 * least + (high - low) / parts
            added.append(inner[1:-1][close[:-1] | close[1:]])
    return np.unique(np.concatenate(added)) if added else np.empty(0)


def _misfit(space: Space, coefficients: Floats, plane: Rows, value: Rows) -> Floats:
    """Return the distances of values at (n, 2) places, part by part: the rows of a million places fill the memory."""
    misfit = np.empty(len(plane))
    if coefficients.ndim == 1 and len(plane) > PART and isinstance(space, TensorSpace):
        # Heights of very many places: their cells' polynomials take a tenth of the time of the basis functions.
        net = np.zeros((*space.shape, 3))
        net[..., 2] = coefficients.reshape(space.shape)
        patch = Patch("", (space.degree, space.degree), space.knots_u, space.knots_v, net)
        cells = tabulate([patch]).coordinate(2)
        for rest, places, heights in blocks(misfit, plane, value):
            np.subtract(heights, cells.points(cells.locate(0, *places.T))[0], out=rest)
            np.abs(rest, out=rest)
        return misfit
    for start in range(0, len(plane), PART):
        part = slice(start, start + PART)
        misfit[part] = _size(value[part] - space.matrix(plane[part]) @ coefficients)
    return misfit


def _size(misfit: Floats) -> Floats:
    return np.abs(misfit) if misfit.ndim == 1 else np.linalg.norm(misfit, axis=1)

"""The points outside a core, or all where there is none: brought within their tolerance where that is sound.

Noise is counted, not followed. What else the regional field leaves of the points is relief between them: it is met by
narrow corrections, for which the spans around the points are shortened.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.spatial import KDTree

from geofit.data.allowance import allowance, any_coarse, largest_noise
from geofit.data.long_arrays import Rows, blocks
from geofit.data.messages import Message, message
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data
from geofit.fitting.approximate import approximate, fixed_by_core, solved_beside
from geofit.fitting.assemble import with_knots
from geofit.fitting.caps import UTMOST, crowded, in_patches
from geofit.fitting.contradiction import CLIFF, neighbours_within, off_neighbours, torn_points
from geofit.fitting.density import CLOUD
from geofit.fitting.field import FieldChoice, Smoothed, precision_band
from geofit.fitting.likelihood import plane_coefficients
from geofit.fitting.resolution import mostly_noise
from geofit.fitting.smoothness import ENOUGH
from geofit.geometry.cells import tabulate
from geofit.splines.patch import Patch
from geofit.splines.refined import Space, outer_of
from geofit.splines.tensor import TensorSpace

__all__ = ["BLUNDER", "Periphery", "PeripheryFit"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]

#: Spans between the core and a point next to it that is met, so that some reach it and do not act on the core, and the
#: shortest of them, in units.
AT_CORE, LEAST = 2.5, 0.01
#: Span around a point that is met within its tolerance, in units: what lies between stays the field's.
NARROW = 0.15
#: Shortest span that is still halved for a point outside its tolerance, in units; for one with a nearer neighbour, so
#: many times their distance.
FINEST, SEPARATE = 0.05, 0.5
#: Neighbours nearer than this, in units, that ask for a steeper slope about the field contradict each other.
NEAR, STEEPEST = 0.2, 1.0
#: Where a field takes most of the relief for noise, a point so many times as far from it, and from its neighbours, as
#: half of the points are is wrong.
BLUNDER = 8.0
#: Noise beyond this many times the interior tolerance is not noise, but relief between sparse points.
BENT = 3.0
#: Where points scatter by this share of their noise about the field, they are so many that it shows.
SHOWN = 0.8
#: Points this near to the core, in units, show whether the surface breaks at its edge. They are left out in so many
#: parts; what a surface with a break misses them by must stay below this share of what one without misses.
BESIDE, LEFT_OUT, PAID = 1.0, 5, 0.8
#: Places whose rows are held at a time.
PART = 50_000


@dataclass(frozen=True, eq=False)
class PeripheryFit:
    """What an approximation gives: see :class:`geofit.fitting.net.Net`; ``torn`` (m,) marks some of its own points."""

    space: Space
    coefficients: Floats
    frozen: NDArray[np.bool_]
    rounds: int
    limit: float
    notes: tuple[Message, ...]
    torn: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Demand:
    """The points to approximate: (m, 2) places in units, (m,) or (m, k) values, and what they ask of the surface, (m,).

    It comes to lie as near as ``met`` to those beyond what is ``allowed``, metres. ``torn`` points contradict those
    around them, and are let go. Spans are halved down to the ``shortest``, in units: short enough to separate
    neighbours, but not to build a cliff.
    """

    plane: Floats
    value: Floats
    met: Floats
    allowed: Floats
    torn: NDArray[np.bool_]
    shortest: Floats


@dataclass(frozen=True, eq=False)
class _Pulled:
    """A surface pulled to points: what it leaves of them, and how many are ``left`` too far away.

    ``asked`` is the number of control points that their spans ask for, 0 where the cap allowed it.
    """

    space: Space
    coefficients: Floats
    misfit: Floats
    rounds: int
    left: int
    asked: int


@dataclass(frozen=True, eq=False)
class Periphery:
    """The points to approximate, next to the core that lends its control points.

    The regional field's fit stands already, and its core's edge is the patch's edge. ``refit`` solves for it anew
    where a break is allowed at the seams and the points show one. ``held`` (k,) marks the finer functions that act on
    the core's points; the others may move for other points in its patch.
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
        base, coefficients = space, start.coefficients
        if self.refit and self.core is not None and isinstance(space, TensorSpace):
            coefficients = self._refitted(space, start, self.core)
        if not self._chased and self.outer.all():
            return self._unchanged(space, coefficients)
        misfit = _misfit(space, coefficients, self.data.plane[:][self.outer], self.data.value[:][self.outer])
        limit = self._limit(misfit)
        allowed = self._allowed(limit)
        if not self._chased or not (misfit > allowed).any():
            notes = self._notes(base, self._beyond(misfit, allowed, limit), limit)
            return PeripheryFit(space, coefficients, self._frozen(space), 0, limit, notes, np.zeros(len(misfit), bool))
        demand = self._demand(space, coefficients, limit, allowed)
        most, rounds = self.most, 0
        best: _Pulled | None = None
        while True:
            pulled = self._pulled(space, coefficients, demand, most)
            rounds += pulled.rounds
            if best is None or pulled.left < best.left:
                best = pulled
            if not pulled.left or most >= UTMOST or not self._affordable(pulled.asked):
                break
            most = min(int(1.5 * most), UTMOST)
        beyond = self._beyond(best.misfit, allowed, limit)
        torn, frozen = demand.torn & (beyond > 0), self._frozen(best.space)
        notes = self._notes(base, np.where(torn, 0.0, beyond), limit, pulled.asked)
        return PeripheryFit(best.space, best.coefficients, frozen, rounds, limit, notes, torn)

    def _demand(self, space: Space, coefficients: Floats, limit: float, allowed: Floats) -> _Demand:
        """Return which of the points are met how closely, and with spans how short."""
        settings, unit = self.settings, self.data.unit
        plane, value, outer = self.data.plane[:], self.data.value[:], self.outer
        off = value - space.matrix(plane) @ coefficients
        excused, torn = np.zeros(len(plane)), np.zeros(len(plane), bool)
        excused[outer] = allowed
        if not settings.strict:
            doubt = cache(lambda: off_neighbours(plane, value))
            torn = torn_points(unit * plane, off, neighbours_within(plane, NEAR), outer, STEEPEST, doubt, excused)
            if mostly_noise(self.field):
                size = _size(off)
                torn |= outer & (size > excused) & _far_out(size, outer) & _far_out(doubt(), outer)
        apart, index = (np.asarray(found)[:, 1] for found in KDTree(plane).query(plane, k=2, workers=-1))
        gentle = _size(off - off[index]) <= CLIFF * unit * apart
        shortest = np.where(gentle, np.minimum(SEPARATE * apart, FINEST), FINEST)
        met = np.where(allowed > limit, allowed, settings.interior_tolerance)
        bound = np.where(torn[outer], np.inf, allowed)
        return _Demand(plane[outer], value[outer], met, bound, torn[outer], shortest[outer])

    def _affordable(self, asked: int) -> bool:
        """Whether the cap yields to points that ask for more control points; one that a person gave does not."""
        return self.settings.max_control_points is None and self.core is None and 0 < asked <= UTMOST

    def _pulled(self, space: Space, coefficients: Floats, demand: _Demand, most: int) -> _Pulled:
        """Meet the points that lie farther away than is allowed, with so many control points at most."""
        plane, value, met, allowed = demand.plane, demand.value, demand.met, demand.allowed
        far = _misfit(space, coefficients, plane, value) > allowed
        space, field, asked = self._narrowed(space, coefficients, plane[far], most)
        rounds, settings = 0, self.settings
        while True:
            frozen = self._frozen(space)
            result = approximate(
                space, field, frozen, plane, value, met, allowed, settings.max_iterations, settings.strict
            )
            rounds += result.rounds
            excess = np.where(result.misfit > allowed, result.misfit, 0.0)
            at_u, at_v, full = self._new_knots(space, demand, excess, most)
            if full:
                asked = max(asked, most + 1)
            if not at_u and not at_v:
                left = int((excess > 0).sum())
                return _Pulled(space, result.coefficients, result.misfit, rounds, left, asked)
            space, field = with_knots(space, field, at_u, at_v)

    def _unchanged(self, space: Space, coefficients: Floats) -> PeripheryFit:
        """Return the field's own surface, with what it leaves of the points: nothing but the distances is held."""
        misfit = _misfit(space, coefficients, self.data.plane, self.data.value)
        limit = self._limit(misfit)
        misfit[misfit <= self.settings.interior_tolerance] = 0.0
        notes = self._notes(space, misfit, limit)
        return PeripheryFit(space, coefficients, self._frozen(space), 0, limit, notes, np.zeros(len(misfit), bool))

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

    def _refitted(self, space: TensorSpace, start: Smoothed, core: Rectangle) -> Floats:
        """Solve for the control points next to the core again, in a space that may break at its edge.

        The start stays unless the points pay for a break: those next to the core, left out in turn, must be predicted
        better with it than with the core's tangent planes.
        """
        data, over = self.data, plane_coefficients(space) @ start.plane
        plane = data.plane[:][self.outer]
        rest = data.value[:][self.outer] - np.column_stack([np.ones(len(plane)), plane]) @ start.plane
        weight = 1 / data.noise[self.outer] ** 2
        beyond = np.maximum(np.maximum(np.array(core[::2]) - plane, plane - np.array(core[1::2])), 0.0)
        near = np.linalg.norm(beyond, axis=1) < BESIDE
        if near.sum() < LEFT_OUT:
            return start.coefficients
        # The spans next to a core are of any length, which a form applied twice does not bear.
        energy = precision_band(space, self.field.at_most(space.degree))

        def solved(frozen: NDArray[np.bool_], used: NDArray[np.bool_]) -> Floats:
            return solved_beside(
                space, energy, start.coefficients - over, frozen, plane[used], rest[used], weight[used]
            )

        def missed(frozen: NDArray[np.bool_]) -> float:
            total, part = 0.0, np.arange(len(plane)) % LEFT_OUT
            for k in range(LEFT_OUT):
                left = near & (part == k)
                off = rest[left] - space.matrix(plane[left]) @ solved(frozen, part != k)
                total += float(weight[left] @ _size(off) ** 2)
            return total

        position = self._frozen(space)
        tangent = binary_dilation(position.reshape(space.shape), np.ones((3, 3), bool)).ravel()
        if missed(position) >= PAID * missed(tangent):
            return start.coefficients
        return over + solved(position, np.ones(len(plane), bool))

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

    def _narrowed(self, space: Space, coefficients: Floats, corrected: Floats, most: int) -> tuple[Space, Floats, int]:
        """Shorten the spans around the points to pull; where the cap binds, return the control points they ask for."""
        ranges = [(np.inf, -np.inf)] * 2 if self.core is None else [self.core[:2], self.core[2:]]
        stretch, asked = 1.0, 0
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
            size = in_patches((nu + len(new[0]), nv + len(new[1])), self.core, space)
            if size <= most or not (new[0] or new[1]):
                break
            stretch, asked = 1.1 * stretch, asked or size
        return (
            (*with_knots(space, coefficients, new[0], new[1]), asked)
            if new[0] or new[1]
            else (space, coefficients, asked)
        )

    def _new_knots(
        self, space: Space, demand: _Demand, excess: Floats, most: int
    ) -> tuple[dict[float, int], dict[float, int], bool]:
        """Halve the longer span at the worst points first; a knot never runs through the core.

        Return also whether the cap ended it.
        """
        breaks = [np.unique(space.knots_u), np.unique(space.knots_v)]
        ranges = [(np.inf, -np.inf)] * 2 if self.core is None else [self.core[:2], self.core[2:]]
        counts = list(outer_of(space).shape)
        new: tuple[dict[float, int], dict[float, int]] = ({}, {})
        for point in np.argsort(-excess, kind="stable"):
            if excess[point] == 0:
                break
            choices = []
            for axis, (low, high) in enumerate(ranges):
                x = demand.plane[point, axis]
                k = int(np.clip(np.searchsorted(breaks[axis], x, side="right") - 1, 0, len(breaks[axis]) - 2))
                span = float(breaks[axis][k + 1] - breaks[axis][k])
                if not low <= x <= high and span > demand.shortest[point]:
                    choices.append((span, axis, float(breaks[axis][k] + breaks[axis][k + 1]) / 2))
            if not choices:
                continue
            _, axis, middle = max(choices)
            if middle not in new[axis]:
                counts[axis] += 1
                if in_patches((counts[0], counts[1]), self.core, space) > most:
                    return *new, True
                new[axis][middle] = 1
        return *new, False

    def _notes(self, base: Space, beyond: Floats, limit: float, asked: int = 0) -> tuple[Message, ...]:
        if limit > self.settings.interior_tolerance and not (beyond > limit).any():
            return (*self._coarse_notes(), *self._noise_notes(beyond))
        return (*self._coarse_notes(), *self._bent_notes(), *self._excess_notes(base, beyond, asked))

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
        """Say why points beyond the tolerance stay there: their own noise puts so many beyond it."""
        if not (beyond > 0).any():
            return ()
        note = message(
            "fitting.points-beyond-tolerance-as-noise",
            "noise of {noise:.3g} m puts points beyond the interior tolerance of {tolerance:g} m; they are listed, not "
            "fitted",
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

    def _excess_notes(self, base: Space, excess: Floats, asked: int) -> tuple[Message, ...]:
        """Say why points are not met; how many and how far is for the check, which sees them after all adjustments."""
        if not (excess > 0).any():
            return ()
        reason = message(
            "fitting.points-too-close-for-knots",
            "a surface through them and the next points, or the core, would swing (strict meets them where knots "
            "allow)",
        )
        if asked:
            reason = message(
                "fitting.control-points-used-up",
                "meeting them takes at least {asked} control points; {most} are allowed (max_control_points)",
                most=self.most,
                asked=asked,
            )
        close = crowded(outer_of(base), self.data.plane)
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
            "points stay beyond the interior tolerance of {tolerance:g} m: {reason}",
            tolerance=self.settings.interior_tolerance,
            reason=reason,
        )
        return (note.with_severity("warning"),)


def _far_out(size: Floats, judged: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (n,) which sizes are many times the median of those that are judged."""
    return size > BLUNDER * float(np.median(size[judged]))


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

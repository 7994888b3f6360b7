"""How fine the field's space is: the even spans that the restricted likelihood asks for, short or long.

A field of Matérn smoothness is rougher than many truths. On spans as long as the truth allows, the space itself is
smooth: there the likelihood is greater, and so is the accuracy away from the data.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geofit.data.errors import FitError
from geofit.data.long_arrays import inverse_squares
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data, degree_for
from geofit.fitting.contradiction import contradict
from geofit.fitting.density import CLOUD
from geofit.fitting.field import FieldChoice, choose_covariance, widened_space
from geofit.fitting.likelihood import FINEST
from geofit.fitting.optimum import BEHIND
from geofit.fitting.smoothness import ENOUGH
from geofit.fitting.weighted_points import WeightedPoints
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

__all__ = ["CLOSE", "EVEN", "Choice", "choose_field", "even_space", "longest_span", "mostly_noise", "sketched_fields"]

Rectangle = tuple[float, float, float, float]

#: Shortest spans of the first space on which the field is chosen, in units of the spacing, and of the last: holes in
#: groups resolve what points of an even spacing do not, less so where the field is smoother than the splines. Control
#: points of the level that the search begins on, of the first that is kept, and at most.
EVEN, CLOSE, LESS_EVEN, SKETCH, FIRST_LEVEL, LAST_LEVEL = 0.5, 0.25, 0.35, 500, 1_500, 25_000
#: Points that the search begins with, at least; of twice as many every other one serves.
SKETCHED = 10_000
#: Another level must raise the restricted likelihood by this much, -2 log of it.
GAIN = 10.0
#: The same where the field is smoother than the splines, for each point or for each control point more, whichever is
#: less: shorter spans are always a better approximation of its form, but are to lower the noise by a fiftieth, or, of
#: very many points, to be worth their number (H. Akaike, IEEE Trans. Autom. Control 19, 1974, 716-723).
OF_POINTS, OF_CONTROL_POINTS = 0.04, 2.0
#: A field that leaves the data's range by more than this many times that range is tried on so much shorter spans.
WILD, CALMER = 2.0, 0.75
#: Noise above this share of the values' own spread may be data that contradict each other.
CONTRADICTION = 0.5
#: Control points of a coarser level, as a share of those of the last, and the least of any.
COARSER, COARSEST = 0.75, 75
#: How many times the noise of the level before a coarser one may find.
LOUDER = 1.25


@dataclass(frozen=True, eq=False)
class Level:
    """The best field on a space, and -2 log of its restricted likelihood."""

    space: TensorSpace
    field: FieldChoice
    value: float


#: The regional field, and the even space that resolves it.
Choice = tuple[FieldChoice, TensorSpace]
#: What finds the fields on a space, the best first, given those to begin with and the value that is of use.
Search = Callable[[TensorSpace, Sequence[FieldChoice], float], list[Level]]


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


def sketched_fields(data: Data, smoothing: float | None = None) -> tuple[FieldChoice, ...]:
    """Return the best field of each smoothness on few control points, where a value of the likelihood costs little.

    Those far behind are left out: finer spans have never yet made up for more.
    """
    some = slice(None, None, max(len(data.plane) // SKETCHED, 1))
    space = even_space(data.area, EVEN, degree_for(len(data.plane)), SKETCH)
    given = WeightedPoints(data.plane[some], data.value[some], inverse_squares(data.noise[some]))
    found = choose_covariance(space, given, smoothing, (), data.trend)
    return tuple(field for field, value in found if value < found[0][1] + BEHIND)


def choose_field(data: Data, settings: FitSettings, most: int, sketched: Sequence[FieldChoice] = ()) -> Choice:
    """Choose the regional field (:func:`geofit.fitting.field.choose_covariance`) and the even space that resolves it.

    Smoothness, range and direction are found on few control points (``sketched``, where that is done already), the
    noise on the first level. Its spans are lengthened while the likelihood gains by it; where it gains nothing, they
    are shortened, down to those that points in groups resolve.
    """
    degree, points = degree_for(len(data.plane)), data.weighted
    given = None if settings.smoothing == "auto" else float(settings.smoothing)
    limit = min(most, LAST_LEVEL)
    space = even_space(data.area, EVEN, degree, min(FIRST_LEVEL, limit))
    nearby = int(COARSER * space.size), 2 * FIRST_LEVEL
    points.foresee(widened_space(even_space(data.area, EVEN, degree, size)) for size in nearby)
    known = tuple(sketched)
    if not known and even_space(data.area, EVEN, degree, SKETCH).size < space.size:
        known = sketched_fields(data, given)

    def on(space: TensorSpace, known: Sequence[FieldChoice], needed: float = math.inf) -> list[Level]:
        found = choose_covariance(space, points, given, known, data.trend, needed=needed)
        return [Level(space, field, value) for field, value in found]

    def resolved(first: Level) -> Level:
        best, lost = _lengthened(first, _coarser(data.area, degree, first.space.size), on)
        if best is first:
            # A field smoother than the splines needs shorter spans only where those of the sketch still cut it.
            settled = known and known[0].noise < LOUDER * first.field.noise
            closest = CLOSE if first.field.alpha <= degree else EVEN if settled else LESS_EVEN
            dense = longest_span(best.space) > 1
            best = _shortened(
                best, _finer(data.area, degree, limit, closest), on, len(data.plane), lost if dense else math.inf
            )
            if best is not first:
                # Spaces no finer than the first one have been evaluated already.
                between = (one for one in _coarser(data.area, degree, best.space.size) if one.size > first.space.size)
                best, _ = _lengthened(best, between, on)
        return best

    firsts = on(space, known)
    # What is relief to a rougher field on finer spans may pass for noise about a smoother one.
    rivals = [
        one
        for one in firsts
        if one.field.alpha <= degree < firsts[0].field.alpha
        and (LOUDER * one.field.noise < firsts[0].field.noise or one.value < firsts[0].value + GAIN)
    ]
    best = min((resolved(one) for one in (firsts[0], *rivals[:1])), key=lambda level: level.value)
    if len(data.plane) <= CLOUD and _wild(best, data):
        best = _shortened(best, _calmer(data.area, degree, limit, longest_span(best.space)), on, len(data.plane))
    space, field = best.space, best.field
    if data.slopes is not None and len(data.slopes):
        field = choose_covariance(space, points, given, [field], data.trend, data.slopes, field.noise)[0][0]
    return replace(field, contradictory=_contradictory(space, field, data)), space


def _lengthened(best: Level, coarser: Iterable[TensorSpace], on: Search) -> tuple[Level, float]:
    """Go to longer spans while the likelihood gains by it, which a truth smoother than any of the fields makes it do.

    What such spans cannot follow counts as noise: where the noise grows, it is the truth that they cut. Return also
    what the next longer spans lose, -2 log of the likelihood.
    """
    simplest, lost = best, math.inf
    for space in coarser:
        level = _tried(on, space, simplest.field, simplest.value)
        if level is not None and simplest is best:
            lost = level.value - best.value
        if level is None or level.value > simplest.value or level.field.noise > LOUDER * best.field.noise:
            break
        simplest = level
    return (simplest if simplest.value < best.value - GAIN else best), lost


def _shortened(best: Level, finer: Iterable[TensorSpace], on: Search, n: int, most: float = math.inf) -> Level:
    """Go to shorter spans while the likelihood of n points gains by it, which it does by ``most`` at most.

    Where the points are dense on every span, halving the cells gains less than a quarter fewer cells lose: what spans
    cut falls at least with their square, and the misfit with the fourth power.
    """
    for space in finer:
        if space.size < 1.3 * best.space.size:
            continue
        worth = min(OF_POINTS * n, OF_CONTROL_POINTS * (space.size - best.space.size))
        gain = GAIN if best.field.alpha <= space.degree else max(GAIN, worth)
        if gain > most:
            break
        level = _tried(on, space, best.field, best.value - gain)
        if level is None or level.value > best.value - gain:
            break
        best = level
    return best


def _wild(level: Level, data: Data) -> bool:
    """Whether a field swings far beyond its data: spans longer than the relief between dense points make it do so."""
    value = np.asarray(data.value[:])
    low, high = float(value.min()), float(value.max())
    found = data.smoothed(level.space, level.field).coefficients
    # About an exact plane, rounding is all the range there is.
    return bool(np.maximum(found - high, low - found).max() > WILD * max(high - low, level.field.noise))


def mostly_noise(field: FieldChoice) -> bool:
    """Whether a field takes most of the data's relief for noise."""
    # Of an exact plane the noise is what keeps the likelihood finite.
    return field.noise > max(CONTRADICTION * field.spread, 2 * FINEST)


def _contradictory(space: TensorSpace, field: FieldChoice, data: Data) -> bool:
    """Whether data of which a field takes most for noise contradict each other."""
    if len(data.plane) < ENOUGH or not mostly_noise(field):
        return False
    if len(data.plane) > CLOUD:
        return True
    plane, found = data.plane[:], data.smoothed(space, field).coefficients
    misfit = data.value[:] - space.matrix(plane) @ found
    return contradict(data.unit * plane, misfit, field.noise, data.accuracy)


def _tried(on: Search, space: TensorSpace, field: FieldChoice, needed: float) -> Level | None:
    """Return the field on another space; None where rounding leaves its system without a solution there."""
    try:
        return on(space, [field], needed)[0]
    except FitError:
        return None


def _finer(area: Rectangle, degree: int, limit: int, closest: float) -> Iterator[TensorSpace]:
    """Yield spaces of ever shorter spans: down to those of evenly spaced points, then that of the shortest."""
    count, last = FIRST_LEVEL, even_space(area, closest, degree, limit)
    while 2 * count <= min(limit, last.size):
        count *= 2
        yield even_space(area, EVEN, degree, count)
    yield last


def _calmer(area: Rectangle, degree: int, limit: int, span: float) -> Iterator[TensorSpace]:
    """Yield spaces of ever shorter spans than those of the sparse points, as far as the control points go."""
    size = 0
    while (space := even_space(area, span := CALMER * span, degree, limit)).size > size:
        size = space.size
        yield space


def _coarser(area: Rectangle, degree: int, size: int) -> Iterator[TensorSpace]:
    """Yield spaces of ever longer spans."""
    while (space := even_space(area, EVEN, degree, int(COARSER * size))).size < size and space.size > COARSEST:
        size = space.size
        yield space


def longest_span(space: TensorSpace) -> float:
    """Return the longest span of a space."""
    return max(float(np.diff(knots).max()) for knots in (space.knots_u, space.knots_v))

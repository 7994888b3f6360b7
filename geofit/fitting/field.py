"""The regional field: the smooth surface that the data support, and how noisy they are.

A Gaussian field about a plane, on a space of splines: heights are plane + field + noise, where the field has a Matérn
covariance (:mod:`geofit.splines.matern`) with its own smoothness, range, direction of the longest range, and size.
The thin-plate spline is its limit of an infinite range. All parameters are those of the greatest restricted likelihood
(:mod:`geofit.fitting.likelihood`). Lengths are counted in units of the spacing of the sparse points.

The field is solved on a space that reaches beyond the study area, where no data bend it, and cut at the area's edge.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.long_arrays import BLOCK, Rows, blocks, covariance, everywhere, spread, sum_squares
from geofit.data.messages import message
from geofit.fitting.likelihood import UNSOLVABLE, Likelihood, Slope, plane_coefficients
from geofit.fitting.optimum import maximize_over_noise
from geofit.fitting.slopes import Slopes
from geofit.fitting.smoothness import as_smooth, search
from geofit.fitting.weighted_points import WeightedPoints
from geofit.splines import bspline
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import Factor, TensorSpace, band_sum

__all__ = [
    "FieldChoice",
    "Smoothed",
    "choose_covariance",
    "drift_of",
    "held_planes",
    "plane_trend",
    "planes_of",
    "precision_band",
    "relative_noise",
    "restricted",
    "slope_of",
    "smooth",
    "widened_space",
]

Floats = NDArray[np.float64]

#: Square of the width of very many points, as a share of that of their length, below which they count as collinear.
COLLINEAR = 1e-14
#: Standard deviation across a strip, in units of the spacing, below which it counts as a line.
_NARROW = 0.05
#: How far the field's space reaches beyond the area, in units, and how fast its spans grow there. Near the free edges
#: of the space the field varies more than the covariance says; the longer its range, the farther in.
_BEYOND, _GROWTH = 3.0, 2.0


@dataclass(frozen=True)
class FieldChoice:
    """What was chosen: the covariance of the field, and the noise (1 sigma, metres) that the likelihood finds.

    ``alpha`` is the exponent of the operator (smoothness nu = alpha - 1), ``kappa`` its inverse range per unit,
    ``rho`` the noise's variance relative to the field's, ``stretch`` its direction (see
    :func:`geofit.splines.matern.metric`). ``spread`` is the standard deviation of the data about their trend, metres.
    ``hold`` is the precision with which the plane's slope is held to zero, in units of the noise's
    (:class:`geofit.fitting.likelihood.Slope`). ``contradictory`` states that the data contradict each other
    (:func:`geofit.fitting.contradiction.contradict`).
    """

    alpha: int
    kappa: float
    rho: float
    stretch: tuple[float, float]
    noise: float
    spread: float = math.inf
    hold: float = 0.0
    #: It says nothing of the covariance, by which choices are equal.
    contradictory: bool = field(default=False, compare=False)

    @property
    def energy(self) -> str:
        """The covariance in words."""
        ratio = math.exp(2 * math.hypot(*self.stretch))
        name = f"Matérn {self.alpha - 1}"
        return name if ratio < 1.05 else f"{name}, {ratio:.1f} : 1"

    @property
    def smoothing(self) -> float:
        """Weight of the field's energy against squared misfits."""
        return self.rho

    def at_most(self, alpha: int) -> FieldChoice:
        """Return the field, or one of the same variance and correlation length, at most as smooth as ``alpha``."""
        if self.alpha <= alpha:
            return self
        kappa, rho = as_smooth(self.kappa, self.rho, self.alpha, alpha)
        return replace(self, alpha=alpha, kappa=kappa, rho=rho)

    @property
    def turned(self) -> FieldChoice:
        """The same field with u and v exchanged."""
        return replace(self, stretch=(-self.stretch[0], self.stretch[1]))


@dataclass(frozen=True, eq=False)
class Smoothed:
    """A field fitted on a space: coefficients, plane included, and the plane's own, (3,) or (3, k) of 1, u, v."""

    coefficients: Floats
    plane: Floats


def plane_trend(plane: Rows, z: Rows, weight: Floats) -> Floats:
    """Return (3,) or (3, k) coefficients of the plane 1, u, v of weighted least squares, least slope first.

    Collinear points leave the slope across them at zero.
    """
    centre = sum(w @ part for part, w in blocks(plane, weight)) / sum(float(w.sum()) for (w,) in blocks(weight))
    solution: Floats
    if len(plane) <= BLOCK:
        root = np.sqrt(weight)
        matrix = np.stack([root, *(root * (plane[:] - centre).T)]).T
        columns = z[:].reshape(len(z), -1) * root[:, None]
        solution = np.linalg.lstsq(matrix, columns, rcond=1e-9)[0]
    else:
        # Products take a tenth of the time of a decomposition, and resolve all but the narrowest strips.
        products, right = np.zeros((3, 3)), np.zeros((3, math.prod(z.shape[1:])))
        for part, values, w in blocks(plane, z, weight):
            rows = [np.ones(len(part)), *(part - centre).T]
            weighted = np.stack([w * row for row in rows])
            products += [[one @ other for other in rows] for one in weighted]
            right += weighted @ values.reshape(len(values), -1)
        solution = np.asarray(np.linalg.pinv(products, rcond=COLLINEAR, hermitian=True) @ right)
    solution[0] -= centre @ solution[1:]
    return solution.reshape(3, *z.shape[1:])


def relative_noise(accuracy: Floats, tolerance: float = math.inf) -> Floats:
    """Return each point's noise against that of the median stated accuracy.

    Points of no stated accuracy are to be met within the tolerance: they count as that accurate, or as the median.
    """
    stated = np.isfinite(accuracy if accuracy.strides != (0,) else accuracy[:1])
    if not stated.any():
        return everywhere(1.0, len(accuracy))
    median = float(np.median(accuracy[stated]))
    ratio = np.full(len(accuracy), min(tolerance / median, 1.0))
    ratio[stated] = accuracy[stated] / median
    return np.asarray(np.clip(ratio, 0.1, 10.0))


def precision_band(space: TensorSpace, field: FieldChoice) -> Floats:
    """Return the band of rho * E, (bandwidth + 1, size), the precision of the field in units of the noise's."""
    return field.rho * MaternPrecision(space, field.alpha).band(field.kappa, field.stretch)


def drift_of(plane: Rows, moments: tuple[Floats, Floats] | None = None, *, sloped: bool = False) -> Floats:
    """Return (3, r) the combinations of 1, u, v that (n, 2) places determine: no slope across a line of points.

    Unless it was measured (``sloped``). ``moments`` is the places' :func:`covariance` where it is known.
    """
    if len(plane) <= BLOCK:
        centre = plane[:BLOCK].mean(axis=0)
        _, size, axes = np.linalg.svd(plane[:BLOCK] - centre, full_matrices=False)
    else:
        centre, products = covariance(plane) if moments is None else moments
        squares, columns = np.linalg.eigh(products)
        size, axes = np.sqrt(np.maximum(squares[::-1], 0.0)), columns.T[::-1]
    known = axes if sloped else axes[size > _NARROW * math.sqrt(len(plane))]
    return np.column_stack([[1.0, 0.0, 0.0], *([-(centre @ axis), *axis] for axis in known)])


def slope_of(plane: Rows, trend: Floats | None, measured: Slopes | None = None) -> Slope:
    """Return what the slope of (n,) heights at (n, 2) places, given about a trend (3,), is held to: none in all.

    Measured slopes determine the plane's slope where the places do not: across a line of points. Without a trend
    nothing holds it, nor that of coordinates, of which a trend is (3, k).
    """
    moments = covariance(plane)
    directions = drift_of(plane, moments, sloped=measured is not None)
    if trend is None or trend.ndim > 1:
        return Slope(directions, np.zeros(directions.shape[1]), 0.0)
    extent = float(np.trace(moments[1])) / len(plane)
    return Slope(directions, np.append(0.0, -(directions[1:, 1:].T @ trend[1:])), extent)


def choose_covariance(
    space: TensorSpace,
    given: WeightedPoints,
    smoothing: float | None = None,
    known: Sequence[FieldChoice] = (),
    trend: Floats | None = None,
    measured: Slopes | None = None,
    expected: float = 0.0,
    needed: float = math.inf,
) -> list[tuple[FieldChoice, float]]:
    """Choose the covariance and the noise for data about their trend.

    Parameters
    ----------
    space : TensorSpace
        A space of even spans over the area; what it cannot follow counts as noise.
    given : WeightedPoints
        Heights (or coordinates) in metres, trend removed, at places in units of the spacing, with the inverse squares
        of their noise relative to each other (:func:`relative_noise`) as weights.
    smoothing : float, optional
        Take this rho; the covariance alone is chosen.
    known : sequence of Field
        What a coarser space gave: the search starts there.
    trend : (3,) or (3, k) array, optional
        The trend that was removed, coefficients of 1, u, v; without it nothing holds the plane's slope.
    measured : Slopes, optional
        Measured slopes about the trend, weighted as if the noise were ``expected``, metres.
    needed : float
        Known fields that plainly stay above this value are not searched to the end.

    Returns
    -------
    list of (Field, float)
        The best of each smoothness with -2 log of its restricted likelihood, but for a constant of the data; the best
        first. On a coarse space the others may gain more from finer spans.

    Raises
    ------
    FitError
        If no field gives a solvable system.
    """
    wide, plane = widened_space(space), given.plane
    turned = wide.shape[1] > wide.shape[0]
    if turned:
        wide, plane, trend, known = wide.turned, plane[:, ::-1], _exchanged(trend), [one.turned for one in known]
        measured = None if measured is None else measured.turned
    band, right = given.equations(wide, turned)
    square = sum_squares(given.value, given.weight)
    slope, count = slope_of(plane, trend, measured), len(plane)
    if measured is not None:
        of_slopes = measured.equations(wide, expected)
        band, right, square, count = (
            band + of_slopes[0],
            right + of_slopes[1],
            square + of_slopes[2],
            count + len(measured),
        )

    def likelihood(alpha: int) -> Likelihood:
        return Likelihood(wide, alpha, band, right, square, slope, count)

    if known:
        # Each is searched: the likelihood at its start does not predict its maximum.
        judges = [likelihood(guess.alpha) for guess in known]
        starts = [
            judge.parameters(guess.kappa, guess.rho, guess.stretch) for judge, guess in zip(judges, known, strict=True)
        ]
        found = [
            maximize_over_noise(judge, start, needed) if smoothing is None else judge.optimum(start)
            for judge, start in zip(judges, starts, strict=True)
        ]
    else:
        found = search(likelihood, space.degree, len(plane), smoothing)
    found = sorted(found, key=lambda one: one.value)
    if found[0].value >= UNSOLVABLE:
        text = message(
            "fitting.system-not-solvable",
            "No smoothing makes the system of {points} points and {size} control points solvable: the points lie on "
            "too few places. Give more points, or a larger coincidence_distance.",
            points=len(plane),
            size=space.size,
        )
        raise FitError(text)
    scatter = spread(given.value)
    fields = []
    for optimum in found:
        own = math.sqrt(optimum.variance) if optimum.value < UNSOLVABLE else math.nan
        covariance = (optimum.alpha, optimum.kappa, optimum.rho, optimum.stretch)
        field = FieldChoice(*covariance, own, scatter, optimum.hold)
        fields.append((field.turned if turned else field, optimum.value))
    return [(field, value) for field, value in fields if value < UNSOLVABLE]


def widened_space(space: TensorSpace) -> TensorSpace:
    """Return the space carried on beyond its edges, in spans that grow."""
    return TensorSpace(_beyond(space.knots_u, space.degree), _beyond(space.knots_v, space.degree), space.degree)


def _beyond(knots: Floats, degree: int) -> Floats:
    inner = knots[degree + 1 : -degree - 1]
    ends = []
    for edge, next_to in ((knots[0], np.unique(knots)[1]), (knots[-1], np.unique(knots)[-2])):
        step, reached = float(edge - next_to), [float(edge)]
        while abs(reached[-1] - edge) < _BEYOND:
            step *= _GROWTH
            reached.append(reached[-1] + step)
        ends.append(reached)
    low, high = ends
    return np.concatenate([np.repeat(low[-1], degree), low[::-1], inner, high, np.repeat(high[-1], degree)])


def restricted(space: TensorSpace, coefficients: Floats) -> Floats:
    """Return the coefficients on a space of a surface on the widened one: cut by knot insertion at the edges."""
    wide, p = widened_space(space), space.degree
    net = coefficients.reshape(*wide.shape, -1)
    for axis, (knots, wide_knots) in enumerate(((space.knots_u, wide.knots_u), (space.knots_v, wide.knots_v))):
        fine = np.sort(np.concatenate([wide_knots, np.repeat([knots[0], knots[-1]], p - 1)]))
        cut = bspline.insertion_matrix(wide_knots, fine, p)
        first = int(np.searchsorted(fine, knots[0], side="left")) - 1
        cut = cut[first : first + len(knots) - p - 1]
        net = np.moveaxis(np.tensordot(cut, net, axes=(1, axis)), 0, axis)
    return np.ascontiguousarray(net).reshape(space.size, *coefficients.shape[1:])


def smooth(
    space: TensorSpace,
    field: FieldChoice,
    given: WeightedPoints,
    trend: Floats | None = None,
    measured: Slopes | None = None,
) -> Smoothed:
    """Return a chosen field on any space: heights about the trend, metres, with the plane of the likelihood.

    ``measured`` slopes, about the trend as well, join the heights by their own accuracy.
    """
    wide, plane = widened_space(space), given.plane
    turned = wide.shape[1] > wide.shape[0]
    if turned:
        wide, plane, trend, field = wide.turned, plane[:, ::-1], _exchanged(trend), field.turned
        measured = None if measured is None else measured.turned
    band, right = given.equations(wide, turned)
    if measured is not None:
        of_slopes = measured.equations(wide, field.noise)
        band, right = band + of_slopes[0], right + of_slopes[1]
    precision, slope = MaternPrecision(wide, field.alpha), slope_of(plane, trend, measured)
    factor = Factor(band_sum(band, field.rho * precision.band(field.kappa, field.stretch)))
    held = held_planes(precision, field, slope, factor.ridge)
    columns = right.reshape(len(right), -1)
    solved = factor.solve(np.column_stack([columns, held]))
    free, drifted = solved[:, : columns.shape[1]], solved[:, columns.shape[1] :]
    moment, cross = planes_of(wide, slope, field.hold, held, free, drifted)
    slopes = np.linalg.lstsq(moment, cross, rcond=None)[0]
    net = (free + drifted @ slopes).reshape(*wide.shape, -1)
    found = slope.directions @ slopes
    if turned:
        net, found = np.swapaxes(net, 0, 1), found[[0, 2, 1]]
    single = given.value.shape[1:]
    return Smoothed(restricted(space, net.reshape(wide.size, *single)), found.reshape(3, *single))


def _exchanged(trend: Floats | None) -> Floats | None:
    return None if trend is None else trend[[0, 2, 1]]


def held_planes(precision: MaternPrecision, field: FieldChoice, slope: Slope, ridge: Floats) -> Floats:
    """Return rho E times the planes, (size, r), with the ridge (size,) of the system's factor as a part of E.

    The ridge holds the field to the plane then. Otherwise it would flatten a plane that only measured slopes determine.
    """
    held = field.rho * precision.times_planes(field.kappa, field.stretch)
    return np.asarray((held + ridge[:, None] * plane_coefficients(precision.space)) @ slope.directions)


def planes_of(
    space: TensorSpace, slope: Slope, hold: float, held: Floats, free: Floats, drifted: Floats
) -> tuple[Floats, Floats]:
    """Return the (r, r) normal matrix of the planes and their (r, k) right-hand side, the slope's prior included.

    ``held`` is rho E times the planes, ``free`` and ``drifted`` what the system gives for the heights and for it.
    """
    drift, prior = plane_coefficients(space) @ slope.directions, slope.precision(hold)
    moment = drift.T @ held - held.T @ drifted + prior
    return (moment + moment.T) / 2, held.T @ free + (prior @ slope.aim)[:, None]
